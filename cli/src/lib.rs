//! The tool `foxhunt`: replays logs, locates live, makes radio maps.
//!
//! | module | holds |
//! |---|---|
//! | `command` | a file for each command |
//! | `settings`, `reading` | what it is told, in a file and on the command line |
//! | `input` | where bytes come from |
//! | `engine` | the search: the library's gateway, and what follows from each piece that comes in |
//! | `live` | a search as it happens: the thread of the search, and the hub of its results |
//! | [`load`] | many gateways at once, for a study of what a broker takes |
//! | `log` | the raw log, and logs of others |
//! | `output` | where results go |
//! | `web` | the page |
//! | `wrong` | values that cannot be |

mod command;
mod engine;
mod input;
mod live;
pub mod load;
mod log;
mod output;
mod reading;
mod screen;
mod settings;
mod web;
mod wrong;

use std::process::ExitCode;

/// Runs the command that the arguments name. The exit code is 0 if it is done, 1 if it failed, 2 if the options are wrong, 3 if a
/// log has no bearing that was used.
pub fn main() -> ExitCode {
    // A deep stack: a locator with all its particles is made on it before it lies on the heap.
    const STACK: usize = 64 << 20;
    let thread = std::thread::Builder::new()
        .stack_size(STACK)
        .spawn(command::run);
    match thread.map(std::thread::JoinHandle::join) {
        Ok(Ok(code)) => code,
        _ => ExitCode::FAILURE,
    }
}
