//! A source on each of several channels.

use super::robust::Shared;
use super::track::Track;
use super::{
    Advice, Alternative, Answer, Bias, Cloud, Hypothesis, Locate, Mixture, Observation, PushError,
    Retract, Retracted, SigmaScale, Source,
};
use crate::random::Rng;
use crate::snapshot::{Persist, value};
use crate::{ConfigError, persist};

/// Locates the source of each [channel](Observation::channel) by an `L`, for up to `C` channels at a time. Channels are what
/// tells sources apart for certain: frequencies, or the identifiers that tags send.
///
/// Bearings of different channels never mix, but the scale of their errors and the bias of the array are learned from all. A
/// channel keeps its source while it is silent, for however long, until another one needs its place and it has been silent
/// for longest, counted in bearings: no time of day counts. It takes `C` times what an `L` does.
///
/// The number of a source is that of its channel.
///
/// ```
/// use foxhunt::aoa::{Bearing, Channels, Locator, Observation, Robust, robust::Config};
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus, normal};
///
/// let mut locator = Locator::<Channels<4, Robust<256>>>::new(Config::DEFAULT)?;
/// // Driving east between a transmitter on channel 1 and one on channel 2.
/// let places = [(1, [600.0_f32, 800.0]), (2, [900.0, -500.0])];
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// for i in 0..60 {
///     let (channel, [x, y]) = places[usize::from(i % 3 == 0)];
///     let east = 25.0 * i as f32;
///     let bearing = Bearing::from_radians(y.atan2(x - east) + 0.02 * normal(&mut rng));
///     let observation = Observation::new(1000 * i, [east, 0.0], bearing, 0.02)?;
///     locator.push(&observation.on_channel(channel), &mut rng)?;
/// }
/// for (channel, place) in places {
///     let fix = locator.state().on_channel(channel).and_then(|one| one.fix());
///     assert!(fix.expect("both are found").ellipse(0.95).contains(place));
/// }
/// # use foxhunt::aoa::Locate;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Channels<const C: usize, L> {
    locators: [L; C],
    slots: [Slot; C],
    /// Bearings so far, and on which channel the last was.
    count: u32,
    latest: u8,
}

/// Whose a locator is.
#[derive(Debug, Clone, Copy)]
struct Slot {
    is_taken: bool,
    channel: u8,
    /// How many bearings there had been when the last one of it came.
    heard: u32,
}

value!(Slot {
    is_taken,
    channel,
    heard
});

const FREE: Slot = Slot {
    is_taken: false,
    channel: 0,
    heard: 0,
};

persist!(impl[const C: usize, L: Persist] Channels<C, L> as "Channels"(C) { locators, slots, count, latest });

impl<const C: usize, L: Track> Channels<C, L> {
    /// The locator of a channel, if it has one.
    pub fn on_channel(&self, channel: u8) -> Option<&L> {
        self.locators.get(self.place(channel)?)
    }

    /// The channels that have a locator, in no particular order.
    pub fn channels(&self) -> impl Iterator<Item = u8> {
        let taken = self.slots.iter().filter(|slot| slot.is_taken);
        taken.map(|slot| slot.channel)
    }

    fn place(&self, channel: u8) -> Option<usize> {
        let is_its = |slot: &Slot| slot.is_taken && slot.channel == channel;
        self.slots.iter().position(is_its)
    }

    /// A free place, or that of the channel that has been silent for longest.
    fn longest_silent(&self) -> usize {
        let silence = |slot: &Slot| match slot.is_taken {
            true => u64::from(self.count.wrapping_sub(slot.heard)),
            false => u64::MAX,
        };
        let all = self.slots.iter().enumerate();
        let longest = all.max_by_key(|(_, slot)| silence(slot));
        longest.map_or(0, |(place, _)| place)
    }

    /// What the bearings of all channels but that of one place say of the errors that all have in common.
    fn shared(&self, but: usize) -> Shared {
        let all = self.slots.iter().zip(&self.locators).enumerate();
        let others = all.filter(|(place, (slot, _))| slot.is_taken && *place != but);
        Shared::together(others.map(|(_, (_, locator))| locator.shared()))
    }

