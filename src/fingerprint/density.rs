//! Matching by kernel densities of the samples themselves.

use core::f32::consts::TAU;

use super::{
    Lattice, MapError, Match, MatchError, Matcher, Posterior, Reading, Settings, check_beacons,
    for_each_accepted,
};
use crate::math::{exp, ln, sqrt};

/// The samples of a survey: as many of every beacon at every point.
#[derive(Debug, Clone, Copy)]
pub struct Samples<'a> {
    lattice: Lattice,
    beacons: u8,
    /// Samples of a beacon at a point.
    each: usize,
    values: &'a [i8],
}

impl<'a> Samples<'a> {
    /// Of values in dBm: by point, then by beacon.
    ///
    /// # Errors
    /// [`MapError::Beacons`] when there is none, [`MapError::Length`] when there are not as many values, at least one,
    /// for each beacon at each point.
    pub const fn new(lattice: Lattice, beacons: u8, values: &'a [i8]) -> Result<Self, MapError> {
        let sets = lattice.points() * beacons as usize;
        let (Some(each), Some(rest)) = (
            values.len().checked_div(sets),
            values.len().checked_rem(sets),
        ) else {
            return Err(MapError::Beacons);
        };
        if each == 0 || rest != 0 {
            return Err(MapError::Length);
        }
        Ok(Self {
            lattice,
            beacons,
            each,
            values,
        })
    }

    /// The samples of a beacon at a point, in dBm; none for numbers that it has not.
    pub fn of(&self, point: usize, beacon: usize) -> &'a [i8] {
        let start = (point * usize::from(self.beacons) + beacon) * self.each;
        let known = point < self.lattice.points() && beacon < usize::from(self.beacons);
        let samples = self
            .values
            .get(start..)
            .and_then(|rest| rest.get(..self.each));
        samples.filter(|_| known).unwrap_or_default()
    }

    /// Where the points lie.
    pub const fn lattice(&self) -> &Lattice {
        &self.lattice
    }
}

/// Compares scans with the samples of a survey (Cui et al. 2017, eq. 1 to 7): the density of a reading at a point is
/// the mean of normal densities about the samples there, besides the share of outliers.
///
/// This takes an exponential for each sample, some 30 times the work of [`super::TableMatcher`] and three times its
/// memory: it is what that one is measured against. Missing beacons say nothing.
///
/// ```
/// use foxhunt::fingerprint::{KernelDensity, Lattice, Matcher, Posterior, Reading, Samples, Settings};
///
/// // Three points, a beacon, two samples each.
/// let lattice = Lattice::new([0.0, 0.0], 1.0, 3, 1)?;
/// let samples = Samples::new(lattice, 1, &[-50, -52, -60, -61, -70, -69])?;
/// let matcher = KernelDensity::new(samples, 4.0, &Settings::new())?;
/// let mut posterior = Posterior::<3>::new();
/// let scan = [Reading { beacon: 0, rssi_dbm: -62.0 }];
/// assert_eq!(matcher.locate(&scan, &mut posterior)?.point, 1);
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct KernelDensity<'a> {
    samples: Samples<'a>,
    settings: Settings,
    /// -1 / (2 h^2)
    curvature: f32,
    /// What the sum over the samples is multiplied with.
    scale: f32,
}

impl<'a> KernelDensity<'a> {
    /// With kernels of the given standard deviation, in dB: it has to cover how a scan differs from a survey, 4 to 6
    /// for a person who walks.
    ///
    /// # Errors
    /// [`MapError::Levels`] when it is not within 0.1 and 50.
    pub fn new(
        samples: Samples<'a>,
        bandwidth_db: f32,
        settings: &Settings,
    ) -> Result<Self, MapError> {
        if !(0.1..=50.0).contains(&bandwidth_db) {
            return Err(MapError::Levels);
        }
        Ok(Self {
            samples,
            settings: *settings,
            curvature: -0.5 / (bandwidth_db * bandwidth_db),
            scale: settings.inliers() / (samples.each as f32 * bandwidth_db * sqrt(TAU)),
        })
    }

    /// Natural logarithm of the density, per dB, of a reading at a point.
    pub fn log_density(&self, reading: &Reading, point: usize) -> f32 {
        let mut sum = 0.0;
        for sample in self.samples.of(point, reading.beacon.into()) {
            let distance = reading.rssi_dbm - f32::from(*sample);
            sum += exp(self.curvature * distance * distance);
        }
        ln(sum * self.scale + self.settings.floor())
    }
}

impl Matcher for KernelDensity<'_> {
    fn locate<const P: usize>(
        &self,
        scan: &[Reading],
        posterior: &mut Posterior<P>,
    ) -> Result<Match, MatchError> {
        let lattice = self.samples.lattice;
        check_beacons(self.samples.beacons.into(), scan)?;
        let used = for_each_accepted(scan, &self.settings, |_| ())?;
        let room = posterior
            .log_likelihoods_mut(lattice.points())
            .ok_or(MatchError::Points)?;
        for (point, sum) in room.iter_mut().enumerate() {
            *sum = 0.0;
            for_each_accepted(scan, &self.settings, |reading| {
                *sum += self.log_density(reading, point);
            })?;
        }
        let (located, log_likelihood) = posterior
            .of_log_likelihoods(&lattice, self.settings.tempering())
            .ok_or(MatchError::Survey)?;
        Ok(located.with(log_likelihood, used))
    }
}
