//! What must hold on every target: cases, each of which panics unless it holds, and says what it computed.
//!
//! `tests/portable.rs` runs them under a test harness and as firmware of the emulated board, `boards/machines` on machines of
//! other cores. `digests.txt` holds what they computed when it was last rewritten (`cargo xtask test --bless`).

#![no_std]

mod answers;
mod aoa;
mod building;
mod digest;
mod filter;
mod fingerprint;
mod gateway;
mod locators;
mod math;
mod proposal;
mod random;
mod refine;
mod snapshot;
mod spectrum;
mod tags;
mod whole;

pub use digest::Digest;
use digest::assert_normal;

/// A case: its name, and a check that panics unless it holds and returns the digest of what it computed.
pub type Case = (&'static str, fn() -> Digest);

const GROUPS: &[&[Case]] = &[
    math::CASES,
    random::CASES,
    filter::CASES,
    aoa::CASES,
    locators::CASES,
    answers::CASES,
    spectrum::CASES,
    refine::CASES,
    proposal::CASES,
    fingerprint::CASES,
    building::CASES,
    gateway::CASES,
    tags::CASES,
    snapshot::CASES,
    whole::CASES,
];

/// All of them.
pub fn all() -> impl Iterator<Item = Case> {
    GROUPS.iter().copied().flatten().copied()
}

/// Runs a case.
///
/// # Panics
/// When it does not hold or has computed something new.
pub fn check((name, case): Case) {
    let mut digests = include_str!("../digests.txt")
        .lines()
        .filter_map(|line| line.split_once(' '));
    let (_, expected) = digests
        .find(|(known, _)| *known == name)
        .expect("not in digests.txt");
    let expected =
        u64::from_str_radix(expected, 16).expect("digests.txt holds hexadecimal numbers");
    let Digest(computed) = case();
    assert!(
        computed == expected,
        "{name} computed {computed:016x}, not {expected:016x}"
    );
}
