//! The gateway of a vehicle: bytes of receivers and direction finders in, reports out.

use foxhunt::ConfigError;
use foxhunt::aoa::geodesy::Geodetic;
use foxhunt::aoa::{Locate, ObservationError, clean, robust};
use foxhunt::gateway::formats::{self, Finder, Formats};
use foxhunt::gateway::{self, BearingReference, Config, Event, Rejected, ReportForm, Station};

use crate::clean::FoxhuntCleanConfig;
use crate::door::{self, Opaque, Out, opaque, plain};
use crate::locator::{self, Fault, Told};
use crate::reasons::FoxhuntRejected;
use crate::result::{FoxhuntResult, FoxhuntText, code};
use crate::robust::FoxhuntRobustConfig;
use crate::types::{RobustVehicle, Vehicle};
use crate::words::{FoxhuntAnswer, FoxhuntAnswerKind};

opaque!(
    /// Gateway of a vehicle with clean bearings.
    FoxhuntVehicle = b"fxVe": Config<clean::Config>, Vehicle = Vehicle::EMPTY
);

opaque!(
    /// Gateway of a vehicle with bearings of which some are wrong.
    FoxhuntRobustVehicle = b"fxRV": Config<robust::Config>, RobustVehicle = RobustVehicle::EMPTY
);

/// Bearings count from the bow: a value of `reference`.
pub const FOXHUNT_REFERENCE_RELATIVE: u32 = 0;
/// Bearings count from true north: a value of `reference`.
pub const FOXHUNT_REFERENCE_TRUE_NORTH: u32 = 1;

/// Every direction finder is heard: a value of `finder`.
pub const FOXHUNT_FINDER_ALL: u32 = 0;
/// An Agrelo: a value of `finder`.
pub const FOXHUNT_FINDER_AGRELO: u32 = 1;
/// A KrakenSDR: a value of `finder`.
pub const FOXHUNT_FINDER_KRAKEN: u32 = 2;
/// A u-blox board: a value of `finder`.
pub const FOXHUNT_FINDER_UBLOX: u32 = 3;
/// A KN5R-RDF: a value of `finder`.
pub const FOXHUNT_FINDER_KN5R: u32 = 4;
/// A direction finder that reports by APRS: a value of `finder`.
pub const FOXHUNT_FINDER_APRS: u32 = 5;

/// How a gateway treats its lines. What the functions that fill it choose is in parentheses; what has none is zero.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntLineConfig {
    /// Seed of the particles: the same bytes with the same seed give the same reports (1).
    pub seed: u64,
    /// The frequencies that a KrakenSDR hears the sources on, which must stay as long as the gateway is used. Null with a
    /// count of zero takes every frequency for one source.
    pub frequencies_hz: *const u32,
    /// How many there are.
    pub frequencies: usize,
    /// The only direction finder that is heard: `FOXHUNT_FINDER_ALL` and so on.
    pub finder: u32,
    /// Not zero: places and headings are used that a simulator made or that were entered by hand.
    pub simulated: u32,
    /// Direction from which bearings count that leave it open: `FOXHUNT_REFERENCE_RELATIVE` and so on.
    pub reference: u32,
    /// Not zero: the direction finders stand where the three next fields say.
    pub is_station: u32,
    /// Latitude of the station, in 1e-7 degree.
    pub station_latitude_e7: i32,
    /// Longitude of the station, in 1e-7 degree.
    pub station_longitude_e7: i32,
    /// Where relative bearings of 0 point, in degrees clockwise from true north, 0 to 360.
    pub station_heading_deg: f32,
    /// Quality, 0 to 100, below which a bearing is rejected (40).
    pub min_quality: f32,
    /// Standard deviation of a bearing of quality 100, at least 0.001 rad (2 degrees).
    pub best_sigma_rad: f32,
    /// Standard deviation of a bearing of quality 0, up to 3.2 rad (10 degrees).
    pub worst_sigma_rad: f32,
    /// Longest time between a bearing and its position or heading, up to an hour (2,000).
    pub max_age_ms: u32,
    /// How many bearings without a time are taken at one time of the receiver, up to 255 (20).
    pub undated_bearings: u32,
    /// Speed from which the course over ground is the heading (1.5).
    pub min_speed_m_s: f32,
    /// Rate of turn of the course above which it is not taken for the heading, up to 360 degrees a second (10).
    pub max_turn_rate_deg_s: f32,
    /// Speed that the vehicle never exceeds (100).
    pub max_speed_m_s: f32,
    /// Not zero: the variation of magnetic north is what the next field says.
    pub has_variation: u32,
    /// Degrees clockwise, -180 to 180.
    pub variation_deg: f32,
    /// Shortest time between two reports, up to an hour; 0 reports on every bearing (1,000).
    pub report_interval_ms: u32,
}

