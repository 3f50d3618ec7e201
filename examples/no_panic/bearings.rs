//! Locators of sources by their bearings.

use core::hint::black_box;

use foxhunt::{
    aoa::{
        Bearing, BearingLikelihood, Locate, Observation,
        correction::{Correction, Pull},
        gauss_newton::{self, Errors},
        geodesy::{Geodetic, LocalPlane},
        locator::{self, Answer, Locator},
        pursuit::{self, Pursuit},
        robust::{self, RobustLocator, Tails},
        sources::{self, Sources},
        triangulation,
    },
    filter::ParticleFilter,
    model::Likelihood,
    random::Xoshiro128PlusPlus,
    refine::DifferentialEvolution,
    snapshot::{self, Keeper, Persist},
};

use crate::values::{any, some, some_mut};

pub fn observation() -> Option<Observation> {
    let bearing = match any(0) {
        0 => Bearing::from_radians(any(0.0)),
        1 => Bearing::from_compass_degrees(any(0.0)),
        _ => Bearing::from_relative_degrees(any(0.0), any(0.0)),
    };
    black_box(bearing.compass_degrees());
    Observation::new(any([0.0; 2]), bearing, any(0.0)).ok()
}

pub fn bearings(rng: &mut Xoshiro128PlusPlus) {
    let mut correction = Correction::new(any(Pull::Continuous));
    correction.add(Bearing::from_radians(any(0.0)), any(0.0));
    black_box((correction.bearing(), correction.readings()));

    let Some(observation) = observation() else {
        return;
    };
    let observations = any([observation; 8]);
    let observations = some(&observations);
    black_box(triangulation::intersection(
        &observation,
        &any(observation),
        any(0.0),
    ));
    black_box(triangulation::random_intersection(
        observations,
        any(0.0),
        rng,
    ));
    let errors = any(Errors::Gaussian);
    _ = black_box(gauss_newton::solve(observations, errors, any([0.0; 2])));
    let (mut a, mut out) = (any([0.0; 20]), any([0.0; 20]));
    let likelihood = BearingLikelihood::new(&observation);
    likelihood.log_likelihoods(
        &[some(&any([0.0; 20])), some_mut(&mut a)],
        some_mut(&mut out),
    );
    black_box(out);

    if let Ok(origin) = Geodetic::new(any(0), any(0))
        && let Ok(plane) = LocalPlane::new(origin)
    {
        _ = black_box(plane.to_local(any(origin)));
        _ = black_box(plane.to_geodetic(any([0.0; 2])));
    }
}

pub fn locate(rng: &mut Xoshiro128PlusPlus) {
    let settings = locator::Settings::new()
        .relative_range_error(any(0.0))
        .and_then(|settings| settings.resample_share(any(0.0)))
        .and_then(|settings| settings.moves(any(0)));
    let mut locator = any(Locator::<50, 16>::new(settings.unwrap_or_default()));
    if let Some(observation) = observation()
        && let Answer::Fix(fix) = locator.push(observation, rng)
    {
        black_box(fix.ellipse(any(0.0)));
    }
    black_box((
        locator.answer(),
        locator.columns(),
        locator.weights(),
        locator.observations(),
    ));
    locator.reset();
}

pub fn pursue(rng: &mut Xoshiro128PlusPlus) {
    let settings = pursuit::Settings::new(any(robust::Settings::default()))
        .speed(any(0.0))
        .and_then(|settings| settings.parked_s(any(0.0)))
        .and_then(|settings| settings.driving_s(any(0.0)))
        .and_then(|settings| settings.straight_s(any(0.0)));
    let mut pursuit = any(Pursuit::<50, 16>::new(settings.unwrap_or_default()));
    for _ in 0..any(100) {
        let Some(observation) = observation() else {
            continue;
        };
        black_box(pursuit.push_after(observation, any(0.0), rng));
        black_box((pursuit.answer(), pursuit.motion()));
        black_box((pursuit.source(any(0)), pursuit.hypothesis(any(0))));
        black_box((pursuit.bias(), pursuit.shares(), pursuit.advice()));
        black_box(pursuit.classify(&observation));
    }
    pursuit.reset();
}

