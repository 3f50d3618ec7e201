//! What is said on the screen.

use std::fmt::Write;

use comfy_table::{Cell, CellAlignment, Table, presets::ASCII_MARKDOWN};
use foxhunt::{
    aoa::Answer,
    gateway::{Counters, Rejected},
};
use foxhunt_host::archive::{Answered, Archive, Kind, coordinates};

/// What became of the lines, by name.
pub fn counts(counters: &Counters) -> Vec<(String, u32)> {
    let mut counts = vec![
        ("all".into(), counters.lines),
        ("sentences used".into(), counters.sentences),
        ("bearings used".into(), counters.bearings),
        ("sentences for others".into(), counters.ignored),
        ("queries".into(), counters.queries),
        ("restarts".into(), counters.restarts),
    ];
    for reason in Rejected::ALL {
        let count = counters.rejected(reason);
        if count > 0 {
            counts.push((format!("rejected: {reason}"), count));
        }
    }
    counts
}

/// The same as a JSON object.
pub fn object(counters: &Counters) -> serde_json::Value {
    let counts = counts(counters).into_iter();
    counts
        .map(|(name, count)| (name, serde_json::Value::from(count)))
        .collect()
}

/// The same as a table, below the number of bytes.
pub fn lines(bytes: u64, counters: &Counters) -> String {
    format!("{bytes} bytes\n{}", table(counters))
}

/// The same as a table.
pub fn table(counters: &Counters) -> Table {
    let mut table = Table::new();
    table.load_style(ASCII_MARKDOWN).set_header(["lines", ""]);
    for (name, count) in counts(counters) {
        let count = Cell::new(count).set_alignment(CellAlignment::Right);
        table.add_row([Cell::new(name), count]);
    }
    table
}

/// What has changed since the first `shown` answers: fixes that came and went.
pub fn news(answers: &[Answered], shown: usize) -> Vec<String> {
    let before = (shown > 0).then(|| &answers[shown - 1]);
    let mut last = before.map_or(0, |known| known.sources.len());
    let mut lines = Vec::new();
    for known in &answers[shown..] {
        let count = known.sources.len();
        if count != last {
            let what = match count {
                0 => "no fix any more".into(),
                1 => "a fix".into(),
                more => format!("fixes of {more} sources"),
            };
            lines.push(format!("{what}, by {} bearings", known.bearings));
        }
        last = count;
    }
    lines
}

/// What is known at the end.
pub fn answer(archive: &Archive) -> String {
    let last = archive.last();
    let mut text = String::new();
    let mut line = |arguments: std::fmt::Arguments| {
        writeln!(text, "{arguments}").expect("a string takes all");
    };
    for source in &last.sources {
        let ellipse = source.fix.ellipse(0.95);
        let place = match coordinates(&last.plane, source.fix.position) {
            Some([longitude, latitude]) => format!("at {latitude:.7}, {longitude:.7}"),
            None => "too far away for coordinates".into(),
        };
        line(format_args!(
            "source {} {place}, within {:.1} m by {:.1} m with 95 % probability, by {} bearings",
            source.identity, ellipse.semi_major, ellipse.semi_minor, source.fix.bearings,
        ));
        if let Some(motion) = source.motion {
            let [east, north] = motion.velocity_m_s;
            line(format_args!(
                "  moves with {:.0} % probability, at {:.1} m/s",
                100.0 * motion.moving,
                east.hypot(north),
            ));
        }
    }
    if let Answer::NotObservable(reason) = last.answer {
        line(format_args!("no fix: {}", reason));
    }
    let likely = archive.hypotheses.iter().filter(|h| h.probability >= 0.01);
    if last.sources.is_empty() || likely.clone().count() > 1 {
        for hypothesis in likely {
            if let Some([longitude, latitude]) = coordinates(&last.plane, hypothesis.position) {
                line(format_args!(
                    "hypothesis at {latitude:.7}, {longitude:.7}: {:.0} %",
                    100.0 * hypothesis.probability,
                ));
            }
        }
    }
    if let Some(bias) = last.bias {
        line(format_args!(
            "bearings have a common bias of {:+.1} degrees (sigma {:.1})",
            -bias.mean_rad.to_degrees(),
            bias.sigma_rad.to_degrees(),
        ));
    }
    if archive.last_bearings().any(|taken| taken.kind().is_some()) {
        let count = |kind| {
            let is = |taken: &&_| foxhunt_host::archive::Taken::kind(taken) == Some(kind);
            archive.last_bearings().filter(is).count()
        };
        line(format_args!(
            "bearings: {} direct, {} mirrored, {} rejected as outliers, {} of what has moved on or is not known any more",
            count(Kind::Direct),
            count(Kind::Mirrored),
            count(Kind::Outlier),
            count(Kind::Past),
        ));
    }
    if let (true, Some(advice)) = (last.sources.is_empty(), archive.advice) {
        line(format_args!(
            "drive {:.0} m towards {:.0} degrees: bearings tell most there",
            advice.distance_m,
            advice.direction.compass_degrees(),
        ));
    }
    text
}
