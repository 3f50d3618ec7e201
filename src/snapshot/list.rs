//! Lists of a bounded length.

use heapless::Vec;

use super::{Error, Reader, Value, Writer};

/// The most bytes of a list of up to `capacity` values.
pub(crate) const fn bytes<T: Value>(capacity: usize) -> usize {
    u32::SIZE + capacity * T::SIZE
}

/// Writes the number of values, and the values.
pub(crate) fn save<T: Value>(list: &[T], to: &mut Writer<'_>) {
    (list.len() as u32).write(to);
    for value in list {
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
    for _ in 0..u32::read(from)? {
        list.push(T::read(from)?).map_err(|_| Error::Malformed)?;
    }
    Ok(())
}
