//! Both tracks, with each fault.

use anyhow::{Context, Result};
use foxhunt::{
    aoa::{
        Answer, Clean, Locator, clean,
        robust::{Config, Errors},
    },
    random::{SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_host::{
    figures::Figure,
    reference::{Posterior, cramer_rao_of_biased},
    simulate,
    tracks::Track,
};
use foxhunt_simulation::{Sight, faults::Faults, random};
use indicatif::ParallelProgressIterator;
use rayon::prelude::*;

use crate::papers::{
    outcome::{Outcome, locate},
    statistics::{Estimate, bootstrap, root_mean_square},
    study::progress,
    table::table,
};

/// What goes wrong, and what is asked of the locator then.
struct Condition {
    name: &'static str,
    key: &'static str,
    faults: Faults,
    /// The most that the RMSE may be, in those of the exact posterior of clean bearings, and of these.
    over_floor: Option<f64>,
    over_exact: Option<f64>,
}

fn conditions() -> [Condition; 6] {
    let condition = |name, key, outlier_rate, mirrored_rate, over_floor| Condition {
        name,
        key,
        faults: Faults {
            outlier_rate,
            mirrored_rate,
            bias_sigma: 0.0,
        },
        over_floor: Some(over_floor),
        over_exact: None,
    };
    [
        condition("clean", "clean", 0.0, 0.0, 1.06),
        condition("10 % outliers", "outliers10", 0.1, 0.0, 1.10),
        condition("30 % outliers", "outliers30", 0.3, 0.0, 1.30),
        condition("10 % mirrored", "mirrored10", 0.0, 0.1, 1.06),
        condition("50 % mirrored", "mirrored50", 0.0, 0.5, 1.06),
        Condition {
            name: "bias of 3 degrees",
            key: "bias3",
            faults: Faults {
                bias_sigma: 3f64.to_radians(),
                ..Faults::default()
            },
            over_floor: None,
            over_exact: Some(1.1),
        },
    ]
}

fn locate_plainly(sights: &[Sight], seed: u64) -> Result<Answer> {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
    let mut locator = Box::new(Locator::<Clean<256>>::new(clean::Config::DEFAULT)?);
    for sight in sights {
        locator.push(&(*sight).try_into()?, &mut rng)?;
    }
    Ok(locator.answer())
}

/// One run of a condition: the exact posterior of the clean bearings, that of these, ours, and the plain locator.
struct Run {
    floor: Outcome,
    exact: Outcome,
    ours: Outcome,
    plain: Outcome,
    /// Five times the bound of bearings without outliers, none of them mirrored.
    far: f64,
}

impl Run {
    fn new(track: &Track, faults: &Faults, run: u32, seed: u64) -> Result<Self> {
        let run = u64::from(run);
        let source = track.source;
        let mut sights = simulate::bearings(track, &mut random::generator(seed, run));
        let bound = cramer_rao_of_biased(&sights, source, faults.bias_sigma).context("no bound")?;
        let floor = Posterior::new(&sights).context("no posterior")?;
        faults.spoil(&mut sights, &mut random::generator(!seed, run));
        let exact = Posterior::with_faults(&sights, faults).context("no posterior")?;
        let config = Config {
            errors: Errors {
                bias_sigma_rad: faults.bias_sigma as f32,
                ..Errors::DEFAULT
            },
            ..Config::DEFAULT
        };
        let ours = locate(&config, &sights, seed ^ run)?;
        let plain = locate_plainly(&sights, seed ^ run)?;
        Ok(Self {
            floor: Outcome::exact(&floor, source),
            exact: Outcome::exact(&exact, source),
            ours: Outcome::of(ours, source),
            plain: Outcome::of(plain, source),
            far: 5.0 * bound.trace().sqrt(),
        })
    }
}

/// All runs of a condition.
struct Runs(Vec<Run>);

type Of = fn(&Run) -> Outcome;

impl Runs {
    fn new(track: &Track, condition: &Condition, runs: u32, seed: u64) -> Result<Self> {
        let what = format!("{}, {}", track.name, condition.name);
        let runs = (0..runs)
            .into_par_iter()
            .progress_with(progress(runs.into(), what)?)
            .map(|run| Run::new(track, &condition.faults, run, seed))
            .collect::<Result<_>>()?;
        Ok(Self(runs))
    }

    fn results(&self) -> Results {
        Results {
            over_floor: self.over(|run| run.ours, |run| run.floor),
            over_exact: self.over(|run| run.ours, |run| run.exact),
            exact_over_floor: self.over(|run| run.exact, |run| run.floor),
            plain_over_floor: self.over(|run| run.plain, |run| run.floor).value,
            coverage: self.fraction(|run| run.ours.covered),
            exact_coverage: self.fraction(|run| run.exact.covered),
            plain_coverage: self.fraction(|run| run.plain.covered),
            beyond: self.fraction(|run| run.ours.error > run.far),
            no_fix: self.fraction(|run| run.ours.error.is_infinite()),
        }
    }

    fn over(&self, method: Of, reference: Of) -> Estimate {
        bootstrap(self.0.len(), |runs| {
            let (a, b): (Vec<f64>, Vec<f64>) = runs
                .map(|run| (method(&self.0[run]).error, reference(&self.0[run]).error))
                .unzip();
            root_mean_square(a.into_iter()) / root_mean_square(b.into_iter())
        })
    }

    fn fraction(&self, is: impl Fn(&Run) -> bool) -> f64 {
        self.0.iter().filter(|run| is(run)).count() as f64 / self.0.len() as f64
    }
}

/// Runs all conditions on both tracks.
pub fn run(runs: u32, seed: u64) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for track in [Track::a1(), Track::a2()] {
        let header = [
            "bearings",
            "RMSE / clean floor",
            "the exact's",
            "RMSE / exact",
            "95 % ellipse holds",
            "the exact's",
            "beyond 5 bounds",
            "no fix",
            "plain locator: RMSE / clean floor",
            "holds",
        ];
        let mut table = table(header, 1);
        for condition in conditions() {
            let results = Runs::new(&track, &condition, runs, seed)?.results();
            table.add_row(results.row(&condition));
            figures.extend(results.figures(&track, &condition));
        }
        println!(
            "Track {}, {} bearings, {runs} runs, 256 particles",
            track.name,
            track.receivers.len()
        );
        println!("{table}\n");
    }
    println!(
        "The floor is the exact posterior of the same bearings before they were spoilt; the exact one knows the rates of the \
         faults, and the sigma of the bias, that ours has to learn. Bounds are those of Cramer and Rao, with the bias as one \
         more unknown where there is one.\n"
    );
    Ok(figures)
}

/// What the runs of a condition say.
struct Results {
    over_floor: Estimate,
    over_exact: Estimate,
    exact_over_floor: Estimate,
    plain_over_floor: f64,
    coverage: f64,
    exact_coverage: f64,
    plain_coverage: f64,
    beyond: f64,
    no_fix: f64,
}

impl Results {
    fn row(&self, condition: &Condition) -> [String; 10] {
        let percent = |fraction: f64| format!("{:.1} %", 100.0 * fraction);
        [
            condition.name.to_owned(),
            self.over_floor.to_string(),
            self.exact_over_floor.to_string(),
            self.over_exact.to_string(),
            percent(self.coverage),
            percent(self.exact_coverage),
            percent(self.beyond),
            percent(self.no_fix),
            format!("{:.3}", self.plain_over_floor),
            percent(self.plain_coverage),
        ]
    }

    fn figures(&self, track: &Track, condition: &Condition) -> [Figure; 7] {
        let prefix = format!(
            "papers.bearings.{}.{}",
            track.name.to_lowercase(),
            condition.key
        );
        let figure = |what: &str, value, unit| Figure::new(format!("{prefix}.{what}"), value, unit);
        let limited = |figure: Figure, limit| Figure { limit, ..figure };
        let off = 100.0 * (self.coverage - self.exact_coverage).abs();
        [
            limited(
                figure("rmse_over_floor", self.over_floor.value, ""),
                condition.over_floor,
            ),
            figure("exact_over_floor", self.exact_over_floor.value, ""),
            limited(
                figure("rmse_over_exact", self.over_exact.value, ""),
                condition.over_exact,
            ),
            figure("coverage", self.coverage, "of runs"),
            figure("coverage_off_exact", off, "% of runs").at_most(2.0),
            figure("beyond_5_bounds", self.beyond, "of runs").at_most(0.0),
            figure("no_fix", self.no_fix, "of runs").at_most(0.0),
        ]
    }
}
