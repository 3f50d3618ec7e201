//! Somebody who walks among fixed stations.

use super::*;
use crate::aoa::robust::Correlation;

type Among = Manoeuvring<Robust<256, 64>, 4>;

const PLACES: [[f32; 2]; 4] = [[0.0, 3.0], [6.0, 0.0], [12.0, 3.0], [6.0, 6.0]];
const BIASES: [f32; 4] = [0.2, -0.15, 0.1, -0.25];

fn config() -> Config {
    let mut config = Config::ROOM;
    config.stationary.errors.correlation = Correlation::NONE;
    config
}

/// Where somebody is who walks up and down the room.
fn walker(second: u32) -> [f32; 2] {
    let along = (0.15 * second as f32).sin();
    [6.0 + 4.0 * along, 3.0 + 1.5 * (0.4 * second as f32).sin()]
}

fn round(second: u32, rng: &mut Xoshiro128PlusPlus) -> Vec<Observation> {
    round_of(walker(second), second, rng)
}

fn round_of(tag: [f32; 2], second: u32, rng: &mut Xoshiro128PlusPlus) -> Vec<Observation> {
    let one = |(k, (place, bias)): (u32, (&[f32; 2], f32))| {
        let off = bias + 0.03 * normal(rng);
        towards(1000 * second + k, *place, tag, off, 0.03).from_station(k as u8)
    };
    (0..).zip(PLACES.iter().zip(BIASES)).map(one).collect()
}

/// Mean and variance of where the tag is, by bearings of this standard deviation, from all places about the room.
fn exact(bearings: &[Observation], sigma_rad: f32) -> ([f32; 2], f32) {
    const STEP_M: f32 = 0.2;
    let [mut mass, mut x, mut y, mut squares] = [0.0; 4];
    for place in (0..120 * 90).map(|i| [(i % 120) as f32 - 30.0, (i / 120) as f32 - 30.0]) {
        let place = place.map(|steps| STEP_M * steps);
        let offs = bearings.iter().map(|one| {
            let [x, y] = one.position();
            let angle = crate::math::atan2(place[1] - y, place[0] - x);
            crate::math::wrap(one.bearing().radians() - angle) / sigma_rad
        });
        let weight = crate::math::exp(-0.5 * offs.map(|off| off * off).sum::<f32>());
        mass += weight;
        x += weight * place[0];
        y += weight * place[1];
        squares += weight * (place[0] * place[0] + place[1] * place[1]);
    }
    let mean = [x / mass, y / mass];
    (mean, squares / mass - mean[0] * mean[0] - mean[1] * mean[1])
}

/// The first fix of all stations, in standard deviations from the mean of all that is possible then.
#[test]
fn the_first_fix_is_what_all_stations_tell() {
    const RUNS: u64 = 100;
    let mut config = config();
    config.stationary.errors.rates = Mixture::new(0.0, 0.001);
    let sigma = config.stationary.errors.stop_sigma_rad;
    let (mut off, mut ratio) = (0.0, 0.0);
    for seed in 0..RUNS {
        let mut rng = generator(seed);
        let mut locator = Locator::<Among>::new(config).unwrap();
        let tag = [
            1.0 + 10.0 * uniform(&mut rng),
            1.0 + 4.0 * uniform(&mut rng),
        ];
        let round: Vec<Observation> = (0..)
            .zip(PLACES)
            .map(|(k, place)| {
                let bias = sigma * normal(&mut rng);
                towards(k, place, tag, bias, 0.03).from_station(k as u8)
            })
            .collect();
        for observation in &round {
            locator.push(observation, &mut rng).unwrap();
        }
        let fix = locator.fix().unwrap();
        let (mean, variance) = exact(&round, sigma.hypot(0.03));
        off += distance(fix.position, mean).powi(2) / variance / RUNS as f32;
        ratio += (fix.covariance.xx + fix.covariance.yy) / variance / RUNS as f32;
    }
    assert!(off < 0.02, "{off}");
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
}

