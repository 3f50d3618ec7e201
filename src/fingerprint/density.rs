//! Matching by kernel densities of the samples themselves.

use core::f32::consts::TAU;

use super::matcher::{accepted, count_accepted};
use super::{Config, Lattice, Match, Matcher, Posterior, Reading, ReadingError};
use crate::ConfigError;
use crate::config::require;
use crate::math::{exp, ln, sqrt};

/// Compares scans with the samples of a survey (Cui et al. 2017, eq. 1 to 7): the density of a reading at a point is
/// the mean of normal densities about the samples there, plus the density of outliers.
///
/// This takes an exponential for each sample, some 30 times the work of [`super::TableMatcher`] and three times its
/// memory: it is the reference for that one. Missing beacons say nothing.
///
/// ```
/// use foxhunt::fingerprint::{Config, KernelDensity, Lattice, Matcher, Posterior, Reading};
///
/// // Three points, a beacon, two samples each.
/// let lattice = Lattice::new([0.0, 0.0], 1.0, 3, 1)?;
/// let samples = [-50, -52, -60, -61, -70, -69];
/// let matcher = KernelDensity::new(lattice, 1, &samples, 4.0, &Config::DEFAULT)?;
/// let mut posterior = Posterior::<3>::EMPTY;
/// let scan = [Reading { beacon: 0, rssi_dbm: -62.0 }];
/// assert_eq!(matcher.locate(&scan, &mut posterior)?.point, 1);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct KernelDensity<'a> {
    lattice: Lattice,
    beacons: u8,
    /// Samples of a beacon at a point.
    each: usize,
    samples: &'a [i8],
    config: Config,
    /// -1 / (2 h^2)
    curvature: f32,
    /// What the sum over the samples is multiplied with.
    scale: f32,
}

impl<'a> KernelDensity<'a> {
    /// With as many `samples`, in dBm, of every beacon at every point: by point, then by beacon. `bandwidth_db` is the
    /// standard deviation of the kernels, 0.1 to 50 dB: it has to cover how a scan differs from a survey, 4 to 6 for a
    /// person who walks.
    ///
    /// # Errors
    /// When `beacons`, `samples`, `bandwidth_db` or a field of the configuration is out of range.
    pub fn new(
        lattice: Lattice,
        beacons: u8,
        samples: &'a [i8],
        bandwidth_db: f32,
        config: &Config,
    ) -> Result<Self, ConfigError> {
        config.check()?;
        require!(
            (0.1..=50.0).contains(&bandwidth_db),
            "bandwidth_db is not within 0.1 and 50"
        );
        require!(beacons > 0, "beacons is 0");
        let sets = lattice.points() * usize::from(beacons);
        let each = samples.len().checked_div(sets).unwrap_or(0);
        require!(
            each > 0 && each * sets == samples.len(),
            "samples is not a multiple of the points times the beacons"
        );
        Ok(Self {
            lattice,
            beacons,
            each,
            samples,
            config: *config,
            curvature: -0.5 / (bandwidth_db * bandwidth_db),
            scale: config.inlier_rate() / (each as f32 * bandwidth_db * sqrt(TAU)),
        })
    }

    /// Natural logarithm of the density, per dB, of a reading at a point.
    fn log_density(&self, reading: &Reading, point: usize) -> f32 {
        let start = (point * usize::from(self.beacons) + usize::from(reading.beacon)) * self.each;
        let samples = self.samples.get(start..);
        let samples = samples.and_then(|rest| rest.get(..self.each));
        let mut sum = 0.0;
        for sample in samples.unwrap_or_default() {
            let distance = reading.rssi_dbm - f32::from(*sample);
            sum += exp(self.curvature * distance * distance);
        }
        ln(sum * self.scale + self.config.floor())
    }
}

impl Matcher for KernelDensity<'_> {
    fn locate<const P: usize>(
        &self,
        scan: &[Reading],
        posterior: &mut Posterior<P>,
    ) -> Result<Match, ReadingError> {
        let used = count_accepted(self.beacons.into(), scan, &self.config)?;
        let room = posterior
            .log_likelihoods_mut(self.lattice.points())
            .ok_or(ReadingError::Points)?;
        for (point, sum) in room.iter_mut().enumerate() {
            *sum = 0.0;
            for reading in accepted(scan, &self.config) {
                *sum += self.log_density(reading, point);
            }
        }
        posterior.of_log_likelihoods(&self.lattice, self.config.tempering, used)
    }
}
