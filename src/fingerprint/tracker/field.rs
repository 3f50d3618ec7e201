//! The likelihood of a scan at every point of the map, and between the points.

use super::Config;
use super::cloud::Cloud;
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
    /// By point: the weights of the particles that are nearest to it, or a mark.
    weights: [f32; P],
    /// How much the scan adds to the precision of the offset, per dB^2: the mean over the points.
    pub precision: f32,
    /// The log-likelihood of the best point.
    pub top: f32,
    /// The mean over the points of the likelihood, relative to that of the best point.
    pub mean: f32,
}

/// Sums over some of the points.
struct Part {
    /// The largest log-likelihood.
    top: f32,
    /// Of the likelihoods, relative to that.
    likelihoods: f32,
    precisions: f32,
    points: u16,
}

impl Part {
    const EMPTY: Self = Self {
        top: f32::NEG_INFINITY,
        likelihoods: 0.0,
        precisions: 0.0,
        points: 0,
    };

    #[inline(always)]
    fn add(&mut self, found: &Found) {
        if found.log_likelihood > self.top {
            self.likelihoods *= exp_of_weight(self.top - found.log_likelihood);
            self.top = found.log_likelihood;
        }
        // Nothing for NaN: both may be minus infinity.
        self.likelihoods += exp_of_weight(found.log_likelihood - self.top);
        self.precisions += found.precision;
        self.points += 1;
    }
}

/// The mean over a map, of which one part was looked up as a whole and the rest in part.
struct Mean {
    whole: Part,
    sampled: Part,
}

impl Mean {
    const EMPTY: Self = Self {
        whole: Part::EMPTY,
        sampled: Part::EMPTY,
    };

    #[inline(always)]
    fn of(&mut self, is_whole: bool) -> &mut Part {
        if is_whole { &mut self.whole } else { &mut self.sampled }
    }

    /// Of so many points.
    fn conclude<const P: usize>(&self, points: usize, field: &mut Field<P>) {
        let Self { whole, sampled } = self;
        let rest = points as f32 - f32::from(whole.points);
        let of_sampled = if sampled.points > 0 {
            rest / f32::from(sampled.points)
        } else {
            0.0
        };
        let top = if whole.top > sampled.top { whole.top } else { sampled.top };
        let likelihoods = whole.likelihoods * exp_of_weight(whole.top - top)
            + of_sampled * (sampled.likelihoods * exp_of_weight(sampled.top - top));
        let each = 1.0 / points as f32;
        field.top = top;
        field.mean = each * likelihoods;
        field.precision = each * (whole.precisions + of_sampled * sampled.precisions);
    }
}

/// The log-likelihood of a point that was not surveyed: a weight of zero, also for places between it and others.
const IMPOSSIBLE: f32 = -1e7;

/// Whether a log-likelihood is that of a place that is not impossible; false for NaN.
#[inline(always)]
pub(super) fn is_possible(log_likelihood: f32) -> bool {
    log_likelihood > 0.01 * IMPOSSIBLE
}

