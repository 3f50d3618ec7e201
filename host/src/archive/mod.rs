//! What came of a log from the field, kept for people: tables for a spreadsheet, a GeoJSON file for a map, a picture.
//!
//! A [`Recorder`] reads the bytes as the gateway of a vehicle does, by whatever locator, and notes what every bearing led
//! to; the [`Archive`] is what that makes, and writes the files.

mod coordinates;
mod drawing;
mod features;
mod gpx;
mod kml;
mod record;
mod tables;
pub mod times;

#[cfg(test)]
mod tests;

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result};
use foxhunt::aoa::{
    Advice, Answer, Bias, Hypothesis, Mixture, Observation, Source,
    geodesy::{Geodetic, LocalPlane},
};
use serde::{Deserialize, Serialize};

use crate::{density::Region, geodesy::Place, picture};
pub use coordinates::coordinates;
pub use record::{Notes, Recorder};
pub use tables::{BearingRow, FixRow};

/// All that is known of a log.
#[derive(Debug, Clone)]
pub struct Archive {
    /// Midnight UTC of the day of the first bearing, in milliseconds after 1970; 0 if the day is not known.
    pub midnight_ms: i64,
    /// Where the vehicle was, by its receiver.
    pub track: Vec<Passed>,
    /// What each bearing led to, in their order.
    pub answers: Vec<Answered>,
    /// Every bearing that was used, in the same order.
    pub bearings: Vec<Taken>,
    /// Where the source may be, at the end.
    pub hypotheses: Vec<Hypothesis>,
    /// The particles of each source, at the end: each is there as often as its weight says.
    pub particles: Vec<[f64; 2]>,
    /// How dense they are, for each source: regions, the widest first.
    pub densities: Vec<Vec<Region>>,
    /// Where to drive next.
    pub advice: Option<Advice>,
    /// Where each source was at the end, if the log says it, as a simulated one does.
    pub truths: Vec<Place>,
}

/// Where the vehicle was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passed {
    /// When, in milliseconds after midnight UTC, if that is known.
    pub time_ms: Option<u32>,
    /// Where.
    pub place: Geodetic,
}

/// What is known with a bearing.
#[derive(Debug, Clone, PartialEq)]
pub struct Answered {
    /// When the bearing was taken, in milliseconds after midnight UTC.
    pub time_ms: u32,
    /// Counts the searches, from 1: a restart begins another, with a plane of its own.
    pub search: u32,
    /// The plane of all places.
    pub plane: LocalPlane,
    /// How many bearings there were in this search.
    pub bearings: u32,
    /// What the gateway said.
    pub answer: Answer,
    /// The sources that have a fix, the best known first.
    pub sources: Vec<Source>,
    /// The common error of all bearings.
    pub bias: Option<Bias>,
    /// The rates of direct, mirrored and outlier bearings.
    pub rates: Option<Mixture>,
}

/// A bearing that was used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Taken {
    /// When it was taken, in milliseconds after midnight UTC.
    pub time_ms: u32,
    /// As [`Answered::search`].
    pub search: u32,
    /// The plane of its place.
    pub plane: LocalPlane,
    /// The bearing.
    pub observation: Observation,
    /// What it probably is, by all that is known at the end of the log; `None` without a fix, and for a locator that
    /// takes every bearing for direct. In a search before the last, or of a source that has moved on since or is not known
    /// any more, by what was known when it was taken.
    pub chances: Option<Mixture>,
    /// Whether it is of a source that has moved on since or is not known any more.
    pub past: bool,
    /// The source that it fits best, and how far it is off the direction of that, in radians counter-clockwise: less the
    /// bias, and turned round if it is mirrored. `None` without a fix.
    pub fits: Option<(Source, f64)>,
}

/// What a bearing is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// It points at the source.
    Direct,
    /// It points away from it.
    Mirrored,
    /// It says nothing of it.
    Outlier,
    /// It fitted where a source was when it was taken, which has moved on since or is not known any more.
    Past,
}

impl Taken {
    /// What it is most probably.
    pub fn kind(&self) -> Option<Kind> {
        let Mixture {
            direct,
            mirrored,
            outlier,
        } = self.chances?;
        Some(if self.past {
            Kind::Past
        } else if outlier > direct.max(mirrored) {
            Kind::Outlier
        } else if mirrored > direct {
            Kind::Mirrored
        } else {
            Kind::Direct
        })
    }
}

/// The probabilities of the regions that densities are shown by.
pub const PROBABILITIES: [f64; 4] = [0.95, 0.8, 0.5, 0.2];

impl Archive {
    /// What is known at the end.
    pub fn last(&self) -> &Answered {
        self.answers.last().expect("an archive has a bearing")
    }

    /// The bearings of the last search.
    pub fn last_bearings(&self) -> impl Iterator<Item = &Taken> + Clone {
        let search = self.last().search;
        (self.bearings.iter()).filter(move |taken| taken.search == search)
    }

    /// Where each source of the last search that may move was thought to be, bearing by bearing, in metres of the last plane.
    pub fn moves(&self) -> BTreeMap<u16, Vec<[f64; 2]>> {
        let search = self.last().search;
        let mut moves = BTreeMap::<u16, Vec<[f64; 2]>>::new();
        for known in self.answers.iter().filter(|known| known.search == search) {
            for source in known.sources.iter().filter(|s| s.motion.is_some()) {
                let places = moves.entry(source.identity).or_default();
                places.push(source.fix.position.map(f64::from));
            }
        }
        moves
    }

    /// Writes `fixes.csv`, `bearings.csv`, `archive.geojson`, `picture.svg`, `picture.png`, `archive.kml` and
    /// `archive.gpx`; says which files these are. The title is that of the picture.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, directory: &Path, title: &str) -> Result<Vec<PathBuf>> {
        fs::create_dir_all(directory)
            .with_context(|| format!("cannot make {}", directory.display()))?;
        let write = |name: &str, bytes: Vec<u8>| -> Result<PathBuf> {
            let file = directory.join(name);
            fs::write(&file, bytes).with_context(|| format!("cannot write {}", file.display()))?;
            Ok(file)
        };
        let mut files = vec![
            write("fixes.csv", tables::csv(&self.fix_rows())?)?,
            write("bearings.csv", tables::csv(&self.bearing_rows())?)?,
            write("archive.geojson", self.geojson()?.to_string().into_bytes())?,
        ];
        let stem = directory.join("picture");
        picture::save(&self.map(title).svg()?, &stem)?;
        files.extend(["svg", "png"].map(|ending| stem.with_extension(ending)));
        files.push(write("archive.kml", self.kml(title).into_bytes())?);
        files.push(write("archive.gpx", self.gpx(title).into_bytes())?);
        Ok(files)
    }
}

/// At most so many of them, evenly, and the last one.
fn thinned<T>(all: &[T], most: usize) -> impl Iterator<Item = &T> {
    let step = all.len().div_ceil(most).max(1);
    let offset = all.len().saturating_sub(1) % step;
    all.iter().skip(offset).step_by(step)
}
