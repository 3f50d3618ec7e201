//! `foxhunt survey`: from places where a tag was heard to a radio map, for the flash of a gateway.

mod line;
mod recipe;
mod record;
mod send;

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail};
use foxhunt::fingerprint::{Lattice, RadioMap};
use foxhunt_host::{
    picture::{self, Heat},
    radio_map::{Expected, Made, Recipe, SiteSurvey, rust_constant},
};
use serde_json::{Value, json};

use crate::screen;

/// Record a survey, check it, make a radio map of it, predict how well it will find tags, or send it to a gateway
#[derive(clap::Subcommand)]
pub enum Command {
    /// Record a survey, by a gateway that hears a tag at one place after another
    #[command(
        after_help = "Each line of the input is a place: x y in metres, or x y floor. An empty line ends the survey.\n\n\
                      Example:\n  foxhunt survey record survey.csv --serial /dev/ttyACM0 --tag 7"
    )]
    Record(record::Record),
    /// Say what a survey holds, and what it lacks
    #[command(after_help = "Example:\n  foxhunt survey check survey.csv")]
    Check(Check),
    /// Make a radio map of a survey
    #[command(
        after_help = "Example:\n  foxhunt survey build survey.csv --output tunnel.map --date 2026-11-27"
    )]
    Build(Build),
    /// Predict how well tags will be found by a map of the survey, and draw it
    #[command(after_help = "Example:\n  foxhunt survey predict survey.csv --picture expected.svg")]
    Predict(Predict),
    /// Send a radio map to a gateway that runs
    #[command(
        after_help = "The gateway checks the map as a whole before it takes the place of its own.\n\n\
                      Example:\n  foxhunt survey send tunnel.map --serial /dev/ttyACM0"
    )]
    Send(send::Send),
}

/// The survey.
#[derive(clap::Args)]
pub struct Check {
    /// CSV with the columns x, y (metres), beacon (a number) and rssi (dBm), a reading in each row; or x, y
    /// and rssi_1, rssi_2 and so on, a place in each row. A column floor makes a map of each floor.
    survey: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// What is predicted.
#[derive(clap::Args)]
pub struct Predict {
    #[command(flatten)]
    survey: Check,
    #[command(flatten)]
    recipe: recipe::Options,
    /// Where the picture is written, as SVG and PNG.
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
}

/// What is made.
#[derive(clap::Args)]
pub struct Build {
    #[command(flatten)]
    survey: Check,
    /// Where the map is written: as Rust if it ends in .rs, otherwise as the bytes themselves. Beside it a picture of what
    /// the map promises. A survey of several floors makes a map of each: tunnel-0.map and so on.
    #[arg(long, short, value_name = "FILE")]
    output: PathBuf,
    /// Name of the Rust constant.
    #[arg(long, value_name = "NAME", default_value = "MAP")]
    name: String,
    #[command(flatten)]
    recipe: recipe::Options,
}

/// Runs the command.
pub fn run(command: &Command) -> Result<()> {
    match command {
        Command::Check(options) => check(options),
        Command::Build(options) => build(options),
        Command::Predict(options) => predict(options),
        Command::Record(options) => record::run(options),
        Command::Send(options) => send::run(options),
    }
}

impl Check {
    /// The surveys of the floors.
    fn floors(&self) -> Result<BTreeMap<i32, SiteSurvey>> {
        let survey = self.survey.display();
        let file = fs::File::open(&self.survey).with_context(|| format!("cannot read {survey}"))?;
        SiteSurvey::floors(file).with_context(|| format!("{survey}"))
    }

    /// What a floor is called in an error.
    fn name_of(&self, floor: i32, is_one_of_several: bool) -> String {
        let file = self.survey.display();
        if is_one_of_several {
            format!("{file}: floor {floor}")
        } else {
            file.to_string()
        }
    }

