//! What all bearings and the priors say of a state.

use core::f32::consts::PI;

use super::shared::Shared;
use super::term::{BIASES, Lanes, Line, SCALE, State, Term, Width};
use crate::aoa::Mixture;
use crate::aoa::core::{BLOCK, Block, Target, square_of_distance};
use crate::math::{exp, larger, ln, sqrt};

/// Where a source may be before any bearing: a density of 1 / ((1 + r^2 / a^2) (1 + r^2 / b^2)) about the middle of
/// the receivers, for a nearest range a and a farthest one b.
///
/// Between the two all ranges of one order of magnitude are as likely as those of the next, and it is proper: a posterior
/// under which every bearing may be an outlier has an infinite mass at infinity without.
#[derive(Debug, Clone, Copy)]
pub(super) struct Region {
    pub(super) centre: [f32; 2],
    /// 1 / a^2 and 1 / b^2.
    inverse_squares: [f32; 2],
}

impl Region {
    pub(super) fn new(centre: [f32; 2], ranges_m: [f32; 2]) -> Self {
        Self {
            centre,
            inverse_squares: ranges_m.map(|range| 1.0 / (range * range)),
        }
    }

    /// Logarithm of (b / a)^2.
    fn span(&self) -> f32 {
        /// That of one range, as far as f32 can tell.
        const LEAST: f32 = 1e-3;
        let [near, far] = self.inverse_squares;
        let span = ln(near / far);
        larger(span, LEAST)
    }

    /// Of a place, up to a constant.
    pub(super) fn log_density(&self, place: [f32; 2]) -> f32 {
        let square = square_of_distance(place, self.centre);
        let [near, far] = self.inverse_squares;
        -ln((1.0 + square * near) * (1.0 + square * far))
    }

    /// The logarithm of the integral of that density over all places.
    #[inline(never)]
    pub(super) fn log_volume(&self) -> f32 {
        let span = self.span();
        ln(PI * span / ((1.0 - exp(-span)) * self.inverse_squares[0]))
    }

    /// Distance from the centre that is not exceeded with this probability.
    #[inline(never)]
    pub(super) fn quantile(&self, probability: f32) -> f32 {
        let span = self.span();
        let ratio = (exp(probability * span) - 1.0) / (1.0 - exp((probability - 1.0) * span));
        sqrt(ratio / self.inverse_squares[0])
    }

    /// Pull to the centre: that of a normal density which draws as strongly here, in 1 / m^2.
    fn information(&self, place: [f32; 2]) -> f32 {
        let square = square_of_distance(place, self.centre);
        let pull = |inverse: f32| 2.0 * inverse / (1.0 + square * inverse);
        let [near, far] = self.inverse_squares;
        pull(near) + pull(far)
    }
}

/// The posterior of some bearings.
#[derive(Clone, Copy)]
pub(super) struct Density<'a, const D: usize> {
    pub(super) terms: &'a [Term<D>],
    pub(super) space: Space,
    pub(super) scale_sigma: f32,
    pub(super) shared: Shared,
}

/// Where a source is sought, which says what the first two numbers of a state are.
#[derive(Clone, Copy)]
pub(super) enum Space {
    /// In the plane: metres east and north.
    Plane(Region),
    /// At infinity: its direction in radians; and a number without a meaning.
    Infinity,
}

impl Space {
    /// Logarithm of the density before any bearing, its gradient, and the information of a normal density that draws as
    /// strongly: of the first two numbers.
    pub(super) fn prior(&self, [x, y]: [f32; 2]) -> (f32, [f32; 2], [f32; 2]) {
        match self {
            Self::Plane(region) => {
                let pull = region.information([x, y]);
                let [cx, cy] = region.centre;
                let gradient = [pull * (cx - x), pull * (cy - y)];
                (region.log_density([x, y]), gradient, [pull; 2])
            }
            Self::Infinity => (-0.5 * y * y, [0.0, -y], [0.0, 1.0]),
        }
    }
}

/// As many odds as can be multiplied without overflow before the logarithm is taken.
const PRODUCTS: usize = 3;

/// Logarithm of a product of odds, taken of a few factors at a time.
pub(super) struct Logarithm {
    sum: f32,
    product: f32,
    factors: usize,
}

impl Logarithm {
    pub(super) const OF_ONE: Self = Self {
        sum: 0.0,
        product: 1.0,
        factors: 0,
    };

