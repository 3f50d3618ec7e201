//! Locators where more happens than a drive past one source: all that they say.

use foxhunt::{
    aoa::{
        Alternative, Bearing, Locate, Locator, Manoeuvring, Motion, MultiTarget, Observation,
        Retract, Robust, manoeuvring, multi,
        robust::{self, Biases, Correlation, Errors},
    },
    math,
    random::{SeedableRng, Xoshiro128PlusPlus, normal},
};

use super::{Case, Digest, answers::add_all};

pub const CASES: &[Case] = &[
    ("locators::sources_that_pause", sources_that_pause),
    ("locators::errors_of_stops", errors_of_stops),
    ("locators::sources_that_move", sources_that_move),
    ("locators::a_walk_among_stations", a_walk_among_stations),
    ("locators::a_source_that_is_lost", a_source_that_is_lost),
    ("locators::biases_by_direction", biases_by_direction),
    ("locators::biases_per_station", biases_per_station),
    ("locators::errors_in_common", errors_in_common),
    (
        "locators::the_next_drive_knows_the_array",
        the_next_drive_knows_the_array,
    ),
];

/// Standard deviation of the bearings.
const SIGMA: f32 = 0.04;

/// A bearing from a place towards another, turned by so much.
fn bearing(time_ms: u32, from: [f32; 2], to: [f32; 2], turn: f32) -> Observation {
    let direction = math::atan2(to[1] - from[1], to[0] - from[0]);
    let bearing = Bearing::from_radians(direction + turn);
    Observation::new(time_ms, from, bearing, SIGMA).expect("in range")
}

/// A locator, its generator, and all that it has said.
struct Run<L: Locate> {
    locator: Locator<L>,
    rng: Xoshiro128PlusPlus,
    digest: Digest,
}

impl<L: Locate> Run<L> {
    fn new(config: L::Config) -> Self {
        Self {
            locator: Locator::new(config).expect("in range"),
            rng: Xoshiro128PlusPlus::seed_from_u64(7),
            digest: Digest::new(),
        }
    }

    fn noise(&mut self) -> f32 {
        SIGMA * normal(&mut self.rng)
    }

    /// Takes the bearings of a reading, as probable as one another, and adds all that the locator says then.
    fn take(&mut self, reading: &[Observation]) {
        let mut alternatives = heapless::Vec::<Alternative, 2>::new();
        let probability = 1.0 / reading.len() as f32;
        for observation in reading {
            let one = Alternative::new(*observation, probability).expect("in range");
            alternatives.push(one).expect("two at most");
        }
        let answer = self.locator.push_alternatives(&alternatives, &mut self.rng);
        answer.expect("in order");
        for observation in reading {
            add_all(&mut self.digest, &self.locator, observation);
        }
    }

    /// Takes something back, and adds what the locator says then of a bearing.
    fn take_back(&mut self, what: Retract, observation: &Observation) {
        let retracted = self.locator.retract(&what, &mut self.rng);
        self.digest.add_bytes(&retracted.bearings.to_le_bytes());
        self.digest.add_bytes(&retracted.merged.to_le_bytes());
        add_all(&mut self.digest, &self.locator, observation);
    }

    /// Forgets all, and adds what the locator says on a short drive past another source.
    fn start_over(mut self) -> Digest {
        self.locator.reset();
        for i in 0..10u16 {
            let place = [100.0 * f32::from(i), 0.0];
            let turn = self.noise();
            self.take(&[bearing(500 * u32::from(i), place, [500.0, 400.0], turn)]);
        }
        self.digest
    }

    /// Whether the locator has a fix so near a place.
    fn is_near(&self, [x, y]: [f32; 2], metres: f32) -> bool {
        (0..4)
            .filter_map(|index| self.locator.source(index))
            .any(|source| {
                let [east, north] = source.fix.position;
                (east - x).abs() < metres && (north - y).abs() < metres
            })
    }
}

/// Where the vehicle stops, in rows.
fn stop(index: u16) -> [f32; 2] {
    let (row, column) = (index / 7, index % 7);
    let column = if row.is_multiple_of(2) {
        column
    } else {
        6 - column
    };
    [
        240.0 + 120.0 * f32::from(column),
        240.0 + 360.0 * f32::from(row),
    ]
}

