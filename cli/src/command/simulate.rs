//! `foxhunt simulate`: logs of drives that nobody has driven.

use std::{fs, path::PathBuf};

use anyhow::{Context, Result};
use foxhunt_host::{drive, packets, scripts::Script};
use foxhunt_simulation::people;
use serde_json::json;

use super::scenario::{self, Told};
use crate::screen;

/// Simulate a drive, or people in a tunnel or a building, and write what a receiver, a direction finder or radios would have sent
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  foxhunt simulate two-sources --output two.nmea\n  foxhunt replay two.nmea\n\n\
                  A scenario of your own, scenario.toml:\n  seed = 1\n  interval_s = 3.0\n  sigma_rad = 0.05\n  \
                  outlier_rate = 0.05\n  mirrored_rate = 0.0\n  bias_rad = 0.0\n  [vehicle]\n  \
                  corners = [[0.0, 0.0], [1500.0, 0.0], [1500.0, 1500.0]]\n  speed_m_s = 12.0\n  start_s = 0.0\n  \
                  [[sources]]\n  corners = [[900.0, 1000.0]]\n  speed_m_s = 1.0\n  start_s = 0.0\n\n\
                  People in a tunnel, each on a way of their own:\n  [tunnel]\n  seed = 1\n  [[tunnel.people]]\n  \
                  tag = 7\n  way = { corners = [[2.0, 1.2], [74.0, 1.2]], speed_m_s = 1.2, start_s = 0.0 }\n\n\
                  People who go from room to room in a building of three floors:\n  [building]\n  seed = 1\n  \
                  people = 3\n  seconds = 300.0"
)]
pub struct Options {
    /// What happens: drive, tunnel, outage, frozen-course, departure, two-sources; or a scenario in a TOML file.
    scenario: String,
    /// The seed of its errors [default: 1; of `drive` and `tunnel` that of the files that come with the project; of a scenario its
    /// own].
    #[arg(long, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// The file to write it to; overwritten if there is one. Beside it are written, of a tunnel the radio
    /// map, as .map, and of a building the survey, as .csv.
    #[arg(long, short)]
    output: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(options: &Options) -> Result<()> {
    let output = options.output.clone();
    let scripted = Script::ALL
        .into_iter()
        .find(|script| script.name() == options.scenario);
    let (seed, files) = match (&*options.scenario, scripted) {
        ("drive", _) => {
            let seed = options.seed.unwrap_or(drive::EXAMPLE_SEED);
            (seed, vec![(output, drive::example(seed).bytes().to_vec())])
        }
        ("tunnel", _) => {
            let seed = options.seed.unwrap_or(people::EXAMPLE_SEED);
            let scene = packets::example(seed);
            let map = output.with_extension("map");
            let lines = scene.recording.line_bytes();
            (seed, vec![(output, lines), (map, scene.map)])
        }
        (_, Some(script)) => {
            let seed = options.seed.unwrap_or(1);
            let bytes = script.scene(seed).drive.bytes().to_vec();
            (seed, vec![(output, bytes)])
        }
        (file, None) => of_file(file, options.seed, output)?,
    };
    for (file, bytes) in &files {
        let name = file.display();
        fs::write(file, bytes).with_context(|| format!("cannot write {name}"))?;
        if !options.json {
            screen::line(format_args!("{name}: {} bytes, seed {seed}", bytes.len()))?;
        }
    }
    if options.json {
        let files = files
            .iter()
            .map(|(file, bytes)| json!({"file": file, "bytes": bytes.len()}));
        screen::json(&json!({"seed": seed, "files": files.collect::<Vec<_>>()}))?;
    }
    Ok(())
}

/// What is written, and where.
type Files = Vec<(PathBuf, Vec<u8>)>;

/// The seed and the files of a scenario in a file.
fn of_file(file: &str, seed: Option<u64>, output: PathBuf) -> Result<(u64, Files)> {
    let named = || file.to_owned();
    Ok(match scenario::read(file)? {
        Told::Drive(mut drive) => {
            drive.seed = seed.unwrap_or(drive.seed);
            (
                drive.seed,
                vec![(output, scenario::log(&drive).with_context(named)?)],
            )
        }
        Told::Tunnel(mut tunnel) => {
            tunnel.seed = seed.unwrap_or(tunnel.seed);
            let scene = tunnel.scene().with_context(named)?;
            let map = (output.with_extension("map"), scene.map);
            let lines = scene.recording.line_bytes();
            (tunnel.seed, vec![(output, lines), map])
        }
        Told::Building(mut building) => {
            building.seed = seed.unwrap_or(building.seed);
            let floors = building.floors().with_context(named)?;
            let survey = (output.with_extension("csv"), floors.survey.into_bytes());
            let lines = floors.recording.line_bytes();
            (building.seed, vec![(output, lines), survey])
        }
    })
}
