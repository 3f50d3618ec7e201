//! Du, Zhao, Jiang, Yu: bearing-only location, Telecommunication Engineering 56(12), 2016.
//!
//! Their fish school on the particles of their filter, as published, and as moves that leave the posterior of all
//! bearings invariant, beside the filter without it, our locator, Gauss-Newton and the exact posterior.

use anyhow::Result;
use foxhunt_host::{figures::Figure, tracks::Track};

use super::{
    bearings::{Experiment, Method, Outcomes, methods_of},
    study::Study,
};
use crate::methods::bearings::{self as methods, *};

/// What an independent implementation in f64 found for a method on a track, in 1,000 runs.
struct Reference {
    track: &'static str,
    method: &'static str,
    what: Found,
    value: f64,
}

#[derive(PartialEq)]
enum Found {
    /// Median error in metres.
    Median,
    /// RMSE as a multiple of the bound.
    OverBound,
    /// Fraction of the runs in which the 95 % ellipse holds the source.
    Coverage,
}

const REFERENCE_RUNS: usize = 1000;

const fn found(track: &'static str, method: &'static str, what: Found, value: f64) -> Reference {
    Reference {
        track,
        method,
        what,
        value,
    }
}

const REFERENCES: [Reference; 18] = [
    found("A1", PUBLISHED, Found::Median, 6.07),
    found("A2", PUBLISHED, Found::Median, 2.74),
    found("A5", PUBLISHED, Found::Median, 2.40),
    found("B2", PUBLISHED, Found::Median, 12.1),
    found("A1", FISH, Found::Median, 6.01),
    found("A2", FISH, Found::Median, 2.78),
    found("A5", FISH, Found::Median, 2.43),
    found("B2", FISH, Found::Median, 11.7),
    found("A1", PUBLISHED, Found::OverBound, 1.87),
    found("A2", PUBLISHED, Found::OverBound, 2.56),
    found("A1", FISH, Found::OverBound, 2.00),
    found("A2", FISH, Found::OverBound, 1.45),
    found("A1", FISH_50, Found::OverBound, 1.95),
    found("A2", FISH_50, Found::OverBound, 1.74),
    found("A1", FISH_LITERAL, Found::OverBound, 29.6),
    found("A2", FISH_LITERAL, Found::OverBound, 54.0),
    found("A1", FISH_50, Found::Coverage, 0.77),
    found("A2", FISH_50, Found::Coverage, 0.70),
];

/// What the paper prints: mean relative errors in x and y.
const PRINTED: [(&str, &str); 2] = [(PUBLISHED, "0.266 %, 0.206 %"), (FISH, "0.101 %, 0.091 %")];

/// Runs the experiment on all tracks.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let mut all = Vec::new();
    for track in [Track::a1(), Track::a2(), Track::a5(), Track::b2()] {
        let methods = methods(study, &track)?;
        let runs = study.runs.unwrap_or(1000);
        let experiment = Experiment::run(track, &methods, runs, study.seed)?;
        experiment.print(&PRINTED);
        for outcomes in &experiment.methods {
            all.extend(experiment.figures("fish", outcomes));
            if outcomes.key == LOCATOR {
                all.extend(goals(&experiment, outcomes));
            }
        }
        for (method, outcomes) in methods.iter().zip(&experiment.methods) {
            all.extend(reproduction(&experiment, method, outcomes, study.seed)?);
        }

        let name = format!("fish-{}", experiment.name());
        let drawn = experiment.errors_picture(&[PUBLISHED, FISH, FISH_50, METROPOLIS, LOCATOR]);
        study.save(&drawn.svg()?, &name)?;
        let drawn = experiment.run_picture(&[PUBLISHED, FISH, LOCATOR]);
        study.save(&drawn.svg()?, &format!("{name}-run"))?;
        println!();
    }
    println!(
        "The paper prints mean relative errors in x and y, over the estimates of one run on a track of its own: \
         particle filter 0.266 % and 0.206 %, fish school 0.101 % and 0.091 %; that is 2.3 to 2.6 times better. The \
         median of the plain filter is within a fifth of that of the exact posterior on A1, A2 and B2: no refinement \
         could be so much better there. A run or two in a thousand that are lost make the RMSE of the published \
         filters, and how many are depends on where the particles start. The reference says: where pairs of bearings \
         cross that are at least 20 places apart; but so started, hardly any run on A1 is lost, and experiments of 1,000 \
         runs stay far below its own figures. From any pairs that are not parallel all of them come back, medians \
         included, so that is taken as published.\n"
    );
    Ok(all)
}

