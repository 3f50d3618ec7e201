//! Two buffers, of which one holds a whole snapshot at any time.

use core::marker::PhantomData;

use super::{CHECKSUM, Error, HEADER, Persist, Reader, Value, Writer, open, seal, shape, take};

/// Keeps the latest snapshots of a state by turns in two buffers: whenever the writing of one is cut short, the other is
/// whole.
///
/// The buffers are wherever bytes outlive what the state does not, such as in RAM that a reset leaves alone; garbage in
/// them is no snapshot. Each snapshot is numbered, under its checksum, to tell the newer one.
///
/// ```
/// use foxhunt::aoa::{Clean, Locate};
/// use foxhunt::snapshot::Keeper;
///
/// type State = Clean<100>;
/// let mut ram = [[0xA5; Keeper::<State>::BYTES]; 2];
///
/// let [one, other] = &mut ram;
/// let mut keeper = Keeper::new([one, other]);
/// let mut locator = State::EMPTY;
/// assert!(keeper.restore(&mut locator).is_err());
/// for _bearing in 0..3 {
///     keeper.save(&locator)?;
/// }
///
/// // After a reset.
/// let [one, other] = &mut ram;
/// let mut keeper = Keeper::new([one, other]);
/// assert_eq!(keeper.restore(&mut locator), Ok(3));
/// # Ok::<(), foxhunt::snapshot::Error>(())
/// ```
#[derive(Debug)]
pub struct Keeper<'a, T> {
    newer: &'a mut [u8],
    older: &'a mut [u8],
    /// Of the newer one.
    number: u32,
    state: PhantomData<fn(&T)>,
}

impl<'a, T: Persist> Keeper<'a, T> {
    /// Of either buffer.
    pub const BYTES: usize = HEADER + u32::SIZE + T::BYTES + CHECKSUM;

    const SHAPE: u32 = shape("Keeper", &[T::SHAPE]);

