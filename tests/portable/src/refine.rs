use foxhunt::{
    filter::ParticleFilter,
    random::{SeedableRng, Xoshiro128PlusPlus, normal},
    refine::{Acceptance, DifferentialEvolution, Firefly, FishSchool, Memory, Refinement},
};

use super::{Case, Digest, assert_normal};

pub const CASES: &[Case] = &[
    ("refine::schools", schools),
    ("refine::fireflies", fireflies),
    ("refine::evolution", evolution),
];

/// A crescent.
fn crescent([x, y]: &[f32; 2]) -> f32 {
    let bent = y - 0.5 * x * x;
    -0.5 * (x * x + bent * bent / 0.09)
}

/// Both forms move particles, and only to places that the target knows.
fn refined(refinements: [impl Refinement<2>; 2]) -> Digest {
    let mut digest = Digest::new();
    for refinement in refinements {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
        let mut filter = ParticleFilter::<2, 120>::new();
        let mut memory = Memory::EMPTY;
        filter.initialise(&mut rng, |rng| [normal(rng), normal(rng)]);
        let report = filter.refine(&refinement, &crescent, &mut memory, &mut rng);
        assert!(report.moves > 0 && report.evaluations <= refinement.evaluations(120));
        assert_normal(&filter.particles().columns());
        for column in filter.particles().columns() {
            digest.add(column);
        }
    }
    digest
}

const BOTH: [Acceptance; 2] = [Acceptance::Greedy, Acceptance::Metropolis];

fn schools() -> Digest {
    refined(BOTH.map(|acceptance| FishSchool {
        perception: 0.8,
        step: 0.4,
        tries: 5,
        iterations: 4,
        acceptance,
        ..FishSchool::DEFAULT
    }))
}

fn fireflies() -> Digest {
    let flutter = 0.3;
    let mut digest = refined(BOTH.map(|acceptance| Firefly {
        flutter,
        acceptance,
        ..Firefly::DEFAULT
    }));
    let standard = Firefly {
        flutter,
        ..Firefly::STANDARD
    };
    let Digest(of_standard) = refined([standard; 2]);
    digest.add_bytes(&of_standard.to_le_bytes());
    digest
}

fn evolution() -> Digest {
    refined(BOTH.map(|acceptance| DifferentialEvolution {
        acceptance,
        ..DifferentialEvolution::DEFAULT
    }))
}
