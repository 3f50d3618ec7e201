//! From a survey to a radio map.
//!
//! A [`SiteSurvey`] is what somebody with a receiver measured: readings of beacons at known places. It becomes the bytes
//! of a [`foxhunt::fingerprint::RadioMap`] on a regular lattice, and those the source text of a Rust constant.

mod encode;
mod field;
mod site;

pub use encode::{Options, rust_constant};
pub use site::{Reading, SiteSurvey};
