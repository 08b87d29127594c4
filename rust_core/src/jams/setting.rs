//! A robot over a ground: what of it can touch where, and which contacts can be together at which angles.

use super::clear::is_clear;
use super::contact::{Contact, Posture, Turn};
use super::layout::{Layout, Outline};
use super::places::{Facing, Place};
use crate::error::Error;
use crate::geometry::{Vector, is_between};
use crate::limits::Cancel;
use crate::scenario::ScenarioError;
use crate::units::Metres;

/// [m] Gaps up to this are contacts; poses are known to a thousandth of it.
pub(super) const TOUCHING: Metres = Metres(1e-9);
/// [m] and [rad] Poses that differ by less are the same.
const SAME: Metres = Metres(1e-7);
/// So many contacts are sorted into pairs in a few seconds.
const MOST_CONTACTS: usize = 20_000;

/// A robot over a ground.
#[derive(Clone, Debug)]
pub(super) struct Setting {
    pub layout: Layout,
    pub places: Vec<Place>,
    /// All that could touch.
    pub contacts: Vec<Contact>,
    /// For each contact, those of higher index that it can be together with.
    pub partners: Vec<Vec<Partner>>,
    /// Angles at which poses are sought.
    pub bins: Bins,
}

impl Setting {
    /// Poses are sought between two angles [rad].
    ///
    /// # Errors
    /// [`Error::Scenario`] for a ground of too many pieces, [`Error::Interrupted`] once `cancel` is asked.
    pub(super) fn new(
        layout: Layout,
        places: Vec<Place>,
        angles: [f64; 2],
        cancel: &Cancel,
    ) -> Result<Self, Error> {
        let contacts = Contact::all(&layout, &places);
        if contacts.len() > MOST_CONTACTS {
            let rule = format!(
                "must have fewer faces and corners: with those of the robot they make {} contacts, and at most \
                 {MOST_CONTACTS} are searched",
                contacts.len()
            );
            let value = format!("{} faces and corners", places.len());
            return Err(ScenarioError::new("terrain", value, rule).into());
        }
        let bounds: Vec<Reach> = contacts
            .iter()
            .map(|contact| Reach::of(&layout, &places, contact))
            .collect();
        let bins = Bins::between(angles);
        let partners = bounds.iter().enumerate().map(|(i, one)| {
            cancel.check()?;
            let later = bounds.iter().enumerate().skip(i + 1);
            let apart =
                later.filter(|(j, _)| !contacts[i].is_one_with(&contacts[*j], TOUCHING.value()));
            let fitting = apart.map(|(j, other)| Partner {
                contact: j,
                angles: one.angles_with(other, &bins),
            });
            Ok(fitting.filter(|partner| partner.angles != 0).collect())
        });
        Ok(Self {
            partners: partners.collect::<Result<_, Error>>()?,
            layout,
            places,
            contacts,
            bins,
        })
    }

    /// The bins of angles at which two contacts, the first of lower index, can be together.
    pub(super) fn together(&self, one: usize, other: usize) -> u128 {
        let partners = &self.partners[one];
        let found = partners.binary_search_by_key(&other, |partner| partner.contact);
        found.map_or(0, |k| partners[k].angles)
    }

    /// The contacts in place in a pose; `None` if the robot overlaps with the ground there.
    pub(super) fn touching(&self, posture: &Posture) -> Option<Vec<usize>> {
        let touches = |contact: &Contact| {
            contact.touch(posture).gap.abs() <= TOUCHING.value() && self.is_real(contact, posture)
        };
        if !self.is_clear(posture) {
            return None;
        }
        let all = self.contacts.iter().enumerate();
        Some(all.filter(|(_, c)| touches(c)).map(|(i, _)| i).collect())
    }

    /// Whether the robot does not overlap with the ground.
    pub(super) fn is_clear(&self, posture: &Posture) -> bool {
        is_clear(&self.layout, &self.places, posture, TOUCHING.value())
    }

    /// Whether what touches is a piece of the outline and a piece of the ground.
    pub(super) fn is_real(&self, contact: &Contact, posture: &Posture) -> bool {
        contact.is_real(&self.layout, &self.places, posture, TOUCHING.value())
    }
}

/// Whether two poses are the same up to rounding.
pub(super) fn is_same(one: &Posture, other: &Posture) -> bool {
    (one.position - other.position).length() < SAME.value()
        && (one.angle - other.angle).abs() < SAME.value()
}

