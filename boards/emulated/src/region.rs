//! Regions of a firmware whose instructions are counted.

use core::{
    hint::black_box,
    sync::atomic::{Ordering, compiler_fence},
};

use cortex_m_semihosting::hprintln;

/// Marks the beginning and the end of a region.
#[inline(never)]
fn region_edge() {
    compiler_fence(Ordering::SeqCst);
    cortex_m::asm::nop();
}

/// A region whose cost is divided by `items`. Regions of one name are added up.
pub fn region<T>(name: &str, items: usize, work: impl FnOnce() -> T) -> T {
    hprintln!("region\t{}\t{}", name, items);
    region_edge();
    let result = black_box(work());
    region_edge();
    result
}
