//! Finding a receiver by how strongly it hears beacons (fingerprints).
//!
//! A survey says how strong each beacon is at each of many points; a scan somewhere is compared with all of them.
//! The survey becomes a [`RadioMap`] on a desk, a few bytes for each point and beacon that are read from flash in
//! place.
//!
//! | to match a whole scan | needs | compares with |
//! |---|---|---|
//! | [`GaussianMatcher`] | a map of [`Encoding::Moments`] | mean and deviation |
//! | [`TableMatcher`] | a map of [`Encoding::Levels`] | a kernel density, folded into a table |
//! | [`KernelDensity`] | the [`Samples`] themselves | a kernel density, exactly |
//! | [`Neighbours`] | a map of [`Encoding::Moments`] | means, by their distance |
//!
//! To weigh particles by one packet at a time there is [`PacketLikelihood`], interpolated between the points.
//!
//! ```
//! use foxhunt::fingerprint::{
//!     GaussianMatcher, Matcher, Posterior, RadioMap, Reading, Settings,
//! };
//!
//! // A tunnel of 80 m, surveyed every metre. The map stays in flash.
//! static TUNNEL: &[u8] =
//!     include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/tunnel.map"));
//!
//! let map = RadioMap::new(TUNNEL)?;
//! let matcher = GaussianMatcher::new(map, &Settings::new())?;
//! let mut posterior = Posterior::<81>::new();
//! // What the four beacons sound like 20 m in, to a decibel or two.
//! let heard = [-60.0, -55.0, -70.0, -72.0];
//! let scan = [0, 1, 2, 3].map(|beacon| Reading { beacon, rssi_dbm: heard[usize::from(beacon)] });
//! let found = matcher.locate(&scan, &mut posterior)?;
//! assert!((found.mean[0] - 20.0).abs() < 5.0);
//! assert!(posterior.weights()[20] > posterior.weights()[70]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod density;
mod gaussian;
mod lattice;
mod map;
mod neighbours;
mod packet;
mod posterior;
pub mod published;
mod settings;
mod table;
#[cfg(test)]
mod tests;
pub mod tracker;

pub use density::{KernelDensity, Samples};
pub use gaussian::GaussianMatcher;
pub use lattice::Lattice;
pub use map::{Beacon, Encoding, MapError, Moments, RadioMap};
pub use neighbours::Neighbours;
pub use packet::{Packet, PacketError, PacketLikelihood, PacketModel};
pub use posterior::{Match, MatchError, Posterior};
pub use settings::{Missing, Reading, Settings, SettingsError};
pub use table::TableMatcher;

/// A way to say where a scan was taken.
pub trait Matcher {
    /// Computes the posterior of a scan over the points of the map, all of which were equally probable before.
    ///
    /// Readings out of the range of the settings are left out, and so are those after the first [`MAX_READINGS`]; two of
    /// one beacon count as independent.
    ///
    /// # Errors
    /// When nothing can be said; the posterior is then as before.
    fn locate<const P: usize>(
        &self,
        scan: &[Reading],
        posterior: &mut Posterior<P>,
    ) -> Result<Match, MatchError>;
}

/// The most readings of a scan that are used.
pub const MAX_READINGS: usize = 64;
/// The most missing beacons that are modelled.
const MAX_MISSING: usize = 128;

/// Refuses a scan that cannot be matched, but for one without readings.
fn check<const P: usize>(map: &RadioMap<'_>, scan: &[Reading]) -> Result<(), MatchError> {
    if map.lattice().points() > P {
        return Err(MatchError::Points);
    }
    // Points are left out where nobody has been: there must be another. Bits beyond the last point mean nothing.
    let mut points = 0..map.lattice().points();
    if !map.is_complete() && !points.any(|point| map.is_surveyed(point)) {
        return Err(MatchError::Survey);
    }
    check_beacons(map.beacons(), scan)
}

fn check_beacons(beacons: usize, scan: &[Reading]) -> Result<(), MatchError> {
    let known = |reading: &Reading| usize::from(reading.beacon) < beacons;
    scan.iter()
        .all(known)
        .then_some(())
        .ok_or(MatchError::Beacon)
}

/// Calls `add` with each reading that can be used, and counts them.
fn for_each_accepted(
    scan: &[Reading],
    settings: &Settings,
    mut add: impl FnMut(&Reading),
) -> Result<usize, MatchError> {
    let mut used = 0;
    for reading in scan {
        if settings.accepts(reading.rssi_dbm) && used < MAX_READINGS {
            add(reading);
            used += 1;
        }
    }
    if used == 0 {
        return Err(MatchError::Scan);
    }
    Ok(used)
}

/// The beacons of which a scan has no reading.
fn missing(
    map: &RadioMap<'_>,
    scan: &[Reading],
    settings: &Settings,
) -> impl Iterator<Item = usize> {
    (0..map.beacons())
        .filter(|beacon| {
            let heard = |reading: &Reading| {
                usize::from(reading.beacon) == *beacon && settings.accepts(reading.rssi_dbm)
            };
            !scan.iter().any(heard)
        })
        .take(MAX_MISSING)
}
