//! Accuracy against what it costs: every method of the other studies beside the bootstrap filter with as many more
//! particles as the same number of calls of the model buys.

use anyhow::Result;
use comfy_table::{CellAlignment, Table, presets::ASCII_MARKDOWN};
use foxhunt::random::Xoshiro128PlusPlus;
use foxhunt_host::{
    picture::{Axis, Curve, Curves, Style, save},
    tracks::Track,
};

use super::{
    Study,
    bearings::{self, methods as on_bearings},
    evolution, firefly, fish, picture,
    scalar::{self, methods},
    statistics::Estimate,
};
use crate::figures::Figure;

/// What a method takes and gives.
struct Point {
    label: String,
    key: &'static str,
    /// Calls of the model per run.
    calls: f64,
    over_floor: Estimate,
}

/// One problem.
struct Panel {
    title: &'static str,
    key: &'static str,
    calls: &'static str,
    /// By rising number of particles.
    bootstrap: Vec<Point>,
    methods: Vec<Point>,
}

const BOOTSTRAP: &str = "bootstrap";

/// Runs all problems.
pub fn run(study: &Study) -> Result<()> {
    let panels = [
        on_track(study, Track::a2())?,
        growth(study)?,
        gamma(study, 1e-5, "Gamma noise, R = 1e-5", "gamma.precise")?,
        gamma(study, 1.0, "Gamma noise, R = 1", "gamma.noisy")?,
    ];
    let mut figures = Vec::new();
    for panel in &panels {
        figures.extend(panel.report());
    }
    let stem = picture("cost");
    save(
        &Curves::grid(&panels.each_ref().map(Panel::curves), 2)?,
        &stem,
    )?;
    println!("picture: {}\n", stem.with_extension("svg").display());
    study.conclude(&figures)
}

fn on_track(study: &Study, track: Track) -> Result<Panel> {
    use bearings::{Method, Outcome, Problem};
    let published = |run: fn(&Problem, &mut Xoshiro128PlusPlus) -> Result<Outcome>| {
        Method::new("", BOOTSTRAP, run)
    };
    let mut all = vec![
        published(on_bearings::published::<100>),
        published(on_bearings::published::<300>),
        published(on_bearings::published::<1000>),
        published(on_bearings::published::<3000>),
        published(on_bearings::published::<10_000>),
    ];
    all.extend(fish::methods(&track)?);
    let experiment = bearings::Experiment::run(track, all, study.runs.unwrap_or(300), study.seed)?;
    let points = experiment.methods.iter().map(|method| Point {
        label: method.label.clone(),
        key: method.key,
        calls: method.evaluations(),
        over_floor: experiment.over_floor(method),
    });
    Ok(Panel::new(
        "Bearings, track A2",
        "a2",
        "likelihoods of a bearing, per run",
        points,
    ))
}

fn growth(study: &Study) -> Result<Panel> {
    let mut all: Vec<firefly::Method> = vec![
        bootstrap(methods::bootstrap::<50, _, _>),
        bootstrap(methods::bootstrap::<150, _, _>),
        bootstrap(methods::bootstrap::<500, _, _>),
        bootstrap(methods::bootstrap::<1500, _, _>),
        bootstrap(methods::bootstrap::<5000, _, _>),
        bootstrap(methods::bootstrap::<15_000, _, _>),
    ];
    all.extend(firefly::growth_methods()?);
    let experiment = firefly::growth_experiment(study, all, 300)?;
    let points = points(&experiment);
    Ok(Panel::new(
        "Growth model",
        "growth",
        "calls of the model per run",
        points,
    ))
}

fn gamma(study: &Study, variance: f64, title: &'static str, key: &'static str) -> Result<Panel> {
    let mut all: Vec<evolution::Method> = vec![
        bootstrap(methods::bootstrap::<10, _, _>),
        bootstrap(methods::bootstrap::<50, _, _>),
        bootstrap(methods::bootstrap::<250, _, _>),
        bootstrap(methods::bootstrap::<1250, _, _>),
        bootstrap(methods::bootstrap::<6250, _, _>),
        bootstrap(methods::bootstrap::<20_000, _, _>),
    ];
    all.extend(evolution::methods()?);
    let experiment = evolution::experiment(study, 0.04, variance, all, 300)?;
    let points = points(&experiment);
    Ok(Panel::new(title, key, "calls of the model per run", points))
}

fn bootstrap<P: 'static>(
    run: fn(&P, &mut Xoshiro128PlusPlus) -> scalar::Estimates,
) -> scalar::Method<P> {
    scalar::Method::new("", BOOTSTRAP, run)
}

