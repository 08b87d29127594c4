//! Columns of numbers next to a JSON text, which has only their positions.

use serde::Serialize;
use serde_json::{Value, json};

/// Columns, one after the other.
#[derive(Debug, Default)]
pub(crate) struct Columns {
    pub(crate) numbers: Vec<f64>,
}

/// The position of a column among the numbers.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Place {
    first: usize,
    count: usize,
}

impl Columns {
    /// Adds a column.
    pub(crate) fn add(&mut self, values: impl IntoIterator<Item = f64>) -> Place {
        let first = self.numbers.len();
        self.numbers.extend(values);
        Place {
            first,
            count: self.numbers.len() - first,
        }
    }
}

/// Columns of poses: a constant value is a number, any other refers to a column by its index.
#[derive(Debug, Default)]
pub(crate) struct Varying {
    pub(crate) places: Vec<Place>,
}

impl Varying {
    /// Adds a quantity, which counts as constant if it changes by no more than a resolution.
    pub(crate) fn add(&mut self, columns: &mut Columns, values: &[f64], resolution: f64) -> Value {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if most - least <= resolution {
            return json!(values.first());
        }
        self.places.push(columns.add(values.iter().copied()));
        json!({ "column": self.places.len() - 1 })
    }
}
