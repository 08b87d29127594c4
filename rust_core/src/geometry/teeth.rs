//! Teeth of a sprocket as the pins of a chain meet them.
//!
//! With the pins shrunk to points and the teeth grown accordingly, a tooth is the region within a pitch of both
//! neighbouring seats and within its tip circle: a pin whose neighbour is seated swings just past its flank. So a
//! flank pushes a pin only along the shoe behind it, and no pull lifts the chain off. Below the pin circle the
//! flanks are radial: no pin wedges there, and the drum carries the shoes.

use std::f64::consts::TAU;

use super::{Rotation, Vector, direction, left_of, right_of};

/// [pitches] Play of a pin in its seat; with less, the polygon of shoes wedges.
const PLAY: f64 = 0.04;
/// [pitches] Smallest and largest height of the teeth above the pin circle; with lower teeth, a chain jumps.
const HEIGHTS: [f64; 2] = [0.15, 0.25];

/// The teeth of a sprocket; the middle of a seat lies on its x axis, and chains run clockwise.
#[derive(Clone, Debug)]
pub struct Teeth {
    /// Number of teeth.
    pub count: usize,
    /// [m] Distance between neighbouring seats.
    pub pitch: f64,
    /// [m] Radius of the circle of the seated pins.
    pub radius: f64,
    /// [m] Radius of the circle of the tips.
    pub(crate) tip_radius: f64,
    /// Round the seat on the x axis: where the pin behind sits when driven, where the pin ahead sits when braked, and
    /// where its own pin sits, braked and driven.
    seats: [Vector; 4],
}

/// The side of a tooth nearest to a pin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flank {
    /// [m] Distance between tooth and pin.
    pub gap: f64,
    /// Direction from the tooth to the pin.
    pub normal: Vector,
}

impl Teeth {
    /// Teeth that reach out to `most` [m], within the limits of their height.
    pub(crate) fn new(count: usize, pitch: f64, most: f64) -> Self {
        let step = TAU / count as f64;
        let radius = 0.5 * pitch / libm::sin(0.5 * step);
        let play = 0.5 * PLAY * pitch / radius;
        let seat = |angle: f64| direction(angle) * radius;
        let [low, high] = HEIGHTS.map(|height| height * pitch);
        Self {
            tip_radius: radius + (most - radius).clamp(low, high),
            count,
            pitch,
            radius,
            seats: [step + play, -step - play, -play, play].map(seat),
        }
    }

    /// [m] Radius at which one turn moves the chain by one pitch per tooth.
    pub fn drive_radius(&self) -> f64 {
        self.count as f64 * self.pitch / TAU
    }

    /// The tooth behind a pin and the one ahead of it; `None` if it is more than `reach` [m] from the tips.
    pub(crate) fn flanks(&self, pin: Vector, reach: f64) -> Option<[Flank; 2]> {
        let out = pin.length();
        let over = out - self.tip_radius;
        if over > reach || out == 0.0 {
            return None;
        }
        let step = TAU / self.count as f64;
        let seat = libm::round(libm::atan2(pin.y, pin.x) / step) * step;
        let turn = Rotation::new(seat);
        let here = turn.inverse() * pin;
        let [behind, ahead, braked, driven] = self.seats;
        let tip = Flank {
            gap: over,
            normal: here / out,
        };
        let flank = |seat: Vector| {
            let spoke = here - seat;
            let length = spoke.length();
            Flank {
                gap: length - self.pitch,
                normal: spoke / length,
            }
        };
        let radial = |seat: Vector, sideways: Vector| {
            let normal = sideways / self.radius;
            Flank {
                gap: (here - seat).dot(normal),
                normal,
            }
        };
        let farthest = |sides: [Flank; 3]| {
            let farther = |most: Flank, side: Flank| {
                if side.gap > most.gap { side } else { most }
            };
            let nearest = sides.into_iter().fold(tip, farther);
            Flank {
                normal: turn * nearest.normal,
                ..nearest
            }
        };
        Some([
            farthest([
                flank(behind),
                flank(braked),
                radial(driven, right_of(driven)),
            ]),
            farthest([flank(ahead), flank(driven), radial(braked, left_of(braked))]),
        ])
    }

