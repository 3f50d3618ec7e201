//! The only module that may hold `unsafe`: instructions that safe Rust cannot name.
#![allow(unsafe_code)]

#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
unsafe extern "C" {
    // SAFETY: the C standard's `float sqrtf(float)`, a pure function of its argument, which
    // compiler-builtins provides on every bare-metal target. The compiler knows it by name and emits
    // `vsqrt.f32` in its place; the call remains only for a negative argument, where both give NaN.
    safe fn sqrtf(x: f32) -> f32;
}

/// Square root, correctly rounded; NaN for a negative argument.
///
/// One `vsqrt.f32` where there is a floating-point unit. Correct rounding leaves only one result, so the
/// ways to compute it cannot disagree.
#[inline(always)]
pub fn sqrt(x: f32) -> f32 {
    #[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
    return sqrtf(x);
    #[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
    return libm::sqrtf(x);
}