/// How the gateway of a vehicle works.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntVehicleConfig {
    /// How it treats its lines.
    pub lines: FoxhuntLineConfig,
    /// What the locator is told.
    pub locator: FoxhuntCleanConfig,
}

/// How the gateway of a vehicle with a robust locator works.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntRobustVehicleConfig {
    /// How it treats its lines.
    pub lines: FoxhuntLineConfig,
    /// What the locator is told.
    pub locator: FoxhuntRobustConfig,
}

/// What a byte led to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum FoxhuntEventKind {
    /// It is in the middle of a line.
    None = 0,
    /// A sentence of the receiver was used.
    Used = 1,
    /// A bearing was used: `answer` is a fix.
    Fix = 2,
    /// A bearing was used: `answer` says why there is no fix yet.
    NotObservable = 3,
    /// The line was not used: `rejected` says why.
    Rejected = 4,
    /// The host has asked, and the report answers.
    Queried = 5,
    /// The host looks for another source, and the report confirms it.
    Restarted = 6,
    /// A correct sentence that is none of the gateway's.
    Other = 7,
}

/// What a byte led to.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntEvent {
    /// What it is.
    pub kind: FoxhuntEventKind,
    /// The reason, where `kind` says that it is a rejection: `foxhunt_rejected_text` says it. Elsewhere it says nothing.
    pub rejected: FoxhuntRejected,
    /// What is known of the source, where a bearing was used; else it says nothing. In metres of a plane round where the
    /// first bearing was taken: `foxhunt_vehicle_place` has latitude and longitude.
    pub answer: FoxhuntAnswer,
}

/// A place on the Earth.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct FoxhuntPlace {
    /// Latitude in 1e-7 degree, north positive.
    pub latitude_e7: i32,
    /// Longitude in 1e-7 degree, east positive.
    pub longitude_e7: i32,
}

plain!(FoxhuntVehicleConfig, FoxhuntRobustVehicleConfig);

fn lines<C>(config: &Config<C>) -> FoxhuntLineConfig {
    FoxhuntLineConfig {
        seed: config.seed,
        frequencies_hz: core::ptr::null(),
        frequencies: 0,
        finder: FOXHUNT_FINDER_ALL,
        simulated: config.formats.simulated.into(),
        reference: FOXHUNT_REFERENCE_RELATIVE,
        is_station: 0,
        station_latitude_e7: 0,
        station_longitude_e7: 0,
        station_heading_deg: 0.0,
        min_quality: config.min_quality,
        best_sigma_rad: config.best_sigma_rad,
        worst_sigma_rad: config.worst_sigma_rad,
        max_age_ms: config.max_age_ms,
        undated_bearings: config.undated_bearings.into(),
        min_speed_m_s: config.min_speed_m_s,
        max_turn_rate_deg_s: config.max_turn_rate_deg_s,
        max_speed_m_s: config.max_speed_m_s,
        has_variation: 0,
        variation_deg: 0.0,
        report_interval_ms: config.report_interval_ms,
    }
}

impl FoxhuntLineConfig {
    /// In the library's words.
    fn to_rust<C>(self, locator: C) -> Result<Config<C>, Fault> {
        let mut formats = formats::Config {
            finder: finder(self.finder)?,
            simulated: self.simulated != 0,
            ..formats::Config::DEFAULT
        };
        formats.kraken.frequencies_hz = door::list(self.frequencies_hz, self.frequencies)?;
        Ok(Config {
            formats,
            reference: match self.reference {
                FOXHUNT_REFERENCE_RELATIVE => BearingReference::Relative,
                FOXHUNT_REFERENCE_TRUE_NORTH => BearingReference::TrueNorth,
                _ => return Err(ConfigError::new("reference must be 0 or 1").into()),
            },
            station: self.station()?,
            seed: self.seed,
            min_quality: self.min_quality,
            best_sigma_rad: self.best_sigma_rad,
            worst_sigma_rad: self.worst_sigma_rad,
            max_age_ms: self.max_age_ms,
            undated_bearings: u8::try_from(self.undated_bearings)
                .map_err(|_| ConfigError::new("undated_bearings must be at most 255"))?,
            min_speed_m_s: self.min_speed_m_s,
            max_turn_rate_deg_s: self.max_turn_rate_deg_s,
            max_speed_m_s: self.max_speed_m_s,
            variation_deg: (self.has_variation != 0).then_some(self.variation_deg),
            report_interval_ms: self.report_interval_ms,
            ..Config::new(locator)
        })
    }

