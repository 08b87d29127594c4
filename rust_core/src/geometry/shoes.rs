//! A closed chain of shoes round the discs of a track: the path of its pins.
//!
//! The pins of a taut chain lie on the straight runs. Round a disc, the middle of each shoe touches the disc, so
//! the pins run on a larger circle, whose chords of one pitch touch the disc. A run meets that circle half a pitch
//! before its own end.

use std::f64::consts::{PI, TAU};

use super::hull::{Arc, Curve, arcs_round};
use super::search::zero;
use super::{Disc, Envelope, Motion, Teeth, lower_tangent};
use super::{Pose, Rotation, Vector, right_of};

/// Number of positions of the chain along its path over which its length is averaged.
const PHASES: u32 = 16;
/// Largest ratio of the length of a polygon of shoes to that of the belt round the same discs.
const LENGTHENED: f64 = 1.1;
/// Fraction of the radial motion of pins on a sprocket by which the sprocket is raised above the lower run; otherwise
/// shoes that it turns downwards would lift the robot.
const LIFT: f64 = 0.5;

/// The closed path of a chain, and the chain on it.
#[derive(Clone, Debug)]
pub struct ShoeLoop {
    /// Discs to whose hull the pin lines are tangent: the rear end, the front end, and those between them.
    discs: Vec<Disc>,
    /// Number of shoes.
    pub count: usize,
    /// [m] Distance between the pins of a shoe.
    pub pitch: f64,
    /// Number of teeth of the sprocket at the rear end, if there is one.
    teeth: Option<usize>,
}

impl ShoeLoop {
    /// A chain of `count` shoes that is taut round the discs, on average over its positions; the first two discs are
    /// the rear and front ends. `None` if a shoe would be longer than half the distance of the ends, the diameter of
    /// the smallest disc or a straight run, because it could not go round.
    pub(crate) fn new(discs: Vec<Disc>, count: usize) -> Option<Self> {
        let least = Envelope::new(&discs).length() / count as f64;
        let most = LENGTHENED * least;
        let half_way = 0.5 * (discs[1].center - discs[0].center).length();
        let radii = discs.iter().map(|disc| disc.radius);
        if most > half_way.min(2.0 * radii.fold(f64::INFINITY, f64::min)) {
            return None;
        }
        let chain = Self {
            discs,
            count,
            pitch: 0.0,
            teeth: None,
        };
        chain.taut_between(least, most)
    }

    /// The same chain round a sprocket at the rear end, with the number of teeth that fits this best; `None` if no run
    /// is as long as a shoe then.
    pub(crate) fn on_sprocket(self) -> Option<Self> {
        let half = 0.5 * self.pitch;
        let teeth = PI / libm::atan(half / self.discs[0].radius);
        let (least, most) = (0.8 * self.pitch, 1.2 * self.pitch);
        let teeth = Some(teeth.round().max(3.0) as usize);
        Self { teeth, ..self }.taut_between(least, most)
    }

    /// The chain with a pitch between two limits at which it is taut on average; `None` if its runs are too short.
    fn taut_between(self, least: f64, most: f64) -> Option<Self> {
        if ![least, most].into_iter().all(|pitch| self.has_runs(pitch)) {
            return None;
        }
        let fraction = |phase: u32| f64::from(phase) / f64::from(PHASES);
        // Shoes that bend round many small discs may make it even longer.
        let is_between = |phase: u32| {
            let excess = |p: f64| self.excess(p, fraction(phase) * p, 0.0);
            excess(least) < 0.0 && 0.0 < excess(most)
        };
        if !(0..PHASES).all(is_between) {
            return None;
        }
        let taut = |phase: u32| {
            zero(least, most, |p: f64| {
                self.excess(p, fraction(phase) * p, 0.0)
            })
        };
        let pitch = (0..PHASES).map(taut).sum::<f64>() / f64::from(PHASES);
        Some(Self { pitch, ..self })
    }

    /// Whether a shoe of a pitch [m] fits on the runs between all discs, even with the front end as far in or out as
    /// `travel` searches.
    fn has_runs(&self, pitch: f64) -> bool {
        [-0.5, 0.5].into_iter().all(|fraction| {
            let mut discs = self.ends(pitch);
            discs[1].center.x += fraction * pitch;
            let arcs = arcs_round(&discs);
            let fits = |[from, to]: [&Disc; 2]| {
                let (apart, step) = (to.center - from.center, to.radius - from.radius);
                apart.length_squared() - step * step >= pitch * pitch
            };
            let next = arcs.iter().cycle().skip(1);
            let mut runs = arcs
                .iter()
                .zip(next)
                .map(|(a, b)| [&discs[a.disc], &discs[b.disc]]);
            let has = |disc: usize| arcs.iter().any(|arc| arc.disc == disc);
            (0..discs.len()).all(has) && runs.all(fits)
        })
    }

