//! `foxhunt simulate`: logs of drives that nobody has driven.

use std::{fs, path::PathBuf};

use anyhow::{Context, Result};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use foxhunt_host::{drive::EXAMPLE_SEED, packets, scripts::Script};
use foxhunt_simulation::people;
use serde_json::json;

use crate::screen;

/// Simulate a drive, or people in a tunnel, and write what a receiver, a direction finder or radios would have sent
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  foxhunt simulate two-sources --output two.nmea\n  foxhunt replay two.nmea"
)]
pub struct Options {
    /// What happens.
    #[arg(value_parser = scenario())]
    scenario: Scenario,
    /// The seed of its errors [default: 1, of `drive` that of the drive that comes with the project].
    #[arg(long, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// The file to write it to; overwritten if there is one. Of a tunnel, the radio map is written beside it, as .map.
    #[arg(long, short)]
    output: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Scenario {
    Drive,
    Script(Script),
    Tunnel,
}

fn scenario() -> impl TypedValueParser<Value = Scenario> {
    let scripts = Script::ALL.map(Script::name);
    let names = ["drive", "tunnel"].into_iter().chain(scripts);
    PossibleValuesParser::new(names).map(|name| match name.as_str() {
        "drive" => Scenario::Drive,
        name => {
            let mut all = Script::ALL.into_iter();
            all.find(|script| script.name() == name)
                .map_or(Scenario::Tunnel, Scenario::Script)
        }
    })
}

/// Runs the command.
pub fn run(options: &Options) -> Result<()> {
    let seed = options.seed.unwrap_or(match options.scenario {
        Scenario::Drive => EXAMPLE_SEED,
        Scenario::Tunnel => people::EXAMPLE_SEED,
        Scenario::Script(_) => 1,
    });
    let mut files = Vec::new();
    let mut write = |file: PathBuf, bytes: &[u8]| -> Result<()> {
        let name = file.display();
        fs::write(&file, bytes).with_context(|| format!("cannot write {name}"))?;
        if !options.json {
            screen::line(format_args!("{name}: {} bytes, seed {seed}", bytes.len()))?;
        }
        files.push(json!({"file": file, "bytes": bytes.len()}));
        Ok(())
    };
    let output = options.output.clone();
    match options.scenario {
        Scenario::Drive => write(output, foxhunt_host::drive::example(seed).bytes())?,
        Scenario::Script(script) => write(output, script.scene(seed).drive.bytes())?,
        Scenario::Tunnel => {
            let scene = packets::example(seed);
            let map = output.with_extension("map");
            write(output, &scene.recording.line_bytes())?;
            write(map, &scene.map)?;
        }
    }
    if options.json {
        screen::json(&json!({"seed": seed, "files": files}))?;
    }
    Ok(())
}
