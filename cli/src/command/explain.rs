//! `foxhunt explain`: the story of a log.

use std::path::PathBuf;

use anyhow::{Result, bail};
use foxhunt::aoa::Answer;
use foxhunt_host::archive::{Answered, Kind, times::time};
use serde::Serialize;

use super::{
    failure::NothingUsed,
    refusals::{Refusals, Refused},
    replay::{self, Told},
    summary,
};
use crate::{
    engine::{Engine, code},
    screen,
};

/// Tell the story of a log: what was refused and why, when a fix became possible, and what would have helped
#[derive(clap::Args)]
#[command(after_help = "Example:\n  foxhunt explain drive.nmea")]
pub struct Options {
    /// The logs, or `-` for the standard input.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Several logs are of one line.
    #[arg(long)]
    one_line: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    told: Told,
}

/// What is told.
#[derive(Debug, Serialize)]
struct Story {
    /// Lines that were not used, the most frequent reason first.
    refused: Vec<Refused>,
    /// What became known, and when.
    events: Vec<String>,
    /// What is known at the end.
    end: String,
    /// What would have helped.
    help: Vec<String>,
}

/// Runs the command.
pub fn run(options: &Options) -> Result<()> {
    let mut refusals = Refusals::of(&options.files);
    let (engine, _) = replay::read_with(
        &options.files,
        options.one_line,
        &options.told,
        &mut |_, _| Ok(()),
        &mut |_, happened| refusals.note(&happened),
    )?;
    let story = story(&engine, &refusals);
    if options.json {
        screen::json(&story)?;
    } else {
        print(&story, &engine)?;
    }
    if engine.answers().is_empty() {
        bail!(NothingUsed("no bearing was used".into()));
    }
    Ok(())
}

fn print(story: &Story, engine: &Engine) -> Result<()> {
    screen::line(summary::table(engine.counters()))?;
    for one in &story.refused {
        let Refused {
            reason,
            count,
            line,
            ..
        } = one;
        screen::line(format_args!(
            "\n{count} refused: {reason}\n  {}\n  first: {line}",
            one.where_they_are()
        ))?;
        if let Some(help) = one.help {
            screen::line(format_args!("  {help}"))?;
        }
    }
    screen::line("")?;
    for event in &story.events {
        screen::line(event)?;
    }
    screen::line(story.end.trim_end())?;
    for help in &story.help {
        screen::line(format_args!("would have helped: {help}"))?;
    }
    Ok(())
}

fn story(engine: &Engine, refusals: &Refusals) -> Story {
    let answers = engine.answers();
    let archive = engine.archive().ok();
    let mut help: Vec<String> = refusals.hint().into_iter().collect();
    if let Some(Answer::NotObservable(reason)) = answers.last().map(|last| last.answer) {
        help.push(format!("to {}", reason.help()));
    }
    if let Some(archive) = &archive {
        let of = |kind| {
            let is = |taken: &&foxhunt_host::archive::Taken| taken.kind() == Some(kind);
            archive.last_bearings().filter(is).count()
        };
        let all = archive.last_bearings().count();
        if 4 * of(Kind::Outlier) > all {
            help.push(format!(
                "{} of {all} bearings are outliers: reflections, another transmitter, or a finder that is mounted askew \
                 (`--bias-sigma`)",
                of(Kind::Outlier)
            ));
        }
        if 4 * of(Kind::Mirrored) > all {
            help.push("many bearings are mirrored: they may grow the other way (`--sense counter-clockwise`)".into());
        }
    }
    Story {
        refused: refusals.sorted().into_iter().cloned().collect(),
        events: events(answers),
        end: archive.map_or("no bearing was used".into(), |archive| {
            summary::answer(&archive)
        }),
        help,
    }
}

/// Fixes that came and went, and reasons that changed.
fn events(answers: &[Answered]) -> Vec<String> {
    let mut events = Vec::new();
    let mut last: Option<(u32, usize, &'static str)> = None;
    for known in answers {
        let (code, text) = match known.answer {
            Answer::NotObservable(reason) => (code(reason), reason.to_string()),
            Answer::Fix(_) => ("", String::new()),
        };
        let now = (known.search, known.sources.len(), code);
        if last != Some(now) {
            let what = match (&*known.sources, last) {
                ([], _) => format!("no fix: {text}"),
                ([one], _) => {
                    let ellipse = one.fix.ellipse(0.95);
                    format!(
                        "a fix, within {:.0} m by {:.0} m",
                        ellipse.semi_major, ellipse.semi_minor
                    )
                }
                (more, _) => format!("fixes of {} sources", more.len()),
            };
            let search = match last {
                Some((before, ..)) if before != known.search => "another search: ",
                _ => "",
            };
            events.push(format!(
                "{} UTC, bearing {}: {search}{what}",
                time(known.time_ms),
                known.bearings
            ));
            last = Some(now);
        }
    }
    const MOST: usize = 60;
    if events.len() > MOST {
        let more = events.len() - MOST;
        events.truncate(MOST);
        events.push(format!("and {more} changes more"));
    }
    events
}
