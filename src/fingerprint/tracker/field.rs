//! The likelihood of a scan at every point of the map, and between the points.

use super::Config;
use super::offset::OffsetBelief;
use super::pending::Level;
use crate::fingerprint::{Lattice, RadioMap, map::LOWEST_MEAN_DBM};
use crate::math::{exp_of_weight, ln};

/// The log-likelihood of every point, up to a common summand.
///
/// It is computed for each point, not for each particle: there are about as many points as particles, and a particle then
/// takes only an interpolation.
#[derive(Debug, Clone)]
pub(super) struct Field<const P: usize> {
    log_likelihoods: [f32; P],
    /// By point: the correction of the mean of the offset, if the tag has one.
    shifts: [f32; P],
    /// By point: the probability that the tag has an offset.
    probabilities: [f32; P],
    /// How much the scan adds to the precision of the offset, per dB^2: the mean over the points.
    pub precision: f32,
    /// The mean over the points of the likelihood, relative to that of the best point.
    pub mean: f32,
}

/// A beacon of a scan, ready to be compared. Levels are in halves of a dB, as the means of the map.
struct Comparison<'a> {
    row: &'a [[u8; 2]],
    /// Above the lowest mean.
    level: f32,
    /// The factor of the squared sigma, in quarters of a dB, for the mean of several packets.
    scale: f32,
}

impl<const P: usize> Field<P> {
    pub const EMPTY: Self = Self {
        log_likelihoods: [0.0; P],
        shifts: [0.0; P],
        probabilities: [0.0; P],
        precision: 0.0,
        mean: 0.0,
    };

    /// Compares a scan with every point: under the better of two hypotheses, that the tag has no offset and that it has
    /// one.
    pub fn look_up<const B: usize>(
        &mut self,
        map: &RadioMap<'_>,
        config: &Config,
        belief: &OffsetBelief,
        scan: &[Level; B],
    ) {
        let mut comparisons: heapless::Vec<Comparison<'_>, B> = heapless::Vec::new();
        for (beacon, level) in scan.iter().enumerate() {
            if let (Some(row), 1..) = (map.moments_row(beacon), level.packets) {
                // There are no more than levels.
                let _ = comparisons.push(Comparison {
                    row,
                    level: 2.0 * (level.mean_dbm - LOWEST_MEAN_DBM),
                    scale: 0.25 / f32::from(level.packets)
                        + 0.25 / f32::from(config.survey_samples),
                });
            }
        }
        let points = map.lattice().points();
        let mut top = f32::NEG_INFINITY;
        let mut precision = 0.0;
        let each = self
            .log_likelihoods
            .iter_mut()
            .zip(&mut self.shifts)
            .zip(&mut self.probabilities);
        for (point, ((log_likelihood, shift), probability)) in each.enumerate().take(points) {
            let mut sums = Sums::new(config, belief);
            for Comparison { row, level, scale } in &comparisons {
                if let Some([sigma, mean]) = row.get(point) {
                    let sigma = f32::from(*sigma);
                    sums.add(level - f32::from(*mean), sigma * sigma * scale);
                }
            }
            let found = sums.conclude();
            precision += found.precision;
            *shift = found.shift;
            *probability = found.probability;
            *log_likelihood = if map.is_surveyed(point) {
                found.log_likelihood
            } else {
                f32::NEG_INFINITY
            };
            if *log_likelihood > top {
                top = *log_likelihood;
            }
        }
        let mut sum = 0.0;
        for log_likelihood in self.log_likelihoods.iter_mut().take(points) {
            *log_likelihood -= top;
            sum += exp_of_weight(*log_likelihood);
        }
        let each = 1.0 / points as f32;
        self.precision = precision * each;
        self.mean = sum * each;
    }

    /// The log-likelihood of a place on a map of one row or one column, by its coordinate along that; minus infinity
    /// beyond the map.
    #[inline(always)]
    pub fn on_line(&self, lattice: &Lattice, coordinate: f32, origin: f32) -> f32 {
        let steps = (coordinate - origin) * lattice.per_metre();
        match before(steps, lattice.points()) {
            Some((first, fraction)) => self.between(first, fraction),
            None => f32::NEG_INFINITY,
        }
    }

    /// The log-likelihood of a place on a map of several rows and columns; minus infinity beyond the map.
    #[inline(always)]
    pub fn in_plane(&self, lattice: &Lattice, [x, y]: [f32; 2]) -> f32 {
        let [x0, y0] = lattice.origin();
        let Some((column, s)) = before((x - x0) * lattice.per_metre(), lattice.columns()) else {
            return f32::NEG_INFINITY;
        };
        let Some((row, t)) = before((y - y0) * lattice.per_metre(), lattice.rows()) else {
            return f32::NEG_INFINITY;
        };
        let first = row * lattice.columns() + column;
        let above = first + lattice.columns();
        mix(self.between(first, s), self.between(above, s), t)
    }

    /// Interpolates between a point and the next one.
    #[inline(always)]
    fn between(&self, first: usize, fraction: f32) -> f32 {
        let pair = self.log_likelihoods.get(first..);
        match pair.and_then(|rest| rest.first_chunk()) {
            Some([a, b]) => mix(*a, *b, fraction),
            None => f32::NEG_INFINITY,
        }
    }

