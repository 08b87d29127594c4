//! The law of one contact: Signorini's for the gap, Coulomb's for the slip, a soft push out of penetration.

/// Velocity change at a contact for a unit impulse along normal and tangent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Admittance {
    pub normal: f64,
    pub tangent: f64,
    /// Normal velocity for a tangent impulse, and the other way round.
    pub cross: f64,
}

impl Admittance {
    pub(super) fn new(
        inverse_mass: f64,
        inverse_inertia: f64,
        normal_lever: f64,
        tangent_lever: f64,
        of_drive: f64,
    ) -> Self {
        Self {
            normal: inverse_mass + normal_lever * normal_lever * inverse_inertia,
            tangent: inverse_mass + tangent_lever * tangent_lever * inverse_inertia + of_drive,
            cross: normal_lever * tangent_lever * inverse_inertia,
        }
    }
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
    pub(super) const RIGID: Self = Self {
        push_rate: 0.0,
        compliance: 0.0,
    };

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
    // It slides, and friction opposes the slip that sticking would have to overcome.
    let limit = friction.copysign(sticking);
    let along = normal_admittance + limit * a.cross;
    if along > 0.0 {
        let normal = -approach / along;
        return (normal, limit * normal);
    }
    // The friction would press the contact together faster than it resists: it jams.
    (
        normal.max(0.0),
        (friction * normal.max(0.0)).copysign(sticking),
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
    fn compliance_lets_the_surfaces_approach_by_its_share_of_the_load() {
        let impulses = coulomb(-1.0, 0.0, ROUND, 0.3, 0.9);
        let (approach, _) = after(impulses, -1.0, 0.0, ROUND);
        assert!((approach + 0.3 * impulses.0).abs() < 1e-15);
    }
}
