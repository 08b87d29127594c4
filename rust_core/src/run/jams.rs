//! The jams of a scenario, and whether a robot stays in them.

use std::panic::resume_unwind;
use std::thread::Builder;

use super::record::STACK;
use super::{Simulation, ValidScenario};
use crate::contact::Intrusion;
use crate::error::Error;
use crate::jams::{self, Certificate, Jam, JamRange, SearchEffort};
use crate::limits::Cancel;
use crate::robot::Model;
use crate::terrain::Ground;
use crate::units::{Metres, Seconds};

/// [s] Duration of each phase: without a push, pushed forwards, pushed back, and again without a push.
const SPELL: Seconds = Seconds(0.5);
/// The push as a fraction of the weight.
const PUSH: f64 = 0.01;
/// [m] Largest displacement of a robot that stays.
const FAR: Metres = Metres(1e-3);
/// [rad] Largest rotation of a robot that stays.
const TURNED: f64 = 0.01;

/// A jam, with the result of a simulation that begins there.
#[derive(Clone, Debug)]
pub struct FoundJam {
    /// The pose and its forces.
    pub jam: Jam,
    /// The ground deepest inside the track.
    pub intrusion: Option<Intrusion>,
    /// Whether the robot stays there for two seconds in which it is pushed forwards and back with 1 % of its weight.
    pub stable: bool,
}

/// All poses in which the robot of a scenario can stand still while its drives run at the first commanded speed.
///
/// # Errors
/// [`Error::Scenario`] for a robot or a ground whose jams are not known, [`Error::Interrupted`] once `cancel` is asked,
/// and what a simulation may end with.
pub fn find_jams(scenario: &ValidScenario, cancel: &Cancel) -> Result<Vec<FoundJam>, Error> {
    let built = (scenario.model(), &**scenario.ground());
    let found = jams::jams(scenario.scenario(), built, cancel)?;
    let tried = found.into_iter().map(|jam| {
        let robot = Simulation::driven_at(scenario, jam.position, jam.angle);
        Ok(FoundJam {
            intrusion: deepest(&robot),
            stable: stays(robot.pressed(&jam), &jam, cancel)?,
            jam,
        })
    });
    tried.collect()
}

/// The jams on three contacts at every friction up to `most`, with the ground deepest inside the track.
pub type JamRanges = Vec<(JamRange, Option<Intrusion>)>;

