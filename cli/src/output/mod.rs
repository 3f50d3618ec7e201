//! Where results go.

mod chasemapper;
mod cot;
mod feature;
mod form;
mod mqtt;
mod nmea;
mod queue;
mod sink;
mod start;

pub use mqtt::options as broker;
pub use start::{settled, start};
