use core::fmt::Debug;

use foxhunt::{
    aoa::{
        Alternative, Bearing, Clean, Fix, Locate, Locator, Manoeuvring, MultiTarget, Observation,
        Robust, clean,
        geodesy::{Geodetic, LocalPlane},
        manoeuvring, multi,
        robust::{self, Errors as Faulty},
        spectrum::Spectrum,
        triangulation::gauss_newton,
    },
    math,
    random::{SeedableRng, Xoshiro128PlusPlus, normal},
    refine::{Acceptance, DifferentialEvolution, Firefly, FishSchool, Lengths, Refinement},
};

use super::{Case, Digest, assert_normal};

pub const CASES: &[Case] = &[
    ("aoa::locator_finds_the_source", locator_finds_the_source),
    ("aoa::locator_with_fish", locator_with_fish),
    ("aoa::locator_with_fireflies", locator_with_fireflies),
    ("aoa::locator_with_evolution", locator_with_evolution),
    (
        "aoa::robust_locator_finds_the_source",
        robust_locator_finds_the_source,
    ),
    (
        "aoa::robust_locator_of_inexact_places",
        robust_locator_of_inexact_places,
    ),
    ("aoa::two_sources_are_found", two_sources_are_found),
    (
        "aoa::a_manoeuvring_source_is_followed",
        a_manoeuvring_source_is_followed,
    ),
    (
        "aoa::robust_locator_with_spectra",
        robust_locator_with_spectra,
    ),
    (
        "aoa::gauss_newton_finds_the_source",
        gauss_newton_finds_the_source,
    ),
    ("aoa::geodesy", geodesy),
];

const SOURCE: [f32; 2] = [1200.0, 800.0];

/// Bearings of two degrees on the source, from a drive past it.
pub fn drive() -> [Observation; 40] {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
    core::array::from_fn(|i| {
        let east = 50.0 * i as f32;
        let direction = math::atan2(SOURCE[1], SOURCE[0] - east) + 0.035 * normal(&mut rng);
        let bearing = Bearing::from_radians(direction);
        Observation::new(1000 * i as u32, [east, 0.0], bearing, 0.035).expect("all is in range")
    })
}

/// The same place and time with another bearing.
fn turned(observation: &Observation, radians: f32) -> Observation {
    let (time_ms, bearing) = (observation.time_ms(), Bearing::from_radians(radians));
    Observation::new(time_ms, observation.position(), bearing, 0.035).expect("in range")
}

fn is_near([x, y]: [f32; 2], metres: f32) -> bool {
    (x - SOURCE[0]).abs() < metres && (y - SOURCE[1]).abs() < metres
}

/// Adds a fix, whose particles are numbers that every core has.
fn add_fix<L: Locate>(digest: &mut Digest, locator: &Locator<L>, fix: &Fix) {
    digest.add(&fix.position);
    digest.add(fix.covariance.rows().as_flattened());
    assert_cloud(locator, 0);
}

/// The particles of a source are numbers that every core has.
fn assert_cloud<L: Locate>(locator: &Locator<L>, index: usize) {
    if let Some(cloud) = locator.cloud(index) {
        assert_normal(&[cloud.east, cloud.north, cloud.weights]);
    }
}

fn locator_finds_the_source() -> Digest {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
    let mut locator = Locator::<Clean<100, 64>>::new(clean::Config::DEFAULT).expect("in range");
    let mut digest = Digest::new();
    for observation in drive() {
        if let Some(fix) = locator
            .push(&observation, &mut rng)
            .expect("in order")
            .fix()
        {
            add_fix(&mut digest, &locator, &fix);
            digest.add(&[fix.effective_sample_size]);
        }
    }
    let fix = locator.fix().expect("a fix");
    assert!(is_near(fix.position, 40.0), "{:?}", fix.position);
    assert!(fix.ellipse(0.999).contains(SOURCE));
    digest
}

