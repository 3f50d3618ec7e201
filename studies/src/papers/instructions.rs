//! What a run of each method takes on a Cortex-M4F, from the firmware `studies` in the emulator.

use std::collections::HashMap;

use anyhow::{Context, Result};

use super::statistics::Estimate;

/// Executed instructions of one run, by what the method is called in tables: the mean over a few runs.
pub struct Instructions(HashMap<String, Estimate>);

impl Instructions {
    /// From what the firmware printed.
    pub(super) fn read(printed: &str) -> Result<Self> {
        let mut runs: HashMap<String, Vec<f64>> = HashMap::new();
        for line in printed.lines() {
            let ["figure", method, count, "instructions"] =
                line.split('\t').collect::<Vec<_>>()[..]
            else {
                anyhow::bail!("the firmware wrote: {line}");
            };
            runs.entry(method.into()).or_default().push(count.parse()?);
        }
        let means = runs
            .into_iter()
            .map(|(method, counts)| (method, Estimate::mean(&counts)));
        Ok(Self(means.collect()))
    }

    /// Of the method that is called so.
    pub fn per_run(&self, method: &str) -> Result<Estimate> {
        let count = self.0.get(method);
        count
            .copied()
            .with_context(|| format!("the firmware has not run: {method}"))
    }
}

/// As tables show a number of instructions, or of calls: three digits, in thousands or millions; nothing for none.
pub fn short(count: f64) -> String {
    if count == 0.0 {
        return String::new();
    }
    let (unit, suffix) = match count {
        ..1e3 => (1.0, ""),
        ..1e6 => (1e3, " k"),
        _ => (1e6, " M"),
    };
    let value = count / unit;
    let decimals = match value {
        _ if unit == 1.0 => 0,
        ..10.0 => 2,
        ..100.0 => 1,
        _ => 0,
    };
    format!("{value:.decimals$}{suffix}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_one_method_are_averaged() {
        let log = "figure\ta, 1\t100\tinstructions\nfigure\tb\t7\tinstructions\nfigure\ta, 1\t300\tinstructions\n";
        let instructions = Instructions::read(log).unwrap();
        assert_eq!(instructions.per_run("a, 1").unwrap().value, 200.0);
        assert_eq!(instructions.per_run("b").unwrap().value, 7.0);
        assert!(instructions.per_run("c").is_err());
        assert!(Instructions::read("panicked").is_err());
    }

    #[test]
    fn counts_are_short() {
        let shown = [0.0, 950.0, 1_260.0, 81_360.0, 133_430_280.0].map(short);
        assert_eq!(shown, ["", "950", "1.26 k", "81.4 k", "133 M"]);
    }
}