/// Two sources, heard in turns from stops; one pauses, and is heard again. Some readings are of both, some of none.
fn sources_that_pause() -> Digest {
    const SOURCES: [[f32; 2]; 2] = [[0.0, 0.0], [1200.0, 900.0]];
    let mut run = Run::<MultiTarget<3, Robust<64, 24>, 24>>::new(multi::Config {
        false_deletion: 0.05,
        ..multi::Config::DEFAULT
    });
    let mut numbers = [None; 3];
    for i in 0..150u16 {
        let (place, time_ms) = (stop(i / 2 % 21), 1000 * u32::from(i));
        let [a, b] = SOURCES.map(|source| {
            let noise = run.noise();
            bearing(time_ms, place, source, noise)
        });
        let pauses = (60..110).contains(&i);
        match i % 10 {
            3 => run.take(&[bearing(time_ms, place, place, f32::from(i))]),
            6 if !pauses => run.take(&[a, b]),
            1 | 4 | 7 | 9 if !pauses => run.take(&[b]),
            _ => run.take(&[a]),
        }
        if let Some(number) = [59, 109, 149].iter().position(|last| *last == i) {
            let mut all = (0..3).filter_map(|index| run.locator.source(index));
            let second = all.find(|source| source.fix.position[0] > 900.0);
            numbers[number] = second.map(|source| source.identity);
        }
    }
    assert!(numbers[0].is_some() && numbers[1].is_none() && numbers[2] == numbers[0]);
    let last = bearing(150_000, stop(0), SOURCES[0], 0.0);
    run.take_back(
        Retract::Place {
            position: stop(3),
            radius_m: 10.0,
        },
        &last,
    );
    let all = Retract::Span {
        from_ms: 0,
        until_ms: 140_000,
    };
    run.take_back(all, &last);
    run.start_over()
}

/// Four sources, heard from stops of which each turns all bearings by several sigmas.
fn errors_of_stops() -> Digest {
    const SOURCES: [[f32; 2]; 4] = [[0.0, 0.0], [1200.0, 0.0], [1200.0, 1200.0], [0.0, 1200.0]];
    type Four = MultiTarget<4, Robust<64, 24>, 24>;
    let mut run = Run::<Four>::new(multi::Config::DEFAULT);
    let mut turn = 0.0;
    for (i, source) in (0..84).zip(SOURCES.into_iter().cycle()) {
        if i % 4 == 0 {
            turn = 3.0 * run.noise();
        }
        let noise = run.noise();
        run.take(&[bearing(
            1000 * u32::from(i),
            stop(i / 4),
            source,
            turn + noise,
        )]);
    }
    assert!(SOURCES.into_iter().all(|source| run.is_near(source, 150.0)));
    run.start_over()
}

/// One drives away, the other stays.
fn sources_that_move() -> Digest {
    const STAYS: [f32; 2] = [-300.0, 500.0];
    type Both = MultiTarget<2, Manoeuvring<Robust<64, 16>>, 16>;
    let mut run = Run::<Both>::new(multi::Config::new(manoeuvring::Config::DEFAULT));
    let mut drives = [200.0f32, 0.0];
    for i in 0..160u16 {
        let (sin, cos) = math::sin_cos(0.06 * f32::from(i));
        let place = [250.0 * cos, 250.0 + 250.0 * sin];
        if i > 100 {
            drives[1] -= 8.0;
        }
        let (time_ms, noise) = (1000 * u32::from(i), run.noise());
        let source = if i % 3 == 1 { STAYS } else { drives };
        run.take(&[bearing(time_ms, place, source, noise)]);
    }
    let motions = [0, 1].map(|index| run.locator.source(index).and_then(|one| one.motion));
    let moves = |motion: &Motion| motion.moving > 0.5 && motion.velocity_m_s[1] < -2.0;
    assert_eq!(
        motions
            .iter()
            .flatten()
            .filter(|motion| moves(motion))
            .count(),
        1
    );
    assert!(run.is_near(STAYS, 60.0));
    run.start_over()
}

/// Told how people walk in a room, and by the default for cars.
fn a_walk_among_stations() -> Digest {
    let mut digest = Digest::new();
    for config in [manoeuvring::Config::ROOM, manoeuvring::Config::DEFAULT] {
        let Digest(walk) = walk_among_stations(config);
        digest.add_bytes(&walk.to_le_bytes());
    }
    digest
}

/// Somebody stands, walks and stands among four stations, each with a bias; a reading in five is of two bearings.
fn walk_among_stations(config: manoeuvring::Config) -> Digest {
    const STATIONS: [[f32; 2]; 4] = [[0.0, 0.0], [12.0, 0.0], [12.0, 9.0], [0.0, 9.0]];
    const BIASES: [f32; 4] = [0.05, -0.08, 0.02, 0.06];
    let stationary = robust::Config {
        errors: Errors {
            stop_sigma_rad: 0.07,
            ..robust::Config::ROOM.errors
        },
        ..robust::Config::ROOM
    };
    let config = manoeuvring::Config {
        stationary,
        ..config
    };
    let mut run = Run::<Manoeuvring<Robust<64, 16>, 4>>::new(config);
    let mut person = [3.0f32, 4.0];
    for i in 0..120u16 {
        let station = i % 4;
        let (time_ms, noise) = (250 * u32::from(i), run.noise());
        if (30..90).contains(&i) {
            person[0] += 0.1;
        }
        let (place, bias) = (STATIONS[usize::from(station)], BIASES[usize::from(station)]);
        let from = |observation: Observation| observation.from_station(station as u8);
        let right = from(bearing(time_ms, place, person, bias + noise));
        let other = from(bearing(time_ms, place, person, 0.5 + bias));
        match i % 5 {
            3 if i > 40 => run.take(&[right, other]),
            _ if i % 17 == 9 => run.take(&[other]),
            _ => run.take(&[right]),
        }
    }
    assert!(run.is_near(person, 1.5));
    run.start_over()
}

