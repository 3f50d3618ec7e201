//! Walks measured in an office floor: twelve fixed receivers hear one beacon.
//!
//! The files are those of the position annotated BLE data set of Danis, Cemgil et al. (Physics and Measurement
//! of BLE, PMC 81, 2022), with the true places from cameras.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use serde::{Deserialize, de::DeserializeOwned};

use foxhunt_simulation::{survey::Survey, tunnel::Packet};

/// A walk, packet by packet.
#[derive(Debug, Clone)]
pub struct Walk {
    /// What was heard, in order of time; the "beacon" is the receiver.
    pub packets: Vec<Packet>,
    /// Where the beacon was at each packet, in metres.
    pub truth: Vec<[f64; 2]>,
}

/// The names of the walks, from the simplest.
pub const WALKS: [&str; 5] = [
    "straight_01",
    "straight_02",
    "straight_03",
    "rectangular_without_rotation",
    "zigzagging_without_rotation",
];

#[derive(Deserialize)]
struct Sensor {
    sensor: usize,
    x_m: f64,
    y_m: f64,
}

#[derive(Deserialize)]
struct Sample {
    x_m: f64,
    y_m: f64,
    sensor: usize,
    rssi_dbm: f64,
}

#[derive(Deserialize)]
struct Heard {
    t_s: f64,
    sensor: usize,
    rssi_dbm: f64,
    x_m: f64,
    y_m: f64,
}

/// The places of the receivers, in metres, read from the data set's `directory`.
///
/// # Errors
/// If the file is missing or not of that form.
pub fn receivers(directory: &Path) -> Result<Vec<[f64; 2]>> {
    let rows: Vec<Sensor> = rows(&directory.join("sensors.csv"))?;
    ensure!(
        rows.iter().enumerate().all(|(n, row)| row.sensor == n),
        "the sensors are not numbered from zero"
    );
    Ok(rows.iter().map(|row| [row.x_m, row.y_m]).collect())
}

/// The survey in the data set's `directory`.
///
/// # Errors
/// If the file is missing or not of that form.
pub fn survey(directory: &Path) -> Result<Survey> {
    let rows: Vec<Sample> = rows(&directory.join("survey.csv"))?;
    let beacons = rows.iter().map(|row| row.sensor + 1).max().unwrap_or(0);
    let mut survey = Survey::default();
    for row in rows {
        let place = [row.x_m, row.y_m];
        let index = match survey.places.iter().position(|known| *known == place) {
            Some(index) => index,
            None => {
                survey.places.push(place);
                survey.samples.push(vec![Vec::new(); beacons]);
                survey.places.len() - 1
            }
        };
        survey.samples[index][row.sensor].push(row.rssi_dbm);
    }
    Ok(survey)
}

/// The walk `name`, one of [`WALKS`], in the data set's `directory`.
///
/// # Errors
/// If the file is missing or not of that form, or its times run backwards.
pub fn walk(directory: &Path, name: &str) -> Result<Walk> {
    let rows: Vec<Heard> = rows(&directory.join("walks").join(format!("{name}.csv")))?;
    ensure!(
        rows.windows(2).all(|pair| pair[0].t_s <= pair[1].t_s),
        "the times of {name} run backwards"
    );
    let packet = |row: &Heard| Packet {
        time: row.t_s,
        beacon: row.sensor,
        level: row.rssi_dbm,
    };
    Ok(Walk {
        packets: rows.iter().map(packet).collect(),
        truth: rows.iter().map(|row| [row.x_m, row.y_m]).collect(),
    })
}

fn rows<T: DeserializeOwned>(file: &Path) -> Result<Vec<T>> {
    let named = || file.display().to_string();
    csv::Reader::from_path(file)
        .with_context(named)?
        .deserialize()
        .collect::<Result<_, _>>()
        .with_context(named)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The directory of the data set, if there is one here: it is not part of the project.
    fn directory() -> Option<std::path::PathBuf> {
        std::env::var_os("FOXHUNT_DATA").map(|data| Path::new(&data).join("tetam"))
    }

    #[test]
    fn the_data_set_is_read_whole() {
        let Some(directory) = directory() else { return };
        assert_eq!(receivers(&directory).unwrap().len(), 12);
        let survey = survey(&directory).unwrap();
        assert_eq!((survey.places.len(), survey.beacons()), (81, 12));
        assert!(survey.samples.iter().flatten().all(|s| s.len() == 50));
        for name in WALKS {
            let walk = walk(&directory, name).unwrap();
            assert!(walk.packets.len() > 1000);
            assert_eq!(walk.packets.len(), walk.truth.len());
        }
        assert!(walk(&directory, "none").is_err());
    }

    #[test]
    fn a_missing_file_is_named() {
        let error = format!("{:#}", survey(Path::new("nowhere")).unwrap_err());
        assert!(error.contains("survey.csv"), "{error}");
    }
}
