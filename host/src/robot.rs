//! A flat in which a robot with a lidar was driven past six beacons: a survey, and another drive.
//!
//! The files are those of Kolakowski (Sensors 21, 6270, 2021). A row is a place and the mean strengths of a third of a second.

use std::{fs::File, path::Path};

use anyhow::{Context, Result, ensure};
use csv::StringRecord;

use crate::radio_map::SiteSurvey;
use foxhunt_simulation::tunnel::Packet;

/// A drive: places by time, and what was heard.
#[derive(Debug, Clone, Default)]
pub struct Drive {
    /// Seconds, and metres.
    pub places: Vec<(f64, [f64; 2])>,
    /// In order of time; the "beacon" is its number in the map of the survey.
    pub packets: Vec<Packet>,
}

/// The survey in the data set's `directory`.
///
/// # Errors
/// If the file is missing or not of that form.
pub fn survey(directory: &Path) -> Result<SiteSurvey> {
    SiteSurvey::open(&directory.join("survey.csv"))
}

/// The drive of a file in the data set's `directory`, without its ending: `robot`, or `survey` itself. Beacons get the numbers
/// that they have among `beacons`.
///
/// # Errors
/// If there is no such file, or it is not of that form.
pub fn drive(directory: &Path, name: &str, beacons: &[u32]) -> Result<Drive> {
    let path = directory.join(format!("{name}.csv"));
    let named = || path.display().to_string();
    let file = File::open(&path).with_context(named)?;
    let mut reader = csv::Reader::from_reader(file);
    let headers = reader.headers().with_context(named)?.clone();
    let column = |name: &str| {
        let found = headers.iter().position(|header| header == name);
        found.with_context(|| format!("{}: no column {name}", path.display()))
    };
    let [t, x, y] = [column("t_s")?, column("x_m")?, column("y_m")?];
    let levels = (beacons.iter().enumerate())
        .map(|(number, beacon)| Ok((number, column(&format!("rssi_{beacon}_dbm"))?)))
        .collect::<Result<Vec<_>>>()?;
    let mut drive = Drive::default();
    for record in reader.records() {
        let record = record.with_context(named)?;
        let time = number(&record, t).with_context(named)?;
        drive.places.push((
            time,
            [
                number(&record, x).with_context(named)?,
                number(&record, y).with_context(named)?,
            ],
        ));
        for (beacon, column) in &levels {
            if record.get(*column).is_some_and(|field| !field.is_empty()) {
                drive.packets.push(Packet {
                    time,
                    beacon: *beacon,
                    level: number(&record, *column).with_context(named)?,
                });
            }
        }
    }
    ensure!(!drive.places.is_empty(), "{} is empty", path.display());
    Ok(drive)
}

fn number(record: &StringRecord, column: usize) -> Result<f64> {
    let field = record.get(column).unwrap_or_default();
    field
        .parse()
        .with_context(|| format!("{field:?} is no number"))
}

impl Drive {
    /// Where the robot was at a time, straight between the rows.
    pub fn at(&self, time: f64) -> [f64; 2] {
        let after = self.places.partition_point(|(t, _)| *t <= time);
        let after = after.clamp(1, self.places.len() - 1);
        let ((t0, a), (t1, b)) = (self.places[after - 1], self.places[after]);
        let part = if t1 > t0 {
            ((time - t0) / (t1 - t0)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        [0, 1].map(|axis| a[axis] + part * (b[axis] - a[axis]))
    }

    /// Every second, from 2 s after the first row on, and whether the robot moved by more than 10 cm in the second before.
    pub fn times(&self) -> Vec<(f64, bool)> {
        let (first, last) = (self.places[0].0, self.places[self.places.len() - 1].0);
        let steps = (last - first) as u32;
        let step = |step: u32| {
            let time = first + f64::from(step);
            let ([x0, y0], [x1, y1]) = (self.at(time - 1.0), self.at(time));
            (time, (x1 - x0).hypot(y1 - y0) > 0.1)
        };
        (2..=steps).map(step).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_data_set_is_read_whole_and_unknown_names_are_errors() {
        // The data set is not part of the project.
        let Some(data) = std::env::var_os("FOXHUNT_DATA") else {
            return;
        };
        let directory = Path::new(&data).join("calib2021");
        let survey = survey(&directory).unwrap();
        // 4,104 rows, some of them at the same millimetre.
        assert_eq!(survey.survey().places.len(), 2609);
        let drive = drive_of(&directory);
        assert_eq!(drive.places.len(), 719);
        assert!(drive.packets.iter().all(|packet| packet.beacon < 6));
        assert!(super::drive(&directory, "nobody", survey.beacons()).is_err());
        assert!(super::drive(&directory, "robot", &[9]).is_err());
    }

    fn drive_of(directory: &Path) -> Drive {
        drive(directory, "robot", &[1, 2, 3, 4, 5, 6]).unwrap()
    }

    #[test]
    fn between_rows_the_way_is_straight() {
        let drive = Drive {
            places: vec![(0.0, [0.0, 0.0]), (1.0, [1.0, 2.0]), (3.0, [1.0, 2.0])],
            packets: Vec::new(),
        };
        assert_eq!(drive.at(0.5), [0.5, 1.0]);
        assert_eq!(drive.at(9.0), [1.0, 2.0]);
        assert_eq!(drive.times(), [(2.0, false), (3.0, false)]);
    }
}
