//! Matching a scan with a map.

use super::{Config, Match, Posterior, RadioMap, ReadingError};

/// One beacon as a scan heard it: a packet, or the mean of several.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Reading {
    /// The number of the beacon, see [`super::RadioMap::beacon_index`].
    pub beacon: u8,
    /// Strength in dBm. For whole scans: less the offset of the receiver.
    pub rssi_dbm: f32,
}

/// A method that finds the place of a scan.
pub trait Matcher {
    /// Computes the posterior of a scan over the points of the map, all of which were equally probable before.
    ///
    /// Readings outside of the range of the configuration are left out, and so are those after the first
    /// [`MAX_READINGS`]; two of one beacon count as independent.
    ///
    /// # Errors
    /// When the scan says nothing of the place; the posterior is then as before.
    fn locate<const P: usize>(
        &self,
        scan: &[Reading],
        posterior: &mut Posterior<P>,
    ) -> Result<Match, ReadingError>;
}

/// The most readings of a scan that are used.
pub const MAX_READINGS: usize = 64;
/// The most missing beacons that are modelled.
const MAX_MISSING: usize = 128;

/// Refuses a scan that cannot be matched, except one without readings.
pub(super) fn check<const P: usize>(
    map: &RadioMap<'_>,
    scan: &[Reading],
) -> Result<(), ReadingError> {
    if map.lattice().points() > P {
        return Err(ReadingError::Points);
    }
    // At least one point must have been surveyed. Bits beyond the last point mean nothing.
    let mut points = 0..map.lattice().points();
    if !map.is_complete() && !points.any(|point| map.is_surveyed(point)) {
        return Err(ReadingError::Survey);
    }
    check_beacons(map.beacons(), scan)
}

pub(super) fn check_beacons(beacons: usize, scan: &[Reading]) -> Result<(), ReadingError> {
    let known = |reading: &Reading| usize::from(reading.beacon) < beacons;
    scan.iter()
        .all(known)
        .then_some(())
        .ok_or(ReadingError::Beacon)
}

/// Calls `add` with each reading that can be used, and counts them.
pub(super) fn for_each_accepted(
    scan: &[Reading],
    config: &Config,
    mut add: impl FnMut(&Reading),
) -> Result<usize, ReadingError> {
    let mut used = 0;
    for reading in scan {
        if config.accepts(reading.rssi_dbm) && used < MAX_READINGS {
            add(reading);
            used += 1;
        }
    }
    if used > 0 {
        Ok(used)
    } else {
        Err(ReadingError::Strength)
    }
}

/// The beacons of which a scan has no reading.
pub(super) fn missing(
    map: &RadioMap<'_>,
    scan: &[Reading],
    config: &Config,
) -> impl Iterator<Item = usize> {
    (0..map.beacons())
        .filter(|beacon| {
            let heard = |reading: &Reading| {
                usize::from(reading.beacon) == *beacon && config.accepts(reading.rssi_dbm)
            };
            !scan.iter().any(heard)
        })
        .take(MAX_MISSING)
}
