//! All runs on one track.

use anyhow::{Context, Result};
use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
use foxhunt_host::{
    figures::Figure,
    reference::{cramer_rao, mahalanobis},
    simulate,
    tracks::Track,
};
use foxhunt_simulation::{Sight, random};
use indicatif::ParallelProgressIterator;
use nalgebra::Matrix2;
use rayon::prelude::*;

use super::{
    method::Method,
    outcomes::Outcomes,
    problem::{Outcome, Problem},
};
use crate::papers::{
    instructions::short,
    statistics::{Estimate, Experiments, bootstrap, root_mean_square},
    study::progress,
    table::table,
};

/// All runs on one track.
pub struct Experiment {
    pub track: Track,
    /// Of the error after the last bearing, in square metres.
    bound: Matrix2<f64>,
    /// Root of its trace after each bearing.
    pub(super) bounds: Vec<Option<f64>>,
    /// The exact posterior is the last of them.
    pub methods: Vec<Outcomes>,
}

const FLOOR: &str = "floor";

impl Experiment {
    /// Runs every method, and the exact posterior, on the same bearings.
    pub fn run(track: Track, methods: &[Method], runs: u32, seed: u64) -> Result<Self> {
        let clean: Vec<Sight> = simulate::bearings(
            &Track {
                sigma: 0.0,
                ..track.clone()
            },
            &mut random::generator(0, 0),
        )
        .into_iter()
        .map(|sight| Sight {
            sigma: track.sigma,
            ..sight
        })
        .collect();
        let bound =
            cramer_rao(&clean, track.source).context("the track does not determine the source")?;
        let bounds = (1..=clean.len())
            .map(|n| cramer_rao(&clean[..n], track.source).map(|bound| bound.trace().sqrt()))
            .collect();

        let exact = Method {
            label: "exact posterior (floor)",
            key: FLOOR,
            instructions: 0.0,
            run: Box::new(|problem, _| Outcome::exact(problem)),
        };
        let methods: Vec<&Method> = methods.iter().chain([&exact]).collect();
        let runs: Vec<Vec<Outcome>> = (0..runs)
            .into_par_iter()
            .progress_with(progress(runs.into(), track.name)?)
            .map(|run| {
                let mut rng = random::generator(seed, run.into());
                let problem = Problem::new(&track, &mut rng)?;
                let one = |method: &&Method| {
                    let mut own = Xoshiro128PlusPlus::from_rng(&mut rng);
                    (method.run)(&problem, &mut own)
                };
                methods.iter().map(one).collect()
            })
            .collect::<Result<_>>()?;
        let methods = methods
            .into_iter()
            .enumerate()
            .map(|(index, method)| Outcomes {
                label: method.label,
                key: method.key,
                instructions: method.instructions,
                runs: runs.iter().map(|run| run[index].clone()).collect(),
            })
            .collect();
        Ok(Self {
            track,
            bound,
            bounds,
            methods,
        })
    }

    pub fn name(&self) -> String {
        self.track.name.to_lowercase()
    }

    pub fn runs(&self) -> usize {
        self.methods[0].runs.len()
    }

    /// Root of the trace of the Cramer-Rao bound, in metres.
    pub fn bound(&self) -> f64 {
        self.bound.trace().sqrt()
    }

    /// Prints the table, with what the paper prints of some methods, by their keys.
    pub fn print(&self, printed: &[(&str, &str)]) {
        println!(
            "Track {}, {} bearings, {} runs; Cramer-Rao bound {:.2} m",
            self.track.name,
            self.track.receivers.len(),
            self.runs(),
            self.bound(),
        );
        let header = [
            "method",
            "RMSE / bound",
            "RMSE / floor",
            "median m",
            "off > 5 sigma",
            "95 % ellipse holds",
            "mean |dx| / x, |dy| / y",
            "the paper's",
            "likelihoods",
            "M4F instructions",
        ];
        let mut table = table(header, 1);
        for method in &self.methods {
            let [x, y] = method.relative_errors(self.track.source);
            let printed = printed.iter().find(|(key, _)| *key == method.key);
            table.add_row([
                method.label.to_owned(),
                self.over_bound(method).to_string(),
                self.over_floor(method).to_string(),
                format!("{:.2}", method.median().value),
                format!("{:.1} %", 100.0 * self.beyond_five_sigma(method)),
                format!("{:.1} %", 100.0 * method.coverage()),
                format!("{:.3} %, {:.3} %", 100.0 * x, 100.0 * y),
                printed.map_or("", |(_, printed)| *printed).to_owned(),
                short(method.evaluations()),
                short(method.instructions),
            ]);
        }
        println!("{table}");
    }

