//! A locator for clean bearings: all of them point at the source, but for normal errors.
//!
//! A particle filter for a source that does not move and may be anywhere: its prior is flat. It keeps the bearings, in a
//! bounded buffer, because their joint likelihood is what particles must be moved by when they have become too few: a
//! filter that forgets them can only jitter its particles, which costs accuracy and, with few particles, the source.
//!
//! * Before the bearings rule out that they are parallel the answer is [`Answer::NotObservable`], with the reason.
//! * Then particles start from intersections of random pairs of bearings (Du et al. 2016, eq. 22 and 23) and are weighed
//!   by all bearings.
//! * Each further bearing weighs them once. When the effective sample size falls, they are resampled and moved by
//!   Metropolis-Hastings steps that leave the posterior of all bearings invariant (resample-move: Gilks and Berzuini
//!   2001): draws about the mode of the posterior and steps of a random walk, or those of any
//!   [`Refinement`](crate::refine::Refinement) of the [configuration](Config::with_refinement).
//! * When the buffer is full, the two bearings that say most nearly the same are averaged: none is forgotten.

mod posterior;
mod track;

use super::core::{Buffer, Crossing, Entry, is_depleted, sweep};
use super::triangulation::random_crossing;
use super::words::Belief;
use super::{
    Advice, Answer, BearingLikelihood, Cloud, Fix, Locate, NotObservable, Observation, PushError,
    Retract, Retracted,
};
use crate::ConfigError;
use crate::config::require_within;
use crate::filter::ParticleFilter;
use crate::math::sqrt;
use crate::persist;
use crate::random::Rng;
use crate::resample::Scheme;
pub(super) use posterior::Moves;
use posterior::{ModeProposal, Posterior, misfit, misfit_at_infinity, mode};

/// What a [`Clean`] locator can be told.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Config<M = ()> {
    /// Largest standard deviation of the range to the source that makes a fix, as a fraction of the range, 0.01 to 1.
    pub relative_range_sigma: f32,
    /// Particles are resampled and moved when the effective sample size falls below this fraction of their number, 0 to 1.
    pub resample_below: f32,
    /// Metropolis-Hastings steps of every particle after a resampling, 1 to 16. Each evaluates all bearings in the buffer
    /// once. A refinement has its own number of moves.
    pub moves: u8,
    /// The refinement that moves the particles; `()` for the locator's own moves.
    pub refinement: M,
}

impl Config {
    /// For a direction finder on a vehicle.
    pub const DEFAULT: Self = Self::with_refinement(());
}

impl<M> Config<M> {
    /// The default, but that `refinement` moves the particles by the posterior of all bearings.
    ///
    /// ```
    /// use foxhunt::aoa::{Clean, Locator, clean::Config};
    /// use foxhunt::refine::FishSchool;
    ///
    /// let school = FishSchool::METROPOLIS;
    /// let locator = Locator::<Clean<100, 64, FishSchool>>::new(Config::with_refinement(school));
    /// ```
    ///
    /// With [`Acceptance::Metropolis`](crate::refine::Acceptance::Metropolis), as here, the posterior stays exact and so
    /// does the ellipse, if each particle is offered four places or so. Read at
    /// [`Acceptance::Greedy`](crate::refine::Acceptance::Greedy) what that form does to the ellipse.
    pub const fn with_refinement(refinement: M) -> Self {
        Self {
            relative_range_sigma: 0.25,
            resample_below: 0.5,
            moves: 2,
            refinement,
        }
    }

    /// Checks the fields, but not the refinement, which has a check of its own.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub const fn check(&self) -> Result<(), ConfigError> {
        require_within!(self: relative_range_sigma 0.01..=1.0, resample_below 0.0..=1.0, moves 1..=16);
        Ok(())
    }
}

/// Locates one stationary source by clean bearings, with `N` particles and a buffer of `B` bearings.
///
/// `M` moves the particles: the locator's own moves, `()`, or any [`Refinement`](crate::refine::Refinement), whose memory
/// takes `28 N + 1028` bytes more. See [`Locator`](super::Locator) for an example.
#[derive(Debug, Clone)]
pub struct Clean<const N: usize, const B: usize = 64, M: Moves<N> = ()> {
    bearings: Buffer<B>,
    filter: ParticleFilter<2, N>,
    answer: Answer,
    memory: M::Memory,
}

/// How far away a source may be that there is no fix of: where advice looks for it, and candidates are expected.
const RANGE_M: f32 = 20_000.0;

/// Least moves of every particle before the first fix: fewer keep traces of the intersections, more take time.
const START_MOVES: u8 = 8;

/// A bearing is surprising if the particles find it this much less likely than one without an error, as a logarithm: derived,
/// an error of four sigmas, which one in 16,000 has.
const SURPRISING: f32 = 8.0;

impl<const N: usize, const B: usize, M: Moves<N>> Locate for Clean<N, B, M> {
    type Config = Config<M>;

