//! A robot over a ground: possible contacts, and the angles at which pairs of them can occur together.

use super::clear::is_clear;
use super::contact::{Contact, Posture, Turn};
use super::layout::{Layout, Outline};
use super::places::{Facing, Place};
use crate::error::Error;
use crate::geometry::{Vector, is_between};
use crate::limits::Cancel;
use crate::scenario::ScenarioError;
use crate::units::Metres;

/// [m] Gaps up to this are contacts; poses are known to a thousandth of it.
pub(super) const TOUCHING: Metres = Metres(1e-9);
/// [m] and [rad] Poses that differ by less are the same.
const SAME: Metres = Metres(1e-7);
/// Largest number of contacts; so many are sorted into pairs in a few seconds.
const MOST_CONTACTS: usize = 20_000;

/// A robot over a ground.
#[derive(Clone, Debug)]
pub(super) struct Setting {
    pub layout: Layout,
    pub places: Vec<Place>,
    /// All possible contacts.
    pub contacts: Vec<Contact>,
    /// For each contact, those with a higher index that can occur together with it.
    pub partners: Vec<Vec<Partner>>,
    /// Angles at which poses are searched.
    pub bins: Bins,
}

impl Setting {
    /// Builds it for a search of poses between two angles [rad].
    ///
    /// # Errors
    /// [`Error::Scenario`] for a ground of too many pieces, [`Error::Interrupted`] once `cancel` is asked.
    pub(super) fn new(
        layout: Layout,
        places: Vec<Place>,
        angles: [f64; 2],
        cancel: &Cancel,
    ) -> Result<Self, Error> {
        let contacts = Contact::all(&layout, &places);
        if contacts.len() > MOST_CONTACTS {
            let rule = format!(
                "must have fewer faces and corners: with those of the robot they make {} contacts, and at most \
                 {MOST_CONTACTS} are searched",
                contacts.len()
            );
            let value = format!("{} faces and corners", places.len());
            return Err(ScenarioError::new("terrain", value, rule).into());
        }
        let bounds: Vec<Reach> = contacts
            .iter()
            .map(|contact| Reach::of(&layout, &places, contact))
            .collect();
        let bins = Bins::between(angles);
        let partners = bounds.iter().enumerate().map(|(i, one)| {
            cancel.check()?;
            let later = bounds.iter().enumerate().skip(i + 1);
            let apart =
                later.filter(|(j, _)| !contacts[i].is_one_with(&contacts[*j], TOUCHING.value()));
            let fitting = apart.map(|(j, other)| Partner {
                contact: j,
                angles: one.angles_with(other, &bins),
            });
            Ok(fitting.filter(|partner| partner.angles != 0).collect())
        });
        Ok(Self {
            partners: partners.collect::<Result<_, Error>>()?,
            layout,
            places,
            contacts,
            bins,
        })
    }

    /// The bins of angles at which two contacts, the one with the lower index first, can occur together.
    pub(super) fn together(&self, one: usize, other: usize) -> u128 {
        let partners = &self.partners[one];
        let found = partners.binary_search_by_key(&other, |partner| partner.contact);
        found.map_or(0, |k| partners[k].angles)
    }

    /// The contacts in a pose; `None` if the robot overlaps with the ground.
    pub(super) fn touching(&self, posture: &Posture) -> Option<Vec<usize>> {
        let touches = |contact: &Contact| {
            contact.touch(posture).gap.abs() <= TOUCHING.value() && self.is_real(contact, posture)
        };
        if !self.is_clear(posture) {
            return None;
        }
        let all = self.contacts.iter().enumerate();
        Some(all.filter(|(_, c)| touches(c)).map(|(i, _)| i).collect())
    }

    /// Whether the robot does not overlap with the ground.
    pub(super) fn is_clear(&self, posture: &Posture) -> bool {
        is_clear(&self.layout, &self.places, posture, TOUCHING.value())
    }

    /// Whether the touching points belong to the piece of the outline and the piece of the ground.
    pub(super) fn is_real(&self, contact: &Contact, posture: &Posture) -> bool {
        contact.is_real(&self.layout, &self.places, posture, TOUCHING.value())
    }
}

/// Whether two poses are the same up to rounding.
pub(super) fn is_same(one: &Posture, other: &Posture) -> bool {
    (one.position - other.position).length() < SAME.value()
        && (one.angle - other.angle).abs() < SAME.value()
}

/// The box that contains a point of the robot, the centre of a disc or the middle of a run, while it touches a place.
struct Reach {
    point: Vector,
    low: Vector,
    high: Vector,
}

