use foxhunt::{
    filter::ParticleFilter,
    random::{SeedableRng, Xoshiro128PlusPlus, normal},
    refine::{
        Acceptance, DifferentialEvolution, Firefly, FishSchool, Lengths, Memory, Refinement, Report,
    },
};

use super::{Case, Digest, assert_normal};

pub const CASES: &[Case] = &[
    ("refine::in_a_line_and_in_space", in_a_line_and_in_space),
    ("refine::schools", schools),
    ("refine::fireflies", fireflies),
    ("refine::evolution", evolution),
];

/// A crescent.
fn crescent([x, y]: &[f32; 2]) -> f32 {
    let bent = y - 0.5 * x * x;
    -0.5 * (x * x + bent * bent / 0.09)
}

/// All forms move particles, and only to places that the target knows.
fn refined(refinements: &[impl Refinement<2>]) -> Digest {
    let mut digest = Digest::new();
    for refinement in refinements {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
        let mut filter = ParticleFilter::<2, 120>::new();
        let mut memory = Memory::EMPTY;
        filter.initialise(&mut rng, |rng| [normal(rng), normal(rng)]);
        let report = filter.refine(refinement, &crescent, &mut memory, &mut rng);
        assert!(report.moves > 0 && report.evaluations <= refinement.evaluations(120));
        add_report(&mut digest, report);
        assert_normal(&filter.particles().columns());
        for column in filter.particles().columns() {
            digest.add(column);
        }
    }
    digest
}

fn add_report(digest: &mut Digest, report: Report) {
    let Report {
        iterations,
        evaluations,
        proposals,
        moves,
    } = report;
    digest.add_counts(&[iterations, evaluations, proposals, moves]);
}

const BOTH: [Acceptance; 2] = [Acceptance::Greedy, Acceptance::Metropolis];

/// Fish that do what the flags say, and stop when they have found nothing better.
const fn school(acceptance: Acceptance, [swarm, follow]: [bool; 2]) -> FishSchool {
    FishSchool {
        perception: 0.8,
        step: 0.4,
        tries: 5,
        iterations: 4,
        threshold: 1e-3,
        swarm,
        follow,
        acceptance,
        ..FishSchool::DEFAULT
    }
}

fn schools() -> Digest {
    let mut digest = Digest::new();
    for flags in [[true, false], [false, true], [true, true], [false, false]] {
        let mut schools = BOTH.map(|acceptance| school(acceptance, flags));
        let Digest(relative) = refined(&schools);
        // Where many mates are in sight, a place must be much better.
        schools = schools.map(|school| FishSchool {
            lengths: Lengths::Absolute,
            perception: 1.5,
            crowding: 0.05,
            diagonal: true,
            threshold: 0.0,
            ..school
        });
        let Digest(absolute) = refined(&schools);
        digest.add_bytes(&relative.to_le_bytes());
        digest.add_bytes(&absolute.to_le_bytes());
    }
    digest
}

fn fireflies() -> Digest {
    let mut digest = Digest::new();
    for swarm in [Firefly::DEFAULT, Firefly::STANDARD] {
        for lengths in [Lengths::Relative, Lengths::Absolute] {
            let swarms = BOTH.map(|acceptance| Firefly {
                lengths,
                flutter: 0.3,
                absorption: 1.5,
                iterations: 3,
                acceptance,
                ..swarm
            });
            let Digest(of_swarms) = refined(&swarms);
            digest.add_bytes(&of_swarms.to_le_bytes());
        }
    }
    digest
}

fn evolution() -> Digest {
    refined(&BOTH.map(|acceptance| DifferentialEvolution {
        acceptance,
        ..DifferentialEvolution::DEFAULT
    }))
}

/// Particles of any dimension are drawn to a place beside what is impossible, which is said in three ways.
fn moved<const D: usize>(digest: &mut Digest, refinement: &impl Refinement<D>) {
    let target = |state: &[f32; D]| {
        for (edge, impossible) in [
            (-1.5, f32::NAN),
            (-1.0, f32::INFINITY),
            (-0.5, f32::NEG_INFINITY),
        ] {
            if state[0] < edge {
                return impossible;
            }
        }
        -0.7 * state.iter().map(|x| (x - 1.0) * (x - 1.0)).sum::<f32>()
    };
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(2);
    let mut filter = ParticleFilter::<D, 90>::new();
    let mut memory = Memory::EMPTY;
    filter.initialise(&mut rng, |rng| [(); D].map(|()| 2.0 * normal(rng)));
    let report = filter.refine(refinement, &target, &mut memory, &mut rng);
    assert!(report.moves > 0 && report.evaluations <= refinement.evaluations(90));
    add_report(digest, report);
    for column in filter.particles().columns() {
        digest.add(column);
    }
}

fn in_a_line_and_in_space() -> Digest {
    fn all<const D: usize>(digest: &mut Digest) {
        for acceptance in BOTH {
            moved::<D>(digest, &school(acceptance, [true, true]));
            let swarm = Firefly {
                acceptance,
                iterations: 2,
                ..Firefly::STANDARD
            };
            moved::<D>(digest, &swarm);
            let evolution = DifferentialEvolution {
                acceptance,
                ..DifferentialEvolution::DEFAULT
            };
            moved::<D>(digest, &evolution);
        }
    }
    let mut digest = Digest::new();
    all::<1>(&mut digest);
    all::<3>(&mut digest);
    digest
}
