//! The methods that are compared.
//!
//! An experiment hands them to a visitor, one after the other. The tasks have one that runs them beside an exact answer;
//! the firmware `studies` has one that counts their instructions.

pub mod bearings;
pub mod correction;
pub mod scalar;
