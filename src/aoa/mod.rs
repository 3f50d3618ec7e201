//! Finding a transmitter from bearings (angle of arrival).

mod bearing;
mod observation;
pub mod geodesy;

pub use bearing::Bearing;
pub use observation::{Observation, ObservationError};
