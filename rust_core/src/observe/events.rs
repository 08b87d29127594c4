//! The outcome of a run, and its events that have a beginning and an end: stops, and intrusions of edges into the
//! track.

#[cfg(test)]
mod tests;

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::contact::Intrusion;
use crate::names::named;
use crate::terrain::{Profile, Side};

named! {
    /// The kind of an event.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    pub enum EventKind {
        /// A span of time without progress although a speed is commanded.
        Stop = "stop",
        /// A span of time in which an edge was inside the envelope of the track.
        Intrusion = "intrusion",
    }
}

/// One event; a stop carries the data of the most loaded intrusion present at its end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// Kind of the event.
    pub kind: EventKind,
    /// [s] Beginning.
    pub start: f64,
    /// [s] End; the end of the run if it was still going on.
    pub end: f64,
    /// Lane of the edge; without an edge, the lane under both tracks.
    pub side: Side,
    /// Edge inside the envelope, or -1.
    pub edge: i32,
    /// Bodies on either side of the edge, in the order in which the belt passes them; none without an edge.
    pub bodies: Option<[usize; 2]>,
    /// [m] Largest depth below the belt round the circumscribed circles.
    pub depth: f64,
    /// [m] Largest depth below the belt round the root circles.
    pub root_depth: f64,
    /// [N] Normal force of the robot on the piece, mean over the event.
    pub force: f64,
}

impl Event {
    /// Whether a robot with this number of parts on these lanes can have produced it.
    pub(crate) fn fits(&self, parts: usize, lanes: &[Profile]) -> bool {
        let numbers = [
            self.start,
            self.end,
            self.depth,
            self.root_depth,
            self.force,
        ];
        let edges = lanes.iter().map(|lane| lane.edges.len()).max();
        self.bodies
            .is_none_or(|pair| pair.iter().all(|b| *b < parts))
            && (-1..edges.unwrap_or(0) as i32).contains(&self.edge)
            && numbers.iter().all(|number| number.is_finite())
    }

    /// A stop, with the intrusion present.
    pub(crate) fn stop(start: f64, end: f64, inside: Option<&Self>) -> Self {
        let nothing = || Self::new(start, Side::Both, -1, None);
        Self {
            kind: EventKind::Stop,
            start,
            end,
            ..inside.cloned().unwrap_or_else(nothing)
        }
    }

    /// An intrusion that begins, of no depth yet.
    fn new(start: f64, side: Side, edge: i32, bodies: Option<[usize; 2]>) -> Self {
        Self {
            kind: EventKind::Intrusion,
            start,
            end: start,
            side,
            edge,
            bodies,
            depth: 0.0,
            root_depth: 0.0,
            force: 0.0,
        }
    }
}

/// Tracks intrusions from check to check.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct IntrusionWatch {
    present: Vec<OngoingIntrusion>,
    past: Vec<Event>,
}

/// An intrusion that has not ended.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct OngoingIntrusion {
    event: Event,
    /// Edges inside at the last check.
    edges: Vec<i32>,
    looks: f64,
    is_present: bool,
}

impl IntrusionWatch {
    /// Processes the intrusions at `time`, each with the force [N] on it.
    pub(crate) fn look(&mut self, time: f64, inside: impl Iterator<Item = (Intrusion, f64)>) {
        for (intrusion, force) in inside {
            let same = |p: &&mut OngoingIntrusion| {
                p.event.bodies == Some(intrusion.bodies)
                    && p.edges.iter().any(|edge| intrusion.edges.contains(edge))
            };
            if let Some(known) = self.present.iter_mut().find(same) {
                known.add(&intrusion, force);
            } else {
                let mut new = OngoingIntrusion::new(time, &intrusion);
                new.add(&intrusion, force);
                self.present.push(new);
            }
        }
        for i in (0..self.present.len()).rev() {
            let known = &mut self.present[i];
            known.event.end = time;
            if !std::mem::take(&mut known.is_present) {
                self.past.push(self.present.remove(i).event);
            }
        }
    }

    /// Whether a robot with this number of parts on these lanes can have produced it.
    pub(crate) fn fits(&self, parts: usize, lanes: &[Profile]) -> bool {
        let present = self.present.iter().map(|p| &p.event);
        let looks = self.present.iter().all(|p| p.looks >= 1.0);
        looks
            && self
                .past
                .iter()
                .chain(present)
                .all(|e| e.fits(parts, lanes))
    }

    /// The most loaded intrusion that has not ended.
    pub(crate) fn most_loaded(&self) -> Option<&Event> {
        let present = self.present.iter().map(|p| &p.event);
        present.reduce(|most, other| {
            if other.force > most.force {
                other
            } else {
                most
            }
        })
    }

    /// All intrusions so far; those still going on end at `now`.
    pub(crate) fn events(&self, now: f64) -> impl Iterator<Item = Event> {
        let present = self.present.iter().map(move |p| Event {
            end: now,
            ..p.event.clone()
        });
        self.past.iter().cloned().chain(present)
    }
}

impl OngoingIntrusion {
    fn new(time: f64, intrusion: &Intrusion) -> Self {
        let Intrusion {
            side, edge, bodies, ..
        } = *intrusion;
        Self {
            event: Event::new(time, side, edge, Some(bodies)),
            edges: Vec::new(),
            looks: 0.0,
            is_present: false,
        }
    }

    fn add(&mut self, intrusion: &Intrusion, force: f64) {
        self.looks += 1.0;
        self.is_present = true;
        self.edges.clone_from(&intrusion.edges);
        let e = &mut self.event;
        if intrusion.depth > e.depth {
            (e.depth, e.edge) = (intrusion.depth, intrusion.edge);
        }
        e.root_depth = e.root_depth.max(intrusion.root_depth);
        e.force += (force - e.force) / self.looks;
    }
}

named! {
    /// The outcome of a run; if several apply, the first in this list counts.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    pub enum Outcome {
        /// The chain of the track has come off its guide.
        Detracked = "detracked",
        /// The chassis turned past its balance point.
        TippedOver = "tipped_over",
        /// An end axle left the terrain.
        LeftTerrain = "left_terrain",
        /// The robot is past the goal.
        Cleared = "cleared",
        /// Stopped by ground in a pocket of the track: with a closed track, the robot gets free.
        Seized = "seized",
        /// The robot moves to and fro without progress.
        Cycling = "cycling",
        /// Stopped with weight on the belly.
        HungUp = "hung_up",
        /// Stopped by the torque limit.
        Stalled = "stalled",
        /// Stopped with the surfaces turning.
        Slipping = "slipping",
        /// The time ran out while the robot was still moving.
        TimedOut = "timed_out",
    }
}

impl Outcome {
    /// Whether the robot made no progress although a speed was commanded.
    pub fn is_stop(self) -> bool {
        matches!(
            self,
            Self::Seized | Self::Cycling | Self::HungUp | Self::Stalled | Self::Slipping
        )
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
