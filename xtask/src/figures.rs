//! Figures, printed as a table and written as JSON.

use std::{fs, path::Path};

use anyhow::{Context, Result, ensure};
use comfy_table::{Cell, CellAlignment, Color, Table, presets::ASCII_MARKDOWN};
use foxhunt_host::figures::Figure;

/// A unit of memory, in bytes.
pub const KIB: f64 = 1024.0;

/// Prints the figures as a table, the missed limits in red.
pub fn print(figures: &[Figure]) {
    let mut table = Table::new();
    table
        .load_style(ASCII_MARKDOWN)
        .set_header(["figure", "value", "limit", "unit", ""]);
    for figure in figures {
        let verdict = match figure.limit {
            None => Cell::new(""),
            Some(_) if figure.ok() => Cell::new("ok").fg(Color::Green),
            Some(_) => Cell::new("MISSED").fg(Color::Red),
        };
        let right = |text| Cell::new(text).set_alignment(CellAlignment::Right);
        table.add_row([
            Cell::new(&figure.name),
            right(number(figure.value)),
            right(figure.limit.map(number).unwrap_or_default()),
            Cell::new(&figure.unit),
            verdict,
        ]);
    }
    println!("{table}");
}

/// Writes the figures to `file` as a JSON list of `{"name", "value", "unit", "limit"}`.
pub fn write_json(figures: &[Figure], file: &Path) -> Result<()> {
    let text = serde_json::to_string_pretty(figures)?;
    fs::write(file, text + "\n").with_context(|| format!("cannot write {}", file.display()))
}

/// Fails, naming them, if figures miss their limits.
pub fn check(figures: &[Figure]) -> Result<()> {
    let missed = figures.iter().filter(|figure| !figure.ok());
    let missed = missed.map(|figure| {
        let limit = figure.limit.map(number).unwrap_or_default();
        format!(
            "{}: {}, at most {limit} {}",
            figure.name,
            number(figure.value),
            figure.unit
        )
    });
    let missed: Vec<String> = missed.collect();
    ensure!(
        missed.is_empty(),
        "figures miss their limits:\n  {}",
        missed.join("\n  ")
    );
    Ok(())
}

/// Four significant digits, or all digits of a whole number; of very small ones three.
fn number(value: f64) -> String {
    if value.abs() < 1e-3 && value != 0.0 {
        return format!("{value:.2e}");
    }
    if value == value.trunc() || value.abs() >= 1000.0 {
        return format!("{value:.0}");
    }
    let decimals = (3 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_but_whole_ones_exact() {
        assert_eq!(number(161.0), "161");
        assert_eq!(number(65_536.0), "65536");
        assert_eq!(number(24.1234), "24.12");
        assert_eq!(number(0.012_345), "0.01235");
        assert_eq!(number(0.000_000_789_1), "7.89e-7");
    }
}
