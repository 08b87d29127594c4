//! The law of one contact: Signorini's for the gap, Coulomb's for the slip, a soft push out of penetration.

/// Velocity change at a contact for a unit impulse along normal and tangent.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Admittance {
    pub normal: f64,
    pub tangent: f64,
    /// Normal velocity for a tangent impulse, and the other way round.
    pub cross: f64,
}

/// Coefficients of a damped spring integrated implicitly.
#[derive(Clone, Copy)]
pub(super) struct Softness {
    /// [1/s] Share of a penetration that is pushed out in a second.
    pub push_rate: f64,
    /// Compliance in units of the contact's own admittance.
    pub compliance: f64,
}

impl Softness {
    pub(super) fn new(frequency: f64, damping_ratio: f64, h: f64) -> Self {
        let omega = std::f64::consts::TAU * frequency;
        let a1 = 2.0 * damping_ratio + h * omega;
        Self {
            push_rate: omega / a1,
            compliance: 1.0 / (h * omega * a1),
        }
    }
}

/// Impulses of one contact under Signorini's and Coulomb's laws, given its velocities without them.
pub(super) fn coulomb(
    approach: f64,
    slip: f64,
    a: Admittance,
    compliance: f64,
    friction: f64,
) -> (f64, f64) {
    if approach >= 0.0 {
        return (0.0, 0.0);
    }
    let normal_admittance = a.normal + compliance;
    let determinant = normal_admittance * a.tangent - a.cross * a.cross;
    let normal = (a.cross * slip - a.tangent * approach) / determinant;
    let sticking = (a.cross * approach - normal_admittance * slip) / determinant;
    if normal >= 0.0 && sticking.abs() <= friction * normal {
        return (normal, sticking);
    }
    // It slides: friction at its limit, against the slip that is left. The slip may have turned.
    for direction in [-slip.signum(), slip.signum()] {
        let limit = direction * friction;
        let along = normal_admittance + limit * a.cross;
        let normal = -approach / along;
        let left = slip + a.cross * normal + a.tangent * limit * normal;
        if along > 0.0 && direction * left <= 0.0 {
            return (normal, limit * normal);
        }
    }
    // Only rounding at the border between sticking and sliding leads here.
    let normal = normal.max(0.0);
    (
        normal,
        sticking.clamp(-friction * normal, friction * normal),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUND: Admittance = Admittance {
        normal: 0.1,
        tangent: 0.5,
        cross: 0.0,
    };
    const SLANTED: Admittance = Admittance {
        normal: 0.1,
        tangent: 0.2,
        cross: 0.05,
    };

    /// Velocities after the impulses.
    fn after(
        (normal, friction): (f64, f64),
        approach: f64,
        slip: f64,
        a: Admittance,
    ) -> (f64, f64) {
        (
            approach + a.normal * normal + a.cross * friction,
            slip + a.cross * normal + a.tangent * friction,
        )
    }

    #[test]
    fn parting_surfaces_bear_nothing() {
        assert_eq!(coulomb(0.1, 1.0, ROUND, 0.0, 0.9), (0.0, 0.0));
    }

    #[test]
    fn enough_friction_stops_the_slip() {
        for a in [ROUND, SLANTED] {
            let impulses = coulomb(-1.0, 0.5, a, 0.0, 5.0);
            let (approach, slip) = after(impulses, -1.0, 0.5, a);
            assert!(approach.abs() < 1e-15 && slip.abs() < 1e-15);
            assert!(impulses.1.abs() <= 5.0 * impulses.0);
        }
    }

    #[test]
    fn sliding_friction_is_its_share_of_the_load_against_the_slip() {
        for a in [ROUND, SLANTED] {
            for slip in [-3.0, 3.0] {
                let impulses = coulomb(-0.1, slip, a, 0.0, 0.4);
                let (approach, left) = after(impulses, -0.1, slip, a);
                assert!(approach.abs() < 1e-15 && left * slip > 0.0);
                assert!((impulses.1 + 0.4_f64.copysign(slip) * impulses.0).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn law_holds_for_any_contact_even_where_friction_presses_it_together() {
        let mut seed = 1_u64;
        let mut draw = |low: f64, high: f64| {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            low + (high - low) * (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        for _ in 0..100_000 {
            let (normal, tangent) = (draw(0.01, 1.0), draw(0.01, 1.0));
            let cross = draw(-0.99, 0.99) * (normal * tangent).sqrt();
            let a = Admittance {
                normal,
                tangent,
                cross,
            };
            let (approach, slip, friction) = (draw(-1.0, 0.2), draw(-1.0, 1.0), draw(0.0, 5.0));
            let impulses = coulomb(approach, slip, a, 0.0, friction);
            let (approach, slip) = after(impulses, approach, slip, a);
            // Rounding grows with the impulses, which near-singular contacts make large.
            let tiny = 1e-12 * (1.0 + impulses.0 + impulses.1.abs()).powi(2);
            assert!(impulses.0 >= 0.0 && approach > -tiny);
            assert!(approach * impulses.0 < tiny, "only touching surfaces press");
            assert!(impulses.1.abs() <= friction * impulses.0 + tiny);
            let against = slip * impulses.1 <= tiny;
            let at_limit = (impulses.1.abs() - friction * impulses.0).abs() < tiny;
            assert!(slip.abs() < tiny || (against && at_limit), "{a:?}");
        }
    }

    #[test]
    fn compliance_lets_the_surfaces_approach_by_its_share_of_the_load() {
        let impulses = coulomb(-1.0, 0.0, ROUND, 0.3, 0.9);
        let (approach, _) = after(impulses, -1.0, 0.0, ROUND);
        assert!((approach + 0.3 * impulses.0).abs() < 1e-15);
    }
}
