//! The gateway of a tunnel as an application: a computer at port 0, radios at the others.

use core::fmt::Write;

use foxhunt::gateway::beacon::{BeaconGateway, Config, Event, Packet};
use heapless::{String, Vec};

use crate::{
    Application,
    kept::Stateful,
    radio::{self, Frames},
};

/// The port of the computer, which sends sentences. The others are those of radios, which send frames.
const COMPUTER: usize = 0;

/// No sentence is longer.
const LINE: usize = 128;

/// A tunnel's gateway and its configuration.
///
/// The gateway has one line. So that messages of several never mix, each is handed on when it is whole.
#[derive(Debug)]
pub struct Tunnel<
    'a,
    const T: usize,
    const N: usize,
    const P: usize,
    const B: usize,
    const D: usize,
    const PORTS: usize,
> {
    gateway: &'a mut BeaconGateway<T, N, P, B, D>,
    config: Config<'a>,
    /// Milliseconds since the board was started; they may overflow.
    clock: fn() -> u32,
    line: Vec<u8, LINE>,
    frames: [Frames; PORTS],
    new_map: &'a mut [u8],
    /// Bytes of a new map that is whole.
    whole: Option<usize>,
}

impl<
    'a,
    const T: usize,
    const N: usize,
    const P: usize,
    const B: usize,
    const D: usize,
    const PORTS: usize,
> Tunnel<'a, T, N, P, B, D, PORTS>
{
    /// The gateway, by this configuration from now on, with room for a new map.
    pub fn new(
        gateway: &'a mut BeaconGateway<T, N, P, B, D>,
        config: Config<'a>,
        clock: fn() -> u32,
        new_map: &'a mut [u8],
    ) -> Self {
        Self {
            gateway,
            config,
            clock,
            line: Vec::new(),
            frames: [const { Frames::EMPTY }; PORTS],
            new_map,
            whole: None,
        }
    }

    /// A new map that has come whole.
    pub fn new_map(&self) -> Option<&[u8]> {
        self.new_map.get(..self.whole?)
    }

    /// Hands on the computer's bytes when its line ends, or fits nowhere.
    fn computer(&mut self, byte: u8) -> bool {
        // There is room: a full line was handed on.
        let _ = self.line.push(byte);
        if byte != b'\n' && !self.line.is_full() {
            return false;
        }
        let line = core::mem::take(&mut self.line);
        self.message(&line)
    }

    /// Hands on the packet of a radio, heard now.
    fn radio(&mut self, port: usize, byte: u8) -> bool {
        let frames = self.frames.get_mut(port);
        let packet = frames
            .and_then(|frames| frames.push(byte))
            .and_then(|frame| radio::packet(&frame));
        let Some(packet) = packet else { return false };
        let time_ms = (self.clock)();
        let line = sentence(&Packet { time_ms, ..packet });
        self.message(line.as_bytes())
    }

    fn message(&mut self, bytes: &[u8]) -> bool {
        let mut has_ended = false;
        for byte in bytes {
            let Some(event) = self.gateway.push(*byte, &self.config) else {
                continue;
            };
            has_ended = true;
            log(&event);
            if let Event::MapPiece(piece) = event
                && let Ok(Some(_)) = self.gateway.take_map(&piece, self.new_map)
            {
                self.whole = usize::try_from(piece.total).ok();
            }
        }
        has_ended
    }
}

impl<
    const T: usize,
    const N: usize,
    const P: usize,
    const B: usize,
    const D: usize,
    const PORTS: usize,
> Application for Tunnel<'_, T, N, P, B, D, PORTS>
{
    fn push(&mut self, port: usize, byte: u8) -> bool {
        match port {
            COMPUTER => self.computer(byte),
            _ => self.radio(port, byte),
        }
    }

    fn report(&self) -> &str {
        self.gateway.report()
    }
}

impl<
    const T: usize,
    const N: usize,
    const P: usize,
    const B: usize,
    const D: usize,
    const PORTS: usize,
> Stateful for Tunnel<'_, T, N, P, B, D, PORTS>
{
    type State = BeaconGateway<T, N, P, B, D>;

    fn state(&mut self) -> &mut Self::State {
        self.gateway
    }
}

/// The sentence of a packet.
fn sentence(packet: &Packet) -> String<LINE> {
    let &Packet {
        time_ms,
        radio,
        tag,
        rssi_dbm,
    } = packet;
    let mut line = String::new();
    // There is room for the longest numbers.
    let _ = write!(line, "$PFOXB,{time_ms},{radio},{tag},{rssi_dbm}");
    let sum = line.bytes().skip(1).fold(0, |sum, byte| sum ^ byte);
    let _ = write!(line, "*{sum:02X}\r\n");
    line
}

/// A message every time that a packet comes would be too many.
fn log(event: &Event) {
    #[cfg(target_os = "none")]
    match event {
        Event::Fix { .. } | Event::Taken { .. } => defmt::debug!("{}", event),
        event => defmt::info!("{}", event),
    }
    #[cfg(not(target_os = "none"))]
    let _ = event;
}

#[cfg(test)]
mod tests;
