//! All of it, and what a panic would call.

use core::panic::PanicInfo;

use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};

use crate::{bearings::*, filters::*, fingerprints::*, gateways::*, values::any};

unsafe extern "C" {
    // SAFETY: never linked, never called.
    safe fn a_panic_is_possible() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    a_panic_is_possible()
}

#[cortex_m_rt::entry]
fn main() -> ! {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(any(1));
    math();
    random(&mut rng);
    cloud(&mut rng);
    filter(&mut rng);
    refine::<1>(&mut rng);
    refine::<2>(&mut rng);
    refine::<4>(&mut rng);
    kalman(&mut rng);
    propose(&mut rng);
    bearings();
    locate(&mut rng);
    locate_robustly(&mut rng);
    locate_several(&mut rng);
    snapshots(&mut rng);
    pursue(&mut rng);
    fingerprints();
    track(&mut rng);
    gateway();
    beacons();
    buildings(&mut rng);
    loop {
        cortex_m::asm::wfi();
    }
}
