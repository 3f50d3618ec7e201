//! Lists of a bounded length.

use heapless::{Deque, Vec};

use super::{Error, Persist, Reader, Value, Writer, shape};

/// The most bytes of a list of up to `capacity` values.
pub(crate) const fn bytes<T: Value>(capacity: usize) -> usize {
    u32::SIZE + capacity * T::SIZE
}

/// Writes the number of values, and the values.
pub(crate) fn save<'a, T: Value + 'a>(
    list: impl IntoIterator<Item = &'a T, IntoIter: ExactSizeIterator>,
    to: &mut Writer<'_>,
) {
    let values = list.into_iter();
    (values.len() as u32).write(to);
    for value in values {
        value.write(to);
    }
}

/// Reads what [`load`] would.
pub(crate) fn check<T: Value>(capacity: usize, from: &mut Reader<'_>) -> Result<(), Error> {
    let length = u32::read(from)?;
    if length as usize > capacity {
        return Err(Error::Malformed);
    }
    for _ in 0..length {
        T::read(from)?;
    }
    Ok(())
}

/// Reads what [`save`] wrote.
pub(crate) fn load<T: Value, const B: usize>(
    list: &mut Vec<T, B>,
    from: &mut Reader<'_>,
) -> Result<(), Error> {
    list.clear();
    each(from, |value| list.push(value))
}

/// Reads what [`save`] wrote, and gives the values away until one is refused.
pub(crate) fn each<T: Value>(
    from: &mut Reader<'_>,
    mut take: impl FnMut(T) -> Result<(), T>,
) -> Result<(), Error> {
    for _ in 0..u32::read(from)? {
        take(T::read(from)?).map_err(|_| Error::Malformed)?;
    }
    Ok(())
}

/// The number of values, and the values.
impl<T: Value, const B: usize> Persist for Vec<T, B> {
    const SHAPE: u32 = shape("list", &[B as u32, T::SIZE as u32]);
    const BYTES: usize = bytes::<T>(B);

    fn save(&self, to: &mut Writer<'_>) {
        save(self, to);
    }

    fn check(&self, from: &mut Reader<'_>) -> Result<(), Error> {
        check::<T>(B, from)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        load(self, from)
    }
}

impl<T: Value, const B: usize> Persist for Deque<T, B> {
    const SHAPE: u32 = shape("list", &[B as u32, T::SIZE as u32]);
    const BYTES: usize = bytes::<T>(B);

    fn save(&self, to: &mut Writer<'_>) {
        save(self, to);
    }

    fn check(&self, from: &mut Reader<'_>) -> Result<(), Error> {
        check::<T>(B, from)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.clear();
        each(from, |value| self.push_back(value))
    }
}
