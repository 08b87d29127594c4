//! A chain in a step: its solve before the motion, and the one after it.
//!
//! In the solve before the motion pins act where they will be in its middle, and are to close their gaps by its end. In
//! the solve after it they hold the shoes together where they are, while their forces over the whole step act where they
//! were in its middle. That way a shoe that goes round an end keeps its speed.
//!
//! The equations: docs/physics.md, "Chains".

use super::pull::find_grasps;
use super::{Chain, STOP_STIFFNESS};
use crate::dynamics::state::{Shoe, State};
use crate::geometry::{Pose, Vector};
use crate::robot::{Bushing, Tensioner};
use crate::solver::{Damper, Hinge, Ring};

impl Chain {
    /// Prepares the solve before a motion of `h` [s]. Pins are to close their gaps by its end; they and the drive act where
    /// they are in its middle, where the chassis has the pose `chassis`. `free` has the velocities without constraints.
    pub(in crate::dynamics) fn follow(
        &mut self,
        ring: &mut Ring,
        (state, chassis): (&State, Pose),
        free: &[f64],
        h: f64,
    ) {
        let shoes = &state.shoes[self.rule.shoes.clone()];
        self.measure_gaps(shoes);
        self.middle.clear();
        self.middle
            .extend(shoes.iter().map(|shoe| shoe.after(0.5 * h)));
        let middle = std::mem::take(&mut self.middle);
        self.turn_pins(&middle);
        self.stiffen(h);
        ring.start(&self.inertias, free);
        for (hinge, pin) in ring.hinges.iter_mut().zip(&self.pins) {
            *hinge = Hinge {
                ends: pin.arms,
                pushed_at: pin.arms,
                velocity: pin.gap / -h,
                ..Hinge::default()
            };
        }
        // As in the middle of the motion, to which it takes half of the step from here.
        let Bushing { stiffness, damping } = self.rule.bushing;
        self.resist(ring, shoes, 0.5 * h, damping + 0.5 * h * stiffness);
        if self.rule.sprocket.is_none() {
            let (center, _) = state.mass_pose_after(0.5 * h);
            find_grasps(&mut ring.grasps, &self.rule, &middle, (chassis, center));
        }
        self.middle = middle;
        ring.slide = self.tensioner(state.idlers[self.rule.number].travel, h, 0.5 * h);
    }

    /// Prepares the solve after it: pins hold where they are now, and their forces over the whole step act where they were in
    /// its middle.
    pub(in crate::dynamics) fn hold(
        &mut self,
        ring: &mut Ring,
        state: &State,
        free: &[f64],
        h: f64,
    ) {
        let shoes = &state.shoes[self.rule.shoes.clone()];
        let mut middle = std::mem::take(&mut self.middle);
        middle.clear();
        middle.extend(shoes.iter().map(|shoe| shoe.after(-0.5 * h)));
        self.turn_pins(&middle);
        self.middle = middle;
        for (hinge, pin) in ring.hinges.iter_mut().zip(&self.pins) {
            hinge.pushed_at = pin.arms;
        }
        self.resist(ring, &self.middle, h, self.rule.bushing.damping);
        self.measure_gaps(shoes);
        self.inertias.fill(self.rule.shoe_inertia);
        ring.start(&self.inertias, free);
        for (hinge, pin) in ring.hinges.iter_mut().zip(&self.pins) {
            (hinge.ends, hinge.velocity) = (pin.arms, Vector::ZERO);
        }
        ring.slide = self.tensioner(state.idlers[self.rule.number].travel, h, h);
    }

    /// Makes the bushings of the pins act for a time [s], with torques by the angles between these shoes and a `damping`
    /// [N m s/rad] by their rates. The pin that closes the chain has no bushing.
    fn resist(&self, ring: &mut Ring, shoes: &[Shoe], time: f64, damping: f64) {
        let Bushing { stiffness, .. } = self.rule.bushing;
        if stiffness == 0.0 && damping == 0.0 {
            return;
        }
        for (hinge, pair) in ring.hinges.iter_mut().zip(shoes.windows(2)) {
            let torque = -stiffness * pair[0].bend(&pair[1]);
            hinge.twist = Damper::new(time * torque, time * damping);
        }
    }

    /// Gives each shoe a moment of inertia with which it turns in the first half of a motion of `h` [s] as if the torques of
    /// its pins changed with its angle. Otherwise a light shoe under strong tension would swing wider with each step.
    pub(super) fn stiffen(&mut self, h: f64) {
        self.inertias.fill(0.0);
        let count = self.pins.len();
        for (i, pin) in self.pins.iter().enumerate() {
            let [own, next] = pin.straightens();
            self.inertias[i] += own;
            self.inertias[(i + 1) % count] += next;
        }
        for inertia in &mut self.inertias {
            *inertia = self.rule.shoe_inertia + 0.25 * h * h * inertia.max(0.0);
        }
    }

    /// Turns the pins' arms with the shoes.
    fn turn_pins(&mut self, shoes: &[Shoe]) {
        self.alongs.clear();
        self.alongs.extend(shoes.iter().map(Shoe::along));
        for (i, pin) in self.pins.iter_mut().enumerate() {
            let next = (i + 1) % shoes.len();
            pin.turn([self.alongs[i], self.alongs[next]], self.rule.path.pitch);
        }
    }

    /// Measures the gaps of the pins.
    fn measure_gaps(&mut self, shoes: &[Shoe]) {
        self.turn_pins(shoes);
        for (i, pin) in self.pins.iter_mut().enumerate() {
            let next = (i + 1) % shoes.len();
            pin.measure([shoes[i].center, shoes[next].center]);
        }
    }

    /// The impulse of the idler's spring and damper over a `time` [s], from a travel [m] and implicitly over a motion of `h`
    /// [s]; its stop is a stiff spring.
    pub(super) fn tensioner(&self, travel: f64, h: f64, time: f64) -> Damper {
        let Tensioner {
            pre_tension,
            stiffness,
            damping,
            stop,
        } = self.rule.tensioner;
        let force = pre_tension - stiffness * travel;
        let beyond = -travel - stop;
        if beyond <= 0.0 {
            return Damper::new(time * force, time * (damping + h * stiffness));
        }
        let hard = STOP_STIFFNESS * stiffness;
        let force = force + hard * beyond;
        Damper::new(time * force, time * (damping + h * (stiffness + hard)))
    }
}
