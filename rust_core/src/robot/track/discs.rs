//! The discs of an outline bend the track: none lies inside the belt round the others.

use crate::geometry::{Disc, Envelope};
use crate::scenario::{ScenarioError, TrackOutline};

/// [rad] Smaller bends are within rounding of none.
const LEAST_BEND: f64 = 1e-6;

/// Checks that the track bends round every disc.
///
/// # Errors
/// A disc lies inside the hull of the others, or only touches it.
pub(super) fn check(outline: &TrackOutline) -> Result<(), ScenarioError> {
    if outline.discs.len() == 2 {
        return Ok(()); // neither lies in the other, so both bend it
    }
    let discs: Vec<Disc> = outline.discs.iter().copied().map(Disc::from).collect();
    let bends = Envelope::new(&discs).bends(discs.len());
    let Some(idle) = bends.iter().position(|bend| *bend < LEAST_BEND) else {
        return Ok(());
    };
    let [x, y, radius] = outline.discs[idle];
    let rule =
        "must reach out of the hull of the others: a track round them would not bend round it";
    Err(ScenarioError::new(
        format!("robot.outline.discs[{idle}]"),
        format!("[{x}, {y}, {radius}]"),
        rule,
    ))
}
