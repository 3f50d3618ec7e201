//! The figures of the firmware that are checked in, so that a change of cost is seen where it is made.

use std::{collections::BTreeMap, fs, path::PathBuf};

use anyhow::{Context, Result, ensure};
use foxhunt_host::figures::Figure;
use serde::{Deserialize, Serialize};

use crate::project;

/// By how much of itself a figure may differ when another compiler made it. With the same compiler it is the
/// same, on every machine and in every directory.
const OTHER_COMPILER: f64 = 0.10;
/// Figures are written with two decimals.
const ROUNDING: f64 = 0.011;

/// Figures, and the compiler whose code they are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Expected {
    compiler: String,
    figures: BTreeMap<String, f64>,
}

impl Expected {
    /// `figures` as measured with the present compiler.
    pub fn of(figures: &[Figure]) -> Result<Self> {
        let rounded = |value: f64| (value * 100.0).round() / 100.0;
        let figures = figures
            .iter()
            .map(|figure| (figure.name.clone(), rounded(figure.value)));
        Ok(Self {
            compiler: project::rustc(&["--version"])?,
            figures: figures.collect(),
        })
    }

    /// The checked-in figures.
    pub fn read() -> Result<Self> {
        let text = fs::read_to_string(file())
            .with_context(|| format!("cannot read {}; bless it first", file().display()))?;
        Ok(serde_json::from_str(&text)?)
    }

    /// The figure of this name.
    pub fn figure(&self, name: &str) -> Result<f64> {
        let figure = self.figures.get(name).copied();
        figure.with_context(|| format!("no {name} is expected"))
    }

    /// Makes these figures the checked-in ones.
    pub fn write(&self) -> Result<()> {
        let text = serde_json::to_string_pretty(self)? + "\n";
        fs::write(file(), text).with_context(|| format!("cannot write {}", file().display()))
    }

    /// Fails, naming the figures, if `measured` differs from these: a figure rose or fell, came
    /// or went.
    pub fn compare(&self, measured: &Self) -> Result<()> {
        let tolerance = if self.compiler == measured.compiler {
            0.0
        } else {
            OTHER_COMPILER
        };
        let mut differences = Vec::new();
        for (name, &expected) in &self.figures {
            match measured.figures.get(name) {
                Some(&value) if (value - expected).abs() <= ROUNDING + tolerance * expected => {}
                Some(value) => {
                    differences.push(format!("{name}: expected {expected}, measured {value}"))
                }
                None => differences.push(format!("{name}: expected {expected}, not measured")),
            }
        }
        for name in measured
            .figures
            .keys()
            .filter(|name| !self.figures.contains_key(*name))
        {
            differences.push(format!("{name}: not expected"));
        }
        ensure!(
            differences.is_empty(),
            "figures differ from those of {} ({}); if that is intended, run with --bless:\n  {}",
            file().display(),
            self.compiler,
            differences.join("\n  ")
        );
        Ok(())
    }
}

fn file() -> PathBuf {
    project::root().join("xtask/expected/firmware.json")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expected(compiler: &str, figures: &[(&str, f64)]) -> Expected {
        Expected {
            compiler: compiler.into(),
            figures: figures
                .iter()
                .map(|&(name, value)| (name.into(), value))
                .collect(),
        }
    }

    #[test]
    fn the_same_compiler_makes_the_same_figures() {
        let old = expected("1", &[("a", 200.0)]);
        assert!(old.compare(&expected("1", &[("a", 200.01)])).is_ok());
        assert!(old.compare(&expected("1", &[("a", 200.1)])).is_err());
        assert!(old.compare(&expected("1", &[("a", 199.9)])).is_err());
    }

    #[test]
    fn another_compiler_may_differ_a_little() {
        let old = expected("1", &[("a", 200.0)]);
        assert!(old.compare(&expected("2", &[("a", 210.0)])).is_ok());
        assert!(old.compare(&expected("2", &[("a", 225.0)])).is_err());
    }

    #[test]
    fn figures_neither_come_nor_go_unseen() {
        let (one, two) = (
            expected("1", &[("a", 1.0)]),
            expected("1", &[("a", 1.0), ("b", 1.0)]),
        );
        assert!(one.compare(&two).is_err());
        assert!(two.compare(&one).is_err());
    }
}