    /// What is said of every method.
    pub fn figures(&self, paper: &str, method: &Outcomes) -> Vec<Figure> {
        let prefix = format!("papers.{paper}.{}.{}", self.name(), method.key);
        let figure = |what: &str, value, unit| Figure::new(format!("{prefix}.{what}"), value, unit);
        let over_bound = self.over_bound(method);
        let mut figures = vec![
            figure("rmse_over_bound", over_bound.value, ""),
            figure("rmse_over_bound_error", over_bound.error, ""),
            figure("rmse_over_floor", self.over_floor(method).value, ""),
            figure("beyond_5_sigma", self.beyond_five_sigma(method), "of runs"),
            figure("coverage", method.coverage(), "of runs"),
            figure("median", method.median().value, "m"),
        ];
        if method.evaluations() > 0.0 {
            figures.push(figure("evaluations", method.evaluations(), "per run"));
        }
        if method.instructions > 0.0 {
            figures.push(figure("instructions", method.instructions, "per run"));
        }
        figures
    }

    /// The RMSE that experiments of `runs` runs find for a method, as a multiple of the bound.
    ///
    /// A few runs in a thousand of the published filters are lost, and they make the RMSE: what 1,000 runs can show of
    /// it is only seen from many more.
    pub fn more_runs(&self, method: &Method, runs: usize, seed: u64) -> Result<Experiments> {
        const MORE_RUNS: u32 = 20_000;
        let pool: Vec<f64> = (0..MORE_RUNS)
            .into_par_iter()
            .progress_with(progress(MORE_RUNS.into(), "lost runs")?)
            .map(|run| {
                let mut rng = random::generator(!seed, run.into());
                let [x, y] = method.error(&self.track, &mut rng)?;
                Ok(x.hypot(y) / self.bound())
            })
            .collect::<Result<_>>()?;
        let experiments = Experiments::draw(&pool, runs, !seed);
        println!(
            "{}, in {MORE_RUNS} more runs: RMSE / bound of {runs} runs {:.2}, 99 % of the time {:.2} to {:.2}",
            method.label,
            experiments.quantile(0.5),
            experiments.quantile(0.005),
            experiments.quantile(0.995),
        );
        Ok(experiments)
    }

    pub fn floor(&self) -> &Outcomes {
        &self.methods[self.methods.len() - 1]
    }

    pub fn over_bound(&self, method: &Outcomes) -> Estimate {
        bootstrap(self.runs(), |runs| {
            root_mean_square(runs.map(|run| method.error(run))) / self.bound()
        })
    }

    /// Against the exact posterior mean of the same runs.
    pub fn over_floor(&self, method: &Outcomes) -> Estimate {
        let floor = self.floor();
        bootstrap(self.runs(), |runs| {
            let (mut ours, mut theirs) = (0.0, 0.0);
            for run in runs {
                ours += method.error(run).powi(2);
                theirs += floor.error(run).powi(2);
            }
            (ours / theirs).sqrt()
        })
    }

    /// Fraction of the runs whose error is longer than five standard deviations of the bound in its direction.
    pub fn beyond_five_sigma(&self, method: &Outcomes) -> f64 {
        // NaN is beyond.
        1.0 - method.fraction(|outcome| mahalanobis(outcome.error, &self.bound) <= 5.0)
    }
}
