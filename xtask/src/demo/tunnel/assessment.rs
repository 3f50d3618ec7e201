//! How good the fixes are.

use std::{collections::BTreeMap, fmt};

use anyhow::{Context, Result};
use foxhunt::fingerprint::RadioMap;
use foxhunt_host::{
    packets::{Replay, Scene},
    picture::{Axis, Curve, Curves, Style, Walk, Walks},
};

use crate::reports::beacon::{Report, TagFix};

/// Seconds from one look at a tag to the next, beginning when it has been there for as long.
const STEP: f64 = 2.0;
/// The same in the pictures.
const FINE_STEP: f64 = 0.5;
/// An error that is small, in metres.
const NEAR: f64 = 2.0;

/// The fixes of every tag beside the truth.
pub struct Assessment {
    tags: BTreeMap<u32, Tag>,
    is_line: bool,
}

struct Tag {
    fixes: Vec<TagFix>,
    /// Distance from the truth every [`STEP`].
    errors: Vec<f64>,
    /// The same every [`FINE_STEP`], with the time.
    fine: Vec<(f64, f64)>,
}

impl Assessment {
    pub fn new(scene: &Scene, reports: &[Report]) -> Result<Self> {
        let lattice = *RadioMap::new(&scene.map)?.lattice();
        let mut tags = BTreeMap::new();
        for (tag, path) in &scene.recording.truth {
            let fixes = reports.iter().filter_map(|report| match report {
                Report::Fix(fix) if fix.tag == *tag => Some(fix.clone()),
                _ => None,
            });
            let fixes: Vec<TagFix> = fixes.collect();
            let [start, end] = path.times().context("a tag was nowhere")?;
            let errors = |step: f64| {
                let times = (1..).map(move |n| start + step * f64::from(n));
                let times = times.take_while(move |time| *time <= end);
                times.filter_map(|time| {
                    // What was known then.
                    let known = fixes.partition_point(|fix| fix.time <= time);
                    let [x, y] = fixes.get(known.checked_sub(1)?)?.place_at(time);
                    let truth = path.at(time)?;
                    Some((time, (x - truth[0]).hypot(y - truth[1])))
                })
            };
            let fine = errors(FINE_STEP).collect();
            let errors = errors(STEP).map(|(_, error)| error).collect();
            let tracked = Tag {
                fixes: fixes.clone(),
                errors,
                fine,
            };
            tags.insert(*tag, tracked);
        }
        Ok(Self {
            tags,
            is_line: lattice.rows() == 1,
        })
    }

    fn all(&self) -> Vec<f64> {
        let errors = self.tags.values().flat_map(|tag| &tag.errors);
        errors.copied().collect()
    }

    /// The picture of all walks.
    pub fn walks(&self, title: &str, scene: &Scene, replay: &Replay<'_>) -> Result<Walks> {
        let lattice = *RadioMap::new(&scene.map)?.lattice();
        let [low, high] =
            [0, lattice.points() - 1].map(|point| lattice.position(point).map(f64::from));
        let walks = self.tags.iter().map(|(number, tag)| Walk {
            name: format!("tag {number}"),
            truth: scene.recording.truth[number].corners().to_vec(),
            fixes: tag.fixes.iter().map(|fix| (fix.time, fix.place)).collect(),
            particles: replay.particles(*number),
        });
        Ok(Walks {
            title: title.to_owned(),
            caption: format!(
                "through the firmware on the emulated board, 300 particles a tag; {}",
                Summary::of(&self.all())
            ),
            map: [low, high],
            is_line: self.is_line,
            radios: scene.radios.clone(),
            walks: walks.collect(),
        })
    }

    /// The picture of the errors: over time, and how many are below which.
    pub fn errors(&self) -> Result<String> {
        let named = |points: &dyn Fn(&Tag) -> Vec<(f64, f64)>| {
            let curves = self.tags.iter().map(|(number, tag)| Curve {
                name: format!("tag {number}"),
                points: points(tag),
                ..Curve::default()
            });
            // The first colour is the truth's: a tag has the same one in both pictures.
            let truth = Curve::default();
            std::iter::once(truth).chain(curves).collect::<Vec<_>>()
        };
        let over_time = Curves {
            title: "distance from the true place".into(),
            horizontal: Axis::linear("seconds"),
            vertical: Axis::logarithmic("metres"),
            curves: named(&|tag| tag.fine.iter().map(|(t, e)| (*t, e.max(0.1))).collect()),
        };
        let mut distributions =
            named(&|tag| distribution(tag.fine.iter().map(|(_, error)| *error)));
        if self.tags.len() > 1 {
            let all = self.tags.values().flat_map(|tag| &tag.fine);
            distributions.push(Curve {
                name: "all".into(),
                points: distribution(all.map(|(_, error)| *error)),
                style: Style::DotsAndLine,
                ..Curve::default()
            });
        }
        let distribution = Curves {
            title: "fraction of the time that it is less".into(),
            horizontal: Axis::linear("metres"),
            vertical: Axis::linear("percent"),
            curves: distributions,
        };
        Curves::grid(&[over_time, distribution], 2)
    }
}

/// How many percent of the errors are below each of some distances.
fn distribution(errors: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
    let errors: Vec<f64> = errors.collect();
    let below = |most: f64| errors.iter().filter(|error| **error < most).count() as f64;
    let distances = (0..=40).map(|n| 0.25 * f64::from(n));
    distances
        .map(|distance| (distance, 100.0 * below(distance) / errors.len() as f64))
        .collect()
}

/// Errors in a few figures.
struct Summary {
    count: usize,
    near: f64,
    median: f64,
    ninety: f64,
    largest: f64,
}

impl Summary {
    fn of(errors: &[f64]) -> Self {
        let mut sorted = errors.to_vec();
        sorted.sort_by(f64::total_cmp);
        let at = |fraction: f64| {
            let place = (fraction * sorted.len() as f64) as usize;
            sorted
                .get(place.min(sorted.len().saturating_sub(1)))
                .copied()
        };
        let near = sorted.iter().filter(|error| **error < NEAR).count() as f64;
        Self {
            count: sorted.len(),
            near: 100.0 * near / sorted.len() as f64,
            median: at(0.5).unwrap_or(f64::NAN),
            ninety: at(0.9).unwrap_or(f64::NAN),
            largest: at(1.0).unwrap_or(f64::NAN),
        }
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:5.1} % within {NEAR} m, median {:.2} m, 90 % within {:5.2} m, largest {:5.2} m ({} steps)",
            self.near, self.median, self.ninety, self.largest, self.count
        )
    }
}

impl fmt::Display for Assessment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "distance from the true place, every {STEP} s")?;
        for (number, tag) in &self.tags {
            let offset = tag.fixes.last().map_or(0.0, |fix| fix.offset);
            let summary = Summary::of(&tag.errors);
            write!(f, "\n  tag {number:<4} {summary}, offset {offset:+.1} dB")?;
        }
        if self.tags.len() > 1 {
            write!(f, "\n  all      {}", Summary::of(&self.all()))?;
        }
        Ok(())
    }
}
