//! Contacts between the robot's parts and the ground.
//!
//! The equations: docs/physics.md, "Contacts", and what a step has found: docs/physics.md, "State".

mod finder;
mod gear;
mod hull;
mod intrusion;
mod lane;
mod penetration;
mod redundant;
mod reference;

use serde::{Deserialize, Serialize};

use crate::geometry::{Vector, plausible, plausible_vectors, right_of};
use crate::robot::Model;
use crate::solver::Grip;
use crate::terrain::Profile;

pub(crate) use finder::ContactFinder;
pub use intrusion::Intrusion;
pub(crate) use intrusion::TrackEnvelope;
pub(crate) use penetration::{Dents, depth};
pub(crate) use reference::solids_of;

/// A place where a part touches the ground or is about to, with the results of the last step.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Contact {
    /// Index of the part.
    pub part: usize,
    /// Facet of the profile, from the left.
    pub facet: usize,
    /// Id of the edge that is touched, or -1 on a face.
    pub edge: i32,
    /// [m] The point halfway between both surfaces.
    pub point: Vector,
    /// Unit normal from the ground to the robot.
    pub normal: Vector,
    /// [m] Gap; negative in penetration.
    pub distance: f64,
    /// Unique number that stays the same from step to step while the contact lasts; 0 when just found.
    pub number: u64,
    /// [m] The point at which the contact closed.
    pub began: Vector,
    /// [N] Mean normal force over the step; 0 when just found, like all following values.
    pub normal_force: f64,
    /// [N] Mean friction on the robot over the step, along the normal turned by -90 degrees.
    pub friction_force: f64,
    /// [m/s] Velocity of the surface relative to the ground in the same direction.
    pub surface_speed: f64,
    /// [N] Normal force from which the next step starts.
    pub normal_guess: f64,
    /// [N] Friction from which the next step starts.
    pub friction_guess: f64,
    /// Its last grip.
    pub grip: Grip,
}

impl Contact {
    /// A contact that has not carried a load yet.
    pub(crate) fn new(
        part: usize,
        (facet, edge): (usize, i32),
        (point, normal): (Vector, Vector),
        distance: f64,
    ) -> Self {
        Self {
            part,
            facet,
            edge,
            point,
            normal,
            distance,
            number: 0,
            began: point,
            normal_force: 0.0,
            friction_force: 0.0,
            surface_speed: 0.0,
            normal_guess: 0.0,
            friction_guess: 0.0,
            grip: Grip::Open,
        }
    }

    /// [N] Force on the robot.
    pub(crate) fn force(&self) -> Vector {
        self.normal * self.normal_force + right_of(self.normal) * self.friction_force
    }

    /// Whether its part and ground exist in a robot and its lanes, and its forces are plausible.
    pub(crate) fn fits(&self, model: &Model, lanes: &[Profile]) -> bool {
        let lane = model.parts.get(self.part).and_then(|p| lanes.get(p.lane));
        lane.is_some_and(|lane| {
            let edges = -1..lane.edges.len() as i32;
            self.facet + 1 < lane.points.len() && edges.contains(&self.edge)
        }) && plausible_vectors(&[self.point, self.normal, self.began])
            && plausible(&[
                self.distance,
                self.normal_force,
                self.friction_force,
                self.surface_speed,
                self.normal_guess,
                self.friction_guess,
            ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Surface, shared};

    #[test]
    fn a_force_is_along_the_normal_and_across_it() {
        let mut contact = Contact::new(0, (0, -1), (Vector::ZERO, Vector::Y), 0.0);
        (contact.normal_force, contact.friction_force) = (2.0, 3.0);
        assert_eq!(contact.force(), Vector::new(3.0, 2.0));
    }

    #[test]
    fn a_contact_fits_a_robot_and_a_ground_that_have_its_part_its_facet_and_its_edge() {
        let robot = shared("engineer_belt_step").robot;
        let model = Model::new(&robot).expect("it can be built");
        let points = [[-1.0, 0.0], [0.0, 0.0], [0.0, 0.1], [1.0, 0.1]];
        let lane = Profile::new("terrain", &points, Surface::sharp(0.9), true);
        let lanes = [lane.expect("it is ground")];
        let fits = |part: usize, facet: usize, edge: i32| {
            let place = (Vector::ZERO, Vector::Y);
            Contact::new(part, (facet, edge), place, 0.0).fits(&model, &lanes)
        };
        let count = model.parts.len();
        assert!(fits(0, 0, -1) && fits(count - 1, 2, 1));
        assert!(!fits(count, 0, -1) && !fits(0, 3, -1));
        assert!(!fits(0, 0, -2) && !fits(0, 0, 2));
        let mut one = Contact::new(0, (0, -1), (Vector::ZERO, Vector::Y), 0.0);
        let numbers: [fn(&mut Contact) -> &mut f64; 12] = [
            |c| &mut c.distance,
            |c| &mut c.normal_force,
            |c| &mut c.friction_force,
            |c| &mut c.surface_speed,
            |c| &mut c.normal_guess,
            |c| &mut c.friction_guess,
            |c| &mut c.point.x,
            |c| &mut c.point.y,
            |c| &mut c.normal.x,
            |c| &mut c.normal.y,
            |c| &mut c.began.x,
            |c| &mut c.began.y,
        ];
        for number in numbers {
            let before = std::mem::replace(number(&mut one), f64::NAN);
            assert!(!one.fits(&model, &lanes));
            *number(&mut one) = before;
        }
        assert!(one.fits(&model, &lanes) && !one.fits(&model, &[]));
    }
}
