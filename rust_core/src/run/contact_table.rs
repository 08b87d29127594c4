//! The contacts of a run as columns.

use std::collections::TryReserveError;

use super::Simulation;
use crate::limits::memory::reserve;
use crate::observe::Loads;

/// Contacts of all samples.
#[derive(Clone, Debug, Default)]
#[allow(missing_docs)] // the columns are described in docs/conventions.md
pub struct ContactTable {
    pub time: Vec<f64>,
    pub contact: Vec<i64>,
    pub lane: Vec<i64>,
    pub body: Vec<i64>,
    pub body_kind: Vec<i64>,
    pub segment: Vec<i64>,
    pub edge: Vec<i64>,
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    pub normal_x: Vec<f64>,
    pub normal_y: Vec<f64>,
    pub normal_force: Vec<f64>,
    pub friction_force: Vec<f64>,
    pub surface_speed: Vec<f64>,
    pub penetration: Vec<f64>,
}

impl Simulation {
    /// Contacts of the last step.
    pub fn contact_table(&self) -> ContactTable {
        let mut loads = Loads::default();
        loads.add(self.loaded(), 1.0);
        let mut table = ContactTable::default();
        table.append(self, self.time(), &mut loads);
        table
    }
}

impl ContactTable {
    /// All columns.
    fn columns(&mut self) -> ([&mut Vec<f64>; 9], [&mut Vec<i64>; 6]) {
        let numbers = [
            &mut self.time,
            &mut self.x,
            &mut self.y,
            &mut self.normal_x,
            &mut self.normal_y,
            &mut self.normal_force,
            &mut self.friction_force,
            &mut self.surface_speed,
            &mut self.penetration,
        ];
        let codes = [
            &mut self.contact,
            &mut self.lane,
            &mut self.body,
            &mut self.body_kind,
            &mut self.segment,
            &mut self.edge,
        ];
        (numbers, codes)
    }

    /// Reserves room in every column for a total number of rows.
    pub(super) fn reserve(&mut self, rows: usize) -> Result<(), TryReserveError> {
        let (numbers, codes) = self.columns();
        numbers.into_iter().try_for_each(|c| reserve(c, rows))?;
        codes.into_iter().try_for_each(|c| reserve(c, rows))
    }

    /// Releases room that no row uses.
    pub(super) fn shrink(&mut self) {
        let (numbers, codes) = self.columns();
        numbers.into_iter().for_each(Vec::shrink_to_fit);
        codes.into_iter().for_each(Vec::shrink_to_fit);
    }

    /// Appends the loads of the interval that ends at `time` [s].
    pub(crate) fn append(&mut self, simulation: &Simulation, time: f64, loads: &mut Loads) {
        for r in loads.drain() {
            self.time.push(time);
            self.contact.push(r.number as i64);
            self.lane.push(simulation.side(r.part) as i64);
            self.body.push(r.part as i64);
            self.body_kind.push(simulation.part_kind(r.part) as i64);
            self.segment.push(r.facet as i64);
            self.edge.push(i64::from(r.edge));
            self.x.push(r.point.x);
            self.y.push(r.point.y);
            self.normal_x.push(r.normal.x);
            self.normal_y.push(r.normal.y);
            self.normal_force.push(r.normal_force);
            self.friction_force.push(r.friction_force);
            self.surface_speed.push(r.surface_speed);
            self.penetration.push((-r.distance).max(0.0));
        }
    }
}
