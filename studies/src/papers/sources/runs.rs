//! What many runs of a scenario say.

use anyhow::Result;
use foxhunt::aoa::{Fix, multi};
use foxhunt_host::figures::Figure;
use indicatif::ParallelProgressIterator;
use rayon::prelude::*;

use super::{
    gospa::{Assignment, Gospa},
    locators::{DEFAULT, UNBIASED, several, told},
    mixture,
    scenarios::Scenario,
};
use crate::papers::{
    statistics::{Estimate, bootstrap, root_mean_square},
    study::progress,
};

/// One source in one run.
#[derive(Debug, Clone, Copy)]
struct Source {
    /// The error of its estimate, in metres, if it has been found.
    error: Option<f64>,
    /// Whether the 95 % ellipse holds it.
    covered: bool,
    /// The error of the locator that gets its readings alone, if it has a fix.
    told: Option<f64>,
    /// Whether the 95 % ellipse of that holds it.
    told_covered: bool,
}

/// One run.
#[derive(Debug, Clone)]
struct Run {
    sources: Vec<Source>,
    ghosts: usize,
    /// Ghosts whose 99 % ellipses hold no source either.
    strays: usize,
    /// Whether there ever were more than there are.
    ever: bool,
    ours: Gospa,
    told: Gospa,
    /// Ours, told that the array has no bias.
    unbiased: Gospa,
    /// Of expectation maximisation that knows how many there are, and as much of the bias as ours.
    mixture: Gospa,
    /// The same, told that there is none.
    mixture_unbiased: Gospa,
}

impl Run {
    fn new(scenario: &Scenario, seed: u64, run: u64) -> Result<Self> {
        let (channel, readings) = scenario.readings(seed, run);
        let truths = &channel.sources;
        let seed = seed ^ run;
        let found = several(&readings, &DEFAULT, seed)?;
        let unbiased = several(&readings, &UNBIASED, seed)?;
        let told = told(&readings, truths.len(), seed)?;
        let places_of = |fixes: &[Fix]| fixes.iter().map(place).collect::<Vec<_>>();
        let places = places_of(&found.fixes);
        let assigned = Assignment::new(truths, &places, scenario.cutoff_m);
        let known: Vec<[f64; 2]> = told.iter().flatten().map(place).collect();
        let mixture = |config: &multi::Config| {
            let bias_sigma = f64::from(config.track.errors.bias_sigma_rad);
            mixture::locate(&readings, truths.len(), bias_sigma, seed)
        };
        let gospa = |places: &[[f64; 2]]| Assignment::new(truths, places, scenario.cutoff_m).gospa;
        let sources = truths.iter().zip(&assigned.estimates).zip(&told);
        let sources: Vec<Source> = sources
            .map(|((truth, estimate), told)| {
                let fix = estimate.map(|index| &found.fixes[index]);
                let holds = |fix: &Fix| fix.ellipse(0.95).contains(truth.map(|v| v as f32));
                Source {
                    error: fix.map(|fix| distance(place(fix), *truth)),
                    covered: fix.is_some_and(holds),
                    told: told.map(|fix| distance(place(&fix), *truth)),
                    told_covered: told.is_some_and(|fix| holds(&fix)),
                }
            })
            .collect();
        let is_stray = |(index, fix): (usize, &Fix)| {
            let region = fix.ellipse(0.99);
            let holds = |truth: &[f64; 2]| region.contains(truth.map(|v| v as f32));
            !assigned.estimates.contains(&Some(index)) && !truths.iter().any(holds)
        };
        let strays = found.fixes.iter().enumerate().filter(|one| is_stray(*one));
        Ok(Self {
            strays: strays.count(),
            ghosts: places.len() - sources.iter().filter(|one| one.error.is_some()).count(),
            ever: found.most > truths.len(),
            sources,
            ours: assigned.gospa,
            told: gospa(&known),
            unbiased: gospa(&places_of(&unbiased.fixes)),
            mixture: gospa(&mixture(&DEFAULT)),
            mixture_unbiased: gospa(&mixture(&UNBIASED)),
        })
    }

    fn complete(&self) -> bool {
        self.sources.iter().all(|one| one.error.is_some())
    }
}

fn place(fix: &Fix) -> [f64; 2] {
    fix.position.map(f64::from)
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// How the figures of the distance end.
pub const GOSPA: &str = ".gospa";

pub const HEADER: [&str; 12] = [
    "scenario",
    "all found",
    "sources found",
    "ghost at the end, by its own region, ever",
    "RMSE m",
    "RMSE / told",
    "95 % ellipse holds, the told",
    "GOSPA m: all (placed, missed, false)",
    "by told locators",
    "by expectation maximisation",
    "told that there is no bias",
    "by expectation maximisation, told so, too",
];

/// All runs of a scenario.
pub struct Runs<'a> {
    scenario: &'a Scenario,
    all: Vec<Run>,
}

impl<'a> Runs<'a> {
    /// Runs 0 to `runs`.
    pub fn new(scenario: &'a Scenario, runs: u32, seed: u64) -> Result<Self> {
        let all = (0..u64::from(runs))
            .into_par_iter()
            .progress_with(progress(runs.into(), scenario.name.clone())?)
            .map(|run| Run::new(scenario, seed, run))
            .collect::<Result<_>>()?;
        Ok(Self { scenario, all })
    }

