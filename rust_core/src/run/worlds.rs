//! Many simulations side by side, advanced together on all cores.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::{Builder, ScopedJoinHandle};

use super::record::{BYTES_A_RUN, STACK};
use super::valid_scenario::{BYTES_A_CORNER, corners};
use super::{ByHand, Log, Simulation, ValidScenario};
use crate::error::{Error, caught};
use crate::limits::Cancel;
use crate::limits::memory::ask;
use crate::observe::{Outcome, Reading};
use crate::scenario::{End, Flippers};

/// Independent simulations. If one fails, it stands still, and the others continue.
pub struct Worlds {
    worlds: Vec<Mutex<World>>,
}

struct World {
    scenario: ValidScenario,
    simulation: Simulation,
    log: Log,
    /// Why it cannot continue.
    error: Option<Error>,
}

/// The state of a world at an instant.
#[derive(Clone, Debug)]
pub struct WorldState {
    /// Position, speeds and time.
    pub reading: Reading,
    /// \[rad\] Angles of the flippers at the front and at the rear, upwards > 0; NaN where there are none.
    pub flipper_angles: [f64; 2],
    /// \[rad/s\] Rates of these.
    pub flipper_rates: [f64; 2],
    /// \[N m\] Torques of their motors, upwards > 0.
    pub flipper_torques: [f64; 2],
    /// \[m\] Distance from the rear of the robot to the goal; below 0 beyond it.
    pub to_goal: f64,
    /// \[J\] Work of the motors of its tracks so far.
    pub drive_work: f64,
    /// How it ended, unless in a stop or by time; no trials are made.
    pub ended: Option<Outcome>,
    /// Whether it is stopped.
    pub is_stopped: bool,
    /// Why it cannot continue.
    pub error: Option<String>,
}

impl Worlds {
    /// One world for each scenario, at its start.
    ///
    /// # Errors
    /// They need more memory than there may be; [`Error::Interrupted`] once `cancel` is asked.
    pub fn new(scenarios: Vec<ValidScenario>, cancel: &Cancel) -> Result<Self, Error> {
        let bytes = |scenario: &ValidScenario| {
            BYTES_A_RUN + corners(&scenario.scenario().terrain) * BYTES_A_CORNER
        };
        ask(
            "simulations side by side",
            scenarios.iter().map(bytes).sum(),
        )?;
        let of = |scenario| {
            cancel.check()?;
            Ok(Mutex::new(World::new(scenario)))
        };
        let worlds: Result<_, Error> = scenarios.into_iter().map(of).collect();
        Ok(Self { worlds: worlds? })
    }

    /// Number of worlds.
    pub fn count(&self) -> usize {
        self.worlds.len()
    }

    /// Restarts a world, with another scenario if one is given.
    pub fn reset(&mut self, index: usize, scenario: Option<ValidScenario>) {
        let world = self.worlds[index]
            .get_mut()
            .unwrap_or_else(PoisonError::into_inner);
        let scenario = scenario.unwrap_or_else(|| world.scenario.clone());
        *world = World::new(scenario);
    }

    /// Gives each world its commands, unless it cannot continue. If one command is invalid, none takes effect.
    ///
    /// # Errors
    /// The first error of [`Simulation::command_all`].
    pub fn command(&mut self, commands: &[ByHand]) -> Result<(), Error> {
        let mut each = |give: fn(&mut World, &ByHand) -> Result<(), Error>| {
            let running = self
                .worlds
                .iter_mut()
                .map(|world| world.get_mut().unwrap_or_else(PoisonError::into_inner));
            let mut pairs = running
                .zip(commands)
                .filter(|(world, _)| world.error.is_none());
            pairs.try_for_each(|(world, commands)| give(world, commands))
        };
        each(|world, commands| world.simulation.check_commands(commands))?;
        each(|world, commands| {
            world.log.note_commands(*commands);
            world.simulation.command_all(commands)
        })
    }

