use foxhunt::{
    aoa::{
        Bearing, Clean, Locate, Observation, Robust, clean,
        robust::{self, Errors},
    },
    random::{SeedableRng, Xoshiro128PlusPlus},
    snapshot::{Persist, restore, save},
};

use super::{Case, Digest, aoa::drive};

pub const CASES: &[Case] = &[
    ("snapshot::locator", locator),
    ("snapshot::robust_locator", robust_locator),
];

/// Snapshots from before a fix, and from after; with a fix, through a restored one.
fn taken<L: Locate + Persist>(config: &L::Config) -> Digest {
    let mut digest = Digest::new();
    let mut going = (L::EMPTY, Xoshiro128PlusPlus::seed_from_u64(2));
    let mut buffer = [0; 4096];
    for (i, observation) in drive().into_iter().enumerate() {
        // Every seventh is mirrored.
        let turn = if i % 7 == 6 {
            core::f32::consts::PI
        } else {
            0.0
        };
        let bearing = Bearing::from_radians(observation.bearing().radians() + turn);
        let (time_ms, place) = (observation.time_ms(), observation.position());
        let spoilt = Observation::new(time_ms, place, bearing, 0.035).expect("in range");
        let answer = going.0.push(&spoilt, config, &mut going.1);
        answer.expect("in order");
        let bytes = save(&going, &mut buffer).expect("it is large enough");
        digest.add_bytes(bytes);
        let mut restored = (L::EMPTY, Xoshiro128PlusPlus::seed_from_u64(3));
        restore(&mut restored, bytes).expect("it is one of these");
        assert_eq!(restored.0.answer(), going.0.answer());
        going = restored;
    }
    assert!(going.0.fix().is_some());
    digest
}

fn locator() -> Digest {
    taken::<Clean<40, 16>>(&clean::Config::DEFAULT)
}

fn robust_locator() -> Digest {
    let errors = Errors {
        bias_sigma_rad: 0.05,
        ..Errors::DEFAULT
    };
    taken::<Robust<60, 16>>(&robust::Config {
        errors,
        ..robust::Config::DEFAULT
    })
}
