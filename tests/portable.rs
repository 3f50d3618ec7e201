//! The portable cases under a test harness on the host, and as firmware of the emulated board.

#![cfg_attr(target_os = "none", no_std, no_main)]

use foxhunt_portable::{all, check};

/// Runs the cases under a test harness, or, with `BLESS` in the environment, rewrites their digests.
#[cfg(not(target_os = "none"))]
fn main() -> std::io::Result<()> {
    use foxhunt_portable::Case;
    use libtest_mimic::{Arguments, Trial};

    if std::env::var_os("BLESS").is_some() {
        let line = |(name, case): Case| format!("{name} {:016x}\n", case().0);
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/portable/digests.txt");
        return std::fs::write(file, all().map(line).collect::<String>());
    }
    let trial = |case: Case| {
        Trial::test(case.0, move || {
            check(case);
            Ok(())
        })
    };
    libtest_mimic::run(&Arguments::from_args(), all().map(trial).collect()).exit()
}

/// Runs the cases on the board.
#[cfg(target_os = "none")]
fn run() {
    for case in all() {
        cortex_m_semihosting::hprintln!("{}", case.0);
        check(case);
    }
}

foxhunt_emulated::program!(board: run);