    const EMPTY: Self = {
        assert!(N >= 2 && B >= 2, "a locator needs particles and bearings");
        Self {
            bearings: Buffer::EMPTY,
            filter: ParticleFilter::EMPTY,
            answer: Answer::NOTHING,
            memory: M::EMPTY,
        }
    };

    fn check(config: &Config<M>) -> Result<(), ConfigError> {
        config.check()?;
        config.refinement.check()
    }

    /// Number of likelihoods that it evaluates:
    ///
    /// * no particle moves: `N`
    /// * the particles move: `N (1 + B (moves + 1))`, and a Gauss-Newton search of the `B` bearings
    /// * first fix: `10 N B` with `N` rounded up to a multiple of 16, and such a search
    ///
    /// The first fix is the same whatever moves the particles. A refinement then takes `B` times its
    /// [`evaluations`](crate::refine::Refinement::evaluations) to move them, after the locator's own moves if the
    /// effective sample size is below 8.
    fn push<R: Rng + ?Sized>(
        &mut self,
        observation: &Observation,
        config: &Config<M>,
        rng: &mut R,
    ) -> Result<Answer, PushError> {
        self.bearings.admit(observation)?;
        self.bearings.note(observation, 1.0);
        let source = self.answer.fix().map(|fix| fix.position);
        let new = Entry::new(*observation, 1.0);
        self.bearings.add(new, &source);
        self.answer = if source.is_some() {
            let likelihood = BearingLikelihood::new(observation);
            // A normal likelihood is never zero, so the update cannot fail.
            let evidence = self.filter.update(&likelihood).unwrap_or(likelihood.peak);
            let surprising = likelihood.peak - evidence > SURPRISING;
            // Of a cloud that has shrunk to a point all particles weigh the same: it never has too few.
            if self.rejuvenate(config, rng) || surprising {
                self.find_again(config, rng)
                    .map(|()| self.cloud_fix())
                    .into()
            } else {
                Answer::Fix(self.cloud_fix())
            }
        } else {
            self.first_answer(config, rng)
        };
        Ok(self.answer)
    }

    fn retract<R: Rng + ?Sized>(
        &mut self,
        what: &Retract,
        config: &Config<M>,
        rng: &mut R,
    ) -> Retracted {
        let retracted = self.bearings.retract(what);
        if retracted.bearings > 0 {
            self.answer = self.first_answer(config, rng);
        }
        retracted
    }

    fn answer(&self) -> Answer {
        self.answer
    }

    fn reset(&mut self) {
        self.bearings.clear();
        self.answer = Answer::NOTHING;
    }

    #[inline(never)]
    fn advice(&self, _: &Config<M>) -> Option<Advice> {
        let latest = self.bearings.latest()?;
        let belief = match self.cloud(0) {
            Some(cloud) => Belief::of_particles(cloud),
            None => Belief::of_ray(latest, RANGE_M),
        };
        belief.advice(latest, self.answer.missing_angle())
    }

    fn cloud(&self, index: usize) -> Option<Cloud<'_>> {
        self.answer.fix().filter(|_| index == 0)?;
        let [east, north] = self.columns();
        Some(Cloud {
            east,
            north,
            weights: self.weights(),
        })
    }
}

impl<const N: usize, const B: usize, M: Moves<N>> Clean<N, B, M> {
    /// The particles' coordinates: metres east, metres north. They mean nothing before the first fix.
    pub fn columns(&self) -> [&[f32]; 2] {
        self.filter.particles().columns()
    }

    /// The particles' weights, which sum to one.
    pub fn weights(&self) -> &[f32] {
        self.filter.weights()
    }

    /// The bearings in the buffer, in no particular order; some are averages once it is full.
    pub fn observations(&self) -> impl ExactSizeIterator<Item = &Observation> {
        self.bearings.observations()
    }

    /// What is known before there is a fix, which may be the first one.
    fn first_answer<R: Rng + ?Sized>(&mut self, config: &Config<M>, rng: &mut R) -> Answer {
        let fix = self.observe(config, rng).map(|mode| {
            self.start(mode, config, rng);
            self.cloud_fix()
        });
        fix.into()
    }

