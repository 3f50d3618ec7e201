//! Several sources as bytes.

use super::{NotObservable, Nursery, Settings, Slot, Sources, Track};
use crate::aoa::locator::Answer;
use crate::snapshot::{Error, Persist, Reader, Value, Writer, shape, value};

impl<const K: usize, T: Track + Persist, const B: usize> Persist for Sources<K, T, B> {
    const SHAPE: u32 = shape(
        "Sources",
        &[K as u32, T::SHAPE, Nursery::<B>::SHAPE, Self::BYTES as u32],
    );
    const BYTES: usize =
        Settings::SIZE + K * (T::BYTES + Slot::SIZE) + Nursery::<B>::BYTES + Rest::SIZE;

    fn save(&self, to: &mut Writer<'_>) {
        let Self {
            settings,
            tracks,
            slots,
            nursery,
            silence_s,
            recent,
            wild,
            next_identity,
            reason,
        } = self;
        settings.write(to);
        for (track, slot) in tracks.iter().zip(slots) {
            track.save(to);
            slot.write(to);
        }
        nursery.save(to);
        let sums = [*silence_s, *recent, *wild];
        Rest::write(&((sums, *next_identity), *reason), to);
    }

    fn check(&self, from: &mut Reader<'_>) -> Result<(), Error> {
        if Settings::read(from)? != self.settings {
            return Err(Error::Settings);
        }
        for track in &self.tracks {
            track.check(from)?;
            Slot::read(from)?;
        }
        self.nursery.check(from)?;
        Rest::read(from).map(drop)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        Settings::read(from)?;
        for (track, slot) in self.tracks.iter_mut().zip(&mut self.slots) {
            track.load(from)?;
            *slot = Slot::read(from)?;
        }
        self.nursery.load(from)?;
        let sums;
        ((sums, self.next_identity), self.reason) = Rest::read(from)?;
        [self.silence_s, self.recent, self.wild] = sums;
        Ok(())
    }
}

/// In a snapshot, what is behind the nursery.
type Rest = (([f32; 3], u16), NotObservable);

value!(Settings {
    log_odds,
    bearings,
    seconds,
    least_share,
});

value!(Slot {
    identity,
    recent,
    silence_s,
});

/// As an answer.
impl Value for NotObservable {
    const SIZE: usize = Answer::SIZE;

    fn write(&self, to: &mut Writer<'_>) {
        Answer::NotObservable(*self).write(to);
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
        match Value::read(from)? {
            Answer::NotObservable(reason) => Ok(reason),
            Answer::Fix(_) => Err(Error::Malformed),
        }
    }
}
