//! Where the next bytes of a snapshot go, and where they come from.

use super::Error;

/// Takes the bytes of a snapshot.
///
/// What there is no room for is counted, but dropped.
#[derive(Debug)]
pub struct Writer<'a> {
    rest: &'a mut [u8],
    count: usize,
}

impl<'a> Writer<'a> {
    pub(crate) const fn new(buffer: &'a mut [u8]) -> Self {
        Self {
            rest: buffer,
            count: 0,
        }
    }

    /// Bytes so far, with those that were dropped.
    pub(super) const fn count(&self) -> usize {
        self.count
    }

    /// Takes so many bytes as they are.
    #[inline(always)]
    pub fn bytes<const K: usize>(&mut self, bytes: [u8; K]) {
        self.count = self.count.saturating_add(K);
        // Nothing goes behind a gap.
        if let Some((place, rest)) = core::mem::take(&mut self.rest).split_first_chunk_mut() {
            *place = bytes;
            self.rest = rest;
        }
    }

    /// Takes numbers whose count the reader knows.
    pub fn column(&mut self, numbers: &[f32]) {
        self.count = self.count.saturating_add(size_of_val(numbers));
        let rest = core::mem::take(&mut self.rest);
        if let Some((places, rest)) = rest.split_at_mut_checked(size_of_val(numbers)) {
            let (places, _) = places.as_chunks_mut();
            for (place, number) in places.iter_mut().zip(numbers) {
                *place = number.to_le_bytes();
            }
            self.rest = rest;
        }
    }
}

/// Gives the bytes of a snapshot.
#[derive(Debug, Clone)]
pub struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    pub(crate) const fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    pub(super) const fn is_at_end(&self) -> bool {
        self.rest.is_empty()
    }

    /// The next so many bytes.
    ///
    /// # Errors
    /// [`Error::Malformed`] when there are fewer.
    #[inline(always)]
    pub fn bytes<const K: usize>(&mut self) -> Result<[u8; K], Error> {
        let (bytes, rest) = self.rest.split_first_chunk().ok_or(Error::Malformed)?;
        self.rest = rest;
        Ok(*bytes)
    }

    /// As many numbers as there is room for.
    ///
    /// # Errors
    /// [`Error::Malformed`] when there are fewer.
    pub fn column(&mut self, numbers: &mut [f32]) -> Result<(), Error> {
        let (places, _) = self.skip(size_of_val(numbers))?.as_chunks();
        for (number, place) in numbers.iter_mut().zip(places) {
            *number = f32::from_le_bytes(*place);
        }
        Ok(())
    }

    /// The next so many bytes, unread.
    ///
    /// # Errors
    /// [`Error::Malformed`] when there are fewer.
    pub fn skip(&mut self, bytes: usize) -> Result<&'a [u8], Error> {
        let (skipped, rest) = self.rest.split_at_checked(bytes).ok_or(Error::Malformed)?;
        self.rest = rest;
        Ok(skipped)
    }
}