    /// Prints the lines, or the JSON.
    fn say(&self, lines: &[String], value: &Value) -> Result<()> {
        if self.json {
            return screen::json(value);
        }
        lines.iter().try_for_each(screen::line)
    }
}

fn check(options: &Check) -> Result<()> {
    /// A beacon that fewer places have heard tells of too little.
    const FEW: usize = 3;
    let floors = options.floors()?;
    let several = floors.len() > 1;
    let mut faults = Vec::new();
    for (floor, survey) in floors {
        let readings = survey.survey();
        let is_heard = |place: usize, beacon: usize| !readings.samples[place][beacon].is_empty();
        let heard = |beacon: usize| {
            let places = 0..readings.places.len();
            places.filter(|place| is_heard(*place, beacon)).count()
        };
        let rarely: Vec<u32> = (survey.beacons().iter().enumerate())
            .filter(|(index, _)| heard(*index) < FEW)
            .map(|(_, beacon)| *beacon)
            .collect();
        let unheard = (0..readings.places.len())
            .filter(|place| {
                let mut beacons = 0..readings.beacons();
                !beacons.any(|beacon| is_heard(*place, beacon))
            })
            .count();
        let samples: usize = readings.samples.iter().flatten().map(Vec::len).sum();
        let mut lines = vec![format!(
            "floor {floor}: {}, {}, {}",
            counted(readings.places.len(), "place"),
            counted(survey.beacons().len(), "beacon"),
            counted(samples, "reading"),
        )];
        if survey.gated() > 0 {
            lines.push(format!(
                "  left out, as no radio measures such strengths: {}",
                counted(survey.gated(), "reading")
            ));
        }
        if !rarely.is_empty() {
            lines.push(format!(
                "  heard at fewer than {FEW} places: beacons {rarely:?}"
            ));
        }
        if unheard > 0 {
            let places = counted(unheard, "place");
            lines.push(format!("  at {places} nothing was heard"));
        }
        let fault = survey.check().err();
        let value = json!({
            "floor": floor, "places": readings.places.len(), "beacons": survey.beacons(), "readings": samples,
            "left_out": survey.gated(), "rarely_heard": rarely, "places_without_readings": unheard,
            "fault": fault.as_ref().map(|fault| format!("{fault:#}")),
        });
        options.say(&lines, &value)?;
        faults.extend(fault.map(|fault| fault.context(options.name_of(floor, several))));
    }
    // Each floor is told before the first fault.
    faults.into_iter().next().map_or(Ok(()), Err)
}

/// A number of things, in words.
fn counted(count: usize, what: &str) -> String {
    let s = if count == 1 { "" } else { "s" };
    format!("{count} {what}{s}")
}

fn build(options: &Build) -> Result<()> {
    let floors = options.survey.floors()?;
    let recipe = options.recipe.of(&floors, &options.survey)?;
    let several = floors.len() > 1;
    for (floor, survey) in floors {
        let file = if several {
            with_floor(&options.output, floor)
        } else {
            options.output.clone()
        };
        let made =
            made(&survey, &recipe).with_context(|| options.survey.name_of(floor, several))?;
        write(options, floor, &survey, &made, &file)?;
    }
    Ok(())
}

fn predict(options: &Predict) -> Result<()> {
    let floors = options.survey.floors()?;
    let recipe = options.recipe.of(&floors, &options.survey)?;
    let several = floors.len() > 1;
    for (floor, survey) in floors {
        let made =
            made(&survey, &recipe).with_context(|| options.survey.name_of(floor, several))?;
        let (mut lines, mut value) = promise(&made);
        lines.insert(0, format!("floor {floor}: {}", made.choices));
        value["floor"] = floor.into();
        if let Some(picture) = &options.picture {
            let file = if several {
                with_floor(picture, floor)
            } else {
                picture.clone()
            };
            let picture = draw(&survey, &made, &file)?;
            lines.push(format!("picture: {}", picture.display()));
            value["picture"] = json!(picture);
        }
        options.survey.say(&lines, &value)?;
    }
    Ok(())
}

impl recipe::Options {
    /// How the maps of some floors are made, all on one lattice.
    fn of(&self, floors: &BTreeMap<i32, SiteSurvey>, survey: &Check) -> Result<Recipe> {
        let mut recipe = self.recipe()?;
        if floors.len() > 1 {
            let lattice = common_lattice(&recipe, floors, survey)?;
            recipe.lattice = Some(lattice);
        }
        Ok(recipe)
    }
}

/// The lattice of all floors, with the spacing of the floor that needs the least.
fn common_lattice(
    recipe: &Recipe,
    floors: &BTreeMap<i32, SiteSurvey>,
    survey_of: &Check,
) -> Result<Lattice> {
    let spacing = match recipe.spacing_m {
        Some(spacing) => spacing,
        None => {
            let mut least = f64::INFINITY;
            for (floor, survey) in floors {
                let made = survey
                    .map(recipe, &mut |_| ())
                    .with_context(|| survey_of.name_of(*floor, true))?;
                least = least.min(made.lattice.spacing().into());
            }
            least
        }
    };
    SiteSurvey::lattice_of(floors.values(), spacing)
        .with_context(|| survey_of.survey.display().to_string())
}

/// The file of a floor: its number comes before the ending.
fn with_floor(output: &Path, floor: i32) -> PathBuf {
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    match output.extension() {
        Some(ending) => {
            output.with_file_name(format!("{stem}-{floor}.{}", ending.to_string_lossy()))
        }
        None => output.with_file_name(format!("{stem}-{floor}")),
    }
}

fn made(survey: &SiteSurvey, recipe: &Recipe) -> Result<Made> {
    let bar = screen::percent("leaving places out");
    let made = survey.map(recipe, &mut |fraction| {
        bar.set_position((100.0 * fraction) as u64)
    })?;
    bar.finish_and_clear();
    Ok(made)
}

fn write(options: &Build, floor: i32, survey: &SiteSurvey, made: &Made, file: &Path) -> Result<()> {
    let map = match RadioMap::new(&made.bytes) {
        Ok(map) => map,
        Err(error) => bail!("the map that was made is not one: {error}"),
    };
    let is_rust = file.extension().is_some_and(|extension| extension == "rs");
    let written = if is_rust {
        fs::write(file, rust_constant(&options.name, &made.bytes))
    } else {
        fs::write(file, &made.bytes)
    };
    written.with_context(|| format!("cannot write {}", file.display()))?;
    let lattice = map.lattice();
    let mut lines = vec![
        format!(
            "floor {floor}: {}: {} bytes, {} beacons at {} x {} points, {} m apart",
            file.display(),
            made.bytes.len(),
            survey.beacons().len(),
            lattice.columns(),
            lattice.rows(),
            lattice.spacing(),
        ),
        made.choices.to_string(),
    ];
    let (promised, mut value) = promise(made);
    lines.extend(promised);
    let picture = draw(survey, made, &file.with_extension("expected"))?;
    lines.push(format!("picture: {}", picture.display()));
    if survey.gated() > 0 {
        lines.push(format!(
            "{} readings left out: no radio measures such strengths",
            survey.gated()
        ));
    }
    for (name, more) in [
        ("floor", json!(floor)),
        ("file", json!(file)),
        ("bytes", json!(made.bytes.len())),
        ("beacons", json!(survey.beacons())),
        ("columns", json!(lattice.columns())),
        ("rows", json!(lattice.rows())),
        ("spacing_m", json!(lattice.spacing())),
        ("picture", json!(picture)),
    ] {
        value[name] = more;
    }
    options.survey.say(&lines, &value)
}

/// How well places will be found.
fn promise(made: &Made) -> (Vec<String>, Value) {
    let expected = &made.expected;
    let (Some(median), Some(most)) = (expected.quantile_m(0.5), expected.quantile_m(0.9)) else {
        return (Vec::new(), json!({}));
    };
    let line = format!(
        "expected of {} packets of each beacon without memory, at {} places that were left out with their neighbours: \
         median {median:.2} m, 90 % within {most:.2} m, {:.0} % within 2 m",
        Expected::PACKETS,
        expected.left_out_m.len(),
        100.0 * expected.within(2.0),
    );
    let value = json!({
        "median_error_m": median, "error_m_90_percent": most, "fraction_within_2_m": expected.within(2.0),
    });
    (vec![line], value)
}

/// Draws it, as SVG and PNG.
fn draw(survey: &SiteSurvey, made: &Made, file: &Path) -> Result<PathBuf> {
    let heat = Heat {
        title: "What the map promises: expected error of a look without memory, in metres".into(),
        panels: vec![picture::Field::of_points(
            "by the survey",
            &made.lattice,
            &made.expected.by_point_m,
        )],
        places: survey.survey().places.clone(),
    };
    picture::save(&heat.svg()?, file)?;
    Ok(file.with_extension("svg"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floors_have_files_of_their_own() {
        assert_eq!(
            with_floor(Path::new("a/site.map"), -1),
            Path::new("a/site--1.map")
        );
        assert_eq!(with_floor(Path::new("site"), 2), Path::new("site-2"));
    }
}
