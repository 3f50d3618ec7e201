//! A place with a radio map, and the tags in it.

use std::path::Path;

use anyhow::{Context, Result, bail};
use foxhunt::{
    aoa::geodesy::{Geodetic, LocalPlane},
    fingerprint::{
        RadioMap,
        tracker::{self, Fix, State},
    },
    gateway::beacon::{BeaconGateway, Config, Event, Framing},
};
use foxhunt_decode::{Report, report};
use foxhunt_host::packets;
use foxhunt_simulation::people;

use super::message::{self, Tag};
use crate::settings;

/// In the place of a file, the radio map of the tunnel that is simulated.
pub const DEMO_MAP: &str = "the demo's";

/// The most points and beacons of a map.
const POINTS: usize = 4096;
const BEACONS: usize = 16;

/// With as many tags and particles as the firmware of a tunnel.
type Gateway<const D: usize> = BeaconGateway<64, 300, POINTS, BEACONS, D>;

enum ForMap {
    Line(Box<Gateway<1>>),
    Plane(Box<Gateway<2>>),
}

/// A gateway of a tunnel or a building.
pub struct Site {
    name: String,
    gateway: ForMap,
    config: Config<tracker::Site<'static>>,
    plane: Plane,
    /// The line that is coming in, in which a gateway may report.
    line: Vec<u8>,
    /// Messages that were read, used, and refused by their reasons.
    pub lines: u64,
    pub used: u64,
    pub refused: std::collections::BTreeMap<String, u64>,
}

impl Site {
    /// Reads its map.
    ///
    /// # Errors
    /// If the map cannot be read, is none, or is too large.
    pub fn new(told: &settings::Site) -> Result<Self> {
        let file = told.map.display();
        let bytes = if told.map == Path::new(DEMO_MAP) {
            packets::example(people::EXAMPLE_SEED).map
        } else {
            std::fs::read(&told.map).with_context(|| format!("cannot read {file}"))?
        };
        // A few kilobytes, for as long as the program runs.
        let map = RadioMap::new(bytes.leak())
            .and_then(|map| map.limited(POINTS, BEACONS))
            .with_context(|| format!("{file} is no radio map that can be used"))?;
        let walks = match told.walks {
            settings::Walks::Tunnel => tracker::Config::TUNNEL,
            settings::Walks::Floor => tracker::Config::DEFAULT,
        };
        let site = tracker::Site::new(map, walks)?;
        let framing = if told.frames {
            Framing::Frames
        } else {
            Framing::Lines
        };
        let plane = match (told.latitude, told.longitude) {
            (Some(latitude), Some(longitude)) => {
                let [latitude, longitude] =
                    [latitude, longitude].map(|degrees| (degrees * 1e7).round() as i32);
                let plane = LocalPlane::new(Geodetic::new(latitude, longitude)?)?;
                Some((plane, told.turned_deg.unwrap_or(0.0).to_radians() as f32))
            }
            (None, None) => None,
            _ => bail!(
                "site {}: latitude and longitude belong together",
                &*told.name
            ),
        };
        Ok(Self {
            name: told.name.to_string(),
            gateway: match map.lattice().axes() {
                1 => ForMap::Line(Box::new(Gateway::EMPTY)),
                _ => ForMap::Plane(Box::new(Gateway::EMPTY)),
            },
            config: Config {
                framing,
                ..Config::new(site)
            },
            plane,
            line: Vec::new(),
            lines: 0,
            used: 0,
            refused: Default::default(),
        })
    }

    /// What it is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What a page is told of it.
    pub fn message(&self) -> message::Site {
        let lattice = self.config.site.map.lattice();
        let points = (0..lattice.points()).filter(|point| self.config.site.map.is_possible(*point));
        let side = |count: usize| f64::from(lattice.spacing()) * count.saturating_sub(1) as f64;
        message::Site {
            name: self.name.clone(),
            width: side(lattice.columns()),
            height: side(lattice.rows()),
            points: points
                .map(|point| lattice.position(point).map(|v| rounded(v.into(), 3)))
                .collect(),
        }
    }

    /// Takes a byte; gives the fix of a tag and the sentences to send, where the byte ends a message.
    pub fn push(&mut self, byte: u8, time_ms: i64) -> Option<(Option<Tag>, &str)> {
        let (event, report) = match &mut self.gateway {
            ForMap::Line(gateway) => (gateway.push(byte, &self.config), gateway.report()),
            ForMap::Plane(gateway) => (gateway.push(byte, &self.config), gateway.report()),
        };
        let Some(event) = event else {
            /// Bytes of the longest sentence that is looked at.
            const LONGEST: usize = 160;
            if self.line.len() < LONGEST {
                self.line.push(byte);
            }
            return None;
        };
        let line = std::mem::take(&mut self.line);
        self.lines += 1;
        let tag = match event {
            Event::Rejected(reason) => {
                *self.refused.entry(reason.to_string()).or_default() += 1;
                None
            }
            Event::Fix { tag, fix } => {
                self.used += 1;
                Some(of_fix(&self.name, &self.plane, tag, &fix, time_ms))
            }
            Event::Taken { .. } => {
                self.used += 1;
                None
            }
            Event::Other => {
                let tag = of_report(&self.name, &self.plane, line.trim_ascii(), time_ms);
                self.used += u64::from(tag.is_some());
                tag
            }
            _ => None,
        };
        Some((tag, report))
    }
}

/// Where the origin of a map is, and how its axes are turned.
type Plane = Option<(LocalPlane, f32)>;

fn of_fix(site: &str, plane: &Plane, id: u32, fix: &Fix, time_ms: i64) -> Tag {
    let covariance = [fix.covariance.xx, fix.covariance.xy, fix.covariance.yy];
    let state = match fix.state {
        State::Tracking => "TRACKING",
        State::Uncertain => "UNCERTAIN",
        State::Lost => "LOST",
        State::Recovered => "RECOVERED",
        _ => "UNKNOWN",
    };
    let covariance = covariance.map(f64::from);
    let place = fix.position.map(f64::from);
    placed(site, plane, time_ms, (id, state), (place, covariance))
}

/// The tag of a sentence by which a gateway in the tunnel reports.
fn of_report(site: &str, plane: &Plane, line: &[u8], time_ms: i64) -> Option<Tag> {
    let Report::Tag {
        tag,
        state,
        place,
        covariance,
    } = report(line)?
    else {
        return None;
    };
    Some(placed(
        site,
        plane,
        time_ms,
        (tag, &state),
        (place, covariance),
    ))
}

/// A tag of a state at a place of the map.
pub fn placed(
    site: &str,
    plane: &Plane,
    time_ms: i64,
    (id, state): (u32, &str),
    (place, covariance): ([f64; 2], [f64; 3]),
) -> Tag {
    let on_earth = plane.as_ref().and_then(|(plane, turned)| {
        // Clockwise, as a compass turns.
        let (sin, cos) = turned.sin_cos();
        let [x, y] = place.map(|metres| metres as f32);
        let metres = [x * cos + y * sin, y * cos - x * sin];
        foxhunt_host::archive::coordinates(plane, metres)
    });
    let [x, y] = place.map(|metres| rounded(metres, 3));
    Tag {
        id,
        site: site.to_owned(),
        time_ms,
        x,
        y,
        covariance: covariance.map(|v| rounded(v, 4)),
        lat: on_earth.map(|[_, latitude]| latitude),
        lon: on_earth.map(|[longitude, _]| longitude),
        state: state.to_owned(),
    }
}

/// So many decimals.
pub fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10f64.powi(decimals);
    (value * scale).round() / scale
}
