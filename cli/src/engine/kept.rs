//! A locator that keeps its bearings, so that any of them can be taken back exactly.

use foxhunt::{
    ConfigError,
    aoa::{
        Advice, Alternative, Answer, Bias, Cloud, Hypothesis, Locate, Mixture, Observation,
        PushError, SigmaScale, Source,
    },
    random::{Rng, SeedableRng, Xoshiro128PlusPlus},
};

/// Bearings from one copy of the state to the next: fewer cost memory, more cost time when one is taken back.
const SPACING: usize = 64;

/// The most copies that are kept; beyond, every second one goes.
const COPIES: usize = 32;

/// What a [`Kept`] is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config<C> {
    /// The configuration of the locator itself.
    pub inner: C,
    /// Seeds the particles, as it does in the gateway of the firmware.
    pub seed: u64,
}

/// A locator and all bearings that it took.
///
/// One that is taken back leaves nothing behind: the others are taken again, with the same random numbers, from the last copy
/// of the state before it.
#[derive(Debug)]
pub struct Kept<L> {
    now: Copied<L>,
    taken: Vec<Taken>,
    copies: Vec<Copied<L>>,
    spacing: usize,
}

#[derive(Debug, Clone)]
struct Copied<L> {
    state: L,
    generator: Option<Xoshiro128PlusPlus>,
    /// Bearings that were taken until then, those that were taken back among them.
    count: usize,
}

#[derive(Debug)]
struct Taken {
    alternatives: Vec<Alternative>,
    is_retracted: bool,
}

impl<L: Locate + Clone> Kept<L> {
    /// How many bearings were taken since the beginning of the search, those that were taken back among them.
    pub fn count(&self) -> usize {
        self.taken.len()
    }

    /// Takes a bearing back, or takes it again; by its place among all. Says whether anything has changed.
    pub fn retract(
        &mut self,
        index: usize,
        is_retracted: bool,
        config: &Config<L::Config>,
    ) -> bool {
        match self.taken.get_mut(index) {
            Some(taken) if taken.is_retracted != is_retracted => taken.is_retracted = is_retracted,
            _ => return false,
        }
        self.copies.retain(|copy| copy.count <= index);
        self.now = self.copies.last().cloned().unwrap_or(Self::EMPTY.now);
        while self.now.count < self.taken.len() {
            self.advance(config);
        }
        true
    }

    /// Takes the next of the kept bearings, which was taken before.
    fn advance(&mut self, config: &Config<L::Config>) {
        if let Some(taken) = self.taken.get(self.now.count)
            && !taken.is_retracted
        {
            // What was too late without another bearing may still be.
            let _ = self.now.push(&taken.alternatives, config);
        }
        self.now.count += 1;
        self.copy();
    }

    fn copy(&mut self) {
        let last = self.copies.last().map_or(0, |copy| copy.count);
        if self.now.count < last + self.spacing.max(SPACING) {
            return;
        }
        self.copies.push(self.now.clone());
        if self.copies.len() > COPIES {
            let mut is_kept = false;
            self.copies.retain(|_| {
                is_kept = !is_kept;
                is_kept
            });
            self.spacing = 2 * self.spacing.max(SPACING);
        }
    }

    fn take(
        &mut self,
        alternatives: &[Alternative],
        config: &Config<L::Config>,
    ) -> Result<Answer, PushError> {
        let answer = self.now.push(alternatives, config)?;
        self.taken.push(Taken {
            alternatives: alternatives.to_vec(),
            is_retracted: false,
        });
        self.now.count += 1;
        self.copy();
        Ok(answer)
    }
}

impl<L: Locate> Copied<L> {
    fn push(
        &mut self,
        alternatives: &[Alternative],
        config: &Config<L::Config>,
    ) -> Result<Answer, PushError> {
        let generator =
            (self.generator).get_or_insert_with(|| Xoshiro128PlusPlus::seed_from_u64(config.seed));
        match alternatives {
            [one] if !L::ALTERNATIVES => {
                self.state.push(one.observation(), &config.inner, generator)
            }
            all => self.state.push_alternatives(all, &config.inner, generator),
        }
    }
}

