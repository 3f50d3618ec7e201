//! What locators have in common.

use core::fmt::Debug;

use super::advice::Advice;
use super::alternative::Alternative;
use super::answer::{Answer, Bias, Cloud, Fix, Hypothesis, Mixture, SigmaScale, Source};
use super::observation::{Observation, PushError};
use super::retract::{Retract, Retracted};
use crate::ConfigError;
use crate::random::Rng;

/// The state of a locator: takes bearings, and says where sources are.
///
/// A state holds no configuration; every call that needs it borrows it, so that one in flash serves many states.
/// [`Locator`] holds both, for short programs. What a locator does not estimate is `None` here, at no cost.
///
/// Bearings may come out of order. A late one is taken in its place if the locator still keeps an earlier one; otherwise
/// it is [`PushError::TooOld`]. The second of a station and time is a [`PushError::Duplicate`].
pub trait Locate {
    /// What the locator can be told.
    type Config: Copy + PartialEq + Debug;

    /// Nothing is known. All bits are zero, so that a `static` takes no flash.
    const EMPTY: Self;

    /// Whether it takes more than the most probable of several bearings that exclude each other. If not, whoever calls it
    /// may leave the others out.
    const ALTERNATIVES: bool = false;

    /// Whether it keeps bearings of different [channels](Observation::channel) apart.
    const CHANNELS: bool = false;

    /// Checks a configuration.
    ///
    /// # Errors
    /// Names the field that is out of range.
    fn check(config: &Self::Config) -> Result<(), ConfigError>;

    /// Takes one bearing, and says what is known with it.
    ///
    /// # Errors
    /// When the bearing is too old or a duplicate; the state is then as before.
    fn push<R: Rng + ?Sized>(
        &mut self,
        observation: &Observation,
        config: &Self::Config,
        rng: &mut R,
    ) -> Result<Answer, PushError>;

    /// Takes a reading of several bearings that exclude each other, and says what is known with it. Some locators take the
    /// most probable one alone; [`Robust`](crate::aoa::Robust), and whatever wraps it, take all: see
    /// [`ALTERNATIVES`](Self::ALTERNATIVES).
    ///
    /// # Errors
    /// When there is no bearing, or the reading is too old or a duplicate; the state is then as before.
    fn push_alternatives<R: Rng + ?Sized>(
        &mut self,
        alternatives: &[Alternative],
        config: &Self::Config,
        rng: &mut R,
    ) -> Result<Answer, PushError> {
        let best = Alternative::most_probable(alternatives).ok_or(PushError::Empty)?;
        self.push(best, config, rng)
    }

    /// Takes bearings back, as far as they can be told from others, and locates the source without them. A full buffer
    /// averages bearings, and so do readings of one place: what stands in a mean with others stays, and is said to.
    ///
    /// A locator that cannot take back anything says that it did not.
    fn retract<R: Rng + ?Sized>(
        &mut self,
        _what: &Retract,
        _config: &Self::Config,
        _rng: &mut R,
    ) -> Retracted {
        Retracted::NOTHING
    }

    /// What is known of the source; of the best known one, where there are several.
    fn answer(&self) -> Answer;

    /// The fix of that source, if there is one.
    fn fix(&self) -> Option<Fix> {
        self.answer().fix()
    }

    /// Forgets everything.
    fn reset(&mut self);

    /// The source of this index among those that have a fix, the best known first.
    fn source(&self, index: usize) -> Option<Source> {
        let fix = self.fix().filter(|_| index == 0)?;
        Some(Source {
            identity: 0,
            probability: 1.0,
            fix,
            motion: None,
        })
    }

    /// A place where one more source may be, beside those that have a fix, and with what probability; the likeliest first.
    fn candidate(&self, _index: usize) -> Option<Hypothesis> {
        None
    }

    /// A place where the source may be, of up to four, in no particular order: before a fix, too.
    fn hypothesis(&self, _index: usize) -> Option<Hypothesis> {
        None
    }

    /// The bias of the latest bearing, which it has in common with others; `None` before the first fix.
    fn bias(&self, _config: &Self::Config) -> Option<Bias> {
        None
    }

    /// The rates of direct, mirrored and outlier bearings, as learned so far.
    fn rates(&self, _config: &Self::Config) -> Option<Mixture> {
        None
    }

    /// The scale of the stated sigmas, as learned so far; `None` where they are taken as stated.
    fn sigma_scale(&self, _config: &Self::Config) -> Option<SigmaScale> {
        None
    }

    /// Where to drive, so that the next bearings tell most; `None` before the first bearing.
    fn advice(&self, _config: &Self::Config) -> Option<Advice> {
        None
    }

