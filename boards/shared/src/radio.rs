//! Packets of tags, from the air and from board to board.
//!
//! A board whose radio hears a tag sends a [`Frame`]. Boards stand in a row along the tunnel: each hands on what the next one
//! out sends, and puts its own frames between. The last one is the gateway, which takes the time at which a frame arrives: the
//! boards need no common clock, and a frame is under way for milliseconds.

use embassy_futures::select::{Either, select};
use embedded_io_async::{Read, Write};
use foxhunt::gateway::beacon::Packet;
use heapless::Vec;

use crate::{Board, Lines};

/// Bytes of a stuffed frame with the zero that ends it.
const FRAME: usize = Packet::FRAME_BYTES + 2;

/// A packet on a line between boards: stuffed, and ended by a zero.
pub type Frame = Vec<u8, FRAME>;

/// The frame of a packet.
pub fn frame(packet: Packet) -> Frame {
    let mut bytes = [0; FRAME];
    let content = packet.to_frame();
    // The last byte stays zero.
    let length = cobs::try_encode(&content, &mut bytes).unwrap_or(0);
    bytes.iter().take(length + 1).copied().collect()
}

/// The packet of a frame that came whole.
pub fn packet(frame: &Frame) -> Option<Packet> {
    let (_zero, stuffed) = frame.split_last()?;
    let mut content = [0; FRAME];
    let report = cobs::decode(stuffed, &mut content).ok()?;
    Packet::from_frame(content.get(..report.frame_size())?).ok()
}

/// Collects the bytes of one frame.
#[derive(Debug, Default)]
pub struct Frames {
    frame: Frame,
    is_overlong: bool,
}

impl Frames {
    /// Nothing has come.
    pub const EMPTY: Self = Self {
        frame: Frame::new(),
        is_overlong: false,
    };

    /// The frame that ends with this byte, if one does. What is no packet comes out as nothing.
    pub fn push(&mut self, byte: u8) -> Option<Frame> {
        self.is_overlong |= self.frame.push(byte).is_err();
        if byte != 0 {
            return None;
        }
        let frame = core::mem::take(&mut self.frame);
        let is_whole = !core::mem::take(&mut self.is_overlong);
        (is_whole && packet(&frame).is_some()).then_some(frame)
    }
}

/// Hands on frames of lines, whole ones only, for ever.
pub async fn relay<R: Read, W: Write, const PORTS: usize>(
    readers: [R; PORTS],
    mut inwards: W,
    mut board: impl Board,
) -> ! {
    let mut lines = Lines::new(readers);
    let mut frames = [const { Frames::EMPTY }; PORTS];
    loop {
        if let Either::Second(()) = select(lines.wait(), board.tick()).await {
            #[cfg(target_os = "none")]
            defmt::debug!("bytes were lost or damaged {} times", lines.failures());
        }
        board.feed();
        for (port, frames) in frames.iter_mut().enumerate() {
            while let Some(byte) = lines.take(port) {
                if let Some(frame) = frames.push(byte) {
                    // What the next board does not get is lost, as a packet is that no radio hears.
                    let _ = inwards.write_all(&frame).await;
                    board.feed();
                }
            }
        }
    }
}

/// The number of the tag that has sent a frame of IEEE 802.15.4: its short address, or the last 32 bits of its long one.
/// `None` for a frame that says no sender.
pub fn tag(frame: &[u8]) -> Option<u32> {
    const DATA: u16 = 1;
    let (control, rest) = frame.split_first_chunk()?;
    let control = u16::from_le_bytes(*control);
    let (_sequence, rest) = rest.split_first()?;
    let modes = [control >> 10 & 3, control >> 14 & 3];
    let is_compressed = control >> 6 & 1 == 1;
    // From the third version on, fields may be missing.
    if control & 7 != DATA || control >> 12 & 3 > 1 {
        return None;
    }
    let [to, from] = modes.map(address_bytes);
    let (to, from) = (to?, from?);
    if is_compressed && (to == 0 || from == 0) {
        return None;
    }
    // Each address comes after that of its network, of which the sender's is left out if it is the same.
    let network = |is_there: bool| if is_there { 2 } else { 0 };
    let before = network(to > 0) + to + network(!is_compressed);
    let address = rest.get(before..)?;
    match from {
        2 => address
            .first_chunk()
            .map(|bytes| u16::from_le_bytes(*bytes).into()),
        8 => address
            .get(..8)?
            .first_chunk()
            .map(|bytes| u32::from_le_bytes(*bytes)),
        _ => None,
    }
}

/// Bytes of an address by its mode; of that which is reserved, none are known.
fn address_bytes(mode: u16) -> Option<usize> {
    match mode {
        0 => Some(0),
        2 => Some(2),
        3 => Some(8),
        _ => None,
    }
}

/// The strength in dBm of a packet that an nRF52's radio rates like this, by the makers' formula (erratum 236 of the nRF52840).
pub fn dbm(rating: u8) -> i8 {
    const OFFSET: i16 = -92;
    i8::try_from(i16::from(rating) + OFFSET).unwrap_or(i8::MAX)
}

#[cfg(test)]
mod tests;