/// Points that are compared with a scan side by side: their sums stay in registers.
const BLOCK: usize = 2;

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
        weights: [0.0; P],
        precision: 0.0,
        top: 0.0,
        mean: 0.0,
    };

    /// Compares a scan with every point: under the better of two hypotheses, that the tag has no offset and that it has
    /// one.
    pub fn look_up_all<const B: usize>(
        &mut self,
        map: &RadioMap<'_>,
        config: &Config,
        belief: &OffsetBelief,
        scan: &[Level; B],
    ) {
        self.weights.fill(1.0);
        self.look_up(map, config, belief, scan);
    }

    /// The same for the points about particles; of the others it takes as many as the mean over the map needs.
    pub fn look_up_at<const N: usize, const B: usize>(
        &mut self,
        cloud: &Cloud<N>,
        map: &RadioMap<'_>,
        config: &Config,
        belief: &OffsetBelief,
        scan: &[Level; B],
    ) {
        self.mark(cloud);
        self.look_up(map, config, belief, scan);
    }

    /// Gives a weight to the first point of every cell that has particles.
    fn mark<const N: usize>(&mut self, cloud: &Cloud<N>) {
        self.weights.fill(0.0);
        for cell in &cloud.cells {
            if let Some(weight) = self.weights.get_mut(usize::from(*cell)) {
                *weight = 1.0;
            }
        }
    }

    /// Whether one of the points of a block is a corner of a cell that has particles.
    #[inline(always)]
    fn is_marked(&self, first: usize, columns: usize) -> bool {
        // From the cell before the block to the one that begins at its last point.
        let any = |from: Option<usize>| {
            let cells = from.and_then(|from| self.weights.get(from..));
            let cells = cells.and_then(<[_]>::first_chunk::<{ BLOCK + 1 }>);
            cells.is_some_and(|[a, b, c]| a + b + c > 0.0)
        };
        // Before the first point there is no cell: one too many is looked at.
        any(Some(first.saturating_sub(1))) || any(first.checked_sub(columns + 1))
    }

    /// Compares a scan with the points of marked cells; and with one block in four of the others (every second one in every
    /// second row) or, on a line, every second one: they stand for those that are left out.
    #[inline(never)]
    fn look_up<const B: usize>(
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
        let terms = Terms::new(config, belief);
        let lattice = map.lattice();
        let points = lattice.points();
        let columns = if lattice.is_plane() {
            lattice.columns()
        } else {
            points
        };
        let mut mean = Mean::EMPTY;
        let (mut row, mut is_sampled) = (0, true);
        while row < points {
            let end = row + columns;
            let mut first = row;
            while first < end {
                let is_marked = self.is_marked(first, columns);
                if is_marked || is_sampled && (first - row) & BLOCK == 0 {
                    if first + BLOCK <= end {
                        self.compare::<BLOCK>(first, &comparisons, &terms, map, mean.of(is_marked));
                    } else {
                        self.compare::<1>(first, &comparisons, &terms, map, mean.of(is_marked));
                    }
                }
                first += BLOCK;
            }
            row = end;
            is_sampled = !is_sampled;
        }
        mean.conclude(points, self);
    }

    /// Compares some points, from the `first` on, with the beacons of a scan.
    #[inline(always)]
    fn compare<const K: usize>(
        &mut self,
        first: usize,
        comparisons: &[Comparison<'_>],
        terms: &Terms<'_>,
        map: &RadioMap<'_>,
        mean: &mut Part,
    ) {
        let mut sums = [Sums::EMPTY; K];
        for comparisons in comparisons.chunks(Sums::FACTORS) {
            for Comparison { row, level, scale } in comparisons {
                let Some(points) = row.get(first..).and_then(<[_]>::first_chunk::<K>) else {
                    continue;
                };
                for (sums, [sigma, mean]) in sums.iter_mut().zip(points) {
                    let sigma = f32::from(*sigma);
                    sums.add(level - f32::from(*mean), sigma * sigma * scale, terms);
                }
            }
            for sums in &mut sums {
                sums.shorten();
            }
        }
        for (lane, sums) in sums.into_iter().enumerate() {
            let mut found = sums.conclude(terms);
            let point = first + lane;
            if !map.is_complete() && !map.is_surveyed(point) {
                found.log_likelihood = IMPOSSIBLE;
            }
            mean.add(&found);
            if let (Some(log_likelihood), Some(shift), Some(probability)) = (
                self.log_likelihoods.get_mut(point),
                self.shifts.get_mut(point),
                self.probabilities.get_mut(point),
            ) {
                *log_likelihood = found.log_likelihood;
                *shift = found.shift;
                *probability = found.probability;
            }
        }
    }

    /// The log-likelihood on a map of one row or one column, in a cell, a fraction of it beyond its first point.
    #[inline(always)]
    pub fn on_line(&self, cell: u16, fraction: f32) -> f32 {
        self.between(usize::from(cell), fraction)
    }

    /// The log-likelihood on a map of several rows and columns, in a cell, fractions of it beyond its first point.
    #[inline(always)]
    pub fn in_plane(&self, cell: u16, columns: usize, [s, t]: [f32; 2]) -> f32 {
        let first = usize::from(cell);
        mix(self.between(first, s), self.between(first + columns, s), t)
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

    /// Teaches the belief about the offset what the particles think of it, whose weights add up to `total`: each as the point
    /// that is nearest to it.
    #[inline(never)]
    pub fn teach<const N: usize>(
        &mut self,
        belief: &mut OffsetBelief,
        lattice: &Lattice,
        cloud: &Cloud<N>,
        total: f32,
    ) {
        if !belief.is_estimated() {
            return;
        }
        let points = lattice.points();
        let by_point = self.weights.get_mut(..points).unwrap_or_default();
        by_point.fill(0.0);
        // Saturates; NaN becomes 0.
        let nearest = |steps: f32| (steps + 0.5) as usize;
        let [x, y] = &cloud.places;
        let is_plane = lattice.is_plane();
        for (weight, (x, y)) in cloud.weights.iter().zip(x.iter().zip(y)) {
            let column = nearest(*x);
            let point = if is_plane {
                nearest(*y) * lattice.columns() + column
            } else {
                column
            };
            if let Some(of_point) = by_point.get_mut(point) {
                *of_point += weight;
            }
        }
        let opinions = self.probabilities.iter().zip(&self.shifts);
        let opinions = by_point.iter().zip(opinions);
        belief.learn(self.precision, total, opinions);
    }

    /// The likelihood of every point, relative to the best one.
    pub fn likelihoods(&self, lattice: &Lattice) -> impl Iterator<Item = f32> {
        let points = self.log_likelihoods.iter().take(lattice.points());
        points.map(|log_likelihood| {
            if is_possible(*log_likelihood) {
                exp_of_weight(*log_likelihood - self.top)
            } else {
                0.0
            }
        })
    }
}

/// Interpolates between `a` and `b`.
#[inline(always)]
fn mix(a: f32, b: f32, fraction: f32) -> f32 {
    a + fraction * (b - a)
}

/// What is the same at all points.
struct Terms<'a> {
    config: &'a Config,
    belief: &'a OffsetBelief,
    is_estimated: bool,
    /// Of the offset.
    mean: f32,
    variance: f32,
    /// The largest cost of a reading, doubled as all costs.
    gate: f32,
    /// What the variance of the offset adds to that for a precision of 1.
    gate_spread: f32,
    mismatch: f32,
}

