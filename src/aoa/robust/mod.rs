//! A locator for bearings of which some are wrong.
//!
//! Reflections and other transmitters make *wild* bearings, which say nothing of the source; an array without a
//! sense of direction makes *mirrored* ones, which point away from it; an array that was not mounted straight adds
//! the same *bias* to all; and readings taken at one place repeat each other's errors. [`RobustLocator`] knows of all
//! four, as its [`Errors`] say. Where the bearings are clean it is as good as the
//! [`Locator`](super::locator::Locator), and takes some eight times as long.
//!
//! The posterior of all bearings in the buffer is a mixture over what each of them is, and often has several modes,
//! the hypotheses. They are found afresh, from where random pairs of bearings cross, whenever the particles are to be
//! moved, and the Metropolis-Hastings proposal is a mixture of all of them and of the prior: particles jump from one
//! hypothesis to another with their right weights (independence sampling: Tierney 1994; resample-move: Gilks and
//! Berzuini 2001). So a wrong start does not last, and nothing else is needed against it.
//!
//! * There is no fix while the bearings might as well be parallel, nor while hypotheses that lie apart are of similar
//!   weight: the answer then is [`NotObservable::NoIntersection`], and [`RobustLocator::hypotheses`] are where they
//!   are. A fix may be taken back.
//! * The shares of mirrored and wild bearings are learned from the first fix on, by a step of expectation
//!   maximisation at a time.
//! * Readings of one place are one bearing, their mean, which is worth as many independent ones as their correlation
//!   leaves.
//! * A receiver that does not know exactly where it is may say how well it does: [`Errors::position_deviation`].
//! * A reading of several bearings that exclude each other, as the peaks of a [spectrum](super::spectrum), is taken bearing
//!   by bearing, each with its share.
//! * A full buffer averages the two bearings that say most nearly the same, and forgets the less likely of two that
//!   contradict each other at nearly the same place.

mod density;
mod errors;
mod evidence;
mod merge;
mod mode;
mod moves;
mod nursery;
pub(super) mod outside;
mod search;
mod snapshot;
mod split;
mod term;

use core::f32::consts::LN_2;

use super::advice::{Advice, Belief};
use super::locate::elapsed;
use super::locator::{self, Answer, Fix, NotObservable};
use super::{Alternative, Observation};
use crate::estimate::{Ellipse, largest_variance};
use crate::filter::ParticleFilter;
use crate::math::{exp, sqrt};
use crate::particles::read;
use crate::random::Rng;
use crate::resample::Scheme;
pub use errors::{Errors, SettingsError, Shares, Tails};
use evidence::{Change, Evidence};
use mode::{Mode, Modes};
use moves::Proposal;
pub(super) use nursery::Nursery;
use search::search;
pub use split::Seed;
use term::State;

/// What a [`RobustLocator`] can be told; the defaults suit a direction finder on a vehicle.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings {
    errors: Errors,
    common: locator::Settings,
    range_m: f32,
}

impl Settings {
    /// The defaults, with what is believed of the errors of the bearings.
    pub const fn new(errors: Errors) -> Self {
        Self {
            errors,
            common: locator::Settings::new(),
            range_m: 20_000.0,
        }
    }

    /// The settings that all locators have.
    #[must_use]
    pub const fn common(mut self, settings: locator::Settings) -> Self {
        self.common = settings;
        self
    }

    /// The source is as likely nearer to the place of the first bearing as farther away than this many metres: 20 km
    /// unless set.
    ///
    /// # Errors
    /// Outside 1 to 1e6.
    pub const fn range_m(mut self, metres: f32) -> Result<Self, SettingsError> {
        if !(metres >= 1.0 && metres <= 1e6) {
            return Err(SettingsError::Range);
        }
        self.range_m = metres;
        Ok(self)
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self::new(Errors::new())
    }
}

/// What all bearings are off by alike.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Bias {
    /// Posterior mean, in radians: what is to be taken off a bearing.
    pub mean: f32,
    /// Posterior standard deviation, in radians.
    pub deviation: f32,
}

/// A place where the source may be: a mode of the posterior, as it was when particles last moved.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Hypothesis {
    /// The mode, in metres east and north.
    pub position: [f32; 2],
    /// Inverse of its curvature, in square metres.
    pub covariance: [[f32; 2]; 2],
    /// Its share of the mass of all hypotheses, by Laplace's approximation.
    pub mass: f32,
}

impl Hypothesis {
    /// The ellipse that holds the source with the given probability (0 to 1), if it is this one.
    pub fn ellipse(&self, probability: f32) -> Ellipse {
        Ellipse::of_normal(self.position, self.covariance, probability)
    }
}

