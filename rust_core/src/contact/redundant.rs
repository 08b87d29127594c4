//! Removes redundant contacts.
//!
//! An overlap of two corners has up to four ways out, one along the normal of each face that meets there; the shortest
//! is the contact. On finely divided ground, a disc bears on few of the places near it. A rigid part comes down on the
//! outer ones of several contacts with the same normal.
//!
//! The equations: docs/physics.md, "Contacts".

use super::Contact;
use super::lane::{Corner, Lane, On, ROUNDING, Touch};
use crate::geometry::{Disc, Vector, is_between, right_of};
use crate::terrain::STRAIGHT;
use crate::units::Metres;

/// Cosine of the angle within which two normals of an overlap both count: nearly parallel faces bear at both ends
/// of their overlap.
const ALIKE_COSINE: f64 = 0.94;
/// [rad] If a face and a run of a part are parallel within this angle, both ends of the run bear on it.
pub(super) const NEARLY_PARALLEL: f64 = 0.05;

/// A sharp corner of a part.
#[derive(Clone, Copy)]
pub(super) struct Tip {
    /// [m] Its position.
    pub place: Vector,
    /// Outward normals of the runs before and behind it, counter-clockwise.
    pub normals: [Vector; 2],
}

impl Tip {
    /// Whether a direction is an outward normal of the part at the tip, within rounding.
    pub(super) fn has_normal(&self, direction: Vector) -> bool {
        is_between(direction, self.normals, ROUNDING)
    }

    /// Whether it can bear there until the part has turned further: above a face in any orientation, and inside a face
    /// if the part lies nearly flat on it.
    pub(super) fn may_bear(&self, touch: &Touch) -> bool {
        match touch.on {
            On::Face(_) => {
                touch.distance > 0.0 || is_between(-touch.normal, self.normals, NEARLY_PARALLEL)
            }
            On::Corner(_) => self.has_normal(-touch.normal),
        }
    }
}

/// Whether a tip inside a face of the ground has a shorter way out than that face.
pub(super) fn tip_yields(lane: &Lane, tip: &Tip, touch: &Touch) -> bool {
    outer_ends(lane, touch).any(|(corner, beside)| {
        let is_gap = |depth: f64| is_gap(depth, (tip.place - corner.center).length());
        let below = (corner.center - tip.place).dot(beside) + corner.radius;
        let leaves_face = || tip.has_normal(-beside);
        let leaves_run = |m: &Vector| {
            let spoke = tip.place - (corner.center - *m * corner.radius);
            let beyond = spoke.dot(*m);
            let leaves = || corner.has_normal(-*m);
            let holds_corner = || tip.normals.iter().all(|m| spoke.dot(*m) > 0.0);
            (is_gap(beyond) && leaves()) || (shorter(touch, -*m, beyond, leaves) && holds_corner())
        };
        // If there is a gap to a face or run that could meet them, they have not met at all.
        (is_gap(below) && leaves_face())
            || shorter(touch, beside, below, leaves_face)
            || tip.normals.iter().any(leaves_run)
    })
}

/// The convex corners at both ends of a face behind which something is, each with the normal of the adjacent face.
fn outer_ends<'a>(lane: &'a Lane, touch: &Touch) -> impl Iterator<Item = (&'a Corner, Vector)> {
    let face = match touch.on {
        On::Face(face) if touch.distance < 0.0 => Some(face),
        _ => None,
    };
    let ends = face.into_iter().flat_map(|face| [(face, 0), (face + 1, 1)]);
    let corners = ends.map(|(i, side)| (lane.corner(i), side));
    corners
        .filter(|(corner, _)| corner.is_convex)
        .map(|(corner, side)| (corner, corner.normals[side]))
}

/// Whether a corner of the ground inside a run of a part that ends in `tip` has a shorter way out than that
/// run.
pub(super) fn run_yields(lane: &Lane, outward: Vector, tip: &Tip, touch: &Touch) -> bool {
    let On::Corner(i) = touch.on else {
        return false;
    };
    let corner = lane.corner(i);
    if touch.distance >= 0.0 || !corner.is_convex {
        return false;
    }
    let [before, behind] = tip.normals;
    let beside = if outward == before { behind } else { before };
    let below = (tip.place - corner.center).dot(beside) + corner.radius;
    let is_apart = is_gap(below, (tip.place - corner.center).length());
    if is_apart && corner.has_normal(-beside) {
        return true;
    }
    let beyond = |normal: Vector| (corner.center - tip.place).dot(normal) + corner.radius;
    shorter(touch, -beside, below, || corner.has_normal(-beside))
        || corner
            .normals
            .iter()
            .any(|n| shorter(touch, *n, beyond(*n), || tip.has_normal(-*n)))
}

