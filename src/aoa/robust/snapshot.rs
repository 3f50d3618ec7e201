//! Robust locators as bytes.

use super::errors::Correlation;
use super::evidence::Evidence;
use super::mode::{MODES, Mode};
use super::{Errors, Nursery, RobustLocator, Settings, Shares, Tails};
use crate::aoa::locator::Answer;
use crate::filter::ParticleFilter;
use crate::snapshot::{Error, Persist, Reader, Value, Writer, list, shape, value};

impl<const N: usize, const B: usize> Persist for RobustLocator<N, B> {
    const SHAPE: u32 = shape(
        "RobustLocator",
        &[
            ParticleFilter::<3, N>::SHAPE,
            Evidence::<B>::SHAPE,
            Self::BYTES as u32,
        ],
    );
    const BYTES: usize = Settings::SIZE
        + Errors::SIZE
        + Evidence::<B>::BYTES
        + ParticleFilter::<3, N>::BYTES
        + list::bytes::<Mode>(MODES)
        + Rest::SIZE;

    fn save(&self, to: &mut Writer<'_>) {
        let Self {
            settings,
            errors,
            evidence,
            filter,
            modes,
            answer,
            since_search,
            withheld,
        } = self;
        settings.write(to);
        errors.write(to);
        evidence.save(to);
        filter.save(to);
        list::save(modes, to);
        Rest::write(&(*answer, (*since_search, *withheld)), to);
    }

    fn check(&self, from: &mut Reader<'_>) -> Result<(), Error> {
        if Settings::read(from)? != self.settings {
            return Err(Error::Settings);
        }
        Errors::read(from)?;
        self.evidence.check(from)?;
        self.filter.check(from)?;
        list::check::<Mode>(MODES, from)?;
        Rest::read(from).map(drop)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        Settings::read(from)?;
        self.errors = Errors::read(from)?;
        self.evidence.load(from)?;
        self.filter.load(from)?;
        list::load(&mut self.modes, from)?;
        (self.answer, (self.since_search, self.withheld)) = Rest::read(from)?;
        Ok(())
    }
}

/// In a snapshot, what is behind the modes.
type Rest = (Answer, (u32, f32));

impl<const B: usize> Persist for Nursery<B> {
    const SHAPE: u32 = shape("Nursery", &[Evidence::<B>::SHAPE, Self::BYTES as u32]);
    const BYTES: usize = Evidence::<B>::BYTES + list::bytes::<Mode>(MODES);

    fn save(&self, to: &mut Writer<'_>) {
        let Self { evidence, modes } = self;
        evidence.save(to);
        list::save(modes, to);
    }

    fn check(&self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.evidence.check(from)?;
        list::check::<Mode>(MODES, from)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.evidence.load(from)?;
        list::load(&mut self.modes, from)
    }
}

value!(Settings {
    errors,
    common,
    range_m,
});

value!(Errors {
    tails,
    shares,
    prior_bearings,
    bias_deviation,
    position_deviation,
    correlation,
});

value!(Shares {
    direct,
    mirror,
    wild,
});

value!(Correlation {
    at_rest,
    distance_m,
    time_s,
});

/// The degrees of freedom, or zero.
impl Value for Tails {
    const SIZE: usize = 1;

    fn write(&self, to: &mut Writer<'_>) {
        match self {
            Self::Normal => 0,
            Self::Student { freedom } => *freedom,
        }
        .write(to);
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
        Ok(match u8::read(from)? {
            0 => Self::Normal,
            freedom => Self::Student { freedom },
        })
    }
}

value!(Mode {
    mean,
    covariance,
    log_mass,
    share,
});
