//! Whether neighbouring shoes of a chain pinch the ground between them.

use super::StopContact;
use super::scene::Scene;
use crate::observe::Stance;

/// [rad] Smallest angle between two pinching shoes; on a straight run it is less.
const BENT: f64 = 0.05;
/// Share of the time for which each shoe must bear, so that both do so at once. Shoes that slip past one after
/// another hold nothing.
const STAYS: f64 = 0.5;

impl Scene<'_> {
    /// Whether two neighbouring shoes bear on the ground inside the track where the gap between them is closing: bent
    /// apart, as round an end of the track, and about to be straightened, as at the leading end.
    pub(super) fn pinches(&self, stance: &Stance, contacts: &[StopContact]) -> bool {
        let bearing = stance
            .bearings
            .iter()
            .filter(|b| b.contact.normal_force > 0.0);
        let mut durations = vec![0.0; self.running.shoes.len()];
        for (bearing, contact) in bearing.zip(contacts).filter(|(_, c)| c.in_pocket) {
            if let Some(shoe) = self.model.parts[contact.body].mount.shoe() {
                durations[shoe] += bearing.duration;
            }
        }
        let closes = |one: usize, next: usize| {
            let [a, b] = [one, next].map(|shoe| self.running.shoes[shoe]);
            let bent = (a.rotation.inverse() * b.rotation).angle().abs();
            let middle = 0.5 * (a.translation.x + b.translation.x);
            durations[one].min(durations[next]) > STAYS
                && bent > BENT
                && self.direction() * middle > 0.0
        };
        self.model.chains.iter().any(|chain| {
            let next = |shoe: usize| {
                if shoe + 1 == chain.shoes.end {
                    chain.shoes.start
                } else {
                    shoe + 1
                }
            };
            chain.shoes.clone().any(|shoe| closes(shoe, next(shoe)))
        })
    }
}
