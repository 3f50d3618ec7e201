//! Walks that were measured in an office: one set of parameters, the library's.

mod both;
mod figures;
mod published;
mod tracked;

use anyhow::Result;
use foxhunt_host::{
    figures::Figure,
    picture::{Axis, Curves},
    walks::Office,
};

use self::{
    both::Both,
    figures::Results,
    tracked::{FOUR, SEEDS, Tracked, sets_of_four},
};
use super::{coverage::Coverage, errors::Errors, pictures};
use crate::papers::{study::Study, table::table};

/// Runs all experiments, if there is data.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let Some(data) = study.data("tetam", "walks") else {
        return Ok(Vec::new());
    };
    let office = Office::open(&data)?;
    let tracked = Tracked::new(&office, study.seed)?;
    let (dead, numbers) = tracked.worst();
    let results = Results {
        left_out_db: office.left_out_db(),
        dead,
        tracked,
        matched: published::memoryless(&office)?,
        printed: published::two_stage(&office, SEEDS, study.seed, false)?,
        fitted: published::two_stage(&office, SEEDS, study.seed, true)?,
        sets: sets_of_four(&office, study.seed)?,
    };
    let four = format!("tracker, receivers {FOUR:?}");
    let [straight, plane] = numbers;
    let dead = format!("tracker, worst receiver dead ({straight}; {plane} in the plane)");
    let tracked = &results.tracked;
    let rows = [
        ("match of the last 2 s, no memory", &results.matched),
        ("match, then PF, 200/40 as printed", &results.printed),
        ("match, then PF, what these matches err by", &results.fitted),
        ("tracker", &tracked.all),
        (&four, &tracked.four),
        ("tracker, tag 10 dB too strong", &tracked.louder),
        ("tracker, tag 10 dB too weak", &tracked.quieter),
        ("tracker, 5 % random outliers", &tracked.outliers),
        (&dead, &results.dead),
    ];
    print(&office, &rows);
    remark(&office, &results);
    draw(study, &rows)?;
    for walk in office.walks.iter().filter(|walk| !walk.is_straight).take(1) {
        pictures::measured(study, &office, walk)?;
    }
    Ok(results.figures())
}

fn print(office: &Office, rows: &[(&str, &Both)]) {
    println!(
        "Walks measured in an office with {} receivers: three along corridors, two in the plane. A step is every \
         2 s, from 2 s after the start; errors in the plane, {SEEDS} filter seeds of every walk, the tracker with the \
         library's own settings. The radio map errs by {:.2} dB where a place of the survey is left out.",
        office.receivers.len(),
        office.left_out_db()
    );
    let header = [
        "method",
        "straight: < 2 m",
        "90 % below m",
        "largest m",
        "plane: < 2 m",
        "median m",
        "90 % below m",
        "largest m",
    ];
    let mut table = table(header, 1);
    for (label, Both { straight, plane }) in rows {
        let near = |errors: &Errors| format!("{:.1} %", 100.0 * errors.near().value);
        let quantile = |errors: &Errors, fraction| format!("{:.2}", errors.quantile(fraction));
        table.add_row([
            (*label).to_owned(),
            near(straight),
            quantile(straight, 0.9),
            quantile(straight, 1.0),
            near(plane),
            quantile(plane, 0.5),
            quantile(plane, 0.9),
            quantile(plane, 1.0),
        ]);
    }
    println!("{table}");
}

fn remark(office: &Office, results: &Results) {
    let tracked = &results.tracked;
    let [straight, plane] = results.loud_late();
    let [low, high] = results.median_of(100).map(|near| 100.0 * near);
    println!(
        "Four receivers: those were chosen by these walks, as the best of {} sets. The median set has {:.1} % of the steps of \
         the straight walks below 2 m, that of 100 sets that are drawn at random {low:.1} to {high:.1} %; {:.0} % of the sets have \
         85 %.\n\
         A tag 10 dB too strong is found late on the straight walks, 90 % of the steps within {:.2} m instead of {:.2} m: an \
         end of a corridor and an offset look alike to the first scans. From the tenth second on that is {straight:.2} times \
         as much, in the plane {plane:.2} times.\n\
         With all receivers {}.",
        results.sets.len(),
        100.0 * results.median_set(),
        100.0 * results.good_sets(),
        tracked.louder.straight.quantile(0.9),
        tracked.all.straight.quantile(0.9),
        Coverage::pooled(&tracked.held),
    );
    for (walk, held) in office.walks.iter().zip(&tracked.held) {
        println!("- {}: {:.1} %", walk.name, 100.0 * held.value());
    }
    println!();
}

fn draw(study: &Study, rows: &[(&str, &Both)]) -> Result<()> {
    const SHOWN: [usize; 6] = [0, 1, 2, 4, 5, 3];
    let curves = |name: &str, of: fn(&Both) -> &Errors| Curves {
        title: name.to_owned(),
        horizontal: Axis::linear("error in m"),
        vertical: Axis::linear("% of the steps below"),
        curves: SHOWN
            .iter()
            .map(|row| of(rows[*row].1).curve(rows[*row].0, 6.0))
            .collect(),
    };
    let pictures = [
        curves("Measured walks along corridors", |both| &both.straight),
        curves("Measured walks in the plane", |both| &both.plane),
    ];
    study.save(&Curves::grid(&pictures, 2)?, "fingerprint-measured")?;
    println!();
    Ok(())
}
