//! Pursuits as bytes.

use super::cloud::{COMPONENTS, Cloud};
use super::component::{Component, Offset};
use super::recent::{Old, RECENT, Recent};
use super::settings::Habits;
use super::{Errors, Lost, Phase, Pursuit, Settings};
use crate::aoa::locator::{Answer, Fix};
use crate::aoa::robust::RobustLocator;
use crate::snapshot::{Error, Persist, Reader, Value, Writer, list, shape, value};

impl<const N: usize, const B: usize> Persist for Pursuit<N, B> {
    const SHAPE: u32 = shape(
        "Pursuit",
        &[RobustLocator::<N, B>::SHAPE, Self::BYTES as u32],
    );
    const BYTES: usize = Settings::SIZE
        + RobustLocator::<N, B>::BYTES
        + Cloud::BYTES
        + Recent::BYTES
        + Errors::SIZE
        + Rest::SIZE;

    fn save(&self, to: &mut Writer<'_>) {
        let Self {
            settings,
            locator,
            errors,
            cloud,
            parked,
            phase,
            recent,
            fitted,
            tried,
            lost,
            seen,
            bearings,
            answer,
        } = self;
        settings.write(to);
        locator.save(to);
        cloud.save(to);
        recent.save(to);
        errors.write(to);
        let numbers = ([*parked, *fitted], [*tried, *bearings]);
        Rest::write(&((numbers, (*phase, *lost)), (*seen, *answer)), to);
    }

    fn check(&self, from: &mut Reader<'_>) -> Result<(), Error> {
        if Settings::read(from)? != self.settings {
            return Err(Error::Settings);
        }
        self.locator.check(from)?;
        self.cloud.check(from)?;
        self.recent.check(from)?;
        Errors::read(from)?;
        Rest::read(from).map(drop)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        Settings::read(from)?;
        self.locator.load(from)?;
        self.cloud.load(from)?;
        self.recent.load(from)?;
        self.errors = Errors::read(from)?;
        let (numbers, of_phase);
        ((numbers, of_phase), (self.seen, self.answer)) = Rest::read(from)?;
        (self.phase, self.lost) = of_phase;
        ([self.parked, self.fitted], [self.tried, self.bearings]) = numbers;
        Ok(())
    }
}

/// In a snapshot, what is behind the errors.
type Rest = (
    (([f32; 2], [u32; 2]), (Phase, Option<Lost>)),
    (Option<Fix>, Answer),
);

/// Of one that is not alive, too: its weights decide when it is resampled.
impl Persist for Cloud {
    const SHAPE: u32 = shape("pursuit::Cloud", &[Self::BYTES as u32]);
    const BYTES: usize = COMPONENTS * (Component::SIZE + 2 * f32::SIZE) + Weight::SIZE;

    fn save(&self, to: &mut Writer<'_>) {
        let Self {
            components,
            log_weights,
            weights,
            log_sum,
            effective_sample_size,
            offset,
            alive,
        } = self;
        for component in components {
            component.write(to);
        }
        to.column(log_weights);
        to.column(weights);
        Weight::write(&([*log_sum, *effective_sample_size], (*offset, *alive)), to);
    }

    fn check(&self, from: &mut Reader<'_>) -> Result<(), Error> {
        from.skip(Self::BYTES - Weight::SIZE)?;
        Weight::read(from).map(drop)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        for component in &mut self.components {
            *component = Component::read(from)?;
        }
        from.column(&mut self.log_weights)?;
        from.column(&mut self.weights)?;
        let sums;
        (sums, (self.offset, self.alive)) = Weight::read(from)?;
        [self.log_sum, self.effective_sample_size] = sums;
        Ok(())
    }
}

/// In a snapshot, what is behind the weights.
type Weight = ([f32; 2], (Offset, bool));

/// A list.
impl Persist for Recent {
    const SHAPE: u32 = shape("pursuit::Recent", &[Self::BYTES as u32]);
    const BYTES: usize = list::bytes::<Old>(RECENT);

    fn save(&self, to: &mut Writer<'_>) {
        list::save(&self.bearings, to);
    }

    fn check(&self, from: &mut Reader<'_>) -> Result<(), Error> {
        list::check::<Old>(RECENT, from)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.clear();
        list::each(from, |old| self.bearings.push_back(old))
    }
}

value!(Settings { locator, habits });

value!(Habits {
    speed,
    parked_s,
    driving_s,
    straight_s,
});

value!(Component {
    place,
    velocity,
    place_spread,
    common,
    velocity_spread,
    rest,
});

value!(Offset { mean, variance });

value!(Old {
    observation,
    age_s,
    seconds,
});

value!(Lost { seconds, bearings });

impl Value for Phase {
    const SIZE: usize = 1;

    fn write(&self, to: &mut Writer<'_>) {
        (*self as u8).write(to);
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
        Ok(match u8::read(from)? {
            0 => Self::Parked,
            1 => Self::Departing,
            2 => Self::Driving,
            _ => return Err(Error::Malformed),
        })
    }
}