    /// Corners of the whole wheel in its own frame, counter-clockwise, for pictures; pins of this radius [m] fit
    /// between the teeth.
    pub fn outline(&self, pin_radius: f64) -> Vec<Vector> {
        /// Number of points on one flank.
        const POINTS: usize = 5;
        let step = TAU / self.count as f64;
        let play = 0.5 * PLAY * self.pitch / self.radius;
        let reach = self.pitch + pin_radius;
        let tip = self.tip_radius - pin_radius;
        // On the drum, below the inner faces of the plates.
        let root = self.radius * libm::cos(0.5 * step) - pin_radius;
        // The point at a distance from the axle, and at the pitch minus the pin radius from the neighbouring seat.
        let angle_at = |out: f64| {
            let r = self.radius;
            if out < r {
                return play + libm::asin((pin_radius / out).min(1.0));
            }
            let inner = reach - 2.0 * pin_radius;
            let cosine = (out * out + r * r - inner * inner) / (2.0 * out * r);
            step + play - libm::acos(cosine.clamp(-1.0, 1.0))
        };
        let outs =
            (0..POINTS).map(|i| self.radius + (tip - self.radius) * i as f64 / (POINTS - 1) as f64);
        let flank: Vec<(f64, f64)> = std::iter::once(root)
            .chain(outs)
            .map(|out| (out, angle_at(out).min(0.5 * step)))
            .collect();
        let point = |(out, angle): (f64, f64)| direction(angle) * out;
        (0..self.count)
            .flat_map(|tooth| {
                let seat = tooth as f64 * step;
                let up = flank.iter().map(move |(out, angle)| (*out, seat + angle));
                let next = seat + step;
                let down = flank
                    .iter()
                    .rev()
                    .map(move |(out, angle)| (*out, next - angle));
                up.chain(down)
            })
            .map(point)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seated(teeth: &Teeth, angle: f64) -> Vector {
        direction(angle) * teeth.radius
    }

    #[test]
    fn pins_fit_between_the_teeth_of_a_picture_and_tips_are_as_high_as_teeth() {
        for count in [7, 11, 14] {
            let teeth = Teeth::new(count, 0.04, 0.0);
            let pin = 0.1 * teeth.pitch;
            let outline = teeth.outline(pin);
            assert_eq!(outline.len(), 12 * count);
            let farthest = outline.iter().map(|point| point.length());
            let tip = teeth.tip_radius - pin;
            assert!((farthest.fold(0.0, f64::max) - tip).abs() < 1e-12);
            for seat in 0..count {
                let pinned = seated(&teeth, seat as f64 * TAU / count as f64);
                let nearest = outline.iter().map(|point| (*point - pinned).length());
                let nearest = nearest.fold(f64::INFINITY, f64::min);
                // The flanks leave half the play on either side.
                let room = nearest - pin;
                assert!(
                    (0.0..PLAY * teeth.pitch).contains(&room),
                    "{room} m of {pin} m"
                );
            }
        }
    }

    #[test]
    fn a_pin_far_from_the_tips_or_on_the_axle_meets_no_tooth() {
        let teeth = Teeth::new(11, 0.04, 0.0);
        let at = |over: f64| direction(0.3) * (teeth.tip_radius + over);
        assert!(teeth.flanks(at(1.1e-3), 1e-3).is_none());
        assert!(teeth.flanks(at(0.9e-3), 1e-3).is_some());
        assert!(teeth.flanks(Vector::ZERO, 1e-3).is_none());
    }

    #[test]
    fn a_pin_in_its_seat_touches_the_flank_that_drives_it() {
        for count in [7, 11, 14] {
            let teeth = Teeth::new(count, 0.04, 0.0);
            let play = 0.5 * PLAY * teeth.pitch / teeth.radius;
            let step = TAU / count as f64;
            for seat in 0..count {
                let middle = seat as f64 * step;
                let [behind, ahead] = teeth.flanks(seated(&teeth, middle + play), 0.0).unwrap();
                assert!(behind.gap.abs() < 1e-12 && ahead.gap > 0.5 * PLAY * teeth.pitch);
                let [behind, ahead] = teeth.flanks(seated(&teeth, middle - play), 0.0).unwrap();
                assert!(ahead.gap.abs() < 1e-12 && behind.gap > 0.5 * PLAY * teeth.pitch);
            }
        }
    }

    /// The load on a driven pin is along the shoe behind it, and on a braked pin along the shoe ahead.
    #[test]
    fn a_flank_pushes_along_the_shoe() {
        let teeth = Teeth::new(7, 0.0486, 0.064);
        let play = 0.5 * PLAY * teeth.pitch / teeth.radius;
        let step = TAU / 7.0;
        let last = seated(&teeth, play + step);
        // Just above its seat: in it, the radial flank below touches as well.
        let shoe = Rotation::new(0.01) * (seated(&teeth, play) - last);
        let [flank, _] = teeth.flanks(last + shoe, 0.0).unwrap();
        assert!(flank.normal.dot(shoe.normalize()) > 1.0 - 1e-12);
    }

    #[test]
    fn a_pin_swings_past_its_tooth_about_the_neighbour() {
        let teeth = Teeth::new(7, 0.0486, 0.064);
        let play = 0.5 * PLAY * teeth.pitch / teeth.radius;
        let step = TAU / 7.0;
        let last = seated(&teeth, play + step);
        for swing in 0..60 {
            let shoe = seated(&teeth, play) - last;
            let pin = last + Rotation::new(0.01 * f64::from(swing)) * shoe;
            let Some([behind, ahead]) = teeth.flanks(pin, 0.0) else {
                assert!(swing > 10);
                break;
            };
            assert!(behind.gap > -1e-12 && ahead.gap > 0.0);
        }
    }

    #[test]
    fn a_pin_below_its_seat_is_free_to_go_deeper() {
        let teeth = Teeth::new(7, 0.0486, 0.064);
        for out in [0.9, 0.95, 0.99] {
            let [behind, ahead] = teeth.flanks(Vector::X * teeth.radius * out, 0.0).unwrap();
            assert!(behind.gap > 0.0 && ahead.gap > 0.0);
            assert!(behind.normal.x.abs() < 0.02 && ahead.normal.x.abs() < 0.02);
        }
    }

    #[test]
    fn a_pin_on_a_tip_is_pushed_out() {
        let teeth = Teeth::new(11, 0.03, 1.0);
        let pin = direction(0.5 * TAU / 11.0) * (teeth.tip_radius - 1e-4);
        let [behind, ahead] = teeth.flanks(pin, 0.0).unwrap();
        let top = if behind.gap < ahead.gap {
            behind
        } else {
            ahead
        };
        assert!((top.gap + 1e-4).abs() < 1e-12);
        assert!(top.normal.dot(pin.normalize()) > 1.0 - 1e-12);
    }

    #[test]
    fn one_turn_moves_the_chain_by_a_pitch_for_each_tooth() {
        let teeth = Teeth::new(11, 0.04, 0.0);
        assert!((teeth.drive_radius() * TAU - 0.44).abs() < 1e-15);
    }

    /// The seats are half the play away on either side.
    #[test]
    fn flanks_of_a_picture_are_where_a_pin_swings_past_and_radial_below_its_seat() {
        for (count, most) in [(7, 0.0), (11, 0.0), (14, 1.0)] {
            let teeth = Teeth::new(count, 0.04, most);
            let (pin, step) = (0.1 * teeth.pitch, TAU / count as f64);
            let play = 0.5 * PLAY * teeth.pitch / teeth.radius;
            let outline = teeth.outline(pin);
            for (tooth, corners) in outline.chunks(12).enumerate() {
                let [seat, next] = [0.0, 1.0].map(|k| (tooth as f64 + k) * step);
                let out: Vec<f64> = corners.iter().map(|p| p.length()).collect();
                let (from, to) = (teeth.radius, teeth.tip_radius - pin);
                let root = from * libm::cos(0.5 * step) - pin;
                let rising = (0..5).map(|k| from + (to - from) * f64::from(k) / 4.0);
                let expected: Vec<f64> = std::iter::once(root).chain(rising).collect();
                for k in 0..6 {
                    assert!((out[k] - expected[k]).abs() < 1e-12);
                    assert!((out[11 - k] - expected[k]).abs() < 1e-12);
                    // It is alike on both sides of the tooth.
                    let middle = direction(0.5 * (seat + next));
                    let [up, down] = [k, 11 - k].map(|k| corners[k].dot(middle));
                    assert!((up - down).abs() < 1e-12);
                    let off = libm::atan2(corners[k].y, corners[k].x) - seat;
                    let off = off - TAU * (off / TAU).round();
                    if off > 0.5 * step - 1e-9 {
                        // Both flanks meet.
                        continue;
                    }
                    if k == 0 {
                        let beside = out[k] * libm::sin(off - play);
                        assert!((beside - pin).abs() < 1e-12, "{beside} m");
                    } else {
                        let behind = seated(&teeth, next + play);
                        let apart = (corners[k] - behind).length();
                        assert!((apart - (teeth.pitch - pin)).abs() < 1e-12, "{apart} m");
                    }
                }
            }
        }
    }
}
