//! At which friction a robot can stand in a pose that three contacts fix; the forces depend on the friction, the pose
//! does not.

use super::contact::{Posture, Turn};
use super::forces::{Push, for_each_choice};
use super::setting::Setting;
use super::zeros::{Difference, zeros};

/// A range that is searched for zeros in one piece.
const ONE_PIECE: f64 = 0.08;

impl Setting {
    /// The same on ground with a friction of 1 everywhere, which no part limits.
    pub(super) fn with_unit_friction(mut self) -> Self {
        for place in &mut self.places {
            place.friction = 1.0;
        }
        for surface in &mut self.layout.surfaces {
            surface.friction_limit = f64::INFINITY;
        }
        self
    }

    /// The intervals of friction, up to a limit, at which these contacts can carry the robot; on ground of unit
    /// friction.
    pub(super) fn carried_at(
        &self,
        contacts: &[usize],
        posture: &Posture,
        most: f64,
    ) -> Vec<[f64; 2]> {
        let turn = Turn::by(posture.angle);
        let pushes: Vec<Push> = contacts.iter().flat_map(|i| self.pushes(*i)).collect();
        // Wrenches are linear in the friction.
        let wrench = |push: Push| self.wrench(push, posture.position, turn);
        let line = |push: &Push| {
            let smooth = Push {
                slope: 0.0,
                ..*push
            };
            (wrench(smooth), wrench(*push))
        };
        let lines: Vec<([f64; 3], [f64; 3])> = pushes.iter().map(line).collect();
        let wrenches = |friction: f64| -> Vec<[f64; 3]> {
            let of = |line: &([f64; 3], [f64; 3])| along(*line, friction);
            lines.iter().map(of).collect()
        };
        let mut ends = vec![0.0, most];
        let mut add_zeros = |f: &dyn Fn(f64) -> Difference| {
            // Determinants are cubic in the friction: one piece of any width holds all of them.
            let range = std::iter::once([0.0, ONE_PIECE]);
            let found = zeros(range, |share| f(most * share / ONE_PIECE));
            ends.extend(found.iter().map(|share| most * share / ONE_PIECE));
        };
        // The loads that pushes can carry are bounded by planes through two of them, or change where three lie in one
        // plane.
        for (i, a) in lines.iter().enumerate() {
            for (j, b) in lines.iter().enumerate().skip(i + 1) {
                add_zeros(&|mu| determinant([0.0, 1.0, 0.0], along(*a, mu), along(*b, mu)));
                for c in &lines[j + 1..] {
                    add_zeros(&|mu| determinant(along(*a, mu), along(*b, mu), along(*c, mu)));
                }
            }
        }
        ends.sort_by(f64::total_cmp);
        let is_carried = |friction: f64| {
            let mut found = false;
            for_each_choice(&wrenches(friction), &mut |_| found = true);
            found
        };
        let mut ranges: Vec<[f64; 2]> = Vec::new();
        for pair in ends.windows(2) {
            let [low, high] = [pair[0], pair[1]];
            if high <= low || !is_carried(0.5 * (low + high)) {
                continue;
            }
            match ranges.last_mut() {
                Some(last) if last[1] >= low => last[1] = high,
                _ => ranges.push([low, high]),
            }
        }
        ranges
    }
}

/// The wrench of a push at a friction, from those at 0 and at 1.
fn along((smooth, rough): ([f64; 3], [f64; 3]), friction: f64) -> [f64; 3] {
    std::array::from_fn(|axis| smooth[axis] + friction * (rough[axis] - smooth[axis]))
}

fn determinant(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> Difference {
    let terms = [
        a[0] * b[1] * c[2],
        a[1] * b[2] * c[0],
        a[2] * b[0] * c[1],
        -a[2] * b[1] * c[0],
        -a[0] * b[2] * c[1],
        -a[1] * b[0] * c[2],
    ];
    [terms.iter().sum(), terms.iter().map(|t| t.abs()).sum()]
}

#[cfg(test)]
#[allow(clippy::float_cmp)] // sides of a box are whole numbers
mod tests {
    use super::*;
    use crate::draw::Draw;

    /// The result is the volume that three vectors span, with a sign for their order.
    #[test]
    fn a_determinant_is_0_for_vectors_of_one_plane_and_a_product_of_sides_for_a_box() {
        let mut draw = Draw(1);
        for _ in 0..100 {
            let mut vector = || std::array::from_fn(|_| draw.between(-1.0, 1.0));
            let (a, b, [s, t, _]): ([f64; 3], [f64; 3], [f64; 3]) = (vector(), vector(), vector());
            let c = std::array::from_fn(|i| s * a[i] + t * b[i]);
            for [volume, size] in [
                determinant(a, b, c),
                determinant(c, a, b),
                determinant(b, c, a),
            ] {
                assert!(volume.abs() <= 1e-15 * size.max(1.0));
            }
        }
        let [x, y, z] = [[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 5.0]];
        assert_eq!(determinant(x, y, z), [30.0, 30.0]);
        assert_eq!(determinant(y, x, z), [-30.0, 30.0]);
        assert_eq!(determinant(z, y, x), [-30.0, 30.0]);
    }
}