    /// The teeth of its sprocket, if any; if possible they reach no farther out than `most` [m].
    pub(crate) fn teeth(&self, most: f64) -> Option<Teeth> {
        self.teeth.map(|count| Teeth::new(count, self.pitch, most))
    }

    /// [rad] Angle of a seat of the sprocket relative to the chassis at the start.
    pub(crate) fn first_seat(&self) -> f64 {
        match self.path(self.pitch, 0.0).stretches[0].curve {
            Curve::Arc(arc) => arc.from,
            Curve::Run(_) => 0.0,
        }
    }

    /// Discs to whose hull the pin lines are tangent, with shoes of a pitch [m].
    ///
    /// The size of a sprocket follows from its teeth, and its axle is placed so that the lower run stays in place,
    /// apart from the clearance for its polygon.
    pub(crate) fn ends(&self, pitch: f64) -> Vec<Disc> {
        let Some(teeth) = self.teeth else {
            return self.discs.clone();
        };
        let (rear, front) = (self.discs[0], self.discs[1]);
        let radius = 0.5 * pitch / libm::tan(PI / teeth as f64);
        let [from, to] = lower_tangent(rear, front);
        let down = right_of((to - from).normalize());
        let rise = radius / libm::cos(PI / teeth as f64) - radius;
        let center = rear.center + down * (rear.radius - radius - LIFT * rise);
        vec![Disc { center, radius }, front]
    }

    /// [m] Extension of the front end that keeps the chain taut when it has run by a distance [m].
    pub(crate) fn travel(&self, run: f64) -> f64 {
        let phase = run.rem_euclid(self.pitch);
        let reach = 0.5 * self.pitch;
        zero(-reach, reach, |out| -self.excess(self.pitch, phase, out))
    }

    /// Frames of the shoes in the chassis frame when the chain is taut and has run by a distance [m]: x along its
    /// travel, y outwards, the origin halfway between the pins.
    pub(crate) fn places(&self, run: f64) -> Vec<Pose> {
        let phase = run.rem_euclid(self.pitch);
        let path = self.path(self.pitch, self.travel(run));
        let positions = self.walk(&path, self.pitch, self.first_position(phase));
        let mut pins: Vec<Vector> = positions.map(|position| path.point_at(position)).collect();
        pins.pop();
        // Each shoe keeps its number as the chain runs.
        let passed = (run.div_euclid(self.pitch) as i64).rem_euclid(self.count as i64);
        pins.rotate_left(passed as usize);
        (0..self.count)
            .map(|i| {
                let (rear, front) = (pins[i], pins[(i + 1) % self.count]);
                let along = (front - rear).normalize();
                let rotation = Rotation::from_cos_sin_unchecked(along.x, along.y);
                Pose::from_parts(0.5 * (rear + front), rotation)
            })
            .collect()
    }

    /// Motion of a shoe with its origin at a point, per metre of chain travel, averaged while the shoe passes.
    pub(crate) fn motion_at(&self, origin: Vector) -> Motion {
        let path = Envelope::new(&self.ends(self.pitch));
        path.motion_at(path.position_of(origin), 0.5 * self.pitch)
    }

    /// [m] Excess length of a chain with this pitch, extension of the front end, and distance of a pin from the
    /// beginning of the path.
    fn excess(&self, pitch: f64, phase: f64, out: f64) -> f64 {
        let path = self.path(pitch, out);
        let first = self.first_position(phase);
        let last = self.walk(&path, pitch, first).last().unwrap_or(first);
        last - first - path.length()
    }

    /// [m] Position on the path of a pin at a distance from its beginning; a sprocket turns its pins evenly.
    fn first_position(&self, phase: f64) -> f64 {
        match self.teeth {
            Some(teeth) => {
                let step = TAU / teeth as f64;
                phase * 0.5 * step / libm::sin(0.5 * step)
            }
            None => phase,
        }
    }

