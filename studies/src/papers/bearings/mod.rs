//! Bearings along a track: methods on the same bearings, beside the exact posterior.

mod experiment;
mod method;
mod outcomes;
mod pictures;
mod problem;

pub use experiment::Experiment;
pub use method::{Method, methods_of};
pub use outcomes::Outcomes;
