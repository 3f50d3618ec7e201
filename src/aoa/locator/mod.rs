//! The locator: bearings in, and a fix out as soon as there can be one.
//!
//! A particle filter for a source that does not move and may be anywhere: its prior is flat. It keeps the bearings, in a bounded buffer, because
//! their joint likelihood is what particles must be moved by when they have become too few: a filter that
//! forgets them can only jitter its particles, which costs accuracy and, with few particles, the source.
//!
//! * Before the bearings rule out that they are parallel the answer is [`Answer::NotObservable`], with the reason.
//! * Then particles start from intersections of random pairs of bearings (Du et al. 2016, eq. 22 and 23) and
//!   are weighed by all bearings.
//! * Each further bearing weighs them once. When the effective sample size falls, they are resampled and moved
//!   by Metropolis-Hastings steps that leave the posterior of all bearings invariant (resample-move: Gilks and
//!   Berzuini 2001): those of [`ModeMoves`], or of any [`Refinement`] that
//!   [`Locator::with_refinement`] is given.
//! * When the buffer is full, the two bearings that say most nearly the same are averaged: none is forgotten.

mod evidence;
mod moves;
mod rejuvenation;
mod snapshot;

use core::fmt;

use super::advice::{Advice, Belief};
use super::triangulation::random_intersection;
use super::{BearingLikelihood, Observation};
use crate::estimate::{Ellipse, largest_variance};
use crate::filter::ParticleFilter;
use crate::math::sqrt;
use crate::random::Rng;
use crate::refine::{Memory, Refinement};
use crate::resample::Scheme;
use evidence::Evidence;
use moves::Proposal;
pub use rejuvenation::{ModeMoves, Moves};

/// What a [`Locator`] can be told; the defaults suit a direction finder on a vehicle.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Settings {
    pub(super) relative_range_error: f32,
    pub(super) resample_share: f32,
    pub(super) moves: u8,
}

/// Why a setting was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum SettingsError {
    /// `relative_range_error` is not within 0.01 and 1.
    RelativeRangeError,
    /// `resample_share` is not within 0 and 1.
    ResampleShare,
    /// `moves` is not within 1 and 16.
    Moves,
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::RelativeRangeError => "relative_range_error is not within 0.01 and 1",
            Self::ResampleShare => "resample_share is not within 0 and 1",
            Self::Moves => "moves is not within 1 and 16",
        })
    }
}

impl core::error::Error for SettingsError {}

impl Settings {
    /// The defaults.
    pub const fn new() -> Self {
        Self {
            relative_range_error: 0.25,
            resample_share: 0.5,
            moves: 2,
        }
    }

    /// Largest standard deviation of the range to the source, as a share of the range, that makes a fix:
    /// 0.25 unless set.
    ///
    /// # Errors
    /// Outside 0.01 to 1.
    pub const fn relative_range_error(mut self, share: f32) -> Result<Self, SettingsError> {
        if !(share >= 0.01 && share <= 1.0) {
            return Err(SettingsError::RelativeRangeError);
        }
        self.relative_range_error = share;
        Ok(self)
    }

    /// Particles are resampled and moved when the effective sample size falls below this share of their
    /// number: 0.5 unless set.
    ///
    /// # Errors
    /// Outside 0 to 1.
    pub const fn resample_share(mut self, share: f32) -> Result<Self, SettingsError> {
        if !(share >= 0.0 && share <= 1.0) {
            return Err(SettingsError::ResampleShare);
        }
        self.resample_share = share;
        Ok(self)
    }

    /// Metropolis-Hastings steps of every particle after a resampling: 2 unless set. Each evaluates all
    /// bearings in the buffer once. A refinement has its own number of moves.
    ///
    /// # Errors
    /// Outside 1 to 16.
    pub const fn moves(mut self, moves: u8) -> Result<Self, SettingsError> {
        if moves < 1 || moves > 16 {
            return Err(SettingsError::Moves);
        }
        self.moves = moves;
        Ok(self)
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self::new()
    }
}

/// What is known of the source.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Answer {
    /// The bearings do not say where it is.
    NotObservable(NotObservable),
    /// Where it is.
    Fix(Fix),
}