    /// [m] Positions of the pins of a chain along its path, and of the one after the last.
    fn walk<'a>(
        &self,
        path: &'a Envelope,
        pitch: f64,
        phase: f64,
    ) -> impl Iterator<Item = f64> + use<'a> {
        let next = move |position: &f64| Some(path.position_at_distance(*position, pitch));
        std::iter::successors(Some(phase), next).take(self.count + 1)
    }

    /// The path of the pins, with the front end extended by `out` [m].
    fn path(&self, pitch: f64, out: f64) -> Envelope {
        let mut discs = self.ends(pitch);
        discs[1].center.x += out;
        let half = 0.5 * pitch;
        let mut path = Envelope::new(&discs);
        let mut start = 0.0;
        for stretch in &mut path.stretches {
            stretch.start = start;
            match &mut stretch.curve {
                Curve::Arc(arc) => {
                    let (beyond, center) = (libm::atan(half / arc.radius), arc.center);
                    let radius = (arc.radius * arc.radius + half * half).sqrt();
                    let (from, sweep) = (arc.from + beyond, arc.sweep + 2.0 * beyond);
                    *arc = Arc::new(arc.disc, Disc { center, radius }, from, sweep);
                    stretch.length = radius * sweep;
                }
                Curve::Run(run) => {
                    run.begin += run.along * half;
                    stretch.length -= pitch;
                }
            }
            start += stretch.length;
        }
        path
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(rear: f64, front: f64) -> Vec<Disc> {
        let disc = |x, radius| Disc {
            center: Vector::new(x, 0.0),
            radius,
        };
        vec![disc(-0.1825, rear), disc(0.1825, front)]
    }

    #[test]
    fn chain_closes_wherever_it_has_run_to() {
        for (rear, front, count) in [(0.0505, 0.0505, 22), (0.0505, 0.0505, 44), (0.06, 0.04, 23)] {
            let chain = ShoeLoop::new(ends(rear, front), count).unwrap();
            for k in 0..100 {
                let run = 0.0123 * f64::from(k);
                let places = chain.places(run);
                let pin = |place: &Pose, side: f64| {
                    place.transform_point(Vector::new(0.5 * side * chain.pitch, 0.0))
                };
                for (i, place) in places.iter().enumerate() {
                    let gap = pin(place, 1.0) - pin(&places[(i + 1) % count], -1.0);
                    assert!(gap.length() < 1e-9, "{count} shoes at {run}: {gap}");
                    let mut discs = ends(rear, front);
                    discs[1].center.x += chain.travel(run);
                    for disc in discs {
                        let local = place.inverse_transform_point(disc.center);
                        if local.x.abs() < 0.5 * chain.pitch {
                            assert!(-local.y > disc.radius - 1e-9, "shoe {i} cuts an end");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn ends_so_unequal_that_no_shoe_fits_between_them_take_no_chain() {
        for (rear, front) in [(0.05, 0.39), (0.39, 0.05)] {
            for count in (3..40).chain((40..400).step_by(17)) {
                if let Some(chain) = ShoeLoop::new(ends(rear, front), count) {
                    assert!(chain.pitch < 0.14);
                    chain.places(0.1);
                    chain.on_sprocket().map(|chain| chain.places(0.1));
                }
            }
        }
    }

    #[test]
    fn shoes_keep_their_numbers() {
        let chain = ShoeLoop::new(ends(0.0505, 0.0505), 22).unwrap();
        for k in 0..200 {
            let (now, next) = (0.01 * f64::from(k), 0.01 * f64::from(k + 1));
            let moved = chain.places(now).into_iter().zip(chain.places(next));
            for (a, b) in moved {
                assert!((b.translation - a.translation).length() < 0.012);
            }
        }
    }

    #[test]
    fn many_short_shoes_are_as_long_as_the_outline() {
        let discs = ends(0.06, 0.04);
        let length = Envelope::new(&discs).length();
        for (count, longer) in [(23, 0.03), (46, 0.01), (368, 2e-4)] {
            let chain = ShoeLoop::new(discs.clone(), count).unwrap();
            let excess = chain.pitch * count as f64 / length - 1.0;
            assert!(0.0 < excess && excess < longer, "{count} shoes: {excess}");
        }
    }

    #[test]
    fn a_chain_is_taut_at_no_pitch_of_a_range_that_is_too_short_or_too_long() {
        for (rear, front, count) in [(0.0505, 0.0505, 22), (0.06, 0.04, 23)] {
            let chain = ShoeLoop::new(ends(rear, front), count).expect("its shoes fit");
            let found = |least: f64, most: f64| {
                let again = chain
                    .clone()
                    .taut_between(least * chain.pitch, most * chain.pitch);
                again.map(|again| again.pitch / chain.pitch)
            };
            // It is taut at pitches that differ by less than a percent as it runs.
            assert!(found(0.9, 0.98).is_none() && found(1.02, 1.1).is_none());
            let again = found(0.95, 1.05).expect("it is taut between them");
            assert!((again - 1.0).abs() < 1e-12, "{again}");
        }
    }

    /// A chain of 22 shoes on a sprocket at its rear end.
    fn on_sprocket() -> ShoeLoop {
        let chain = ShoeLoop::new(ends(0.0505, 0.0505), 22).expect("its shoes fit");
        chain.on_sprocket().expect("they fit on a sprocket")
    }

    /// Chords of the pin circle are one pitch long, and the drum touches their middles.
    #[test]
    fn a_sprocket_has_as_many_teeth_as_fit_and_turns_its_pins_evenly() {
        let chain = on_sprocket();
        let (half, teeth) = (0.5 * chain.pitch, chain.teeth(1.0).expect("it has teeth"));
        let fitting = PI / libm::atan(half / 0.0505);
        assert!((teeth.count as f64 - fitting).abs() < 0.6, "{fitting}");
        assert!(teeth.tip_radius > teeth.radius && chain.teeth(0.0).is_some());
        let [drum, front] = chain.ends(chain.pitch)[..] else {
            panic!("it has two ends");
        };
        assert!((drum.radius.hypot(half) - teeth.radius).abs() < 1e-12);
        assert!((front.radius - 0.0505).abs() < 1e-15);
        // Its lower run is that of the ends, except for half of the rise of a pin on it.
        let rise = teeth.radius - drum.radius;
        let lower = 0.0505 - (drum.radius - drum.center.y);
        assert!((lower - 0.5 * rise).abs() < 1e-12, "{lower} m");
        assert!((drum.center.x + 0.1825).abs() < 1e-12);
        let path = chain.path(chain.pitch, 0.0);
        for k in 0..10 {
            let phase = 0.1 * f64::from(k) * chain.pitch;
            let spoke = path.point_at(chain.first_position(phase)) - drum.center;
            assert!((spoke.length() - teeth.radius).abs() < 1e-12);
            let turned = chain.first_seat() - libm::atan2(spoke.y, spoke.x);
            let off = turned - phase / teeth.drive_radius();
            assert!((off - TAU * (off / TAU).round()).abs() < 1e-12, "{off} rad");
        }
    }

    #[test]
    fn a_chain_on_a_sprocket_closes_and_its_pins_stay_in_their_seats() {
        let chain = on_sprocket();
        let teeth = chain.teeth(1.0).expect("it has teeth");
        let drum = chain.ends(chain.pitch)[0].center;
        for k in 0..50 {
            let run = 0.0123 * f64::from(k);
            let places = chain.places(run);
            let pin = |i: usize, side: f64| {
                places[i % 22].transform_point(Vector::new(0.5 * side * chain.pitch, 0.0))
            };
            let mut seated = 0;
            for i in 0..22 {
                assert!(
                    (pin(i, 1.0) - pin(i + 1, -1.0)).length() < 1e-9,
                    "{i} at {run}"
                );
                let spoke = pin(i, 1.0) - drum;
                if (spoke.length() - teeth.radius).abs() > 1e-9 {
                    continue;
                }
                seated += 1;
                let seat = chain.first_seat() - run / teeth.drive_radius();
                let steps = (libm::atan2(spoke.y, spoke.x) - seat) / (TAU / teeth.count as f64);
                // Half the play is 0.02 pitches.
                assert!(
                    (steps - steps.round()).abs() < 0.02,
                    "{steps} steps at {run}"
                );
            }
            assert!(seated >= teeth.count / 2 - 1, "{seated} pins");
            assert!(chain.travel(run).abs() < 0.02 * chain.pitch);
        }
    }

    /// It begins to turn half a pitch before a joint, and does not turn in the middle of a run.
    #[test]
    fn a_shoe_moves_along_its_run_and_turns_about_its_disc() {
        let chain = ShoeLoop::new(ends(0.0505, 0.0505), 22).expect("its shoes fit");
        let turn = |x: f64, y: f64| chain.motion_at(Vector::new(x, y)).turn * 0.0505;
        let end = 0.1825;
        for (x, y, expected) in [
            (0.0, -0.0505, 0.0),
            (0.0, 0.0505, 0.0),
            (end - 0.6 * chain.pitch, 0.0505, 0.0),
            (end - 0.25 * chain.pitch, 0.0505, 0.25),
            (-end - 0.0505, 0.0, 1.0),
            (end + 0.0505, 0.0, 1.0),
        ] {
            assert!(
                (turn(x, y) - expected).abs() < 1e-9,
                "{x} {y}: {}",
                turn(x, y)
            );
        }
    }
}
