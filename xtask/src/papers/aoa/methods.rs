//! The methods that are compared.

use anyhow::{Context, Result};
use foxhunt::{
    aoa::{
        BearingLikelihood, Observation,
        gauss_newton::{self, Errors},
        locator::{Answer, Locator, Settings},
        triangulation::intersection,
    },
    estimate::Ellipse,
    filter::ParticleFilter,
    model::RandomWalk,
    random::{SeedableRng, Xoshiro128PlusPlus},
    resample::Scheme,
};
use foxhunt_host::{
    Sight,
    reference::{Posterior, mahalanobis},
    simulate,
    tracks::Track,
};
use rand::{Rng, RngExt};

/// What a method made of one run.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Error after the last bearing, in metres east and north.
    pub error: [f64; 2],
    /// Whether the 95 % ellipse holds the source.
    pub covered: bool,
    /// Error after each bearing; empty for a method that is asked once, at the end.
    pub path: Vec<Option<[f64; 2]>>,
}

pub const LOCATOR: &str = "locator.n100";
pub const PUBLISHED_100: &str = "published.n100";
pub const PUBLISHED_1000: &str = "published.n1000";
/// Place of the exact posterior among the methods.
pub const FLOOR: usize = 4;

/// Label and key of every method, in the order of [`run`].
pub const ALL: [(&str, &str); 5] = [
    ("particle filter as published, N = 100", PUBLISHED_100),
    ("particle filter as published, N = 1000", PUBLISHED_1000),
    ("locator, N = 100", LOCATOR),
    ("Gauss-Newton on all bearings", "gauss_newton"),
    ("exact posterior (floor)", "floor"),
];

/// 95 % of a normal distribution in the plane lie within this Mahalanobis distance.
const NINETY_FIVE: f64 = 2.447_746_830_680_816;

/// All methods on the same bearings.
pub fn run(track: &Track, rng: &mut impl Rng) -> Result<Vec<Outcome>> {
    let sights = simulate::bearings(track, rng);
    let observations = observations(&sights)?;
    let mut own = || Xoshiro128PlusPlus::from_rng(rng);
    Ok(vec![
        published::<100>(track, &observations, &mut own()),
        published::<1000>(track, &observations, &mut own()),
        locator(track, &observations, &mut own())?,
        gauss_newton(track, &observations)?,
        floor(track, &sights)?,
    ])
}

/// The last error of the published filter with 100 particles.
pub fn published_alone(track: &Track, rng: &mut impl Rng) -> Result<[f64; 2]> {
    let observations = observations(&simulate::bearings(track, rng))?;
    let mut own = Xoshiro128PlusPlus::from_rng(rng);
    Ok(published::<100>(track, &observations, &mut own).error)
}

fn observations(sights: &[Sight]) -> Result<Vec<Observation>> {
    Ok(sights
        .iter()
        .map(|sight| (*sight).try_into())
        .collect::<Result<_, _>>()?)
}

/// The bootstrap filter of the paper: a random walk of the source, systematic resampling after every
/// bearing. The printed weights count each bearing twice; here it counts once.
fn published<const N: usize>(
    track: &Track,
    observations: &[Observation],
    rng: &mut Xoshiro128PlusPlus,
) -> Outcome {
    let walk = RandomWalk {
        deviation: [track.process.sqrt() as f32; 2],
    };
    let starts = starts(observations);
    let mut filter = ParticleFilter::<2, N>::new();
    filter.initialise(rng, |rng| starts[rng.random_range(0..starts.len())]);
    let mut path = Vec::new();
    let mut covered = false;
    for observation in observations {
        filter.predict(&walk, 1.0, rng);
        // Where all weights are zero the cloud stays as it is: a lost run.
        let _ = filter.update(&BearingLikelihood::new(observation));
        path.push(Some(error(track, filter.mean())));
        covered = holds(track, filter.mean(), filter.covariance());
        filter.resample(Scheme::Systematic, rng);
    }
    Outcome {
        error: path.last().copied().flatten().unwrap_or([f64::NAN; 2]),
        covered,
        path,
    }
}

/// Where the particles of the published filter start: the intersections of all pairs of bearings that are a
/// fixed gap apart in their order by angle (eq. 22 and 23).
fn starts(observations: &[Observation]) -> Vec<[f32; 2]> {
    const GAP: usize = 20;
    const LEAST_SINE: f32 = 0.02;
    let mut sorted = observations.to_vec();
    sorted.sort_by(|a, b| a.bearing().radians().total_cmp(&b.bearing().radians()));
    sorted
        .iter()
        .zip(&sorted[GAP..])
        .filter_map(|(a, b)| intersection(a, b, LEAST_SINE))
        .collect()
}

fn locator(
    track: &Track,
    observations: &[Observation],
    rng: &mut Xoshiro128PlusPlus,
) -> Result<Outcome> {
    let mut locator = Locator::<100>::new(Settings::default());
    let answers: Vec<Answer> = observations
        .iter()
        .map(|observation| locator.push(*observation, rng))
        .collect();
    let fix = |answer: &Answer| match answer {
        Answer::Fix(fix) => Some(*fix),
        Answer::NotObservable(_) => None,
    };
    let last = answers
        .last()
        .and_then(fix)
        .context("the locator found no source")?;
    Ok(Outcome {
        error: error(track, last.position),
        covered: last.ellipse(0.95).contains(track.source.map(|v| v as f32)),
        path: answers
            .iter()
            .map(|answer| Some(error(track, fix(answer)?.position)))
            .collect(),
    })
}

/// From the middle of the published filter's starts.
fn gauss_newton(track: &Track, observations: &[Observation]) -> Result<Outcome> {
    let starts = starts(observations);
    let middle = [0, 1].map(|d| {
        let mut column: Vec<f32> = starts.iter().map(|start| start[d]).collect();
        column.sort_by(f32::total_cmp);
        column[column.len() / 2]
    });
    let solution = gauss_newton::solve(observations, Errors::Gaussian, middle)?;
    Ok(Outcome {
        error: error(track, solution.position),
        covered: holds(track, solution.position, solution.covariance),
        path: Vec::new(),
    })
}

fn floor(track: &Track, sights: &[Sight]) -> Result<Outcome> {
    let posterior = Posterior::new(sights).context("the posterior has no bounds")?;
    let error = [0, 1].map(|d| posterior.mean[d] - track.source[d]);
    let covered = mahalanobis(error, &posterior.covariance) <= NINETY_FIVE;
    Ok(Outcome {
        error,
        covered,
        path: Vec::new(),
    })
}

fn error(track: &Track, position: [f32; 2]) -> [f64; 2] {
    [0, 1].map(|d| f64::from(position[d]) - track.source[d])
}

fn holds(track: &Track, position: [f32; 2], covariance: [[f32; 2]; 2]) -> bool {
    Ellipse::of_normal(position, covariance, 0.95).contains(track.source.map(|v| v as f32))
}
