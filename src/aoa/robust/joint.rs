//! Which of some modes are sources, weighed together.

use core::f32::consts::TAU;

use heapless::Vec;

use super::density::Density;
use super::mode::{MODES, Mode};
use super::term::{PLAIN, Term, Width};
use crate::aoa::Mixture;
use crate::math::{ln, smaller};

/// Which of the modes are taken for sources.
pub(super) type Taken = [bool; MODES];

/// A mixture of sources and outliers, and what it says of some bearings.
pub(super) struct Joint<const B: usize> {
    /// The modes that may be sources.
    all: Taken,
    bearings: Vec<Bearing, B>,
    /// Of each mode: logarithms of the mass of its place, and of the density of its errors before any bearing.
    masses: [f32; MODES],
    errors: [f32; MODES],
    /// What all readings count for.
    count: f32,
}

/// What the modes say of a bearing.
struct Bearing {
    /// What it counts for.
    worth: f32,
    /// That it is the right one of the bearings of its reading.
    probability: f32,
    /// Of each mode: how many times as likely it is from there as if it was an outlier.
    odds: [f32; MODES],
}

impl<const B: usize> Joint<B> {
    /// For these bearings, which from now on count in full each.
    pub(super) fn new(terms: &mut [Term<PLAIN>]) -> Self {
        let (mut bearings, mut count) = (Vec::new(), 0.0);
        for term in terms {
            let worth;
            (worth, *term) = term.in_full();
            let bearing = Bearing {
                worth,
                probability: term.probability(),
                odds: [0.0; MODES],
            };
            count += worth * bearing.probability;
            let _ = bearings.push(bearing);
        }
        Self {
            all: [false; MODES],
            bearings,
            masses: [0.0; MODES],
            errors: [0.0; MODES],
            count,
        }
    }

    /// Adds what a source at a mode says of the bearings, by Laplace's approximation.
    #[inline(never)]
    pub(super) fn add(
        &mut self,
        place: usize,
        density: &Density<'_, PLAIN>,
        mode: &Mode<PLAIN>,
        log_volume: f32,
        rates: &Mixture,
    ) {
        let masses = self.masses.iter_mut().zip(&mut self.errors);
        let Some(((mass, errors), may_be)) = masses.zip(&mut self.all).nth(place) else {
            return;
        };
        *may_be = true;
        let width = Width::new(density.scale_sigma, &mode.mean);
        let scale = rates.outlier / (1.0 - rates.outlier);
        for (bearing, term) in self.bearings.iter_mut().zip(density.terms) {
            if let Some(odds) = bearing.odds.get_mut(place) {
                *odds = scale * term.read(&density.line(term, &mode.mean), &width).odds;
            }
        }
        *errors = density.log_prior_of_errors(&mode.mean);
        let log_prior = density.log_prior(&mode.mean) - *errors - log_volume;
        // The mass of the hyperbolic density of the scale is 1 / 0.766 times that of a normal one of its height.
        *mass = log_prior + const { ln(TAU) + ln(0.766) } + mode.covariance.half_ln_determinant();
    }

    /// Those sources of which the Bayes factors, each beside all the others, are large enough: found by leaving out the least
    /// likely one after the other. And the logarithms of the Bayes factors of all, beside these.
    #[inline(never)]
    pub(super) fn found(&self, log_odds: f32) -> (Taken, [f32; MODES]) {
        let mut taken = self.all;
        let mut evidence = self.log_evidence(&taken);
        loop {
            let mut gains = [f32::NEG_INFINITY; MODES];
            let (mut worst, mut least) = (None, log_odds);
            for (place, gain) in gains.iter_mut().enumerate() {
                if taken.get(place) == Some(&true) {
                    *gain = evidence - self.log_evidence(&with(&taken, place, false));
                    if *gain < least {
                        (worst, least) = (Some(place), *gain);
                    }
                }
            }
            if let Some(worst) = worst {
                taken = with(&taken, worst, false);
                evidence -= least;
                continue;
            }
            let others = self.all.iter().zip(&taken).zip(&mut gains).enumerate();
            for (place, ((may_be, is), gain)) in others {
                if *may_be && !is {
                    *gain = self.log_evidence(&with(&taken, place, true)) - evidence;
                }
            }
            return (taken, gains);
        }
    }

    /// Logarithm of how many times as likely all bearings are with these sources as if they were outliers: over all places and
    /// rates of each, by Laplace's approximation. Their errors are those of one array, so what these cost counts once.
    #[inline(never)]
    fn log_evidence(&self, taken: &Taken) -> f32 {
        /// Steps of expectation maximisation over the rates: enough to come near, for time.
        const STEPS: usize = 6;
        let start = |taken: bool| if taken { 1.0 / (MODES + 1) as f32 } else { 0.0 };
        let mut rates = taken.map(start);
        for _ in 0..STEPS {
            let counts = self.counts(&rates);
            rates = counts.map(|count| count / (self.count + 1.0));
        }
        let mut sums = self.sums(&rates);
        let mut errors = 0.0;
        let costs = self.masses.iter().zip(&self.errors).zip(sums.information);
        for (((mass, own), information), _) in costs.zip(taken).filter(|(_, taken)| **taken) {
            let rate = 0.5 * ln(TAU / (1.0 + information));
            sums.log_likelihood += mass + smaller(rate, 0.0);
            errors = smaller(*own, errors);
        }
        sums.log_likelihood + errors
    }

    /// How many bearings are of each source.
    #[inline(never)]
    fn counts(&self, rates: &[f32; MODES]) -> [f32; MODES] {
        let mut counts = [0.0; MODES];
        for bearing in &self.bearings {
            let part = bearing.worth / bearing.likelihood(rates);
            for (count, (odds, rate)) in counts.iter_mut().zip(bearing.odds.iter().zip(rates)) {
                *count += part * rate * odds;
            }
        }
        counts
    }

    #[inline(never)]
    fn sums(&self, rates: &[f32; MODES]) -> Sums {
        let mut sums = Sums::default();
        for bearing in &self.bearings {
            let likelihood = bearing.likelihood(rates);
            for (information, odds) in sums.information.iter_mut().zip(bearing.odds) {
                let slope = (odds - bearing.probability) / likelihood;
                *information += bearing.worth * slope * slope;
            }
            sums.log_likelihood += bearing.worth * ln(likelihood);
        }
        sums
    }
}

impl Bearing {
    /// How much more likely it is, if sources have these rates, than as an outlier. Of bearings that exclude each other, each
    /// has its part of the rates: 1 + a + b is nearly (1 + a) (1 + b).
    #[inline(never)]
    fn likelihood(&self, rates: &[f32; MODES]) -> f32 {
        let pairs = self.odds.iter().zip(rates);
        let fitted: f32 = pairs.map(|(odds, rate)| rate * odds).sum();
        1.0 - self.probability * rates.iter().sum::<f32>() + fitted
    }
}

/// Sums over all bearings.
#[derive(Default)]
struct Sums {
    log_likelihood: f32,
    /// What they tell of the rate of each source.
    information: [f32; MODES],
}

fn with(taken: &Taken, place: usize, is: bool) -> Taken {
    let mut all = *taken;
    if let Some(one) = all.get_mut(place) {
        *one = is;
    }
    all
}
