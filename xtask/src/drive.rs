//! The task `drive`: remakes the drive that comes with the project, or writes another.

use std::{fs, path::PathBuf};

use anyhow::{Context, Result};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use foxhunt_host::{
    drive::{EXAMPLE_SEED, example},
    scripts::Script,
};

use crate::project;

/// The drive that comes with the project.
pub const EXAMPLE: &str = "examples/data/drive.nmea";

/// The options of `cargo xtask drive`.
#[derive(clap::Args)]
pub struct Options {
    /// A drive on which this happens. Unless given, the drive that comes with the project is made, and
    /// examples/data/drive.nmea overwritten by it.
    #[arg(long, value_parser = script(), requires = "output")]
    script: Option<Script>,
    /// The seed of its errors.
    #[arg(
        long,
        default_value_t = 1,
        requires = "script",
        allow_negative_numbers = true
    )]
    seed: u64,
    /// The file to write it to; overwritten if there is one.
    #[arg(long, requires = "script")]
    output: Option<PathBuf>,
}

fn script() -> impl TypedValueParser<Value = Script> {
    let names = Script::ALL.map(Script::name);
    PossibleValuesParser::new(names).map(|name| {
        let mut all = Script::ALL.into_iter();
        all.find(|script| script.name() == name)
            .expect("it is one of these names")
    })
}

/// Simulates the drive and writes its file.
pub fn run(options: &Options) -> Result<()> {
    let (drive, file, seed) = match (options.script, &options.output) {
        (Some(script), Some(file)) => {
            let scene = script.scene(options.seed);
            (scene.drive, file.clone(), options.seed)
        }
        _ => {
            let file = project::root().join(EXAMPLE);
            (example(EXAMPLE_SEED), file, EXAMPLE_SEED)
        }
    };
    let name = file.display();
    fs::write(&file, drive.bytes()).with_context(|| format!("cannot write {name}"))?;
    println!("{name}: {} bytes, seed {seed}", drive.bytes().len());
    Ok(())
}
