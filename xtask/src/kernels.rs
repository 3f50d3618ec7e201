//! The elementary functions beside those of others: the largest error of each, and a table for the guide.

use std::{
    f64::consts::{PI, TAU},
    path::Path,
};

use anyhow::{Context, Result};
use foxhunt::math;
use foxhunt_host::{
    accuracy::{ACCURACY, Accuracy, Measure},
    figures::Figure,
};
use micromath::F32Ext;

use crate::marks;

/// The functions, with the one of [`ACCURACY`] whose range and measure hold for it.
const FUNCTIONS: [(&str, &str); 5] = [
    ("exp", "exp"),
    ("ln", "ln"),
    ("atan2", "atan2"),
    ("sin_cos", "sin"),
    ("sqrt", "sqrt"),
];

/// The libraries, with what their figures have in their names.
const LIBRARIES: [Library; 3] = [
    Library {
        name: "foxhunt",
        part: "",
        exp: math::exp,
        ln: math::ln,
        sqrt: math::sqrt,
        atan2: math::atan2,
        sin_cos: math::sin_cos,
    },
    Library {
        name: "libm",
        part: ".libm",
        exp: libm::expf,
        ln: libm::logf,
        sqrt: libm::sqrtf,
        atan2: libm::atan2f,
        sin_cos: libm::sincosf,
    },
    Library {
        name: "micromath",
        part: ".micromath",
        exp: F32Ext::exp,
        ln: F32Ext::ln,
        sqrt: F32Ext::sqrt,
        atan2: F32Ext::atan2,
        sin_cos: F32Ext::sin_cos,
    },
];

struct Library {
    name: &'static str,
    part: &'static str,
    exp: fn(f32) -> f32,
    ln: fn(f32) -> f32,
    sqrt: fn(f32) -> f32,
    atan2: fn(f32, f32) -> f32,
    sin_cos: fn(f32) -> (f32, f32),
}

/// The largest error of each function of each library, over the range that filters use.
pub fn errors() -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    for (function, known) in FUNCTIONS {
        let accuracy = accuracy(known)?;
        for library in &LIBRARIES {
            let error = library.error(function, accuracy);
            let name = format!("math.{function}{}.error", library.part);
            let figure = Figure::new(name, error, unit(accuracy));
            figures.push(match library.part {
                "" => figure.at_most(f64::from(accuracy.error)),
                _ => figure,
            });
        }
    }
    Ok(figures)
}

/// Writes a table of `figures` into the guide's page `file`, between its marks.
pub fn write(figures: &[Figure], file: &Path) -> Result<()> {
    marks::write(file, "kernels", &table(figures)?)
}

fn table(figures: &[Figure]) -> Result<String> {
    let value = |name: String| {
        let mut figures = figures.iter();
        let figure = figures.find(|figure| figure.name == name);
        let figure = figure.with_context(|| format!("no {name} was measured"));
        figure.map(|figure| figure.value)
    };
    let mut table = "| function | library | instructions | modelled cycles | largest error |\n\
        |---|---|--:|--:|--:|\n"
        .to_owned();
    for (function, known) in FUNCTIONS {
        let accuracy = accuracy(known)?;
        let (from, to) = accuracy.range;
        for Library { name, part, .. } in &LIBRARIES {
            let first = match *part {
                "" => format!("`{function}`, {from} to {to}").replace("3.1415927", "π"),
                _ => String::new(),
            };
            table += &format!(
                "| {first} | {name} | {:.1} | {:.1} | {:.1e} {} |\n",
                value(format!("m4f.math.{function}{part}.instructions"))?,
                value(format!("m4f.math.{function}{part}.cycles_modelled"))?,
                value(format!("math.{function}{part}.error"))?,
                unit(accuracy),
            );
        }
    }
    Ok(table)
}

/// The entry of a function for the range that filters use, which is its first.
fn accuracy(function: &str) -> Result<&'static Accuracy> {
    let mut entries = ACCURACY.iter();
    let entry = entries.find(|entry| entry.function == function);
    entry.with_context(|| format!("{function} promises no accuracy"))
}

fn unit(accuracy: &Accuracy) -> &'static str {
    match accuracy.measure {
        Measure::Absolute => "absolute",
        Measure::Relative => "relative",
    }
}

impl Library {
    fn error(&self, function: &str, accuracy: &Accuracy) -> f64 {
        match function {
            "exp" => worst(accuracy, self.exp, f64::exp),
            "ln" => worst(accuracy, self.ln, f64::ln),
            "sqrt" => worst(accuracy, self.sqrt, f64::sqrt),
            "atan2" => worst_atan2(self.atan2),
            _ => {
                let sin = worst(accuracy, |x| (self.sin_cos)(x).0, f64::sin);
                sin.max(worst(accuracy, |x| (self.sin_cos)(x).1, f64::cos))
            }
        }
    }
}

/// The largest error at a million arguments in even steps. A relative error of zero is none.
fn worst(accuracy: &Accuracy, function: impl Fn(f32) -> f32, exact: impl Fn(f64) -> f64) -> f64 {
    let (from, to) = (f64::from(accuracy.range.0), f64::from(accuracy.range.1));
    let arguments = (0..=1_000_000).map(|i| (from + (to - from) * f64::from(i) / 1e6) as f32);
    let errors = arguments.map(|x| {
        let exact = exact(f64::from(x));
        let error = (f64::from(function(x)) - exact).abs();
        match accuracy.measure {
            Measure::Relative if exact == 0.0 => 0.0,
            Measure::Relative => error / exact.abs(),
            Measure::Absolute => error,
        }
    });
    errors.fold(0.0, f64::max)
}

/// The same at a million angles, at radii from microns to hundreds of kilometres. A turn more or less is no error.
fn worst_atan2(atan2: fn(f32, f32) -> f32) -> f64 {
    let errors = (0..1_000_000).map(|i| {
        let angle = (f64::from(i) / 5e5 - 1.0) * PI;
        let radius = 10f64.powi(i % 12 - 6);
        let (y, x) = ((radius * angle.sin()) as f32, (radius * angle.cos()) as f32);
        let error = (f64::from(atan2(y, x)) - f64::from(y).atan2(f64::from(x))).abs();
        error.min((TAU - error).abs())
    });
    errors.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_keeps_to_its_promises_and_micromath_errs_more() {
        let figures = errors().unwrap();
        assert_eq!(figures.len(), FUNCTIONS.len() * LIBRARIES.len());
        assert!(figures.iter().all(Figure::ok), "{figures:?}");
        let error = |name: &str| {
            figures
                .iter()
                .find(|figure| figure.name == name)
                .unwrap()
                .value
        };
        assert!(error("math.ln.micromath.error") > 1e3 * error("math.ln.error"));
    }

    #[test]
    fn a_table_has_a_row_for_each_function_and_library() {
        let mut figures = Vec::new();
        for (function, _) in FUNCTIONS {
            for Library { part, .. } in &LIBRARIES {
                let name = format!("math.{function}{part}");
                figures.push(Figure::new(format!("{name}.error"), 8e-7, ""));
                for what in ["instructions", "cycles_modelled"] {
                    figures.push(Figure::new(format!("m4f.{name}.{what}"), 25.33, ""));
                }
            }
        }
        let table = table(&figures).unwrap();
        assert_eq!(table.lines().count(), 2 + 15);
        assert!(
            table.contains("| `exp`, -10 to 0 | foxhunt | 25.3 | 25.3 | 8.0e-7 relative |"),
            "{table}"
        );
    }
}