/// What is asked of the locator.
fn goals(experiment: &Experiment, locator: &Outcomes) -> [Figure; 3] {
    let figure = |what: &str, value, unit| {
        let name = format!("papers.fish.{}.{LOCATOR}.{what}", experiment.name());
        Figure::new(name, value, unit)
    };
    let off = (locator.coverage() - experiment.floor().coverage()).abs();
    let over_floor = experiment.over_floor(locator).value;
    let limit = if experiment.track.name == "A1" {
        1.03
    } else {
        1.02
    };
    [
        figure("goal.rmse_over_floor", over_floor, "").at_most(limit),
        figure("goal.coverage_off_floor", 100.0 * off, "% of runs").at_most(2.0),
        figure(
            "goal.beyond_5_sigma",
            experiment.beyond_five_sigma(locator),
            "of runs",
        )
        .at_most(0.0),
    ]
}

/// How far it is from what others found.
///
/// A run or two in a thousand of the published filters are lost, and they make its RMSE. Such a figure of the
/// reference is compared with those of many experiments of as many runs: it has to lie where 99.8 % of them do. Where
/// the particles start decides how many runs are lost. The reference describes its start as pairs of bearings at
/// least 20 places apart in the order of their angles. With these, [`APART`], hardly any run on A1 is: its own figures
/// are far outside. Started from any two bearings that are not parallel, its figures and its medians come back
/// on every track, so that is the start that is taken as published.
fn reproduction(
    experiment: &Experiment,
    method: &Method,
    outcomes: &Outcomes,
    seed: u64,
) -> Result<Vec<Figure>> {
    let (reference_runs, runs) = (REFERENCE_RUNS as f64, experiment.runs() as f64);
    let key = method.key;
    let of = if key == APART { PUBLISHED } else { key };
    // How many iterations look at how many places is not said: there is no telling how near it should be.
    let exactly_known = [PUBLISHED, FISH].contains(&key);
    let limited = |figure: Figure, limit| {
        if exactly_known {
            figure.at_most(limit)
        } else {
            figure
        }
    };
    let mut figures = Vec::new();
    for reference in &REFERENCES {
        if (reference.track, reference.method) != (experiment.track.name, of) {
            continue;
        }
        let figure = |what: &str, value, unit| {
            let name = format!("papers.fish.{}.{key}.{what}", experiment.name());
            Figure::new(name, value, unit)
        };
        match reference.what {
            Found::Median => {
                let median = outcomes.median();
                let off = median.distance(reference.value, reference_runs, runs);
                figures.push(limited(figure("median_off_reference", off, "sigma"), 3.0));
            }
            Found::OverBound if exactly_known || key == APART => {
                let more = experiment.more_runs(method, REFERENCE_RUNS, seed)?;
                let below = more.fraction_below(reference.value);
                println!(
                    "the reference's {:.2} is above {:.1} % of them",
                    reference.value,
                    100.0 * below
                );
                let surprise = figure("rmse_surprise", more.surprise(reference.value), "");
                figures.push(limited(surprise, 0.998));
            }
            Found::OverBound => {
                let ratio = experiment.over_bound(outcomes).value / reference.value;
                figures.push(figure("rmse_over_reference", ratio, ""));
            }
            Found::Coverage => {
                let off = 100.0 * (outcomes.coverage() - reference.value);
                figures.push(figure("coverage_off_reference", off, "% of runs"));
            }
        }
    }
    Ok(figures)
}

/// All methods that are compared on a track.
pub(super) fn methods(study: &Study, track: &Track) -> Result<Vec<Method>> {
    let name = format!("fish:{}", track.name.to_lowercase());
    methods_of(study, &name, |visit| match track.particles {
        80 => methods::fish::<80>(visit),
        _ => methods::fish::<100>(visit),
    })
}
