//! Li, Wang, Wang: differential evolution in particle filters, J. Electronics & Information Technology 33(7), 2011.
//!
//! A model with gamma noise, measured precisely, and with more noise: their filters with log-weights and true
//! moments, ours, and the exact filter; and their table by the numerics that it was made with.

mod legacy;

use anyhow::Result;
use foxhunt_host::{
    figures::Figure,
    picture::{Axis, Curve, Curves, Style},
    reference,
};
use foxhunt_problems::gamma::{self, GammaNoise, Measurement};
use foxhunt_simulation::random;
use indicatif::ParallelProgressIterator;
use rayon::prelude::*;

use self::legacy::Legacy;
use super::{
    instructions::short,
    scalar::{self, Experiment, STEPS},
    statistics::Estimate,
    study::{Study, progress},
    table::table,
};
use crate::methods::scalar::{self as methods, *};

pub(super) type Problem = scalar::Problem<GammaNoise, Measurement>;
pub(super) type Method = scalar::Method<Problem>;

const N: usize = 10;
const RUNS: u32 = 2000;
const VARIANCES: [f64; 4] = [1e-5, 0.01, 0.1, 1.0];
/// That of the original study, which gives the paper's table, and the one that the paper prints.
const OMEGAS: [f64; 2] = [0.04, 0.4];

/// Ours that keep the posterior.
const OURS: [&str; 3] = [AUXILIARY, POINT_MASS, EVOLUTION];

/// Runs the experiments.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for omega in OMEGAS {
        figures.extend(table_of_the_paper(study, omega)?);
    }
    let mut curves: Vec<Curve> = Vec::new();
    for variance in VARIANCES {
        let experiment = experiment(
            study,
            OMEGAS[0],
            variance,
            methods(study, OMEGAS[0], variance)?,
            RUNS,
        )?;
        figures.extend(report(&experiment, OMEGAS[0], variance));
        let others = experiment.methods.iter().filter(|m| m.key != scalar::FLOOR);
        for (index, method) in others.enumerate() {
            if curves.len() <= index {
                curves.push(Curve {
                    name: method.label.into(),
                    style: Style::DotsAndLine,
                    ..Curve::default()
                });
            }
            let ratio = experiment.mean_over_floor(method);
            curves[index].points.push((variance, ratio.value));
            curves[index].errors.push(ratio.error);
        }
        let title = format!("Gamma noise, R = {variance:e}, N = {N}");
        let picture = experiment.picture(&title, &[PF, PFDE, UPFDE, EVOLUTION, scalar::FLOOR])?;
        study.save(&picture, &format!("evolution-{variance:e}"))?;
        println!();
    }
    // The printed omega too, where the paper measures.
    let (omega, variance) = (OMEGAS[1], VARIANCES[0]);
    let printed = experiment(
        study,
        omega,
        variance,
        methods(study, omega, variance)?,
        RUNS,
    )?;
    figures.extend(report(&printed, omega, variance));

    let picture = Curves {
        title: format!("Gamma noise, N = {N}: mean RMSE over that of the exact filter"),
        horizontal: Axis::logarithmic("variance of the measurements"),
        vertical: Axis::logarithmic("RMSE / floor"),
        curves,
    };
    study.save(&picture.svg()?, "evolution")?;
    println!();
    Ok(figures)
}

/// A row of the paper's table: its own mean and, where it is printed, variance of the RMSE over the runs.
struct Row {
    label: &'static str,
    key: &'static str,
    method: Legacy,
    mean: f64,
    variance: Option<f64>,
    /// Within a tenth, which is what can be asked where it is clear what was done.
    clear: bool,
}

const fn row(
    (label, key): (&'static str, &'static str),
    (particles, unscented, evolution): (usize, bool, bool),
    mean: f64,
    variance: Option<f64>,
    clear: bool,
) -> Row {
    let method = Legacy {
        particles,
        unscented,
        evolution,
    };
    Row {
        label,
        key,
        method,
        mean,
        variance,
        clear,
    }
}

const PAPER: [Row; 5] = [
    row(("PF", PF), (10, false, false), 0.9485, Some(0.0324), true),
    row(
        ("PF, N = 200", PF_200),
        (200, false, false),
        0.4398,
        None,
        true,
    ),
    row(
        ("PFDE", PFDE),
        (10, false, true),
        0.8054,
        Some(0.0320),
        true,
    ),
    row(("UPF", UPF), (10, true, false), 0.4893, Some(0.0100), true),
    row(
        ("UPFDE", UPFDE),
        (10, true, true),
        0.2580,
        Some(0.0084),
        false,
    ),
];

