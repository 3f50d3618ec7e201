//! Matching by a table of log-densities.

use super::map::Levels;
use super::matcher::{accepted, locate_by_costs};
use super::posterior::Scale;
use super::{Config, Encoding, Match, Matcher, Posterior, RadioMap, Reading, ReadingError};
use crate::ConfigError;

/// Compares scans with a table of kernel densities by level, which were computed from the samples beforehand
/// (Cui et al. 2017, eq. 1 to 7).
///
/// The inflation and the outlier rate of the configuration have no effect: the table has its own.
///
/// Takes some 620 bytes.
#[derive(Debug, Clone)]
pub struct TableMatcher<'a> {
    map: RadioMap<'a>,
    config: Config,
    scale: Scale,
}

impl<'a> TableMatcher<'a> {
    /// Compares with a map of [`Encoding::Levels`].
    ///
    /// # Errors
    /// For another map, or when a field of the configuration is out of range.
    pub fn new(map: RadioMap<'a>, config: &Config) -> Result<Self, ConfigError> {
        config.check()?;
        map.check_encoding(Encoding::Levels)?;
        let Levels { top, step, .. } = *map.levels();
        Ok(Self {
            map,
            config: *config,
            scale: Scale::new(top, step, config.tempering),
        })
    }
}

/// Adds the codes of a row to the sums of its points.
fn add(row: &[u8], sums: &mut [u16]) {
    let (words, _) = row.as_chunks::<4>();
    let (blocks, rest) = sums.as_chunks_mut::<8>();
    for (sums, bytes) in blocks.iter_mut().zip(words) {
        let word = u32::from_le_bytes(*bytes);
        sums[0] += (word & 15) as u16;
        sums[1] += (word >> 8 & 15) as u16;
        sums[2] += (word >> 16 & 15) as u16;
        sums[3] += (word >> 24 & 15) as u16;
        sums[4] += (word >> 4 & 15) as u16;
        sums[5] += (word >> 12 & 15) as u16;
        sums[6] += (word >> 20 & 15) as u16;
        sums[7] += (word >> 28) as u16;
    }
    if let Some(bytes) = words.get(blocks.len()) {
        let codes = bytes.map(|byte| byte & 15).into_iter();
        let codes = codes.chain(bytes.map(|byte| byte >> 4));
        for (sum, code) in rest.iter_mut().zip(codes) {
            *sum += u16::from(code);
        }
    }
}

impl Matcher for TableMatcher<'_> {
    fn locate<const P: usize>(
        &self,
        scan: &[Reading],
        posterior: &mut Posterior<P>,
    ) -> Result<Match, ReadingError> {
        let set = |costs: &mut [u16]| {
            costs.fill(0);
            for reading in accepted(scan, &self.config) {
                let level = self.map.level(reading.rssi_dbm);
                if let Some(row) = self.map.level_row(reading.beacon.into(), level) {
                    add(row, costs);
                }
            }
        };
        // The level after the last is the absence.
        let absence = usize::from(self.map.levels().count);
        let how = (&self.map, &self.config, &self.scale);
        locate_by_costs(how, scan, posterior, set, |beacon, costs| {
            if let Some(row) = self.map.level_row(beacon, absence) {
                add(row, costs);
            }
        })
    }
}
