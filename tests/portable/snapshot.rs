use foxhunt::{
    aoa::{
        Bearing, Locate, Observation,
        locator::{self, Answer, Locator},
        robust::{self, RobustLocator, Tails},
    },
    random::{SeedableRng, Xoshiro128PlusPlus},
    snapshot::{Persist, restore, save},
};

use crate::{Case, aoa::drive, digest::Digest};

pub const CASES: &[Case] = &[
    ("snapshot::locator", locator),
    ("snapshot::robust_locator", robust_locator),
];

/// Snapshots from before a fix, and from after; with a fix, through a restored one.
fn taken<L: Locate + Persist>(new: impl Fn() -> L) -> Digest {
    let mut digest = Digest::new();
    let mut going = (new(), Xoshiro128PlusPlus::seed_from_u64(2));
    let mut buffer = [0; 4096];
    for (i, observation) in drive().into_iter().enumerate() {
        // Every seventh is mirrored.
        let turn = if i % 7 == 6 {
            core::f32::consts::PI
        } else {
            0.0
        };
        let bearing = Bearing::from_radians(observation.bearing().radians() + turn);
        let spoilt = Observation::new(observation.position(), bearing, observation.deviation());
        going
            .0
            .push_after(spoilt.expect("in range"), 1.0, &mut going.1);
        let bytes = save(&going, &mut buffer).expect("it is large enough");
        digest.add_bytes(bytes);
        let mut restored = (new(), Xoshiro128PlusPlus::seed_from_u64(3));
        restore(&mut restored, bytes).expect("it is one of these");
        assert_eq!(restored.0.answer(), going.0.answer());
        going = restored;
    }
    assert!(matches!(going.0.answer(), Answer::Fix(_)));
    digest
}

fn locator() -> Digest {
    taken(|| Locator::<40, 16>::new(locator::Settings::new()))
}

fn robust_locator() -> Digest {
    let errors = robust::Errors::new().tails(Tails::Student { freedom: 5 });
    let errors = errors.and_then(|errors| errors.bias_deviation(0.05));
    let settings = robust::Settings::new(errors.expect("in range"));
    taken(|| RobustLocator::<60, 16>::new(settings))
}
