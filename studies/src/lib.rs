//! Published experiments, run again and compared with their figures.
//!
//! [`methods`] are what the experiments compare: the tasks run them to see how accurate they are, the firmware `studies` to
//! see what they take. [`papers`] are the experiments.

#![cfg_attr(not(feature = "std"), no_std)]

pub mod methods;
#[cfg(feature = "std")]
pub mod papers;
