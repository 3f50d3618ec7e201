//! Several sources at rest on one channel: found by default, and told apart; beside locators that are told whose each reading
//! is.

use anyhow::Result;
use foxhunt_host::figures::Figure;

use super::{study::Study, table::table};

mod gospa;
mod locators;
mod mixture;
mod runs;
mod scenarios;

pub use gospa::{Assignment, Gospa};
use runs::{GOSPA, HEADER, Runs};
pub use scenarios::Scenario;

/// How the figures of a labelled multi-Bernoulli filter end.
pub const LMB: &str = ".gospa_lmb";

/// Prints the tables of the scenarios whose names begin like one of these, or of all, and returns their figures.
///
/// # Errors
/// When no scenario has such a name, or a reading is none.
pub fn run(study: &Study, asked: &[String]) -> Result<Vec<Figure>> {
    let scenarios = Scenario::asked(asked)?;
    println!(
        "Sources at rest, default configuration with {} tracks. Found is what is nearer to a source than the cutoff of GOSPA \
         (p = 2, alpha = 2): a quarter of the side of the square; 200 m for two sources and for one. A ghost is farther; \
         by its own region if its 99 % ellipse holds no source. Told are robust locators of the readings of one source \
         each; expectation maximisation knows how many there are, and as much of the bias as the locator beside it.\n",
        locators::TRACKS
    );
    let mut figures = Vec::new();
    for group in scenarios.chunk_by(|a, b| a.group() == b.group()) {
        let mut table = table(HEADER, 1);
        for scenario in group {
            let runs = study.runs.unwrap_or(scenario.runs).min(scenario.runs);
            let runs = Runs::new(scenario, runs, study.seed)?;
            table.add_row(runs.row());
            figures.extend(runs.figures());
        }
        println!("{table}\n");
    }
    Ok(figures)
}

/// Limits the distances of the locator by those of the filter of another crate, [`LMB`].
pub fn limit_by(figures: &mut [Figure], peers: &[Figure]) {
    for figure in figures {
        let peer = peers.iter().find(|peer| {
            let scenario = peer.name.strip_suffix(LMB);
            scenario.is_some_and(|scenario| figure.name.strip_suffix(GOSPA) == Some(scenario))
        });
        if let Some(peer) = peer {
            figure.limit = Some(figure.limit.unwrap_or(f64::INFINITY).min(peer.value));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two runs of a scenario of each kind.
    #[test]
    fn scenarios_have_their_figures() {
        let study = Study {
            runs: Some(2),
            seed: 1,
            data: None,
            pictures: std::env::temp_dir(),
            board: |_| unreachable!("nothing runs on the board"),
        };
        for name in [
            "stops.s12.n1.sigma2.own",
            "drive.sigma2.outliers",
            "pair",
            "one",
        ] {
            let figures = run(&study, &[name.to_owned()]).unwrap();
            let prefix = format!("sources.{name}");
            assert!(
                figures
                    .iter()
                    .all(|figure| figure.name.starts_with(&prefix))
            );
            let values = figures.iter().filter(|figure| figure.name.ends_with(GOSPA));
            assert!(values.count() > 0);
        }
        assert!(run(&study, &["nothing".to_owned()]).is_err());
    }

    #[test]
    fn the_nearest_of_all_others_is_the_limit() {
        let mut figures = [Figure::new("sources.a.gospa", 2.0, "m").at_most(1.5)];
        for (name, value, limit) in [("b", 1.0, 1.5), ("a", 1.7, 1.5), ("a", 1.0, 1.0)] {
            let peer = Figure::new(format!("sources.{name}.gospa_lmb"), value, "m");
            limit_by(&mut figures, &[peer]);
            assert_eq!(figures[0].limit, Some(limit));
        }
    }
}