    /// The probabilities that a bearing is direct, mirrored or an outlier; `None` without a fix, or where every bearing is
    /// taken for direct.
    fn classify(&self, _observation: &Observation, _config: &Self::Config) -> Option<Mixture> {
        None
    }

    /// The particles of the source with this index.
    fn cloud(&self, _index: usize) -> Option<Cloud<'_>> {
        None
    }
}

/// A locator: a state with its configuration, for programs that need not keep them apart.
///
/// ```
/// use foxhunt::aoa::{Bearing, Clean, Locator, Observation, clean::Config};
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
///
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut locator = Locator::<Clean<100>>::new(Config::DEFAULT)?;
/// // Driving east, past a transmitter 800 m to the north.
/// for (second, east, degrees) in [(0, 0.0, 36.6), (20, 300.0, 20.8), (40, 600.0, 359.7), (60, 900.0, 339.9)] {
///     let bearing = Bearing::from_compass_degrees(degrees);
///     let observation = Observation::new(1000 * second, [east, 0.0], bearing, 0.02)?;
///     locator.push(&observation, &mut rng)?;
/// }
/// let fix = locator.fix().expect("the bearings cross");
/// assert!(fix.ellipse(0.95).contains([600.0, 800.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Locator<L: Locate> {
    config: L::Config,
    state: L,
}

impl<L: Locate> Locator<L> {
    /// A locator without bearings.
    ///
    /// # Errors
    /// Names the field of the configuration that is out of range.
    pub fn new(config: L::Config) -> Result<Self, ConfigError> {
        L::check(&config)?;
        Ok(Self {
            config,
            state: L::EMPTY,
        })
    }

    /// The configuration.
    pub const fn config(&self) -> &L::Config {
        &self.config
    }

    /// The state, with what only this kind of locator knows.
    pub const fn state(&self) -> &L {
        &self.state
    }

    /// See [`Locate::push`].
    ///
    /// # Errors
    /// When the bearing is too old or a duplicate; the locator is then as before.
    pub fn push<R: Rng + ?Sized>(
        &mut self,
        observation: &Observation,
        rng: &mut R,
    ) -> Result<Answer, PushError> {
        self.state.push(observation, &self.config, rng)
    }

    /// See [`Locate::push_alternatives`].
    ///
    /// # Errors
    /// When there is no bearing, or the reading is too old or a duplicate; the locator is then as before.
    pub fn push_alternatives<R: Rng + ?Sized>(
        &mut self,
        alternatives: &[Alternative],
        rng: &mut R,
    ) -> Result<Answer, PushError> {
        self.state
            .push_alternatives(alternatives, &self.config, rng)
    }

    /// See [`Locate::retract`].
    pub fn retract<R: Rng + ?Sized>(&mut self, what: &Retract, rng: &mut R) -> Retracted {
        self.state.retract(what, &self.config, rng)
    }

    /// See [`Locate::answer`].
    pub fn answer(&self) -> Answer {
        self.state.answer()
    }

    /// See [`Locate::fix`].
    pub fn fix(&self) -> Option<Fix> {
        self.state.fix()
    }

    /// Forgets everything but the configuration.
    pub fn reset(&mut self) {
        self.state.reset();
    }

    /// See [`Locate::source`].
    pub fn source(&self, index: usize) -> Option<Source> {
        self.state.source(index)
    }

    /// The places where one more source may be, beside those that have a fix; the likeliest first.
    pub fn candidates(&self) -> impl Iterator<Item = Hypothesis> {
        (0..).map_while(|index| self.state.candidate(index))
    }

    /// The places where the source may be, in no particular order: before a fix, too.
    pub fn hypotheses(&self) -> impl Iterator<Item = Hypothesis> {
        (0..).map_while(|index| self.state.hypothesis(index))
    }

    /// See [`Locate::bias`].
    pub fn bias(&self) -> Option<Bias> {
        self.state.bias(&self.config)
    }

    /// See [`Locate::rates`].
    pub fn rates(&self) -> Option<Mixture> {
        self.state.rates(&self.config)
    }

    /// See [`Locate::sigma_scale`].
    pub fn sigma_scale(&self) -> Option<SigmaScale> {
        self.state.sigma_scale(&self.config)
    }

    /// See [`Locate::advice`].
    pub fn advice(&self) -> Option<Advice> {
        self.state.advice(&self.config)
    }

    /// See [`Locate::classify`].
    pub fn classify(&self, observation: &Observation) -> Option<Mixture> {
        self.state.classify(observation, &self.config)
    }

    /// See [`Locate::cloud`].
    pub fn cloud(&self, index: usize) -> Option<Cloud<'_>> {
        self.state.cloud(index)
    }
}
