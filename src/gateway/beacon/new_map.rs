//! A new radio map over the line, in pieces, into a buffer that the caller lends.

use crate::error::messages;
use crate::fingerprint::{Encoding, MapError, RadioMap};

/// A piece of a radio map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MapPiece {
    /// Where its bytes stand in the map.
    pub offset: u32,
    /// Bytes of the whole map.
    pub total: u32,
    length: u8,
    bytes: [u8; Self::BYTES],
}

impl MapPiece {
    /// The most bytes of a piece.
    pub const BYTES: usize = 32;

    /// Its bytes.
    pub fn bytes(&self) -> &[u8] {
        self.bytes
            .get(..usize::from(self.length))
            .unwrap_or_default()
    }

    pub(super) fn new(offset: u32, total: u32, (length, bytes): (u8, [u8; Self::BYTES])) -> Self {
        Self {
            offset,
            total,
            length,
            bytes,
        }
    }
}

/// Why a piece of a map, or the whole map, was refused. The map begins anew with its first piece, except after
/// [`NewMapError::Order`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum NewMapError {
    /// The map is longer than the buffer.
    Room,
    /// Another piece should have come: the answer says which.
    Order,
    /// It is no map, is damaged, or has more points or radios than the gateway has room for.
    Map(MapError),
    /// It holds no means and sigmas.
    Encoding,
    /// It is a plane, and there is room for one axis.
    Axes,
}

messages!(NewMapError {
    Self::Room => "the map is longer than the buffer",
    Self::Order => "another piece of the map should have come",
    Self::Map(_) => "no map, a damaged one, or too large a one",
    Self::Encoding => "the map holds no means and sigmas",
    Self::Axes => "the map is a plane, and there is room for one axis",
});

/// What a gateway has room for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Room {
    pub points: usize,
    pub beacons: usize,
    pub axes: usize,
}

/// How much of a map has come.
#[derive(Debug)]
pub(super) struct Reception {
    received: u32,
    total: u32,
}

impl Reception {
    pub const EMPTY: Self = Self {
        received: 0,
        total: 0,
    };

    /// The bytes that have come.
    pub fn received(&self) -> u32 {
        self.received
    }

    /// Takes a piece; returns the map once all of it has come and it is one that the gateway can use.
    pub fn take<'b>(
        &mut self,
        piece: &MapPiece,
        buffer: &'b mut [u8],
        room: &Room,
    ) -> Result<Option<RadioMap<'b>>, NewMapError> {
        if piece.offset == 0 {
            (self.received, self.total) = (0, piece.total);
        }
        let is_next = piece.offset == self.received && piece.total == self.total;
        let bytes = piece.bytes();
        let end = piece.offset.saturating_add(bytes.len() as u32);
        if !is_next || end > self.total {
            return Err(NewMapError::Order);
        }
        let taken = self.store(piece, buffer, end, room);
        if taken.is_err() {
            *self = Self::EMPTY;
        }
        taken
    }

    fn store<'b>(
        &mut self,
        piece: &MapPiece,
        buffer: &'b mut [u8],
        end: u32,
        room: &Room,
    ) -> Result<Option<RadioMap<'b>>, NewMapError> {
        let whole = buffer
            .get_mut(..self.total as usize)
            .ok_or(NewMapError::Room)?;
        let to = whole.get_mut(piece.offset as usize..end as usize);
        for (to, byte) in to.unwrap_or_default().iter_mut().zip(piece.bytes()) {
            *to = *byte;
        }
        self.received = end;
        if end < self.total {
            return Ok(None);
        }
        *self = Self::EMPTY;
        let map = RadioMap::new(whole).and_then(|map| map.limited(room.points, room.beacons));
        let map = map.map_err(NewMapError::Map)?;
        if map.encoding() != Encoding::Moments {
            return Err(NewMapError::Encoding);
        }
        if map.lattice().axes() > room.axes {
            return Err(NewMapError::Axes);
        }
        Ok(Some(map))
    }
}