fn robust<const B: usize>(errors: Faulty) -> Locator<Robust<128, B>> {
    let config = robust::Config {
        errors,
        ..robust::Config::DEFAULT
    };
    Locator::new(config).expect("in range")
}

/// A third of the bearings outliers or mirrored, all of them biased; through a small buffer.
fn robust_locator_finds_the_source() -> Digest {
    let mut digest = Digest::new();
    let mut locator = robust::<32>(Faulty {
        bias_sigma_rad: 0.05,
        ..Faulty::DEFAULT
    });
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
    for (i, observation) in drive().into_iter().enumerate() {
        let turn = match i % 6 {
            2 => core::f32::consts::PI,
            4 => i as f32,
            _ => 0.0,
        };
        let spoilt = turned(&observation, observation.bearing().radians() + turn + 0.03);
        if let Some(fix) = locator.push(&spoilt, &mut rng).expect("in order").fix() {
            add_fix(&mut digest, &locator, &fix);
        }
    }
    let fix = locator.fix().expect("a fix");
    assert!(is_near(fix.position, 100.0), "{:?}", fix.position);
    assert!(fix.ellipse(0.999).contains(SOURCE));
    let (bias, rates) = (
        locator.bias().expect("a fix"),
        locator.rates().expect("some"),
    );
    digest.add(&[bias.mean_rad, bias.sigma_rad, rates.outlier, rates.mirrored]);
    for hypothesis in locator.hypotheses() {
        digest.add(&hypothesis.position);
        digest.add(&[hypothesis.probability]);
    }
    digest
}

/// Every reading with a reflection, which is as high.
fn robust_locator_with_spectra() -> Digest {
    let temper = 0.2;
    let mut locator = robust::<64>(Faulty::DEFAULT);
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
    let mut digest = Digest::new();
    for (i, observation) in drive().into_iter().enumerate() {
        let tops = [observation.bearing().radians(), 0.7 * i as f32];
        let mut spectrum = Spectrum::new();
        for degree in 0..360_u16 {
            let level = tops.iter().fold(0.0, |level: f32, top| {
                let off = math::wrap(f32::from(degree) * 0.017_453_3 - top);
                level.max(20.0 - 6e3 * off * off)
            });
            spectrum.push(level).expect("in range");
        }
        let mut alternatives = heapless::Vec::<Alternative, 3>::new();
        for peak in spectrum.peaks(temper).into_iter().rev().flatten() {
            digest.add(&[peak.angle_rad, peak.sigma_rad, peak.probability]);
            let bearing = Bearing::from_radians(peak.angle_rad);
            let (time_ms, place) = (observation.time_ms(), observation.position());
            let seen = Observation::new(time_ms, place, bearing, peak.sigma_rad);
            let seen = Alternative::new(seen.expect("in range"), peak.probability);
            alternatives.push(seen.expect("in range")).expect("three");
        }
        locator
            .push_alternatives(&alternatives, &mut rng)
            .expect("in order");
        let axis = Bearing::from_radians(0.3);
        let likelihood = spectrum.likelihood([0.0; 2], axis, temper);
        digest.add(&[likelihood(&SOURCE)]);
        if let Some(fix) = locator.fix() {
            digest.add(&fix.position);
        }
    }
    let fix = locator.fix().expect("a fix");
    assert!(is_near(fix.position, 100.0), "{:?}", fix.position);
    digest
}

/// From places that are off by ten metres.
fn robust_locator_of_inexact_places() -> Digest {
    let mut locator = robust::<32>(Faulty {
        position_sigma_m: 10.0,
        ..Faulty::DEFAULT
    });
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
    let mut digest = Digest::new();
    for observation in drive() {
        let place = observation.position().map(|x| x + 10.0 * normal(&mut rng));
        let (time_ms, bearing) = (observation.time_ms(), observation.bearing());
        let moved = Observation::new(time_ms, place, bearing, 0.035).expect("in range");
        if let Some(fix) = locator.push(&moved, &mut rng).expect("in order").fix() {
            add_fix(&mut digest, &locator, &fix);
        }
    }
    let fix = locator.fix().expect("a fix");
    assert!(is_near(fix.position, 100.0), "{:?}", fix.position);
    digest
}

