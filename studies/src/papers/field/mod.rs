//! The robust locator as it comes, where the field is not as stated: in rooms, with wrong sigmas, with errors by stop, by station
//! and by direction; beside the exact posterior that knows as much.

use anyhow::Result;
use foxhunt_host::figures::Figure;

use super::study::Study;

mod config;
mod direction;
mod rooms;
mod runs;
mod scale;
mod stations;
mod stops;

/// A part of the study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Measured bearings in rooms.
    Rooms,
    /// Wrong sigmas, and tracks of any size.
    Scale,
    /// A vehicle that stops.
    Stops,
    /// Fixed arrays.
    Stations,
    /// A bias by direction.
    Direction,
}

impl Part {
    /// All of them, with their names.
    pub const ALL: [(&str, Self); 5] = [
        ("rooms", Self::Rooms),
        ("scale", Self::Scale),
        ("stops", Self::Stops),
        ("stations", Self::Stations),
        ("direction", Self::Direction),
    ];
}

/// Prints the tables of some parts, and returns their figures.
///
/// # Errors
/// When measured data cannot be read.
pub fn run(study: &Study, parts: &[Part]) -> Result<Vec<Figure>> {
    let runs = |most: u32| study.runs.unwrap_or(1000).min(1000).div_ceil(1000 / most);
    let mut figures = Vec::new();
    for part in parts {
        figures.extend(match part {
            Part::Rooms => rooms::run(study, runs(50))?,
            Part::Scale => scale::run(runs(1000), study.seed)?,
            Part::Stops => stops::run(runs(500), study.seed)?,
            Part::Stations => stations::run(study, runs(1000))?,
            Part::Direction => direction::run(runs(500), study.seed)?,
        });
    }
    Ok(figures)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A single run of each part that needs no measured data.
    #[test]
    fn every_part_has_its_figures() {
        let study = Study {
            runs: Some(1),
            seed: 1,
            data: None,
            pictures: std::env::temp_dir(),
            board: |_| unreachable!("nothing runs on the board"),
        };
        for (name, part) in Part::ALL {
            let figures = run(&study, &[part]).unwrap();
            let prefix = format!("field.{name}.");
            assert!(
                figures
                    .iter()
                    .all(|figure| figure.name.starts_with(&prefix))
            );
            assert_eq!(figures.is_empty(), part == Part::Rooms);
        }
    }
}
