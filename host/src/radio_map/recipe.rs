//! What a map is made by: what is stated, and what was chosen.

use std::{collections::BTreeMap, fmt};

use anyhow::{Result, ensure};
use foxhunt::fingerprint::{Encoding, Lattice};

pub use super::kriging::Shape;

/// What is known beforehand. What is not stated is chosen by the survey: as it predicts places that are left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Recipe {
    /// The lattice of the map; by default it reaches over the places of the survey.
    pub lattice: Option<Lattice>,
    /// Metres from one point to the next, if the lattice is not stated.
    pub spacing_m: Option<f64>,
    /// Side of the cells in which places are put together, in metres: 0 for none.
    pub cell_m: Option<f64>,
    /// The covariance of the fields between the places.
    pub shape: Option<Shape>,
    /// Standard deviation of the map's error where the survey has been, in dB.
    pub sigma_db: Option<f64>,
    /// Distance over which the correlation of the map's error falls to 1 / e, in metres.
    pub length_m: Option<f64>,
    /// Standard deviation of a packet about the mean at its place, in dB.
    pub packet_sigma_db: Option<f64>,
    /// Points further than this from any place of the survey are impossible: by default none. Where nobody has been, a map
    /// is uncertain; what is impossible is for walls to say.
    pub reach_m: Option<f64>,
    /// Where beacons are, in metres, by identifier, as far as that is known: between the places of the survey and beyond
    /// them, the level of those is expected to fall with the logarithm of the distance.
    pub sources: BTreeMap<u32, [f64; 2]>,
    /// When the survey was made, in days since 1970-01-01.
    pub days: Option<u32>,
    /// What the map holds.
    pub encoding: Encoding,
    /// Width of the kernel of [`Encoding::Levels`], in dB: besides the noise it has to cover how a scan differs from
    /// a survey.
    pub bandwidth_db: f64,
    /// Rate of the readings that may have any strength, in [`Encoding::Levels`].
    pub outliers: f64,
    /// Levels of [`Encoding::Levels`], up to 255: half a byte for each of them, each point and each beacon.
    pub levels: u8,
}

impl Default for Recipe {
    /// All by the survey, in moments; levels with a bandwidth of 4 dB, 32 of them, one outlier in a thousand.
    fn default() -> Self {
        Self {
            lattice: None,
            spacing_m: None,
            cell_m: None,
            shape: None,
            sigma_db: None,
            length_m: None,
            packet_sigma_db: None,
            reach_m: None,
            sources: BTreeMap::new(),
            days: None,
            encoding: Encoding::Moments,
            bandwidth_db: 4.0,
            outliers: 1e-3,
            levels: 32,
        }
    }
}

impl Recipe {
    /// With these points.
    pub fn on(lattice: Lattice) -> Self {
        Self {
            lattice: Some(lattice),
            ..Self::default()
        }
    }

    /// Fails with the name of an option that is out of its range.
    pub(super) fn check(&self) -> Result<()> {
        ensure!(
            self.bandwidth_db > 0.0 && self.bandwidth_db <= 50.0,
            "bandwidth must be from 0 to 50 dB"
        );
        ensure!(
            self.outliers > 0.0 && self.outliers < 0.5,
            "outliers must be from 0 to 0.5"
        );
        ensure!(self.levels >= 2, "levels is below 2");
        for (name, value, most) in [
            ("cell", self.cell_m, 1e3),
            ("sigma", self.sigma_db, 15.0),
            ("length", self.length_m, 1e4),
            ("packet sigma", self.packet_sigma_db, 60.0),
            ("reach", self.reach_m, 1e6),
        ] {
            ensure!(
                value.is_none_or(|value| (0.0..=most).contains(&value)),
                "{name} must be from 0 to {most}"
            );
        }
        Ok(())
    }

    /// What was chosen by hand, as in the header of a map.
    pub(super) fn by_hand(&self) -> u8 {
        let stated = [
            self.lattice.is_some() || self.spacing_m.is_some(),
            self.cell_m.is_some(),
            self.shape.is_some(),
            self.sigma_db.is_some(),
            self.length_m.is_some(),
            self.packet_sigma_db.is_some(),
        ];
        let bits = stated.into_iter().enumerate();
        bits.fold(0, |byte, (bit, stated)| byte | u8::from(stated) << bit)
    }
}

/// What was chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Choices {
    /// Side of the cells, in metres; none where each place is a cell of its own.
    pub cell_m: Option<f64>,
    /// How many cells have readings.
    pub cells: usize,
    /// The covariance of the fields.
    pub shape: Shape,
    /// Standard deviation of the fields, in dB: of the map's error where nobody has been.
    pub field_sigma_db: f64,
    /// Standard deviation of the map's error where the survey has been, in dB.
    pub sigma_db: f64,
    /// Distance over which the correlation of the map's error falls to 1 / e, in metres.
    pub length_m: f64,
    /// Standard deviation of a packet about the mean at its place, in dB.
    pub packet_sigma_db: f64,
    /// How far from a place of the survey that still tells something, in metres.
    pub reach_m: f64,
    /// Root mean square, in dB, of how far the mean level at a place is from what places outside of its block predict.
    pub left_out_db: f64,
}

impl fmt::Display for Choices {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cells = match self.cell_m {
            Some(cell) => format!("cells of {cell} m"),
            None => "places".to_owned(),
        };
        write!(
            f,
            "{} {cells}; places that are left out with their neighbours are predicted to {:.2} dB; sigma of a packet {:.2} dB, \
             of the map {:.2} dB where the survey was, up to {:.2} dB elsewhere, from {:.1} m on; length of its error {:.2} m",
            self.cells,
            self.left_out_db,
            self.packet_sigma_db,
            self.sigma_db,
            self.sigma_db.hypot(self.field_sigma_db),
            self.reach_m,
            self.length_m,
        )
    }
}
