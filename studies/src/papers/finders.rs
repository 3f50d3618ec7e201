//! How far the stated errors of direction finders can be trusted among reflections, by the method of the spectrum.

use anyhow::Result;
use comfy_table::{Table, presets::ASCII_MARKDOWN};
use foxhunt_host::{
    array::{Method, coverage},
    figures::Figure,
};

use super::Study;

/// Readings of each method, unless told otherwise.
const RUNS: u32 = 2_000;
/// The least rate of readings of which a 95 % interval holds the truth.
const LEAST: f64 = 0.9;

/// Prints the table, and returns its figures.
///
/// # Errors
/// None.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
    let runs = u64::from(study.runs.unwrap_or(RUNS));
    let mut table = Table::new();
    table.load_style(ASCII_MARKDOWN).set_header([
        "method",
        "bearing",
        "truth within 95 %",
        "of the best",
        "stated sigma, degrees",
        "error, degrees",
        "bearings",
    ]);
    let mut figures = Vec::new();
    for method in Method::ALL {
        for (spectra, name) in [(false, "field"), (true, "spectrum")] {
            let found = coverage(method, spectra, runs, study.seed);
            table.add_row([
                method.name().to_owned(),
                name.to_owned(),
                format!("{:.1} %", 100.0 * found.any),
                format!("{:.1} %", 100.0 * found.best),
                format!("{:.1}", found.stated),
                format!("{:.1}", found.error),
                format!("{:.2}", found.bearings),
            ]);
            let figure = |what, value, unit| {
                Figure::new(
                    format!("kraken.{}.{name}.{what}", method.name()),
                    value,
                    unit,
                )
            };
            figures.push(figure("missed", 1.0 - found.any, "rate").at_most(1.0 - LEAST));
            figures.push(figure("sigma", found.stated, "degrees"));
            figures.push(figure("error", found.error, "degrees"));
        }
    }
    println!(
        "{runs} readings of a KrakenSDR, with a reflection of 0.2 to 0.6 from anywhere:\n\n{table}\n"
    );
    Ok(figures)
}