/// It drives, is not heard for long, is heard elsewhere again, and is elsewhere for good at last.
fn a_source_that_is_lost() -> Digest {
    let mut run = Run::<Manoeuvring<Robust<64, 16>>>::new(manoeuvring::Config {
        stationary_s: 60.0,
        ..manoeuvring::Config::DEFAULT
    });
    let mut source = [0.0f32; 2];
    for i in 0..220u16 {
        let (sin, cos) = math::sin_cos(0.06 * f32::from(i));
        let place = [source[0] + 250.0 * cos, 250.0 * sin];
        match i {
            40..90 => source[0] += 8.0,
            160 => source[0] -= 3000.0,
            _ => {}
        }
        let (time_ms, noise) = (1000 * u32::from(i), run.noise());
        // Bearings of nothing, for long.
        let turn = if (70..84).contains(&i) {
            f32::from(i)
        } else {
            noise
        };
        let right = bearing(time_ms, place, source, turn);
        let other = bearing(time_ms, place, source, 1.0);
        if i % 6 == 5 {
            run.take(&[right, other]);
        } else {
            run.take(&[right]);
        }
        if i == 30 {
            let (time_ms, station) = (29_000, 0);
            run.take_back(Retract::Bearing { time_ms, station }, &right);
        }
    }
    assert!(run.is_near(source, 80.0));
    run.start_over()
}

/// What the drive past one source has taught of an array helps with the next source.
fn the_next_drive_knows_the_array() -> Digest {
    const SOURCES: [[f32; 2]; 2] = [[700.0, 500.0], [300.0, -600.0]];
    let config = robust::Config {
        errors: Errors {
            bias_sigma_rad: 0.09,
            biases: Biases::ByDirection,
            ..Errors::DEFAULT
        },
        ..robust::Config::DEFAULT
    };
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(7);
    let mut digest = Digest::new();
    let mut locator = Robust::<64, 24, 8>::EMPTY;
    for source in SOURCES {
        for i in 0..40u16 {
            let place = [
                30.0 * f32::from(i),
                50.0 * math::sin_cos(0.2 * f32::from(i)).0,
            ];
            let heading = Bearing::from_radians(0.15 * f32::from(i));
            let turn = 0.1 + SIGMA * normal(&mut rng);
            let seen = bearing(1000 * u32::from(i), place, source, turn).with_heading(heading);
            let answer = locator.push(&seen, &config, &mut rng).expect("in order");
            let (fix, bias) = (answer.fix(), locator.bias_of(&seen, &config));
            digest.add(&fix.map_or([0.0; 2], |fix| fix.position));
            digest.add(&bias.map_or([0.0; 2], |bias| [bias.mean_rad, bias.sigma_rad]));
        }
        assert!(locator.answer().fix().is_some());
        locator.forget_source();
        assert!(locator.answer().fix().is_none());
    }
    digest
}

/// The drive past a source, each bearing from a heading and a station, for a locator of these errors and so many numbers.
fn driven_past<const D: usize>(errors: Errors, turn: fn(u16) -> f32) -> Digest {
    const SOURCE: [f32; 2] = [700.0, 500.0];
    let mut run = Run::<Robust<64, 24, D>>::new(robust::Config {
        errors,
        ..robust::Config::DEFAULT
    });
    for i in 0..60u16 {
        let place = [
            20.0 * f32::from(i),
            40.0 * math::sin_cos(0.2 * f32::from(i)).0,
        ];
        let turn = turn(i) + run.noise();
        let heading = Bearing::from_radians(0.1 * f32::from(i));
        let time_ms = 1000 * u32::from(i);
        let seen = bearing(time_ms, place, SOURCE, turn).with_heading(heading);
        run.take(&[seen.from_station((i % 3) as u8)]);
    }
    assert!(run.is_near(SOURCE, 150.0));
    run.digest
}

fn biases_by_direction() -> Digest {
    let errors = Errors {
        bias_sigma_rad: 0.09,
        biases: Biases::ByDirection,
        ..Errors::DEFAULT
    };
    driven_past::<8>(errors, |i| 0.05 * math::sin_cos(0.1 * f32::from(i)).0)
}

fn biases_per_station() -> Digest {
    let errors = Errors {
        biases: Biases::PerStation,
        ..Errors::DEFAULT
    };
    driven_past::<6>(errors, |i| 0.04 * f32::from(i % 3))
}

/// At one place, over time, at stops, and by places that are not known exactly.
fn errors_in_common() -> Digest {
    let errors = Errors {
        correlation: Correlation {
            at_rest: 0.8,
            distance: 0.05,
            distance_m: 15.0,
            time_s: 6.0,
        },
        stop_sigma_rad: 0.03,
        position_sigma_m: 5.0,
        sigma_scale: 1.5,
        scale_sigma: 0.5,
        ..Errors::DEFAULT
    };
    driven_past::<4>(errors, |i| 0.05 * math::sin_cos(0.3 * f32::from(i)).0)
}