impl Answer {
    /// How much farther the bearings must turn before there can be a fix, in radians; zero with a fix.
    pub(super) fn missing_angle(&self) -> f32 {
        /// Where that is not known,
        const SOME: f32 = 0.1;
        /// and where they cross at the angle that is needed, but the range is too uncertain: as a share of it.
        const MORE: f32 = 0.25;
        match self {
            Self::Fix(_) => 0.0,
            Self::NotObservable(NotObservable::CrossingAngle { radians, needed }) => {
                let (missing, least) = (needed - radians, MORE * needed);
                if missing > least { missing } else { least }
            }
            Self::NotObservable(_) => SOME,
        }
    }
}

/// Why there is no fix yet.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum NotObservable {
    /// Two bearings are the least.
    TooFewBearings {
        /// How many there are.
        have: u32,
    },
    /// The bearings cross at too small an angle, so that they might as well be parallel: drive on, across them.
    CrossingAngle {
        /// Angle between the halves of the bearings, as far as it stands out of their errors; in radians.
        radians: f32,
        /// The angle that their errors ask for, in radians. It falls with the number of bearings.
        needed: f32,
    },
    /// The bearings part: they do not meet in front of their receivers.
    NoIntersection,
}

/// A located source.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fix {
    /// Posterior mean, in metres east and north.
    pub position: [f32; 2],
    /// Posterior covariance, in square metres; includes the sampling error of the particles.
    pub covariance: [[f32; 2]; 2],
    /// How many equally weighted particles the cloud is worth.
    pub effective_sample_size: f32,
    /// How many bearings the fix rests on.
    pub bearings: u32,
}

impl Fix {
    /// From the moments of particles worth `n`.
    pub(super) fn of_cloud(
        position: [f32; 2],
        covariance: [[f32; 2]; 2],
        n: f32,
        bearings: u32,
    ) -> Self {
        // The covariance of n samples about their own mean is small by 1 - 1/n, and that mean is off by 1/n
        // of the covariance.
        let sampling = if n > 2.0 {
            (1.0 + 1.0 / n) / (1.0 - 1.0 / n)
        } else {
            3.0
        };
        Self {
            position,
            covariance: covariance.map(|row| row.map(|entry| entry * sampling)),
            effective_sample_size: n,
            bearings,
        }
    }

    /// The ellipse that holds the source with the given probability (0 to 1).
    pub fn ellipse(&self, probability: f32) -> Ellipse {
        Ellipse::of_normal(self.position, self.covariance, probability)
    }
}

/// Locates one source that does not move, with `N` particles and a buffer of `B` bearings.
///
/// `M` moves the particles: the locator's own [`ModeMoves`], or any refinement, which brings its memory with it. See
/// [`Locator::with_refinement`].
///
/// ```
/// use foxhunt::aoa::{Bearing, Observation};
/// use foxhunt::aoa::locator::{Answer, Locator, Settings};
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
///
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut locator = Locator::<100>::new(Settings::new());
/// // Driving east, past a transmitter 800 m to the north.
/// for (east, compass_degrees) in [(0.0, 36.6), (300.0, 20.8), (600.0, 359.7), (900.0, 339.9)] {
///     let bearing = Bearing::from_compass_degrees(compass_degrees);
///     let observation = Observation::new([east, 0.0], bearing, 0.02).unwrap();
///     locator.push(observation, &mut rng);
/// }
/// let Answer::Fix(fix) = locator.answer() else { panic!("the bearings cross") };
/// assert!(fix.ellipse(0.95).contains([600.0, 800.0]));
/// ```
#[derive(Debug, Clone)]
pub struct Locator<const N: usize, const B: usize = 64, M: Moves<N> = ModeMoves> {
    settings: Settings,
    evidence: Evidence<B>,
    filter: ParticleFilter<2, N>,
    answer: Answer,
    moves: M,
    memory: M::Memory,
}

/// As far as advice thinks that a source may be which there is no fix of.
const RANGE_M: f32 = 20_000.0;

/// The smallest sine of the angle of two bearings whose intersection may start a particle.
const LEAST_SINE: f32 = 0.02;

/// Moves of every particle before the first fix, at least.
const START_MOVES: u8 = 8;

impl<const N: usize, const B: usize> Locator<N, B> {
    /// No bearings yet.
    pub const fn new(settings: Settings) -> Self {
        Self::with_moves(settings, ModeMoves, ())
    }
}

