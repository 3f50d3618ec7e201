//! The gateway of a tunnel: what its radios hear in, where the tags are out.
//!
//! [`BeaconGateway`] takes one byte after the other from the line that the radios share, as
//! [`Vehicle`](super::Vehicle) does, and tells what each message led to. It holds no clock: every time is one that a
//! packet states.
//!
//! # Messages in
//!
//! As sentences, ended by CR, LF or both, or as binary frames: see [`Settings::with_framing`].
//!
//! | sentence | frame | means |
//! |---|---|---|
//! | `$PFOXB,time,radio,tag,rssi*hh` | [`Packet::to_frame`] | a radio has heard a tag: milliseconds, the radio's identifier in the map, the tag's number, dBm |
//! | `$PFOXQ*50` | `Q` | a query: the fix of every tag, after an update by the packets that wait, and the status |
//! | `$PFOXR*53` | `R` | a restart: all tags are forgotten |
//!
//! A frame holds, little-endian: the byte 0xB1, the time (4 bytes), the radio (2), the tag (4), the RSSI (1), and the
//! CRC-32 of these (4); it is stuffed (COBS), so that a zero byte ends it and stands nowhere else.
//!
//! # Sentences out
//!
//! **`$PFOXT,time,tag,state,x,y,vx,vy,major,minor,orientation,offset,ess*hh`**, the fix of a tag, after every update:
//! the mean time of its packets in milliseconds; `TRACKING`, `UNCERTAIN`, `LOST` or `RECOVERED`
//! ([`State`](crate::fingerprint::tracker::State)); place and velocity in metres and metres a second; standard deviations in
//! metres along the longer and the shorter axis of its uncertainty, and the direction of the longer one in degrees
//! counter-clockwise from x; by how many dB the tag is louder than the one of the survey; the effective sample size.
//!
//! **`$PFOXL,time,radio,SILENT*hh`**, a radio of the map has heard no tag for
//! [`Settings::with_silence_ms`] while others have; **`...,HEARD*hh`** when it hears one again.
//!
//! **`$PFOXS,messages,packets,tags,silent,ignored,evicted,...*hh`**, the status: [`Counters`], how many tags are tracked and
//! how many radios are silent, and then, in the order of [`Rejected::ALL`], the counts of every reason for a rejection.

mod counters;
mod input;
mod packet;
mod radios;
mod report;
mod settings;

pub use counters::{Counters, Rejected};
pub use packet::Packet;
pub use settings::{Framing, Settings, SettingsError};

use crate::fingerprint::tracker::{Fix, PushError, Site, Tag, Tracker, Trackers, Workspace};
use crate::random::{SeedableRng, Xoshiro128PlusPlus};
use input::{Input, Message};
use radios::Radios;
use report::Report;

/// The most tags of one gateway: the answer to a query has room for so many.
pub const MAX_TAGS: usize = 16;

/// What a message led to.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Event {
    /// A packet was taken, and waits for others.
    Taken(Tag),
    /// A packet led to an update: there the tag is.
    Fix(Tag, Fix),
    /// The message was not used.
    Rejected(Rejected),
    /// The host has asked, and [`BeaconGateway::report`] answers.
    Queried,
    /// All tags were forgotten.
    Restarted,
}

/// What radios hear in, places of up to `T` tags out, with `N` particles for each, on a map of up to `P` points and `B`
/// beacons. See the [module](self) for the messages.
///
/// Takes T times a [`Tracker`], a [`Workspace`], and 3 kB.
#[derive(Debug)]
pub struct BeaconGateway<'a, const T: usize, const N: usize, const P: usize, const B: usize = 16> {
    site: Site<'a>,
    input: Input,
    counters: Counters,
    trackers: Trackers<T, N, B>,
    workspace: Workspace<N, P>,
    radios: Radios<B>,
    seed: u64,
    generator: Option<Xoshiro128PlusPlus>,
    report: Report,
}