    fn fraction(&self, is: impl Fn(&Run) -> bool) -> f64 {
        self.all.iter().filter(|run| is(run)).count() as f64 / self.all.len() as f64
    }

    fn sources(&self) -> impl Iterator<Item = &Source> + Clone {
        self.all.iter().flat_map(|run| &run.sources)
    }

    /// Of those that have been found, and of the same where their readings are told.
    fn rmse<'r>(runs: impl Iterator<Item = &'r Run>) -> [f64; 2] {
        let both = |source: &Source| Some((source.error?, source.told?));
        let sources = runs.flat_map(|run| &run.sources);
        let (ours, told): (Vec<f64>, Vec<f64>) = sources.filter_map(both).unzip();
        [ours, told].map(|errors| root_mean_square(errors.into_iter()))
    }

    fn ratio(&self) -> Estimate {
        bootstrap(self.all.len(), |runs| {
            let [ours, told] = Self::rmse(runs.map(|run| &self.all[run]));
            ours / told
        })
    }

    fn found(&self) -> f64 {
        let all = self.sources().count() as f64;
        self.sources().filter(|one| one.error.is_some()).count() as f64 / all
    }

    /// Of those that have been found, and of those that the told locators have.
    fn covered(&self) -> [f64; 2] {
        let count = |is: fn(&Source) -> bool| self.sources().filter(|one| is(one)).count() as f64;
        [
            count(|one| one.covered) / count(|one| one.error.is_some()),
            count(|one| one.told_covered) / count(|one| one.told.is_some()),
        ]
    }

    /// Root of the mean of the squares: all, and its parts.
    fn gospa(&self, of: impl Fn(&Run) -> Gospa) -> [f64; 4] {
        let sum: Gospa = self.all.iter().map(of).sum();
        let root = |sum: f64| (sum / self.all.len() as f64).sqrt();
        [sum.total(), sum.localisation, sum.missed, sum.ghosts].map(root)
    }

    pub fn row(&self) -> [String; 12] {
        let percent = |fraction: f64| format!("{:.1} %", 100.0 * fraction);
        let gospa = |[all, placed, missed, ghosts]: [f64; 4]| {
            format!("{all:.3} ({placed:.3}, {missed:.3}, {ghosts:.3})")
        };
        let [rmse, _] = Self::rmse(self.all.iter());
        let [covered, told_covered] = self.covered();
        [
            self.scenario.name.clone(),
            percent(self.fraction(Run::complete)),
            percent(self.found()),
            format!(
                "{}, {}, {}",
                percent(self.fraction(|run| run.ghosts > 0)),
                percent(self.fraction(|run| run.strays > 0)),
                percent(self.fraction(|run| run.ever))
            ),
            format!("{rmse:.3}"),
            self.ratio().to_string(),
            format!("{}, {}", percent(covered), percent(told_covered)),
            gospa(self.gospa(|run| run.ours)),
            gospa(self.gospa(|run| run.told)),
            gospa(self.gospa(|run| run.mixture)),
            gospa(self.gospa(|run| run.unbiased)),
            gospa(self.gospa(|run| run.mixture_unbiased)),
        ]
    }

    pub fn figures(&self) -> Vec<Figure> {
        let figure = |what: &str, value, unit| {
            Figure::new(
                format!("sources.{}.{what}", self.scenario.name),
                value,
                unit,
            )
        };
        let limits = &self.scenario.limits;
        let [covered, told_covered] = self.covered();
        let [least, most] = limits.covered;
        let missed = 1.0 - self.fraction(Run::complete);
        let mut figures = vec![
            figure("incomplete", missed, "of runs").at_most(1.0 - limits.found),
            figure("ghosts", self.fraction(|run| run.ghosts > 0), "of runs").at_most(limits.ghosts),
            figure("strays", self.fraction(|run| run.strays > 0), "of runs"),
            figure("ghosts_ever", self.fraction(|run| run.ever), "of runs"),
            figure("rmse_over_told", self.ratio().value, "").at_most(limits.ratio),
            figure("covered", covered, "of sources found").at_most(most),
            figure("uncovered", 1.0 - covered, "of sources found").at_most(1.0 - least),
        ];
        let [mixture, ..] = self.gospa(|run| run.mixture);
        let [mixture_unbiased, ..] = self.gospa(|run| run.mixture_unbiased);
        let [told, ..] = self.gospa(|run| run.told);
        let [unbiased, ..] = self.gospa(|run| run.unbiased);
        let [all, placed, missed, ghosts] = self.gospa(|run| run.ours);
        figures.extend([
            figure("told.covered", told_covered, "of fixes"),
            figure(&GOSPA[1..], all, "m").at_most(mixture),
            figure("gospa.placed", placed, "m"),
            figure("gospa.missed", missed, "m"),
            figure("gospa.false", ghosts, "m"),
            figure("gospa_mixture", mixture, "m"),
            figure("gospa_told", told, "m"),
            figure("gospa_unbiased", unbiased, "m").at_most(mixture_unbiased),
            figure("gospa_mixture_unbiased", mixture_unbiased, "m"),
        ]);
        figures
    }
}
