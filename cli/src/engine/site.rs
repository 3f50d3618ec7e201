//! A place with a radio map, and the tags in it.

use std::path::Path;

use anyhow::{Context, Result, bail};
use foxhunt::{
    aoa::geodesy::{Geodetic, LocalPlane},
    fingerprint::{
        RadioMap, Zone,
        tracker::{self, Fix, Passage, State},
    },
    gateway::beacon::{Config, Event, Framing},
};
use foxhunt_decode::{Report, report};
use foxhunt_host::packets;
use foxhunt_simulation::people;

use super::{
    gateways::{self, BEACONS, BEACONS_OF_ALL, Gateway, POINTS, Within},
    message::{self, Tag},
};
use crate::settings;

/// In the place of a file, the radio map of the tunnel that is simulated.
pub const DEMO_MAP: &str = "the demo's";

/// A gateway of a tunnel or a building.
pub struct Site {
    name: String,
    gateway: Box<dyn Gateway + Send>,
    /// That of the only floor, or of the lowest.
    map: RadioMap<'static>,
    /// The rooms, and what they are called.
    rooms: Vec<Zone<'static>>,
    names: Vec<String>,
    plane: Plane,
    /// The line that is coming in, in which a gateway may report.
    line: Vec<u8>,
    /// Messages that were read, used, and refused by their reasons.
    pub lines: u64,
    pub used: u64,
    pub refused: std::collections::BTreeMap<String, u64>,
}

impl Site {
    /// Reads its maps.
    ///
    /// # Errors
    /// If a map cannot be read, is none, or is too large, or if floors and passages do not belong together.
    pub fn new(told: &settings::Site) -> Result<Self> {
        let beacons = if told.above.is_empty() {
            BEACONS
        } else {
            BEACONS_OF_ALL
        };
        let map = map(&told.map, beacons)?;
        let above: Vec<_> =
            (told.above.iter().map(|file| self::map(file, beacons))).collect::<Result<_>>()?;
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
        let config = Config {
            framing,
            ..Config::new(site)
        };
        let passages = told.passage.iter().map(passage).collect();
        let in_site = || format!("site {}", &*told.name);
        let (names, rooms) = rooms(&told.room).with_context(in_site)?;
        Ok(Self {
            name: told.name.to_string(),
            gateway: if above.is_empty() && told.passage.is_empty() {
                gateways::of_floor(config)
            } else {
                gateways::of_building(&config, above, passages).with_context(in_site)?
            },
            map,
            rooms,
            names,
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
        let lattice = self.map.lattice();
        let points = (0..lattice.points()).filter(|point| self.map.is_possible(*point));
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
        let Some(event) = self.gateway.push(byte) else {
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
                let within = self.gateway.within(tag, &self.rooms);
                let told = of_fix(&self.name, &self.plane, tag, &fix, time_ms);
                Some(self.with(told, within))
            }
            Event::Taken { .. } => {
                self.used += 1;
                None
            }
            Event::Other => {
                let tag = report(line.trim_ascii())
                    .and_then(|report| of_report(&self.name, &self.plane, &report, time_ms));
                self.used += u64::from(tag.is_some());
                tag
            }
            _ => None,
        };
        Some((tag, self.gateway.report()))
    }

    /// A tag with its floor and its room.
    fn with(&self, tag: Tag, within: Within) -> Tag {
        let probability = |value: f32| rounded(value.into(), 3);
        let name = |(number, p): (usize, f32)| Some((self.names.get(number)?.clone(), p));
        let (room, room_probability) = within.room.and_then(name).unzip();
        let (floor, floor_probability) = within.floor.unzip();
        Tag {
            floor,
            floor_probability: floor_probability.map(probability),
            room,
            room_probability: room_probability.map(probability),
            ..tag
        }
    }
}

/// Reads a map, for as long as the program runs: a few kilobytes.
fn map(path: &Path, beacons: usize) -> Result<RadioMap<'static>> {
    let file = path.display();
    let bytes = if path == Path::new(DEMO_MAP) {
        packets::example(people::EXAMPLE_SEED).map
    } else {
        std::fs::read(path).with_context(|| format!("cannot read {file}"))?
    };
    RadioMap::new(bytes.leak())
        .and_then(|map| map.limited(POINTS, beacons))
        .with_context(|| format!("{file} is no radio map that can be used"))
}

/// A zone of no name on a floor, for as long as the program runs.
fn zone(id: u16, floor: u8, corners: &[[f32; 2]]) -> Zone<'static> {
    Zone {
        id,
        floor,
        corners: corners.to_vec().leak(),
    }
}

fn passage(told: &settings::Passage) -> Passage<'static> {
    Passage {
        place: zone(0, 0, &told.corners),
        floors: told.floors.clone().leak(),
        seconds: told.seconds,
    }
}

/// The names of rooms, and the rooms.
fn rooms(told: &[settings::Room]) -> Result<(Vec<String>, Vec<Zone<'static>>)> {
    let each = told.iter().zip(0..).map(|(room, id)| {
        let zone = zone(id, room.floor, &room.corners);
        let named = || format!("room {}", room.name);
        zone.check().with_context(named)?;
        Ok((room.name.clone(), zone))
    });
    each.collect()
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

/// The tag of a report by which a gateway elsewhere tells of it.
pub fn of_report(site: &str, plane: &Plane, report: &Report, time_ms: i64) -> Option<Tag> {
    let Report::Tag {
        tag,
        state,
        place,
        covariance,
        floor,
    } = report
    else {
        return None;
    };
    let told = placed(site, plane, time_ms, (*tag, state), (*place, *covariance));
    let (floor, floor_probability) = floor.unzip();
    Some(Tag {
        floor,
        floor_probability,
        ..told
    })
}

/// A tag of a state at a place of the map.
fn placed(
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
        floor: None,
        floor_probability: None,
        room: None,
        room_probability: None,
    }
}

/// So many decimals.
pub fn rounded(value: f64, decimals: i32) -> f64 {
    let scale = 10f64.powi(decimals);
    (value * scale).round() / scale
}
