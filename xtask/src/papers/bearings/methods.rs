//! The methods that are compared.

use anyhow::{Context, Result};
use foxhunt::{
    aoa::{
        BearingLikelihood, Observation,
        gauss_newton::{self, Errors},
        locator::{Answer, Locator, Settings},
        triangulation::{intersection, random_intersection},
    },
    estimate::Ellipse,
    filter::ParticleFilter,
    math::wrap,
    model::{Likelihood, RandomWalk},
    random::Xoshiro128PlusPlus,
    refine::{FishSchool, Memory, Refinement},
    resample::Scheme,
};
use foxhunt_host::reference::{Posterior, mahalanobis};
use rand::RngExt;

use super::{Outcome, Problem};
use crate::papers::counted::Counter;

/// 95 % of a normal distribution in the plane lie within this Mahalanobis distance.
const NINETY_FIVE: f64 = 2.447_746_830_680_816;

/// The bootstrap filter of the papers: a random walk of the source, systematic resampling after every
/// bearing. The printed weights count each bearing twice; here it counts once.
pub fn published<const N: usize>(
    problem: &Problem,
    rng: &mut Xoshiro128PlusPlus,
) -> Result<Outcome> {
    bootstrap::<N, FishSchool>(problem, None, rng)
}

/// The same, its particles refined as published: by the likelihood of the bearing, before they are weighed by it.
pub fn refined<const N: usize>(
    problem: &Problem,
    refinement: &impl Refinement<2>,
    rng: &mut Xoshiro128PlusPlus,
) -> Result<Outcome> {
    bootstrap::<N, _>(problem, Some(refinement), rng)
}

fn bootstrap<const N: usize, F: Refinement<2>>(
    problem: &Problem,
    refinement: Option<&F>,
    rng: &mut Xoshiro128PlusPlus,
) -> Result<Outcome> {
    let walk = RandomWalk {
        deviation: [problem.track.process.sqrt() as f32; 2],
    };
    let starts = starts(&problem.observations);
    let counter = Counter::default();
    let mut memory = Memory::new();
    let mut filter = ParticleFilter::<2, N>::new();
    filter.initialise(rng, |rng| starts[rng.random_range(0..starts.len())]);
    let mut path = Vec::new();
    let mut covered = false;
    for observation in &problem.observations {
        let likelihood = BearingLikelihood::new(observation);
        let likelihood = counter.of(&likelihood);
        filter.predict(&walk, 1.0, rng);
        if let Some(refinement) = refinement {
            filter.refine(refinement, &likelihood, &mut memory, rng);
        }
        // Where all weights are zero the cloud stays as it is: a lost run.
        let _ = filter.update(&likelihood);
        path.push(Some(problem.error(filter.mean())));
        covered = holds(problem, filter.mean(), filter.covariance());
        filter.resample(Scheme::Systematic, rng);
    }
    Ok(Outcome {
        error: path.last().copied().flatten().unwrap_or([f64::NAN; 2]),
        covered,
        path,
        evaluations: counter.calls(),
    })
}

/// Where the particles of the published filter start: the intersections of all pairs of bearings that are a
/// fixed gap apart in their order by angle (eq. 22 and 23).
fn starts(observations: &[Observation]) -> Vec<[f32; 2]> {
    const GAP: usize = 20;
    let mut sorted = observations.to_vec();
    sorted.sort_by(|a, b| a.bearing().radians().total_cmp(&b.bearing().radians()));
    sorted
        .iter()
        .zip(&sorted[GAP..])
        .filter_map(|(a, b)| intersection(a, b, LEAST_SINE))
        .collect()
}

/// Two bearings must cross at an angle of at least this sine.
const LEAST_SINE: f32 = 0.02;