fn points(experiment: &scalar::Experiment) -> impl Iterator<Item = Point> {
    experiment.methods.iter().map(|method| Point {
        label: method.label.clone(),
        key: method.key,
        calls: method.calls(),
        over_floor: experiment.pooled_over_floor(method),
    })
}

impl Panel {
    /// Sorts the points; what costs nothing that can be counted is left out, and the same filter a second time.
    fn new(
        title: &'static str,
        key: &'static str,
        calls: &'static str,
        points: impl Iterator<Item = Point>,
    ) -> Self {
        let (bootstrap, others): (Vec<Point>, Vec<Point>) = points
            .filter(|point| point.calls > 0.0)
            .partition(|point| point.label.is_empty());
        let methods = others
            .into_iter()
            .filter(|point| !PLAIN.contains(&point.key))
            .collect();
        Self {
            title,
            key,
            calls,
            bootstrap,
            methods,
        }
    }

    /// What the bootstrap filter reaches for as many calls: on a straight line between its measured points, in
    /// logarithms. Beyond the last of them it is said to be there.
    fn bootstrap_at(&self, calls: f64) -> Estimate {
        let before = |pair: &&[Point]| pair[1].calls >= calls;
        let last = &self.bootstrap[self.bootstrap.len() - 1];
        let Some([a, b]) = self.bootstrap.windows(2).find(before) else {
            return last.over_floor;
        };
        let share = ((calls / a.calls).ln() / (b.calls / a.calls).ln()).max(0.0);
        let (a, b) = (a.over_floor, b.over_floor);
        Estimate {
            value: a.value * (b.value / a.value).powf(share),
            error: a.error.max(b.error),
        }
    }

    fn report(&self) -> Vec<Figure> {
        println!("{}", self.title);
        let mut table = Table::new();
        table.load_style(ASCII_MARKDOWN).set_header([
            "method",
            self.calls,
            "RMSE / floor",
            "bootstrap filter for as many",
            "verdict",
        ]);
        for column in table.column_iter_mut().skip(1) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        let mut figures = Vec::new();
        for point in &self.methods {
            let plain = self.bootstrap_at(point.calls);
            let Estimate { value, error } = point.over_floor;
            let off = (value - plain.value) / error.hypot(plain.error);
            let verdict = if off > 3.0 {
                "loses"
            } else if off < -3.0 {
                "wins"
            } else {
                "even"
            };
            table.add_row([
                point.label.clone(),
                format!("{:.0}", point.calls),
                point.over_floor.to_string(),
                plain.to_string(),
                verdict.into(),
            ]);
            let figure = |what: &str, value, unit| {
                let name = format!("papers.cost.{}.{}.{what}", self.key, point.key);
                Figure::new(name, value, unit)
            };
            figures.extend([
                figure("calls", point.calls, "per run"),
                figure("rmse_over_floor", value, ""),
                figure("rmse_over_floor_error", error, ""),
                figure("bootstrap_for_as_many", plain.value, ""),
            ]);
        }
        println!("{table}\n");
        figures
    }

    fn curves(&self) -> Curves {
        let curve = |name: &str, points: &[Point], style| Curve {
            name: name.into(),
            points: points
                .iter()
                .map(|p| (p.calls, p.over_floor.value))
                .collect(),
            errors: points.iter().map(|p| p.over_floor.error).collect(),
            style,
        };
        let methods = self
            .methods
            .iter()
            .filter(|point| point.over_floor.value < 10.0 * self.bootstrap[0].over_floor.value)
            .map(|point| curve(&point.label, std::slice::from_ref(point), Style::Dots));
        let bootstrap = curve(
            "bootstrap filter, more and more particles",
            &self.bootstrap,
            Style::DotsAndLine,
        );
        let curves: Vec<Curve> = std::iter::once(bootstrap).chain(methods).collect();
        let highest = curves
            .iter()
            .flat_map(|curve| &curve.points)
            .fold(1.0, |highest, (_, ratio)| ratio.max(highest));
        Curves {
            title: self.title.into(),
            horizontal: Axis::logarithmic(self.calls),
            vertical: Axis {
                name: "RMSE / floor".into(),
                logarithmic: highest > 5.0,
            },
            curves,
        }
    }
}

/// The bootstrap filter in the other studies.
const PLAIN: [&str; 6] = [
    BOOTSTRAP,
    "bootstrap.n1000",
    "published",
    "pf",
    "pf.n200",
    "fish.literal",
];