    fn station(&self) -> Result<Option<Station>, ConfigError> {
        if self.is_station == 0 {
            return Ok(None);
        }
        let place = Geodetic::new(self.station_latitude_e7, self.station_longitude_e7);
        let place = place.map_err(|error| {
            ConfigError::new(match error {
                ObservationError::Latitude => "station_latitude_e7 must be from -90 to 90 degrees",
                _ => "station_longitude_e7 must be from -180 to 180 degrees",
            })
        })?;
        Ok(Some(Station {
            place,
            heading_deg: self.station_heading_deg,
        }))
    }
}

fn finder(number: u32) -> Result<Option<Finder>, ConfigError> {
    Ok(Some(match number {
        FOXHUNT_FINDER_ALL => return Ok(None),
        FOXHUNT_FINDER_AGRELO => Finder::Agrelo,
        FOXHUNT_FINDER_KRAKEN => Finder::Kraken,
        FOXHUNT_FINDER_UBLOX => Finder::Ublox,
        FOXHUNT_FINDER_KN5R => Finder::Kn5r,
        FOXHUNT_FINDER_APRS => Finder::Aprs,
        _ => return Err(ConfigError::new("finder must be from 0 to 5")),
    }))
}

impl Told for FoxhuntVehicleConfig {
    type Rust = Config<clean::Config>;

    fn to_rust(self) -> Result<Self::Rust, Fault> {
        self.lines.to_rust(self.locator.to_rust()?)
    }

    fn check(config: &Self::Rust) -> Result<(), ConfigError> {
        config.check()?;
        FoxhuntCleanConfig::check(&config.locator)
    }
}

impl Told for FoxhuntRobustVehicleConfig {
    type Rust = Config<robust::Config>;

    fn to_rust(self) -> Result<Self::Rust, Fault> {
        self.lines.to_rust(self.locator.to_rust()?)
    }

    fn check(config: &Self::Rust) -> Result<(), ConfigError> {
        config.check()?;
        FoxhuntRobustConfig::check(&config.locator)
    }
}

impl From<Option<Event>> for FoxhuntEvent {
    fn from(event: Option<Event>) -> Self {
        use FoxhuntEventKind as Kind;
        let nothing = FoxhuntAnswer::without_fix(FoxhuntAnswerKind::TooFewBearings, 0.0, 2.0);
        let rejected = match event {
            Some(Event::Rejected(reason)) => reason.into(),
            _ => FoxhuntRejected::Other,
        };
        let (kind, answer) = match event {
            None => (Kind::None, nothing),
            Some(Event::Used) => (Kind::Used, nothing),
            Some(Event::Fix(fix)) => (Kind::Fix, fix.into()),
            Some(Event::NotObservable(reason)) => (Kind::NotObservable, reason.into()),
            Some(Event::Rejected(_)) => (Kind::Rejected, nothing),
            Some(Event::Queried) => (Kind::Queried, nothing),
            Some(Event::Restarted) => (Kind::Restarted, nothing),
            Some(_) => (Kind::Other, nothing),
        };
        Self {
            kind,
            rejected,
            answer,
        }
    }
}

fn push<T, L, F, R, const PORTS: usize>(
    vehicle: *mut T,
    port: u32,
    byte: u8,
    event: *mut FoxhuntEvent,
) -> FoxhuntResult
where
    T: Opaque<Config = Config<L::Config>, State = gateway::Vehicle<L, F, R, PORTS>>,
    L: Locate,
    F: Formats,
    R: ReportForm,
{
    let result = || {
        let out = Out::optional(event)?;
        let port = usize::try_from(port).unwrap_or(usize::MAX);
        let event = door::change(vehicle, |config, state| {
            (port < PORTS).then(|| state.push(port, byte, config))
        })?;
        out.write(event.ok_or(FoxhuntResult::Port)?.into());
        Ok(())
    };
    code(result())
}

fn place<T, L, F, R, const PORTS: usize>(
    vehicle: *const T,
    local: [f32; 2],
    place: *mut FoxhuntPlace,
) -> FoxhuntResult
where
    T: Opaque<State = gateway::Vehicle<L, F, R, PORTS>>,
    L: Locate,
    F: Formats,
    R: ReportForm,
{
    let result = || {
        let out = Out::new(place)?;
        let plane = door::look(vehicle, |_, state| state.plane().copied())?;
        let found = plane.ok_or(FoxhuntResult::Nothing)?.to_geodetic(local)?;
        out.write(FoxhuntPlace {
            latitude_e7: found.latitude_e7(),
            longitude_e7: found.longitude_e7(),
        });
        Ok(())
    };
    code(result())
}

/// Why a line was rejected, by the number of the reason; an empty text of any other number.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_rejected_text(rejected: u32) -> FoxhuntText {
    let reason = Rejected::ALL.get(rejected as usize);
    reason.map_or("", |reason| reason.message()).into()
}