/// The box in which a point of the robot lies while a surface touches a place: the centre of a disc, the middle of a run.
struct Reach {
    point: Vector,
    low: Vector,
    high: Vector,
}

impl Reach {
    fn of(layout: &Layout, places: &[Place], contact: &Contact) -> Self {
        let surface = &layout.surfaces[contact.surface].shape;
        let (point, far) = match surface {
            Outline::Round(disc) => (disc.center, disc.radius),
            Outline::Flat { ends: [a, b], .. } => ((*a + *b) * 0.5, 0.5 * (*b - *a).length()),
        };
        let ends = match (&places[contact.place].shape, surface) {
            (Facing::Face { ends, normal }, _) => ends.map(|end| end + *normal * far).to_vec(),
            (
                Facing::Corner {
                    center,
                    radius,
                    cone,
                },
                Outline::Round(_),
            ) => {
                let axes = [Vector::X, Vector::Y, Vector::NEG_X, Vector::NEG_Y];
                let inside = axes
                    .into_iter()
                    .filter(|axis| is_between(*axis, *cone, 0.0));
                let directions = cone.iter().copied().chain(inside);
                directions.map(|d| center + d * (radius + far)).collect()
            }
            // The run may lie in any direction.
            (Facing::Corner { center, radius, .. }, Outline::Flat { .. }) => {
                let most = Vector::ONE * (radius + far);
                vec![center - most, center + most]
            }
        };
        let first = ends[0];
        let slack = Vector::ONE * (2.0 * TOUCHING.value());
        Self {
            point,
            low: ends.iter().copied().fold(first, Vector::min) - slack,
            high: ends.iter().copied().fold(first, Vector::max) + slack,
        }
    }

    /// The bins of angles at which both points can be in their boxes.
    fn angles_with(&self, other: &Self, bins: &Bins) -> u128 {
        let between = other.point - self.point;
        let (low, high) = (other.low - self.high, other.high - self.low);
        let distance = between.length();
        let least = low.max(-high).max(Vector::ZERO).length();
        let most = low.abs().max(high.abs()).length();
        if !(least..=most).contains(&distance) {
            return 0;
        }
        let slack = Vector::ONE * (distance * bins.half_width);
        let (low, high) = (low - slack, high + slack);
        let is_in = |v: Vector| v.cmpge(low).all() && v.cmple(high).all();
        let at = bins.middles.iter().enumerate();
        at.filter(|(_, turn)| is_in(turn.apply(between)))
            .fold(0, |bits, (i, _)| bits | 1 << i)
    }
}

/// A contact that another can be together with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Partner {
    pub contact: usize,
    /// The bins of angles.
    pub angles: u128,
}

/// A range of angles, divided into as many bins as an integer has bits.
#[derive(Clone, Debug)]
pub(super) struct Bins {
    low: f64,
    half_width: f64,
    middles: Vec<Turn>,
}

impl Bins {
    fn between([low, high]: [f64; 2]) -> Self {
        let half_width = 0.5 * (high - low) / f64::from(u128::BITS);
        let middle = |i: u32| Turn::by(low + f64::from(2 * i + 1) * half_width);
        Self {
            low,
            half_width,
            middles: (0..u128::BITS).map(middle).collect(),
        }
    }

    /// [rad] The ranges that bins cover together.
    pub(super) fn ranges(&self, bins: u128) -> impl Iterator<Item = [f64; 2]> + use<> {
        let (low, width) = (self.low, 2.0 * self.half_width);
        let mut left = bins;
        let mut from = 0;
        std::iter::from_fn(move || {
            if left == 0 {
                return None;
            }
            let skipped = left.trailing_zeros();
            // All bins together leave nothing to shift.
            left = left.checked_shr(skipped).unwrap_or(0);
            let count = left.trailing_ones();
            left = left.checked_shr(count).unwrap_or(0);
            let first = from + skipped;
            from = first + count;
            Some([first, from].map(|bin| low + f64::from(bin) * width))
        })
    }

    /// Whether an angle is in the range.
    pub(super) fn hold(&self, angle: f64) -> bool {
        let width = 2.0 * self.half_width * f64::from(u128::BITS);
        (self.low..=self.low + width).contains(&angle)
    }
}
