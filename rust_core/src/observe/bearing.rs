//! A signature of what bears: while it is the same, the same parts bear on the same places.

use crate::contact::Contact;

/// The signature of the loaded contacts; their order does not matter.
pub(super) fn signature(loaded: &[Contact]) -> u64 {
    let bearing = loaded.iter().filter(|l| l.normal_force > 0.0);
    sum(bearing.map(|l| {
        // Nor does it matter on which side of a vertex an edge was found.
        let place = if l.edge >= 0 {
            l.edge as u64 + (1 << 32)
        } else {
            l.facet as u64
        };
        (l.part as u64, place)
    }))
}

/// Part and place are mixed before they are summed: otherwise two parts could swap places unnoticed.
fn sum(bearing: impl Iterator<Item = (u64, u64)>) -> u64 {
    let mixed = bearing.map(|(part, place)| mix(mix(part) ^ place));
    mixed.fold(0, u64::wrapping_add)
}

/// Spreads each bit over all of them (the finaliser of splitmix64).
fn mix(bits: u64) -> u64 {
    let z = bits.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::contact::Contact;
    use crate::geometry::Vector;

    /// Parts that bear on facets, each with this force [N].
    fn on_facets(bearing: &[(usize, usize)], force: f64) -> Vec<Contact> {
        let loaded = |(part, facet): &(usize, usize)| Contact {
            normal_force: force,
            ..Contact::new(*part, (*facet, -1), (Vector::ZERO, Vector::Y), 0.0)
        };
        bearing.iter().map(loaded).collect()
    }

    fn of(bearing: &[(usize, usize)]) -> u64 {
        signature(&on_facets(bearing, 1.0))
    }

    #[test]
    fn wheels_that_swap_their_facets_are_seen() {
        assert_ne!(of(&[(0, 5), (1, 6)]), of(&[(0, 6), (1, 5)]));
        assert_ne!(of(&[(0, 1), (1, 0)]), of(&[(0, 0), (1, 1)]));
    }

    #[test]
    fn parts_256_apart_are_told_from_each_other() {
        assert_ne!(of(&[(1, 4)]), of(&[(257, 4)]));
        assert_ne!(of(&[(256, 4)]), of(&[(0, 5)]));
    }

    #[test]
    fn edges_are_told_from_facets_but_not_by_the_facet_they_were_found_on() {
        let on_edge = |facet| {
            let mut loaded = on_facets(&[(3, facet)], 1.0);
            loaded[0].edge = 7;
            signature(&loaded)
        };
        assert_eq!(on_edge(6), on_edge(7));
        assert_ne!(on_edge(7), of(&[(3, 7)]));
    }

    #[test]
    fn neither_order_nor_what_bears_nothing_matters() {
        let two = [(0, 5), (1, 6)];
        assert_eq!(of(&two), of(&[(1, 6), (0, 5)]));
        let mut loaded = on_facets(&two, 1.0);
        loaded.extend(on_facets(&[(2, 7)], 0.0));
        assert_eq!(signature(&loaded), of(&two));
    }

    #[test]
    fn no_two_pairs_of_parts_and_facets_are_taken_for_each_other() {
        let parts = (0..400).flat_map(|part| (0..200).map(move |facet| (part, facet)));
        let seen: HashSet<u64> = parts.map(|bears| of(&[bears])).collect();
        assert_eq!(seen.len(), 400 * 200);
    }
}
