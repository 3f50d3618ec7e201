//! The methods of a study, ready to run.

use anyhow::{Context, Result};
use foxhunt::{
    aoa::{BearingLikelihood, Clean, Locate},
    estimate::Ellipse,
    random::{SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_host::tracks::Track;
use rand::Rng;

use super::problem::{Outcome, Problem};
use crate::{
    methods::bearings::{self as methods, Bearings, Visit, Watch},
    papers::{
        counted::{Counted, Counter},
        study::Study,
    },
};

/// A method to run.
pub struct Method {
    pub label: &'static str,
    /// In the names of figures.
    pub key: &'static str,
    /// Instructions of a run.
    pub instructions: f64,
    pub(super) run: Box<Run>,
}

type Run = dyn Fn(&Problem, &mut Xoshiro128PlusPlus) -> Result<Outcome> + Sync;

impl Method {
    /// The last error in one run.
    pub(super) fn error(&self, track: &Track, rng: &mut impl Rng) -> Result<[f64; 2]> {
        let problem = Problem::new(track, rng)?;
        let mut own = Xoshiro128PlusPlus::from_rng(rng);
        Ok((self.run)(&problem, &mut own)?.error)
    }
}

/// The methods that the study of this name hands to a visitor, with what the board took for each.
pub fn methods_of(
    study: &Study,
    name: &str,
    visit: impl FnOnce(&mut Collected),
) -> Result<Vec<Method>> {
    let mut collected = Collected(Vec::new());
    visit(&mut collected);
    let instructions = study.instructions(name)?;
    let mut methods = collected.0;
    for method in &mut methods {
        method.instructions = instructions.per_run(method.label)?.value;
    }
    Ok(methods)
}

/// Methods as a study hands them over.
pub struct Collected(Vec<Method>);

impl Visit for Collected {
    fn method(
        &mut self,
        label: &'static str,
        key: &'static str,
        method: impl methods::Method + Send + Sync + 'static,
    ) {
        self.0.push(Method {
            label,
            key,
            instructions: 0.0,
            run: Box::new(move |problem, rng| locate(problem, &method, rng)),
        });
    }
}

fn locate(
    problem: &Problem,
    method: &impl methods::Method,
    rng: &mut Xoshiro128PlusPlus,
) -> Result<Outcome> {
    let counter = Counter::default();
    let likelihoods: Vec<Counted<'_, BearingLikelihood>> = problem
        .observations
        .iter()
        .map(|observation| counter.of(BearingLikelihood::new(observation)))
        .collect();
    let bearings = Bearings {
        observations: &problem.observations,
        likelihoods: &likelihoods,
        process: problem.track.process as f32,
    };
    let mut watcher = Watcher {
        problem,
        path: Vec::new(),
        counter: &counter,
        locator: None,
    };
    let estimate = method
        .locate(bearings, rng, &mut watcher)
        .context("the method found no source")?;
    let source = problem.track.source.map(|v| v as f32);
    Ok(Outcome {
        error: problem.error(estimate.position),
        covered: Ellipse::of_normal(estimate.position, estimate.covariance.into(), 0.95)
            .contains(source),
        path: watcher.path,
        evaluations: counter.calls(),
    })
}

struct Watcher<'a> {
    problem: &'a Problem,
    path: Vec<Option<[f64; 2]>>,
    counter: &'a Counter,
    /// The particles of a locator that had a fix before the last bearing.
    locator: Option<[Vec<f32>; 2]>,
}

impl Watch for Watcher<'_> {
    fn estimate(&mut self, position: Option<[f32; 2]>) {
        let error = position.map(|position| self.problem.error(position));
        self.path.push(error);
    }

    /// What a locator evaluates for each particle can be told from whether they moved.
    fn pushed<const N: usize>(&mut self, locator: &Clean<N>, moves: u8) {
        if locator.fix().is_none() {
            return;
        }
        let (kept, moves) = (locator.observations().len(), usize::from(moves));
        let columns = locator.columns().map(<[f32]>::to_vec);
        self.counter.add(match &self.locator {
            None => N * kept * (moves + 2),
            Some(before) if *before == columns => N,
            Some(_) => N * (1 + kept * (moves + 1)),
        });
        self.locator = Some(columns);
    }
}
