//! Accuracy against what it costs: every method of the other studies beside the bootstrap filter with as many more
//! particles as the same instructions of a Cortex-M4F buy. The emulated board has memory for 20,000 of them.

use anyhow::Result;
use foxhunt_host::{
    figures::Figure,
    picture::{Axis, Curve, Curves, Style},
    tracks::Track,
};

use super::{
    bearings, evolution, firefly, fish, instructions::short, scalar, statistics::Estimate,
    study::Study, table::table,
};
use crate::methods::{self, bearings::PUBLISHED, scalar as keys};

/// What a method takes and gives.
struct Point {
    label: &'static str,
    key: &'static str,
    /// Instructions, and calls of the model, of a run.
    instructions: f64,
    calls: f64,
    over_floor: Estimate,
}

/// One problem.
struct Panel {
    title: &'static str,
    key: &'static str,
    /// By rising number of particles.
    bootstrap: Vec<Point>,
    methods: Vec<Point>,
}

/// Runs all problems.
pub fn run(study: &Study) -> Result<Vec<Figure>> {
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
    let picture = Curves::grid(&panels.each_ref().map(Panel::curves), 2)?;
    study.save(&picture, "cost")?;
    println!();
    Ok(figures)
}

fn on_track(study: &Study, track: Track) -> Result<Panel> {
    let mut all = bearings::methods_of(study, "ladder:a2", methods::bearings::ladder)?;
    let rungs = all.len();
    all.extend(fish::methods(study, &track)?);
    let experiment = bearings::Experiment::run(track, &all, study.runs.unwrap_or(300), study.seed)?;
    let points = experiment.methods.iter().map(|method| Point {
        label: method.label,
        key: method.key,
        instructions: method.instructions,
        calls: method.evaluations(),
        over_floor: experiment.over_floor(method),
    });
    Ok(Panel::new("Bearings, track A2", "a2", rungs, points))
}

fn growth(study: &Study) -> Result<Panel> {
    let mut all: Vec<firefly::Method> = scalar::methods_of(study, "ladder:growth", keys::ladder)?;
    let rungs = all.len();
    all.extend(firefly::growth_methods(study)?);
    let experiment = firefly::growth_experiment(study, all, 300)?;
    Ok(Panel::new(
        "Growth model",
        "growth",
        rungs,
        points(&experiment),
    ))
}

fn gamma(study: &Study, variance: f64, title: &'static str, key: &'static str) -> Result<Panel> {
    const OMEGA: f64 = 0.04;
    let ladder = format!("ladder:gamma:{OMEGA}:{variance:e}");
    let mut all: Vec<evolution::Method> = scalar::methods_of(study, &ladder, keys::ladder)?;
    let rungs = all.len();
    all.extend(evolution::methods(study, OMEGA, variance)?);
    let experiment = evolution::experiment(study, OMEGA, variance, all, 300)?;
    Ok(Panel::new(title, key, rungs, points(&experiment)))
}

fn points(experiment: &scalar::Experiment) -> impl Iterator<Item = Point> {
    experiment.methods.iter().map(|method| Point {
        label: method.label,
        key: method.key,
        instructions: method.instructions,
        calls: method.calls(),
        over_floor: experiment.pooled_over_floor(method),
    })
}

impl Panel {
    /// Takes the bootstrap filters first, `rungs` of them; leaves them out where they come a second time, and the
    /// floor.
    fn new(
        title: &'static str,
        key: &'static str,
        rungs: usize,
        mut points: impl Iterator<Item = Point>,
    ) -> Self {
        Self {
            title,
            key,
            bootstrap: points.by_ref().take(rungs).collect(),
            methods: points
                .filter(|point| point.instructions > 0.0 && !PLAIN.contains(&point.key))
                .collect(),
        }
    }

    /// What the bootstrap filter reaches for as many instructions: on a straight line between its measured points, in
    /// logarithms. Beyond them it is said to be where the next of them is.
    fn bootstrap_at(&self, instructions: f64) -> Estimate {
        let before = |pair: &&[Point]| pair[1].instructions >= instructions;
        let last = &self.bootstrap[self.bootstrap.len() - 1];
        let Some([a, b]) = self.bootstrap.windows(2).find(before) else {
            return last.over_floor;
        };
        let way = (instructions / a.instructions).ln() / (b.instructions / a.instructions).ln();
        let way = way.max(0.0);
        let (a, b) = (a.over_floor, b.over_floor);
        Estimate {
            value: a.value * (b.value / a.value).powf(way),
            error: a.error + way * (b.error - a.error),
        }
    }

    fn report(&self) -> Vec<Figure> {
        println!("{}", self.title);
        let header = [
            "method",
            "M4F instructions",
            "calls of the model",
            "RMSE / floor",
            "bootstrap filter for as many instructions",
            "verdict",
        ];
        let mut table = table(header, 1);
        for rung in &self.bootstrap {
            table.add_row([
                format!("bootstrap filter, {}", rung.label),
                short(rung.instructions),
                short(rung.calls),
                rung.over_floor.to_string(),
            ]);
        }
        let mut figures = Vec::new();
        for point in &self.methods {
            let plain = self.bootstrap_at(point.instructions);
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
                point.label.into(),
                short(point.instructions),
                short(point.calls),
                point.over_floor.to_string(),
                plain.to_string(),
                verdict.into(),
            ]);
            let figure = |what: &str, value, unit| {
                let name = format!("papers.cost.{}.{}.{what}", self.key, point.key);
                Figure::new(name, value, unit)
            };
            figures.extend([
                figure("instructions", point.instructions, "per run"),
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
                .map(|p| (p.instructions, p.over_floor.value))
                .collect(),
            errors: points.iter().map(|p| p.over_floor.error).collect(),
            style,
        };
        let methods = self
            .methods
            .iter()
            .filter(|point| point.over_floor.value < 10.0 * self.bootstrap[0].over_floor.value)
            .map(|point| curve(point.label, std::slice::from_ref(point), Style::Dots));
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
            horizontal: Axis::logarithmic("instructions of a Cortex-M4F, per run"),
            vertical: Axis {
                name: "RMSE / floor".into(),
                logarithmic: highest > 5.0,
            },
            curves,
        }
    }
}

/// The bootstrap filter in the other studies, and what is there for show.
const PLAIN: [&str; 6] = [
    keys::BOOTSTRAP,
    keys::BOOTSTRAP_1000,
    keys::PF,
    keys::PF_200,
    PUBLISHED,
    methods::bearings::FISH_LITERAL,
];