impl Reach {
    fn of(layout: &Layout, places: &[Place], contact: &Contact) -> Self {
        let surface = &layout.surfaces[contact.surface].shape;
        let (point, far) = match surface {
            Outline::Round(disc) => (disc.center, disc.radius),
            Outline::Flat { ends: [a, b], .. } => ((*a + *b) * 0.5, 0.5 * (*b - *a).length()),
        };
        let ends = match (&places[contact.place].shape, surface) {
            (Facing::Face { ends, normal }, _) => ends.map(|end| end + *normal * far).to_vec(),
            (
                Facing::Corner {
                    center,
                    radius,
                    cone,
                },
                Outline::Round(_),
            ) => {
                let axes = [Vector::X, Vector::Y, Vector::NEG_X, Vector::NEG_Y];
                let inside = axes
                    .into_iter()
                    .filter(|axis| is_between(*axis, *cone, 0.0));
                let directions = cone.iter().copied().chain(inside);
                directions.map(|d| center + d * (radius + far)).collect()
            }
            // The run may lie in any direction.
            (Facing::Corner { center, radius, .. }, Outline::Flat { .. }) => {
                let most = Vector::ONE * (radius + far);
                vec![center - most, center + most]
            }
        };
        let first = ends[0];
        let slack = Vector::ONE * (2.0 * TOUCHING.value());
        Self {
            point,
            low: ends.iter().copied().fold(first, Vector::min) - slack,
            high: ends.iter().copied().fold(first, Vector::max) + slack,
        }
    }

    /// The bins of angles at which both points can be in their boxes.
    fn angles_with(&self, other: &Self, bins: &Bins) -> u128 {
        let between = other.point - self.point;
        let (low, high) = (other.low - self.high, other.high - self.low);
        let distance = between.length();
        let least = low.max(-high).max(Vector::ZERO).length();
        let most = low.abs().max(high.abs()).length();
        if !(least..=most).contains(&distance) {
            return 0;
        }
        let slack = Vector::ONE * (distance * bins.half_width);
        let (low, high) = (low - slack, high + slack);
        let is_in = |v: Vector| v.cmpge(low).all() && v.cmple(high).all();
        let at = bins.middles.iter().enumerate();
        at.filter(|(_, turn)| is_in(turn.apply(between)))
            .fold(0, |bits, (i, _)| bits | 1 << i)
    }
}

/// A contact that can occur together with another one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Partner {
    pub contact: usize,
    /// The bins of angles.
    pub angles: u128,
}

/// A range of angles, divided into as many bins as an integer has bits.
#[derive(Clone, Debug)]
pub(super) struct Bins {
    low: f64,
    half_width: f64,
    middles: Vec<Turn>,
}

impl Bins {
    fn between([low, high]: [f64; 2]) -> Self {
        let half_width = 0.5 * (high - low) / f64::from(u128::BITS);
        let middle = |i: u32| Turn::by(low + f64::from(2 * i + 1) * half_width);
        Self {
            low,
            half_width,
            middles: (0..u128::BITS).map(middle).collect(),
        }
    }

    /// [rad] The ranges that bins cover together.
    pub(super) fn ranges(&self, bins: u128) -> impl Iterator<Item = [f64; 2]> + use<> {
        let (low, width) = (self.low, 2.0 * self.half_width);
        let mut left = bins;
        let mut from = 0;
        std::iter::from_fn(move || {
            if left == 0 {
                return None;
            }
            let skipped = left.trailing_zeros();
            // If all bins are set, a shift would overflow.
            left = left.checked_shr(skipped).unwrap_or(0);
            let count = left.trailing_ones();
            left = left.checked_shr(count).unwrap_or(0);
            let first = from + skipped;
            from = first + count;
            Some([first, from].map(|bin| low + f64::from(bin) * width))
        })
    }