/// Whether two corners `apart` [m] have not met, because one is outside a face of the other by more than rounding of
/// its normal explains.
fn is_gap(depth: f64, apart: f64) -> bool {
    depth < -ROUNDING * apart
}

/// Whether a way out of length `depth` along `normal` is open, and shorter than that of `touch`.
fn shorter(touch: &Touch, normal: Vector, depth: f64, open: impl Fn() -> bool) -> bool {
    0.0 < depth && depth < -touch.distance && normal.dot(touch.normal) < ALIKE_COSINE && open()
}

/// [m] A contact whose normal passes this close to the centre of a disc is one of the disc.
const ON_DISC: Metres = Metres(1e-9);
/// So few contacts are not thinned out.
const FEW: usize = 4;

/// Keeps, among the contacts of a disc from number `first` on, those that it can reach within `prediction` [m], if the
/// ground there is finely divided. A corner of a part is a disc of radius 0.
///
/// The normals of all contacts of a disc pass through its centre, so only the displacement of its centre matters.
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

/// A subset of a disc's contacts that, after any displacement of up to `far` [m], keeps it out of all contacts within
/// `STRAIGHT`.
fn reachable(contacts: Vec<Contact>, far: f64) -> Vec<Contact> {
    let Some(first) = deepest(&contacts, Vector::ZERO) else {
        return contacts;
    };
    let mut range = Displacements::around(far);
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
struct Displacements {
    /// Counter-clockwise.
    corners: Vec<Vertex>,
}

struct Vertex {
    /// [m]
    at: Vector,
    is_checked: bool,
}

impl Displacements {
    /// All displacements by up to a distance [m] along x and y.
    fn around(far: f64) -> Self {
        let ends = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        let corner = |(x, y)| Vertex {
            at: Vector::new(x, y) * far,
            is_checked: false,
        };
        Self {
            corners: ends.map(corner).into(),
        }
    }

    /// Keeps the displacements at which the gap of a contact is open. parry's clipping does not say which corners are
    /// new.
    fn cut(&mut self, contact: &Contact) {
        let old = std::mem::take(&mut self.corners);
        let gaps: Vec<f64> = old.iter().map(|c| gap_after(contact, c.at)).collect();
        for (i, corner) in old.iter().enumerate() {
            let next = (i + 1) % old.len();
            if gaps[i] >= 0.0 {
                self.corners.push(Vertex { ..*corner });
            }
            if (gaps[i] >= 0.0) != (gaps[next] >= 0.0) {
                let fraction = gaps[i] / (gaps[i] - gaps[next]);
                self.corners.push(Vertex {
                    at: corner.at + (old[next].at - corner.at) * fraction,
                    is_checked: false,
                });
            }
        }
    }
}

/// Removes redundant contacts: duplicates on the same part, and contacts between two others with the same normal
/// that are no deeper than these, since a rigid part comes down on its outer contacts first.
pub(super) fn without_redundant(contacts: &mut Vec<Contact>) {
    /// Normals closer than this count as equal; f64 resolves about 1e-16.
    const SAME_DIRECTION: f64 = 1e-12;

    // A stable order: by part, then from the left, so that neighbours are adjacent.
    contacts.sort_by(|a, b| a.part.cmp(&b.part).then(a.point.x.total_cmp(&b.point.x)));
    let same = |a: &Contact, b: &Contact| {
        a.part == b.part && 1.0 - a.normal.dot(b.normal) < SAME_DIRECTION
    };
    contacts.dedup_by(|b, a| same(a, b) && (a.point - b.point).length() < 1e-9);
    let is_covered = |first: &Contact, middle: &Contact, last: &Contact| {
        same(first, middle) && same(middle, last) && lies_above(first, middle, last)
    };
    let mut kept = 0;
    for i in 0..contacts.len() {
        while kept >= 2 && is_covered(&contacts[kept - 2], &contacts[kept - 1], &contacts[i]) {
            kept -= 1;
        }
        contacts[kept] = contacts[i];
        kept += 1;
    }
    contacts.truncate(kept);
}

/// Whether the middle gap is at least that of the chord between its neighbours.
fn lies_above(first: &Contact, middle: &Contact, last: &Contact) -> bool {
    /// [m] A gap this close to the chord is on the same face.
    const ON_CHORD: Metres = Metres(1e-9);

    let along = right_of(middle.normal);
    let (a, b) = (
        (middle.point - first.point).dot(along),
        (last.point - middle.point).dot(along),
    );
    let chord = (first.distance * b + last.distance * a) / (a + b);
    a * b > 0.0 && middle.distance > chord - ON_CHORD.value()
}

#[cfg(test)]
mod tests;
