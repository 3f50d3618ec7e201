//! The gateway of a tunnel: reports of its radios in, the places of the tags out.
//!
//! [`BeaconGateway`] takes one byte after the other from the common line of the radios, as
//! [`Vehicle`](super::Vehicle) does, and returns what each message led to. It holds no clock: every time is one that a
//! packet states.
//!
//! # Messages in
//!
//! As sentences, ended by CR, LF or both, or as binary frames: see [`Config::framing`].
//!
//! | sentence | frame | means |
//! |---|---|---|
//! | `$PFOXB,time,radio,tag,rssi*hh` | [`Packet::to_frame`] | a radio has heard a tag: milliseconds, the radio's identifier in the map, the tag's number, dBm |
//! | `$PFOXQ*50` | `Q` | a query: the fix of every tag, after an update by the packets that wait, and the status |
//! | `$PFOXR*53` | `R` | a restart: all tags are forgotten |
//! | `$PFOXV,tag,x,y,floor*hh` | | a survey: somebody stands with this tag at a place, in metres, on a floor |
//! | `$PFOXV*57` | | the survey is over |
//! | `$PFOXM,offset,total,bytes*hh` | | a piece of a new map: where it begins, the length of the map, up to 32 bytes in hexadecimal; see [`BeaconGateway::take_map`] |
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
//! counter-clockwise from x; by how many dB the tag is louder than the one of the survey; the effective sample size. In a
//! [`Building`](crate::fingerprint::tracker::Building) two more fields: the likeliest floor, counted from 0, and its probability.
//!
//! **`$PFOXL,time,radio,SILENT*hh`**, a radio of the map has heard no tag for [`Config::silence_ms`] while others have;
//! **`...,HEARD*hh`** when it hears one again. **`...,MOVED*hh`**: its levels are not those of the map, at several places, by
//! what it hears of all tags: it was moved, turned or damaged, and counts less until they are again (**`...,FITS*hh`**).
//! **`...,RARE*hh`**: it hears tags that are next to it far less often than other radios do, until it no longer does
//! (**`...,USUAL*hh`**).
//!
//! **`$PFOXV,x,y,floor,radio,rssi*hh`**, a reading of a survey, for every packet of the tag that is surveyed, whether its
//! radio is in the map or not: a log of them is a survey that `foxhunt survey` reads.
//!
//! **`$PFOXM,received,total,MORE*hh`**, the answer to a piece of a new map: the next one begins at `received`;
//! **`...,READY*hh`** when the whole map was checked, **`...,REFUSED*hh`** when it cannot be used.
//!
//! **`$PFOXS,messages,packets,ignored,queries,restarts,...,tags,silent,evicted*hh`**, the status: all messages, and how
//! many of them were packets that a tracker took, sentences of other kinds, queries with commands of surveys and maps, and
//! restarts; in the place of `...`, in the order of [`Rejected::ALL`], how many were rejected for each reason, so that the second to the twelfth number
//! add up to the first; how many tags are tracked, how many radios are silent, and how many tags lost their tracker to
//! another one.

mod config;
mod health;
mod input;
mod new_map;
mod outcome;
mod radios;
mod report;
mod survey;

pub use config::{Config, Framing};
pub use input::Packet;
pub use new_map::{MapPiece, NewMapError};
pub use outcome::{Counters, Event, Rejected};

use crate::fingerprint::tracker::{
    Fix, Ground, OnFloor, Packed, Stored, Tracker, Trackers, Workspace,
};
use crate::fingerprint::{RadioMap, Reading, ReadingError};
use crate::persist;
use crate::random::{SeedableRng, Xoshiro128PlusPlus};
use health::Health;
use input::{Input, Message};
use new_map::{Reception, Room};
use radios::Radios;
pub use report::MAX_TAGS;
use report::Report;
pub use survey::Spot;
use survey::Survey;

