//! A locator for bearings of which some are wrong.
//!
//! Reflections and other transmitters make *outliers*, which say nothing of the source; an array with a 180-degree
//! ambiguity makes *mirrored* bearings, which point away from it; an array that was not mounted straight adds the same
//! *bias* to all; and readings taken at one place repeat each other's errors. [`Robust`] knows of all four, as its
//! [`Errors`] say. Where the bearings are clean it is as good as [`Clean`](super::Clean), and takes some eight times as
//! long.
//!
//! The posterior of all bearings in the buffer is a mixture over what each of them is, and often has several modes, the
//! hypotheses. They are found afresh, from where random pairs of bearings cross, whenever the particles are to be moved,
//! and the Metropolis-Hastings proposal is a mixture of all of them and of the prior: particles jump from one hypothesis
//! to another with their right weights (independence sampling: Tierney 1994; resample-move: Gilks and Berzuini 2001). So a
//! wrong start does not last, and nothing else is needed against it.
//!
//! * There is no fix while the bearings might as well be parallel, nor while hypotheses that lie apart are of similar
//!   weight: the answer then is [`NotObservable::SeveralPlaces`], and the [hypotheses](Locate::hypothesis) are where they
//!   are. A fix may be taken back.
//! * The rates of mirrored and outlier bearings are learned from the first fix on, by a step of expectation maximisation
//!   at a time; those of each station, where [biases](Biases) are per station. How many times as large as stated the errors
//!   of the others are is a number of each particle, like the biases.
//! * Readings of one place are one bearing, their mean. What its error has in common with those of other places nearby, more
//!   bearings do not average out.
//! * A receiver that does not know exactly where it is may say how well it does: [`Errors::position_sigma_m`].
//! * A reading of several bearings that exclude each other, as the peaks of a [spectrum](super::spectrum), is taken bearing
//!   by bearing, each with its probability.
//! * A full buffer averages the two bearings that say most nearly the same, and forgets the less likely of two that
//!   contradict each other at nearly the same place.

mod biases;
mod candidates;
mod common;
mod config;
mod density;
mod errors;
mod evidence;
mod joint;
mod mode;
pub(super) mod outside;
mod proposal;
mod search;
mod shared;
mod term;
mod track;

use core::f32::consts::LN_2;

use super::core::{Importance, Proposal, check_narrow, is_depleted, sweep};
use super::words::Belief;
use super::{
    Advice, Alternative, Answer, Bias, Cloud, Fix, Hypothesis, Locate, Mixture, NotObservable,
    Observation, PushError, Retract, Retracted, SigmaScale,
};
use crate::ConfigError;
use crate::filter::ParticleFilter;
use crate::math::ln;
use crate::particles::read;
use crate::persist;
use crate::random::Rng;
use crate::resample::Scheme;
pub use biases::Biases;
use biases::Known;
pub(super) use candidates::{Candidates, of_log_odds, probability};
pub use config::Config;
pub use errors::{Correlation, Errors, Learned};
pub(super) use evidence::Candidate;
use evidence::{Change, Evidence};
pub(super) use mode::MODES;
use mode::{Modes, hypotheses, plane, position};
use proposal::MixtureProposal;
use search::search;
pub(super) use shared::Shared;
use term::{PLAIN, SCALE, State, Term, Width};

/// Locates one stationary source, with `N` particles and a buffer of `B` bearings, some of which may be wrong.
///
/// ```
/// use foxhunt::aoa::{Bearing, Locator, Observation, Robust, robust::Config};
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
///
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut locator = Locator::<Robust<256>>::new(Config::DEFAULT)?;
/// // Driving east, past a transmitter 800 m to the north of 600 m. One bearing is a reflection, one is mirrored.
/// for (second, east, degrees) in [
///     (0, 0.0, 36.6), (10, 150.0, 29.5), (20, 300.0, 200.8), (30, 450.0, 10.9), (40, 600.0, 359.7), (50, 750.0, 71.0),
///     (60, 900.0, 339.9),
/// ] {
///     let bearing = Bearing::from_compass_degrees(degrees);
///     let observation = Observation::new(1000 * second, [east, 0.0], bearing, 0.02)?;
///     locator.push(&observation, &mut rng)?;
/// }
/// let fix = locator.fix().expect("the bearings cross");
/// assert!(fix.ellipse(0.95).contains([600.0, 800.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Robust<const N: usize, const B: usize = 64, const D: usize = 4> {
    evidence: Evidence<B, D>,
    filter: ParticleFilter<D, N>,
    modes: Modes<D>,
    answer: Answer,
    /// Mean and covariance of the particles.
    moments: (State<D>, [State<D>; D]),
    learned: Learned,
    /// Bearings since the last search for modes.
    since_search: u32,
    /// Outliers that were removed upstream for each bearing.
    outliers_removed: f32,
}