    /// Whether an angle is in the range.
    pub(super) fn hold(&self, angle: f64) -> bool {
        let width = 2.0 * self.half_width * f64::from(u128::BITS);
        (self.low..=self.low + width).contains(&angle)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::draw::Draw;
    use crate::geometry::Disc;
    use crate::jams::contact::Kind;
    use crate::jams::layout::{Grip, Surface};
    use crate::robot::BodyKind;

    /// A robot of one surface over one piece of ground, and the box of that.
    fn reach(shape: Outline, facing: Facing) -> Reach {
        let surface = Surface {
            part: 0,
            kind: BodyKind::Wheel,
            lane: 0,
            shape,
            grip: Grip::Free,
            friction_limit: f64::INFINITY,
        };
        let place = Place {
            lane: 0,
            edge: None,
            shape: facing,
            friction: 0.5,
        };
        let layout = Layout {
            center_of_mass: Vector::ZERO,
            reach: 1.0,
            surfaces: vec![surface],
            solids: Vec::new(),
        };
        let contact = Contact {
            surface: 0,
            place: 0,
            kind: Kind::Across(Vector::Y, 0.0, Vector::ZERO, 0.0),
        };
        Reach::of(&layout, &[place], &contact)
    }

    /// A disc of 0.1 m, and a run of 0.4 m, at a face, at the corner of a step and at one that opens downwards by 60
    /// degrees.
    #[test]
    fn a_surface_at_a_piece_of_ground_lies_in_a_box() {
        let center = Vector::new(2.0, 1.0);
        let round = Outline::Round(Disc {
            center: Vector::new(0.3, 0.2),
            radius: 0.1,
        });
        let flat = Outline::Flat {
            ends: [Vector::new(0.1, 0.0), Vector::new(0.5, 0.0)],
            outward: Vector::NEG_Y,
        };
        let face = Facing::Face {
            ends: [Vector::new(-1.0, 0.5), Vector::new(3.0, 0.5)],
            normal: Vector::Y,
        };
        let corner = |cone: [Vector; 2]| Facing::Corner {
            center,
            radius: 0.02,
            cone,
        };
        let step = corner([Vector::Y, Vector::NEG_X]);
        let tip = corner([60.0_f64, 120.0].map(|angle| Vector::from_angle(angle.to_radians())));
        let half = 0.12 * 0.5;
        for (outline, facing, point, low, high) in [
            (round, face, [0.3, 0.2], [-1.0, 0.6], [3.0, 0.6]),
            (round, step, [0.3, 0.2], [1.88, 1.0], [2.0, 1.12]),
            (
                round,
                tip,
                [0.3, 0.2],
                [2.0 - half, 1.0 + half * 3.0_f64.sqrt()],
                [2.0 + half, 1.12],
            ),
            (flat, step, [0.3, 0.0], [1.78, 0.78], [2.22, 1.22]),
        ] {
            let found = reach(outline, facing);
            for (found, expected) in [(found.point, point), (found.low, low), (found.high, high)] {
                let off = (found - Vector::from(expected)).length();
                assert!(off < 4.0 * TOUCHING.value(), "{found} {expected:?}");
            }
            assert!(found.low.x < low[0] && found.high.y > high[1], "{facing:?}");
        }
    }

    /// One of two points 0.5 m apart stays at the origin, the other in a box.
    #[test]
    fn two_surfaces_can_be_together_at_the_angles_that_bring_both_into_their_boxes() {
        let bins = Bins::between([-0.5 * TAU, 0.5 * TAU]);
        let mut draw = Draw(20_270_601);
        let between = Vector::new(0.3, 0.4);
        let (mut some, mut none) = (0, 0);
        for _ in 0..300 {
            let at = |low: Vector, high: Vector, point: Vector| Reach { point, low, high };
            let corner = Vector::new(draw.between(-0.8, 0.8), draw.between(-0.8, 0.8));
            let size = Vector::new(draw.between(0.0, 0.3), draw.between(0.0, 0.3));
            let one = at(Vector::ONE, Vector::ONE, Vector::X);
            let shift = Vector::ONE;
            let other = at(corner + shift, corner + size + shift, Vector::X + between);
            let found = one.angles_with(&other, &bins);
            let is_at = |angle: f64, slack: f64| {
                let v = Turn::by(angle).apply(between) - corner;
                let (low, high) = (v.min(size - v), Vector::ZERO - Vector::ONE * slack);
                low.x >= high.x && low.y >= high.y
            };
            let width = TAU / f64::from(u128::BITS);
            for bin in 0..u128::BITS {
                let from = -0.5 * TAU + f64::from(bin) * width;
                let is_found = found >> bin & 1 == 1;
                let mut shares = (0..=20).map(|k| from + width * f64::from(k) / 20.0);
                if shares.clone().any(|angle| is_at(angle, 0.0)) {
                    assert!(is_found, "bin {bin}");
                }
                // A bin moves the point by 0.5 m times its width.
                if is_found {
                    assert!(shares.any(|angle| is_at(angle, 0.5 * width)), "bin {bin}");
                }
            }
            some += u32::from(found != 0);
            none += u32::from(found == 0);
        }
        assert!(some > 50 && none > 50, "{some} {none}");
    }

    #[test]
    fn neighbouring_bins_are_one_range_and_all_of_them_the_whole() {
        let bins = Bins::between([-1.0, 3.0]);
        let width = 4.0 / 128.0;
        let last = 1_u128 << 127;
        for (bits, expected) in [
            (0, vec![]),
            (1, vec![[0.0, 1.0]]),
            (0b111_0110, vec![[1.0, 3.0], [4.0, 7.0]]),
            (last | 1, vec![[0.0, 1.0], [127.0, 128.0]]),
            (u128::MAX, vec![[0.0, 128.0]]),
        ] {
            let found: Vec<[f64; 2]> = bins.ranges(bits).collect();
            assert_eq!(found.len(), expected.len(), "{bits:b}");
            for (found, expected) in found.iter().zip(expected) {
                let off = [0, 1].map(|k| (found[k] + 1.0 - expected[k] * width).abs());
                assert!(off[0] < 1e-12 && off[1] < 1e-12, "{found:?}");
            }
        }
        for (angle, is_held) in [(-1.01, false), (-1.0, true), (2.9, true), (3.01, false)] {
            assert_eq!(bins.hold(angle), is_held, "{angle} rad");
        }
    }
}
