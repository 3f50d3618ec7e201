//! The task `papers`: published experiments, run again and compared with their figures.

use std::{env, path::PathBuf, process::Command, time::Duration};

use anyhow::{Result, ensure};
use clap::builder::PossibleValuesParser;
use foxhunt_host::figures::Figure;
use foxhunt_studies::papers::{self, Study, field::Part};
use indicatif::ProgressBar;

use crate::{figures, project, qemu::Machine, setup};

/// The options of `cargo xtask papers`.
#[derive(clap::Args)]
pub struct Options {
    #[command(subcommand)]
    paper: Paper,
}

#[derive(clap::Subcommand)]
enum Paper {
    /// Locate a transmitter by bearings: the particle filter of Du et al. (2016), the locator and
    /// Gauss-Newton, beside the exact posterior.
    Aoa(Run),
    /// Its particles refined by a fish school (the same paper), as published and with the posterior kept.
    Fish(Run),
    /// Track the growth model, and locate a transmitter, with fireflies: Du, Li and Jiang (2017).
    Firefly(Run),
    /// Track a model with gamma noise with differential evolution and unscented proposals: Li, Wang and Wang (2011).
    Evolution(Run),
    /// Track a person in a tunnel by radio fingerprints: Cui, Wu, He and Wu (2017), and the tracker, simulated and
    /// measured.
    Fingerprint(Run),
    /// Locate a transmitter by bearings of which some are outliers, mirrored or biased: the robust locator, simulated and
    /// measured.
    Bearings(Run),
    /// Whether the stated errors of a KrakenSDR's bearings hold the truth among reflections, by the method of its spectra.
    Finders(Run),
    /// The robust locator as it comes, in rooms, with wrong sigmas, with errors by stop, by station and by direction.
    Field(Field),
    /// Several sources at rest on one channel, found by default and told apart.
    Sources(Sources),
    /// Somebody who walks among fixed arrays: simulated and measured.
    Walkers(Run),
    /// Follow tags through a building of three floors: on which, and in which room.
    Floors(Run),
    /// The exact posterior of bearings, which others of these compare with, beside uniform grids.
    Reference(Run),
    /// What each method of these is worth beside the bootstrap filter that costs as much.
    Cost(Run),
}

#[derive(clap::Args)]
struct Run {
    /// Runs of every method [default: as many as its figures ask for].
    #[arg(long, value_parser = clap::value_parser!(u32).range(10..))]
    runs: Option<u32>,
    /// Seed of all random numbers: the same seed gives the same tables.
    #[arg(long, default_value_t = 2016)]
    seed: u64,
    /// Write the figures to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

#[derive(clap::Args)]
struct Field {
    #[command(flatten)]
    run: Run,
    /// Parts of it [default: all].
    #[arg(value_name = "PART", value_parser = part_names())]
    parts: Vec<String>,
}

#[derive(clap::Args)]
struct Sources {
    #[command(flatten)]
    run: Run,
    /// Scenarios, by the first dotted words of their names, such as stops.s12.n1 [default: all].
    #[arg(value_name = "SCENARIO")]
    scenarios: Vec<String>,
    /// Run the filter of another crate beside it, too, which is built in a workspace of its own.
    #[arg(long)]
    peers: bool,
}

impl Sources {
    fn figures(&self) -> Result<Vec<Figure>> {
        let mut figures = papers::sources::run(&study(&self.run), &self.scenarios)?;
        if self.peers {
            let peers = self.peers()?;
            papers::sources::limit_by(&mut figures, &peers);
            figures.extend(peers);
        }
        Ok(figures)
    }

    /// The figures of another filter on the same readings.
    fn peers(&self) -> Result<Vec<Figure>> {
        let directory = project::root().join("peers/sources");
        let mut command = Command::new(project::executable_in(&directory, &[])?);
        command.args(["--seed", &self.run.seed.to_string()]);
        if let Some(runs) = self.run.runs {
            command.args(["--runs", &runs.to_string()]);
        }
        let output = command.args(&self.scenarios).output()?;
        ensure!(output.status.success(), "the other filter failed");
        Ok(serde_json::from_slice(&output.stdout)?)
    }
}

fn part_names() -> PossibleValuesParser {
    PossibleValuesParser::new(Part::ALL.map(|(name, _)| name))
}

impl Field {
    fn parts(&self) -> Vec<Part> {
        let asked =
            |name: &str| self.parts.is_empty() || self.parts.iter().any(|part| part == name);
        let parts = Part::ALL.into_iter().filter(|(name, _)| asked(name));
        parts.map(|(_, part)| part).collect()
    }
}

/// Runs the task: prints the figures, writes them if asked to, and fails if one misses its limit.
pub fn run(options: &Options) -> Result<()> {
    type Of = fn(&Study) -> Result<Vec<Figure>>;
    let (run, paper): (_, Of) = match &options.paper {
        Paper::Aoa(run) => (run, papers::aoa::run),
        Paper::Fish(run) => (run, papers::fish::run),
        Paper::Firefly(run) => (run, papers::firefly::run),
        Paper::Evolution(run) => (run, papers::evolution::run),
        Paper::Fingerprint(run) => (run, papers::fingerprint::run),
        Paper::Bearings(run) => (run, papers::outliers::run),
        Paper::Finders(run) => (run, papers::finders::run),
        Paper::Reference(run) => (run, papers::reference::run),
        Paper::Floors(run) => (run, papers::floors::run),
        Paper::Walkers(run) => (run, papers::walkers::run),
        Paper::Cost(run) => (run, papers::cost::run),
        Paper::Sources(sources) => {
            return finish(&sources.run, sources.figures()?);
        }
        Paper::Field(field) => {
            let parts = field.parts();
            return finish(&field.run, papers::field::run(&study(&field.run), &parts)?);
        }
    };
    finish(run, paper(&study(run))?)
}

fn study(run: &Run) -> Study {
    Study {
        runs: run.runs,
        seed: run.seed,
        data: env::var_os("FOXHUNT_DATA").map(PathBuf::from),
        pictures: project::root().join("target/papers"),
        board: on_board,
    }
}

fn finish(run: &Run, figures: Vec<Figure>) -> Result<()> {
    figures::print(&figures);
    if let Some(file) = &run.json {
        figures::write_json(&figures, file)?;
    }
    figures::check(&figures)
}

/// Builds the firmware `studies` and boots it for the study of this name: what it printed.
fn on_board(study: &str) -> Result<String> {
    setup::ensure(setup::FIRMWARE)?;
    let spinner =
        ProgressBar::new_spinner().with_message(format!("instructions, {study}, emulated"));
    spinner.enable_steady_tick(Duration::from_millis(100));
    let elf = project::firmware("studies")?;
    // The board's clock counts instructions, whatever this machine does.
    let clock = ["-icount", "shift=6", "-append", study];
    let log = Machine::boot_with(&elf, Duration::from_secs(300), &clock)?.finish()?;
    spinner.finish_and_clear();
    Ok(String::from_utf8(log)?)
}