/// The state of a gateway that tracks up to `T` tags, with `N` particles for each, on a map of up to `P` points and `B`
/// beacons. See the [module](self) for the messages.
///
/// Takes T times a [`Tracker`], a [`Workspace`], and 10 kB. `D` is 1 where the map has one row or one column, 2 in the
/// plane.
///
/// ```
/// use foxhunt::fingerprint::RadioMap;
/// use foxhunt::fingerprint::tracker::{self, Site};
/// use foxhunt::gateway::beacon::{BeaconGateway, Config, Event};
///
/// static TUNNEL: &[u8] =
///     include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/tunnel.map"));
/// let site = Site::new(RadioMap::new(TUNNEL)?, tracker::Config::TUNNEL)?;
/// let config = Config { silence_ms: 10_000, ..Config::new(site) };
/// config.check()?;
/// let mut gateway = BeaconGateway::<64, 300, 81, 4, 1>::EMPTY;
/// let events = b"$PFOXQ*50\r\n".iter().filter_map(|byte| gateway.push(*byte, &config));
/// assert_eq!(events.last(), Some(Event::Queried));
/// assert!(gateway.report().starts_with("$PFOXS,1,0,0,1,0,"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct BeaconGateway<
    const T: usize,
    const N: usize,
    const P: usize,
    const B: usize = 16,
    const D: usize = 2,
    S: Stored = Packed<D>,
> {
    input: Input,
    counters: Counters,
    trackers: Trackers<T, N, B, D, S>,
    workspace: Workspace<N, P, S::Floor>,
    radios: Radios<B>,
    health: Health<B>,
    survey: Survey,
    reception: Reception,
    generator: Option<Xoshiro128PlusPlus>,
    report: Report,
}

