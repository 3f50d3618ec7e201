//! The same drives on a Cortex-M4F. Every filter's steps are a region: its instructions are counted
//! from outside, between the edges.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod firmware {
    use core::mem::MaybeUninit;
    use core::sync::atomic::{Ordering, compiler_fence};

    use cortex_m::asm;
    use cortex_m_rt::entry;
    use cortex_m_semihosting::{debug, hprintln};
    // Only for the linker script that the flags of the firmware name.
    use defmt as _;
    use embedded_alloc::LlffHeap;
    use foxhunt_peers::filters::{BayesEstimate, Filter, Foxhunt, Multicalc};
    use foxhunt_peers::workload::{self, SEED, Sighting, error_m, sightings};

    const PARTICLES: usize = 200;
    /// Counted steps, after one that warms up: few, because counting takes the emulator its time.
    const STEPS: usize = 20;
    const HEAP_BYTES: usize = 1 << 16;

    #[global_allocator]
    static HEAP: LlffHeap = LlffHeap::empty();

    /// Marks the beginning and the end of a region.
    #[inline(never)]
    fn region_edge() {
        compiler_fence(Ordering::SeqCst);
        asm::nop();
    }

    fn drive<F: Filter<PARTICLES>>(name: &str, sightings: &[Sighting; workload::STEPS]) {
        let mut filter = F::new(SEED);
        let mut mean = filter.step(&sightings[0]);
        region_edge();
        for sighting in &sightings[1..=STEPS] {
            mean = filter.step(sighting);
        }
        region_edge();
        let error = error_m(mean.unwrap_or([f32::NAN; 2]));
        hprintln!("region\t{}.step.n200\t{}", name, STEPS * PARTICLES);
        hprintln!("figure\t{}.error_m\t{:.3}\tm", name, error);
    }

    #[entry]
    fn main() -> ! {
        static mut MEMORY: [MaybeUninit<u8>; HEAP_BYTES] = [MaybeUninit::uninit(); HEAP_BYTES];
        // SAFETY: called once, before the first allocation, with memory that nothing else uses.
        unsafe { HEAP.init(MEMORY.as_ptr() as usize, HEAP_BYTES) }

        let sightings = sightings();
        drive::<Foxhunt<PARTICLES>>("m4f.peer.foxhunt", &sightings);
        drive::<Multicalc<f32>>("m4f.peer.multicalc", &sightings);
        drive::<BayesEstimate>("m4f.peer.bayes_estimate", &sightings);
        debug::exit(debug::EXIT_SUCCESS);
        loop {
            asm::wfi();
        }
    }

    #[panic_handler]
    fn panic(info: &core::panic::PanicInfo) -> ! {
        hprintln!("{}", info);
        debug::exit(debug::EXIT_FAILURE);
        loop {
            asm::wfi();
        }
    }
}

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("peers_m4 is firmware: build it with --target thumbv7em-none-eabihf");
}
