//! The walk of the published experiment, and what it is measured against.

use rand::Rng;

use crate::reference::corridor::LineMap;
use foxhunt_simulation::survey::Survey;
use foxhunt_simulation::tunnel::{Radio, Site, Tunnel};

/// Seconds from one scan to the next.
pub const INTERVAL: f64 = 2.0;
/// Metres between the points of the survey, from one end of the tunnel to the other.
pub const SPACING: f64 = 1.0;
/// Readings of each beacon at each of these points.
pub const SAMPLES: usize = 50;
/// Across the tunnel, in metres: where the survey is taken, and where the person walks.
pub const SURVEYED: f64 = 1.75;
/// See [`SURVEYED`].
pub const WALKED: f64 = 1.2;
/// Variance that the survey's map is given for not being where the person walks, in dB^2.
pub const MISMATCH: f64 = 4.0;

/// One run: a tunnel with its shadowing drawn, a survey, and a walk at 2.5 metres a second with a scan every
/// [`INTERVAL`].
#[derive(Debug, Clone)]
pub struct Run {
    /// The tunnel.
    pub site: Site,
    /// Its survey, every [`SPACING`] along [`SURVEYED`].
    pub survey: Survey,
    /// Where each scan was taken, in metres along the tunnel.
    pub truth: Vec<f64>,
    /// The scans: for each beacon the mean of [`Run::packets`] packets.
    pub scans: Vec<Vec<Option<f64>>>,
    /// Packets of each beacon in a scan.
    pub packets: usize,
}

impl Run {
    /// Draws a run whose packets have `noise` dB of noise, `packets` of them in a scan.
    pub fn draw(noise: f64, packets: usize, rng: &mut impl Rng) -> Self {
        let site = Tunnel::default().draw(rng);
        let radio = Radio::new(noise);
        let points = (site.tunnel.length / SPACING).round() as usize;
        let places: Vec<[f64; 2]> = (0..=points)
            .map(|n| [n as f64 * SPACING, SURVEYED])
            .collect();
        let survey = site.survey(&places, SAMPLES, &radio, rng);
        let truth: Vec<f64> = (0..=16).map(|k| 5.0 * f64::from(k)).collect();
        let scans = truth
            .iter()
            .map(|x| site.scan([*x, WALKED], packets, &radio, rng))
            .collect();
        Self {
            site,
            survey,
            truth,
            scans,
            packets,
        }
    }

    /// Mean and variance of the survey, as a map along the tunnel.
    pub fn map(&self) -> LineMap {
        let levels = |place| {
            let level = |beacon| {
                let level = self.survey.level(place, beacon).expect("nothing is lost");
                [level.mean, level.variance]
            };
            (0..self.survey.beacons()).map(level).collect()
        };
        LineMap {
            spacing: SPACING,
            levels: (0..self.survey.places.len()).map(levels).collect(),
        }
    }

    /// Log-likelihood of every scan at every one of `places`, by the survey's map.
    pub fn log_likelihoods(&self, places: &[f64]) -> Vec<Vec<f64>> {
        let map = self.map();
        let means = 1.0 / self.packets as f64 + 1.0 / SAMPLES as f64;
        let at = |x: &f64, scan: &[Option<f64>]| {
            map.log_likelihood(*x, scan, |variance| variance * means + MISMATCH)
        };
        let of_scan = |scan: &Vec<_>| places.iter().map(|x| at(x, scan)).collect();
        self.scans.iter().map(of_scan).collect()
    }

    /// Where the survey's samples put a scan: the mean of a kernel density over all beacons at once, with
    /// Gaussian kernels of `width` dB.
    pub fn matched(&self, scan: &[Option<f64>], width: f64) -> f64 {
        let kernel = |point: &[Vec<f64>], sample: usize| {
            let distances = point.iter().zip(scan).filter_map(|(samples, level)| {
                level.map(|level| ((level - samples[sample]) / width).powi(2))
            });
            -0.5 * distances.sum::<f64>()
        };
        let exponents: Vec<Vec<f64>> = (self.survey.samples.iter())
            .map(|point| (0..SAMPLES).map(|sample| kernel(point, sample)).collect())
            .collect();
        let largest = exponents.iter().flatten().fold(f64::MIN, |a, b| a.max(*b));
        let (mut total, mut sum) = (0.0, 0.0);
        for (place, exponents) in self.survey.places.iter().zip(&exponents) {
            let density: f64 = exponents.iter().map(|e| (e - largest).exp()).sum();
            total += density;
            sum += density * place[0];
        }
        sum / total
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix1x2, Matrix2, Vector2};