persist!(impl[const N: usize, const B: usize, const D: usize] Robust<N, B, D> as "Robust"(N, B, D) {
    evidence, filter, modes, answer, moments, learned, since_search, outliers_removed
});

/// Moves of every particle for the first fix: it sets those apart that were drawn from the modes as one.
const START_MOVES: u8 = 1;

/// Particles are moved after so many bearings at the latest: fewer find a missed mode sooner, for time.
const AT_LEAST_EVERY: u32 = 8;

impl<const N: usize, const B: usize, const D: usize> Locate for Robust<N, B, D> {
    type Config = Config;

    const ALTERNATIVES: bool = true;

    const EMPTY: Self = {
        assert!(N >= 2 && B >= 2, "a locator needs particles and bearings");
        assert!(D >= PLAIN, "a state holds a place, a scale and a bias");
        Self {
            evidence: Evidence::EMPTY,
            filter: ParticleFilter::EMPTY,
            modes: Modes::new(),
            answer: Answer::NOTHING,
            moments: ([0.0; D], [[0.0; D]; D]),
            learned: Learned::NOTHING,
            since_search: 0,
            outliers_removed: 0.0,
        }
    };

    fn check(config: &Config) -> Result<(), ConfigError> {
        config.check()
    }

    fn push<R: Rng + ?Sized>(
        &mut self,
        observation: &Observation,
        config: &Config,
        rng: &mut R,
    ) -> Result<Answer, PushError> {
        self.push_alternatives(&[(*observation).into()], config, rng)
    }

    /// Evaluates `N` likelihoods of each bearing; `N B (moves + 1)` more when particles are moved, and `4 N B` for the
    /// first fix (with `N` rounded up to a multiple of 16); and up to `300 B` for the search before either. A full buffer
    /// compares its `B^2 / 2` pairs.
    fn push_alternatives<R: Rng + ?Sized>(
        &mut self,
        alternatives: &[Alternative],
        config: &Config,
        rng: &mut R,
    ) -> Result<Answer, PushError> {
        let first = alternatives.first().ok_or(PushError::Empty)?;
        self.evidence.bearings.admit(first.observation())?;
        let believed = self.believed(config);
        let fixed = matches!(self.answer, Answer::Fix(_));
        let mut surprising = false;
        for alternative in alternatives {
            let change = (self.evidence).push(alternative.into(), &believed.errors, false);
            if fixed {
                surprising |= self.weigh(&change, believed.errors.scale_sigma);
            }
        }
        let answer = if fixed {
            self.rejuvenate(surprising, config, rng);
            // When hypotheses have come apart there is no fix until they separate: by some hysteresis.
            self.credible_fix(2.0, config)
        } else {
            self.observe(&believed, rng)
        };
        self.answer = answer.into();
        Ok(self.answer)
    }

    fn retract<R: Rng + ?Sized>(
        &mut self,
        what: &Retract,
        config: &Config,
        rng: &mut R,
    ) -> Retracted {
        let retracted = self.evidence.bearings.retract(what);
        if retracted.bearings > 0 {
            let believed = self.believed(config);
            self.answer = self.observe(&believed, rng).into();
        }
        retracted
    }

    fn answer(&self) -> Answer {
        self.answer
    }

    fn reset(&mut self) {
        self.evidence.known = Known::NOTHING;
        self.evidence.forget_station_rates();
        self.evidence.shared = Shared::NOTHING;
        self.forget_bearings();
        self.learned = Learned::NOTHING;
        self.outliers_removed = 0.0;
    }

    fn hypothesis(&self, index: usize) -> Option<Hypothesis> {
        mode::hypothesis(&self.modes, index)
    }

    fn bias(&self, config: &Config) -> Option<Bias> {
        self.bias_of(self.evidence.bearings.latest()?, config)
    }

    fn rates(&self, config: &Config) -> Option<Mixture> {
        Some(self.believed(config).errors.rates)
    }

    fn sigma_scale(&self, config: &Config) -> Option<SigmaScale> {
        Some(config.errors.scale_of(&self.learned))
    }

    #[inline(never)]
    fn advice(&self, config: &Config) -> Option<Advice> {
        let latest = self.evidence.bearings.latest()?;
        let belief = match self.cloud(0) {
            Some(cloud) => Belief::of_particles(cloud),
            None => Belief::of_hypotheses(hypotheses(&self.modes), latest, config.range_m),
        };
        belief.advice(latest, self.answer.missing_angle())
    }