/// A source at rest, all bearings kept: started as the locator is, its particles moved after every resampling by a
/// refinement that leaves the posterior of all bearings so far invariant.
pub fn moved<const N: usize>(
    problem: &Problem,
    refinement: &impl Refinement<2>,
    rng: &mut Xoshiro128PlusPlus,
) -> Result<Outcome> {
    /// The bearings must cross at this angle, in radians, before particles start.
    const CROSSING: f32 = 0.35;
    /// Refinements that bring the first cloud, of a few survivors, to rest.
    const FIRST: usize = 10;
    let counter = Counter::default();
    let mut memory = Memory::new();
    let mut filter = ParticleFilter::<2, N>::new();
    let mut likelihoods = Vec::new();
    let mut path = Vec::new();
    let mut started = false;
    for (index, observation) in problem.observations.iter().enumerate() {
        let latest = BearingLikelihood::new(observation);
        likelihoods.push(latest);
        let seen = &problem.observations[..=index];
        let posterior = |state: &[f32; 2]| -> f32 {
            counter.add(likelihoods.len());
            likelihoods.iter().map(|l| l.log_likelihood(state)).sum()
        };
        if started {
            // A normal likelihood is never zero.
            filter.update(&counter.of(&latest))?;
            if filter.effective_sample_size() < 0.5 * N as f32 {
                filter.resample(Scheme::Systematic, rng);
                filter.refine(refinement, &posterior, &mut memory, rng);
            }
        } else if turned(seen) > CROSSING {
            started = true;
            filter.initialise(rng, |rng| {
                (0..100)
                    .find_map(|_| random_intersection(seen, LEAST_SINE, rng))
                    .unwrap_or_default()
            });
            filter.update(&posterior)?;
            filter.resample(Scheme::Systematic, rng);
            for _ in 0..FIRST {
                filter.refine(refinement, &posterior, &mut memory, rng);
            }
        }
        path.push(started.then(|| problem.error(filter.mean())));
    }
    // The covariance of n samples about their own mean is small by 1 - 1/n, and that mean is off by 1/n of it.
    let n = filter.effective_sample_size();
    let sampling = (1.0 + 1.0 / n) / (1.0 - 1.0 / n);
    let covariance = filter.covariance().map(|row| row.map(|v| v * sampling));
    Ok(Outcome {
        error: problem.error(filter.mean()),
        covered: holds(problem, filter.mean(), covariance),
        path,
        evaluations: counter.calls(),
    })
}

/// The largest angle of a bearing to the first.
fn turned(observations: &[Observation]) -> f32 {
    let angle = |o: &Observation| o.bearing().radians();
    observations
        .iter()
        .map(|o| wrap(angle(o) - angle(&observations[0])).abs())
        .fold(0.0, f32::max)
}

/// The library's own, which moves its particles so often after a resampling.
pub fn locator<const N: usize>(
    problem: &Problem,
    moves: u8,
    rng: &mut Xoshiro128PlusPlus,
) -> Result<Outcome> {
    let mut locator = Locator::<N>::new(Settings::new().moves(moves)?);
    let moves = usize::from(moves);
    let mut evaluations = 0;
    let mut fixes = Vec::new();
    for observation in &problem.observations {
        let before = locator.columns().map(<[f32]>::to_vec);
        let had_fix = matches!(locator.answer(), Answer::Fix(_));
        let answer = locator.push(*observation, rng);
        let has_fix = matches!(answer, Answer::Fix(_));
        // What it does for each particle can be told from whether they moved.
        let kept = locator.observations().len();
        let moved = has_fix && locator.columns().map(<[f32]>::to_vec) != before;
        evaluations += match (had_fix, moved) {
            (true, true) => N * (1 + kept * (moves + 1)),
            (true, false) => N,
            (false, true) => N * kept * (moves + 2),
            (false, false) => 0,
        };
        fixes.push(match answer {
            Answer::Fix(fix) => Some(fix),
            Answer::NotObservable(_) => None,
        });
    }
    let last = fixes
        .last()
        .copied()
        .flatten()
        .context("the locator found no source")?;
    let source = problem.track.source.map(|v| v as f32);
    Ok(Outcome {
        error: problem.error(last.position),
        covered: last.ellipse(0.95).contains(source),
        path: fixes
            .iter()
            .map(|fix| fix.map(|fix| problem.error(fix.position)))
            .collect(),
        evaluations: evaluations as u64,
    })
}

/// From the middle of the published filter's starts.
pub fn gauss_newton(problem: &Problem) -> Result<Outcome> {
    let starts = starts(&problem.observations);
    let middle = [0, 1].map(|d| {
        let mut column: Vec<f32> = starts.iter().map(|start| start[d]).collect();
        column.sort_by(f32::total_cmp);
        column[column.len() / 2]
    });
    let solution = gauss_newton::solve(&problem.observations, Errors::Gaussian, middle)?;
    Ok(Outcome {
        error: problem.error(solution.position),
        covered: holds(problem, solution.position, solution.covariance),
        path: Vec::new(),
        evaluations: 0,
    })
}

pub fn floor(problem: &Problem) -> Result<Outcome> {
    let posterior = Posterior::new(&problem.sights).context("the posterior has no bounds")?;
    let error = [0, 1].map(|d| posterior.mean[d] - problem.track.source[d]);
    let covered = mahalanobis(error, &posterior.covariance) <= NINETY_FIVE;
    Ok(Outcome {
        error,
        covered,
        path: Vec::new(),
        evaluations: 0,
    })
}

fn holds(problem: &Problem, position: [f32; 2], covariance: [[f32; 2]; 2]) -> bool {
    let source = problem.track.source.map(|v| v as f32);
    Ellipse::of_normal(position, covariance, 0.95).contains(source)
}