    /// Advances the worlds with these indices by a duration \[s\], on several threads.
    ///
    /// # Errors
    /// [`Error::Interrupted`] once `cancel` is asked; then they are at different times.
    pub fn advance(
        &self,
        places: &[usize],
        duration: f64,
        threads: usize,
        cancel: &Cancel,
    ) -> Result<(), Error> {
        let next = AtomicUsize::new(0);
        let work = || {
            while let Some(place) = places.get(next.fetch_add(1, Ordering::Relaxed)) {
                let mut world = lock(&self.worlds[*place]);
                let end = world.set_out(duration);
                if !world.go_on(end, cancel) {
                    return Err(Error::Interrupted);
                }
            }
            Ok(())
        };
        std::thread::scope(|scope| {
            let thread = || Builder::new().stack_size(STACK);
            let start = |_| thread().spawn_scoped(scope, work);
            // If the system gives no thread, this one does the work.
            let others: Vec<_> = (1..threads.min(places.len()))
                .map_while(|k| start(k).ok())
                .collect();
            let own = work();
            let ended = others.into_iter().map(ScopedJoinHandle::join);
            ended.fold(own, |all, one| {
                all.and(one.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            })
        })
    }

    /// Starts an advance of one world by a duration \[s\]; returns the time at its end.
    pub fn set_out(&self, place: usize, duration: f64) -> f64 {
        lock(&self.worlds[place]).set_out(duration)
    }

    /// Advances it to that time \[s\], or until `cancel` is asked; returns whether it is finished or has failed.
    pub fn go_on(&self, place: usize, end: f64, cancel: &Cancel) -> bool {
        lock(&self.worlds[place]).go_on(end, cancel)
    }

    /// The state of each world.
    pub fn states(&self) -> Vec<WorldState> {
        self.worlds
            .iter()
            .map(|world| lock(world).state())
            .collect()
    }

    /// \[m\] Heights of the ground at distances from each robot along x, one row for each world.
    ///
    /// # Errors
    /// They need more memory than there may be.
    pub fn heights(&self, offsets: &[f64]) -> Result<Vec<f64>, Error> {
        // While rows are joined, there are up to two copies.
        let bytes = 2 * size_of::<f64>() * self.worlds.len() * offsets.len();
        ask("heights of the ground", bytes as u64)?;
        let of = |world: &Mutex<World>| {
            let world = lock(world);
            let x = world.simulation.reading().position.x;
            let ground = world.simulation.ground();
            let heights = offsets.iter().map(|offset| ground.height(x + offset));
            heights.collect::<Vec<f64>>()
        };
        Ok(self.worlds.iter().flat_map(of).collect())
    }

    /// Number of points of the ground of a world, and of parts of its robot.
    pub fn size(&self, index: usize) -> (usize, usize) {
        lock(&self.worlds[index]).simulation.size()
    }

    /// The scenario of a world.
    pub fn scenario(&self, index: usize) -> ValidScenario {
        lock(&self.worlds[index]).scenario.clone()
    }

    /// The commands and advances of a world since its start.
    pub fn log(&self, index: usize) -> Log {
        lock(&self.worlds[index]).log.clone()
    }

    /// A snapshot of a world.
    ///
    /// # Errors
    /// As [`Simulation::snapshot`].
    pub fn snapshot(&self, index: usize) -> Result<Vec<u8>, Error> {
        lock(&self.worlds[index]).simulation.snapshot()
    }
}

/// Nothing is left half done in a world whose thread has panicked: it has an error then.
fn lock(world: &Mutex<World>) -> MutexGuard<'_, World> {
    world.lock().unwrap_or_else(PoisonError::into_inner)
}

impl World {
    fn new(scenario: ValidScenario) -> Self {
        Self {
            simulation: Simulation::new(&scenario),
            scenario,
            log: Log::default(),
            error: None,
        }
    }

    /// Records an advance by a duration [s]; returns the time at its end.
    fn set_out(&mut self, duration: f64) -> f64 {
        let end = self.simulation.time() + duration;
        if self.error.is_none() {
            self.log.note_steps(end);
        }
        end
    }

    /// Takes steps up to a time [s], unless it cannot continue, or until `cancel` is asked; returns whether it is
    /// finished or has failed.
    fn go_on(&mut self, end: f64, cancel: &Cancel) -> bool {
        if self.error.is_some() {
            return true;
        }
        let simulation = &mut self.simulation;
        let all = || {
            while simulation.time() < end {
                cancel.check()?;
                simulation.step_until(end)?;
            }
            Ok(())
        };
        let result = caught(all);
        self.log.has_reached(self.simulation.time());
        match result {
            Err(Error::Interrupted) => return false,
            Err(error) => self.error = Some(error),
            Ok(()) => {}
        }
        true
    }