    fn latest(&self) -> Option<&L> {
        self.on_channel(self.latest)
    }
}

impl<const C: usize, L: Track> Locate for Channels<C, L> {
    type Config = L::Config;

    const ALTERNATIVES: bool = L::ALTERNATIVES;

    const CHANNELS: bool = true;

    const EMPTY: Self = {
        assert!(C >= 1, "there is a locator for one channel at least");
        Self {
            locators: [const { L::EMPTY }; C],
            slots: [FREE; C],
            count: 0,
            latest: 0,
        }
    };

    fn check(config: &Self::Config) -> Result<(), ConfigError> {
        L::check(config)
    }

    fn push<R: Rng + ?Sized>(
        &mut self,
        observation: &Observation,
        config: &Self::Config,
        rng: &mut R,
    ) -> Result<Answer, PushError> {
        self.push_alternatives(&[(*observation).into()], config, rng)
    }

    /// The answer is that of the bearing's channel.
    fn push_alternatives<R: Rng + ?Sized>(
        &mut self,
        alternatives: &[Alternative],
        config: &Self::Config,
        rng: &mut R,
    ) -> Result<Answer, PushError> {
        let first = alternatives.first().ok_or(PushError::Empty)?.observation();
        let known = self.place(first.channel());
        let place = known.unwrap_or_else(|| self.longest_silent());
        let shared = self.shared(place);
        let all = self.locators.get_mut(place).zip(self.slots.get_mut(place));
        let (locator, slot) = all.ok_or(PushError::Empty)?;
        if known.is_none() {
            locator.reset();
        }
        locator.assume(&shared, first)?;
        let answer = locator.push_alternatives(alternatives, config, rng)?;
        self.count = self.count.wrapping_add(1);
        self.latest = first.channel();
        *slot = Slot {
            is_taken: true,
            channel: first.channel(),
            heard: self.count,
        };
        Ok(answer)
    }

    /// From all channels.
    fn retract<R: Rng + ?Sized>(
        &mut self,
        what: &Retract,
        config: &Self::Config,
        rng: &mut R,
    ) -> Retracted {
        let mut all = Retracted::NOTHING;
        for (slot, locator) in self.slots.iter().zip(&mut self.locators) {
            if slot.is_taken {
                all = all.plus(locator.retract(what, config, rng));
            }
        }
        all
    }

    /// Of the channel that was heard last.
    fn answer(&self) -> Answer {
        self.latest().map_or(Answer::NOTHING, Locate::answer)
    }

    fn reset(&mut self) {
        for locator in &mut self.locators {
            locator.reset();
        }
        self.slots = [FREE; C];
    }

    /// Those of all channels, in the order of their numbers.
    fn source(&self, index: usize) -> Option<Source> {
        let all = || self.slots.iter().zip(&self.locators);
        let fixed = || {
            let taken = all().filter(|(slot, _)| slot.is_taken);
            taken.filter_map(|(slot, locator)| Some((slot.channel, locator.source(0)?)))
        };
        let is_rank = |(channel, _): &(u8, Source)| {
            fixed().filter(|(other, _)| other < channel).count() == index
        };
        let (channel, source) = fixed().find(is_rank)?;
        Some(Source {
            identity: u16::from(channel),
            ..source
        })
    }

    /// Of the channel that was heard last.
    fn hypothesis(&self, index: usize) -> Option<Hypothesis> {
        self.latest()?.hypothesis(index)
    }

    /// Of the channel that was heard last.
    fn bias(&self, config: &Self::Config) -> Option<Bias> {
        self.latest()?.bias(config)
    }

    /// Of the channel that was heard last.
    fn rates(&self, config: &Self::Config) -> Option<Mixture> {
        self.latest()?.rates(config)
    }

    /// Of the channel that was heard last.
    fn sigma_scale(&self, config: &Self::Config) -> Option<SigmaScale> {
        self.latest()?.sigma_scale(config)
    }

    /// For the channel that was heard last.
    fn advice(&self, config: &Self::Config) -> Option<Advice> {
        self.latest()?.advice(config)
    }

    /// By the source of its channel.
    fn classify(&self, observation: &Observation, config: &Self::Config) -> Option<Mixture> {
        (self.on_channel(observation.channel())?).classify(observation, config)
    }

