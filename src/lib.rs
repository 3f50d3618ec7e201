//! Particle filters that find and track radio sources on a microcontroller.
//!
//! No heap, no `std`, no f64: columns of f32 of a fixed size, memory that the linker knows, bounded work in every
//! call, and numbers that are the same to the last bit on a Cortex-M4F and on a desk. One seed replays one run.
//!
//! Each layer knows only those above it in this table, so a reader can stop anywhere:
//!
//! | module | holds |
//! |---|---|
//! | [`math`] | exp, ln, atan2, sine and cosine, square root: short, with a table of their errors |
//! | [`random`] | uniform and normal samples from any generator |
//! | [`snapshot`] | any state as bytes, and back, for boards that lose power |
//! | [`particles`] | the cloud: a column per dimension of the state, and log-weights |
//! | [`weights`], [`resample`] | normalisation in the log domain; four unbiased resampling schemes, in place |
//! | [`estimate`] | mean, covariance, quantiles, credible ellipses |
//! | [`model`] | the traits that a user implements, and stock dynamics |
//! | [`filter`] | the bootstrap particle filter: predict, update, resample, or all three in one step |
//! | [`kalman`] | normal distributions; the linear and the unscented Kalman filter |
//! | [`proposal`] | filters that look at the measurement before they move: unscented, auxiliary, point mass |
//! | [`refine`] | fish schools, fireflies, differential evolution: as published, or with the posterior kept exact |
//! | [`aoa`] | bearings and their conventions, triangulation, Gauss-Newton; locators of one source or several, stationary or manoeuvring |
//! | [`fingerprint`] | radio maps in flash, matching of signal strengths with them, trackers of tags |
//! | `gateway` (feature) | bytes in, fixes out: the same state machine in firmware, host tools and tests |
//!
//! To find a transmitter from bearings, start at [`aoa::Locator`]. To track something of your own, start at [`model`].
//! The guide in `docs/` of the repository explains which locator to take, how to read the uncertainty, and how to build
//! firmware.
//!
//! # Conventions
//!
//! Positions are metres east and north of a local origin ([`aoa::geodesy`] makes them). Angles are radians,
//! counter-clockwise from east; compass bearings enter by constructors that say so. Times are integer milliseconds.
//! Weights are natural logarithms until they are needed. The generator is always an argument.
//!
//! A configuration is a plain struct with public fields, the unit in each name; [`config!`] checks it while it compiles,
//! and [`ConfigError`] names the field that is out of range. A state holds no configuration: `EMPTY` is all zero bits, so
//! that a `static` takes no flash, and the calls borrow the configuration that they need.
//!
//! # What cannot happen
//!
//! Nothing here panics, which a linked firmware proves: it does not link if a panic is left in it. Input that
//! makes no sense gets a typed error and leaves the state as it was. Loops are bounded.
//!
//! # Features
//!
//! None is on by default, all are additive, and none changes a number.
//!
//! * `gateway`: the serial gateway, with the parsers that it needs.
//! * `defmt`: `defmt::Format` for values and errors.
#![no_std]
#![deny(unsafe_code)]
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod aoa;
mod checksum;
mod config;
mod error;
pub mod estimate;
pub mod filter;
pub mod fingerprint;
#[cfg(feature = "gateway")]
#[cfg_attr(docsrs, doc(cfg(feature = "gateway")))]
pub mod gateway;
pub mod kalman;
pub mod math;
pub mod model;
pub mod particles;
pub mod proposal;
pub mod random;
pub mod refine;
pub mod resample;
pub mod snapshot;
pub mod weights;

pub use config::ConfigError;

#[cfg(doctest)]
mod guide;
