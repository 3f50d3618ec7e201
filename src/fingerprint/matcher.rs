//! Matching a scan with a map.

use super::gaussian::Gaussian;
use super::posterior::Scale;
use super::scan::{MAX_READINGS, accepted};
use super::{Config, Encoding, Match, Posterior, RadioMap, Reading, ReadingError, table};
use crate::ConfigError;

/// The most missing beacons that are modelled.
const MAX_MISSING: usize = 128;

/// Finds the place of a scan.
///
/// With a map of [`Encoding::Moments`], the likelihood of a reading is the larger one of the normal density, with the
/// sigma of the map and the inflation of the configuration, and of the uniform density of the outliers: nearly their sum
/// (max-mixture of Olson and Agarwal, 2013), in steps of 0.03 to 0.07 of its logarithm. With one of [`Encoding::Levels`],
/// it is a kernel density that was computed from the samples beforehand (Cui et al. 2017, eq. 1 to 7).
///
/// Takes some 880 bytes.
#[derive(Debug, Clone)]
pub struct Matcher<'a> {
    map: RadioMap<'a>,
    config: Config,
    gaussian: Gaussian,
}

impl<'a> Matcher<'a> {
    /// Compares with a map.
    ///
    /// # Errors
    /// When a field of the configuration is out of range.
    pub fn new(map: RadioMap<'a>, config: &Config) -> Result<Self, ConfigError> {
        config.check()?;
        let mut gaussian = Gaussian::new(config);
        if map.encoding() == Encoding::Levels {
            let levels = map.levels();
            gaussian.scale = Scale::new(levels.top, levels.step, config.tempering);
        }
        Ok(Self {
            map,
            config: *config,
            gaussian,
        })
    }

    /// Computes the posterior of a scan over the points of the map, all of which were equally probable before.
    ///
    /// Readings outside of the range of the configuration are left out, and so are those after the first
    /// [`MAX_READINGS`]; two of one beacon count as independent.
    ///
    /// # Errors
    /// When the scan says nothing of the place; the posterior is then as before.
    pub fn locate<const P: usize>(
        &self,
        scan: &[Reading],
        posterior: &mut Posterior<P>,
    ) -> Result<Match, ReadingError> {
        let Self {
            map,
            config,
            gaussian,
        } = self;
        let costs = posterior.costs_mut(map.lattice().points());
        let costs = costs.ok_or(ReadingError::Points)?;
        let used = check(map, scan, config)?;
        let readings = accepted(scan, config);
        match map.encoding() {
            Encoding::Moments => gaussian.set(map, readings, costs),
            Encoding::Levels => table::set(map, readings, costs),
        }
        if config.missing_beacons_count {
            let heard = |beacon: usize, reading: &Reading| {
                usize::from(reading.beacon) == beacon && config.accepts(reading.rssi_dbm)
            };
            let missing = (0..map.beacons())
                .filter(|beacon| !scan.iter().any(|reading| heard(*beacon, reading)));
            for beacon in missing.take(MAX_MISSING) {
                match map.encoding() {
                    Encoding::Moments => gaussian.add_missing(map, beacon, costs),
                    Encoding::Levels => table::add_missing(map, beacon, costs),
                }
            }
        }
        posterior.of_costs(map, &gaussian.scale, used)
    }
}

/// Counts the readings that can be used. Refuses a scan that has none, or of unknown beacons.
fn check(map: &RadioMap<'_>, scan: &[Reading], config: &Config) -> Result<usize, ReadingError> {
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
