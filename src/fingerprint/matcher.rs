//! Matching a scan with a map.

use super::posterior::Scale;
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

/// The readings of a scan that can be used.
pub(super) fn accepted<'a>(
    scan: &'a [Reading],
    config: &'a Config,
) -> impl Iterator<Item = &'a Reading> {
    let accepted = scan.iter().filter(|r| config.accepts(r.rssi_dbm));
    accepted.take(MAX_READINGS)
}

/// Counts the readings that can be used. Refuses a scan that has none, or of unknown beacons, and a map for which the
/// posterior has no room, or of which nothing was surveyed.
fn check<const P: usize>(
    map: &RadioMap<'_>,
    scan: &[Reading],
    config: &Config,
) -> Result<usize, ReadingError> {
    if map.lattice().points() > P {
        return Err(ReadingError::Points);
    }
    // At least one point must have been surveyed. Bits beyond the last point mean nothing.
    let mut points = 0..map.lattice().points();
    if !map.is_complete() && !points.any(|point| map.is_surveyed(point)) {
        return Err(ReadingError::Survey);
    }
    let mut used = 0;
    for reading in scan {
        if usize::from(reading.beacon) >= map.beacons() {
            return Err(ReadingError::Beacon);
        }
        used += usize::from(config.accepts(reading.rssi_dbm));
    }
    match used.min(MAX_READINGS) {
        0 => Err(ReadingError::Strength),
        used => Ok(used),
    }
}

/// Matches by the costs of the points: those of the readings, which `set` writes, and of each beacon that is missing, which
/// `add` adds if the configuration says so.
pub(super) fn locate_by_costs<const P: usize>(
    (map, config, scale): (&RadioMap<'_>, &Config, &Scale),
    scan: &[Reading],
    posterior: &mut Posterior<P>,
    set: impl FnOnce(&mut [u16]),
    add: impl Fn(usize, &mut [u16]),
) -> Result<Match, ReadingError> {
    let used = check::<P>(map, scan, config)?;
    let costs = posterior.costs_mut(map.lattice().points());
    let costs = costs.ok_or(ReadingError::Points)?;
    set(costs);
    if config.missing_beacons_count {
        let heard = |beacon: usize, reading: &Reading| {
            usize::from(reading.beacon) == beacon && config.accepts(reading.rssi_dbm)
        };
        (0..map.beacons())
            .filter(|beacon| !scan.iter().any(|reading| heard(*beacon, reading)))
            .take(MAX_MISSING)
            .for_each(|beacon| add(beacon, costs));
    }
    posterior.of_costs(map, scale, used)
}
