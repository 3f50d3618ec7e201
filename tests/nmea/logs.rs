//! The logs and what they say, decoded independently.

use std::{collections::HashMap, fs, path::PathBuf};

/// A sentence of a log as it should be read.
pub struct Expected {
    /// Of its `$` in the file.
    pub offset: usize,
    /// `RMC`, `GGA`, `VTG`, `HDT` or `THS`.
    pub kind: String,
    /// Milliseconds after midnight.
    pub time_ms: Option<u32>,
    /// Degrees times 10^7.
    pub place: Option<[i32; 2]>,
    pub speed_knots: Option<f64>,
    pub course_deg: Option<f64>,
    pub heading_deg: Option<f64>,
    /// Status and mode of RMC, quality of GGA, mode of VTG.
    pub status: String,
}

/// A log with the sentences that are expected of it.
pub struct Log {
    pub name: String,
    pub bytes: Vec<u8>,
    pub expected: Vec<Expected>,
}

/// All logs, by their names; nothing where they are not.
pub fn read(test: &str) -> Vec<Log> {
    let Some(data) = std::env::var_os("FOXHUNT_DATA").map(PathBuf::from) else {
        println!("{test} skipped: FOXHUNT_DATA does not name the directory of the measured data");
        return Vec::new();
    };
    let folder = data.join("nmea");
    let mut expected: HashMap<String, Vec<Expected>> = HashMap::new();
    let table = fs::read_to_string(folder.join("expected.csv")).unwrap();
    for row in table.lines().skip(1) {
        let columns: Vec<&str> = row.split(',').collect();
        let [
            log,
            offset,
            kind,
            time,
            latitude,
            longitude,
            speed,
            course,
            heading,
            status,
        ] = columns[..]
        else {
            panic!("{row}");
        };
        let number = |text: &str| text.parse().ok();
        let place = latitude.parse().ok().zip(longitude.parse().ok());
        expected.entry(log.into()).or_default().push(Expected {
            offset: offset.parse().unwrap(),
            kind: kind.into(),
            time_ms: milliseconds(time),
            place: place.map(|(latitude, longitude)| [latitude, longitude]),
            speed_knots: number(speed),
            course_deg: number(course),
            heading_deg: number(heading),
            status: status.into(),
        });
    }
    let logs = fs::read_dir(folder.join("logs")).unwrap();
    let mut logs: Vec<Log> = logs
        .map(|log| {
            let path = log.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            Log {
                bytes: fs::read(&path).unwrap(),
                expected: expected.remove(&name).unwrap_or_default(),
                name,
            }
        })
        .collect();
    logs.sort_by(|one, other| one.name.cmp(&other.name));
    assert!(expected.is_empty());
    logs
}

/// From `hhmmss.sss`.
fn milliseconds(time: &str) -> Option<u32> {
    let two = |from: usize| time.get(from..from + 2)?.parse::<u32>().ok();
    let fraction: f64 = format!("0{}", &time[time.len().min(6)..]).parse().ok()?;
    let whole = (two(0)? * 60 + two(2)?) * 60 + two(4)?;
    Some(1_000 * whole + (1_000.0 * fraction).round() as u32)
}
