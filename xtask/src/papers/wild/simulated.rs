//! Both tracks, with each fault.

use anyhow::{Context, Result};
use comfy_table::{CellAlignment, Table, presets::ASCII_MARKDOWN};
use foxhunt::{
    aoa::{
        locator::{self, Answer, Fix, Locator},
        robust::{Errors, RobustLocator, Settings},
    },
    random::{SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_host::{
    Sight,
    faults::Faults,
    reference::{Posterior, cramer_rao_of_biased, mahalanobis},
    simulate,
    tracks::Track,
};
use indicatif::ParallelProgressIterator;
use rayon::prelude::*;

use super::super::{
    progress,
    statistics::{Estimate, bootstrap, root_mean_square},
};
use crate::figures::Figure;

/// 95 % of a normal distribution in the plane lie within this Mahalanobis distance.
pub const NINETY_FIVE: f64 = 2.447_746_830_680_816;

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
    let condition = |name, key, wild, mirror, over_floor| Condition {
        name,
        key,
        faults: Faults {
            wild,
            mirror,
            bias: 0.0,
        },
        over_floor: Some(over_floor),
        over_exact: None,
    };
    [
        condition("clean", "clean", 0.0, 0.0, 1.06),
        condition("10 % wild", "wild10", 0.1, 0.0, 1.10),
        condition("30 % wild", "wild30", 0.3, 0.0, 1.30),
        condition("10 % mirrored", "mirrored10", 0.0, 0.1, 1.06),
        condition("50 % mirrored", "mirrored50", 0.0, 0.5, 1.06),
        Condition {
            name: "bias of 3 degrees",
            key: "bias3",
            faults: Faults {
                bias: 3f64.to_radians(),
                ..Faults::default()
            },
            over_floor: None,
            over_exact: Some(1.1),
        },
    ]
}

/// What a method made of one run.
#[derive(Debug, Clone, Copy)]
pub struct Outcome {
    /// In metres; infinite without a fix.
    pub error: f64,
    /// Whether the 95 % ellipse holds the source.
    pub covered: bool,
}

impl Outcome {
    fn exact(posterior: &Posterior, source: [f64; 2]) -> Self {
        let error = [0, 1].map(|d| posterior.mean[d] - source[d]);
        Self {
            error: error[0].hypot(error[1]),
            covered: mahalanobis(error, &posterior.covariance) <= NINETY_FIVE,
        }
    }

    pub fn of(answer: Answer, source: [f64; 2]) -> Self {
        let Answer::Fix(fix) = answer else {
            return Self {
                error: f64::INFINITY,
                covered: false,
            };
        };
        Self {
            error: distance(&fix, source),
            covered: fix.ellipse(0.95).contains(source.map(|v| v as f32)),
        }
    }
}

/// Of a fix from the source, in metres.
pub fn distance(fix: &Fix, source: [f64; 2]) -> f64 {
    let [x, y] = [0, 1].map(|d| f64::from(fix.position[d]) - source[d]);
    x.hypot(y)
}

/// The last answer to the bearings.
pub fn locate(settings: Settings, sights: &[Sight], seed: u64) -> Result<Answer> {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
    let mut locator = Box::new(RobustLocator::<256, 64>::new(settings));
    for sight in sights {
        locator.push((*sight).try_into()?, &mut rng);
    }
    Ok(locator.answer())
}

fn locate_plainly(sights: &[Sight], seed: u64) -> Result<Answer> {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
    let mut locator = Box::new(Locator::<256, 64>::new(locator::Settings::new()));
    for sight in sights {
        locator.push((*sight).try_into()?, &mut rng);
    }
    Ok(locator.answer())
}

/// One run of a condition: the exact posterior of the clean bearings, that of these, ours, and the plain locator.
struct Run {
    floor: Outcome,
    exact: Outcome,
    ours: Outcome,
    plain: Outcome,
    /// Five times the bound of bearings that are neither wild nor mirrored.
    far: f64,
}

impl Run {
    fn new(track: &Track, faults: &Faults, run: u32, seed: u64) -> Result<Self> {
        let run = u64::from(run);
        let source = track.source;
        let mut sights = simulate::bearings(track, &mut simulate::generator(seed, run));
        let bound = cramer_rao_of_biased(&sights, source, faults.bias).context("no bound")?;
        let floor = Posterior::new(&sights).context("no posterior")?;
        faults.spoil(&mut sights, &mut simulate::generator(!seed, run));
        let exact = Posterior::with_faults(&sights, faults).context("no posterior")?;
        let errors = Errors::new().bias_deviation(faults.bias as f32)?;
        let ours = locate(Settings::new(errors), &sights, seed ^ run)?;
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
    fn over(&self, method: Of, reference: Of) -> Estimate {
        bootstrap(self.0.len(), |runs| {
            let (a, b): (Vec<f64>, Vec<f64>) = runs
                .map(|run| (method(&self.0[run]).error, reference(&self.0[run]).error))
                .unzip();
            root_mean_square(a.into_iter()) / root_mean_square(b.into_iter())
        })
    }

    fn share(&self, is: impl Fn(&Run) -> bool) -> f64 {
        self.0.iter().filter(|run| is(run)).count() as f64 / self.0.len() as f64
    }
}

/// Runs all conditions on both tracks.
pub fn run(runs: u32, seed: u64) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for track in [Track::a1(), Track::a2()] {
        let mut table = Table::new();
        table.load_style(ASCII_MARKDOWN).set_header([
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
        ]);
        for column in table.column_iter_mut().skip(1) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        for condition in conditions() {
            let what = format!("{}, {}", track.name, condition.name);
            let all = Runs(
                (0..runs)
                    .into_par_iter()
                    .progress_with(progress(runs.into(), what)?)
                    .map(|run| Run::new(&track, &condition.faults, run, seed))
                    .collect::<Result<_>>()?,
            );
            let (over_floor, over_exact) = (
                all.over(|run| run.ours, |run| run.floor),
                all.over(|run| run.ours, |run| run.exact),
            );
            let exact_over_floor = all.over(|run| run.exact, |run| run.floor);
            let coverage = all.share(|run| run.ours.covered);
            let exact_coverage = all.share(|run| run.exact.covered);
            let beyond = all.share(|run| run.ours.error > run.far);
            let no_fix = all.share(|run| run.ours.error.is_infinite());
            let percent = |share: f64| format!("{:.1} %", 100.0 * share);
            table.add_row([
                condition.name.to_owned(),
                over_floor.to_string(),
                exact_over_floor.to_string(),
                over_exact.to_string(),
                percent(coverage),
                percent(exact_coverage),
                percent(beyond),
                percent(no_fix),
                format!("{:.3}", all.over(|run| run.plain, |run| run.floor).value),
                percent(all.share(|run| run.plain.covered)),
            ]);

            let prefix = format!(
                "papers.bearings.{}.{}",
                track.name.to_lowercase(),
                condition.key
            );
            let figure =
                |what: &str, value, unit| Figure::new(format!("{prefix}.{what}"), value, unit);
            let limited = |figure: Figure, limit: Option<f64>| match limit {
                Some(limit) => figure.at_most(limit),
                None => figure,
            };
            let off = 100.0 * (coverage - exact_coverage).abs();
            figures.extend([
                limited(
                    figure("rmse_over_floor", over_floor.value, ""),
                    condition.over_floor,
                ),
                figure("exact_over_floor", exact_over_floor.value, ""),
                limited(
                    figure("rmse_over_exact", over_exact.value, ""),
                    condition.over_exact,
                ),
                figure("coverage", coverage, "of runs"),
                figure("coverage_off_exact", off, "% of runs").at_most(2.0),
                figure("beyond_5_bounds", beyond, "of runs").at_most(0.0),
                figure("no_fix", no_fix, "of runs").at_most(0.0),
            ]);
        }
        println!(
            "Track {}, {} bearings, {runs} runs, 256 particles",
            track.name,
            track.receivers.len()
        );
        println!("{table}\n");
    }
    println!(
        "The floor is the exact posterior of the same bearings before they were spoilt; the exact one knows the shares, \
         and the deviation of the bias, that ours has to learn. Bounds are those of Cramer and Rao, with the bias as one \
         more unknown where there is one.\n"
    );
    Ok(figures)
}
