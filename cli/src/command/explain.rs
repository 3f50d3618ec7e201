//! `foxhunt explain`: the story of a log.

use std::{collections::BTreeMap, path::PathBuf};

use anyhow::{Result, bail};
use foxhunt::{
    aoa::Answer,
    gateway::{Event, Rejected},
};
use foxhunt_host::archive::{Answered, Kind, times::time};
use serde::Serialize;

use super::{
    failure::NothingUsed,
    replay::{self, Told},
    summary,
};
use crate::{
    engine::{Engine, Happened, code, legible},
    log, screen,
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

/// Lines that were refused for one reason.
#[derive(Debug, Clone, Serialize)]
struct Refused {
    reason: String,
    count: u64,
    /// Where the first is: the log and the number of its line.
    first: String,
    line: String,
    help: Option<&'static str>,
}

/// Runs the command.
pub fn run(options: &Options) -> Result<()> {
    let names: Vec<String> = options.files.iter().map(|file| log::name(file)).collect();
    let mut refused: BTreeMap<String, Refused> = BTreeMap::new();
    let mut note = |input: usize, number: u64, reason: String, line: &[u8], help| {
        let name = names.get(input).or(names.first());
        let entry = refused.entry(reason.clone()).or_insert_with(|| Refused {
            reason,
            count: 0,
            first: format!("{}:{number}", name.map_or("", String::as_str)),
            line: legible(line),
            help,
        });
        entry.count += 1;
    };
    let mut say = |_: &_, happened: Happened<'_>| match happened {
        Happened::Line {
            input,
            number,
            line,
            event: Event::Rejected(reason),
        } => note(input, number, reason.to_string(), line, advice(*reason)),
        Happened::Refused {
            input,
            number,
            reason,
        } => note(input, number, reason.to_string(), b"", None),
        _ => {}
    };
    let (engine, _) = replay::read_with(
        &options.files,
        options.one_line,
        &options.told,
        &mut |_, _| Ok(()),
        &mut say,
    )?;
    let mut refused: Vec<Refused> = refused.into_values().collect();
    refused.sort_by_key(|one| std::cmp::Reverse(one.count));
    let story = story(&engine, refused);
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
            first,
            ..
        } = one;
        screen::line(format_args!(
            "\n{count} refused: {reason}\n  first {first}: {}",
            one.line
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

/// What to do about lines that were refused.
fn advice(reason: Rejected) -> Option<&'static str> {
    Some(match reason {
        Rejected::NoHeading => {
            "bearings count from the bow: send HDT sentences, or say `--reference true-north` if they are absolute, or \
             `--heading station` of a KrakenSDR that stands"
        }
        Rejected::LowQuality => {
            "the finder hears nothing, or its quality is on another scale: try `--minimum-quality 0`"
        }
        Rejected::StalePosition => {
            "the receiver was silent, or the clock of the finder is wrong, or lines stand in another order than they came"
        }
        Rejected::NoPosition => "the receiver had no position yet",
        Rejected::Frozen => "the KrakenSDR heard nothing, and repeated what it last heard",
        Rejected::Duplicate => "the page of a finder was read twice, which does no harm",
        Rejected::Checksum => {
            "lines were damaged: look at the cable, the baud rate, and whether two programs read the port"
        }
        Rejected::Unparsable => "these are no lines of a known device, or parts of some",
        Rejected::Turning => "there is no compass, and the course is no heading in a bend",
        Rejected::NoVariation => "say how far magnetic north is off: `--variation DEGREES`",
        Rejected::Simulated => "to use positions of a simulator: `--simulated`",
        Rejected::TimeBackwards => "two clocks are mixed on one line, or a clock was set back",
        Rejected::Unconfirmed => {
            "a position waits for a second that agrees: one or two at the beginning are usual"
        }
        Rejected::OtherFrequency
        | Rejected::OtherTag
        | Rejected::OtherFinder
        | Rejected::OtherAnchor => "the options name another one",
        _ => return None,
    })
}

fn story(engine: &Engine, refused: Vec<Refused>) -> Story {
    let answers = engine.answers();
    let archive = engine.archive().ok();
    let mut help = Vec::new();
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
        refused,
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