    fn state(&self) -> WorldState {
        let simulation = &self.simulation;
        let flippers = simulation.scenario().robot.flippers.iter();
        let has_front = flippers.flat_map(Flippers::ends).next() == Some(End::Front);
        let both = |values: Vec<f64>| match (values.as_slice(), has_front) {
            ([front, rear], _) => [*front, *rear],
            ([front], true) => [*front, f64::NAN],
            ([rear], false) => [f64::NAN, *rear],
            _ => [f64::NAN; 2],
        };
        let reading = simulation.reading();
        WorldState {
            to_goal: simulation.monitor().to_goal(&reading),
            reading,
            flipper_angles: both(simulation.flipper_angles().collect()),
            flipper_rates: both(simulation.flipper_rates().collect()),
            flipper_torques: both(simulation.flipper_torques().collect()),
            drive_work: simulation.monitor().observed.drive_work,
            ended: simulation.ended_as(),
            is_stopped: simulation.is_stopped(),
            error: self.error.as_ref().map(ToString::to_string),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Ends, Scenario, Terrain, shared};

    /// Both stand 0.2 m before a step of 8 cm, each with as many distances as are asked for.
    #[test]
    fn heights_are_those_of_the_ground_so_far_from_each_robot() {
        let scenario = ValidScenario::new(&shared("engineer_belt_step")).expect("it is valid");
        let worlds = Worlds::new(vec![scenario.clone(); 2], &Cancel::default());
        let worlds = worlds.expect("there is room");
        let Terrain::Step { height, .. } = scenario.scenario().terrain else {
            panic!("it is a step");
        };
        let x = worlds.states()[0].reading.position.x;
        let before = -x;
        assert!(before > 0.1, "{before} m");
        let offsets = [-0.5, 0.0, before - 0.02, before + 0.02, before + 1.0];
        let row = [0.0, 0.0, 0.0, height, height];
        let found = worlds.heights(&offsets).expect("there is room");
        assert_eq!(found.len(), 2 * row.len());
        for (found, expected) in found.iter().zip(row.iter().cycle()) {
            assert!((found - expected).abs() < 1e-12, "{found} m");
        }
    }

    #[test]
    fn angles_of_arms_are_those_of_the_front_and_of_the_rear() {
        let mut scenario = shared("engineer_flippers_step");
        scenario.robot.moment_of_inertia = 1.0;
        scenario.drive.gait = None;
        let angles = |ends: Option<Ends>, scenario: &mut Scenario| {
            match (ends, &mut scenario.robot.flippers) {
                (Some(ends), Some(arms)) => (arms.ends, arms.angle) = (ends, 0.8),
                _ => scenario.robot.flippers = None,
            }
            let checked = ValidScenario::new(scenario).expect("it is valid");
            let worlds = Worlds::new(vec![checked], &Cancel::default());
            let states = worlds.expect("there is room").states();
            let found = states[0].flipper_angles;
            found.map(|angle| (angle - 0.8).abs() < 1e-12)
        };
        assert_eq!(angles(Some(Ends::Both), &mut scenario), [true, true]);
        assert_eq!(angles(Some(Ends::Front), &mut scenario), [true, false]);
        assert_eq!(angles(Some(Ends::Rear), &mut scenario), [false, true]);
        assert_eq!(angles(None, &mut scenario), [false, false]);
    }

    #[test]
    fn if_one_command_is_refused_no_world_has_another() {
        let scenario = ValidScenario::new(&shared("engineer_belt_step")).expect("it is valid");
        let worlds = Worlds::new(vec![scenario; 2], &Cancel::default());
        let mut worlds = worlds.expect("there is room");
        let push = |force: f64| ByHand {
            speed: None,
            flippers: [None; 2],
            push: Some(force),
        };
        let pushes = |worlds: &Worlds| [0, 1].map(|k| lock(&worlds.worlds[k]).simulation.push());
        worlds
            .command(&[push(1.0), push(2.0)])
            .expect("they are forces");
        assert_eq!(
            pushes(&worlds).map(f64::to_bits),
            [1.0, 2.0].map(f64::to_bits)
        );
        assert!(worlds.command(&[push(3.0), push(f64::NAN)]).is_err());
        assert_eq!(
            pushes(&worlds).map(f64::to_bits),
            [1.0, 2.0].map(f64::to_bits)
        );
        // Of one that cannot go on, commands do not matter.
        let failed = worlds.worlds[1].get_mut().expect("nobody panicked");
        failed.error = Some(Error::Internal("a fault".to_owned()));
        worlds
            .command(&[push(3.0), push(f64::NAN)])
            .expect("it has failed");
        assert_eq!(
            pushes(&worlds).map(f64::to_bits),
            [3.0, 2.0].map(f64::to_bits)
        );
    }

    #[test]
    fn one_that_cannot_go_on_stands_still_until_it_is_reset_and_the_others_go_on() {
        let scenario = ValidScenario::new(&shared("engineer_belt_step")).expect("it is valid");
        let worlds = Worlds::new(vec![scenario; 2], &Cancel::default());
        let mut worlds = worlds.expect("there is room");
        let failed = worlds.worlds[1].get_mut().expect("nobody panicked");
        failed.error = Some(Error::Internal("a fault".to_owned()));
        let times = |worlds: &Worlds| -> Vec<f64> {
            worlds
                .states()
                .iter()
                .map(|state| state.reading.time)
                .collect()
        };
        worlds
            .advance(&[0, 1], 0.1, 2, &Cancel::default())
            .expect("it is not interrupted");
        assert_eq!(
            times(&worlds)
                .iter()
                .map(|t| t.to_bits())
                .collect::<Vec<_>>(),
            [0.1, 0.0].map(f64::to_bits)
        );
        assert!(
            worlds.states()[1]
                .error
                .as_ref()
                .is_some_and(|why| why.contains("a fault"))
        );
        worlds.reset(1, None);
        worlds
            .advance(&[0, 1], 0.1, 2, &Cancel::default())
            .expect("it is not interrupted");
        assert_eq!(times(&worlds)[1].to_bits(), 0.1_f64.to_bits());
    }
}