#[test]
fn biases_are_learned_on_the_way() {
    for seed in 0..10 {
        let mut locator = Locator::<Among>::new(config()).unwrap();
        let mut rng = generator(seed);
        for second in 0..60 {
            for observation in round(second, &mut rng) {
                locator.push(&observation, &mut rng).unwrap();
                if second < 50 {
                    continue;
                }
                let bias = locator.bias().unwrap();
                let truth = BIASES[usize::from(observation.station())];
                assert!((bias.mean_rad - truth).abs() < 5.0 * bias.sigma_rad);
                assert!(bias.sigma_rad < 0.06, "{bias:?}");
            }
        }
        let fix = locator.fix().unwrap();
        assert!(distance(fix.position, walker(59)) < 0.8, "{fix:?}");
    }
}

/// Of 40 walks, each with two departures; unless departures are drawn more often than they happen, 38 % of the places are more than a metre off.
#[test]
fn who_walks_on_is_followed_by_the_default_for_cars_too() {
    let config = Config {
        stationary: config().stationary,
        ..Config::DEFAULT
    };
    let (mut off, mut all) = (0, 0);
    for seed in 0..40 {
        let mut locator = Locator::<Among>::new(config).unwrap();
        let mut rng = generator(seed);
        for second in 0..50_u32 {
            // Stands for 15 s, goes 8 m in 8 s, stands for as long and goes back.
            let way = second.saturating_sub(15).min(8) - second.saturating_sub(38).min(8);
            let tag = [2.0 + way as f32, 2.5];
            for observation in round_of(tag, second, &mut rng) {
                locator.push(&observation, &mut rng).unwrap();
            }
            if second >= 15 {
                all += 1;
                let near = (locator.fix()).is_some_and(|fix| distance(fix.position, tag) < 1.0);
                off += u32::from(!near);
            }
        }
    }
    std::println!("{off} of {all} are more than a metre off");
    assert!(10 * off < all);
}

/// Bearings of anything but the source are counted, one by one, until some fit again or everything starts anew.
#[test]
fn bearings_without_the_source_are_counted() {
    let mut locator = Locator::<Among>::new(config()).unwrap();
    let mut rng = generator(1);
    let mut lost = Vec::new();
    for second in 0..60 {
        for observation in round(second, &mut rng) {
            let [x, y] = observation.position();
            let angle = TAU * uniform(&mut rng);
            let nowhere = [
                x + crate::math::sin_cos(angle).1,
                y + crate::math::sin_cos(angle).0,
            ];
            let observation = if second < 20 {
                observation
            } else {
                towards(observation.time_ms(), [x, y], nowhere, 0.0, 0.03)
                    .from_station(observation.station())
            };
            locator.push(&observation, &mut rng).unwrap();
            lost.push(locator.state().lost.bearings);
        }
    }
    let counts = |pair: &[u32]| pair[1] == pair[0] + 1 || pair[1] == 0;
    assert!(lost.windows(2).all(counts), "{lost:?}");
    assert!(
        lost[..80].iter().all(|lost| *lost < 5) && lost.iter().any(|lost| *lost > 10),
        "{lost:?}"
    );
}

#[test]
fn a_bearing_is_taken_once_and_in_its_order() {
    let mut locator = Locator::<Among>::new(config()).unwrap();
    let mut rng = generator(1);
    for second in 0..20 {
        for observation in round(second, &mut rng) {
            locator.push(&observation, &mut rng).unwrap();
        }
    }
    let answer = locator.answer();
    let late = round(19, &mut rng);
    assert_eq!(locator.push(&late[3], &mut rng), Err(PushError::Duplicate));
    let old = at(18_500, &late[0]);
    assert_eq!(locator.push(&old, &mut rng), Err(PushError::TooOld));
    assert_eq!(locator.answer(), answer);
    assert!(is_zero::<Among>(|place| {
        place.write(Locate::EMPTY);
    }));
}
