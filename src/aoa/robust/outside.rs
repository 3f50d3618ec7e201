//! What a locator that is built round this one needs of it.

use super::errors::{Errors, Tails};
use super::evidence::{Lines, tempered};
use super::mode::weigh;
use super::search::climb_again;
use super::term::{State, Term};
use super::{Candidate, Config, Robust, crossing};
use crate::aoa::core::{Comparison, Entry};
use crate::aoa::{Answer, Locate, Mixture, Observation};
use crate::math::{exp, ln, sqrt};
use crate::random::Rng;

impl<const N: usize, const B: usize> Robust<N, B> {
    /// The errors, with the rates as learned so far.
    pub(in crate::aoa) fn errors(&self, config: &Config) -> Errors {
        self.believed(config).errors
    }

    /// The latest bearing by time.
    pub(in crate::aoa) fn latest(&self) -> Option<&Observation> {
        self.evidence.bearings.latest()
    }

    /// Mean and covariance of the place and of the bias in its prior sigmas.
    pub(in crate::aoa) fn moments(&self) -> (State, [State; 3]) {
        self.moments
    }

    /// Forgets all bearings, and starts again with these rates.
    pub(in crate::aoa) fn restart(&mut self, rates: Mixture) {
        self.reset();
        self.rates = rates;
    }

    /// The source is as likely within `range_m` of `centre` as not, whatever the bearings say. The first bearing says
    /// where, so this comes later.
    pub(in crate::aoa) fn centre_prior(&mut self, centre: [f32; 2], range_m: f32) {
        self.evidence.centre_on(centre, range_m);
    }

    /// Takes an earlier bearing, and does not look at what it says: the next one does.
    pub(in crate::aoa) fn recall(&mut self, observation: &Observation, config: &Config) {
        let errors = self.errors(config);
        self.evidence.push(&(*observation).into(), None, &errors);
    }

    /// Forgets everything, takes the bearings of a candidate, and says what is known with them.
    ///
    /// Evaluates up to `5 N B` likelihoods of one bearing, and `50 B` before. A candidate of more than `B` bearings takes
    /// `B^2 / 2` comparisons for each beyond.
    pub(in crate::aoa) fn initiate<R: Rng + ?Sized>(
        &mut self,
        candidate: &Candidate<'_>,
        config: &Config,
        rng: &mut R,
    ) -> Answer {
        self.reset();
        self.evidence.adopt(candidate, &config.errors);
        let terms = self.evidence.terms(&config.errors);
        self.modes = climb_again(&self.evidence.density(&terms, config), candidate.modes);
        weigh(&mut self.modes);
        let crosses = crossing(&self.evidence, &terms, &self.modes, config);
        let fix = crosses.and_then(|()| {
            self.start(&terms, config, rng);
            self.credible_fix(1.0, config)
        });
        self.answer = match fix {
            Ok(fix) => Answer::Fix(fix),
            Err(reason) => Answer::NotObservable(reason),
        };
        self.answer
    }

    /// States how many outliers were removed upstream for each bearing that it gets, so that the rates that it learns are
    /// those of all. None unless stated.
    pub(in crate::aoa) fn set_outliers_removed(&mut self, per_bearing: f32) {
        if (0.0..=1e3).contains(&per_bearing) {
            self.outliers_removed = per_bearing;
        }
    }

    /// How many times as likely a bearing is to be direct or mirrored as an outlier: the mean over the particles. It means
    /// nothing before the first fix.
    pub(in crate::aoa) fn odds(&self, observation: &Observation, config: &Config) -> f32 {
        let errors = self.errors(config);
        let term = self.evidence.single(observation, &errors);
        let scale = errors.bias_sigma_rad;
        let [x, y, bias] = self.columns();
        let states = x.iter().zip(y).zip(bias).zip(self.weights());
        states
            .map(|(((x, y), bias), weight)| weight * term.read(&[*x, *y, *bias], scale * bias).odds)
            .sum()
    }

    /// How well the latest bearing fitted, if there was a fix before it: the mean of 1 + odds over the particles, less
    /// what a reading that it was joined with had said.
    pub(in crate::aoa) fn evidence(&self) -> f32 {
        exp(self.log_evidence)
    }
}

/// Odds of a bearing not being an outlier, of a place and the bias in its prior sigmas; `about` is where the source is, by
/// and large.
pub(in crate::aoa) fn odds(
    observation: &Observation,
    errors: &Errors,
    about: &State,
) -> impl Fn(&State) -> f32 {
    let variance = errors.variance(observation, 1.0, Some([about[0], about[1]]));
    let term = Term::new(observation, errors, variance);
    let scale = errors.bias_sigma_rad;
    move |state| term.read(state, scale * state[2]).odds
}

/// A bearing that counts for no more than it tells beside earlier ones, which come with their ages in seconds.
pub(in crate::aoa) fn independent<'a>(
    observation: &Observation,
    earlier: impl Iterator<Item = (&'a Observation, f32)>,
    errors: &Errors,
) -> Observation {
    let [x, y] = observation.position();
    let new = Entry::new(*observation, 1.0);
    let lines = Lines {
        source: None,
        errors,
    };
    let mut least = f32::INFINITY;
    for (old, seconds) in earlier {
        let (dx, dy) = (old.position()[0] - x, old.position()[1] - y);
        let lengths = errors.correlation.lengths(sqrt(dx * dx + dy * dy), seconds);
        if lengths < least && lines.is_similar(&Entry::new(*old, 1.0), &new) {
            least = lengths;
        }
    }
    tempered(*observation, errors.correlation.worth(least))
}

/// The line of a bearing, as it is seen from a state.
pub(in crate::aoa) struct Line {
    pub(in crate::aoa) error: LineError,
    /// Derivatives of the error by the place and by the bias in its prior sigmas.
    pub(in crate::aoa) gradient: State,
}

/// How far off a bearing is, in radians.
pub(in crate::aoa) struct LineError {
    pub(in crate::aoa) angle: f32,
    /// Variance that it has on its own.
    pub(in crate::aoa) variance: f32,
    pub(in crate::aoa) mirrored: bool,
}

impl LineError {
    /// Odds of not being an outlier of an error of `angle`, if errors have this variance.
    pub(in crate::aoa) fn odds(&self, angle: f32, variance: f32, errors: &Errors) -> f32 {
        let Mixture {
            direct,
            mirrored,
            outlier,
        } = errors.rates;
        let rate = if self.mirrored { mirrored } else { direct };
        let peak = errors.tails.height() / (sqrt(variance) * outlier);
        let square = angle * angle / variance;
        rate * peak
            * match errors.tails {
                Tails::Normal => exp(-0.5 * square),
                Tails::Student { freedom } => {
                    let freedom = f32::from(freedom);
                    exp(-0.5 * (freedom + 1.0) * ln(1.0 + square / freedom))
                }
            }
    }
}

pub(in crate::aoa) fn read(observation: &Observation, errors: &Errors, state: &State) -> Line {
    let variance = errors.variance(observation, 1.0, Some([state[0], state[1]]));
    let term = Term::new(observation, errors, variance);
    let reading = term.read(state, errors.bias_sigma_rad * state[2]);
    let [x, y] = term.gradient(state);
    Line {
        error: LineError {
            angle: reading.error,
            variance,
            mirrored: reading.mirrored,
        },
        gradient: [x, y, errors.bias_sigma_rad],
    }
}
