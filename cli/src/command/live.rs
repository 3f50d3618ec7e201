//! `foxhunt live`: a search as it happens.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use serde_json::json;

use super::summary;
use crate::{
    input::Demo,
    live::{self, Extra},
    screen,
    settings::{Input, Name, Settings},
    wrong::address,
};

/// Locate live: read receivers and direction finders, show a page, and tell other programs
///
/// What comes in and where results go is told by a settings file, which `foxhunt init` writes. Without one, lines are read from
/// the standard input. It runs until Ctrl-C.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  foxhunt live --demo\n  foxhunt live foxhunt.toml\n  cat drive.nmea | foxhunt live --until-end"
)]
pub struct Options {
    /// The settings.
    file: Option<PathBuf>,
    /// Simulate a drive past two transmitters, and people in a tunnel, in place of the inputs.
    #[arg(long)]
    demo: bool,
    /// How many times as fast as it was the demo runs.
    #[arg(long, requires = "demo", default_value_t = 1.0, value_parser = speed)]
    speed: f64,
    /// Seeds the errors of the demo.
    #[arg(long, requires = "demo", default_value_t = 1)]
    seed: u64,
    /// Where the page is served, in place of what the settings say: an address and a port.
    #[arg(long, value_name = "ADDRESS", value_parser = listen)]
    listen: Option<String>,
    /// Serve no page.
    #[arg(long, conflicts_with = "listen")]
    no_page: bool,
    /// Write the raw log to this file, in place of what the settings say.
    #[arg(long, value_name = "FILE")]
    log: Option<PathBuf>,
    /// End when all inputs have ended, as of a file on the standard input.
    #[arg(long)]
    until_end: bool,
    /// Only say whether the settings are right, and what they say.
    #[arg(long)]
    check: bool,
    /// Print JSON at the end.
    #[arg(long)]
    json: bool,
}

fn speed(text: &str) -> Result<f64> {
    let speed: f64 = text.parse().context("a number")?;
    anyhow::ensure!(speed > 0.0 && speed <= 1_000.0, "from above 0 to 1000");
    Ok(speed)
}

fn listen(text: &str) -> Result<String> {
    match address("listen", text) {
        Ok(()) => Ok(text.to_owned()),
        Err(wrong) => bail!(wrong.what),
    }
}

/// Runs the command.
pub fn run(options: &Options) -> Result<()> {
    let mut settings = match &options.file {
        Some(file) => Settings::read(file)?,
        None => Settings::default(),
    };
    let mut extra = Extra {
        demo: None,
        until_end: options.until_end,
    };
    if options.demo {
        settings = Demo::settings(settings);
        extra.demo = Some(Demo {
            speed: options.speed,
            seed: options.seed,
        });
    } else if options.file.is_none() {
        settings.input.push(Input {
            name: Name::try_from("stdin".to_owned()).unwrap_or_default(),
            stdin: Some(true),
            ..Input::default()
        });
    }
    if let Some(listen) = &options.listen {
        settings.web.listen.clone_from(listen);
        settings.web.enabled = true;
    }
    settings.web.enabled &= !options.no_page;
    if let Some(file) = &options.log {
        settings.set_log(file);
    }
    if options.check {
        live::check(&settings)?;
        return said(options.file.as_deref(), &settings);
    }
    if settings.input.is_empty() {
        eprintln!("{NOTHING}");
    }
    let engine = live::run(&settings, extra)?;
    let archive = engine.archive().ok();
    if options.json {
        let fixes = archive.as_ref().map(|archive| archive.fix_rows());
        let last = archive
            .as_ref()
            .map_or(0, |archive| archive.last().sources.len().max(1));
        let fixes = fixes.map(|rows| rows.into_iter().rev().take(last).rev().collect::<Vec<_>>());
        return screen::json(&json!({
            "lines": summary::object(engine.counters()), "fixes": fixes.unwrap_or_default(),
        }));
    }
    if engine.counters().lines > 0 {
        eprintln!("{}", summary::table(engine.counters()));
    }
    for (input, heard) in settings.input.iter().zip(engine.heard()) {
        let refused = heard.refused.iter();
        let refused: String = refused
            .map(|(reason, count)| format!(", {count} not used: {reason}"))
            .collect();
        eprintln!(
            "{}: {} lines, {} used{refused}",
            &*input.name, heard.lines, heard.used
        );
    }
    if let Some(archive) = archive {
        eprint!("{}", summary::answer(&archive));
    }
    Ok(())
}

/// Said where there is no input.
const NOTHING: &str = "nothing comes in: the settings have no [[input]]";

/// Says what the settings say.
fn said(file: Option<&Path>, settings: &Settings) -> Result<()> {
    match file {
        Some(file) => screen::line(format_args!("{}: all right", file.display()))?,
        None => screen::line("no settings: what holds without any; `foxhunt init` writes some")?,
    }
    if settings.input.is_empty() {
        screen::line(NOTHING)?;
    }
    for input in &settings.input {
        let of = input
            .site
            .as_ref()
            .map(|site| format!(", tags of {}", &**site));
        let (name, of) = (&*input.name, of.unwrap_or_default());
        screen::line(format_args!("input {name}: {}{of}", input.source()?))?;
    }
    for output in &settings.output {
        screen::line(format_args!("output {}: {}", &*output.name, output.sink()?))?;
    }
    if let Some(log) = &settings.log {
        screen::line(format_args!("log: {}", log.file.display()))?;
    }
    if settings.web.enabled {
        screen::line(format_args!("page: {}", settings.web.listen))?;
    }
    Ok(())
}