    /// By the point nearest to a place: the probability of an offset, and the correction of its mean.
    #[inline(always)]
    pub fn offset_at(&self, lattice: &Lattice, place: [f32; 2]) -> [f32; 2] {
        let point = lattice.nearest(place);
        match (self.probabilities.get(point), self.shifts.get(point)) {
            (Some(probability), Some(shift)) => [*probability, *shift],
            _ => [0.0; 2],
        }
    }

    /// The likelihood of every point, relative to the best one.
    pub fn likelihoods(&self, lattice: &Lattice) -> impl Iterator<Item = f32> {
        let points = self.log_likelihoods.iter().take(lattice.points());
        points.map(|log_likelihood| exp_of_weight(*log_likelihood))
    }
}

/// The last point at or before a place, so many `steps` from the first of `points` in a line, and the fraction of a step
/// beyond it; none beyond the line, or for NaN.
#[inline(always)]
fn before(steps: f32, points: usize) -> Option<(usize, f32)> {
    let last = points.saturating_sub(1);
    if !(steps >= 0.0 && steps <= last as f32) {
        return None;
    }
    let first = (steps as usize).min(last.saturating_sub(1));
    Some((first, steps - first as f32))
}

/// Interpolates between `a` and `b`; minus infinity if one of them is.
#[inline(always)]
fn mix(a: f32, b: f32, fraction: f32) -> f32 {
    let lowest = if a < b { a } else { b };
    if lowest == f32::NEG_INFINITY {
        lowest
    } else {
        a + fraction * (b - a)
    }
}

/// Sums over the beacons of a scan at one point, in halves of a dB.
struct Sums<'a> {
    config: &'a Config,
    belief: &'a OffsetBelief,
    /// Of the offset.
    mean: f32,
    variance: f32,
    /// The largest cost of a reading, doubled as all costs.
    gate: f32,
    mismatch: f32,
    /// Without an offset.
    cost: f32,
    /// With the mean of the offset.
    cost_with: f32,
    /// Over the readings within the gate of the offset: precisions, and differences weighted by them.
    precision: f32,
    weighted: f32,
    /// Product of all precisions; its logarithm is taken when it gets small.
    product: f32,
}

/// The result of one point.
struct Found {
    log_likelihood: f32,
    precision: f32,
    shift: f32,
    probability: f32,
}

impl<'a> Sums<'a> {
    #[inline(always)]
    fn new(config: &'a Config, belief: &'a OffsetBelief) -> Self {
        Self {
            config,
            belief,
            mean: 2.0 * belief.mean_db,
            variance: 4.0 * belief.variance,
            gate: config.gate_sigmas * config.gate_sigmas,
            mismatch: 4.0 * config.mismatch_sigma_db * config.mismatch_sigma_db,
            cost: 0.0,
            cost_with: 0.0,
            precision: 0.0,
            weighted: 0.0,
            product: 1.0,
        }
    }

    /// Adds a reading that differs so much from the mean of the map, which has this variance.
    #[inline(always)]
    fn add(&mut self, difference: f32, variance: f32) {
        let precision = 1.0 / (variance + self.mismatch);
        let least = |a: f32, b: f32| if a < b { a } else { b };
        self.cost += least(difference * difference * precision, self.gate);
        if self.belief.is_estimated() {
            let difference = difference - self.mean;
            let cost = difference * difference * precision;
            // An offset that is not known well leaves room for larger differences.
            if cost < self.gate * (1.0 + self.variance * precision) {
                self.cost_with += cost;
                self.precision += precision;
                self.weighted += difference * precision;
            } else {
                self.cost_with += self.gate;
            }
        }
        self.product *= precision;
        if self.product < 1e-25 {
            let logarithm = ln(self.product);
            self.cost -= logarithm;
            self.cost_with -= logarithm;
            self.product = 1.0;
        }
    }

    #[inline(always)]
    fn conclude(self) -> Found {
        let tempering = self.config.tempering;
        let logarithm = ln(self.product);
        let half = 0.5 * tempering;
        let without = half * (logarithm - self.cost);
        if !self.belief.is_estimated() {
            return Found {
                log_likelihood: without,
                precision: 0.0,
                shift: 0.0,
                probability: 0.0,
            };
        }
        let precision = tempering * self.precision;
        let weighted = tempering * self.weighted;
        let known = 1.0 + self.variance * precision;
        let gain = self.variance / known;
        let with =
            half * (logarithm - self.cost_with) + 0.5 * (gain * weighted * weighted - ln(known));
        // The sum of both is at most ln 2 above the larger.
        let (without_prior, with_prior) =
            (without + self.belief.log_none, with + self.belief.log_some);
        Found {
            log_likelihood: if with_prior > without_prior {
                with_prior
            } else {
                without_prior
            },
            precision: 4.0 * precision,
            shift: 0.5 * gain * weighted,
            probability: self.belief.probability_given(with - without),
        }
    }
}
