//! What must hold on the target as on the host: the same cases run here under a test harness and there as
//! firmware, and what they compute must be the same to the last bit.
//!
//! `digests.txt` holds what they computed when it was last rewritten (`cargo xtask test --bless`).

#![cfg_attr(target_os = "none", no_std, no_main)]

mod aoa;
mod digest;
mod filter;
mod fingerprint;
mod gateway;
mod math;
mod proposal;
mod random;
mod refine;
mod snapshot;

use digest::Digest;

/// A case: its name, and a check that panics unless it holds and returns the digest of what it computed.
type Case = (&'static str, fn() -> Digest);

const GROUPS: &[&[Case]] = &[
    math::CASES,
    random::CASES,
    filter::CASES,
    aoa::CASES,
    refine::CASES,
    proposal::CASES,
    fingerprint::CASES,
    gateway::CASES,
    snapshot::CASES,
];

fn cases() -> impl Iterator<Item = Case> {
    GROUPS.iter().copied().flatten().copied()
}

/// Runs a case.
///
/// # Panics
/// When it does not hold or has computed something new.
fn check((name, case): Case) {
    let mut digests = include_str!("digests.txt")
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

/// Runs the cases under a test harness, or, with `BLESS` in the environment, rewrites their digests.
#[cfg(not(target_os = "none"))]
fn main() -> std::io::Result<()> {
    use libtest_mimic::{Arguments, Trial};

    if std::env::var_os("BLESS").is_some() {
        let line = |(name, case): Case| format!("{name} {:016x}\n", case().0);
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/portable/digests.txt");
        return std::fs::write(file, cases().map(line).collect::<String>());
    }
    let trial = |case: Case| {
        Trial::test(case.0, move || {
            check(case);
            Ok(())
        })
    };
    libtest_mimic::run(&Arguments::from_args(), cases().map(trial).collect()).exit()
}

/// Runs the cases on the board.
#[cfg(target_os = "none")]
fn run() {
    for case in cases() {
        cortex_m_semihosting::hprintln!("{}", case.0);
        check(case);
    }
}

#[cfg(target_os = "none")]
foxhunt_emulated::program!(run);
