//! Number of bytes that reading and building a scenario takes.

use crate::error::LimitError;
use crate::limits::memory;
use crate::scenario::Terrain;

/// Bytes per corner of the ground and its index during a run; measured: 250, and as much again while they are
/// built.
pub(super) const BYTES_A_CORNER: u64 = 600;
/// Largest number of bytes per character that a parsed text takes: `[0],` is a row of one number.
const BYTES_A_CHARACTER: u64 = 40;

/// Checks that the memory for reading a scenario is available.
pub(crate) fn ask_for_text(text: &str) -> Result<(), LimitError> {
    memory::ask("reading a scenario", text.len() as u64 * BYTES_A_CHARACTER)
}

/// Checks that the memory for building the ground of a scenario is available.
pub(crate) fn ask_for_ground(terrain: &Terrain) -> Result<(), LimitError> {
    memory::ask("the ground", corners(terrain) * BYTES_A_CORNER)
}

/// Largest possible number of corners of a ground, all lanes together, including facets of rounded edges.
pub(super) fn corners(terrain: &Terrain) -> u64 {
    /// Facets of a rounded edge that turns by a right angle, and the maximum of a lane.
    const FACETS: (u64, u64) = (90, 1_000_000);

    let rounded = |corners: u64, radius: f64| {
        if radius > 0.0 {
            corners + (corners * FACETS.0).min(FACETS.1)
        } else {
            corners
        }
    };
    match terrain {
        Terrain::Points {
            points, surface, ..
        } => rounded(points.len() as u64, surface.edge_radius),
        Terrain::Lanes {
            left,
            right,
            middle,
        } => {
            let own = [left, right].map(|lane| corners(lane));
            let of_belly = middle.as_ref().map_or(own[0] + own[1], |m| corners(m));
            own[0] + own[1] + of_belly
        }
        Terrain::Stairs { count, surface, .. } => {
            rounded(2 * u64::from(*count), surface.edge_radius)
        }
        Terrain::RandomStepfield(field) => {
            3 * rounded(2 * u64::from(field.posts), field.surface.edge_radius)
        }
        _ => 1000,
    }
}
