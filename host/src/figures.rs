//! Measured figures: one shape for everything that is measured.

use serde::{Deserialize, Serialize};

/// One measured figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// What was measured, dotted from the general to the particular: `m4f.step.n200.instructions`.
    pub name: String,
    /// The measurement.
    pub value: f64,
    /// The unit of `value` and `limit`.
    pub unit: String,
    /// The largest value that passes; `None` where the figure is only reported.
    pub limit: Option<f64>,
}

impl Figure {
    /// A figure without a limit.
    pub fn new(name: impl Into<String>, value: f64, unit: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            value,
            unit: unit.into(),
            limit: None,
        }
    }

    /// The same figure, which must not exceed `limit`.
    pub fn at_most(mut self, limit: f64) -> Self {
        self.limit = Some(limit);
        self
    }

    /// Whether the figure keeps to its limit. A value that is not a number never does.
    pub fn ok(&self) -> bool {
        self.limit.is_none_or(|limit| self.value <= limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_is_the_largest_value_that_passes() {
        let figure = |value| Figure::new("x", value, "ns").at_most(25.0);
        assert!(figure(25.0).ok());
        assert!(!figure(25.1).ok());
        assert!(!figure(f64::NAN).ok());
        assert!(Figure::new("x", 1e9, "ns").ok());
    }

    #[test]
    fn a_missing_limit_is_null_in_json() {
        let json = serde_json::to_value(Figure::new("x", 1.5, "ns")).unwrap();
        assert_eq!(
            json,
            serde_json::json!({"name": "x", "value": 1.5, "unit": "ns", "limit": null})
        );
    }
}