impl<const N: usize, const B: usize, F: Refinement<2>> Locator<N, B, F> {
    /// No bearings yet; `refinement` is to move the particles, by the posterior of all bearings. It takes `28 N + 1028`
    /// bytes more, its [`Memory`].
    ///
    /// ```
    /// use foxhunt::aoa::locator::{Locator, Settings};
    /// use foxhunt::refine::FishSchool;
    ///
    /// let school = FishSchool::METROPOLIS;
    /// let locator = Locator::<100, 64, FishSchool>::with_refinement(Settings::new(), school);
    /// ```
    ///
    /// With [`Acceptance::Metropolis`](crate::refine::Acceptance::Metropolis), as here, the posterior stays exact and so
    /// does the ellipse, if each particle is offered four places or so.
    ///
    /// [`Acceptance::Greedy`](crate::refine::Acceptance::Greedy) is there because it was published. It draws the
    /// particles together at the mode: the ellipse is too small and holds the source far less often than it says, and
    /// the effective sample size does not tell any more when they must move. With lengths relative to the cloud, fish
    /// and fireflies that have gathered cannot follow the mode, and the fix stays behind by many deviations: give them
    /// [`Lengths::Absolute`](crate::refine::Lengths::Absolute) of the accuracy that is hoped for, which is then what
    /// the ellipse shows, and have them move after every bearing, by a [`Settings::resample_share`] of 1.
    pub const fn with_refinement(settings: Settings, refinement: F) -> Self {
        Self::with_moves(settings, refinement, Memory::new())
    }
}

impl<const N: usize, const B: usize, M: Moves<N>> Locator<N, B, M> {
    const fn with_moves(settings: Settings, moves: M, memory: M::Memory) -> Self {
        const { assert!(N >= 2 && B >= 2, "a locator needs particles and bearings") };
        Self {
            settings,
            evidence: Evidence::new(),
            filter: ParticleFilter::new(),
            answer: Answer::NotObservable(NotObservable::TooFewBearings { have: 0 }),
            moves,
            memory,
        }
    }

    /// Forgets everything but the settings.
    pub fn reset(&mut self) {
        self.evidence.clear();
        self.answer = Answer::NotObservable(NotObservable::TooFewBearings { have: 0 });
    }

    /// Takes one bearing, and says what is known with it.
    ///
    /// Evaluates `N` likelihoods when no particle needs to move, `N (1 + B (moves + 1))` when they do, `10 N B` for
    /// the first fix (with `N` rounded up to a multiple of 16), and takes a Gauss-Newton search of the `B` bearings
    /// for either. The first fix is the same whatever moves the particles; a refinement then takes `B` times its
    /// [`evaluations`](Refinement::evaluations) to move them, after the locator's own moves if fewer than 8 were left.
    pub fn push<R: Rng + ?Sized>(&mut self, observation: Observation, rng: &mut R) -> Answer {
        if let Answer::Fix(fix) = self.answer {
            self.evidence.push(observation, Some(fix.position));
            // A normal likelihood is never zero, so the update cannot fail.
            let _ = self.filter.update(&BearingLikelihood::new(&observation));
            // A single particle that is left has no covariance to say so.
            let share = self.settings.resample_share * N as f32;
            let needed = if share > 2.0 { share } else { 2.0 };
            self.rejuvenate(needed, rng);
            self.answer = Answer::Fix(self.fix());
        } else {
            self.evidence.push(observation, None);
            self.answer = match self.observe(rng) {
                Err(reason) => Answer::NotObservable(reason),
                Ok(start) => {
                    self.start(start, rng);
                    Answer::Fix(self.fix())
                }
            };
        }
        self.answer
    }

    /// What is known of the source.
    pub const fn answer(&self) -> Answer {
        self.answer
    }

    /// Where to drive, so that the next bearings tell most; `None` before the first bearing.
    #[inline(never)]
    pub fn advice(&self) -> Option<Advice> {
        let latest = self.evidence.latest()?;
        let belief = match self.answer {
            Answer::Fix(_) => Belief::of_particles(self.columns(), self.weights()),
            Answer::NotObservable(_) => Belief::of_ray(latest, RANGE_M),
        };
        belief.advice(latest, self.answer.missing_angle())
    }

