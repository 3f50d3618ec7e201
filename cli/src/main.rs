//! The program `foxhunt`.

use std::process::ExitCode;

fn main() -> ExitCode {
    foxhunt_cli::main()
}