impl<const T: usize, const N: usize, const P: usize, const B: usize, const D: usize, S: Stored>
    BeaconGateway<T, N, P, B, D, S>
{
    /// No tags yet, in bits that are all zero.
    pub const EMPTY: Self = {
        assert!(T <= MAX_TAGS, "at most 64 tags");
        Self {
            input: Input::EMPTY,
            counters: Counters::EMPTY,
            trackers: Trackers::EMPTY,
            workspace: Workspace::EMPTY,
            radios: Radios::EMPTY,
            health: Health::EMPTY,
            survey: Survey::EMPTY,
            reception: Reception::EMPTY,
            generator: None,
            report: Report::new(),
        }
    };

    /// Takes the next byte of the line, and returns what the message led to that ends with it, if one does.
    ///
    /// Never waits. The byte that ends a packet runs at most one update, that of a query one for every tag.
    pub fn push<G>(&mut self, byte: u8, config: &Config<G>) -> Option<Event>
    where
        G: Ground<Floor = S::Floor>,
    {
        let message = self.input.push(byte, config.framing)?;
        self.report.clear();
        let event = match message {
            Ok(Message::Packet(packet)) => {
                let result = self.packet(&packet, config);
                result.unwrap_or_else(Event::Rejected)
            }
            Ok(Message::Query) => Event::Queried,
            Ok(Message::Restart) => {
                self.restart();
                Event::Restarted
            }
            Ok(Message::Survey(spot)) => {
                self.survey.turn_to(spot);
                Event::Survey(spot)
            }
            Ok(Message::MapPiece(piece)) => Event::MapPiece(piece),
            Ok(Message::Other) => Event::Other,
            Err(reason) => Event::Rejected(reason),
        };
        self.counters.count(&event);
        if event == Event::Queried {
            self.answer(config);
        }
        Some(event)
    }

    /// What to send for the last message: sentences with their line ends, or nothing. Holds until the next message ends.
    pub fn report(&self) -> &str {
        self.report.as_str()
    }

    /// The counts of the messages so far.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// The tags and their trackers.
    pub fn tags(&self) -> impl Iterator<Item = (u32, &Tracker<N, B, D, S>)> {
        self.trackers.iter()
    }

    /// Forgets all tags, and which radios are silent; keeps the counts.
    pub fn restart(&mut self) {
        self.trackers.clear();
        self.radios = Radios::EMPTY;
        self.health = Health::EMPTY;
        self.generator = None;
        self.report.clear();
    }

    /// Takes a piece of another map into a buffer that holds the map until it is whole, and returns the map then: one that
    /// this gateway has room for and can track on. [`BeaconGateway::report`] answers to the sender.
    ///
    /// The gateway goes on with its present map. To go on with the new one, [`BeaconGateway::restart`] it and lend it a
    /// configuration with the new map from then on; the buffer has to last as long.
    ///
    /// ```
    /// # use foxhunt::fingerprint::{RadioMap, tracker::{self, Site}};
    /// use foxhunt::gateway::beacon::{BeaconGateway, Config, Event};
    ///
    /// # static TUNNEL: &[u8] =
    /// #     include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/tunnel.map"));
    /// # let config = Config::new(Site::new(RadioMap::new(TUNNEL)?, tracker::Config::TUNNEL)?);
    /// # let line = TUNNEL.chunks(32).enumerate().flat_map(|(number, bytes)| {
    /// #     let bytes: String = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
    /// #     let payload = format!("PFOXM,{},{},{bytes}", 32 * number, TUNNEL.len());
    /// #     let sum = payload.bytes().fold(0, |sum, byte| sum ^ byte);
    /// #     format!("${payload}*{sum:02X}\r\n").into_bytes()
    /// # });
    /// let mut gateway = BeaconGateway::<8, 300, 81, 4, 1>::EMPTY;
    /// let mut spare = [0; 1024];
    /// let mut has_come = false;
    /// for byte in line {
    ///     if let Some(Event::MapPiece(piece)) = gateway.push(byte, &config) {
    ///         has_come = gateway.take_map(&piece, &mut spare)?.is_some();
    ///     }
    /// }
    /// assert!(has_come && gateway.report().contains(",READY*"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// See [`NewMapError`].
    pub fn take_map<'b>(
        &mut self,
        piece: &MapPiece,
        buffer: &'b mut [u8],
    ) -> Result<Option<RadioMap<'b>>, NewMapError> {
        let room = Room {
            points: P,
            beacons: B,
            axes: D,
        };
        let taken = self.reception.take(piece, buffer, &room);
        let (received, word) = match &taken {
            Ok(Some(_)) => (piece.total, "READY"),
            Ok(None) | Err(NewMapError::Order) => (self.reception.received(), "MORE"),
            Err(_) => (0, "REFUSED"),
        };
        self.report.clear();
        self.report.map(received, piece.total, word);
        taken
    }

    #[inline(never)]
    fn packet<G>(&mut self, packet: &Packet, config: &Config<G>) -> Result<Event, Rejected>
    where
        G: Ground<Floor = S::Floor>,
    {
        let &Packet { time_ms, tag, .. } = packet;
        if let Some(spot) = self.survey.of(tag) {
            self.report.survey(spot, packet);
        }
        let site = &config.site;
        let beacon = site.map(0).beacon_index(packet.radio.into());
        let beacon = beacon.and_then(|beacon| u8::try_from(beacon).ok());
        let reading = Reading {
            beacon: beacon.ok_or(Rejected::UnknownRadio)?,
            rssi_dbm: packet.rssi_dbm.into(),
        };
        // Before a tag is evicted for it.
        if !site.config().accepts(reading.rssi_dbm) {
            return Err(Rejected::OutOfRange);
        }
        let rng = self
            .generator
            .get_or_insert_with(|| Xoshiro128PlusPlus::seed_from_u64(config.seed));
        let trackers = self.trackers.of(tag, time_ms);
        let (tracker, evicted) = trackers.ok_or(Rejected::NoRoom)?;
        if evicted.is_some() {
            self.counters.evicted = self.counters.evicted.saturating_add(1);
        }
        let doubts_db2 = self.health.doubts_db2();
        let fix = tracker
            .push_doubting(time_ms, reading, doubts_db2, site, &mut self.workspace, rng)
            .map_err(|error| match error {
                ReadingError::TooOld => Rejected::TooOld,
                _ => Rejected::UnknownRadio,
            })?;
        let known = tracker.fix().zip(tracker.floor());
        let floor = floor_of(tracker, site);
        self.watch(&reading, time_ms, known, config);
        Ok(match fix {
            Some(fix) => {
                self.report.tag(tag, &fix, floor);
                Event::Fix { tag, fix }
            }
            None => Event::Taken { tag },
        })
    }

    /// Notes what a packet shows of the radios, by where its tag is thought to be, on which floor.
    fn watch<G: Ground>(
        &mut self,
        heard: &Reading,
        time_ms: u32,
        known: Option<(Fix, u8)>,
        config: &Config<G>,
    ) {
        // All floors have the same beacons.
        let map = config.site.map(0);
        let report = &mut self.report;
        let now_ms = self.trackers.now_ms();
        let radio = usize::from(heard.beacon);
        let identifier = |radio| map.beacon(radio).map_or(0, |beacon| beacon.identifier);
        let radios = (map.beacons(), config.silence_ms);
        (self.radios).hear(now_ms, radio, radios, |radio, is_silent| {
            let word = if is_silent { "SILENT" } else { "HEARD" };
            report.radio(now_ms, identifier(radio), word);
        });
        if let Some((fix, floor)) = known {
            let heard = (radio, heard.rssi_dbm);
            let site = &config.site;
            (self.health).hear(heard, time_ms, (&fix, floor), site, |radio, finding| {
                report.radio(now_ms, identifier(radio), finding.word());
            });
        }
    }

    /// Reports every tag and the status.
    #[inline(never)]
    fn answer<G: Ground<Floor = S::Floor>>(&mut self, config: &Config<G>) {
        let mut tags = 0;
        for (tag, tracker) in self.trackers.iter_mut() {
            tags += 1;
            if let Some(rng) = &mut self.generator {
                let doubts_db2 = self.health.doubts_db2();
                tracker.flush_doubting(doubts_db2, &config.site, &mut self.workspace, rng);
            }
            if let Some(fix) = tracker.fix() {
                self.report.tag(tag, &fix, floor_of(tracker, &config.site));
            }
        }
        self.report
            .status(&self.counters, tags, self.radios.silent());
    }
}

