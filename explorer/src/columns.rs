//! Columns of numbers beside a text: the text has only their place.

use serde::Serialize;
use serde_json::{Value, json};

/// Columns, one after the other.
#[derive(Debug, Default)]
pub(crate) struct Columns {
    pub(crate) numbers: Vec<f64>,
}

/// Where a column is among the numbers.
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

/// Columns of poses: a value that does not change is a number, another one refers to a column by its index.
#[derive(Debug, Default)]
pub(crate) struct Varying {
    pub(crate) places: Vec<Place>,
}

impl Varying {
    /// Adds a quantity that has changed if it did so by more than a resolution.
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
