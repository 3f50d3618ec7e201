//! The tracker of one tag: packets in, its place out.

use foxhunt::ConfigError;
use foxhunt::fingerprint::tracker::{Config, Fix, Site, State};
use foxhunt::fingerprint::{RadioMap, Reading};

use crate::door::{self, Out, opaque, plain};
use crate::locator::{self, Fault, Told};
use crate::result::{FoxhuntResult, FoxhuntText, code};
use crate::sizes::{FOXHUNT_BEACONS, FOXHUNT_POINTS};
use crate::types::{Tracker, Workspace};
use crate::words::{FoxhuntGenerator, FoxhuntSymmetric2, draw};

opaque!(
    /// A radio map, and how tags are tracked on it: one serves all trackers.
    FoxhuntSite = b"fxSi": Site<'static>, () = (), NoSite
);

opaque!(
    /// Tracks one tag.
    FoxhuntTracker = b"fxTr": (), Tracker = Tracker::EMPTY
);

opaque!(
    /// Scratch memory of an update: one serves all trackers.
    FoxhuntWorkspace = b"fxWo": (), Workspace = Workspace::EMPTY, NoWorkspace
);

/// How tags are tracked. `INFINITY` is a value.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntTrackerConfig {
    /// Standard deviation of a velocity along an axis when nothing is known of it, in metres a second: 0.01 to 100.
    pub velocity_sigma_m_s: f32,
    /// Variance that a velocity gains every second, in m^2/s^3: 0.0001 to 1000.
    pub velocity_noise_m2_s3: f32,
    /// Seconds in which a velocity falls to 1/e: at least 0.1; infinite for one that stays.
    pub velocity_memory_s: f32,
    /// Standard deviation in dB, 0.1 to 30, of the difference between a walk and the survey at one place.
    pub mismatch_sigma_db: f32,
    /// Seconds in which what a tag at rest remembers of the map's error falls to 1/e: at least 0.1.
    pub error_memory_s: f32,
    /// The power, 0.01 to 1, to which the likelihood of a scan of twelve beacons is raised.
    pub tempering: f32,
    /// Readings that differ by more than so many sigmas count as if they differed by that: at least 0.5; may be infinite.
    pub gate_sigmas: f32,
    /// The lowest strength in dBm that a radio can report, at least -128.
    pub lowest_dbm: f32,
    /// The highest, at least 10 dB above, at most 127.
    pub highest_dbm: f32,
    /// The probability, 0 to 0.99, that a tag reads otherwise than the one of the survey.
    pub offset_probability: f32,
    /// Standard deviation of its offset in that case, in dB: 0.1 to 50.
    pub offset_sigma_db: f32,
    /// Variance that an offset gains every second, in dB^2/s: 0 to 100.
    pub offset_noise_db2_s: f32,
    /// Packets of so many milliseconds, up to a minute, make one update; 0 for an update by every packet.
    pub window_ms: u32,
    /// Fraction of the particles, 0 to 1, that is drawn anew when the evidence has gone against them.
    pub redraw_fraction: f32,
    /// A place is uncertain when its standard deviation in the worst direction is larger than this, in metres.
    pub uncertain_sigma_m: f32,
}

/// How reliable the place of a tag is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum FoxhuntTagState {
    /// It is where the fix says.
    Tracking = 0,
    /// The fix is the mean of places too far apart.
    Uncertain = 1,
    /// The evidence has gone against the particles, and some or all were just drawn anew.
    Lost = 2,
    /// It was lost, and the evidence has supported the particles since then, but not for long.
    Recovered = 3,
}

/// Where a tag is.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntTagFix {
    /// When it was there: the mean time of the packets of the last update, in milliseconds.
    pub time_ms: u32,
    /// How reliable the place is.
    pub state: FoxhuntTagState,
    /// Posterior mean along the first axis of the map, in metres.
    pub x_m: f32,
    /// And along the second.
    pub y_m: f32,
    /// Posterior covariance in square metres.
    pub covariance: FoxhuntSymmetric2,
    /// Posterior mean of the velocity along the first axis, in metres a second.
    pub x_m_s: f32,
    /// And along the second.
    pub y_m_s: f32,
    /// By how many dB the tag reads stronger than the one of the survey.
    pub offset_db: f32,
    /// How many equally weighted particles the cloud is worth.
    pub effective_sample_size: f32,
}