impl<L: Locate + Clone> Locate for Kept<L> {
    type Config = Config<L::Config>;

    const EMPTY: Self = Self {
        now: Copied {
            state: L::EMPTY,
            generator: None,
            count: 0,
        },
        taken: Vec::new(),
        copies: Vec::new(),
        spacing: 0,
    };

    const ALTERNATIVES: bool = L::ALTERNATIVES;
    const CHANNELS: bool = L::CHANNELS;

    fn check(config: &Self::Config) -> Result<(), ConfigError> {
        L::check(&config.inner)
    }

    fn push<R: Rng + ?Sized>(
        &mut self,
        observation: &Observation,
        config: &Self::Config,
        _rng: &mut R,
    ) -> Result<Answer, PushError> {
        self.take(&[Alternative::from(*observation)], config)
    }

    fn push_alternatives<R: Rng + ?Sized>(
        &mut self,
        alternatives: &[Alternative],
        config: &Self::Config,
        _rng: &mut R,
    ) -> Result<Answer, PushError> {
        self.take(alternatives, config)
    }

    fn answer(&self) -> Answer {
        self.now.state.answer()
    }

    fn reset(&mut self) {
        *self = Self::EMPTY;
    }

    fn source(&self, index: usize) -> Option<Source> {
        self.now.state.source(index)
    }

    fn candidate(&self, index: usize) -> Option<Hypothesis> {
        self.now.state.candidate(index)
    }

    fn hypothesis(&self, index: usize) -> Option<Hypothesis> {
        self.now.state.hypothesis(index)
    }

    fn bias(&self, config: &Self::Config) -> Option<Bias> {
        self.now.state.bias(&config.inner)
    }

    fn rates(&self, config: &Self::Config) -> Option<Mixture> {
        self.now.state.rates(&config.inner)
    }

    fn sigma_scale(&self, config: &Self::Config) -> Option<SigmaScale> {
        self.now.state.sigma_scale(&config.inner)
    }

    fn advice(&self, config: &Self::Config) -> Option<Advice> {
        self.now.state.advice(&config.inner)
    }

    fn classify(&self, observation: &Observation, config: &Self::Config) -> Option<Mixture> {
        self.now.state.classify(observation, &config.inner)
    }

    fn cloud(&self, index: usize) -> Option<Cloud<'_>> {
        self.now.state.cloud(index)
    }
}

#[cfg(test)]
mod tests {
    use foxhunt::aoa::{Bearing, Robust, robust};

    use super::*;

    type Locator = Kept<Robust<64, 32>>;

    const CONFIG: Config<robust::Config> = Config {
        inner: robust::Config::CITY,
        seed: 7,
    };

    fn bearing(k: u32) -> Observation {
        let east = 5.0 * k as f32;
        let angle = 800f32.atan2(600.0 - east) + 0.02 * (k as f32 * 1.7).sin();
        Observation::new(1_000 * k, [east, 0.0], Bearing::from_radians(angle), 0.03).unwrap()
    }

    fn of(bearings: impl Iterator<Item = u32>) -> Box<Locator> {
        let mut locator = Box::new(Locator::EMPTY);
        let mut unused = Xoshiro128PlusPlus::seed_from_u64(0);
        for k in bearings {
            locator.push(&bearing(k), &CONFIG, &mut unused).unwrap();
        }
        locator
    }

    /// Whatever is taken back, the others alone would have led to the same, to the last bit.
    #[test]
    fn a_bearing_that_is_taken_back_leaves_nothing_behind() {
        const ALL: u32 = 200;
        let mut locator = of(0..ALL);
        let before = locator.answer();
        for index in [0, 3, 63, 64, 130, 199] {
            assert!(locator.retract(index, true, &CONFIG));
            assert!(!locator.retract(index, true, &CONFIG));
            let without = of((0..ALL).filter(|k| *k as usize != index));
            assert_eq!(locator.answer(), without.answer(), "{index}");
            assert!(locator.retract(index, false, &CONFIG));
            assert_eq!(locator.answer(), before, "{index}");
        }
        assert!(!locator.retract(200, true, &CONFIG));
        assert!(before.fix().is_some());
    }
}
