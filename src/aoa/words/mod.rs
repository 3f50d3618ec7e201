//! The words of bearing-only location: what goes into a locator, what comes out of it, and what locators have in common.

mod advice;
mod alternative;
mod answer;
mod correction;
mod locate;
mod observation;
mod reasons;
mod retract;

pub(in crate::aoa) use advice::Belief;
pub use advice::{Advice, DIRECTIONS, FARTHEST_M};
pub use alternative::Alternative;
pub use answer::{
    Answer, Bias, Cloud, Fix, Hypothesis, Mixture, Motion, NotObservable, SigmaScale, Source,
};
pub(in crate::aoa) use correction::Correction;
pub use locate::{Locate, Locator};
pub use observation::{Bearing, Observation, ObservationError, PushError};
pub use retract::{Retract, Retracted};
