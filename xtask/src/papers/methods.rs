//! The methods that are compared: those that the firmware `studies` runs, from the same files.

#[path = "../../../examples/studies/bearings.rs"]
pub mod bearings;
#[path = "../../../examples/studies/scalar.rs"]
pub mod scalar;
