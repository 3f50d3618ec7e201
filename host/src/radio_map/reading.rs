//! The rows of a survey.

use std::{collections::BTreeMap, io::Read, path::Path};

use anyhow::{Context, Result, ensure};
use csv::StringRecord;
use foxhunt::fingerprint::Lattice;
use serde::Deserialize;

/// One packet of a beacon, received at a known place.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Reading {
    /// Metres.
    #[serde(alias = "x_m")]
    pub x: f64,
    /// Metres.
    #[serde(alias = "y_m")]
    pub y: f64,
    /// Identifier of the beacon.
    #[serde(alias = "sensor")]
    pub beacon: u32,
    /// dBm.
    #[serde(alias = "rssi_dbm")]
    pub rssi: f64,
}

/// Where a row was taken.
#[derive(Deserialize)]
struct Place {
    #[serde(alias = "x_m")]
    x: f64,
    #[serde(alias = "y_m")]
    y: f64,
    #[serde(default)]
    floor: Option<i32>,
}

/// The readings of a file by floor, in its order.
pub(super) fn read(mut file: impl Read) -> Result<BTreeMap<i32, Vec<Reading>>> {
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    let rows = rows_of_log(&String::from_utf8_lossy(&bytes));
    let csv = rows.as_ref().map_or(&bytes[..], String::as_bytes);
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(csv);
    ensure!(
        !csv.trim_ascii().is_empty(),
        "it is empty: the names of the columns come first, such as x,y,beacon,rssi"
    );
    let headers = reader.headers().context("line 1")?.clone();
    let beacons = beacons(&headers);
    let mut floors: BTreeMap<i32, Vec<Reading>> = BTreeMap::new();
    let mut record = StringRecord::new();
    // The errors of the reader name their lines themselves.
    while reader.read_record(&mut record)? {
        // A record begins with the blank lines before it.
        let begins = record.position().map_or(0, csv::Position::line);
        let line = begins.max(reader.position().line() - 1);
        let (place, readings) = row(&record, &headers, &beacons)
            .map_err(|error| anyhow::anyhow!("line {line}: {error:#}"))?;
        for (name, value) in [("x", place.x), ("y", place.y)] {
            ensure!(value.is_finite(), "line {line}: {name} is not finite");
            ensure!(
                value.abs() <= f64::from(Lattice::MAX_COORDINATE_M),
                "line {line}: {name} is more than 1000 km from the origin"
            );
        }
        for reading in &readings {
            ensure!(reading.rssi.is_finite(), "line {line}: rssi is not finite");
        }
        let of_floor = floors.entry(place.floor.unwrap_or(0)).or_default();
        of_floor.extend(readings);
    }
    ensure!(
        !floors.is_empty(),
        "there is no row below the names of the columns"
    );
    Ok(floors)
}

/// The readings of a survey in the log of a gateway, as CSV; none if it is no log. Sentences that are damaged, and others, are
/// left out.
fn rows_of_log(log: &str) -> Option<String> {
    let reading = |line: &str| {
        // A time or a word may stand before it.
        let (_, sentence) = line.trim().rsplit_once('$')?;
        let (payload, stated) = sentence.split_once('*')?;
        let sum = payload.bytes().fold(0, |sum, byte| sum ^ byte);
        let fields = payload.strip_prefix("PFOXV,")?;
        let is_right = u8::from_str_radix(stated, 16) == Ok(sum);
        (is_right && fields.split(',').count() == 5).then(|| fields.to_owned())
    };
    let readings: Vec<String> = log.lines().filter_map(reading).collect();
    let header = "x,y,floor,beacon,rssi";
    (!readings.is_empty()).then(|| format!("{header}\n{}\n", readings.join("\n")))
}

/// The columns of a file of poses that hold the strength of a beacon, and its identifier.
fn beacons(headers: &StringRecord) -> Vec<(usize, u32)> {
    let columns = headers.iter().enumerate();
    let beacon = |(column, name): (usize, &str)| {
        let name = name.strip_prefix("rssi_")?;
        let name = name.strip_suffix("_dbm").unwrap_or(name);
        Some((column, name.parse().ok()?))
    };
    columns.filter_map(beacon).collect()
}

fn row(
    record: &StringRecord,
    headers: &StringRecord,
    beacons: &[(usize, u32)],
) -> Result<(Place, Vec<Reading>)> {
    let named = |error: csv::Error| anyhow::anyhow!("{}", cause(&error, headers));
    if beacons.is_empty() {
        let reading: Reading = record.deserialize(Some(headers)).map_err(named)?;
        let place: Place = record.deserialize(Some(headers)).map_err(named)?;
        return Ok((place, vec![reading]));
    }
    let place: Place = record.deserialize(Some(headers)).map_err(named)?;
    let mut readings = Vec::new();
    for (column, beacon) in beacons {
        let field = record.get(*column).unwrap_or_default();
        if !field.is_empty() {
            let rssi = field
                .parse()
                .with_context(|| headers[*column].to_string())?;
            readings.push(Reading {
                x: place.x,
                y: place.y,
                beacon: *beacon,
                rssi,
            });
        }
    }
    Ok((place, readings))
}

/// What is wrong with a record, without its line.
fn cause(error: &csv::Error, headers: &csv::StringRecord) -> String {
    let csv::ErrorKind::Deserialize { err, .. } = error.kind() else {
        return error.to_string();
    };
    let column = err.field().and_then(|field| headers.get(field as usize));
    match column {
        Some(column) => format!("{column}: {}", err.kind()),
        None => err.kind().to_string(),
    }
}

/// Where beacons are, by identifier, of a CSV file with the columns `id` (or `beacon`, `sensor`), `x` and `y`.
///
/// # Errors
/// When it cannot be read.
pub fn sources(file: &Path) -> Result<BTreeMap<u32, [f64; 2]>> {
    #[derive(Deserialize)]
    struct Row {
        #[serde(alias = "beacon", alias = "sensor")]
        id: u32,
        #[serde(alias = "x_m")]
        x: f64,
        #[serde(alias = "y_m")]
        y: f64,
    }
    let named = || format!("cannot read the beacons {}", file.display());
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_path(file)
        .with_context(named)?;
    let rows = reader.deserialize().map(|row| {
        let Row { id, x, y } = row?;
        Ok((id, [x, y]))
    });
    rows.collect::<Result<_>>().with_context(named)
}