    use super::*;
    use crate::reference::{
        Kalman,
        corridor::{CorridorFilter, Motion},
    };
    use foxhunt_simulation::random::generator;

    /// Noise and packets of the columns of the table.
    const COLUMNS: [(f64, usize); 4] = [(2.0, 1), (4.0, 1), (6.0, 1), (4.0, 10)];
    const RUNS: u64 = 200;
    /// Runs behind the table's figures.
    const TABLE_RUNS: f64 = 1000.0;

    /// Squared errors and fraction of steps within 2 m, run by run.
    #[derive(Default)]
    struct Errors {
        squared: Vec<f64>,
        near: Vec<f64>,
    }

    impl Errors {
        fn add(&mut self, truth: &[f64], estimates: impl Iterator<Item = f64>) {
            let errors: Vec<f64> = truth.iter().zip(estimates).map(|(x, e)| e - x).collect();
            let count = errors.len() as f64;
            let near = errors.iter().filter(|error| error.abs() < 2.0).count();
            self.squared
                .push(errors.iter().map(|e| e * e).sum::<f64>() / count);
            self.near.push(near as f64 / count);
        }

        /// Whether both are compatible with a root mean square error and a percentage that come from
        /// [`TABLE_RUNS`] other runs and were rounded to the `digit`.
        ///
        /// Four standard deviations of the difference are allowed, estimated from our runs: one check in
        /// 16,000 would fail by chance were the means normal, and some more as errors have long tails.
        fn check(&self, rmse: f64, percent: f64) {
            let check = |values: &[f64], expected: f64, rounding: f64| {
                let count = values.len() as f64;
                let mean = values.iter().sum::<f64>() / count;
                let variance =
                    values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0);
                let allowed = 4.0 * (variance * (1.0 / count + 1.0 / TABLE_RUNS)).sqrt() + rounding;
                assert!(
                    (mean - expected).abs() < allowed,
                    "{mean:.3}, but {expected:.3} +- {allowed:.3} in the table"
                );
            };
            check(&self.squared, rmse * rmse, 0.01 * rmse);
            check(&self.near, percent / 100.0, 0.005);
        }
    }

    fn runs(column: usize) -> impl Iterator<Item = Run> {
        let (noise, packets) = COLUMNS[column];
        (0..RUNS).map(move |run| Run::draw(noise, packets, &mut generator(41 + column as u64, run)))
    }

    #[test]
    fn the_exact_filter_reaches_the_published_figures() {
        let table = [(1.82, 89.0), (3.60, 68.0), (5.59, 51.0), (1.33, 94.0)];
        let filter = CorridorFilter::new(&Motion::default(), 0.5, 17);
        let places: Vec<f64> = filter.places().collect();
        for (column, (rmse, percent)) in table.into_iter().enumerate() {
            let mut errors = Errors::default();
            for run in runs(column) {
                let beliefs = filter.run(&run.log_likelihoods(&places));
                errors.add(&run.truth, beliefs.iter().map(|belief| belief.mean));
            }
            errors.check(rmse, percent);
        }
    }

    /// Match, then filter: positions taken for normal with a variance of 200 m^2.
    #[test]
    fn the_kalman_filter_as_printed_reaches_the_published_figures() {
        let table = [(3.22, 52.0), (4.95, 38.0), (7.64, 28.0), (3.43, 47.0)];
        let motion = Motion::default();
        let transition = Matrix2::new(1.0, INTERVAL, 0.0, 1.0);
        let push = Vector2::new(0.5 * INTERVAL * INTERVAL, INTERVAL) * motion.acceleration;
        let process = push * push.transpose();
        let row = Matrix1x2::new(1.0, 0.0);
        for (column, (rmse, percent)) in table.into_iter().enumerate() {
            let mut errors = Errors::default();
            for run in runs(column) {
                let first = run.matched(&run.scans[0], 2.0);
                let mut kalman = Kalman {
                    mean: Vector2::new(first, 0.0),
                    covariance: Matrix2::new(200.0, 0.0, 0.0, motion.velocity.powi(2)),
                };
                let mut estimates = vec![first];
                for scan in &run.scans[1..] {
                    kalman.predict(&transition, &process);
                    kalman.update(&row, run.matched(scan, 2.0), 200.0);
                    estimates.push(kalman.mean[0]);
                }
                errors.add(&run.truth, estimates.into_iter());
            }
            errors.check(rmse, percent);
        }
    }
}
