//! Bytes to packets and requests, in one of two forms.

use cobs::{DecodeResult, DecoderState};
use heapless::Vec;

use super::{Framing, MapPiece, Rejected, Spot};
use crate::checksum::crc32;
use crate::gateway::formats::Nmea;
use crate::gateway::line::LineReader;
use crate::gateway::sentence::{self, columns, fixed};
use crate::snapshot::{Reader, Value, Writer, value};

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

impl Spot {
    /// Reads the fields `tag,x,y,floor`, in metres.
    pub(super) fn from_fields(fields: &[u8]) -> Result<Self, Rejected> {
        let [tag, x, y, floor]: [&[u8]; 4] = columns(fields).ok_or(Rejected::Unparsable)?;
        let number = |text, places| fixed(text, places).ok_or(Rejected::Unparsable);
        let place = [number(x, 3)?, number(y, 3)?];
        // As far as a map may reach, in millimetres.
        if place.iter().any(|metres| metres.abs() > 1_000_000_000) {
            return Err(Rejected::OutOfRange);
        }
        let out_of_range = |_| Rejected::OutOfRange;
        Ok(Self {
            tag: u32::try_from(number(tag, 0)?).map_err(out_of_range)?,
            place: place.map(|millimetres| millimetres as f32 / 1e3),
            floor: u8::try_from(number(floor, 0)?).map_err(out_of_range)?,
        })
    }
}

impl MapPiece {
    /// Reads the fields `offset,total,bytes`, the bytes in hexadecimal.
    pub(super) fn from_fields(fields: &[u8]) -> Result<Self, Rejected> {
        let [offset, total, digits]: [&[u8]; 3] = columns(fields).ok_or(Rejected::Unparsable)?;
        let number = |text| {
            let number = fixed(text, 0).ok_or(Rejected::Unparsable)?;
            u32::try_from(number).map_err(|_| Rejected::OutOfRange)
        };
        let (pairs, rest) = digits.as_chunks::<2>();
        if pairs.is_empty() || pairs.len() > Self::BYTES || !rest.is_empty() {
            return Err(Rejected::Unparsable);
        }
        let mut bytes = [0; Self::BYTES];
        for (byte, pair) in bytes.iter_mut().zip(pairs) {
            let digit = |digit: u8| char::from(digit).to_digit(16).ok_or(Rejected::Unparsable);
            *byte = (digit(pair[0])? << 4 | digit(pair[1])?) as u8;
        }
        let held = (pairs.len() as u8, bytes);
        Ok(Self::new(number(offset)?, number(total)?, held))
    }
}

/// What a message says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Message {
    Packet(Packet),
    /// The host asks for every tag's position and for the status.
    Query,
    /// The host begins anew.
    Restart,
    /// A survey is recorded, or no more.
    Survey(Option<Spot>),
    /// A piece of another map.
    MapPiece(MapPiece),
    /// A correct sentence of another kind.
    Other,
}

/// Collects the bytes of one message.
#[derive(Debug)]
pub(super) struct Input {
    lines: LineReader<(Nmea,)>,
    frames: FrameReader,
}

impl Input {
    pub const EMPTY: Self = Self {
        lines: LineReader::EMPTY,
        frames: FrameReader::EMPTY,
    };

    /// Takes a byte; returns the message that ends with it, if one does.
    pub fn push(&mut self, byte: u8, framing: Framing) -> Option<Result<Message, Rejected>> {
        match framing {
            Framing::Lines => Some(match self.lines.push(byte)? {
                Ok(()) => from_line(self.lines.bytes()),
                Err(crate::gateway::Rejected::Overlong) => Err(Rejected::Overlong),
                Err(_) => Err(Rejected::Unparsable),
            }),
            Framing::Frames => self.frames.push(byte),
        }
    }
}

fn from_line(line: &[u8]) -> Result<Message, Rejected> {
    match sentence::checked(line, b"$!").ok_or(Rejected::Checksum)? {
        b"PFOXQ" => Ok(Message::Query),
        b"PFOXR" => Ok(Message::Restart),
        [b'P', b'F', b'O', b'X', b'B', b',', fields @ ..] => {
            Packet::from_fields(fields).map(Message::Packet)
        }
        b"PFOXV" => Ok(Message::Survey(None)),
        [b'P', b'F', b'O', b'X', b'V', b',', fields @ ..] => {
            Spot::from_fields(fields).map(|spot| Message::Survey(Some(spot)))
        }
        [b'P', b'F', b'O', b'X', b'M', b',', fields @ ..] => {
            MapPiece::from_fields(fields).map(Message::MapPiece)
        }
        _ => Ok(Message::Other),
    }
}

