//! Locators as bytes.

use super::evidence::Evidence;
use super::{Answer, Fix, Locator, Moves, NotObservable, Settings};
use crate::filter::ParticleFilter;
use crate::snapshot::{Error, Persist, Reader, Value, Writer, by_value, shape, value};

/// What moves the particles is not in a snapshot: they are drawn from the same posterior whatever it is, and one that
/// goes on with other moves is as right, if not the same.
impl<const N: usize, const B: usize, M: Moves<N>> Persist for Locator<N, B, M> {
    const SHAPE: u32 = shape(
        "Locator",
        &[
            ParticleFilter::<2, N>::SHAPE,
            Evidence::<B>::SHAPE,
            Self::BYTES as u32,
        ],
    );
    const BYTES: usize =
        Settings::SIZE + Evidence::<B>::BYTES + ParticleFilter::<2, N>::BYTES + Answer::SIZE;

    fn save(&self, to: &mut Writer<'_>) {
        let Self {
            settings,
            evidence,
            filter,
            answer,
            moves: _,
            memory: _,
        } = self;
        settings.write(to);
        evidence.save(to);
        filter.save(to);
        answer.write(to);
    }

    fn check(&self, from: &mut Reader<'_>) -> Result<(), Error> {
        if Settings::read(from)? != self.settings {
            return Err(Error::Settings);
        }
        self.evidence.check(from)?;
        self.filter.check(from)?;
        Answer::read(from).map(drop)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        Settings::read(from)?;
        self.evidence.load(from)?;
        self.filter.load(from)?;
        self.answer = Answer::read(from)?;
        Ok(())
    }
}

value!(Settings {
    relative_range_error,
    resample_share,
    moves,
});

value!(Fix {
    position,
    covariance,
    effective_sample_size,
    bearings,
});

/// A number for what it is, then its fields.
impl Value for Answer {
    const SIZE: usize = 1 + Fix::SIZE;

    fn write(&self, to: &mut Writer<'_>) {
        match self {
            Self::Fix(fix) => {
                0u8.write(to);
                fix.write(to);
            }
            Self::NotObservable(NotObservable::TooFewBearings { have }) => {
                1u8.write(to);
                have.write(to);
            }
            Self::NotObservable(NotObservable::CrossingAngle { radians, needed }) => {
                2u8.write(to);
                [*radians, *needed].write(to);
            }
            Self::NotObservable(NotObservable::NoIntersection) => 3u8.write(to),
        }
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
        Ok(Self::NotObservable(match u8::read(from)? {
            0 => return Fix::read(from).map(Self::Fix),
            1 => NotObservable::TooFewBearings {
                have: Value::read(from)?,
            },
            2 => {
                let [radians, needed] = Value::read(from)?;
                NotObservable::CrossingAngle { radians, needed }
            }
            3 => NotObservable::NoIntersection,
            _ => return Err(Error::Malformed),
        }))
    }
}

by_value!(Answer);
