//! The paper's method on the measured walks: a match, and a filter after it.

use anyhow::Result;
use foxhunt::{
    kalman::Covariance,
    random::{SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_host::walks::{Office, PARTICLES, Walk};

use super::both::Both;
use crate::papers::fingerprint::two_stage::{Cloud, Model};

/// A walk, and the place that each step is matched with: in the frame of the maps, in which corridors go along x.
type Matched<'a> = (&'a Walk, Vec<[f64; 2]>);

/// The match alone.
pub fn memoryless(office: &Office) -> Result<Both> {
    let mut both = Both::default();
    for walk in &office.walks {
        let times = walk.times();
        let places = walk.matched(&walk.packets, &times)?;
        both.push(walk, walk.errors(&times, &places));
    }
    Ok(both)
}

/// The published filter, with so many seeds; if fitted, with what the matches of the very walks err by, which is more than
/// it could know.
pub fn two_stage(office: &Office, seeds: u64, seed: u64, is_fitted: bool) -> Result<Both> {
    let mut both = Both::default();
    for straight in [true, false] {
        let walks = office.walks.iter();
        let matched: Vec<Matched<'_>> = walks
            .filter(|walk| walk.is_straight == straight)
            .map(|walk| {
                let places = walk.matched(&walk.packets, &walk.times())?;
                Ok((
                    walk,
                    places.into_iter().map(|place| walk.turn(place)).collect(),
                ))
            })
            .collect::<Result<_>>()?;
        let mut model = Model::AS_PRINTED;
        if !straight {
            // Nothing tells one direction from another.
            model.acceleration_sigma_m_s2 = [0.5; 2];
            model.velocity_sigma_m_s = [1.5; 2];
        }
        if is_fitted {
            model.observation = Covariance::diagonal(sigmas(&matched));
        }
        for (walk, places) in &matched {
            for filter_seed in 0..seeds {
                let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed << 8 ^ filter_seed);
                let found = filtered(walk, places, &model, &mut rng)?;
                both.push(walk, walk.errors(&walk.times(), &found));
            }
        }
    }
    Ok(both)
}

/// What the matches err by along each axis.
fn sigmas(matched: &[Matched<'_>]) -> [f32; 2] {
    let (mut count, mut squares) = (0.0, [0.0; 2]);
    for (walk, places) in matched {
        for (place, time) in places.iter().zip(walk.times()) {
            let truth = walk.turn(walk.truth_at(time));
            count += 1.0;
            for axis in 0..2 {
                squares[axis] += (place[axis] - truth[axis]).powi(2);
            }
        }
    }
    squares.map(|square: f64| (square / count).sqrt() as f32)
}

/// The places that the published filter finds on a walk.
fn filtered(
    walk: &Walk,
    places: &[[f64; 2]],
    model: &Model,
    rng: &mut Xoshiro128PlusPlus,
) -> Result<Vec<[f64; 2]>> {
    let mut cloud = Cloud::<PARTICLES>::EMPTY;
    let mut found = Vec::new();
    for (step, place) in places.iter().enumerate() {
        let place = place.map(|x| x as f32);
        if step == 0 {
            cloud.start_around(place, model, rng);
        } else {
            cloud.step(2.0, place, model, rng)?;
        }
        let [x, y, ..] = cloud.mean();
        found.push(walk.turn([x.into(), y.into()]));
    }
    Ok(found)
}