/// Undoes consistent overhead byte stuffing: a zero ends every frame and stands nowhere else.
#[derive(Debug)]
pub(super) struct FrameReader {
    state: DecoderState,
    frame: Vec<u8, { Packet::FRAME_BYTES }>,
    /// The frame is too long; what is left of it is skipped.
    overlong: bool,
}

impl FrameReader {
    const EMPTY: Self = Self {
        state: DecoderState::Idle,
        frame: Vec::new(),
        overlong: false,
    };

    fn push(&mut self, byte: u8) -> Option<Result<Message, Rejected>> {
        if self.overlong {
            self.overlong = byte != 0;
            return (!self.overlong).then_some(Err(Rejected::Overlong));
        }
        match self.state.feed(byte) {
            Ok(DecodeResult::NoData) => None,
            Ok(DecodeResult::DataStart) => {
                self.frame.clear();
                None
            }
            Ok(DecodeResult::DataContinue(byte)) => {
                if self.frame.push(byte).is_err() {
                    self.state = DecoderState::Idle;
                    self.overlong = true;
                }
                None
            }
            Ok(DecodeResult::DataComplete) => Some(match self.frame.as_slice() {
                b"Q" => Ok(Message::Query),
                b"R" => Ok(Message::Restart),
                frame => Packet::from_frame(frame).map(Message::Packet),
            }),
            // A zero within a block: the zero has ended the frame.
            Err(_) => Some(Err(Rejected::Unparsable)),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;
    use std::{format, vec};

    const PACKET: Packet = Packet {
        time_ms: 256,
        radio: 0,
        tag: 7,
        rssi_dbm: -60,
    };

    fn read(framing: Framing, bytes: &[u8]) -> Vec<Result<Message, Rejected>> {
        let mut input = Input::EMPTY;
        let bytes = bytes.iter();
        bytes
            .filter_map(|byte| input.push(*byte, framing))
            .collect()
    }

    fn stuffed(content: &[u8]) -> Vec<u8> {
        let mut frame = vec![0; cobs::max_encoding_length(content.len()) + 1];
        let length = cobs::encode(content, &mut frame);
        frame.truncate(length + 1);
        frame
    }

    #[test]
    fn lines() {
        let sentence = |payload: &str| {
            let sum = sentence::checksum(payload.as_bytes());
            format!("${payload}*{sum:02X}\r\n")
        };
        let right = sentence("PFOXB,256,0,7,-60") + &sentence("PFOXQ") + &sentence("GPHDT,1,T");
        let wrong = sentence("PFOXB,256,0,7,-60").replace("60", "61") + "%045/7\r\n";
        let lines = right + &wrong;
        assert_eq!(
            read(Framing::Lines, lines.as_bytes()),
            [
                Ok(Message::Packet(PACKET)),
                Ok(Message::Query),
                Ok(Message::Other),
                Err(Rejected::Checksum),
                Err(Rejected::Unparsable),
            ]
        );
    }

    #[test]
    fn a_frame_after_lost_bytes_is_read() {
        let frame = stuffed(&PACKET.to_frame());
        let lost: [(&[u8], &[Rejected]); 4] = [
            (&[], &[]),
            (&[0, 0], &[]),
            (&[5, 1, 0], &[Rejected::Unparsable]),
            (&[255; 40], &[]),
        ];
        for (before, reasons) in lost {
            let mut bytes = before.to_vec();
            if before.first() == Some(&255) {
                bytes.push(0);
            }
            bytes.extend(&frame);
            let got = read(Framing::Frames, &bytes);
            assert_eq!(got.last(), Some(&Ok(Message::Packet(PACKET))), "{before:?}");
            if before.first() == Some(&255) {
                assert_eq!(got[0], Err(Rejected::Overlong));
                assert_eq!(got.len(), 2);
            } else {
                assert_eq!(got.len(), reasons.len() + 1);
            }
        }
        assert_eq!(read(Framing::Frames, &stuffed(b"Q")), [Ok(Message::Query)]);
    }

    #[test]
    fn a_survey_reaches_as_far_as_a_map_may() {
        let spot = Spot {
            tag: 7,
            place: [1e6, -1e6],
            floor: 255,
        };
        let farthest = b"7,1000000,-1000000,255";
        assert_eq!(Spot::from_fields(farthest), Ok(spot));
        let further = b"7,0,-1000000.001,0";
        assert_eq!(Spot::from_fields(further), Err(Rejected::OutOfRange));
    }

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

        #[test]
        fn any_bytes_cost_at_most_their_own_frame(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            let mut stream = bytes;
            stream.push(0);
            stream.extend(stuffed(&PACKET.to_frame()));
            let read = read(Framing::Frames, &stream);
            prop_assert_eq!(read.last(), Some(&Ok(Message::Packet(PACKET))));
        }
    }
}
