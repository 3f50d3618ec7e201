//! What the page is told. Places are in metres east and north, angles in degrees clockwise from north.

use foxhunt::{
    aoa::{Bearing, NotObservable},
    estimate::{self, Symmetric2},
};
use serde::Serialize;

/// The probability that an ellipse holds.
pub const PROBABILITY: f32 = 0.95;

/// An ellipse about a place that is stated beside it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Ellipse {
    /// Half of the longest diameter.
    pub semi_major_m: f32,
    /// Half of the shortest diameter.
    pub semi_minor_m: f32,
    /// The direction of the longest diameter.
    pub angle_deg: f32,
}

/// A bearing, as it was taken.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Taken {
    /// Counts from zero.
    pub id: u32,
    /// When it was taken.
    pub time_ms: u32,
    /// Where it was taken, to the east.
    pub x: f32,
    /// To the north.
    pub y: f32,
    /// Where it points.
    pub bearing_deg: f32,
    /// Its standard deviation.
    pub sigma_deg: f32,
    /// The probability that it is an outlier, as the locator now takes it.
    pub outlier: Option<f32>,
    /// Whether it is one now, but was not when it was taken, and sources may move: it points at where one was.
    pub past: bool,
}

/// A source that has a fix.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Source {
    /// It keeps this number.
    pub number: u16,
    /// To the east.
    pub x: f32,
    /// To the north.
    pub y: f32,
    /// In square metres: east, both, north.
    pub covariance: [f32; 3],
    /// What holds it.
    pub ellipse: Ellipse,
    /// Probability that there is such a source.
    pub probability: f32,
    /// Probability that it moves now, of locators for sources that do.
    pub moving: Option<f32>,
    /// East and north if it moves, in metres a second.
    pub velocity_m_s: Option<[f32; 2]>,
    /// The number of bearings that the fix rests on.
    pub bearings: u32,
    /// How many equally weighted particles the cloud is worth.
    pub effective_sample_size: f32,
}

/// A place where a source may be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Hypothesis {
    /// To the east.
    pub x: f32,
    /// To the north.
    pub y: f32,
    /// Its probability among all.
    pub mass: f32,
    /// What holds the source if it is there.
    pub ellipse: Ellipse,
}

/// Why there is no fix.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reason {
    /// In plain words.
    pub text: String,
    /// What helps.
    pub help: &'static str,
}

impl Reason {
    /// The reason, for a person.
    pub fn of(reason: NotObservable) -> Self {
        Self {
            text: reason.to_string(),
            help: reason.help(),
        }
    }
}

/// Where to drive.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Advice {
    /// To the east.
    pub x: f32,
    /// To the north.
    pub y: f32,
    /// In plain words.
    pub text: String,
}

/// What is known.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// The sources that have a fix, the best known first.
    pub sources: Vec<Source>,
    /// Where the source may be, the likeliest first.
    pub hypotheses: Vec<Hypothesis>,
    /// Why there is no fix.
    pub reason: Option<Reason>,
    /// Where to drive.
    pub advice: Option<Advice>,
    /// The bias of the array, in degrees clockwise, and its standard deviation.
    pub bias_deg: Option<[f32; 2]>,
    /// The rates of direct, mirrored and outlier bearings.
    pub rates: Option<[f32; 3]>,
    /// The particles of every source: east, north and weight times their number, one after the other.
    pub particles: Vec<f32>,
}

impl Ellipse {
    /// From the library's, which counts counter-clockwise from east.
    pub fn of(covariance: Symmetric2) -> Self {
        let ellipse = estimate::Ellipse::of_normal([0.0; 2], covariance, PROBABILITY);
        Self {
            semi_major_m: ellipse.semi_major,
            semi_minor_m: ellipse.semi_minor,
            angle_deg: Bearing::from_radians(ellipse.orientation).compass_degrees(),
        }
    }
}
