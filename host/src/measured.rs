//! Bearings from the field, turned into a drive.
//!
//! The files are those of the WSR toolbox data set (Harvard REACT): angles of arrival of Wi-Fi signals,
//! measured by moving robots, with the true places from a camera system.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use serde::Deserialize;

use crate::{
    drive::{self, Drive, Reading},
    geodesy::Place,
};

/// Standard deviation of measured bearings unless told otherwise, in degrees: where the sight was free, 90 % of the bearings
/// of the WSR set are within 6.6 degrees, as those of a normal distribution with this sigma are.
pub const SIGMA_DEGREES: f64 = 4.0;

/// The bearings on one transmitter.
#[derive(Debug, Clone)]
pub struct Measured {
    /// True place of the transmitter, in metres.
    pub transmitter: [f64; 2],
    /// Where each bearing was taken, in metres, and the bearing, in degrees counter-clockwise from +x.
    pub bearings: Vec<([f64; 2], f64)>,
}

#[derive(Deserialize)]
struct Row {
    tx: String,
    tx_x_m: f64,
    tx_y_m: f64,
    rx_x_m: f64,
    rx_y_m: f64,
    azimuth_deg: f64,
}

/// Where the origin of the measured coordinates is put; any place would do.
const ORIGIN: Place = Place {
    latitude: 42.377,
    longitude: -71.1167,
};
/// Seconds from one stop to the next.
const PAUSE: f64 = 2.0;

impl Measured {
    /// Reads the bearings on `transmitter` from a file of the set.
    ///
    /// # Errors
    /// If the file is not of that form, or knows no such transmitter; the error names those it knows.
    pub fn read(file: &Path, transmitter: &str) -> Result<Self> {
        let mut reader = csv::Reader::from_path(file)
            .with_context(|| format!("cannot read {}", file.display()))?;
        let rows: Vec<Row> = reader
            .deserialize()
            .collect::<Result<_, _>>()
            .with_context(|| format!("{} is not a file of bearings", file.display()))?;
        let of_transmitter: Vec<&Row> = rows.iter().filter(|row| row.tx == transmitter).collect();
        let mut names: Vec<&str> = rows.iter().map(|row| row.tx.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        ensure!(
            !of_transmitter.is_empty(),
            "{} has no transmitter {transmitter}; it has {}",
            file.display(),
            names.join(", ")
        );
        Ok(Self {
            transmitter: [of_transmitter[0].tx_x_m, of_transmitter[0].tx_y_m],
            bearings: of_transmitter
                .iter()
                .map(|row| ([row.rx_x_m, row.rx_y_m], row.azimuth_deg))
                .collect(),
        })
    }

    /// The drive that stops at every place, heading north, and takes its bearing there. The quality of
    /// the bearings is the one that the gateway takes for a standard deviation of `sigma_degrees`.
    ///
    /// # Errors
    /// If no quality stands for that sigma.
    pub fn drive(&self, sigma_degrees: f64) -> Result<Drive> {
        let quality = quality(sigma_degrees)?;
        let mut drive = Drive::default();
        drive.truth(ORIGIN.offset(self.transmitter));
        // A receiver is on before the first bearing: its first position waits for a second.
        if let Some((position, _)) = self.bearings.first() {
            drive.position(3599.0, ORIGIN.offset(*position), 0.0, 0.0);
        }
        for (stop, (position, azimuth)) in self.bearings.iter().enumerate() {
            let time = 3600.0 + PAUSE * stop as f64;
            drive.position(time, ORIGIN.offset(*position), 0.0, 0.0);
            drive.heading(0.0);
            drive.kraken(Reading {
                time,
                degrees: 90.0 - azimuth,
                quality,
            });
        }
        Ok(drive)
    }
}

/// The quality that stands for a standard deviation, halved in between.
fn quality(sigma_degrees: f64) -> Result<f64> {
    let (mut low, mut high) = (50.0, 100.0);
    let (worst, best) = (drive::sigma_degrees(low), drive::sigma_degrees(high));
    ensure!(
        (best..=worst).contains(&sigma_degrees),
        "the gateway takes sigmas from {best:.1} to {worst:.1} degrees"
    );
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if drive::sigma_degrees(middle) > sigma_degrees {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(high)
}
