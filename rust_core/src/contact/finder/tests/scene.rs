//! A random part over random ground.

use std::f64::consts::TAU;
use std::slice::from_ref;

use super::super::OwnContact;
use super::grounds::{self, Ground};
use super::judge::{Approach, Judge};
use super::outlines::{self, Outline};
use crate::contact::Contact;
use crate::draw::Draw;
use crate::geometry::{Pose, Rotation, Vector};
use crate::robot::Running;

pub(super) struct Scene {
    pub name: String,
    pub ground: Ground,
    pub outline: Outline,
    pub contact: OwnContact,
    pub pose: Pose,
    /// [m] Travel of the drive.
    pub drive: f64,
}

impl Scene {
    /// A part that does not touch the ground, but is near some of it.
    pub(super) fn random(number: usize, draw: &mut Draw) -> Self {
        let name = format!("scene {number} of {:#x}", draw.0);
        let left = [0.0, 1e-11, 1e-8, 1e-5];
        let left = (number % 3 == 2).then(|| left[number / 3 % left.len()]);
        let ground = Ground::random(draw.below(grounds::KINDS), left, draw);
        let outline = Outline::random(draw.below(outlines::KINDS), draw);
        let contact = OwnContact::new(from_ref(&outline.part), from_ref(&ground.profile));
        // On a random feature other than the end ones, or on the flat beside it.
        let feature = ground.curves[draw.below(ground.curves.len())];
        let [a, b] = feature.ends();
        let mut place = a + (b - a) * draw.between(0.0, 1.0);
        place.x = place.x.clamp(ground.curves[0].ends()[1].x - 0.1, {
            ground.curves[ground.curves.len() - 1].ends()[0].x + 0.1
        });
        // Sometimes level.
        let turn = if draw.chance(0.1) {
            0.0
        } else {
            draw.between(0.0, TAU)
        };
        let mut scene = Self {
            name,
            ground,
            outline,
            contact,
            pose: Pose::from_rotation(Rotation::new(turn)),
            drive: draw.between(-1.0, 1.0),
        };
        let away = Rotation::new(draw.between(0.05, 0.5 * TAU - 0.05)) * Vector::X;
        let center = scene.pose.transform_point(scene.outline.center);
        scene.push(place + away * (scene.outline.reach * draw.between(0.7, 1.1)) - center);
        while !scene.judge(0.0).is_clear() {
            scene.push((away + Vector::Y) * (0.1 * scene.outline.reach));
        }
        scene
    }

    pub(super) fn push(&mut self, way: Vector) {
        self.pose.translation += way;
    }

    /// Turns the part about its own centre by an angle [rad].
    pub(super) fn turn(&mut self, angle: f64) {
        let center = self.pose.transform_point(self.outline.center);
        self.pose.rotation = Rotation::new(angle) * self.pose.rotation;
        self.push(center - self.pose.transform_point(self.outline.center));
    }

    /// A judge that considers ground within `sight` [m].
    pub(super) fn judge(&self, sight: f64) -> Judge<'_> {
        Judge::new(self.outline.at(self.pose, self.drive), &self.ground, sight)
    }

    /// [m] How far ground may rise above the chord of two contacts without being reported: rounding, or a
    /// micrometre where it is finely divided.
    pub(super) fn unreported(&self) -> f64 {
        if self.ground.curves.len() > 16 {
            1e-6
        } else {
            2e-9
        }
    }

    /// Moves the part along its nearest approach until its gap is at most this [m]; negative for a
    /// penetration.
    pub(super) fn approach(&mut self, gap: f64) -> Approach {
        let nearest = self.judge(1.0).nearest(f64::INFINITY).unwrap();
        self.push(nearest.normal() * (gap - nearest.distance()).min(0.0));
        nearest
    }

    pub(super) fn contacts(&self, prediction: f64) -> Vec<Contact> {
        let mut contacts = Vec::new();
        let running = Running {
            drives: vec![self.drive],
            ..Running::default()
        };
        self.contact
            .find(self.pose, &running, prediction, &mut contacts);
        contacts
    }

    /// Everything needed to reproduce the scene.
    pub(super) fn describe(&self) -> String {
        let points = &self.ground.profile.points;
        let at = self.pose.transform_point(self.outline.center).x;
        let near = |p: &&Vector| (p.x - at).abs() < 1.2 * self.outline.reach;
        let few: Vec<_> = points.iter().filter(near).take(20).collect();
        format!(
            "{}\n part {:?}\n ground {} {few:?}\n pose {:?} angle {:?} drive {:?}",
            self.name,
            self.outline.part.shape,
            self.ground.name,
            self.pose.translation,
            self.pose.rotation.angle(),
            self.drive
        )
    }
}