/// The paper's table by the numerics that it was made with.
fn table_of_the_paper(study: &Study, omega: f64) -> Result<Vec<Figure>> {
    let model = reference::gamma::GammaNoise {
        omega,
        variance: VARIANCES[0],
    };
    let runs = study.runs.unwrap_or(RUNS);
    let rmses: Vec<[f64; 5]> = (0..runs)
        .into_par_iter()
        .progress_with(progress(runs.into(), format!("legacy, omega {omega}"))?)
        .map(|run| {
            let rng = &mut random::generator(study.seed, run.into());
            let (truth, measurements) = model.run(STEPS, rng);
            PAPER.map(|row| row.method.rmse(&model, &truth, &measurements, rng))
        })
        .collect();
    println!(
        "The paper's table by the numerics that it was made with: omega = {omega}, {runs} runs"
    );
    let header = [
        "method",
        "mean RMSE",
        "variance",
        "the paper",
        "ours / paper",
    ];
    let mut table = table(header, 1);
    let mut figures = Vec::new();
    for (index, row) in PAPER.iter().enumerate() {
        let column: Vec<f64> = rmses.iter().map(|rmses| rmses[index]).collect();
        let mean = Estimate::mean(&column);
        let variance = mean.error.powi(2) * column.len() as f64;
        let printed = row
            .variance
            .map(|v| format!(" / {v:.4}"))
            .unwrap_or_default();
        table.add_row([
            row.label.to_owned(),
            mean.to_string(),
            format!("{variance:.4}"),
            format!("{:.4}{printed}", row.mean),
            format!("{:.2}", mean.value / row.mean),
        ]);
        let figure = |what: &str, value| {
            Figure::new(
                format!("papers.evolution.legacy.omega_{omega}.{}.{what}", row.key),
                value,
                "",
            )
        };
        figures.push(figure("rmse", mean.value));
        let off = figure("off_the_paper", (mean.value / row.mean - 1.0).abs());
        figures.push(if omega == OMEGAS[0] && row.clear {
            off.at_most(0.1)
        } else {
            off
        });
    }
    println!("{table}\n");
    Ok(figures)
}

/// `methods` on the model with this drift and this variance of the measurements.
pub(super) fn experiment(
    study: &Study,
    omega: f64,
    variance: f64,
    methods: Vec<Method>,
    runs: u32,
) -> Result<Experiment> {
    let model = reference::gamma::GammaNoise { omega, variance };
    let problem = |run| {
        let (truth, measurements) = model.run(STEPS, &mut random::generator(study.seed, run));
        let measured = |(z, step): (&f64, u32)| {
            let dynamics = GammaNoise {
                step,
                omega: omega as f32,
            };
            let measurement = Measurement {
                step,
                value: *z as f32,
                variance: variance as f32,
            };
            (dynamics, measurement)
        };
        Problem {
            start: gamma::START,
            steps: measurements.iter().zip(1..).map(measured).collect(),
            exact: model.means(&measurements),
            truth,
        }
    };
    Experiment::run(
        format!("omega {omega}, R {variance:e}"),
        problem,
        methods,
        study.runs.unwrap_or(runs),
        study.seed,
    )
}

fn report(experiment: &Experiment, omega: f64, variance: f64) -> Vec<Figure> {
    println!(
        "Log-weights and true moments: omega = {omega}, R = {variance:e}, N = {N}, {} runs",
        experiment.runs()
    );
    let header = [
        "method",
        "mean RMSE",
        "variance",
        "median",
        "RMSE / floor",
        "95 % of the cloud hold",
        "calls of the model",
        "M4F instructions",
    ];
    let mut table = table(header, 1);
    let mut figures = Vec::new();
    let best = OURS
        .iter()
        .filter_map(|key| experiment.named(key))
        .map(|method| experiment.mean_over_floor(method).value)
        .fold(f64::INFINITY, f64::min);
    let prefix = format!("papers.evolution.omega_{omega}.r_{variance:e}");
    for method in &experiment.methods {
        let over_floor = experiment.mean_over_floor(method);
        let (mean, spread) = (method.mean(), method.variance());
        let digits = (3.0 - mean.value.log10().floor()) as usize;
        table.add_row([
            method.label.into(),
            format!("{:.digits$} ± {:.digits$}", mean.value, mean.error),
            format!("{spread:.1e}"),
            format!("{:.digits$}", method.median()),
            over_floor.to_string(),
            scalar::percent(method.coverage()),
            short(method.calls()),
            short(method.instructions),
        ]);
        let figure = |what: &str, value, unit| {
            Figure::new(format!("{prefix}.{}.{what}", method.key), value, unit)
        };
        let precise = variance == VARIANCES[0] && [PFDE, UPFDE].contains(&method.key);
        let rmse = figure("rmse", mean.value, "");
        let over = figure("rmse_over_floor", over_floor.value, "");
        figures.extend([
            if precise { rmse.at_most(0.006) } else { rmse },
            figure("rmse_error", mean.error, ""),
            figure("rmse_variance", spread, ""),
            if method.key == EVOLUTION {
                over.at_most(1.03)
            } else {
                over
            },
        ]);
        figures.extend(method.cost_and_coverage(figure));
    }
    println!("{table}");
    println!(
        "Of {N} particles of equal weight, drawn from the exact posterior, the outermost hold the state in {:.1} % of \
         the steps.\n",
        100.0 * (N - 1) as f64 / (N + 1) as f64
    );
    figures.push(Figure::new(format!("{prefix}.best.rmse_over_floor"), best, "").at_most(1.03));
    figures
}

/// All methods that are compared, on this drift and this variance.
pub(super) fn methods(study: &Study, omega: f64, variance: f64) -> Result<Vec<Method>> {
    let name = format!("gamma:{omega}:{variance:e}");
    scalar::methods_of(study, &name, methods::gamma)
}