    /// The particles' coordinates: metres east, metres north. They mean nothing before the first fix.
    pub fn columns(&self) -> [&[f32]; 2] {
        self.filter.particles().columns()
    }

    /// The particles' weights, which sum to one.
    pub fn weights(&self) -> &[f32] {
        self.filter.weights()
    }

    /// The bearings in the buffer, in no particular order; some are averages once it is full.
    pub fn observations(&self) -> &[Observation] {
        self.evidence.observations()
    }

    /// Whether the bearings make a fix: the normal distribution about their intersection, or the reason why not.
    ///
    /// They do if they rule out that they are parallel, that the source is anywhere up to infinity: by the
    /// likelihood ratio, because the curvature of the likelihood alone is deceived by the intersections that
    /// errors make of parallel bearings, among the vehicle's own places.
    #[inline(never)]
    fn observe<R: Rng + ?Sized>(&self, rng: &mut R) -> Result<Proposal, NotObservable> {
        /// The best of this many random intersections starts the search.
        const CANDIDATES: u32 = 8;
        let observations = self.evidence.observations();
        let have = observations.len();
        if have < 2 {
            return Err(NotObservable::TooFewBearings { have: have as u32 });
        }
        let (misfit_at_infinity, information) = self.evidence.misfit_at_infinity();
        let limit = self.settings.relative_range_error;
        // Two halves of the bearings that differ by this angle have a likelihood ratio of 1 / (2 limit^2).
        let needed = 2.0 / (limit * sqrt(information));
        let crossing = |radians| NotObservable::CrossingAngle { radians, needed };

        let mut best = None;
        for _ in 0..CANDIDATES {
            if let Some(point) = random_intersection(observations, LEAST_SINE, rng) {
                let misfit = self.evidence.misfit(point);
                if best.is_none_or(|(_, least)| misfit < least) {
                    best = Some((point, misfit));
                }
            }
        }
        let Some(mode) = best.and_then(|(start, _)| self.evidence.mode(start).ok()) else {
            // Are they as parallel as their errors let them be? Beyond four deviations of chi-squared they part.
            let freedom = have as f32 - 1.0;
            let parallel = misfit_at_infinity < freedom + 4.0 * sqrt(2.0 * freedom);
            return Err(if parallel {
                crossing(0.0)
            } else {
                NotObservable::NoIntersection
            });
        };
        let gain = misfit_at_infinity - self.evidence.misfit(mode.mean());
        let gain = if gain > 0.0 { gain } else { 0.0 };
        let relative_error = sqrt(largest_variance(&mode.covariance()))
            / self.evidence.distance_to_latest(mode.mean());
        if gain * limit * limit < 1.0 || relative_error > limit {
            return Err(crossing(2.0 * sqrt(gain / information)));
        }
        Ok(mode)
    }

    /// Starts the particles from intersections of pairs of bearings.
    #[inline(never)]
    fn start<R: Rng + ?Sized>(&mut self, mode: Proposal, rng: &mut R) {
        let evidence = &self.evidence;
        self.filter.initialise(rng, |rng| {
            random_intersection(evidence.observations(), LEAST_SINE, rng)
                .unwrap_or_else(|| mode.draw(rng))
        });
        let _ = self.filter.update(evidence);
        self.filter.resample(Scheme::Systematic, rng);
        // Intersections are not drawn from the posterior: it takes more moves than usual to forget that.
        let moves = self.settings.moves.max(START_MOVES);
        moves::sweep(self.filter.columns_mut(), evidence, &mode, moves, rng);
    }

    /// Resamples and moves the particles if they are worth fewer than `needed`.
    #[inline(never)]
    fn rejuvenate<R: Rng + ?Sized>(&mut self, needed: f32, rng: &mut R) {
        if self.filter.effective_sample_size() >= needed {
            return;
        }
        let (filter, memory) = (&mut self.filter, &mut self.memory);
        self.moves
            .rejuvenate(filter, &self.evidence, &self.settings, memory, rng);
    }

    fn fix(&self) -> Fix {
        let n = self.filter.effective_sample_size();
        Fix::of_cloud(
            self.filter.mean(),
            self.filter.covariance(),
            n,
            self.evidence.count(),
        )
    }
}

#[cfg(test)]
mod tests;
