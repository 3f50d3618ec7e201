//! What each function of [`foxhunt::math`] promises, as its documentation says.

/// How an error is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measure {
    /// In the unit of the result.
    Absolute,
    /// As a fraction of the exact result.
    Relative,
}

/// The largest error of a function over a range of its argument.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Name in [`foxhunt::math`].
    pub function: &'static str,
    /// Range of the argument; of the angle for `atan2`, at any radius.
    pub range: (f32, f32),
    /// Largest error within the range.
    pub error: f32,
    /// How `error` is measured.
    pub measure: Measure,
}

const fn entry(
    function: &'static str,
    range: (f32, f32),
    error: f32,
    measure: Measure,
) -> Accuracy {
    Accuracy {
        function,
        range,
        error,
        measure,
    }
}

/// The largest error of every function, over the range that filters use and over the whole range.
pub const ACCURACY: [Accuracy; 12] = {
    use Measure::{Absolute, Relative};
    const PI: f32 = core::f32::consts::PI;
    [
        entry("exp", (-10.0, 0.0), 8e-7, Relative),
        entry("exp", (-87.0, 88.0), 6e-6, Relative),
        entry("ln", (0.5, 2.0), 5e-7, Absolute),
        entry("ln", (1e-30, 1e30), 8e-6, Absolute),
        entry("sqrt", (0.0, 1e6), 6e-8, Relative),
        entry("atan2", (-PI, PI), 8e-7, Absolute),
        entry("sin", (-PI, PI), 1e-6, Absolute),
        entry("sin", (-1e3, 1e3), 1.5e-4, Absolute),
        entry("cos", (-PI, PI), 1e-6, Absolute),
        entry("cos", (-1e3, 1e3), 1.5e-4, Absolute),
        entry("wrap", (-PI, PI), 0.0, Absolute),
        entry("wrap", (-1e3, 1e3), 2e-7, Absolute),
    ]
};

#[cfg(test)]
mod tests {
    use super::*;
    use foxhunt::math;

    /// Function and exact function of one argument.
    #[allow(clippy::type_complexity, reason = "named, it would say less")]
    fn pair(name: &str) -> (fn(f32) -> f32, fn(f64) -> f64) {
        match name {
            "exp" => (math::exp, f64::exp),
            "ln" => (math::ln, f64::ln),
            "sqrt" => (math::sqrt, f64::sqrt),
            "sin" => (|x| math::sin_cos(x).0, f64::sin),
            "cos" => (|x| math::sin_cos(x).1, f64::cos),
            _ => unreachable!("{name} has no reference"),
        }
    }

    fn error(measure: Measure, got: f32, exact: f64) -> f64 {
        let absolute = (f64::from(got) - exact).abs();
        match measure {
            Measure::Absolute => absolute,
            Measure::Relative => absolute / exact.abs().max(f64::MIN_POSITIVE),
        }
    }

    /// A million arguments over a range: even steps, or even ratios where it spans decades.
    fn arguments((from, to): (f32, f32)) -> impl Iterator<Item = f32> {
        let (from, to) = (f64::from(from), f64::from(to));
        let geometric = from > 0.0 && to / from > 1e3;
        (0..=1_000_000).map(move |i| {
            let part = f64::from(i) / 1e6;
            (if geometric {
                from * (to / from).powf(part)
            } else {
                from + (to - from) * part
            }) as f32
        })
    }

    /// Radii from microns to hundreds of kilometres, and directions that meet no grid of the polynomial.
    fn worst_atan2() -> f64 {
        let mut worst = 0f64;
        for i in 0..1_000_000u32 {
            let angle = (f64::from(i) / 5e5 - 1.0) * core::f64::consts::PI;
            let radius = 10f64.powi(i as i32 % 12 - 6);
            let (y, x) = ((radius * angle.sin()) as f32, (radius * angle.cos()) as f32);
            let exact = f64::from(y).atan2(f64::from(x));
            worst = worst.max((f64::from(math::atan2(y, x)) - exact).abs());
        }
        worst
    }

    /// Against the representative of the angle that is nearest: half a turn has two.
    fn worst_wrap(range: (f32, f32)) -> f64 {
        let turns_off = |x: f32| (f64::from(math::wrap(x)) - f64::from(x)) / core::f64::consts::TAU;
        arguments(range)
            .map(|x| (turns_off(x) - turns_off(x).round()).abs() * core::f64::consts::TAU)
            .fold(0.0, f64::max)
    }

    #[test]
    fn errors_stay_within_the_table() {
        for Accuracy {
            function,
            range,
            error: limit,
            measure,
        } in ACCURACY
        {
            let worst = match function {
                "atan2" => worst_atan2(),
                "wrap" => worst_wrap(range),
                _ => {
                    let (ours, exact) = pair(function);
                    arguments(range)
                        .map(|x| error(measure, ours(x), exact(f64::from(x))))
                        .fold(0.0, f64::max)
                }
            };
            println!("{function:6} on {range:?}: worst {worst:.2e}, promised {limit:.1e}");
            assert!(
                worst <= f64::from(limit),
                "{function} on {range:?} errs by {worst:e}"
            );
            // A promise far above the truth would hide a loss of accuracy.
            assert!(
                worst >= 0.5 * f64::from(limit),
                "{function} on {range:?} only errs by {worst:e}"
            );
        }
    }

    #[test]
    fn the_documentation_says_the_same() {
        let documentation = include_str!("../../src/math/mod.rs");
        for entry in ACCURACY {
            let number = |x: f32| match x.abs() {
                std::f32::consts::PI => format!("{x:.0}").replace('3', "pi"),
                1e-30 | 1e30 => format!("{x:e}"),
                1e6 => "1e6".to_owned(),
                _ => x.to_string(),
            };
            let row = format!(
                "| `{}` | {} | {} | {} | {} |",
                entry.function,
                number(entry.range.0),
                number(entry.range.1),
                if entry.error > 0.0 {
                    format!("{:e}", entry.error)
                } else {
                    "0".to_owned()
                },
                format!("{:?}", entry.measure).to_lowercase(),
            );
            assert!(documentation.contains(&row), "{row}");
        }
    }
}
