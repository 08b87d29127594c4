//! From the described terrain to the profile that contacts are computed on.

mod obstacle;
mod profile;

use crate::error::ScenarioError;
use crate::scenario::{Scenario, Terrain};
use profile::COLLINEAR;
pub use profile::{Edge, Profile};

/// The ground of a scenario.
#[derive(Clone, Debug)]
pub struct Ground {
    /// One profile under both tracks and the belly (equal lanes are simulated as one).
    pub profile: Profile,
    /// [m] The x that must be left behind.
    pub goal: f64,
    /// [m] Where the obstacle begins: the first edge at or beyond x = 0, else the first of all, else 0.
    pub first_edge: f64,
}

impl Ground {
    /// Builds the ground of a terrain.
    ///
    /// # Errors
    /// A profile that cannot be: overhang, too few points, an edge radius that does not fit.
    pub fn new(terrain: &Terrain) -> Result<Self, ScenarioError> {
        Self::at("terrain", terrain)
    }

    /// [m] The x that the rear axle must leave behind, unless the scenario has its own.
    pub fn goal_of(&self, scenario: &Scenario) -> f64 {
        scenario.goal.unwrap_or(self.goal)
    }

    fn at(path: &str, terrain: &Terrain) -> Result<Self, ScenarioError> {
        if let Terrain::Lanes {
            left,
            right,
            middle,
        } = terrain
        {
            return Self::lanes(path, left, right, middle.as_deref());
        }
        let obstacle = obstacle::of(terrain);
        let goal = obstacle.goal;
        let profile = Profile::new(
            path,
            &obstacle.points,
            obstacle.edge_radius,
            obstacle.friction,
            true,
        )?;
        let edges = &profile.edges;
        let first_edge = edges
            .iter()
            .find(|edge| edge.x >= -COLLINEAR)
            .or(edges.first());
        let first_edge = first_edge.map_or(0.0, |edge| edge.x);
        let ground = Self {
            profile,
            goal,
            first_edge,
        };
        let (low, high) = ground.profile.extent();
        if !(low..=high).contains(&ground.goal) {
            let rule = format!("must lie on the terrain, from {low} to {high} m");
            return Err(ScenarioError::new(format!("{path}.goal"), goal, rule));
        }
        Ok(ground)
    }

    /// Equal lanes are one ground under lumped tracks.
    fn lanes(
        path: &str,
        left: &Terrain,
        right: &Terrain,
        middle: Option<&Terrain>,
    ) -> Result<Self, ScenarioError> {
        let ground = Self::at(&format!("{path}.left"), left)?;
        for (name, lane) in [("right", Some(right)), ("middle", middle)] {
            let Some(lane) = lane else { continue };
            let path = format!("{path}.{name}");
            Self::at(&path, lane)?;
            if lane != left {
                let value = serde_json::to_string(lane).unwrap_or_default();
                return Err(ScenarioError::new(
                    path,
                    value,
                    "must equal the left lane: both tracks are simulated as one",
                ));
            }
        }
        Ok(ground)
    }
}
