//! A vehicle's gateway as bytes.

use super::Vehicle;
use crate::aoa::geodesy::LocalPlane;
use crate::aoa::{Locate, Observation};
use crate::gateway::clock::TimeOfDay;
use crate::gateway::{Counters, TakeSpectrum};
use crate::random::Xoshiro128PlusPlus;
use crate::snapshot::{self, Error, Persist, Reader, Value, Writer, shape};

impl<L: Locate + Persist, const REPORT: usize, S: TakeSpectrum> Vehicle<L, REPORT, S> {
    /// Writes all that is known of the source to the front of `buffer`, and returns that part of it: see
    /// [`snapshot::save`] and, for the size, [`snapshot::largest`].
    ///
    /// The plane, the locator, the generator, the counts and the latest bearing with its time are in it. Where the vehicle
    /// is and how it heads are not: by the time of a [`restore`](Self::restore) they are old, and the next sentences of
    /// the receiver tell them.
    ///
    /// # Errors
    /// [`Error::BufferTooSmall`].
    pub fn snapshot<'b>(&self, buffer: &'b mut [u8]) -> Result<&'b [u8], Error> {
        snapshot::save(self, buffer)
    }

    /// Goes on with the source of the [`snapshot`](Self::snapshot) at the front of `bytes`, as if it had known all along
    /// what that holds. What the vehicle's own gateway has heard of the receiver since it was started stays.
    ///
    /// Of the settings, those of the locator must be the same: what is known of the source rests on no others. Times are of
    /// the day, so it is up to the caller that a snapshot is not of another hunt.
    ///
    /// # Errors
    /// As [`snapshot::restore`]; nothing has changed then.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), Error> {
        snapshot::restore(self, bytes)
    }
}

/// In a snapshot, what is beside the locator: the plane and the generator, the latest bearing and the time of the last
/// report, the counts.
type Rest = (
    (Option<LocalPlane>, Option<Xoshiro128PlusPlus>),
    (
        (Option<(TimeOfDay, Observation)>, Option<TimeOfDay>),
        (u32, Counters),
    ),
);

impl<L: Locate + Persist, const REPORT: usize, S: TakeSpectrum> Persist for Vehicle<L, REPORT, S> {
    const SHAPE: u32 = shape("Vehicle", &[L::SHAPE, Rest::SIZE as u32]);
    const BYTES: usize = L::BYTES + Rest::SIZE;

    fn save(&self, to: &mut Writer<'_>) {
        let Self {
            settings: _,
            reader: _,
            counters,
            receiver: _,
            finder: _,
            places: _,
            headings: _,
            courses: _,
            own_place: _,
            plane,
            strays: _,
            locator,
            generator,
            given,
            latest,
            reported,
            report: _,
        } = self;
        locator.save(to);
        let of_source = (*plane, generator.clone());
        let times = (*latest, *reported);
        Rest::write(&(of_source, (times, (*given, *counters))), to);
    }

    fn check(&self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.locator.check(from)?;
        Rest::read(from).map(drop)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.locator.load(from)?;
        (
            (self.plane, self.generator),
            ((self.latest, self.reported), (self.given, self.counters)),
        ) = Rest::read(from)?;
        self.strays = None;
        self.report.clear();
        Ok(())
    }
}
