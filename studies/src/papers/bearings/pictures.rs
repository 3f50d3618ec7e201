//! Pictures of an experiment.

use foxhunt_host::picture::{Axis, Curve, Curves, Style};

use super::{experiment::Experiment, outcomes::Outcomes};
use crate::papers::statistics::Estimate;

impl Experiment {
    /// The RMSE of the named methods after each bearing.
    pub fn errors_picture(&self, keys: &[&str]) -> Curves {
        let bound = Curve {
            name: "Cramer-Rao bound".into(),
            points: self
                .bounds
                .iter()
                .enumerate()
                .filter_map(|(n, bound)| Some(((n + 1) as f64, (*bound)?)))
                .filter(|(_, bound)| *bound < 1000.0)
                .collect(),
            ..Curve::default()
        };
        Curves {
            title: format!(
                "Track {}: error after each bearing, {} runs",
                self.track.name,
                self.runs()
            ),
            horizontal: Axis::linear("bearings"),
            vertical: Axis::logarithmic("root mean square error, m"),
            curves: std::iter::once(bound)
                .chain(self.named(keys).filter_map(Outcomes::curve))
                .collect(),
        }
    }

    /// Where the named methods thought the source to be after each bearing of the first run, once they were near.
    pub fn run_picture(&self, keys: &[&str]) -> Curves {
        let [x, y] = self.track.source;
        let near = 12.0 * self.bound();
        let paths = self.named(keys).map(|method| Curve {
            name: method.label.into(),
            points: method.runs[0]
                .path
                .iter()
                .flatten()
                .filter(|[dx, dy]| dx.hypot(*dy) < near)
                .map(|[dx, dy]| (x + dx, y + dy))
                .collect(),
            style: Style::DotsAndLine,
            ..Curve::default()
        });
        let truth = Curve {
            name: "source".into(),
            points: vec![(x, y)],
            style: Style::Dots,
            ..Curve::default()
        };
        Curves {
            title: format!(
                "Track {}: estimates within {near:.0} m in one run",
                self.track.name
            ),
            horizontal: Axis::linear("metres east"),
            vertical: Axis::linear("metres north"),
            curves: std::iter::once(truth).chain(paths).collect(),
        }
    }

    fn named(&self, keys: &[&str]) -> impl Iterator<Item = &Outcomes> {
        self.methods
            .iter()
            .filter(|method| keys.contains(&method.key))
    }
}

impl Outcomes {
    /// RMSE after each bearing, from where nearly all runs have an estimate; `None` if the method has one at the
    /// end only.
    fn curve(&self) -> Option<Curve> {
        let steps = self.runs[0].path.len();
        let (points, errors): (Vec<_>, Vec<_>) = (0..steps)
            .filter_map(|step| {
                let squares: Vec<f64> = self
                    .runs
                    .iter()
                    .filter_map(|outcome| outcome.path[step])
                    .map(|[x, y]| x * x + y * y)
                    .collect();
                let known = squares.len() as f64 >= 0.99 * self.runs.len() as f64;
                known.then(|| {
                    let rmse = Estimate::root_of_mean(&squares);
                    (((step + 1) as f64, rmse.value), rmse.error)
                })
            })
            .unzip();
        (!points.is_empty()).then(|| Curve {
            name: self.label.into(),
            points,
            errors,
            style: Style::Line,
        })
    }
}
