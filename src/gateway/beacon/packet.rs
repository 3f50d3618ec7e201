//! A packet of a tag, as a radio reports it.

use crate::checksum::crc32;
use crate::gateway::sentence::{columns, fixed};
use crate::snapshot::{Reader, Value, Writer, value};

use super::Rejected;

/// A tag's packet, as one radio heard it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Packet {
    /// When, in milliseconds of a clock that is common to all radios. It may overflow: only differences count.
    pub time_ms: u32,
    /// The radio that heard it: a beacon of the map, by its identifier.
    pub radio: u16,
    /// Who sent it.
    pub tag: u32,
    /// How strong it was, in dBm.
    pub rssi_dbm: i8,
}

impl Packet {
    /// Bytes of a frame before it is stuffed.
    pub const FRAME_BYTES: usize = 16;
    /// First byte of a frame: what it is, and in which version.
    const FRAME_KIND: u8 = 0xB1;

    /// Reads the fields `time,radio,tag,rssi`.
    pub(super) fn from_fields(fields: &[u8]) -> Result<Self, Rejected> {
        let columns: [&[u8]; 4] = columns(fields).ok_or(Rejected::Unparsable)?;
        let mut numbers = [0; 4];
        for (number, column) in numbers.iter_mut().zip(columns) {
            *number = fixed(column, 0).ok_or(Rejected::Unparsable)?;
        }
        let [time, radio, tag, rssi] = numbers;
        let out_of_range = |_| Rejected::OutOfRange;
        Ok(Self {
            time_ms: u32::try_from(time).map_err(out_of_range)?,
            radio: u16::try_from(radio).map_err(out_of_range)?,
            tag: u32::try_from(tag).map_err(out_of_range)?,
            rssi_dbm: i8::try_from(rssi).map_err(out_of_range)?,
        })
    }

    /// Reads a frame: kind, time, radio, tag, RSSI, and the CRC-32 of these; little-endian.
    ///
    /// # Errors
    /// [`Rejected::Checksum`], or [`Rejected::Unparsable`] for another length or kind.
    pub fn from_frame(frame: &[u8]) -> Result<Self, Rejected> {
        let (content, sum) = frame.split_last_chunk().ok_or(Rejected::Unparsable)?;
        if frame.len() != Self::FRAME_BYTES {
            return Err(Rejected::Unparsable);
        }
        if crc32(content) != u32::from_le_bytes(*sum) {
            return Err(Rejected::Checksum);
        }
        match Value::read(&mut Reader::new(content)) {
            Ok((Self::FRAME_KIND, packet)) => Ok(packet),
            _ => Err(Rejected::Unparsable),
        }
    }

    /// The frame of this packet, before it is stuffed: what a radio sends.
    pub fn to_frame(self) -> [u8; Self::FRAME_BYTES] {
        let mut frame = [0; Self::FRAME_BYTES];
        (Self::FRAME_KIND, self).write(&mut Writer::new(&mut frame));
        if let Some((content, sum)) = frame.split_last_chunk_mut() {
            *sum = crc32(content).to_le_bytes();
        }
        frame
    }
}

value!(Packet {
    time_ms,
    radio,
    tag,
    rssi_dbm
});

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_line_is_four_numbers() {
        let packet = Packet {
            time_ms: 12_500,
            radio: 3,
            tag: 4_000_000_000,
            rssi_dbm: -71,
        };
        assert_eq!(Packet::from_fields(b"12500,3,4000000000,-71"), Ok(packet));
        for (fields, reason) in [
            ("12500,3,7", Rejected::Unparsable),
            ("12500,3,,-71", Rejected::Unparsable),
            ("12500,3,7,-71dBm", Rejected::Unparsable),
            ("-1,3,7,-71", Rejected::OutOfRange),
            ("4294967296,3,7,-71", Rejected::OutOfRange),
            ("1,65536,7,-71", Rejected::OutOfRange),
            ("1,3,7,-171", Rejected::OutOfRange),
        ] {
            assert_eq!(
                Packet::from_fields(fields.as_bytes()),
                Err(reason),
                "{fields}"
            );
        }
    }

    proptest! {
        #[test]
        fn a_frame_brings_back_what_went_in(time_ms: u32, radio: u16, tag: u32, rssi_dbm: i8) {
            let packet = Packet { time_ms, radio, tag, rssi_dbm };
            prop_assert_eq!(Packet::from_frame(&packet.to_frame()), Ok(packet));
        }

        #[test]
        fn a_frame_with_a_wrong_bit_is_refused(tag: u32, bit in 0..8 * Packet::FRAME_BYTES) {
            let packet = Packet { time_ms: 1, radio: 2, tag, rssi_dbm: -60 };
            let mut frame = packet.to_frame();
            frame[bit / 8] ^= 1 << (bit % 8);
            prop_assert_eq!(Packet::from_frame(&frame), Err(Rejected::Checksum));
        }

        #[test]
        fn any_bytes_are_read_or_refused(bytes: std::vec::Vec<u8>) {
            let _ = Packet::from_frame(&bytes);
            let _ = Packet::from_fields(&bytes);
        }
    }
}