    /// Goes on with what is in the buffers, if anything is.
    pub fn new([one, other]: [&'a mut [u8]; 2]) -> Self {
        let numbers = (Self::number(one), Self::number(other));
        let (newer, older, number) = match numbers {
            // The shorter way round: numbers begin again when they are used up.
            (Ok(a), Ok(b)) if (b.wrapping_sub(a) as i32) < 0 => (one, other, a),
            (_, Ok(b)) => (other, one, b),
            (Ok(a), Err(_)) => (one, other, a),
            (Err(_), Err(_)) => (one, other, 0),
        };
        Self {
            newer,
            older,
            number,
            state: PhantomData,
        }
    }

    /// Writes a snapshot over the older one.
    ///
    /// # Errors
    /// [`Error::BufferTooSmall`]; the newer one stays what it is.
    pub fn save(&mut self, state: &T) -> Result<(), Error> {
        let number = self.number.wrapping_add(1);
        let mut writer = Writer::new(self.older.get_mut(HEADER..).unwrap_or_default());
        number.write(&mut writer);
        state.save(&mut writer);
        let content = writer.count();
        seal(self.older, Self::SHAPE, content)?;
        self.number = number;
        core::mem::swap(&mut self.newer, &mut self.older);
        Ok(())
    }

    /// Makes `state` what it was when the newest snapshot was taken that can be restored, and returns the number of that:
    /// how many were taken, if the buffers began with none.
    ///
    /// # Errors
    /// When neither can be, why the newer one cannot; `state` is then as it was before.
    pub fn restore(&mut self, state: &mut T) -> Result<u32, Error> {
        Self::restore_from(self.newer, state).or_else(|error| {
            let number = Self::restore_from(self.older, state).map_err(|_| error)?;
            // The next one is written over the one that is of no use.
            core::mem::swap(&mut self.newer, &mut self.older);
            Ok(number)
        })
    }

    fn restore_from(bytes: &[u8], state: &mut T) -> Result<u32, Error> {
        let mut content = Reader::new(open(bytes, Self::SHAPE)?);
        let number = u32::read(&mut content)?;
        take(state, content)?;
        Ok(number)
    }

    fn number(bytes: &[u8]) -> Result<u32, Error> {
        u32::read(&mut Reader::new(open(bytes, Self::SHAPE)?))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::{vec, vec::Vec};

    use super::*;
    use crate::aoa::{Bearing, Clean, Locate, Observation, clean};
    use crate::random::{Rng, SeedableRng, Xoshiro128PlusPlus};
    use crate::snapshot::save;

    type State = Clean<5, 3>;
    type Ram = [Vec<u8>; 2];

    fn new() -> State {
        State::EMPTY
    }

    /// What is known after so many bearings.
    fn after(bearings: u16) -> State {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
        let mut state = new();
        for i in 0..bearings {
            let bearing = Bearing::from_compass_degrees(40.0 + f32::from(i));
            let place = [50.0 * f32::from(i), 0.0];
            let observation = Observation::new(1000 * u32::from(i), place, bearing, 0.03);
            let config = clean::Config::DEFAULT;
            state
                .push(&observation.unwrap(), &config, &mut rng)
                .unwrap();
        }
        state
    }

    fn bytes(state: &State) -> Vec<u8> {
        let mut buffer = vec![0; crate::snapshot::largest::<State>()];
        save(state, &mut buffer).unwrap().to_vec()
    }

    fn garbage(seed: u64) -> Ram {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
        [(); 2].map(|()| {
            let byte = |_| rng.next_u32() as u8;
            (0..Keeper::<State>::BYTES).map(byte).collect()
        })
    }

    fn keeper(ram: &mut Ram) -> Keeper<'_, State> {
        let [one, other] = ram;
        Keeper::new([one, other])
    }

    fn restored(ram: &mut Ram) -> Result<(u32, Vec<u8>), Error> {
        let mut state = new();
        let before = bytes(&state);
        match keeper(ram).restore(&mut state) {
            Ok(number) => Ok((number, bytes(&state))),
            Err(error) => {
                assert_eq!(bytes(&state), before);
                Err(error)
            }
        }
    }

    #[test]
    fn the_newest_is_restored() {
        let mut ram = garbage(1);
        assert_eq!(restored(&mut ram), Err(Error::NotASnapshot));
        for count in 1..10 {
            // A reset after each.
            keeper(&mut ram).save(&after(count)).unwrap();
            let expected = (u32::from(count), bytes(&after(count)));
            assert_eq!(restored(&mut ram), Ok(expected.clone()));
            ram.swap(0, 1);
            assert_eq!(restored(&mut ram), Ok(expected));
        }
        let mut ram = garbage(2);
        let mut keeper = keeper(&mut ram);
        for count in 0..10 {
            keeper.save(&after(count)).unwrap();
        }
        assert_eq!(restored(&mut ram), Ok((10, bytes(&after(9)))));
    }

    #[test]
    fn numbers_begin_again() {
        let mut ram = garbage(1);
        let mut keeper = keeper(&mut ram);
        keeper.number = u32::MAX - 1;
        for count in 1..4 {
            keeper.save(&after(count)).unwrap();
        }
        assert_eq!(restored(&mut ram), Ok((1, bytes(&after(3)))));
    }

    /// In the order of writing: the content, the header, the checksum; and in that of the addresses.
    #[test]
    fn power_that_fails_while_one_is_written_leaves_the_other() {
        let length = Keeper::<State>::BYTES;
        let header = 0..HEADER;
        let content = HEADER..length - CHECKSUM;
        let checksum = length - CHECKSUM..length;
        let written = content.chain(header).chain(checksum);
        let orders: [Vec<usize>; 2] = [written.collect(), (0..length).collect()];
        for earlier in 0..3 {
            let mut before = garbage(1);
            for count in 1..=earlier {
                keeper(&mut before).save(&after(count)).unwrap();
            }
            let old = restored(&mut before);
            let mut whole = before.clone();
            keeper(&mut whole).save(&after(earlier + 1)).unwrap();
            let new = restored(&mut whole);
            for order in &orders {
                let mut ram = before.clone();
                for place in order {
                    for (byte, end) in ram.iter_mut().zip(&whole) {
                        byte[*place] = end[*place];
                    }
                    if ram == whole {
                        continue;
                    }
                    let mut found = restored(&mut ram);
                    // Why the one being written is of no use is any reason.
                    if old.is_err() && found.is_err() {
                        found.clone_from(&old);
                    }
                    assert_eq!(found, old);
                    let mut resumed = ram.clone();
                    keeper(&mut resumed).save(&after(9)).unwrap();
                    assert_eq!(restored(&mut resumed).unwrap().1, bytes(&after(9)));
                    if let Ok((_, old)) = &old {
                        let [one, other] = &mut resumed;
                        // It was the broken one that was written over.
                        let spoil = keeper_is_newer(one) == Some(true);
                        if spoil { one } else { other }.fill(0);
                        assert_eq!(&restored(&mut resumed).unwrap().1, old);
                    }
                }
                assert_eq!(restored(&mut ram), new);
            }
        }
    }

    /// Whether a buffer holds [`after`] nine bearings.
    fn keeper_is_newer(buffer: &[u8]) -> Option<bool> {
        let mut state = new();
        Keeper::<State>::restore_from(buffer, &mut state).ok()?;
        Some(bytes(&state) == bytes(&after(9)))
    }

    #[test]
    fn small_buffers_keep_nothing() {
        let mut small = [vec![0; 10], vec![0; Keeper::<State>::BYTES]];
        let mut keeper = keeper(&mut small);
        keeper.save(&after(3)).unwrap();
        let error = keeper.save(&after(4)).unwrap_err();
        assert!(matches!(error, Error::BufferTooSmall { .. }));
        assert_eq!(restored(&mut small), Ok((1, bytes(&after(3)))));
    }
}
