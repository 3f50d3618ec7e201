//! What the locators are told, and what the exact posterior beside them expects.

use std::f64::consts::PI;

use foxhunt::aoa::{
    Robust, clean,
    robust::{Biases, Config, Correlation, Errors},
};
use foxhunt_host::reference::{Prior, Square};
use foxhunt_simulation::Sight;

const DEGREE: f64 = PI / 180.0;

/// By default: how well the scale of the sigmas is known, and the sigma of a bias of all bearings.
pub const SCALE_SIGMA: f64 = Config::DEFAULT.errors.scale_sigma as f64;
pub const BIAS_SIGMA: f64 = Config::DEFAULT.errors.bias_sigma_rad as f64;
/// In all parts: within which ranges the source is about as likely in each.
const NEAREST_M: f64 = Config::DEFAULT.nearest_m as f64;
pub const RANGE_M: f64 = Config::DEFAULT.range_m as f64;

/// The range in a room.
pub const ROOM_M: f64 = Config::ROOM.range_m as f64;

/// The largest relative standard deviation of range that makes a fix.
pub const RANGE_SIGMA: f64 = Config::DEFAULT.relative_range_sigma as f64;

/// A vehicle's stops: the errors of a stop and of a reading.
pub const STOP_SIGMA: f64 = 15.0 * DEGREE;
pub const READING_SIGMA: f64 = 3.0 * DEGREE;
/// What a user who knows of no stops may say of them.
pub const GUESSED_SIGMA: f64 = 5.0 * DEGREE;

/// Arrays in a room: their biases, and what changes with time.
pub const STATION_SIGMA: f64 = 10.0 * DEGREE;
pub const STATION_READING_SIGMA: f64 = 3.0 * DEGREE;
pub const STATION_TIME_S: f64 = 2.0;

/// A bias by direction.
pub const CURVE_SIGMA: f64 = 10.0 * DEGREE;
pub const HARMONICS: usize = 2;

/// The locator for a bias of each station, which counts as an error of its place, and of each direction.
pub type ByStation = Robust<256>;
pub type ByDirection = Robust<256, 64, { 4 + 2 * HARMONICS }>;

/// What a locator is told of bearings.
#[derive(Clone, Copy)]
pub struct Told {
    pub config: Config,
    /// The sigma that each states, in radians.
    pub sigma: f64,
}

/// Nothing, but the sigma of a bearing.
pub fn nothing(sigma: f64) -> Told {
    Told {
        config: Config::DEFAULT,
        sigma,
    }
}

/// Of the clean locator.
pub const CLEAN: clean::Config = clean::Config::DEFAULT;

/// That readings of a stop have an error in common, and nothing else.
pub fn stops() -> Told {
    Told {
        config: with_errors(Errors {
            stop_sigma_rad: STOP_SIGMA as f32,
            bias_sigma_rad: 0.0,
            correlation: Correlation::NONE,
            ..Errors::DEFAULT
        }),
        sigma: READING_SIGMA,
    }
}

/// That each station is in a room, and has a bias.
pub fn stations() -> Told {
    let mut config = Config::ROOM;
    config.errors.stop_sigma_rad = STATION_SIGMA as f32;
    config.errors.correlation.time_s = STATION_TIME_S as f32;
    Told {
        config,
        sigma: STATION_READING_SIGMA,
    }
}

/// That there is a bias by direction.
pub fn direction(sigma: f64) -> Told {
    Told {
        config: with_errors(Errors {
            bias_sigma_rad: CURVE_SIGMA as f32,
            biases: Biases::ByDirection,
            ..Errors::DEFAULT
        }),
        sigma,
    }
}

fn with_errors(errors: Errors) -> Config {
    Config {
        errors,
        ..Config::DEFAULT
    }
}

/// The prior of a locator of these bearings: about the middle of the places where they are taken, and flat among them; of
/// sources within a range.
pub fn prior(sights: &[Sight], range_m: f64) -> Option<Prior> {
    let (low, high) = extent(sights)?;
    let half = 0.5 * (high[0] - low[0]).hypot(high[1] - low[1]);
    Some(Prior::Ranged {
        centre: [0, 1].map(|d| 0.5 * (low[d] + high[d])),
        nearest_m: half.clamp(NEAREST_M, range_m),
        range_m,
    })
}

/// Where the source may be.
pub fn everywhere(sights: &[Sight]) -> Option<Square> {
    let centre = sights.first()?.position;
    let side = 10.0 * RANGE_M;
    Some(Square { centre, side })
}

/// The corners of the box of all places.
fn extent(sights: &[Sight]) -> Option<([f64; 2], [f64; 2])> {
    let first = sights.first()?.position;
    Some(sights.iter().fold((first, first), |(low, high), sight| {
        let least = [0, 1].map(|d| f64::min(low[d], sight.position[d]));
        let most = [0, 1].map(|d| f64::max(high[d], sight.position[d]));
        (least, most)
    }))
}
