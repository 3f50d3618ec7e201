//! Particle filters that find and track radio sources on a microcontroller.
//!
//! No heap, no `std`, no f64: fixed-size columns of f32, memory that the linker knows, bounded work in every
//! call, and numbers that are the same to the last bit on a Cortex-M4F and on a desk. One seed replays one run.
//!
//! The layers, each of which knows only those above it; a reader can stop anywhere:
//!
//! | module | holds |
//! |---|---|
//! | [`math`] | exp, ln, atan2, sine and cosine, square root: short, with a table of their errors |
//! | [`random`] | uniform, normal and gamma samples from any generator |
//! | [`particles`] | the cloud: a column per dimension of the state, and log-weights |
//! | [`weights`], [`resample`] | normalisation in the log domain; four unbiased resampling schemes, in place |
//! | [`model`] | the two traits that a user implements, and stock dynamics |
//! | [`refine`] | fish schools, fireflies, differential evolution: as published, or with the posterior kept exact |
//! | [`filter`] | the bootstrap particle filter: predict, update, resample |
//! | [`estimate`] | mean, covariance, quantiles, credible ellipses |
//! | [`kalman`] | normal distributions; the linear and the unscented Kalman filter |
//! | [`proposal`] | filters that look at the measurement before they move: unscented, auxiliary, point mass |
//! | [`aoa`] | bearings and their conventions, triangulation, Gauss-Newton; locators of one source or several, at rest or not |
//! | [`fingerprint`] | radio maps in flash, and matching of signal strengths with them |
//! | [`problems`] | the problems of the published experiments, ready to run |
//! | [`snapshot`] | the whole state of a locator as bytes, and back, for boards that lose power |
//! | `gateway` (feature) | bytes in, fixes out: the state machine that firmware, host tools and tests share |
//!
//! Start at [`aoa::locator::Locator`] to find a transmitter from clean bearings, at [`aoa::robust`] where they are not, at [`model`] to track something of
//! your own.
//!
//! # Conventions
//!
//! Positions are metres east and north of a local origin ([`aoa::geodesy`] makes them). Angles are radians,
//! counter-clockwise from east; compass bearings enter by constructors that say so. Weights are natural
//! logarithms until they are needed. The generator is always an argument.
//!
//! # What cannot happen
//!
//! Nothing here panics, which a linked firmware proves: it does not link if a panic is left in it. Input that
//! makes no sense gets a typed error that names the field and leaves the state as it was. Loops are bounded.
//!
//! # Features
//!
//! None is on by default, all are additive, and none changes a number.
//!
//! * `gateway`: the serial gateway, with the parser that it needs.
//! * `defmt`: `defmt::Format` for values and errors.
#![no_std]
#![deny(unsafe_code)]

pub mod aoa;
mod checksum;
mod config;
pub mod estimate;
pub mod filter;
pub mod fingerprint;
#[cfg(feature = "gateway")]
pub mod gateway;
pub mod kalman;
pub mod math;
pub mod model;
pub mod particles;
pub mod problems;
pub mod proposal;
pub mod random;
pub mod refine;
pub mod resample;
pub mod snapshot;
pub mod weights;

pub use config::ConfigError;

/// The examples of the README, run with the others.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
