//! The scenario that a trial makes of that of a run.

use crate::diagnosis::Change;
use crate::scenario::{
    BeltTrack, ClosedSurface, ClosedTrack, Engine, Gait, Hold, Robot, Scenario, TorqueSharing,
    Track,
};

/// How a trial continues from a stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Start {
    /// With all of the state.
    Continued,
    /// With pose and speeds; ground inside is let out.
    Rebuilt,
    /// At rest, in the nearest pose in which no ground is inside.
    Clear,
    /// Where the scenario begins.
    Anew,
}

/// The variant that a change makes of a scenario; `None` if it makes no sense for its robot.
pub(super) fn of(scenario: &Scenario, change: Change) -> Option<(Scenario, Start)> {
    let mut variant = scenario.clone();
    // Trials of another engine's stops are made by our own dynamics, at its time step.
    variant.solver.engine = Engine::Own;
    let robot = &mut variant.robot;
    let start = match change {
        Change::Nothing => Start::Continued,
        Change::Rebuilt => Start::Rebuilt,
        Change::ClosedTrack | Change::ClosedTrackClear | Change::ClosedTrackFromStart => {
            robot.track = closed(robot, ClosedSurface::Own)?;
            match change {
                Change::ClosedTrack => Start::Rebuilt,
                Change::ClosedTrackClear => Start::Clear,
                _ => Start::Anew,
            }
        }
        Change::ClosedSmoothTrack => {
            any_track(robot, Track::has_grousers).then_some(())?;
            robot.track = closed(robot, ClosedSurface::Smooth)?;
            Start::Rebuilt
        }
        Change::Belt | Change::BeltFromStart => {
            any_track(robot, Track::has_pockets).then_some(())?;
            robot.track = Track::Belt(BeltTrack {});
            robot.drivetrain.torque_sharing = TorqueSharing::Track;
            if let Some(flippers) = &mut robot.flippers {
                flippers.track = None;
            }
            if change == Change::Belt {
                Start::Rebuilt
            } else {
                Start::Anew
            }
        }
        Change::OneMotor => {
            let sharing = &mut robot.drivetrain.torque_sharing;
            (*sharing == TorqueSharing::Wheel).then_some(())?;
            *sharing = TorqueSharing::Track;
            Start::Rebuilt
        }
        Change::TwiceTheTorque => {
            robot.drivetrain.max_torque *= 2.0;
            Start::Continued
        }
        Change::TenTimesTheTorque => {
            robot.drivetrain.max_torque *= 10.0;
            Start::Continued
        }
        Change::TwiceTheFriction => {
            variant.terrain.scale_friction(2.0);
            if let Track::Force(force) = &mut robot.track {
                force.skid_friction *= 2.0;
            }
            Start::Continued
        }
        Change::NoBelly => {
            robot.belly.take()?;
            Start::Continued
        }
        Change::FlippersLevel => {
            robot.flippers.as_ref()?;
            variant.drive.gait = Some(Gait::Hold(Hold {
                angle: 0.0,
                schedule: None,
            }));
            Start::Continued
        }
    };
    Some((variant, start))
}

/// The robot's track, closed; `None` if it has no pockets that could be closed.
fn closed(robot: &Robot, surface: ClosedSurface) -> Option<Track> {
    any_track(robot, Track::has_pockets).then(|| {
        Track::Closed(ClosedTrack {
            of: Box::new(robot.track.clone()),
            surface,
        })
    })
}

/// Whether something is so of the robot's track or of its arms'.
fn any_track(robot: &Robot, is_so: fn(&Track) -> bool) -> bool {
    let arms = robot.flippers.as_ref().and_then(|f| f.track.as_ref());
    is_so(&robot.track) || arms.is_some_and(is_so)
}
