//! The options of a recipe.

use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use foxhunt::fingerprint;
use foxhunt_host::radio_map::{self, Recipe, Shape};

/// How a map is made.
#[derive(clap::Args)]
pub struct Options {
    /// Metres from one point of the map to the next [default: by the survey].
    #[arg(long, value_name = "METRES")]
    spacing: Option<f64>,
    /// Side of the cells in which places are put together, 0 for none [default: by the survey].
    #[arg(long, value_name = "METRES")]
    cell: Option<f64>,
    /// Distance over which the strengths of the beacons are alike; with --field-noise [default: by the survey].
    #[arg(long, value_name = "METRES", requires = "field_noise")]
    field_length: Option<f64>,
    /// Fraction of the variance of the strengths that is noise of single places [default: by the survey].
    #[arg(long, value_name = "FRACTION", requires = "field_length")]
    field_noise: Option<f64>,
    /// Standard deviation of the map's error where the survey has been [default: by the survey].
    #[arg(long, value_name = "DB")]
    sigma: Option<f64>,
    /// Distance over which the map's error is alike [default: by the survey].
    #[arg(long, value_name = "METRES")]
    length: Option<f64>,
    /// Standard deviation of a packet at one place [default: by the survey].
    #[arg(long, value_name = "DB")]
    packet_sigma: Option<f64>,
    /// Points further than this from the survey are impossible [default: none is].
    #[arg(long, value_name = "METRES")]
    reach: Option<f64>,
    /// Where beacons are: CSV with the columns id, x and y.
    #[arg(long, value_name = "FILE")]
    beacons: Option<PathBuf>,
    /// The day of the survey.
    #[arg(long, value_name = "YYYY-MM-DD", value_parser = days)]
    date: Option<u32>,
    /// What the map holds of each beacon at each point.
    #[arg(long, value_enum, default_value_t = Encoding::Moments)]
    encoding: Encoding,
    /// Width of the kernel of levels, in dB: how much a scan differs from a survey.
    #[arg(long, value_name = "DB", default_value_t = Recipe::default().bandwidth_db)]
    bandwidth: f64,
    /// How many levels there are.
    #[arg(long, value_name = "NUMBER", default_value_t = Recipe::default().levels)]
    levels: u8,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum Encoding {
    /// Mean and sigma, in two bytes: what the tracker needs.
    Moments,
    /// The logarithm of a kernel density by level: what the table matcher needs.
    Levels,
}

impl Options {
    /// What they state.
    ///
    /// # Errors
    /// If the file of the beacons cannot be read.
    pub fn recipe(&self) -> Result<Recipe> {
        let sources = match &self.beacons {
            Some(file) => radio_map::sources(file)?,
            None => Default::default(),
        };
        let shape = self.field_length.zip(self.field_noise);
        Ok(Recipe {
            spacing_m: self.spacing,
            cell_m: self.cell,
            shape: shape.map(|(length_m, noise)| Shape { length_m, noise }),
            sigma_db: self.sigma,
            length_m: self.length,
            packet_sigma_db: self.packet_sigma,
            reach_m: self.reach,
            sources,
            days: self.date,
            encoding: match self.encoding {
                Encoding::Moments => fingerprint::Encoding::Moments,
                Encoding::Levels => fingerprint::Encoding::Levels,
            },
            bandwidth_db: self.bandwidth,
            levels: self.levels,
            ..Recipe::default()
        })
    }
}

/// Days since 1970-01-01 of a date of the Gregorian calendar.
fn days(date: &str) -> Result<u32> {
    let parts: Vec<i64> = date
        .split('-')
        .map(|part| part.parse().with_context(|| format!("{date} is no date")))
        .collect::<Result<_>>()?;
    let [year, month, day] = parts[..] else {
        bail!("{date} is not of the form YYYY-MM-DD");
    };
    if !(1970..=9999).contains(&year) || !(1..=12).contains(&month) || !(1..=31).contains(&day) {
        bail!("{date} is no date since 1970");
    }
    // Years begin in March, so that the leap day is the last.
    let shifted = year - i64::from(month <= 2);
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    let days = 365 * shifted + shifted / 4 - shifted / 100 + shifted / 400 + of_year - 719_468;
    u32::try_from(days).with_context(|| format!("{date} is no date since 1970"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_those_of_the_calendar() {
        for (date, expected) in [
            ("1970-01-01", 0),
            ("2000-02-29", 11_016),
            ("2026-11-27", 20_784),
        ] {
            assert_eq!(days(date).unwrap(), expected, "{date}");
        }
        for wrong in ["2026-13-01", "2026-11", "yesterday", "1969-12-31"] {
            assert!(days(wrong).is_err(), "{wrong}");
        }
    }
}
