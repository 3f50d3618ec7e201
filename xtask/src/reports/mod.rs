//! The reports of the gateways, read back.

pub mod beacon;
mod sentence;
pub mod vehicle;