plain!(FoxhuntTrackerConfig);

impl From<Config> for FoxhuntTrackerConfig {
    fn from(config: Config) -> Self {
        let [lowest_dbm, highest_dbm] = config.range_dbm;
        Self {
            velocity_sigma_m_s: config.velocity_sigma_m_s,
            velocity_noise_m2_s3: config.velocity_noise_m2_s3,
            velocity_memory_s: config.velocity_memory_s,
            mismatch_sigma_db: config.mismatch_sigma_db,
            error_memory_s: config.error_memory_s,
            tempering: config.tempering,
            gate_sigmas: config.gate_sigmas,
            lowest_dbm,
            highest_dbm,
            offset_probability: config.offset_probability,
            offset_sigma_db: config.offset_sigma_db,
            offset_noise_db2_s: config.offset_noise_db2_s,
            window_ms: config.window_ms,
            redraw_fraction: config.redraw_fraction,
            uncertain_sigma_m: config.uncertain_sigma_m,
        }
    }
}

impl Told for FoxhuntTrackerConfig {
    type Rust = Config;

    fn to_rust(self) -> Result<Config, Fault> {
        Ok(Config {
            velocity_sigma_m_s: self.velocity_sigma_m_s,
            velocity_noise_m2_s3: self.velocity_noise_m2_s3,
            velocity_memory_s: self.velocity_memory_s,
            mismatch_sigma_db: self.mismatch_sigma_db,
            error_memory_s: self.error_memory_s,
            tempering: self.tempering,
            gate_sigmas: self.gate_sigmas,
            range_dbm: [self.lowest_dbm, self.highest_dbm],
            offset_probability: self.offset_probability,
            offset_sigma_db: self.offset_sigma_db,
            offset_noise_db2_s: self.offset_noise_db2_s,
            window_ms: self.window_ms,
            redraw_fraction: self.redraw_fraction,
            uncertain_sigma_m: self.uncertain_sigma_m,
        })
    }

    fn check(config: &Config) -> Result<(), ConfigError> {
        config.check()
    }
}

impl From<Fix> for FoxhuntTagFix {
    fn from(fix: Fix) -> Self {
        let [x_m, y_m] = fix.position;
        let [x_m_s, y_m_s] = fix.velocity;
        Self {
            time_ms: fix.time_ms,
            state: match fix.state {
                State::Uncertain => FoxhuntTagState::Uncertain,
                State::Lost => FoxhuntTagState::Lost,
                State::Recovered => FoxhuntTagState::Recovered,
                _ => FoxhuntTagState::Tracking,
            },
            x_m,
            y_m,
            covariance: fix.covariance.into(),
            x_m_s,
            y_m_s,
            offset_db: fix.offset_db,
            effective_sample_size: fix.effective_sample_size,
        }
    }
}

/// Fills a configuration for people on foot, in the reach of a dozen radios.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_tracker_config_default(
    config: *mut FoxhuntTrackerConfig,
) -> FoxhuntResult {
    locator::write(config, Config::DEFAULT.into())
}

/// Fills a configuration for a tunnel: at any pace, past few radios.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_tracker_config_tunnel(
    config: *mut FoxhuntTrackerConfig,
) -> FoxhuntResult {
    locator::write(config, Config::TUNNEL.into())
}

/// The name of the first field that is out of range, and what it may be; an empty text if all is right.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_tracker_config_fault(config: *const FoxhuntTrackerConfig) -> FoxhuntText {
    locator::fault(config)
}