impl<'a, const T: usize, const N: usize, const P: usize, const B: usize>
    BeaconGateway<'a, T, N, P, B>
{
    /// Knows of no tag yet. Fit for a `static`.
    pub const fn new(site: Site<'a>, settings: Settings) -> Self {
        const { assert!(T <= MAX_TAGS, "at most 16 tags") };
        Self {
            site,
            input: Input::new(settings.framing),
            counters: Counters::new(),
            trackers: Trackers::new(),
            workspace: Workspace::new(),
            radios: Radios::new(settings.silence_ms),
            seed: settings.seed,
            generator: None,
            report: Report::new(),
        }
    }

    /// Takes the next byte of the line, and says what a message led to if it ends with that byte.
    ///
    /// Never waits. The byte that ends a packet runs at most one update, that of a query one for every tag.
    pub fn push(&mut self, byte: u8) -> Option<Event> {
        let message = self.input.push(byte)?;
        self.report.clear();
        self.counters.messages = self.counters.messages.saturating_add(1);
        let result = message.and_then(|message| match message {
            Message::Packet(packet) => self.packet(&packet).map(Some),
            Message::Query => {
                self.query();
                Ok(Some(Event::Queried))
            }
            Message::Restart => {
                self.restart();
                Ok(Some(Event::Restarted))
            }
            Message::Other => {
                self.counters.ignored = self.counters.ignored.saturating_add(1);
                Ok(None)
            }
        });
        result.unwrap_or_else(|reason| {
            self.counters.reject(reason);
            Some(Event::Rejected(reason))
        })
    }

    /// What to send for the last message: sentences with their line ends, or nothing. Holds until the next message ends.
    pub fn report(&self) -> &str {
        self.report.as_str()
    }

    /// What became of the messages so far.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// The tags and their trackers.
    pub fn tags(&self) -> impl Iterator<Item = (Tag, &Tracker<N, B>)> {
        self.trackers.iter()
    }

    /// Forgets all tags, and which radios are silent; keeps the counts.
    pub fn restart(&mut self) {
        self.trackers.clear();
        self.radios.clear();
        self.generator = None;
        self.report.clear();
    }

    #[inline(never)]
    fn packet(&mut self, packet: &Packet) -> Result<Event, Rejected> {
        let map = self.site.map();
        let beacon = map.beacon_index(packet.radio.into());
        let beacon = beacon.and_then(|beacon| u8::try_from(beacon).ok());
        let beacon = beacon.ok_or(Rejected::UnknownRadio)?;
        let rssi = f32::from(packet.rssi_dbm);
        // Before a tag is evicted for it.
        if !self.site.settings().accepts(rssi) {
            return Err(Rejected::OutOfRange);
        }
        let seed = self.seed;
        let rng = self
            .generator
            .get_or_insert_with(|| Xoshiro128PlusPlus::seed_from_u64(seed));
        let tag = Tag(packet.tag);
        let (tracker, evicted) = self.trackers.of(tag, packet.time_ms);
        if evicted.is_some() {
            self.counters.evicted = self.counters.evicted.saturating_add(1);
        }
        let workspace = &mut self.workspace;
        let led = tracker
            .push(packet.time_ms, beacon, rssi, &self.site, workspace, rng)
            .map_err(|error| match error {
                PushError::TimeBackwards => Rejected::TimeBackwards,
                PushError::Beacon | PushError::Points => Rejected::UnknownRadio,
                PushError::Strength => Rejected::OutOfRange,
            })?;
        self.counters.packets = self.counters.packets.saturating_add(1);
        let identifier = |radio: usize| map.beacon(radio).map_or(0, |beacon| beacon.identifier);
        let beacons = map.beacons();
        self.radios.hear(
            packet.time_ms,
            beacon.into(),
            beacons,
            |radio, is_silent| {
                self.report
                    .radio(packet.time_ms, identifier(radio), is_silent);
            },
        );
        Ok(match led {
            Some(fix) => {
                self.report.tag(tag, &fix);
                Event::Fix(tag, fix)
            }
            None => Event::Taken(tag),
        })
    }

    #[inline(never)]
    fn query(&mut self) {
        let mut tags = 0;
        for (tag, tracker) in self.trackers.iter_mut() {
            tags += 1;
            if let Some(rng) = &mut self.generator {
                tracker.flush(&self.site, &mut self.workspace, rng);
            }
            if let Some(fix) = tracker.fix() {
                self.report.tag(tag, &fix);
            }
        }
        self.report
            .status(&self.counters, tags, self.radios.silent());
    }
}

#[cfg(test)]
mod tests;