/// Locates one source that does not move, with `N` particles and a buffer of `B` bearings, some of which may be wrong.
///
/// With `N` = 256 and `B` = 64 it takes 9.8 kB, and 6 kB of stack while a bearing is taken. All of its state is plain
/// data: a clone goes on as the original does.
///
/// ```
/// use foxhunt::aoa::{Bearing, Observation};
/// use foxhunt::aoa::locator::Answer;
/// use foxhunt::aoa::robust::{Errors, RobustLocator, Settings};
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
///
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut locator = RobustLocator::<256, 64>::new(Settings::new(Errors::new()));
/// // Driving east, past a transmitter 800 m to the north of 600 m. One bearing is a reflection, one is mirrored.
/// for (east, compass_degrees) in [
///     (0.0, 36.6), (150.0, 29.5), (300.0, 200.8), (450.0, 10.9), (600.0, 359.7), (750.0, 71.0), (900.0, 339.9),
/// ] {
///     let bearing = Bearing::from_compass_degrees(compass_degrees);
///     let observation = Observation::new([east, 0.0], bearing, 0.02).unwrap();
///     locator.push(observation, &mut rng);
/// }
/// let Answer::Fix(fix) = locator.answer() else { panic!("the bearings cross") };
/// assert!(fix.ellipse(0.95).contains([600.0, 800.0]));
/// ```
#[derive(Debug, Clone)]
pub struct RobustLocator<const N: usize, const B: usize = 64> {
    settings: Settings,
    /// As learned so far.
    errors: Errors,
    evidence: Evidence<B>,
    filter: ParticleFilter<3, N>,
    modes: Modes,
    answer: Answer,
    /// Bearings since the last search for modes.
    since_search: u32,
    /// How many wild bearings it has not been given for each that it has.
    withheld: f32,
}

/// Moves of every particle for the first fix.
const START_MOVES: u8 = 3;

/// Particles are moved after so many bearings at the latest: cheap insurance against a mode that has been missed.
const AT_LEAST_EVERY: u32 = 8;

const NOTHING: Answer = Answer::NotObservable(NotObservable::TooFewBearings { have: 0 });

impl<const N: usize, const B: usize> RobustLocator<N, B> {
    /// No bearings yet.
    pub const fn new(settings: Settings) -> Self {
        const { assert!(N >= 2 && B >= 2, "a locator needs particles and bearings") };
        Self {
            settings,
            errors: settings.errors,
            evidence: Evidence::new(settings.range_m),
            filter: ParticleFilter::new(),
            modes: Modes::new(),
            answer: NOTHING,
            since_search: 0,
            withheld: 0.0,
        }
    }

    /// Forgets everything but the settings.
    pub fn reset(&mut self) {
        self.errors = self.settings.errors;
        self.evidence.clear();
        self.evidence.centre_on([0.0; 2], self.settings.range_m);
        self.modes.clear();
        self.answer = NOTHING;
        self.since_search = 0;
        self.withheld = 0.0;
    }

    /// Takes one bearing, and says what is known with it.
    ///
    /// Evaluates `N` likelihoods of one bearing; `N B (moves + 1)` more when particles are moved, and `4 N B` for the
    /// first fix (with `N` rounded up to a multiple of 16); and up to `200 B` for the search before either. A full
    /// buffer compares its `B^2 / 2` pairs.
    pub fn push<R: Rng + ?Sized>(&mut self, observation: Observation, rng: &mut R) -> Answer {
        self.push_after(observation, 0.0, rng)
    }

    /// Like [`push`](Self::push), for a bearing that was taken `seconds` after the one before, for errors that are
    /// correlated in time. What is no such time is none.
    pub fn push_after<R: Rng + ?Sized>(
        &mut self,
        observation: Observation,
        seconds: f32,
        rng: &mut R,
    ) -> Answer {
        self.push_alternatives(&[observation.into()], seconds, rng)
    }

    /// Like [`push_after`](Self::push_after), for a reading that is one of several bearings, which exclude each other. No
    /// bearing changes nothing.
    ///
    /// Evaluates `N` likelihoods more for each but one; what is dear is done once.
    pub fn push_alternatives<R: Rng + ?Sized>(
        &mut self,
        alternatives: &[Alternative],
        seconds: f32,
        rng: &mut R,
    ) -> Answer {
        if alternatives.is_empty() {
            return self.answer;
        }
        let mut seconds = elapsed(seconds);
        let fixed = matches!(self.answer, Answer::Fix(_));
        let source = fixed.then(|| self.filter.mean());
        let mut surprising = false;
        for alternative in alternatives {
            let errors = &self.errors;
            let change = self
                .evidence
                .push(*alternative, seconds, source.as_ref(), errors);
            if fixed {
                surprising |= self.weigh(&change);
            }
            seconds = 0.0;
        }
        let answer = if fixed {
            self.rejuvenate(surprising, rng);
            // When hypotheses have come apart there is no fix until they separate: by some hysteresis.
            self.credible_fix(2.0)
        } else {
            self.observe(rng).and_then(|()| {
                self.start(rng);
                self.credible_fix(1.0)
            })
        };
        self.answer = match answer {
            Ok(fix) => Answer::Fix(fix),
            Err(reason) => Answer::NotObservable(reason),
        };
        self.answer
    }