/// The gateway of a [`Building`](crate::fingerprint::tracker::Building) of several floors: `P` counts the points of all.
///
/// ```
/// use foxhunt::fingerprint::RadioMap;
/// use foxhunt::fingerprint::tracker::{self, Building, Site, Storey, Walls};
/// use foxhunt::gateway::beacon::{BuildingGateway, Config};
///
/// # static CELLAR: &[u8] =
/// #     include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/tunnel.map"));
/// # static HALL: &[u8] = CELLAR;
/// let [cellar, hall] = [RadioMap::new(CELLAR)?, RadioMap::new(HALL)?];
/// let above = [Storey { map: hall, walls: Walls::None }];
/// let building = Building {
///     lowest: Site::new(cellar, tracker::Config::DEFAULT)?,
///     above: &above,
///     passages: &[], // stairs and lifts: without any, a tag on another floor is lost, and found there
/// };
/// let config = Config::new(building);
/// config.check()?;
/// let mut gateway = BuildingGateway::<8, 300, 162, 4, 1>::EMPTY;
/// let events = b"$PFOXQ*50\r\n".iter().filter_map(|byte| gateway.push(*byte, &config));
/// assert_eq!(events.count(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub type BuildingGateway<
    const T: usize,
    const N: usize,
    const P: usize,
    const B: usize = 16,
    const D: usize = 2,
> = BeaconGateway<T, N, P, B, D, OnFloor<Packed<D>>>;

/// The likeliest floor of a tag and its probability, where there are several.
fn floor_of<const N: usize, const B: usize, const D: usize, S: Stored>(
    tracker: &Tracker<N, B, D, S>,
    site: &impl Ground,
) -> Option<(u8, f32)> {
    let floor = tracker.floor().filter(|_| site.floors() > 1)?;
    Some((floor, tracker.floor_probability(floor)))
}

persist!(
    impl[const T: usize, const N: usize, const P: usize, const B: usize, const D: usize, S: Stored]
    BeaconGateway<T, N, P, B, D, S> as "BeaconGateway"(T, N, B)
    { counters, trackers, radios, health, survey, generator } without { input, workspace, report, reception }
);

#[cfg(test)]
mod tests;
