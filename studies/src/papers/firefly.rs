//! Du, Li, Jiang: a particle filter improved by fireflies, China Measurement & Test 43(11), 2017.
//!
//! Their two experiments, the growth model and a source located by bearings: fireflies as published and as moves
//! that leave the posterior invariant, beside the plain filter, ours and the exact answer.

use anyhow::Result;
use foxhunt_host::{figures::Figure, reference, tracks::Track};
use foxhunt_problems::growth::{self, Growth, Measurement};
use foxhunt_simulation::random;

use super::{
    bearings,
    instructions::short,
    scalar::{self, Experiment, Outcomes, STEPS},
    study::Study,
    table::table,
};
use crate::methods::{
    bearings::{self as on_bearings, LOCATOR, PUBLISHED},
    scalar::{self as methods, *},
};

pub(super) type Problem = scalar::Problem<Growth, Measurement>;
pub(super) type Method = scalar::Method<Problem>;

/// What the paper prints for one run of the improved firefly filter.
const PRINTED: f64 = 1.4322;

/// Runs both experiments.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let mut figures = growth(study)?;
    figures.extend(bearings(study)?);
    Ok(figures)
}

/// `methods` on the growth model.
pub(super) fn growth_experiment(
    study: &Study,
    methods: Vec<Method>,
    runs: u32,
) -> Result<Experiment> {
    let exact = reference::growth::GridFilter::new(STEPS);
    let problem = |run| {
        let (truth, measurements) =
            reference::growth::run(STEPS, &mut random::generator(study.seed, run));
        let measured = |(y, step): (&f64, u32)| (Growth { step }, Measurement { value: *y as f32 });
        Problem {
            start: growth::START,
            steps: measurements.iter().zip(1..).map(measured).collect(),
            exact: exact.means(&measurements),
            truth,
        }
    };
    let runs = study.runs.unwrap_or(runs);
    Experiment::run("growth model".into(), problem, methods, runs, study.seed)
}

/// The growth model with 50 particles.
fn growth(study: &Study) -> Result<Vec<Figure>> {
    let experiment = growth_experiment(study, growth_methods(study)?, 2000)?;
    print_growth(&experiment);
    let of = |method| growth_figures(&experiment, method);
    let mut figures: Vec<Figure> = experiment.methods.iter().flat_map(of).collect();
    let rmses = experiment.floor().rmses();
    let lucky = rmses.iter().filter(|rmse| **rmse < PRINTED).count() as f64 / rmses.len() as f64;
    println!(
        "The exact filter is below {PRINTED} in {:.1} % of the runs: the paper's figure is a lucky run.",
        100.0 * lucky
    );
    figures.push(Figure::new(
        "papers.firefly.growth.floor.below_the_papers",
        lucky,
        "of runs",
    ));
    let drawn = [BOOTSTRAP, IMPROVED, POINT_MASS, scalar::FLOOR];
    let picture = experiment.picture("Growth model, N = 50", &drawn)?;
    study.save(&picture, "firefly-growth")?;
    println!();
    Ok(figures)
}

fn print_growth(experiment: &Experiment) {
    let runs = experiment.runs();
    println!("Growth model, {STEPS} steps, N = 50, {runs} runs");
    let header = [
        "method",
        "pooled RMSE",
        "/ floor",
        "mean of runs",
        "median",
        "95 % of the cloud hold",
        "the paper's run",
        "calls of the model",
        "M4F instructions",
    ];
    let mut table = table(header, 1);
    for method in &experiment.methods {
        let printed = match method.key {
            BOOTSTRAP => "3.0190",
            IMPROVED => "1.4322",
            _ => "",
        };
        table.add_row([
            method.label.into(),
            method.pooled().to_string(),
            experiment.pooled_over_floor(method).to_string(),
            method.mean().to_string(),
            format!("{:.2}", method.median()),
            scalar::percent(method.coverage()),
            printed.into(),
            short(method.calls()),
            short(method.instructions),
        ]);
    }
    println!("{table}");
}

fn growth_figures(experiment: &Experiment, method: &Outcomes) -> Vec<Figure> {
    let figure = |what: &str, value, unit| {
        let name = format!("papers.firefly.growth.{}.{what}", method.key);
        Figure::new(name, value, unit)
    };
    let over_floor = experiment.pooled_over_floor(method);
    let over = figure("pooled_rmse_over_floor", over_floor.value, "");
    let mut figures = vec![
        figure("pooled_rmse", method.pooled().value, ""),
        figure("pooled_rmse_error", method.pooled().error, ""),
        if method.key == POINT_MASS {
            over.at_most(1.01)
        } else {
            over
        },
        figure("pooled_rmse_over_floor_error", over_floor.error, ""),
    ];
    figures.extend(method.cost_and_coverage(figure));
    figures
}

/// All methods that are compared on the growth model.
pub(super) fn growth_methods(study: &Study) -> Result<Vec<Method>> {
    scalar::methods_of(study, "growth", methods::growth)
}

/// What an independent implementation in f64 found on B2, in 1,000 runs: RMSE as multiples of the bound.
const REFERENCES: [(&str, f64); 3] = [(PUBLISHED, 1.50), (STANDARD, 1.51), (IMPROVED, 1.48)];
const REFERENCE_RUNS: usize = 1000;

/// Bearings on track B2 with 80 particles.
fn bearings(study: &Study) -> Result<Vec<Figure>> {
    let methods = bearings::methods_of(study, "fireflies:b2", on_bearings::fireflies::<80>)?;
    let runs = study.runs.unwrap_or(1000);
    let experiment = bearings::Experiment::run(Track::b2(), &methods, runs, study.seed)?;
    experiment.print(&[(IMPROVED, "0.23 % at most")]);
    let mut figures: Vec<Figure> = experiment
        .methods
        .iter()
        .flat_map(|method| experiment.figures("firefly", method))
        .collect();
    for (key, value) in REFERENCES {
        for method in methods.iter().filter(|method| method.key == key) {
            let more = experiment.more_runs(method, REFERENCE_RUNS, study.seed)?;
            println!(
                "an independent implementation found {value:.2}: above {:.1} % of them",
                100.0 * more.fraction_below(value)
            );
            let name = format!("papers.firefly.b2.{key}.rmse_surprise");
            let surprise = Figure::new(name, more.surprise(value), "");
            // Parameters of the fireflies that are not printed had to be chosen.
            figures.push(if key == PUBLISHED {
                surprise.at_most(0.998)
            } else {
                surprise
            });
        }
    }
    println!(
        "The paper prints a largest error of 0.23 %, about four times better than its particle filter; that filter is \
         within a fifth of the exact posterior, in all but the lost runs."
    );
    let keys = [PUBLISHED, STANDARD, IMPROVED, IMPROVED_METROPOLIS, LOCATOR];
    study.save(&experiment.errors_picture(&keys).svg()?, "firefly-b2")?;
    let picture = experiment.run_picture(&[PUBLISHED, IMPROVED, LOCATOR]);
    study.save(&picture.svg()?, "firefly-b2-run")?;
    println!();
    Ok(figures)
}