    #[inline(never)]
    fn classify(&self, observation: &Observation, config: &Config) -> Option<Mixture> {
        self.answer.fix()?;
        let errors = self.believed(config).errors;
        let term = self.evidence.new_term(observation, &errors);
        let particles = self.filter.particles().columns();
        let mut probabilities = Mixture::ZERO;
        for (i, weight) in self.weights().iter().enumerate() {
            let state: State<D> = read(&particles, i);
            let reading = term.read(&term.line(&state), &Width::new(errors.scale_sigma, &state));
            let fitted = weight * (reading.odds / (1.0 + reading.odds));
            reading.count(&mut probabilities, fitted);
            probabilities.outlier += weight - fitted;
        }
        Some(probabilities)
    }

    fn cloud(&self, index: usize) -> Option<Cloud<'_>> {
        self.answer.fix().filter(|_| index == 0)?;
        let columns = self.columns();
        Some(Cloud {
            east: columns[0],
            north: columns[1],
            weights: self.weights(),
        })
    }
}

impl<const N: usize, const B: usize, const D: usize> Robust<N, B, D> {
    /// The particles' coordinates: metres east, metres north, the logarithm of the scale of the errors in its prior sigmas,
    /// and the numbers of the biases in theirs. They mean nothing before the first fix.
    pub fn columns(&self) -> [&[f32]; D] {
        self.filter.particles().columns()
    }

    /// The particles' weights, which sum to one.
    pub fn weights(&self) -> &[f32] {
        self.filter.weights()
    }

    /// The bearings in the buffer, in no particular order; some stand for several.
    pub fn observations(&self) -> impl ExactSizeIterator<Item = &Observation> {
        self.evidence.bearings.observations()
    }

    /// The bias of a bearing, of its station and direction; `None` before the first fix.
    #[inline(never)]
    pub fn bias_of(&self, observation: &Observation, config: &Config) -> Option<Bias> {
        self.answer.fix()?;
        Some((self.evidence.known).bias(observation, config.errors.biases(), &self.moments))
    }

    /// Forgets the source and its bearings, and goes on with what they have taught of biases and rates. For the next drive
    /// with the same arrays.
    pub fn forget_source(&mut self) {
        if self.answer.fix().is_some() {
            let (mean, covariance) = &self.moments;
            self.evidence.known.learn(mean, covariance);
        }
        self.forget_bearings();
    }

    fn forget_bearings(&mut self) {
        self.evidence.clear();
        self.modes.clear();
        self.answer = Answer::NOTHING;
        self.moments = ([0.0; D], [[0.0; D]; D]);
        self.since_search = 0;
    }

    /// The configuration with the rates as learned so far.
    #[inline(never)]
    fn believed(&self, config: &Config) -> Config {
        Config {
            errors: config.errors.with_rates(&self.learned),
            ..*config
        }
    }

    /// Weighs the particles by a new bearing; whether they find it an outlier.
    #[inline(never)]
    fn weigh(&mut self, change: &Change<D>, scale_sigma: f32) -> bool {
        let likelihood = |state: &State<D>| {
            let width = Width::new(scale_sigma, state);
            let log = |term: &Term<D>| ln(1.0 + term.read(&term.line(state), &width).odds);
            log(&change.new) - change.old.as_ref().map_or(0.0, log)
        };
        // The likelihood is finite, so the update cannot fail. As an evidence it is the mean of 1 + odds.
        let evidence = self.filter.update(&likelihood).unwrap_or(0.0);
        self.since_search += 1;
        change.likely && change.old.is_none() && evidence < LN_2
    }

    /// Moves the particles if a bearing was surprising, if few are left, or if they have not moved for long.
    #[inline(never)]
    fn rejuvenate<R: Rng + ?Sized>(&mut self, surprising: bool, config: &Config, rng: &mut R) {
        let worth = self.filter.effective_sample_size();
        if surprising
            || is_depleted(worth, N, config.resample_below)
            || self.since_search >= AT_LEAST_EVERY
        {
            let believed = self.believed(config);
            let mut terms = self.evidence.terms(&believed.errors);
            self.find_modes(&terms, &believed, rng);
            self.learn(&terms, config);
            self.evidence
                .set_source(&self.filter.mean(), config.errors.scale_sigma);
            let believed = self.believed(config);
            terms = self.evidence.terms(&believed.errors);
            self.filter.resample(Scheme::Systematic, rng);
            self.sweep(&terms, config.moves, &believed, rng);
        }
    }

