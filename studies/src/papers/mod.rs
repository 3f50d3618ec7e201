//! The experiments: each prints its tables, draws its pictures and returns its figures.

pub mod aoa;
mod bearings;
pub mod cost;
mod counted;
pub mod evolution;
pub mod field;
pub mod finders;
pub mod fingerprint;
pub mod firefly;
pub mod fish;
pub mod floors;
mod instructions;
mod others;
mod outcome;
pub mod outliers;
pub mod reference;
mod scalar;
pub mod sources;
mod statistics;
mod study;
mod table;
pub mod walkers;

pub use study::Study;