    #[inline(always)]
    pub(super) fn multiply(&mut self, factor: f32) {
        self.product *= factor;
        self.factors += 1;
        if self.factors == PRODUCTS {
            self.sum += ln(self.product);
            (self.product, self.factors) = (1.0, 0);
        }
    }

    pub(super) fn value(&self) -> f32 {
        self.sum + ln(self.product)
    }
}

impl<'a, const D: usize> Density<'a, D> {
    /// The gradient and the information of the prior: those of a normal density that draws as strongly.
    #[inline(never)]
    pub(super) fn prior(&self, state: &State<D>) -> (State<D>, State<D>) {
        let mut gradient = state.map(|z| -z);
        let mut information = [1.0; D];
        let (_, [gx, gy], [ix, iy]) = self.space.prior([state[0], state[1]]);
        (gradient[0], gradient[1]) = (gx, gy);
        (information[0], information[1]) = (ix, iy);
        let bend = sqrt(1.0 + state[SCALE] * state[SCALE]);
        gradient[SCALE] /= bend;
        information[SCALE] /= bend;
        self.shared.add(state, &mut gradient, &mut information);
        (gradient, information)
    }

    /// The logarithm of the prior of a state, up to a constant.
    #[inline(never)]
    pub(super) fn log_prior(&self, state: &State<D>) -> f32 {
        self.space.prior([state[0], state[1]]).0 + self.log_prior_of_errors(state)
    }

    /// Of the scale and the biases, up to a constant.
    ///
    /// That of the scale is a hyperbolic density (Barndorff-Nielsen 1977): normal about what is stated, but far from it it
    /// falls as slowly as an exponential, for where sigmas are wrong, they may be wrong by any factor.
    #[inline(never)]
    pub(super) fn log_prior_of_errors(&self, state: &State<D>) -> f32 {
        let squares = state.iter().skip(BIASES).map(|z| z * z);
        let log_prior = 1.0 - sqrt(1.0 + state[SCALE] * state[SCALE]) - 0.5 * squares.sum::<f32>();
        log_prior + self.shared.log_likelihood(state)
    }

    /// What the bearings say of a state, but for the prior of the place.
    #[inline(never)]
    pub(super) fn log_likelihood(&self, state: &State<D>) -> f32 {
        let width = Width::new(self.scale_sigma, state);
        let mut sum = Logarithm::OF_ONE;
        for place in self.places() {
            sum.multiply(1.0 + self.odds(place, state, &width));
        }
        sum.value() + self.log_prior_of_errors(state)
    }

    /// Log-density up to a constant.
    #[inline(never)]
    pub(super) fn log_density(&self, state: &State<D>) -> f32 {
        self.log_likelihood(state) + self.space.prior([state[0], state[1]]).0
    }

    /// The bearings of each place, which exclude each other.
    pub(super) fn places(&self) -> impl Iterator<Item = &'a [Term<D>]> {
        let mut rest = self.terms;
        core::iter::from_fn(move || {
            let last = rest.iter().position(Term::is_last_of_place)?;
            let (place, others) = rest.split_at_checked(last + 1)?;
            rest = others;
            Some(place)
        })
    }

    /// The odds that one of the bearings of a place is no outlier.
    #[inline(never)]
    pub(super) fn odds(&self, place: &[Term<D>], state: &State<D>, width: &Width) -> f32 {
        let odds = |term: &Term<D>| term.read(&self.line(term, state), width).odds;
        place.iter().map(odds).sum()
    }

    /// Counts what the bearings are, from a state: all, or those of one station.
    #[inline(never)]
    pub(super) fn count(
        &self,
        state: &State<D>,
        weight: f32,
        station: Option<u8>,
        counts: &mut Mixture,
    ) {
        let width = Width::new(self.scale_sigma, state);
        let is_of_station =
            |place: &&[Term<D>]| station.is_none() || place.first().map(Term::station) == station;
        for place in self.places().filter(is_of_station) {
            let total = 1.0 + self.odds(place, state, &width);
            let mut worth = 0.0;
            for term in place {
                let reading = term.read(&self.line(term, state), &width);
                worth = reading.worth;
                reading.count(counts, weight * worth * reading.odds / total);
            }
            counts.outlier += weight * worth / total;
        }
    }

    /// What the bearings tell of directions that are no outliers, from a state, in 1 / rad^2.
    #[inline(never)]
    pub(super) fn information(&self, state: &State<D>) -> f32 {
        let width = Width::new(self.scale_sigma, state);
        let of_place = |place: &[Term<D>]| {
            let told = |term: &Term<D>| {
                let reading = term.read(&self.line(term, state), &width);
                reading.odds * reading.precision
            };
            place.iter().map(told).sum::<f32>() / (1.0 + self.odds(place, state, &width))
        };
        self.places().map(of_place).sum()
    }

    /// How a bearing is off, seen from a state.
    #[inline(never)]
    pub(super) fn line(&self, term: &Term<D>, state: &State<D>) -> Line {
        match self.space {
            Space::Plane(_) => term.line(state),
            Space::Infinity => term.line_far(state),
        }
    }

    /// The same with the derivatives of the error by the state but for the scale.
    #[inline(always)]
    pub(super) fn linearise(&self, term: &Term<D>, state: &State<D>) -> (Line, State<D>) {
        let mut gradient = *term.features();
        let (line, [gx, gy]) = match self.space {
            Space::Plane(_) => (term.line_of(state), term.gradient(state)),
            Space::Infinity => (term.line_far(state), [1.0, 0.0]),
        };
        gradient[0] = gx;
        gradient[1] = gy;
        (line, gradient)
    }

    /// The same bearings of a source at infinity.
    pub(super) const fn at_infinity(&self) -> Self {
        Self {
            space: Space::Infinity,
            ..*self
        }
    }
}

