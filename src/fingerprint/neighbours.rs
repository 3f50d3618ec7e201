//! Matching by nearest neighbours.

use super::matcher::{accepted, check};
use super::{Config, Encoding, Match, Matcher, Posterior, RadioMap, Reading, ReadingError};
use crate::ConfigError;
use crate::config::require;

/// The points whose means are nearest to a scan: the oldest method, as a baseline.
///
/// The nearest points have equal weights, all others none; inflation, outlier rate and tempering have no effect. A beacon
/// that was not heard at a point counts there as -120 dBm, one that is missing in the scan not at all.
#[derive(Debug, Clone, Copy)]
pub struct Neighbours<'a> {
    map: RadioMap<'a>,
    config: Config,
    neighbours: u8,
}

/// A beacon that was not heard, in dBm.
const SILENCE_DBM: f32 = -120.0;

impl<'a> Neighbours<'a> {
    /// Finds 1 to [`Neighbours::MOST`] neighbours in a map of [`Encoding::Moments`].
    ///
    /// # Errors
    /// For another map or number of neighbours, or when a field of the configuration is out of range.
    pub fn new(map: RadioMap<'a>, neighbours: u8, config: &Config) -> Result<Self, ConfigError> {
        config.check()?;
        map.check_encoding(Encoding::Moments)?;
        require!(
            (1..=Self::MOST).contains(&neighbours),
            "neighbours is not within 1 and 16"
        );
        Ok(Self {
            map,
            config: *config,
            neighbours,
        })
    }

    /// The most neighbours.
    pub const MOST: u8 = 16;

    /// Sum of the squared distances between a scan and the means of a point, in dB^2.
    fn squares(&self, scan: &[Reading], point: usize) -> f32 {
        let mut sum = 0.0;
        for reading in accepted(scan, &self.config) {
            let moments = self.map.moments(reading.beacon.into(), point);
            let mean = moments.map_or(SILENCE_DBM, |moments| moments.mean_dbm);
            sum += (reading.rssi_dbm - mean) * (reading.rssi_dbm - mean);
        }
        sum
    }
}

impl Matcher for Neighbours<'_> {
    fn locate<const P: usize>(
        &self,
        scan: &[Reading],
        posterior: &mut Posterior<P>,
    ) -> Result<Match, ReadingError> {
        let used = check::<P>(&self.map, scan, &self.config)?;
        let lattice = self.map.lattice();
        // In ascending order of their distances.
        let mut nearest = [(f32::INFINITY, 0); Self::MOST as usize];
        for point in (0..lattice.points()).filter(|point| self.map.is_surveyed(*point)) {
            let mut next = (self.squares(scan, point), point);
            for kept in &mut nearest {
                if next.0 < kept.0 {
                    core::mem::swap(kept, &mut next);
                }
            }
        }
        let weights = posterior
            .log_likelihoods_mut(lattice.points())
            .ok_or(ReadingError::Points)?;
        weights.fill(0.0);
        let kept = nearest.iter().take(self.neighbours.into());
        for (_, point) in kept.filter(|(squares, _)| *squares < f32::INFINITY) {
            if let Some(weight) = weights.get_mut(*point) {
                *weight = 1.0;
            }
        }
        let (squares, point) = nearest[0];
        Ok(posterior.of_weights(lattice, (point, -squares, used)))
    }
}
