//! How the ground inside the track is held.

use super::StopContact;
use crate::scenario::SeizureCriteria;

/// How the ground inside the track is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mechanism {
    /// Two bodies bear on it.
    Straddled,
    /// One body alone bears on it and slides at its friction limit.
    Undercut,
    /// The motors are at their limit.
    Blocked,
    /// The motors are at their limit, with the flank of a grouser against it.
    Interlocked,
    /// It is in the gap between two shoes of a chain, which closes as they move on.
    Pinched,
    /// It has got through a chain of shoes to the guide or wheels that the chain runs on.
    Fouled,
}

impl Mechanism {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Straddled,
        Self::Undercut,
        Self::Blocked,
        Self::Interlocked,
        Self::Pinched,
        Self::Fouled,
    ];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Straddled => "straddled",
            Self::Undercut => "undercut",
            Self::Blocked => "blocked",
            Self::Interlocked => "interlocked",
            Self::Pinched => "pinched",
            Self::Fouled => "fouled",
        }
    }

    /// The first mechanism that the facts show; `None` if one body sticks to the ground and turns with it.
    pub(super) fn of(facts: &Facts, criteria: &SeizureCriteria, weight: f64) -> Option<Self> {
        let on_it = || facts.contacts.iter().filter(|c| c.in_pocket);
        let force_of = |body: usize| -> f64 {
            on_it()
                .filter(|c| c.body == body)
                .map(|c| c.normal_force)
                .sum()
        };
        let least = criteria.intrusion_load * weight;
        let mut bodies: Vec<usize> = on_it().map(|c| c.body).collect();
        bodies.sort_unstable();
        bodies.dedup();
        let bearing = bodies.iter().filter(|b| force_of(**b) > 0.5 * least);
        if on_it().any(|c| c.kind.is_in_chain() && force_of(c.body) > 0.5 * least) {
            Some(Self::Fouled)
        } else if facts.pinched {
            Some(Self::Pinched)
        } else if facts.stalled_share >= 0.5 {
            Some(if facts.flank {
                Self::Interlocked
            } else {
                Self::Blocked
            })
        } else if bearing.count() >= 2 {
            Some(Self::Straddled)
        } else if on_it().any(|c| c.slides) {
            Some(Self::Undercut)
        } else {
            None
        }
    }
}

/// The facts of a stop.
pub(super) struct Facts {
    /// Contacts that bear.
    pub contacts: Vec<StopContact>,
    /// Share of the load that the belly carries.
    pub belly_share: f64,
    /// Share of the normal force that is at sliding contacts.
    pub sliding_share: f64,
    /// Share of the motors that are at their limit.
    pub stalled_share: f64,
    /// The flank of a grouser bears on the ground inside the track.
    pub flank: bool,
    /// Two neighbouring shoes bear on the ground inside the track and are about to close the gap between them.
    pub pinched: bool,
}
