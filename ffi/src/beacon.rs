//! The gateway of a tunnel: reports of its radios in, the places of tags out.

use foxhunt::ConfigError;
use foxhunt::fingerprint::tracker::Site;
use foxhunt::gateway::beacon::{Config, Event, Framing, Rejected};

use crate::door::{self, Out, opaque, plain};
use crate::locator::{self, Fault};
use crate::reasons::FoxhuntBeaconRejected;
use crate::result::{FoxhuntResult, FoxhuntText, code};
use crate::tracker::{FoxhuntSite, FoxhuntTagFix};
use crate::types::Beacon;

opaque!(
    /// Gateway of a tunnel.
    FoxhuntBeacon = b"fxBe": Config<Site<'static>>, Beacon = Beacon::EMPTY
);

/// Messages are `$PFOXB` sentences: a value of `framing`.
pub const FOXHUNT_FRAMING_LINES: u32 = 0;
/// Messages are binary frames: a value of `framing`.
pub const FOXHUNT_FRAMING_FRAMES: u32 = 1;

/// How the gateway of a tunnel treats its messages.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntBeaconConfig {
    /// Seed of the particles: the same bytes with the same seed give the same reports.
    pub seed: u64,
    /// How messages come: `FOXHUNT_FRAMING_LINES` and so on.
    pub framing: u32,
    /// A radio that has heard nothing for so many milliseconds while others have, a second to an hour, is reported as silent.
    pub silence_ms: u32,
}

/// What a byte led to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum FoxhuntBeaconEventKind {
    /// It is in the middle of a message.
    None = 0,
    /// A packet of `tag` was taken, and waits for others.
    Taken = 1,
    /// A packet led to an update: `fix` of `tag`.
    Fix = 2,
    /// The message was not used: `rejected` says why.
    Rejected = 3,
    /// The host has asked, and the report answers.
    Queried = 4,
    /// All tags were forgotten.
    Restarted = 5,
    /// A correct sentence of another kind, or one of a survey or of a new map, which C does not take.
    Other = 6,
}

/// What a byte led to. `foxhunt_beacon_fix` has the fix.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntBeaconEvent {
    /// What it is.
    pub kind: FoxhuntBeaconEventKind,
    /// The reason, where `kind` says that it is a rejection: `foxhunt_beacon_rejected_text` says it. Elsewhere it says nothing.
    pub rejected: FoxhuntBeaconRejected,
    /// The number of the tag.
    pub tag: u32,
}

plain!(FoxhuntBeaconConfig);

impl FoxhuntBeaconConfig {
    /// In the library's words, on a site, and checked.
    fn to_rust(self, site: *const FoxhuntSite) -> Result<Config<Site<'static>>, Fault> {
        let config = Config {
            framing: match self.framing {
                FOXHUNT_FRAMING_LINES => Framing::Lines,
                FOXHUNT_FRAMING_FRAMES => Framing::Frames,
                _ => return Err(ConfigError::new("framing must be 0 or 1").into()),
            },
            seed: self.seed,
            silence_ms: self.silence_ms,
            ..Config::new(door::look(site, |site, ()| *site)?)
        };
        config.check()?;
        Ok(config)
    }
}

impl From<Option<Event>> for FoxhuntBeaconEvent {
    fn from(event: Option<Event>) -> Self {
        use FoxhuntBeaconEventKind as Kind;
        let rejected = match event {
            Some(Event::Rejected(reason)) => reason.into(),
            _ => FoxhuntBeaconRejected::Other,
        };
        let (kind, tag) = match event {
            None => (Kind::None, 0),
            Some(Event::Taken { tag }) => (Kind::Taken, tag),
            Some(Event::Fix { tag, .. }) => (Kind::Fix, tag),
            Some(Event::Rejected(_)) => (Kind::Rejected, 0),
            Some(Event::Queried) => (Kind::Queried, 0),
            Some(Event::Restarted) => (Kind::Restarted, 0),
            Some(_) => (Kind::Other, 0),
        };
        Self {
            kind,
            rejected,
            tag,
        }
    }
}

/// Fills a configuration: sentences, and five seconds until a radio is silent.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_beacon_config_default(config: *mut FoxhuntBeaconConfig) -> FoxhuntResult {
    let default = FoxhuntBeaconConfig {
        seed: 1,
        framing: FOXHUNT_FRAMING_LINES,
        silence_ms: 5_000,
    };
    locator::write(config, default)
}

/// The name of the first field that is out of range, and what it may be; an empty text if all is right.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_beacon_config_fault(
    site: *const FoxhuntSite,
    config: *const FoxhuntBeaconConfig,
) -> FoxhuntText {
    let result = || door::get(config)?.to_rust(site);
    match result() {
        Ok(_) => "".into(),
        Err(fault) => fault.message(),
    }
}

/// Why a message was rejected, by the number of the reason; an empty text of any other number.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_beacon_rejected_text(rejected: u32) -> FoxhuntText {
    let reason = Rejected::ALL.get(rejected as usize);
    reason.map_or("", |reason| reason.message()).into()
}

/// Makes a gateway without tags, with a copy of the site and of the configuration. `size` is `sizeof *beacon`. The bytes of
/// the map stay where they are.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_beacon_init(
    beacon: *mut FoxhuntBeacon,
    size: usize,
    site: *const FoxhuntSite,
    config: *const FoxhuntBeaconConfig,
) -> FoxhuntResult {
    let result = || {
        let config = door::get(config)?.to_rust(site)?;
        door::init(beacon, size, config)
    };
    code(result())
}

/// Forgets all tags, and which radios are silent; keeps the counts.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_beacon_restart(beacon: *mut FoxhuntBeacon) -> FoxhuntResult {
    code(door::change(beacon, |_, state| state.restart()))
}

/// Takes the next byte of the line, and says what it led to; `event` may be null. Never waits.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_beacon_push(
    beacon: *mut FoxhuntBeacon,
    byte: u8,
    event: *mut FoxhuntBeaconEvent,
) -> FoxhuntResult {
    let result = || {
        let out = Out::optional(event)?;
        let event = door::change(beacon, |config, state| state.push(byte, config))?;
        out.write(event.into());
        Ok(())
    };
    code(result())
}

/// What to send for the last message: sentences with their line ends, or nothing. It holds until the next call with this
/// gateway.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_beacon_report(beacon: *const FoxhuntBeacon) -> FoxhuntText {
    door::look(beacon, |_, state| state.report().into()).unwrap_or_else(|_| "".into())
}

/// Where a tag is: `FOXHUNT_RESULT_NOTHING` if it is not tracked or has no fix yet.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_beacon_fix(
    beacon: *const FoxhuntBeacon,
    tag: u32,
    fix: *mut FoxhuntTagFix,
) -> FoxhuntResult {
    let result = || {
        let out = Out::new(fix)?;
        let found = door::look(beacon, |_, state| {
            let tracker = state.tags().find(|(other, _)| *other == tag);
            tracker.and_then(|(_, tracker)| tracker.fix())
        })?;
        out.write(found.ok_or(FoxhuntResult::Nothing)?.into());
        Ok(())
    };
    code(result())
}
