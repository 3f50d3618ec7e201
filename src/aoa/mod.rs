//! Finding a transmitter from bearings (angle of arrival).
//!
//! A [`Bearing`] that an array takes at some place and time is an [`Observation`]. A locator takes observations and says
//! where the source is, or why that cannot be said yet: its [`Answer`]. All locators [`Locate`] in the same way:
//!
//! | locator | for |
//! |---|---|
//! | [`Clean`] | one stationary source; every bearing points at it, but for normal errors |
//! | [`Robust`] | one stationary source; bearings may be outliers, mirrored, biased or correlated |
//! | [`Manoeuvring`] | one source that may move and stop; wraps either of the two |
//! | [`MultiTarget`] | several sources on a channel; wraps any of the three |
//!
//! Each is a state that borrows its configuration with every call; [`Locator`] holds both, for short programs.
//! [`presets`] are combinations for common situations.
//!
//! Around them: [`geodesy`] makes metres of latitude and longitude; a [`spectrum`] is the whole circle of a direction
//! finder, whose peaks are [`Alternative`]s; an [`Advice`] says where to drive. [`triangulation`] has the classical
//! estimates, which locators start from.

mod channels;
pub mod clean;
mod core;
pub mod geodesy;
mod likelihood;
pub mod manoeuvring;
pub mod multi;
pub mod presets;
pub mod robust;
pub mod spectrum;
#[cfg(test)]
pub(crate) mod testing;
mod track;
pub mod triangulation;
mod words;

pub use channels::Channels;
pub use clean::Clean;
pub use likelihood::BearingLikelihood;
pub use manoeuvring::Manoeuvring;
pub use multi::MultiTarget;
pub use robust::Robust;
pub use words::{
    Advice, Alternative, Answer, Bearing, Bias, Cloud, DIRECTIONS, FARTHEST_M, Fix, Hypothesis,
    Locate, Locator, Mixture, Motion, NotObservable, Observation, ObservationError, PushError,
    Retract, Retracted, SigmaScale, Source,
};