/// Every fourth bearing is of a second source, every ninth is an outlier.
fn two_sources_are_found() -> Digest {
    const OTHER: [f32; 2] = [700.0, -900.0];
    let mut digest = Digest::new();
    let mut locator = Locator::<MultiTarget<2, Robust<128, 32>, 32>>::new(multi::Config::DEFAULT)
        .expect("in range");
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(4);
    for (i, observation) in drive().into_iter().chain(drive()).enumerate() {
        let [x, y] = observation.position();
        let radians = match i {
            _ if i % 9 == 5 => i as f32,
            _ if i % 4 == 1 => math::atan2(OTHER[1] - y, OTHER[0] - x) + 0.035 * normal(&mut rng),
            _ => observation.bearing().radians(),
        };
        let bearing = Bearing::from_radians(radians);
        let observation = Observation::new(2000 * i as u32, [x, y], bearing, 0.035);
        let answer = locator.push(&observation.expect("in range"), &mut rng);
        answer.expect("in order");
        for (index, source) in (0..).map_while(|index| Some((index, locator.source(index)?))) {
            assert_cloud(&locator, index);
            digest.add(&source.fix.position);
            digest.add(source.fix.covariance.rows().as_flattened());
            digest.add(&[f32::from(source.identity)]);
        }
    }
    let [a, b] = [0, 1].map(|index| locator.source(index).expect("two sources").fix);
    assert!(a.ellipse(0.999).contains(SOURCE) && b.ellipse(0.999).contains(OTHER));
    digest
}

/// A source is stationary, drives with a turn, and stops again, circled by a vehicle; every eighth bearing is an outlier.
fn a_manoeuvring_source_is_followed() -> Digest {
    let mut digest = Digest::new();
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(3);
    let mut locator = Locator::<Manoeuvring<Robust<128, 32>>>::new(manoeuvring::Config::DEFAULT)
        .expect("in range");
    let (mut source, mut moved) = ([0.0f32; 2], false);
    for second in 0..200u16 {
        match second {
            60..90 => source[0] += 10.0,
            90..120 => source[1] += 10.0,
            _ => {}
        }
        let (sin, cos) = math::sin_cos(0.04 * f32::from(second));
        let place = [source[0] + 300.0 * cos, source[1] + 300.0 * sin];
        let error = 0.04 * normal(&mut rng) + if second % 8 == 3 { 2.0 } else { 0.0 };
        let direction = math::atan2(source[1] - place[1], source[0] - place[0]) + error;
        let (time_ms, bearing) = (1000 * u32::from(second), Bearing::from_radians(direction));
        let observation = Observation::new(time_ms, place, bearing, 0.04).expect("in range");
        if let Some(fix) = locator
            .push(&observation, &mut rng)
            .expect("in order")
            .fix()
        {
            add_fix(&mut digest, &locator, &fix);
        }
        if let Some(motion) = locator.state().motion() {
            digest.add(&[motion.moving, motion.sigma_m_s]);
            digest.add(&motion.velocity_m_s);
            moved |= motion.moving > 0.9;
        }
    }
    let fix = locator.fix().expect("a fix");
    let [dx, dy] = [fix.position[0] - source[0], fix.position[1] - source[1]];
    assert!(moved && dx.abs() < 30.0 && dy.abs() < 30.0, "{:?}", fix);
    digest
}