    /// Whether the bearings make a fix: the normal distribution about their intersection, or the reason why not.
    #[inline(never)]
    fn observe<R: Rng + ?Sized>(
        &self,
        config: &Config<M>,
        rng: &mut R,
    ) -> Result<ModeProposal, NotObservable> {
        /// The best of this many random intersections starts the search: enough that one is near the source.
        const CANDIDATES: u32 = 8;
        let bearings = self.bearings.entries();
        let have = bearings.len();
        if have < 2 {
            return Err(NotObservable::TooFewBearings { have: have as u32 });
        }
        let (at_infinity, information) = misfit_at_infinity(&self.bearings);
        let crossing = |gain| Crossing {
            gain,
            information,
            limit: config.relative_range_sigma,
            enough: 1.0,
        };

        let mut best = None;
        for _ in 0..CANDIDATES {
            if let Some(point) = intersection(bearings, rng) {
                let residual = misfit(&self.bearings, point);
                if best.is_none_or(|(_, least)| residual < least) {
                    best = Some((point, residual));
                }
            }
        }
        let Some(found) = best.and_then(|(start, _)| mode(&self.bearings, start)) else {
            // Are they as parallel as their errors let them be?
            return Err(if is_consistent(at_infinity, have as f32 - 1.0) {
                crossing(0.0).reason()
            } else {
                NotObservable::NoIntersection
            });
        };
        let gain = at_infinity - misfit(&self.bearings, found.mean());
        let variance = found.covariance().largest_eigenvalue();
        crossing(gain).check(variance, self.bearings.range_squared(found.mean()))?;
        Ok(found)
    }

    /// Starts the particles from intersections of pairs of bearings.
    #[inline(never)]
    fn start<R: Rng + ?Sized>(&mut self, mode: ModeProposal, config: &Config<M>, rng: &mut R) {
        let bearings = self.bearings.entries();
        self.filter.initialise(rng, |rng| {
            intersection(bearings, rng).unwrap_or_else(|| mode.step(mode.mean(), 1.0, rng))
        });
        let posterior = Posterior::new(&self.bearings);
        let _ = self.filter.update(&posterior);
        self.filter.resample(Scheme::Systematic, rng);
        // Intersections are not drawn from the posterior: it takes more moves than usual to forget that.
        let moves = config.moves.max(START_MOVES);
        sweep(self.filter.columns_mut(), &posterior, &mode, moves, rng);
    }

    /// Resamples and moves the particles if they are worth too few; says whether it did.
    // Apart, so that its memory is free when the source is searched for.
    #[inline(never)]
    fn rejuvenate<R: Rng + ?Sized>(&mut self, config: &Config<M>, rng: &mut R) -> bool {
        let worth = self.filter.effective_sample_size();
        let depleted = is_depleted(worth, N, config.resample_below);
        if depleted {
            let (filter, memory) = (&mut self.filter, &mut self.memory);
            let (refinement, posterior) = (&config.refinement, Posterior::new(&self.bearings));
            refinement.rejuvenate(filter, &posterior, config.moves, memory, rng);
        }
        depleted
    }

    /// Starts again from the best intersection if the particles are at a mode that other bearings have left behind, as may
    /// happen if errors are larger than stated, or have something in common.
    ///
    /// # Errors
    /// The reason if the bearings make no fix any more, neither where the particles are nor elsewhere.
    #[inline(never)]
    fn find_again<R: Rng + ?Sized>(
        &mut self,
        config: &Config<M>,
        rng: &mut R,
    ) -> Result<(), NotObservable> {
        /// Twice the logarithm of the odds, 8,000 to 1, at which another mode is believed instead.
        const BETTER: f32 = 18.0;
        let here = misfit(&self.bearings, self.filter.mean());
        // Bearings with the errors that they state always fit.
        if is_consistent(here, self.bearings.entries().len() as f32 - 2.0) {
            return Ok(());
        }
        let found = match self.observe(config, rng) {
            Ok(found) => found,
            // Beyond what bearings can tell from infinity.
            Err(reason) if misfit_at_infinity(&self.bearings).0 - here < BETTER => {
                return Err(reason);
            }
            Err(_) => return Ok(()),
        };
        if misfit(&self.bearings, found.mean()) + BETTER < here {
            self.start(found, config, rng);
        }
        Ok(())
    }

    fn cloud_fix(&self) -> Fix {
        let n = self.filter.effective_sample_size();
        Fix::of_cloud(
            self.filter.mean(),
            self.filter.covariance(),
            n,
            self.bearings.count(),
        )
    }
}

/// Whether a sum of squares of errors in sigmas is within four sigmas of what it should be.
fn is_consistent(misfit: f32, freedom: f32) -> bool {
    misfit < freedom + 4.0 * sqrt(2.0 * freedom)
}

/// Where the rays of a random pair of bearings intersect.
fn intersection<R: Rng + ?Sized>(bearings: &[Entry], rng: &mut R) -> Option<[f32; 2]> {
    /// Least sine of the angle of two bearings whose intersection may start a particle: less starts some far away.
    const LEAST_SINE: f32 = 0.02;
    /// More find one among more bearings that are nearly parallel, for time.
    const TRIES: u32 = 32;
    random_crossing(bearings, LEAST_SINE, TRIES, rng, |_, _, crossing| {
        crossing.is_ahead
    })
}

// What moves the particles is not in a snapshot: they are drawn from the same posterior whatever it is, and one that goes
// on with other moves is as right, if not the same.
persist!(impl[const N: usize, const B: usize, M: Moves<N>] Clean<N, B, M> as "Clean"(N, B) {
    bearings, filter, answer
} without { memory });

#[cfg(test)]
mod tests;