    /// What is known of the source.
    pub const fn answer(&self) -> Answer {
        self.answer
    }

    /// What is known of the bias of all bearings; `None` before the first fix.
    pub fn bias(&self) -> Option<Bias> {
        let Answer::Fix(_) = self.answer else {
            return None;
        };
        let (mean, [_, _, [_, _, variance]]) = (self.filter.mean(), self.filter.covariance());
        let scale = self.errors.bias_deviation;
        Some(Bias {
            mean: scale * mean[2],
            deviation: scale * sqrt(variance),
        })
    }

    /// The probabilities that a bearing is direct, mirrored or wild, by where the source is; `None` without a fix.
    #[inline(never)]
    pub fn classify(&self, observation: &Observation) -> Option<Shares> {
        let Answer::Fix(_) = self.answer else {
            return None;
        };
        let term = self.evidence.single(observation, &self.errors);
        let particles = self.filter.particles().columns();
        let scale = self.errors.bias_deviation;
        let mut shares = Shares::NONE;
        for (i, weight) in self.weights().iter().enumerate() {
            let state = read(&particles, i);
            shares.add(&term.read(&state, scale * state[2]), *weight);
        }
        Some(shares)
    }

    /// The shares of direct, mirrored and wild bearings, as learned so far.
    pub const fn shares(&self) -> Shares {
        self.errors.shares
    }

    /// The places where the source may be, up to four, in no particular order: before a fix, too.
    pub fn hypotheses(&self) -> impl Iterator<Item = Hypothesis> {
        hypotheses(&self.modes)
    }

    /// Where to drive, so that the next bearings tell most; `None` before the first bearing.
    #[inline(never)]
    pub fn advice(&self) -> Option<Advice> {
        let latest = self.evidence.latest()?;
        let belief = match self.answer {
            Answer::Fix(_) => {
                let [east, north, _] = self.columns();
                Belief::of_particles([east, north], self.weights())
            }
            _ if self.modes.is_empty() => Belief::of_ray(latest, self.settings.range_m),
            _ => Belief::of_hypotheses(self.hypotheses(), latest.position()),
        };
        belief.advice(latest, self.answer.missing_angle())
    }

    /// The particles' coordinates: metres east, metres north, and the bias in its prior deviations.
    /// They mean nothing before the first fix.
    pub fn columns(&self) -> [&[f32]; 3] {
        self.filter.particles().columns()
    }

    /// The particles' weights, which sum to one.
    pub fn weights(&self) -> &[f32] {
        self.filter.weights()
    }

    /// The bearings in the buffer, in no particular order; some stand for several.
    pub fn observations(&self) -> impl ExactSizeIterator<Item = &Observation> {
        self.evidence.observations()
    }

    /// Weighs the particles by a new bearing; whether they find it wild.
    fn weigh(&mut self, change: &Change) -> bool {
        let scale = self.errors.bias_deviation;
        let likelihood = |state: &State| {
            let bias = scale * state[2];
            let old = (change.old).map_or(0.0, |old| old.log_likelihood(state, bias));
            change.new.log_likelihood(state, bias) - old
        };
        // The likelihood is finite, so the update cannot fail. As an evidence it is the mean of 1 + odds.
        let evidence = self.filter.update(&likelihood).unwrap_or(0.0);
        self.since_search += 1;
        change.likely && change.old.is_none() && evidence < LN_2
    }

    /// Moves the particles if a bearing was surprising, if few are left, or if they have not moved for long.
    fn rejuvenate<R: Rng + ?Sized>(&mut self, surprising: bool, rng: &mut R) {
        let share = self.settings.common.resample_share * N as f32;
        let needed = if share > 2.0 { share } else { 2.0 };
        if surprising
            || self.filter.effective_sample_size() < needed
            || self.since_search >= AT_LEAST_EVERY
        {
            self.find_modes(rng);
            self.learn();
            self.filter.resample(Scheme::Systematic, rng);
            self.sweep(self.settings.common.moves, rng);
        }
    }

    /// Whether the bearings make a fix, by their best mode; or the reason why not.
    #[inline(never)]
    fn observe<R: Rng + ?Sized>(&mut self, rng: &mut R) -> Result<(), NotObservable> {
        let have = self.evidence.sights().len();
        if have < 2 {
            let have = self.evidence.count();
            return Err(NotObservable::TooFewBearings { have });
        }
        self.find_modes(rng);
        if self.errors.position_deviation > 0.0
            && let Some(best) = mode::best(&self.modes)
        {
            self.evidence.refresh(&self.errors, &best.mean);
        }
        self.crossing()
    }

