//! What a search says to pages, brokers and maps.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// A message. Times are milliseconds after 1970, places are degrees, bearings degrees clockwise from true north, all else
/// metres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub enum Message {
    /// Where a vehicle, a station or a gateway is.
    Receiver(Receiver),
    /// A bearing came in.
    Bearing(Bearing),
    /// A bearing was taken back.
    Retracted {
        /// Its number.
        id: u64,
        /// Who did it.
        by: By,
    },
    /// A bearing that was taken back counts again.
    Restored {
        /// Its number.
        id: u64,
    },
    /// What is known now.
    Answer(Answer),
    /// Where a tag is.
    Tag(Tag),
    /// A place with a radio map.
    Site(Site),
    /// What comes in and goes out.
    Health(Health),
    /// A place that somebody has marked.
    Mark(Mark),
    /// A line or a message of an input was not used.
    Refused(Refused),
    /// Bearings are taken for outliers with other probabilities than before.
    Outliers {
        /// Their numbers, and the probabilities.
        changed: Vec<(u64, f64)>,
    },
}

/// Who takes a bearing back.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum By {
    /// Somebody at a page.
    Page,
    /// The direction finder.
    Device,
    /// Whoever undoes the last thing.
    Undo,
}

/// See [`Message::Receiver`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Receiver {
    pub name: String,
    pub kind: Kind,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lat: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lon: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heading_deg: Option<f64>,
    pub time_ms: i64,
}

/// What a receiver is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    Vehicle,
    Station,
    Gateway,
}

/// See [`Message::Bearing`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Bearing {
    pub id: u64,
    pub receiver: String,
    pub time_ms: i64,
    pub lat: f64,
    pub lon: f64,
    pub bearing_deg: f64,
    pub sigma_deg: f64,
    pub used: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outlier: Option<f64>,
    /// It came from another station by a broker or by UDP, so it is not this one's to tell of.
    #[serde(skip)]
    pub is_of_others: bool,
}

/// See [`Message::Answer`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    pub time_ms: i64,
    pub sources: Vec<Source>,
    pub hypotheses: Vec<Hypothesis>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<Reason>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub advice: Option<Advice>,
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub particles: Vec<[f64; 2]>,
}

/// A source that has a fix.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Source {
    pub number: u16,
    pub lat: f64,
    pub lon: f64,
    /// Of east, east and north, north; in square metres.
    pub covariance: [f64; 3],
    pub ellipse: Ellipse,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub probability: Option<f64>,
    pub fix: bool,
    pub bearings: u32,
}

/// A 95 % ellipse.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ellipse {
    pub semi_major_m: f64,
    pub semi_minor_m: f64,
    /// Of the major axis, clockwise from north.
    pub angle_deg: f64,
}

/// See [`Message::Refused`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Refused {
    pub input: String,
    /// When it came in; 0 if that is not known.
    pub time_ms: i64,
    pub reason: String,
    /// Its beginning.
    pub text: String,
    /// How many of the input were refused for this reason so far.
    pub count: u64,
}

/// A place where the source may be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Hypothesis {
    pub lat: f64,
    pub lon: f64,
    pub mass: f64,
    pub ellipse: Ellipse,
}

/// Why there is no fix.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reason {
    /// As in `$PFOXN`.
    pub code: String,
    pub text: String,
    /// What helps.
    pub help: String,
}

/// Where to drive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Advice {
    pub lat: f64,
    pub lon: f64,
    pub text: String,
}

/// See [`Message::Tag`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tag {
    pub id: u32,
    pub site: String,
    pub time_ms: i64,
    pub x: f64,
    pub y: f64,
    /// Of x, x and y, y; in square metres.
    pub covariance: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lat: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lon: Option<f64>,
    /// As in `$PFOXT`.
    pub state: String,
    /// The likeliest floor, counted from 0, where there are several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub floor: Option<u8>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub floor_probability: Option<f64>,
    /// The name of the likeliest room, if it is in any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub room: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub room_probability: Option<f64>,
}

/// See [`Message::Site`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Site {
    pub name: String,
    pub width: f64,
    pub height: f64,
    pub points: Vec<[f64; 2]>,
}

/// See [`Message::Health`].
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Health {
    pub inputs: Vec<InputHealth>,
    pub outputs: Vec<OutputHealth>,
}

/// An input.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InputHealth {
    pub name: String,
    pub state: State,
    pub since_ms: i64,
    pub lines: u64,
    pub used: u64,
    pub refused: BTreeMap<String, u64>,
}

/// An output.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OutputHealth {
    pub name: String,
    pub state: State,
    pub queued: u64,
    pub sent: u64,
    pub lost: u64,
}

/// Whether an input or output works.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    Open,
    Silent,
    Lost,
    /// It has come to its end.
    Ended,
}

/// See [`Message::Mark`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mark {
    pub id: u64,
    pub lat: f64,
    pub lon: f64,
    pub text: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub removed: Option<bool>,
}