/// Fills a configuration for a car.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_vehicle_config_default(
    config: *mut FoxhuntVehicleConfig,
) -> FoxhuntResult {
    const DEFAULT: Config<clean::Config> = Config::new(clean::Config::DEFAULT);
    let default = FoxhuntVehicleConfig {
        lines: lines(&DEFAULT),
        locator: DEFAULT.locator.into(),
    };
    locator::write(config, default)
}

/// The name of the first field that is out of range, and what it may be; an empty text if all is right.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_vehicle_config_fault(config: *const FoxhuntVehicleConfig) -> FoxhuntText {
    locator::fault(config)
}

/// Makes a gateway that knows nothing, with a copy of the configuration. `size` is `sizeof *vehicle`.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_vehicle_init(
    vehicle: *mut FoxhuntVehicle,
    size: usize,
    config: *const FoxhuntVehicleConfig,
) -> FoxhuntResult {
    locator::init(vehicle, size, config)
}

/// Forgets the source, to look for another; keeps the vehicle's own place and the counts.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_vehicle_restart(vehicle: *mut FoxhuntVehicle) -> FoxhuntResult {
    code(door::change(vehicle, |_, state| state.restart()))
}

/// Takes the next byte of a port, 0 to `FOXHUNT_PORTS - 1`, and says what it led to; `event` may be null. Never waits.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_vehicle_push(
    vehicle: *mut FoxhuntVehicle,
    port: u32,
    byte: u8,
    event: *mut FoxhuntEvent,
) -> FoxhuntResult {
    push(vehicle, port, byte, event)
}

/// What to send for the last line: sentences with their line ends, or nothing. It holds until the next call with this
/// gateway.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_vehicle_report(vehicle: *const FoxhuntVehicle) -> FoxhuntText {
    door::look(vehicle, |_, state| state.report().into()).unwrap_or_else(|_| "".into())
}

/// Latitude and longitude of so many metres east and north of the origin, as a fix has them, up to 100 km:
/// `FOXHUNT_RESULT_NOTHING` before the first bearing.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_vehicle_place(
    vehicle: *const FoxhuntVehicle,
    east_m: f32,
    north_m: f32,
    place: *mut FoxhuntPlace,
) -> FoxhuntResult {
    self::place(vehicle, [east_m, north_m], place)
}

/// Fills a configuration for a car in a city.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_robust_vehicle_config_city(
    config: *mut FoxhuntRobustVehicleConfig,
) -> FoxhuntResult {
    const CITY: Config<robust::Config> = Config::new(robust::Config::CITY);
    let city = FoxhuntRobustVehicleConfig {
        lines: lines(&CITY),
        locator: CITY.locator.into(),
    };
    locator::write(config, city)
}

/// The name of the first field that is out of range, and what it may be; an empty text if all is right.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_robust_vehicle_config_fault(
    config: *const FoxhuntRobustVehicleConfig,
) -> FoxhuntText {
    locator::fault(config)
}

/// Makes a gateway that knows nothing, with a copy of the configuration. `size` is `sizeof *vehicle`.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_robust_vehicle_init(
    vehicle: *mut FoxhuntRobustVehicle,
    size: usize,
    config: *const FoxhuntRobustVehicleConfig,
) -> FoxhuntResult {
    locator::init(vehicle, size, config)
}

/// Forgets the source, to look for another; keeps the vehicle's own place and the counts.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_robust_vehicle_restart(
    vehicle: *mut FoxhuntRobustVehicle,
) -> FoxhuntResult {
    code(door::change(vehicle, |_, state| state.restart()))
}

/// Takes the next byte of a port, 0 to `FOXHUNT_PORTS - 1`, and says what it led to; `event` may be null. Never waits.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_robust_vehicle_push(
    vehicle: *mut FoxhuntRobustVehicle,
    port: u32,
    byte: u8,
    event: *mut FoxhuntEvent,
) -> FoxhuntResult {
    push(vehicle, port, byte, event)
}

/// What to send for the last line: sentences with their line ends, or nothing. It holds until the next call with this
/// gateway.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_robust_vehicle_report(
    vehicle: *const FoxhuntRobustVehicle,
) -> FoxhuntText {
    door::look(vehicle, |_, state| state.report().into()).unwrap_or_else(|_| "".into())
}

/// Latitude and longitude of so many metres east and north of the origin, as a fix has them, up to 100 km:
/// `FOXHUNT_RESULT_NOTHING` before the first bearing.
#[unsafe(no_mangle)]
pub extern "C" fn foxhunt_robust_vehicle_place(
    vehicle: *const FoxhuntRobustVehicle,
    east_m: f32,
    north_m: f32,
    place: *mut FoxhuntPlace,
) -> FoxhuntResult {
    self::place(vehicle, [east_m, north_m], place)
}