/// The jams of several scenarios, on all cores.
///
/// # Errors
/// As [`find_jams`].
pub fn jam_ranges(
    scenarios: &[ValidScenario],
    most: f64,
    cancel: &Cancel,
) -> Result<Vec<JamRanges>, Error> {
    let all = |part: &[ValidScenario]| -> Result<Vec<JamRanges>, Error> {
        part.iter()
            .map(|scenario| ranges_of(scenario, most, cancel))
            .collect()
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut parts = scenarios.chunks(scenarios.len().div_ceil(threads).max(1));
    let first = parts.next().unwrap_or_default();
    std::thread::scope(|scope| {
        let thread = || Builder::new().stack_size(STACK);
        let start = |part| thread().spawn_scoped(scope, move || all(part));
        // If the system gives no thread, this one does the work.
        let others: Vec<_> = parts.map(|part| (part, start(part))).collect();
        let mut found = all(first)?;
        for (part, thread) in others {
            let of_part = match thread {
                Ok(thread) => thread.join().unwrap_or_else(|panic| resume_unwind(panic)),
                Err(_) => all(part),
            };
            found.extend(of_part?);
        }
        Ok(found)
    })
}

fn ranges_of(scenario: &ValidScenario, most: f64, cancel: &Cancel) -> Result<JamRanges, Error> {
    let built = (scenario.model(), &**scenario.ground());
    let found = jams::jam_ranges(scenario.scenario(), built, most, cancel)?;
    let seen = found.into_iter().map(|range| {
        let robot = Simulation::driven_at(scenario, range.position, range.angle);
        (range, deepest(&robot))
    });
    Ok(seen.collect())
}

/// Certifies at which values of parameters there are no jams that a belt does not have. The scenarios have the smallest
/// values of all parameters, the largest of each alone, the largest of all, and the middle of all; `belts` are the same
/// with a belt round the wheels.
///
/// # Errors
/// As [`find_jams`], and for parameters that move anything but corners of the ground, friction and the centre of mass.
pub fn certify(
    scenarios: &[ValidScenario],
    belts: &[ValidScenario],
    names: &[String],
    effort: SearchEffort,
    cancel: &Cancel,
) -> Result<Certificate, Error> {
    let (wheels, belts) = (built(scenarios), built(belts));
    let scenario = scenarios[0].scenario();
    jams::certify::certify(scenario, [&wheels, &belts], names, effort, cancel)
}

fn built(scenarios: &[ValidScenario]) -> Vec<(&Model, &Ground)> {
    scenarios
        .iter()
        .map(|scenario| (scenario.model(), &**scenario.ground()))
        .collect()
}

fn deepest(robot: &Simulation) -> Option<Intrusion> {
    let inside = robot.intrusions().into_iter();
    inside.max_by(|a, b| a.depth.total_cmp(&b.depth))
}

fn stays(mut robot: Simulation, jam: &Jam, cancel: &Cancel) -> Result<bool, Error> {
    let push = robot.direction() * PUSH * robot.weight();
    for force in [0.0, push, -push, 0.0] {
        robot.set_push(force)?;
        robot.advance(SPELL.value())?;
        cancel.check()?;
        let now = robot.reading();
        let is_off = (now.position - jam.position).length() > FAR.value()
            || (now.chassis_angle - jam.angle).abs() > TURNED;
        if is_off {
            return Ok(false);
        }
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vector;
    use crate::run::trials::tests::wheels;
    use crate::scenario::{ForceSupport, ForceTrack, Surface, Terrain, Track, shared};

    /// The Engineer without motor force on skids of some friction, on ground that rises by a tenth.
    fn skids(friction: f64, rises: bool) -> (Simulation, Jam) {
        let mut scenario = shared("engineer_belt_step");
        scenario.robot.track = Track::Force(ForceTrack {
            support: ForceSupport::Skids,
            skid_friction: friction,
            wheel_count: 5,
        });
        scenario.robot.drivetrain.max_torque = 0.0;
        let slope = if rises { 0.1 } else { 0.0 };
        scenario.start.angle = libm::atan(slope);
        scenario.terrain = Terrain::Points {
            points: vec![[-3.0, -3.0 * slope], [3.0, 3.0 * slope]],
            goal: 2.0,
            surface: Surface::sharp(0.9),
            segment_friction: None,
        };
        let robot = Simulation::new(&ValidScenario::new(&scenario).expect("it is valid"));
        let start = robot.reading();
        let jam = Jam {
            position: start.position,
            angle: start.chassis_angle,
            contacts: Vec::new(),
        };
        (robot, jam)
    }

    /// On as many threads as there are cores.
    #[test]
    fn the_ranges_of_several_robots_come_in_their_order() {
        let of = |count| ValidScenario::new(&wheels(count, 0.08)).expect("it is valid");
        let scenarios = [3, 4, 3, 5, 4].map(of);
        let cancel = Cancel::default();
        let bits = |found: &JamRanges| -> Vec<[u64; 3]> {
            let of = |(range, _): &(JamRange, _)| {
                let [low, high] = range.friction;
                [range.position.x, low, high].map(f64::to_bits)
            };
            found.iter().map(of).collect()
        };
        let all = jam_ranges(&scenarios, 1.0, &cancel).expect("their jams are known");
        assert_eq!(all.len(), scenarios.len());
        for (scenario, found) in scenarios.iter().zip(&all) {
            let alone = ranges_of(scenario, 1.0, &cancel).expect("its jams are known");
            assert_eq!(bits(found), bits(&alone));
        }
        assert!(!all[1].is_empty() && bits(&all[0]) != bits(&all[1]));
        assert!(
            jam_ranges(&[], 1.0, &cancel)
                .expect("there is nothing to do")
                .is_empty()
        );
    }

    /// Of a slope of 0.1, a friction of 0.1 and half a hundredth more bears no push of a hundredth of the weight backwards.
    #[test]
    fn a_robot_stays_unless_a_hundredth_of_its_weight_moves_it_either_way() {
        for (friction, rises, expected) in [
            (0.005, false, false),
            (0.02, false, true),
            (0.105, true, false),
            (0.12, true, true),
        ] {
            let (robot, jam) = skids(friction, rises);
            let found = stays(robot, &jam, &Cancel::default()).expect("it stays finite");
            assert_eq!(found, expected, "{friction} {rises}");
        }
    }

    /// A millimetre, and a hundredth of a radian.
    #[test]
    fn a_robot_that_is_not_where_it_is_to_stay_does_not_stay() {
        for (off, turned, expected) in [
            (Vector::new(0.8e-3, 0.0), 0.0, true),
            (Vector::new(0.9e-3, 0.9e-3), 0.0, false),
            (Vector::ZERO, 0.009, true),
            (Vector::ZERO, 0.011, false),
            (Vector::ZERO, -0.011, false),
        ] {
            let (robot, mut jam) = skids(0.3, false);
            jam.position += off;
            jam.angle += turned;
            let found = stays(robot, &jam, &Cancel::default()).expect("it stays finite");
            assert_eq!(found, expected, "{off} {turned}");
        }
    }
}