impl<'a> Terms<'a> {
    fn new(config: &'a Config, belief: &'a OffsetBelief) -> Self {
        let gate = config.gate_sigmas * config.gate_sigmas;
        let variance = 4.0 * belief.variance;
        Self {
            config,
            belief,
            is_estimated: belief.is_estimated(),
            mean: 2.0 * belief.mean_db,
            variance,
            gate,
            gate_spread: gate * variance,
            mismatch: 4.0 * config.mismatch_sigma_db * config.mismatch_sigma_db,
        }
    }
}

/// Sums over the beacons of a scan at one point, in halves of a dB.
#[derive(Clone, Copy)]
struct Sums {
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

impl Sums {
    /// Readings between two calls of [`Sums::shorten`].
    const FACTORS: usize = 4;

    const EMPTY: Self = Self {
        cost: 0.0,
        cost_with: 0.0,
        precision: 0.0,
        weighted: 0.0,
        product: 1.0,
    };

    /// Adds a reading that differs so much from the mean of the map, which has this variance.
    #[inline(always)]
    fn add(&mut self, difference: f32, variance: f32, terms: &Terms<'_>) {
        let precision = 1.0 / (variance + terms.mismatch);
        let least = |a: f32, b: f32| if a < b { a } else { b };
        self.cost += least(difference * difference * precision, terms.gate);
        if terms.is_estimated {
            let difference = difference - terms.mean;
            let weighted = difference * precision;
            let cost = difference * weighted;
            // An offset that is not known well leaves room for larger differences.
            if cost < terms.gate + terms.gate_spread * precision {
                self.cost_with += cost;
                self.precision += precision;
                self.weighted += weighted;
            } else {
                self.cost_with += terms.gate;
            }
        }
        self.product *= precision;
    }

    /// Takes the logarithm of the product if its next factors could make it too small or too large: each is within 2e-4 and
    /// 25, by the bounds of the mismatch and of the sigmas of a map.
    #[inline(always)]
    fn shorten(&mut self) {
        if !(self.product > 1e-20 && self.product < 1e20) {
            let logarithm = ln(self.product);
            self.cost -= logarithm;
            self.cost_with -= logarithm;
            self.product = 1.0;
        }
    }

    #[inline(always)]
    fn conclude(self, terms: &Terms<'_>) -> Found {
        let tempering = terms.config.tempering;
        let logarithm = ln(self.product);
        let half = 0.5 * tempering;
        let without = half * (logarithm - self.cost);
        if !terms.is_estimated {
            return Found {
                log_likelihood: without,
                precision: 0.0,
                shift: 0.0,
                probability: 0.0,
            };
        }
        let precision = tempering * self.precision;
        let weighted = tempering * self.weighted;
        let known = 1.0 + terms.variance * precision;
        let gain = terms.variance / known;
        let with =
            half * (logarithm - self.cost_with) + 0.5 * (gain * weighted * weighted - ln(known));
        // The sum of both is at most ln 2 above the larger.
        let (without_prior, with_prior) =
            (without + terms.belief.log_none, with + terms.belief.log_some);
        Found {
            log_likelihood: if with_prior > without_prior {
                with_prior
            } else {
                without_prior
            },
            precision: 4.0 * precision,
            shift: 0.5 * gain * weighted,
            probability: terms.belief.probability_given(with - without),
        }
    }
}
