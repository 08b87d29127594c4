//! What a disc can reach on finely divided ground: most of the places that it is near to bear nothing, because
//! others hold it off them wherever it goes in a step.
//!
//! The equations: docs/physics.md, "Contacts".

use super::Contact;
use super::lane::Lane;
use crate::geometry::{Disc, Vector};
use crate::terrain::STRAIGHT;
use crate::units::Metres;

/// [m] A contact whose normal passes this close to the centre of a disc is one of the disc.
const ON_DISC: Metres = Metres(1e-9);
/// So few contacts need no thinning out.
const FEW: usize = 4;

/// Leaves, of the contacts of a disc from number `first` on, those that it can reach within `prediction` [m], if
/// the ground there is finely divided. A corner of a part is a disc of radius 0.
///
/// The normals of all contacts of a disc pass through its centre, so only the way of the centre matters.
pub(super) fn thin_out(
    contacts: &mut Vec<Contact>,
    first: usize,
    lane: &Lane,
    disc: &Disc,
    prediction: f64,
) {
    if contacts.len() <= first + FEW || !lane.is_fine(disc.center, disc.radius + prediction) {
        return;
    }
    let of_disc = |c: &mut Contact| {
        let foot = c.point + c.normal * (disc.radius + 0.5 * c.distance);
        (disc.center - foot).length() < ON_DISC.value()
    };
    let own = contacts.extract_if(first.., of_disc).collect();
    contacts.extend(reachable(own, prediction));
}

/// The contacts of a disc that keep it out of all of them, within `STRAIGHT`, wherever it goes by up to `far` [m].
fn reachable(contacts: Vec<Contact>, far: f64) -> Vec<Contact> {
    let Some(first) = deepest(&contacts, Vector::ZERO) else {
        return contacts;
    };
    let mut range = Range::around(far);
    range.cut(&first);
    let mut kept = vec![first];
    while let Some(corner) = range.corners.iter_mut().find(|c| !c.is_checked) {
        corner.is_checked = true;
        let at = corner.at;
        if let Some(contact) = deepest(&contacts, at)
            && gap_after(&contact, at) < -STRAIGHT.value()
        {
            range.cut(&contact);
            kept.push(contact);
        }
    }
    // If they hold the disc from all sides, it is in the ground already.
    if range.corners.is_empty() {
        contacts
    } else {
        kept
    }
}

/// [m] The gap of a contact after a displacement of the disc.
fn gap_after(contact: &Contact, displacement: Vector) -> f64 {
    contact.distance + contact.normal.dot(displacement)
}

/// The contact with the smallest gap after a displacement.
fn deepest(contacts: &[Contact], at: Vector) -> Option<Contact> {
    let gaps = contacts
        .iter()
        .map(|contact| (gap_after(contact, at), contact));
    let least = gaps.reduce(|least, next| if next.0 < least.0 { next } else { least });
    least.map(|(_, contact)| *contact)
}

/// A convex range of displacements.
struct Range {
    /// Counter-clockwise.
    corners: Vec<Corner>,
}

struct Corner {
    /// [m]
    at: Vector,
    is_checked: bool,
}

impl Range {
    /// All displacements by up to a distance [m] along x and y.
    fn around(far: f64) -> Self {
        let ends = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        let corner = |(x, y)| Corner {
            at: Vector::new(x, y) * far,
            is_checked: false,
        };
        Self {
            corners: ends.map(corner).into(),
        }
    }

    /// Leaves the displacements at which the gap of a contact is open.
    fn cut(&mut self, contact: &Contact) {
        let old = std::mem::take(&mut self.corners);
        let gaps: Vec<f64> = old.iter().map(|c| gap_after(contact, c.at)).collect();
        for (i, corner) in old.iter().enumerate() {
            let next = (i + 1) % old.len();
            if gaps[i] >= 0.0 {
                self.corners.push(Corner { ..*corner });
            }
            if (gaps[i] >= 0.0) != (gaps[next] >= 0.0) {
                let share = gaps[i] / (gaps[i] - gaps[next]);
                self.corners.push(Corner {
                    at: corner.at + (old[next].at - corner.at) * share,
                    is_checked: false,
                });
            }
        }
    }
}
