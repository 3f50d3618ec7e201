//! Bytes to packets and requests, in one of two forms.

use cobs::{DecodeResult, DecoderState};
use heapless::Vec;

use super::{Framing, Packet, Rejected};
use crate::gateway::formats::Nmea;
use crate::gateway::line::LineReader;
use crate::gateway::sentence;

/// What a message says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Message {
    Packet(Packet),
    /// The host asks for every tag's position and for the status.
    Query,
    /// The host begins anew.
    Restart,
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
    match sentence::checked(line).ok_or(Rejected::Checksum)? {
        b"PFOXQ" => Ok(Message::Query),
        b"PFOXR" => Ok(Message::Restart),
        [b'P', b'F', b'O', b'X', b'B', b',', fields @ ..] => {
            Packet::from_fields(fields).map(Message::Packet)
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
            } else {
                assert_eq!(got.len(), reasons.len() + 1);
            }
        }
        assert_eq!(read(Framing::Frames, &stuffed(b"Q")), [Ok(Message::Query)]);
    }

    proptest! {
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