/// Opens a radio map of `length` bytes, which are read in place: they must stay as they are as long as the site is used, and
/// may lie in flash. `size` is `sizeof *site`.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_site_init(
    site: *mut FoxhuntSite,
    size: usize,
    map: *const u8,
    length: usize,
    config: *const FoxhuntTrackerConfig,
) -> FoxhuntResult {
    let result = || {
        let config = locator::checked(config)?;
        if map.is_null() {
            return Err(FoxhuntResult::NullPointer);
        }
        let map = RadioMap::new(door::list(map, length)?)?;
        let map = map.limited(FOXHUNT_POINTS, FOXHUNT_BEACONS)?;
        // The configuration is in order, so it is the encoding that is refused.
        let opened = Site::new(map, config).map_err(|_| FoxhuntResult::MapEncoding)?;
        door::init(site, size, opened)
    };
    code(result())
}

/// The number of the beacon with an identifier in the map; -1 if there is none.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_site_beacon(site: *const FoxhuntSite, identifier: u32) -> i32 {
    let beacon = door::look(site, |site, ()| site.map.beacon_index(identifier));
    let beacon = beacon.ok().flatten();
    beacon
        .and_then(|beacon| i32::try_from(beacon).ok())
        .unwrap_or(-1)
}

/// Makes scratch memory. `size` is `sizeof *workspace`.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_workspace_init(
    workspace: *mut FoxhuntWorkspace,
    size: usize,
) -> FoxhuntResult {
    code(door::init(workspace, size, ()))
}

/// Makes a tracker without a tag. `size` is `sizeof *tracker`.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_tracker_init(tracker: *mut FoxhuntTracker, size: usize) -> FoxhuntResult {
    code(door::init(tracker, size, ()))
}

/// Forgets the tag.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_tracker_reset(tracker: *mut FoxhuntTracker) -> FoxhuntResult {
    code(door::change(tracker, |(), state| state.reset()))
}

/// Takes a packet with its time in milliseconds, which may wrap: the number of the beacon in the map, and the strength in
/// dBm. If it leads to an update, `updated` becomes 1, else 0, and the fix is written; `updated` and `fix` may be null.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_tracker_push(
    tracker: *mut FoxhuntTracker,
    time_ms: u32,
    beacon: u8,
    rssi_dbm: f32,
    site: *const FoxhuntSite,
    workspace: *mut FoxhuntWorkspace,
    generator: *mut FoxhuntGenerator,
    updated: *mut u32,
    fix: *mut FoxhuntTagFix,
) -> FoxhuntResult {
    let result = || {
        let outs = (Out::optional(updated)?, Out::optional(fix)?);
        let packet = Reading { beacon, rssi_dbm };
        let fix = door::look(site, |site, ()| {
            door::change(tracker, |(), state| {
                door::change(workspace, |(), workspace| {
                    draw(generator, |rng| {
                        state.push(time_ms, packet, site, workspace, rng)
                    })
                })
            })
        })?????;
        outs.0.write(fix.is_some().into());
        if let Some(fix) = fix {
            outs.1.write(fix.into());
        }
        Ok(())
    };
    code(result())
}

/// Updates by the packets that wait, if there are any: at the end of a walk, or for a query.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_tracker_flush(
    tracker: *mut FoxhuntTracker,
    site: *const FoxhuntSite,
    workspace: *mut FoxhuntWorkspace,
    generator: *mut FoxhuntGenerator,
) -> FoxhuntResult {
    let result = || {
        door::look(site, |site, ()| {
            door::change(tracker, |(), state| {
                door::change(workspace, |(), workspace| {
                    draw(generator, |rng| state.flush(site, workspace, rng))
                })
            })
        })????;
        Ok(())
    };
    code(result())
}

/// Where the tag was at the last update: `FOXHUNT_RESULT_NOTHING` before the first.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_tracker_fix(
    tracker: *const FoxhuntTracker,
    fix: *mut FoxhuntTagFix,
) -> FoxhuntResult {
    let result = || {
        let out = Out::new(fix)?;
        let fix = door::look(tracker, |(), state| state.fix())?;
        out.write(fix.ok_or(FoxhuntResult::Nothing)?.into());
        Ok(())
    };
    code(result())
}
