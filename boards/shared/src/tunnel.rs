//! The gateway of a tunnel as an application: a computer at port 0, radios at the others.

use core::fmt::Write;

use foxhunt::fingerprint::tracker::Site;
use foxhunt::gateway::beacon::{BeaconGateway, Config, Event, MapPiece, Packet};
use foxhunt::snapshot::Persist;
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

/// A tunnel's gateway, of any size.
pub trait Gateway: Persist {
    /// Takes the next byte.
    fn push(&mut self, byte: u8, config: &Config<Site<'_>>) -> Option<Event>;

    /// What to send for the last message.
    fn report(&self) -> &str;

    /// Takes a piece of a new map, and says whether the map is whole.
    fn take_map(&mut self, piece: &MapPiece, room: &mut [u8]) -> bool;
}

impl<const T: usize, const N: usize, const P: usize, const B: usize, const D: usize> Gateway
    for BeaconGateway<T, N, P, B, D>
{
    fn push(&mut self, byte: u8, config: &Config<Site<'_>>) -> Option<Event> {
        self.push(byte, config)
    }

    fn report(&self) -> &str {
        self.report()
    }

    fn take_map(&mut self, piece: &MapPiece, room: &mut [u8]) -> bool {
        matches!(self.take_map(piece, room), Ok(Some(_)))
    }
}

/// What is known, and the time that goes on with it.
#[derive(Debug)]
pub struct State<G> {
    gateway: G,
    /// Milliseconds in which the board was on; they may overflow.
    time_ms: u32,
}

impl<G> State<G> {
    /// A gateway that has just begun. All bits are zero, if its are.
    pub const fn new(gateway: G) -> Self {
        Self {
            gateway,
            time_ms: 0,
        }
    }
}

foxhunt::persist!(impl[G: Persist] State<G> as "Tunnel"() { gateway, time_ms });

/// A tunnel's gateway and its configuration.
///
/// The gateway has one line. So that messages of several never mix, each is handed on when it is whole.
#[derive(Debug)]
pub struct Tunnel<'a, G, const PORTS: usize> {
    state: &'a mut State<G>,
    config: Config<Site<'a>>,
    /// Milliseconds since the board was started; they may overflow.
    clock: fn() -> u32,
    /// What it said last.
    seen_ms: u32,
    line: Vec<u8, LINE>,
    frames: [Frames; PORTS],
    new_map: &'a mut [u8],
    /// Bytes of a new map that is whole.
    whole: Option<usize>,
}

impl<'a, G: Gateway, const PORTS: usize> Tunnel<'a, G, PORTS> {
    /// The gateway, by this configuration from now on, with room for a new map.
    pub fn new(
        state: &'a mut State<G>,
        config: Config<Site<'a>>,
        clock: fn() -> u32,
        new_map: &'a mut [u8],
    ) -> Self {
        Self {
            state,
            config,
            clock,
            seen_ms: clock(),
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
        let now_ms = (self.clock)();
        let passed_ms = now_ms.wrapping_sub(self.seen_ms);
        self.seen_ms = now_ms;
        self.state.time_ms = self.state.time_ms.wrapping_add(passed_ms);
        let line = sentence(&Packet {
            time_ms: self.state.time_ms,
            ..packet
        });
        self.message(line.as_bytes())
    }

    fn message(&mut self, bytes: &[u8]) -> bool {
        let gateway = &mut self.state.gateway;
        let mut has_ended = false;
        for byte in bytes {
            let Some(event) = gateway.push(*byte, &self.config) else {
                continue;
            };
            has_ended = true;
            log(&event);
            if let Event::MapPiece(piece) = event
                && gateway.take_map(&piece, self.new_map)
            {
                self.whole = usize::try_from(piece.total).ok();
            }
        }
        has_ended
    }
}

impl<G: Gateway, const PORTS: usize> Application for Tunnel<'_, G, PORTS> {
    fn push(&mut self, port: usize, byte: u8) -> bool {
        match port {
            COMPUTER => self.computer(byte),
            _ => self.radio(port, byte),
        }
    }

    fn report(&self) -> &str {
        self.state.gateway.report()
    }
}

impl<G: Gateway, const PORTS: usize> Stateful for Tunnel<'_, G, PORTS> {
    type State = State<G>;

    fn state(&mut self) -> &mut Self::State {
        self.state
    }

    /// Nobody knows how long the board was off; tags may have gone anywhere in the time since the snapshot.
    fn resume(&mut self, seconds: u32) {
        let passed_ms = seconds.saturating_mul(1_000);
        self.state.time_ms = self.state.time_ms.wrapping_add(passed_ms);
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