/// Both forms of a refinement; the greedy one after every bearing.
fn refined<F: Refinement<2> + Copy + PartialEq + Debug>(metropolis: F, greedy: F) -> Digest {
    let greedy = clean::Config {
        resample_below: 1.0,
        ..clean::Config::with_refinement(greedy)
    };
    let mut digest = Digest::new();
    for config in [clean::Config::with_refinement(metropolis), greedy] {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
        let mut locator = Locator::<Clean<100, 64, F>>::new(config).expect("in range");
        for observation in drive() {
            if let Some(fix) = locator
                .push(&observation, &mut rng)
                .expect("in order")
                .fix()
            {
                add_fix(&mut digest, &locator, &fix);
                assert_cloud(&locator, 0);
            }
        }
        let fix = locator.fix().expect("a fix");
        assert!(is_near(fix.position, 50.0), "{:?}", fix.position);
    }
    digest
}

fn locator_with_fish() -> Digest {
    let school = |lengths, step, acceptance| FishSchool {
        lengths,
        perception: 2.0 * step,
        step,
        tries: 5,
        iterations: 2,
        acceptance,
        ..FishSchool::DEFAULT
    };
    refined(
        school(Lengths::Relative, 3.0, Acceptance::Metropolis),
        school(Lengths::Absolute, 10.0, Acceptance::Greedy),
    )
}

fn locator_with_fireflies() -> Digest {
    let swarm = |lengths, absorption, flutter, acceptance| Firefly {
        lengths,
        absorption,
        flutter,
        iterations: 3,
        acceptance,
        ..Firefly::DEFAULT
    };
    refined(
        swarm(Lengths::Relative, 0.1, 4.0, Acceptance::Metropolis),
        swarm(Lengths::Absolute, 0.01, 10.0, Acceptance::Greedy),
    )
}

fn locator_with_evolution() -> Digest {
    let greedy = DifferentialEvolution {
        generations: 4,
        ..DifferentialEvolution::DEFAULT
    };
    refined(DifferentialEvolution::METROPOLIS, greedy)
}

fn gauss_newton_finds_the_source() -> Digest {
    let (position, covariance) = gauss_newton(&drive(), [1000.0, 500.0]).expect("they meet");
    assert!(is_near(position, 40.0), "{:?}", position);
    let mut digest = Digest::new();
    digest.add(&position);
    digest.add(covariance.rows().as_flattened());
    digest
}

fn geodesy() -> Digest {
    let place = |latitude, longitude| Geodetic::new(latitude, longitude).expect("on the globe");
    let mut digest = Digest::new();
    for (latitude, longitude) in [
        (481_173_000, 115_166_667),
        (-335_000_000, 1_799_999_000),
        (0, -1_799_999_000),
        (840_000_000, 0),
        (-849_000_000, -700_000_000),
    ] {
        let plane = LocalPlane::new(place(latitude, longitude)).expect("far from the poles");
        for i in -50..50 {
            let there = place(
                latitude + i * 31_415,
                (longitude - i * 27_182).clamp(-1_800_000_000, 1_800_000_000),
            );
            let local = plane.to_local(there).expect("near");
            digest.add(&local);
            let back = plane.to_geodetic(local).expect("near");
            assert!((back.latitude_e7() - there.latitude_e7()).abs() < 100);
            digest.add_bytes(&back.latitude_e7().to_le_bytes());
            digest.add_bytes(&back.longitude_e7().to_le_bytes());
        }
        for i in 0..64_u8 {
            let (sin, cos) = math::sin_cos(0.1 * f32::from(i));
            let far = [1_500.0, 1_600.0].map(|reach| reach * f32::from(i));
            let there = plane.to_geodetic([far[0] * sin, far[0] * cos]);
            let there = there.expect("within range");
            digest.add_bytes(&there.latitude_e7().to_le_bytes());
            digest.add_bytes(&there.longitude_e7().to_le_bytes());
            digest.add(&plane.to_local(there).expect("within range"));
            // Some of these are too far away.
            digest.add_shown(&plane.to_geodetic([far[1] * cos, far[1] * sin]));
        }
    }
    digest
}
