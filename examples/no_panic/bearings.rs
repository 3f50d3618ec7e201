//! Locators of sources by their bearings.

use core::hint::black_box;

use foxhunt::{
    aoa::{
        Bearing, BearingLikelihood, Channels, Clean, Locate, Manoeuvring, MultiTarget, Observation,
        Robust, clean,
        geodesy::{Geodetic, LocalPlane},
        manoeuvring, multi, robust,
        triangulation::{gauss_newton, intersection},
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
    let observation = Observation::new(any(0), any([0.0; 2]), bearing, any(0.0)).ok()?;
    Some(observation.from_station(any(0)))
}

pub fn bearings() {
    let Some(observation) = observation() else {
        return;
    };
    let observations = any([observation; 8]);
    let observations = some(&observations);
    black_box(intersection(&observation, &any(observation), any(0.0)));
    black_box(gauss_newton(observations, any([0.0; 2])));
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

/// Everything that a locator can be asked.
fn locate_by<L: Locate>(config: &L::Config, rng: &mut Xoshiro128PlusPlus) {
    if L::check(config).is_err() {
        return;
    }
    let mut locator = any(L::EMPTY);
    for _ in 0..any(100) {
        let (Some(one), Some(other)) = (observation(), observation()) else {
            continue;
        };
        if let Ok(answer) = locator.push(&one, config, rng)
            && let Some(fix) = answer.fix()
        {
            black_box(fix.ellipse(any(0.0)));
        }
        let reading = any([one.into(), other.into()]);
        _ = black_box(locator.push_alternatives(some(&reading), config, rng));
        black_box((locator.answer(), locator.source(any(0))));
        black_box((locator.hypothesis(any(0)), locator.cloud(any(0))));
        black_box((
            locator.bias(config),
            locator.rates(config),
            locator.sigma_scale(config),
        ));
        black_box((locator.advice(config), locator.classify(&one, config)));
    }
    locator.reset();
}

fn clean_config() -> clean::Config {
    clean::Config {
        relative_range_sigma: any(0.25),
        resample_below: any(0.5),
        moves: any(2),
        refinement: (),
    }
}

pub fn locate(rng: &mut Xoshiro128PlusPlus) {
    locate_by::<Clean<50, 16>>(&clean_config(), rng);
}

pub fn locate_robustly(rng: &mut Xoshiro128PlusPlus) {
    locate_by::<Robust<50, 16>>(&any(robust::Config::DEFAULT), rng);
}

pub fn pursue(rng: &mut Xoshiro128PlusPlus) {
    locate_by::<Manoeuvring<Robust<50, 16>>>(&any(manoeuvring::Config::DEFAULT), rng);
    let clean = manoeuvring::Config::new(clean_config());
    locate_by::<Manoeuvring<Clean<50, 16>>>(&any(clean), rng);
}

pub fn locate_several(rng: &mut Xoshiro128PlusPlus) {
    locate_by::<MultiTarget<3, Robust<50, 16>, 16>>(&any(multi::Config::DEFAULT), rng);
    locate_by::<Channels<3, Robust<50, 16>>>(&any(robust::Config::DEFAULT), rng);
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
    let place = Geodetic::new(any(0), any(0));
    let Ok(mut place) = place else { return };
    let Ok(mut plane) = LocalPlane::new(place) else {
        return;
    };
    both_ways(&mut place);
    both_ways(&mut (&mut plane, rng));
    both_ways(&mut any(ParticleFilter::<4, 50>::new()));
    both_ways(&mut any(Clean::<50, 16>::EMPTY));
    both_ways(&mut any(Clean::<50, 16, DifferentialEvolution>::EMPTY));
    both_ways(&mut any(Robust::<50, 16>::EMPTY));
    both_ways(&mut any(Manoeuvring::<Robust<20, 8>>::EMPTY));
    both_ways(&mut any(Clean::<50, 16>::EMPTY.answer()));
    both_ways(&mut any(MultiTarget::<2, Robust<20, 8>, 16>::EMPTY));
}
