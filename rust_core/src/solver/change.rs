//! A change of all velocities, from the present ones to a solution of the linear system.
//!
//! The equations: docs/physics.md, "Lowering".

use super::Problem;

impl Problem {
    /// Solves the system, rings included, for the change to its solution; none if the constraints contradict each other.
    pub(super) fn solve_for_change(&mut self) -> Option<()> {
        if !self.rings.is_empty() {
            let mut rows = self.system.of_base();
            for ring in &mut self.rings {
                ring.eliminate(&mut rows)?;
            }
            self.system.set_of_base(rows);
        }
        let (change, now) = (&mut self.change, &self.velocities);
        self.system.solve(change)?;
        for (k, ring) in self.rings.iter_mut().enumerate() {
            let [slide, spin] = ring.follow(change.base, &mut change.links);
            change.slides[k] = slide;
            if let Some(k) = ring.spin {
                change.spins[k] = spin;
            }
        }
        let turn = change.base.turn - now.base.turn;
        change.base = change.base.less(now.base);
        for (k, joint) in self.joints.iter().enumerate() {
            change.joints[k] = match joint.held {
                Some(_) => turn,
                None => change.joints[k] - now.joints[k],
            };
        }
        for (k, spin) in self.spins.iter().enumerate() {
            change.spins[k] = match spin.held {
                Some(_) => 0.0,
                None => change.spins[k] - now.spins[k],
            };
        }
        for (link, now) in change.links.iter_mut().zip(&now.links) {
            *link = link.less(*now);
        }
        for (slide, now) in change.slides.iter_mut().zip(&now.slides) {
            *slide -= now;
        }
        Some(())
    }

    /// Changes all velocities by a share of the change.
    pub(super) fn go(&mut self, share: f64) {
        self.velocities.add(&self.change, share);
    }
}
