//! `foxhunt compare`: several configurations on one log or scenario.

use std::{
    fs,
    path::{Path, PathBuf},
    time::Instant,
};

use anyhow::{Context, Result, bail, ensure};
use clap::Parser;
use comfy_table::{Table, presets::ASCII_MARKDOWN};
use foxhunt_host::{
    archive::{Archive, coordinates},
    geodesy::Place,
    picture,
};
use serde::Serialize;

use super::{
    failure::NothingUsed,
    replay::{self, Told},
    scenario,
};
use crate::screen;

/// Compare configurations on one log or scenario: a table, and a picture of each
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  foxhunt compare two.nmea --with \"--locator single\" --with \"--locator robust --bias-sigma 6\"\n  \
                  foxhunt compare scenario.toml\n\n\
                  Every --with holds options of `foxhunt replay`. Without any, the locators are compared."
)]
pub struct Options {
    /// The logs, one raw log, or a scenario of a drive as of `foxhunt simulate`: a TOML file.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// The seed of a scenario, in place of its own.
    #[arg(long, value_name = "SEED")]
    scenario_seed: Option<u64>,
    /// Several logs are of one line.
    #[arg(long)]
    one_line: bool,
    /// Options of one configuration.
    #[arg(long = "with", value_name = "OPTIONS", allow_hyphen_values = true)]
    with: Vec<String>,
    /// Where the pictures are written: a directory, made if need be [default: compare/].
    #[arg(long, short, value_name = "DIRECTORY")]
    output: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// A row of the table.
#[derive(Debug, Serialize)]
struct Row {
    options: String,
    bearings: usize,
    /// The bearing with which the first fix came.
    first_fix: Option<u32>,
    sources: usize,
    latitude: Option<f64>,
    longitude: Option<f64>,
    semi_major_m: Option<f64>,
    semi_minor_m: Option<f64>,
    /// If the log says where the source is.
    error_m: Option<f64>,
    seconds: f64,
    picture: Option<PathBuf>,
}

/// Options of a replay alone.
#[derive(Parser)]
#[command(name = "foxhunt replay", no_binary_name = true)]
struct One {
    #[command(flatten)]
    told: Told,
}

/// Runs the command.
pub fn run(options: &Options) -> Result<()> {
    let mut with = options.with.clone();
    if with.is_empty() {
        let kinds = ["plain", "single", "moving", "robust"];
        with = kinds.map(|kind| format!("--locator {kind}")).to_vec();
    }
    let told: Vec<Told> = with
        .iter()
        .map(|text| {
            let one = One::try_parse_from(text.split_whitespace());
            one.map(|one| one.told)
                .with_context(|| format!("--with \"{text}\""))
        })
        .collect::<Result<_>>()?;
    let directory = options.output.clone().unwrap_or_else(|| "compare".into());
    let files = logs(options, &directory)?;
    let bar = screen::percent("replaying");
    let mut rows = Vec::new();
    for (index, (text, told)) in with.iter().zip(&told).enumerate() {
        let picture = directory.join(format!("{}", index + 1));
        rows.push(row(&files, options.one_line, text, told, &picture)?);
        bar.set_position((100 * (index + 1) / with.len()) as u64);
    }
    bar.finish_and_clear();
    if options.json {
        screen::json(&rows)?;
    } else {
        screen::line(table(&rows))?;
        for row in &rows {
            if let Some(picture) = &row.picture {
                screen::line(format_args!("{}: {}", row.options, picture.display()))?;
            }
        }
    }
    if rows.iter().all(|row| row.bearings == 0) {
        bail!(NothingUsed("no bearing was used".into()));
    }
    Ok(())
}

/// The logs; that of a scenario is written beside the pictures.
fn logs(options: &Options, directory: &Path) -> Result<Vec<PathBuf>> {
    let log = |file: &PathBuf| -> Result<PathBuf> {
        if !scenario::is_scenario(file) {
            return Ok(file.clone());
        }
        let name = file.display().to_string();
        let scenario::Told::Drive(mut drive) = scenario::read(&name)? else {
            bail!("{name} is no drive: only bearings can be compared");
        };
        drive.seed = options.scenario_seed.unwrap_or(drive.seed);
        let bytes = scenario::log(&drive).with_context(|| name.clone())?;
        let stem = file.file_stem().unwrap_or_default();
        let log = directory.join(stem).with_extension("log");
        fs::create_dir_all(directory)
            .and_then(|()| fs::write(&log, bytes))
            .with_context(|| format!("cannot write {}", log.display()))?;
        Ok(log)
    };
    let files: Vec<PathBuf> = options.files.iter().map(log).collect::<Result<_>>()?;
    let is_told = options.scenario_seed.is_none() || files != options.files;
    ensure!(is_told, "--scenario-seed is of no use without a scenario");
    Ok(files)
}

fn row(files: &[PathBuf], one_line: bool, text: &str, told: &Told, picture: &Path) -> Result<Row> {
    let begin = Instant::now();
    let (engine, _) = replay::read(files, one_line, told, &mut |_, _| Ok(()))
        .with_context(|| format!("with {text}"))?;
    let mut row = Row {
        options: text.to_owned(),
        bearings: 0,
        first_fix: None,
        sources: 0,
        latitude: None,
        longitude: None,
        semi_major_m: None,
        semi_minor_m: None,
        error_m: None,
        seconds: begin.elapsed().as_secs_f64(),
        picture: None,
    };
    let Ok(archive) = engine.archive() else {
        return Ok(row);
    };
    row.bearings = archive.bearings.len();
    let first = archive
        .answers
        .iter()
        .find(|known| !known.sources.is_empty());
    row.first_fix = first.map(|known| known.bearings);
    row.sources = archive.last().sources.len();
    best(&archive, &mut row);
    picture::save(&archive.map(text).svg()?, picture)?;
    row.picture = Some(picture.with_extension("svg"));
    Ok(row)
}

/// The best known source, and how far it is from the nearest that the log tells of.
fn best(archive: &Archive, row: &mut Row) {
    let last = archive.last();
    let Some(source) = last.sources.first() else {
        return;
    };
    let ellipse = source.fix.ellipse(0.95);
    row.semi_major_m = Some(rounded(ellipse.semi_major));
    row.semi_minor_m = Some(rounded(ellipse.semi_minor));
    if let Some([longitude, latitude]) = coordinates(&last.plane, source.fix.position) {
        (row.latitude, row.longitude) = (Some(latitude), Some(longitude));
        let place = Place {
            latitude,
            longitude,
        };
        let distance = |truth: &Place| {
            let [east, north] = place.local(*truth);
            east.hypot(north)
        };
        let nearest = archive.truths.iter().map(distance).min_by(f64::total_cmp);
        row.error_m = nearest.map(|error| rounded(error as f32));
    }
}

fn rounded(metres: f32) -> f64 {
    (f64::from(metres) * 10.0).round() / 10.0
}

fn table(rows: &[Row]) -> Table {
    let mut table = Table::new();
    table.load_style(ASCII_MARKDOWN).set_header([
        "options",
        "bearings",
        "first fix",
        "sources",
        "95 % ellipse, m",
        "error, m",
        "seconds",
    ]);
    let number = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.1}"));
    for row in rows {
        table.add_row([
            row.options.clone(),
            row.bearings.to_string(),
            row.first_fix
                .map_or("-".into(), |bearing| bearing.to_string()),
            row.sources.to_string(),
            format!(
                "{} by {}",
                number(row.semi_major_m),
                number(row.semi_minor_m)
            ),
            number(row.error_m),
            format!("{:.2}", row.seconds),
        ]);
    }
    table
}
