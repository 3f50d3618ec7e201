//! The commands.

mod compare;
mod explain;
mod failure;
mod init;
mod live;
mod refusals;
mod replay;
mod scenario;
mod simulate;
mod summary;
mod survey;

use std::process::ExitCode;

use clap::Parser;

use crate::screen;
use failure::NothingUsed;

/// Finds radio transmitters by bearings, and tags by how strongly radios hear them: from logs, and live.
#[derive(Parser)]
#[command(name = "foxhunt", version, max_term_width = 100)]
enum Command {
    Replay(replay::Options),
    Live(live::Options),
    Explain(explain::Options),
    Compare(compare::Options),
    Simulate(simulate::Options),
    Init(init::Options),
    #[command(subcommand)]
    Survey(survey::Command),
}

/// Runs the command that the arguments name.
pub fn run() -> ExitCode {
    let done = match Command::parse() {
        Command::Replay(options) => replay::run(&options),
        Command::Explain(options) => explain::run(&options),
        Command::Compare(options) => compare::run(&options),
        Command::Live(options) => live::run(&options),
        Command::Simulate(options) => simulate::run(&options),
        Command::Init(options) => init::run(&options),
        Command::Survey(command) => survey::run(&command),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if screen::is_unread(&error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            match error.downcast_ref::<NothingUsed>() {
                Some(_) => ExitCode::from(3),
                None => ExitCode::FAILURE,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn every_command_has_an_example() {
        fn check(command: &clap::Command) {
            for inner in command.get_subcommands().filter(|c| c.get_name() != "help") {
                if inner.has_subcommands() {
                    check(inner);
                    continue;
                }
                let example = inner.get_after_help().map(ToString::to_string);
                let example = example.unwrap_or_default();
                assert!(example.contains("foxhunt "), "{}", inner.get_name());
            }
        }
        let command = super::Command::command();
        command.clone().debug_assert();
        check(&command);
    }
}
