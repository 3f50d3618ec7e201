//! Finding a receiver by how strongly it hears beacons (fingerprints).
//!
//! A survey says how strong each beacon is at each of many points; a scan somewhere is compared with all of them.
//! The survey becomes a [`RadioMap`] on a desk, a few bytes for each point and beacon that are read from flash in
//! place.
//!
//! A [`Matcher`] compares a whole scan: with the mean and the sigma of every beacon, or with a kernel density that is
//! folded into a table, as the map has it. A [`tracker`] follows tags by their packets. For a filter of your own, the
//! likelihood of a place is the weight of the point that is [`nearest`](Lattice::nearest) to it.
//!
//! ```
//! use foxhunt::fingerprint::{Config, Matcher, Posterior, RadioMap, Reading};
//!
//! // A tunnel of 80 m, surveyed every metre. The map stays in flash.
//! static TUNNEL: &[u8] =
//!     include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/tunnel.map"));
//!
//! let map = RadioMap::new(TUNNEL)?;
//! let matcher = Matcher::new(map, &Config::DEFAULT)?;
//! let mut posterior = Posterior::<81>::EMPTY;
//! // What the four beacons sound like 20 m in, to a decibel or two.
//! let heard = [-60.0, -55.0, -70.0, -72.0];
//! let scan = [0, 1, 2, 3].map(|beacon| Reading { beacon, rssi_dbm: heard[usize::from(beacon)] });
//! let found = matcher.locate(&scan, &mut posterior)?;
//! assert!((found.mean[0] - 20.0).abs() < 5.0);
//! let likelihood = |place| posterior.weights()[map.lattice().nearest(place)];
//! assert!(likelihood([20.2, 0.0]) > likelihood([70.0, 0.0]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod config;
mod error;
mod gaussian;
mod lattice;
mod map;
mod matcher;
mod posterior;
mod scan;
mod table;
#[cfg(test)]
mod tests;
pub mod tracker;
mod zone;

pub use config::Config;
pub use error::{MapError, ReadingError};
pub use lattice::Lattice;
pub use map::{Beacon, Encoding, Moments, RadioMap};
pub use matcher::Matcher;
pub use posterior::{Match, Posterior};
pub use scan::{MAX_READINGS, Reading};
pub use zone::Zone;