pub fn locate_robustly(rng: &mut Xoshiro128PlusPlus) {
    let errors = robust::Errors::new()
        .tails(any(Tails::Normal))
        .and_then(|errors| errors.shares(any(0.0), any(0.0)))
        .and_then(|errors| errors.prior_bearings(any(0.0)))
        .and_then(|errors| errors.bias_deviation(any(0.0)))
        .and_then(|errors| errors.position_deviation(any(0.0)))
        .and_then(|errors| errors.correlation(any(0.0), any(0.0), any(0.0)));
    let settings = robust::Settings::new(errors.unwrap_or_default())
        .common(any(locator::Settings::new()))
        .range_m(any(0.0));
    let mut locator = any(RobustLocator::<50, 16>::new(settings.unwrap_or_default()));
    for _ in 0..any(100) {
        let Some(observation) = observation() else {
            continue;
        };
        black_box(locator.push(observation, rng));
        black_box(locator.push_after(observation, any(0.0), rng));
        black_box((locator.answer(), locator.bias(), locator.shares()));
        black_box((locator.columns(), locator.weights()));
        locator.hypotheses().for_each(|hypothesis| {
            black_box(hypothesis);
        });
        black_box(locator.observations().len());
    }
    locator.reset();
}

pub fn locate_several(rng: &mut Xoshiro128PlusPlus) {
    let settings = sources::Settings::new()
        .false_birth(any(0.0))
        .and_then(|settings| settings.memory(any(0.0), any(0.0)))
        .and_then(|settings| settings.least_share(any(0.0)));
    let tracks =
        [const { RobustLocator::<50, 16>::new(robust::Settings::new(robust::Errors::new())) }; 3];
    let mut sources = any(Sources::<3, _, 16>::new(
        settings.unwrap_or_default(),
        tracks,
    ));
    for _ in 0..any(100) {
        let Some(observation) = observation() else {
            continue;
        };
        black_box(sources.push(observation, rng));
        black_box(sources.push_after(observation, any(0.0), rng));
        black_box((sources.answer(), sources.bias(), sources.shares()));
        black_box((sources.source(any(0)), sources.hypothesis(any(0))));
        black_box((sources.advice(), sources.classify(&observation)));
        black_box((sources.cloud(any(0)), sources.tracks().count()));
    }
    sources.reset();
}

pub fn snapshots(rng: &mut Xoshiro128PlusPlus) {
    fn both_ways<T: Persist>(state: &mut T) {
        let mut buffer = any([0; 2000]);
        _ = black_box(snapshot::save(state, some_mut(&mut buffer)));
        _ = black_box(snapshot::restore(state, some(&any(buffer))));
        let [mut one, mut other] = any([[0; 2000]; 2]);
        let mut keeper = Keeper::new([some_mut(&mut one), some_mut(&mut other)]);
        _ = black_box(keeper.restore(state));
        _ = black_box(keeper.save(state));
    }
    let settings = any(locator::Settings::new());
    let place = Geodetic::new(any(0), any(0));
    let Ok(mut place) = place else { return };
    let Ok(mut plane) = LocalPlane::new(place) else {
        return;
    };
    both_ways(&mut place);
    both_ways(&mut (&mut plane, rng));
    both_ways(&mut any(ParticleFilter::<4, 50>::new()));
    both_ways(&mut any(Locator::<50, 16>::new(settings)));
    let evolution = any(DifferentialEvolution::DEFAULT);
    both_ways(&mut any(
        Locator::<50, 16, DifferentialEvolution>::with_refinement(settings, evolution),
    ));
    both_ways(&mut any(RobustLocator::<50, 16>::new(any(
        robust::Settings::default(),
    ))));
    both_ways(&mut any(Pursuit::<20, 8>::new(any(
        pursuit::Settings::default(),
    ))));
    both_ways(&mut any(Locator::<50, 16>::new(settings).answer()));
    let track = || any(RobustLocator::<20, 8>::new(robust::Settings::default()));
    both_ways(&mut any(Sources::<2, _, 16>::new(
        any(sources::Settings::new()),
        [track(), track()],
    )));
}
