//! Du, Zhao, Jiang, Yu: bearing-only location, Telecommunication Engineering 56(12), 2016.
//!
//! Their particle filter as they give it, on tracks of the size of theirs, beside our locator, Gauss-Newton
//! and the exact posterior.

use anyhow::Result;
use foxhunt_host::{figures::Figure, tracks::Track};

use super::{
    bearings::{Experiment, Outcomes, methods_of},
    statistics::{Estimate, Experiments},
    study::Study,
};
use crate::methods::bearings::{self as methods, LOCATOR_100, PUBLISHED_100, PUBLISHED_1000};

/// What an independent implementation in f64 found for the published filter, in 1,000 runs.
struct Reference {
    /// RMSE as a multiple of the bound, with 100 and with 1000 particles.
    rmse: [f64; 2],
    /// RMSE of the exact posterior mean as a multiple of the bound.
    floor: f64,
    /// Median error with 100 particles, in metres.
    median: f64,
}

const REFERENCE_RUNS: usize = 1000;

/// Runs the experiment on both tracks.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let tracks = [
        (
            Track::a1(),
            Reference {
                rmse: [1.87, 1.09],
                floor: 1.017,
                median: 6.07,
            },
        ),
        (
            Track::a2(),
            Reference {
                rmse: [2.56, 1.14],
                floor: 1.010,
                median: 2.74,
            },
        ),
    ];
    let mut all = Vec::new();
    for (track, reference) in tracks {
        let key = format!("aoa:{}", track.name.to_lowercase());
        let methods = methods_of(study, &key, methods::aoa)?;
        let experiment = Experiment::run(track, &methods, study.runs.unwrap_or(1000), study.seed)?;
        experiment.print(&[(PUBLISHED_100, "0.266 %, 0.206 %")]);
        let more = experiment.more_runs(&methods[0], REFERENCE_RUNS, study.seed)?;
        for method in &experiment.methods {
            all.extend(figures(&experiment, method, &reference, &more));
        }
        let drawn = experiment.errors_picture(&[PUBLISHED_100, PUBLISHED_1000, LOCATOR_100]);
        study.save(&drawn.svg()?, &format!("aoa-{}", experiment.name()))?;
        println!();
    }
    println!(
        "The paper prints mean relative errors in x and y, over the estimates of one run on a track of its own: \
         particle filter 0.266 % and 0.206 %, fish school 0.101 % and 0.091 %. Those above are of the last \
         estimates of all runs. The published filters start from all bearings, which is why they seem to know \
         the source before it can be known.\n"
    );
    Ok(all)
}

fn figures(
    experiment: &Experiment,
    method: &Outcomes,
    reference: &Reference,
    more: &Experiments,
) -> Vec<Figure> {
    let mut figures = experiment.figures("aoa", method);
    let prefix = format!("papers.aoa.{}.{}", experiment.name(), method.key);
    let figure = |what: &str, value, unit| Figure::new(format!("{prefix}.{what}"), value, unit);
    figures.push(figure(
        "coverage_missed",
        1.0 - method.coverage(),
        "of runs",
    ));
    // The reproduction: within three standard deviations of what others found.
    let off = |estimate: Estimate, expected| {
        estimate.distance(expected, REFERENCE_RUNS as f64, experiment.runs() as f64)
    };
    match method.key {
        LOCATOR_100 => {
            for figure in &mut figures {
                figure.limit = match figure.name.rsplit('.').next() {
                    Some("rmse_over_floor") => Some(1.2),
                    Some("beyond_5_sigma") => Some(0.01),
                    Some("coverage") => Some(0.98),
                    Some("coverage_missed") => Some(0.10),
                    _ => None,
                };
            }
        }
        PUBLISHED_100 => {
            let surprise = more.surprise(reference.rmse[0]);
            figures.push(figure("rmse_surprise", surprise, "").at_most(0.998));
            let off = off(method.median(), reference.median);
            figures.push(figure("median_off_reference", off, "sigma").at_most(3.0));
        }
        PUBLISHED_1000 => {
            // Beside the floor of the same runs their common luck does not count.
            let over_floor = experiment.over_floor(method);
            let off = off(over_floor, reference.rmse[1] / reference.floor);
            figures.push(figure("rmse_off_reference", off, "sigma").at_most(3.0));
        }
        _ => {}
    }
    figures
}