    /// The first fix, if the bearings make one by their best mode; or the reason why not.
    #[inline(never)]
    fn observe<R: Rng + ?Sized>(
        &mut self,
        believed: &Config,
        rng: &mut R,
    ) -> Result<Fix, NotObservable> {
        if self.evidence.entries().len() < 2 {
            let have = self.evidence.bearings.count();
            return Err(NotObservable::TooFewBearings { have });
        }
        let mut terms = self.evidence.terms(&believed.errors);
        self.find_modes(&terms, believed, rng);
        if believed.errors.depend_on_range()
            && let Some(best) = mode::best(&self.modes)
        {
            self.evidence
                .set_source(&best.mean, believed.errors.scale_sigma);
            terms = self.evidence.terms(&believed.errors);
        }
        self.evidence.crossing(&terms, &self.modes, believed)?;
        self.start(&terms, believed, rng);
        self.credible_fix(1.0, believed)
    }

    /// Starts the particles from all modes: draws of them by what they are worth, each of which then is moved.
    #[inline(never)]
    fn start<R: Rng + ?Sized>(&mut self, terms: &[Term<D>], believed: &Config, rng: &mut R) {
        let proposal = MixtureProposal::new(&self.modes, self.evidence.region(believed));
        let importance = Importance {
            target: &self.evidence.density(terms, believed),
            proposal: &proposal,
        };
        self.filter.initialise(rng, |rng| proposal.draw(rng));
        // Each is worth a finite number, so the update cannot fail.
        let _ = self.filter.update(&importance);
        self.filter.resample(Scheme::Systematic, rng);
        self.sweep(terms, START_MOVES, believed, rng);
    }

    #[inline(never)]
    fn find_modes<R: Rng + ?Sized>(&mut self, terms: &[Term<D>], believed: &Config, rng: &mut R) {
        self.modes = search(&self.evidence, terms, believed, &self.modes, rng);
        self.since_search = 0;
    }

    /// One step of expectation maximisation. Not before there is a fix: a chance crossing of two would teach that all
    /// other bearings are outliers.
    #[inline(never)]
    fn learn(&mut self, terms: &[Term<D>], config: &Config) {
        let density = self.evidence.density(terms, config);
        let mut counts = Mixture::ZERO;
        for mode in &self.modes {
            density.count(&mode.mean, mode.weight, None, &mut counts);
        }
        counts.outlier += self.outliers_removed * counts.total();
        self.learned.rates = config.errors.learned_rates(&counts);
        if config.errors.biases == Biases::PerStation {
            let all = config.errors.with_rates(&self.learned);
            self.evidence
                .learn_station_rates(&density, &self.modes, &all);
        }
    }

    #[inline(never)]
    fn sweep<R: Rng + ?Sized>(
        &mut self,
        terms: &[Term<D>],
        moves: u8,
        believed: &Config,
        rng: &mut R,
    ) {
        let density = self.evidence.density(terms, believed);
        let proposal = MixtureProposal::new(&self.modes, self.evidence.region(believed));
        sweep(self.filter.columns_mut(), &density, &proposal, moves, rng);
    }

    /// The fix, if the cloud is small beside its range: its sigma at most `slack` times as large as it may be.
    #[inline(never)]
    fn credible_fix(&mut self, slack: f32, config: &Config) -> Result<Fix, NotObservable> {
        self.moments = (self.filter.mean(), self.filter.covariance());
        if config.errors.scale_sigma > 0.0 {
            let (mean, covariance) = &self.moments;
            let scale = (config.errors).scale(mean[SCALE], covariance[SCALE][SCALE]);
            self.learned.sigma_scale = scale;
        }
        let fix = Fix::of_cloud(
            position(&self.moments.0),
            plane(&self.moments.1),
            self.filter.effective_sample_size(),
            self.evidence.bearings.count(),
        );
        let range = self.evidence.bearings.range_squared(fix.position);
        let limit = slack * config.relative_range_sigma;
        check_narrow(fix.covariance.largest_eigenvalue(), range, limit)
            .map_err(|wide| several_places(&self.modes).unwrap_or(wide))?;
        Ok(fix)
    }
}

/// The reason, if it is that several modes have a good part of the mass.
#[inline(never)]
fn several_places<const D: usize>(modes: &Modes<D>) -> Option<NotObservable> {
    const PART: f32 = 0.02;
    let have = hypotheses(modes)
        .filter(|one| one.probability >= PART)
        .count() as u32;
    (have > 1).then_some(NotObservable::SeveralPlaces { have })
}

#[cfg(test)]
mod tests;
