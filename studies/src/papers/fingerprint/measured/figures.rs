//! What came of the measured walks, in figures.

use foxhunt_host::figures::Figure;
use foxhunt_simulation::random::generator;
use rand::seq::index;

use super::{both::Both, tracked::Tracked};
use crate::papers::{
    fingerprint::{coverage::Coverage, errors::Errors},
    statistics::median,
};

/// Steps of two seconds before the tenth.
const EARLY: usize = 4;

/// The errors of all methods.
pub struct Results {
    /// What the radio map errs by where a place of the survey is left out.
    pub left_out_db: f64,
    pub tracked: Tracked,
    /// The tracker without the receiver whose loss is worst.
    pub dead: Both,
    /// The match alone, and the published filter after it: as printed, and fitted to these walks.
    pub matched: Both,
    pub printed: Both,
    pub fitted: Both,
    /// For every set of four receivers, the fraction of the steps of the straight walks below 2 m.
    pub sets: Vec<f64>,
}

impl Results {
    /// The fraction of the sets with which 85 % of the steps are below 2 m.
    pub fn good_sets(&self) -> f64 {
        let good = self.sets.iter().filter(|near| **near >= 0.85).count();
        good as f64 / self.sets.len() as f64
    }

    /// The fraction of the steps below 2 m with the set in the middle.
    pub fn median_set(&self) -> f64 {
        median(self.sets.iter().copied())
    }

    /// From where to where that is of so many sets that are drawn at random, with a probability of 95 %.
    pub fn median_of(&self, count: usize) -> [f64; 2] {
        const DRAWS: usize = 1000;
        let mut rng = generator(495, 0);
        let mut medians: Vec<f64> = (0..DRAWS)
            .map(|_| {
                let drawn = index::sample(&mut rng, self.sets.len(), count);
                median(drawn.into_iter().map(|number| self.sets[number]))
            })
            .collect();
        medians.sort_by(f64::total_cmp);
        [medians[DRAWS / 40], medians[DRAWS - 1 - DRAWS / 40]]
    }

    /// All figures.
    pub fn figures(&self) -> Vec<Figure> {
        let mut figures = vec![figure("map.left_out", self.left_out_db, "dB")];
        figures.extend(self.straight());
        figures.extend(self.plane());
        figures.extend(self.changed());
        figures.extend(self.loud());
        figures.extend(self.held());
        figures
    }

    /// By how much a tag that is 10 dB too strong raises what nine tenths of the errors are at most from the tenth second on:
    /// along corridors, and in the plane.
    pub fn loud_late(&self) -> [f64; 2] {
        let Tracked { all, louder, .. } = &self.tracked;
        [
            (&louder.straight, &all.straight),
            (&louder.plane, &all.plane),
        ]
        .map(|(loud, all)| p90_ratio(&loud.after(EARLY), &all.after(EARLY)))
    }

    fn loud(&self) -> [Figure; 2] {
        let [straight, plane] = self.loud_late();
        [("straight", straight), ("plane", plane)].map(|(kind, ratio)| {
            figure(
                &format!("{kind}.10_db_too_strong.p90_ratio_from_10_s"),
                ratio,
                "",
            )
            .at_most(1.10)
        })
    }

    /// What the regions of all walks hold, and how far below 80 % those of the worst walk are.
    fn held(&self) -> [Figure; 2] {
        let walks = self.tracked.held.iter().map(Coverage::value);
        let least = walks.fold(f64::INFINITY, f64::min);
        let off = Coverage::pooled(&self.tracked.held).off(0.95);
        [
            figure("coverage_off_95", off, "of steps").at_most(0.0),
            figure("worst_walk_below_80", (0.8 - least).max(0.0), "of steps").at_most(0.0),
        ]
    }

    /// The walks along corridors.
    fn straight(&self) -> [Figure; 8] {
        let all = &self.tracked.all.straight;
        let figure = |name: &str, value, unit| figure(&format!("straight.{name}"), value, unit);
        let beyond = |name: &str, errors: &Errors| {
            let beyond = 1.0 - errors.near().value;
            figure(&format!("{name}.beyond_2_m"), beyond, "of steps")
        };
        let median_set = 1.0 - self.median_set();
        [
            beyond("12_receivers", all).at_most(0.03),
            figure("12_receivers.p90", all.quantile(0.9), "m"),
            beyond("4_receivers", &self.tracked.four.straight).at_most(0.15),
            figure("4_receivers.median_set_beyond_2_m", median_set, "of steps").at_most(0.22),
            figure(
                "4_receivers.sets_that_miss",
                1.0 - self.good_sets(),
                "of sets",
            ),
            beyond("match", &self.matched.straight),
            beyond("two_stage_printed", &self.printed.straight),
            beyond("two_stage_fitted", &self.fitted.straight),
        ]
    }

    /// The walks in the plane.
    fn plane(&self) -> [Figure; 7] {
        let p90 = |name: &str, both: &Both| {
            figure(&format!("plane.{name}.p90"), both.plane.quantile(0.9), "m")
        };
        let [ours, matched] = [&self.tracked.all.plane, &self.matched.plane];
        let beside = |name: &str, of: &dyn Fn(&Errors) -> f64| {
            figure(
                &format!("plane.{name}_over_match"),
                of(ours) / of(matched),
                "",
            )
            .at_most(1.0)
        };
        [
            beside("median", &|errors| errors.quantile(0.5)),
            beside("p90", &|errors| errors.quantile(0.9)),
            beside("beyond_2_m", &|errors| 1.0 - errors.near().value),
            p90("12_receivers", &self.tracked.all).at_most(2.9),
            p90("match", &self.matched),
            p90("two_stage_printed", &self.printed),
            p90("two_stage_fitted", &self.fitted),
        ]
    }

    /// What changed packets do to the tracker.
    fn changed(&self) -> [Figure; 8] {
        let Tracked {
            all,
            louder,
            quieter,
            outliers,
            ..
        } = &self.tracked;
        let ratio = |name: &str, changed: &Errors, clean: &Errors| {
            figure(&format!("{name}.p90_ratio"), p90_ratio(changed, clean), "")
        };
        let plane =
            |name: &str, both: &Both| ratio(&format!("plane.{name}"), &both.plane, &all.plane);
        let straight = |name: &str, both: &Both| {
            ratio(&format!("straight.{name}"), &both.straight, &all.straight)
        };
        let beyond = 1.0 - louder.straight.near().value;
        [
            plane("10_db_too_strong", louder).at_most(1.10),
            plane("10_db_too_weak", quieter),
            straight("10_db_too_strong", louder),
            figure("straight.10_db_too_strong.beyond_2_m", beyond, "of steps"),
            plane("5_percent_outliers", outliers).at_most(1.15),
            straight("5_percent_outliers", outliers).at_most(1.15),
            plane("one_dead", &self.dead).at_most(1.20),
            straight("one_dead", &self.dead).at_most(1.20),
        ]
    }
}

fn p90_ratio(changed: &Errors, clean: &Errors) -> f64 {
    changed.quantile(0.9) / clean.quantile(0.9)
}

fn figure(name: &str, value: f64, unit: &str) -> Figure {
    Figure::new(format!("papers.fingerprint.measured.{name}"), value, unit)
}