    fn cloud(&self, index: usize) -> Option<Cloud<'_>> {
        let channel = self.source(index)?.identity;
        self.on_channel(channel as u8)?.cloud(0)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::*;
    use crate::aoa::testing::is_zero;
    use crate::aoa::{Bearing, Locator, Robust, robust::Config};
    use crate::math::atan2;
    use crate::random::{SeedableRng, Xoshiro128PlusPlus, normal};

    type Three = Channels<3, Robust<128, 32>>;

    const PLACES: [[f32; 2]; 4] = [
        [900.0, 900.0],
        [1100.0, -700.0],
        [300.0, 600.0],
        [1400.0, 800.0],
    ];

    /// Bearings along a drive to the east, one a second, each on the channel that `whose` says.
    fn bearings(count: usize, seed: u64, whose: impl Fn(usize) -> u8) -> Vec<Observation> {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
        let take = |i: usize| {
            let channel = whose(i);
            let [x, y] = PLACES[usize::from(channel)];
            let east = 20.0 * i as f32;
            let bearing = Bearing::from_radians(atan2(y, x - east) + 0.02 * normal(&mut rng));
            Observation::new(1000 * i as u32, [east, 0.0], bearing, 0.02)
                .unwrap()
                .on_channel(channel)
        };
        (0..count).map(take).collect()
    }

    fn run(bearings: &[Observation], seed: u64) -> Locator<Three> {
        let mut locator = Locator::new(Config::DEFAULT).unwrap();
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
        for one in bearings {
            locator.push(one, &mut rng).unwrap();
        }
        locator
    }

    fn holds(source: &Source) -> bool {
        let place = PLACES[usize::from(source.identity)];
        source.fix.ellipse(0.999).contains(place)
    }

    #[test]
    fn channels_never_mix() {
        let locator = run(&bearings(90, 1, |i| (i % 3) as u8), 2);
        let all: Vec<Source> = (0..).map_while(|i| locator.source(i)).collect();
        assert_eq!(
            all.iter().map(|one| one.identity).collect::<Vec<_>>(),
            [0, 1, 2]
        );
        assert!(all.iter().all(holds));
        assert!(all.iter().all(|one| one.fix.bearings == 30));
    }

    #[test]
    fn a_burst_has_its_source_again_after_a_long_silence() {
        let bursts = |i: usize| u8::from((10..40).contains(&i) || i >= 100);
        let sights = bearings(104, 3, bursts);
        let locator = run(&sights, 4);
        let known = locator.state().on_channel(1).unwrap().fix().unwrap();
        assert_eq!(known.bearings, 34);
    }

    #[test]
    fn the_channel_that_has_been_silent_for_longest_makes_room() {
        // Channel 1 is silent from 40 on, channel 3 comes at 60.
        let whose = |i: usize| match i {
            0..40 => (i % 3) as u8,
            40..60 => {
                if i.is_multiple_of(2) {
                    0
                } else {
                    2
                }
            }
            _ => [0, 2, 3][i % 3],
        };
        let locator = run(&bearings(70, 5, whose), 6);
        let mut kept: Vec<u8> = locator.state().channels().collect();
        kept.sort_unstable();
        assert_eq!(kept, [0, 2, 3]);
    }

    #[test]
    fn what_one_channel_teaches_of_the_array_others_know() {
        let sights = bearings(90, 7, |i| (i % 3) as u8);
        let (mut own, mut rng) = (
            Locator::<Robust<128, 32>>::new(Config::DEFAULT).unwrap(),
            Xoshiro128PlusPlus::seed_from_u64(8),
        );
        for one in sights.iter().step_by(3) {
            own.push(one, &mut rng).unwrap();
        }
        let all = run(&sights, 8);
        let of_first = all.state().on_channel(0).unwrap();
        let shared = of_first.sigma_scale(&Config::DEFAULT).unwrap().sigma;
        assert!(shared < 0.8 * own.sigma_scale().unwrap().sigma);
    }

    #[test]
    fn an_empty_state_is_all_zero() {
        assert!(is_zero::<Three>(|place| {
            place.write(Three::EMPTY);
        }));
    }
}
