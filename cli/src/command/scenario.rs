//! Scenarios in TOML files: a drive, people in a tunnel, or people in a building.

use std::{fs, path::Path};

use anyhow::{Context, Result, bail, ensure};
use foxhunt_host::{
    drive::Drive,
    geodesy::Place,
    packets::{self, Floors, Scene},
};
use foxhunt_simulation::scenario::{Scenario, Way};
use serde::{Deserialize, de::DeserializeOwned};
use serde_json::json;

/// What a file tells.
pub enum Told {
    /// A vehicle that takes bearings.
    Drive(Scenario),
    /// People in a tunnel.
    Tunnel(Tunnel),
    /// People in a building.
    Building(Building),
}

/// People in the tunnel that comes with the project.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tunnel {
    pub seed: u64,
    people: Vec<Person>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Person {
    tag: u32,
    way: Way,
}

/// People in a building of three floors, who go from room to room.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Building {
    pub seed: u64,
    people: u32,
    seconds: f64,
}

/// The longest time that is simulated, in seconds, and the most people.
const LONGEST_S: f64 = 3_600.0;
const MOST: usize = 64;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OfTunnel {
    tunnel: Tunnel,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct OfBuilding {
    building: Building,
}

/// Reads a file.
///
/// # Errors
/// Names the file and the line, and what is wrong there.
pub fn read(file: &str) -> Result<Told> {
    ensure!(
        is_scenario(Path::new(file)),
        "there is no scenario {file}; one of your own is a .toml file"
    );
    let text = fs::read_to_string(file).with_context(|| format!("cannot read {file}"))?;
    let table: toml::Table = parsed(file, &text)?;
    Ok(if table.contains_key("tunnel") {
        Told::Tunnel(parsed::<OfTunnel>(file, &text)?.tunnel)
    } else if table.contains_key("building") {
        Told::Building(parsed::<OfBuilding>(file, &text)?.building)
    } else {
        Told::Drive(parsed(file, &text)?)
    })
}

/// Whether a file is one, by its ending.
pub fn is_scenario(file: &Path) -> bool {
    file.extension().is_some_and(|ending| ending == "toml")
}

fn parsed<T: DeserializeOwned>(file: &str, text: &str) -> Result<T> {
    match toml::from_str(text) {
        Ok(value) => Ok(value),
        Err(error) => {
            let before = error.span().and_then(|span| text.get(..span.start));
            let line = before.map_or(1, |before| 1 + before.matches('\n').count());
            bail!("{file}:{line}: {}", error.message())
        }
    }
}

impl Tunnel {
    /// What the radios hear.
    ///
    /// # Errors
    /// If there is nobody, or somebody whose way is none.
    pub fn scene(&self) -> Result<Scene> {
        ensure!(
            (1..=MOST).contains(&self.people.len()),
            "people: from 1 to {MOST}"
        );
        let path = |person: &Person| {
            let tag = person.tag;
            ensure!(
                person.way.is_valid(),
                "tag {tag}: a way needs corners, a speed above zero and a start"
            );
            let path = person.way.path();
            let end = path.times().map_or(0.0, |[_, end]| end);
            ensure!(
                end <= LONGEST_S,
                "tag {tag}: its way takes longer than {LONGEST_S} s"
            );
            Ok((tag, path))
        };
        let people: Vec<_> = self.people.iter().map(path).collect::<Result<_>>()?;
        Ok(packets::tunnel(self.seed, &people))
    }
}

impl Building {
    /// What the beacons hear.
    ///
    /// # Errors
    /// If there is nobody, or for no time.
    pub fn floors(&self) -> Result<Floors> {
        ensure!(
            (1..=MOST as u32).contains(&self.people),
            "people: from 1 to {MOST}"
        );
        ensure!(
            self.seconds > 0.0 && self.seconds <= LONGEST_S,
            "seconds: above 0, at most {LONGEST_S}"
        );
        Ok(packets::building(self.seed, self.people, self.seconds))
    }
}

/// The log of a drive: the receiver's sentences, and bearings as JSON, in the order of time.
///
/// # Errors
/// Names what is out of range.
pub fn log(scenario: &Scenario) -> Result<Vec<u8>> {
    const ORIGIN: Place = Place {
        latitude: 52.229_675_6,
        longitude: 21.012_228_7,
    };
    /// Seconds after midnight, and midnight of the day of all simulated drives in seconds after 1970.
    const DEPARTURE: f64 = 9.0 * 3600.0;
    const MIDNIGHT: f64 = 1_795_305_600.0;
    let readings = scenario.readings()?;
    let end = readings
        .last()
        .map_or(0.0, |last| f64::from(last.sight.time_ms) * 1e-3);
    let mut bytes = Vec::new();
    let mut add = |write: &dyn Fn(&mut Drive)| {
        let mut drive = Drive::default();
        write(&mut drive);
        bytes.extend_from_slice(drive.bytes());
    };
    for place in scenario.places(end) {
        add(&|drive| drive.truth(ORIGIN.offset(place)));
    }
    // A receiver that has been on for two seconds is believed.
    if let Some(first) = readings.first() {
        for early in [2.0, 1.0] {
            let time = DEPARTURE + f64::from(first.sight.time_ms) * 1e-3 - early;
            add(&|drive| drive.position(time, ORIGIN.offset(first.sight.position), 0.0, 0.0));
        }
    }
    let mut log = bytes;
    for reading in &readings {
        let sight = reading.sight;
        let time = DEPARTURE + f64::from(sight.time_ms) * 1e-3;
        let place = ORIGIN.offset(sight.position);
        let compass = |radians: f64| (90.0 - radians.to_degrees()).rem_euclid(360.0);
        let mut drive = Drive::default();
        let speed = scenario.vehicle.speed_m_s;
        drive.position(time, place, speed, compass(reading.heading));
        log.extend_from_slice(drive.bytes());
        let bearing = json!({
            "type": "BEARING", "bearing_type": "absolute", "latitude": place.latitude, "longitude": place.longitude,
            "bearing": compass(sight.bearing), "sigma_deg": sight.sigma.to_degrees(), "timestamp": MIDNIGHT + time,
        });
        log.extend_from_slice(format!("{bearing}\n").as_bytes());
    }
    Ok(log)
}