    fn crossing(&self) -> Result<(), NotObservable> {
        crossing(&self.evidence, &self.modes, &self.errors, &self.settings)
    }

    /// Starts the particles from all modes.
    #[inline(never)]
    fn start<R: Rng + ?Sized>(&mut self, rng: &mut R) {
        let density = self.evidence.density(&self.errors);
        let proposal = Proposal::new(&self.modes, density.region);
        self.filter.initialise(rng, |rng| proposal.draw(rng));
        self.sweep(START_MOVES, rng);
    }

    #[inline(never)]
    fn find_modes<R: Rng + ?Sized>(&mut self, rng: &mut R) {
        self.modes = search(&self.evidence, &self.errors, &self.modes, rng);
        self.since_search = 0;
    }

    /// One step of expectation maximisation. Not before there is a fix: a chance crossing of two would teach that all
    /// other bearings are wild.
    fn learn(&mut self) {
        let mut counts = Shares::NONE;
        let density = self.evidence.density(&self.errors);
        for mode in &self.modes {
            let portions = self.evidence.sights().iter().map(|sight| sight.share);
            density.count(&mode.mean, mode.share, portions, &mut counts);
        }
        // What excluded a bearing that fits may have been forgotten.
        if counts.wild < 0.0 {
            counts.wild = 0.0;
        }
        counts.wild += self.withheld * (counts.direct + counts.mirror + counts.wild);
        self.errors.learn(&self.settings.errors, &counts);
        self.evidence.refresh(&self.errors, &self.filter.mean());
    }

    fn sweep<R: Rng + ?Sized>(&mut self, moves: u8, rng: &mut R) {
        let density = self.evidence.density(&self.errors);
        let columns = self.filter.columns_mut();
        moves::sweep(columns, &density, &self.modes, moves, rng);
    }

    /// The fix, if the cloud is small beside its range: its deviation at most `slack` times as large as it may be.
    fn credible_fix(&self, slack: f32) -> Result<Fix, NotObservable> {
        let limit = slack * self.settings.common.relative_range_error;
        let fix = Fix::of_cloud(
            position(&self.filter.mean()),
            plane(&self.filter.covariance()),
            self.filter.effective_sample_size(),
            self.evidence.count(),
        );
        let range = self
            .evidence
            .range_squared(fix.position[0], fix.position[1]);
        if largest_variance(&fix.covariance) <= limit * limit * range {
            Ok(fix)
        } else {
            Err(NotObservable::NoIntersection)
        }
    }
}

/// Whether bearings make a fix by their best mode: if they rule out that the source is anywhere up to infinity, by the
/// likelihood ratio, under the same mixture.
#[inline(never)]
fn crossing<const B: usize>(
    evidence: &Evidence<B>,
    modes: &Modes,
    errors: &Errors,
    settings: &Settings,
) -> Result<(), NotObservable> {
    let (at_infinity, information) = evidence.at_infinity();
    let limit = settings.common.relative_range_error;
    // As the other locator says it: two halves of the bearings that differ by this angle.
    let needed = 2.0 / (limit * sqrt(information));
    let crossing = |radians| NotObservable::CrossingAngle { radians, needed };
    let best = mode::best(modes).ok_or(crossing(0.0))?;
    let gain = evidence.density(errors).log_density(&best.mean) - at_infinity;
    let gain = if gain > 0.0 { 2.0 * gain } else { 0.0 };
    let deviation = largest_variance(&plane(&best.covariance.matrix()));
    let range = evidence.range_squared(best.mean[0], best.mean[1]);
    if gain * limit * limit < 1.0 || deviation > limit * limit * range {
        return Err(crossing(2.0 * sqrt(gain / information)));
    }
    Ok(())
}

fn hypotheses(modes: &Modes) -> impl Iterator<Item = Hypothesis> {
    let best = mode::largest(modes);
    let mass = move |mode: &Mode| exp(mode.log_mass - best);
    let total: f32 = modes.iter().map(mass).sum();
    modes.iter().map(move |mode| Hypothesis {
        position: position(&mode.mean),
        covariance: plane(&mode.covariance.matrix()),
        mass: mass(mode) / total,
    })
}

fn position(&[x, y, _]: &State) -> [f32; 2] {
    [x, y]
}

/// Of place and bias, the part of the place.
fn plane(&[[xx, xy, _], [yx, yy, _], _]: &[[f32; 3]; 3]) -> [[f32; 2]; 2] {
    [[xx, xy], [yx, yy]]
}

#[cfg(test)]
mod tests;
