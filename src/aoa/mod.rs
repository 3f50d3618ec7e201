//! Finding a transmitter from bearings (angle of arrival).
//!
//! The way of a bearing: a [`Bearing`] taken somewhere becomes an [`Observation`]; several at one stop may be
//! pulled together by a [`correction`]; a [`locator`] collects them and says where the source is, or why that
//! cannot be said yet. Where bearings may be wild, mirrored or biased, it is a [`robust`] one that does; where the source
//! may drive off, a [`pursuit`]; where there may be several sources, [`sources`] has one of either for each. All of them
//! [`Locate`], and [`advice`] is where to drive. A direction finder that gives the whole circle has a [`spectrum`].

pub mod clean;
mod core;
pub mod correction;
pub mod gauss_newton;
pub mod geodesy;
mod likelihood;
pub mod manoeuvring;
pub mod multi;
pub mod presets;
pub mod robust;
pub mod spectrum;
#[cfg(test)]
pub(crate) mod testing;
pub mod track;
pub mod triangulation;
mod words;

pub use clean::Clean;
pub use likelihood::BearingLikelihood;
pub use manoeuvring::Manoeuvring;
pub use multi::MultiTarget;
pub use robust::Robust;

pub use words::{
    Advice, Alternative, Answer, Bearing, Bias, Cloud, DIRECTIONS, FARTHEST_M, Fix, Hypothesis,
    Locate, Locator, Mixture, Motion, NotObservable, Observation, ObservationError, PushError,
    Source,
};
