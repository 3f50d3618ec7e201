//! From a survey to a radio map.
//!
//! A [`SiteSurvey`] is what somebody with a receiver measured: readings of beacons at known places, or the strengths of all
//! beacons by poses of a robot. [`SiteSurvey::map`] makes of it the bytes of a [`foxhunt::fingerprint::RadioMap`] on a regular
//! lattice, and says how well places will be found on it; [`rust_constant`] makes of those the source text of a constant.

mod cells;
mod content;
mod encode;
mod errors;
mod expected;
mod kriging;
mod make;
mod reading;
mod recipe;
mod site;

pub use encode::rust_constant;
pub use expected::Expected;
pub use make::Made;
pub use reading::sources;
pub use recipe::{Choices, Recipe, Shape};
pub use site::{Reading, SiteSurvey};
