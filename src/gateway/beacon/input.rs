//! Bytes to packets and requests, in one of two forms.

use cobs::{DecodeResult, DecoderState};
use heapless::Vec;

use super::{Framing, Packet, Rejected};
use crate::gateway::formats::Nmea;
use crate::gateway::line::LineReader;
use crate::gateway::sentence;

/// What the line has said.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Message {
    Packet(Packet),
    /// The host asks for every tag's position and for the status.
    Query,
    /// The host begins anew.
    Restart,
    /// A correct sentence that is of no use here.
    Other,
}

/// Collects the bytes of one message.
#[expect(
    clippy::large_enum_variant,
    reason = "it never moves, and there is no heap to box into"
)]
#[derive(Debug)]
pub(super) enum Input {
    Lines(LineReader<(Nmea,)>),
    Frames(FrameReader),
}

impl Input {
    pub const fn new(framing: Framing) -> Self {
        match framing {
            Framing::Lines => Self::Lines(LineReader::EMPTY),
            Framing::Frames => Self::Frames(FrameReader::new()),
        }
    }

    /// Takes a byte; says what has ended with it, if anything.
    pub fn push(&mut self, byte: u8) -> Option<Result<Message, Rejected>> {
        match self {
            Self::Lines(reader) => Some(match reader.push(byte)? {
                Ok(()) => from_line(reader.bytes()),
                Err(crate::gateway::Rejected::Overlong) => Err(Rejected::Overlong),
                Err(_) => Err(Rejected::Unparsable),
            }),
            Self::Frames(reader) => reader.push(byte),
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
    /// The frame cannot be one; what is left of it is skipped.
    lost: Option<Rejected>,
}

impl FrameReader {
    const fn new() -> Self {
        Self {
            state: DecoderState::Idle,
            frame: Vec::new(),
            lost: None,
        }
    }

    fn push(&mut self, byte: u8) -> Option<Result<Message, Rejected>> {
        if let Some(reason) = self.lost {
            if byte != 0 {
                return None;
            }
            self.lost = None;
            return Some(Err(reason));
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
                    self.lost = Some(Rejected::Overlong);
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
        let mut input = Input::new(framing);
        bytes.iter().filter_map(|byte| input.push(*byte)).collect()
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
    fn frames_after_whatever_was_lost() {
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
