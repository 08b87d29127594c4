//! The unknowns: the velocities of all bodies.
//!
//! The equations: docs/physics.md, "The problem".

use super::direction::Direction;
use super::twist::Twist;

/// Bodies hinged to the base, at most.
pub(super) const JOINTS: usize = 2;

/// The velocities of all bodies, or changes of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Velocities {
    pub base: Twist,
    /// [rad/s] Of bodies hinged to the base.
    pub joints: [f64; JOINTS],
    /// [rad/s] Of bodies that spin on the base, or on what is hinged to it.
    pub spins: Vec<f64>,
    /// Of the links of all rings, ring by ring.
    pub links: Vec<Twist>,
    /// [m/s] Of what slides on the base, one in each ring.
    pub slides: Vec<f64>,
}

impl Velocities {
    /// Adds a share of a change.
    pub(super) fn add(&mut self, change: &Self, share: f64) {
        self.base = self.base.plus(change.base, share);
        let joints = self.joints.iter_mut().zip(&change.joints);
        let spins = self.spins.iter_mut().zip(&change.spins);
        let slides = self.slides.iter_mut().zip(&change.slides);
        for (rate, change) in joints.chain(spins).chain(slides) {
            *rate += change * share;
        }
        for (link, change) in self.links.iter_mut().zip(&change.links) {
            *link = link.plus(*change, share);
        }
    }
}

/// Velocities of all bodies, however they are kept.
pub(crate) trait HasVelocities {
    fn base(&self) -> Twist;
    fn joint(&self, joint: usize) -> f64;
    fn spin(&self, spin: usize) -> f64;
    fn link(&self, link: usize) -> Twist;
    fn slide(&self, ring: usize) -> f64;
}

impl HasVelocities for Velocities {
    fn base(&self) -> Twist {
        self.base
    }

    fn joint(&self, joint: usize) -> f64 {
        self.joints[joint]
    }

    fn spin(&self, spin: usize) -> f64 {
        self.spins[spin]
    }

    fn link(&self, link: usize) -> Twist {
        self.links[link]
    }

    fn slide(&self, ring: usize) -> f64 {
        self.slides[ring]
    }
}

/// A link of a ring: its number among the links of all rings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    pub ring: usize,
    pub number: usize,
}

/// The bodies on which a constraint acts.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ActsOn {
    /// The base, or what is hinged to it, and what spins on either.
    Base {
        joint: Option<usize>,
        spin: Option<usize>,
    },
    Link(Link),
    /// A link, and the slide of its ring; the base takes the reaction.
    LinkAndSlide(Link),
    /// A link, and a body that spins on the base; the base takes the reaction at the axle.
    LinkAndSpin {
        link: Link,
        spin: usize,
    },
}

impl ActsOn {
    /// On the base, and what spins on it.
    pub(crate) fn on_spin(spin: usize) -> Self {
        Self::Base {
            joint: None,
            spin: Some(spin),
        }
    }

    /// On the base, and what is hinged to it.
    pub(crate) fn on_joint(joint: usize) -> Self {
        Self::Base {
            joint: Some(joint),
            spin: None,
        }
    }

    /// The direction of the rate over the base of what spins there or is hinged to it, at a lever [m].
    pub(super) fn over_base(self, lever: f64) -> Direction {
        let of = |body: Option<usize>| body.map_or(0.0, |_| lever);
        Direction {
            lever: -lever,
            spin_lever: of(self.spin()),
            joint_lever: of(self.joint()),
            ..Direction::default()
        }
    }

    /// [m/s] Speed along a direction, without its offset.
    pub(crate) fn speed(self, along: &Direction, of: &impl HasVelocities) -> f64 {
        let of_link = |link: Link, beside: f64| {
            let base = of.base();
            let reaction = along.unit.dot(base.velocity) + along.back * base.turn;
            along.on(of.link(link.number)) + along.spin_lever * beside - reaction
        };
        match self {
            Self::Base { joint, spin } => {
                let turning = along.on(of.base());
                let spinning = spin.map_or(0.0, |k| along.spin_lever * of.spin(k));
                turning + spinning + joint.map_or(0.0, |k| along.joint_lever * of.joint(k))
            }
            Self::Link(link) => along.on(of.link(link.number)),
            Self::LinkAndSlide(link) => of_link(link, of.slide(link.ring)),
            Self::LinkAndSpin { link, spin } => of_link(link, of.spin(spin)),
        }
    }

    /// The body on the base that spins there.
    pub(super) fn spin(self) -> Option<usize> {
        match self {
            Self::Base { spin, .. } => spin,
            _ => None,
        }
    }

    /// The body hinged to the base.
    pub(super) fn joint(self) -> Option<usize> {
        match self {
            Self::Base { joint, .. } => joint,
            _ => None,
        }
    }
}