impl<const D: usize> Target<D> for Density<'_, D> {
    #[inline(never)]
    fn log_densities(&self, states: &Block<D>) -> [f32; BLOCK] {
        let (mut sums, mut lanes) = ([0.0; BLOCK], Lanes::START);
        for (i, sum) in sums.iter_mut().enumerate() {
            let state = states.each_ref().map(|column| column[i]);
            *sum = self.log_prior(&state);
            let width = Width::new(self.scale_sigma, &state);
            (lanes.log_heights[i], lanes.precisions[i]) = (width.log_height, width.precision);
        }
        let mut factors = 0;
        for place in self.places() {
            lanes.multiply(place, states);
            factors += 1;
            if factors == PRODUCTS {
                lanes.add_logarithms(&mut sums);
                factors = 0;
            }
        }
        lanes.add_logarithms(&mut sums);
        sums
    }
}

impl Lanes {
    /// Multiplies the products by one plus the odds of the bearings of a place.
    #[inline(always)]
    fn multiply<const D: usize>(&mut self, place: &[Term<D>], states: &Block<D>) {
        let mut totals = [1.0; BLOCK];
        for term in place {
            term.odds_of_block(states, self);
            for (total, odds) in totals.iter_mut().zip(&self.odds) {
                *total += odds;
            }
        }
        for (product, total) in self.products.iter_mut().zip(totals) {
            *product *= total;
        }
    }

    /// Takes the logarithms of the products into sums; the products are one again.
    #[inline(never)]
    fn add_logarithms(&mut self, sums: &mut [f32; BLOCK]) {
        for (sum, product) in sums.iter_mut().zip(&mut self.products) {
            *sum += ln(*product);
            *product = 1.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The gradient is that of the density, by differences; the information is that of a normal density at infinity.
    #[test]
    fn the_prior_is_drawn_to_its_middle() {
        let region = Region::new([30.0, -20.0], [50.0, 900.0]);
        for (space, step) in [(Space::Plane(region), 0.5), (Space::Infinity, 0.01)] {
            for place in [[80.0, 40.0], [-60.0, 3.0], [2.0, -70.0]] {
                let place = if step < 0.1 {
                    place.map(|x| 0.02 * x)
                } else {
                    place
                };
                let (_, gradient, information) = space.prior(place);
                for axis in 0..2 {
                    let at = |off: f32| {
                        let mut there = place;
                        there[axis] += off;
                        space.prior(there).0
                    };
                    let slope = (at(step) - at(-step)) / (2.0 * step);
                    let off = (slope - gradient[axis]).abs();
                    assert!(
                        off < 0.01 * gradient[axis].abs() + 1e-4,
                        "{slope} {gradient:?}"
                    );
                    assert!(information[axis] >= 0.0);
                }
            }
        }
        assert_eq!(Space::Infinity.prior([0.3, 0.7]).2, [0.0, 1.0]);
    }
}
