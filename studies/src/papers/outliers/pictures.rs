//! One drive with many outliers: while hypotheses compete, and at its end.

use anyhow::Result;
use foxhunt::{
    aoa::{
        locator::Answer,
        robust::{RobustLocator, Settings},
    },
    estimate::Ellipse,
    random::{SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_host::{Sight, faults::Faults, picture::Map, simulate, tracks::Track};

use crate::papers::study::Study;

/// Draws the pictures.
pub fn draw(study: &Study) -> Result<()> {
    let seed = study.seed;
    let track = Track::a2();
    let mut sights = simulate::bearings(&track, &mut simulate::generator(seed, 0));
    let faults = Faults {
        outlier_rate: 0.3,
        mirrored_rate: 0.1,
        bias_sigma: 0.0,
    };
    faults.spoil(&mut sights, &mut simulate::generator(!seed, 0));
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
    let mut locator = Box::new(RobustLocator::<256, 64>::new(Settings::default()));
    let mut competing = false;
    for k in 1..=sights.len() {
        locator.push(sights[k - 1].try_into()?, &mut rng);
        let last = k == sights.len();
        // Early on, when a few bearings cross here and there.
        let heavy = locator.hypotheses().filter(|h| h.mass > 0.02).count();
        let compete = k > 5 && heavy > 1 && !competing;
        if last || compete {
            competing = true;
            let name = if last { "end" } else { "hypotheses" };
            let picture = map(&track, &sights[..k], &locator).svg()?;
            study.save(&picture, &format!("bearings-{name}"))?;
        }
    }
    println!();
    Ok(())
}

fn map(track: &Track, sights: &[Sight], locator: &RobustLocator<256, 64>) -> Map {
    let fix = match locator.answer() {
        Answer::Fix(fix) => Some(fix),
        Answer::NotObservable(_) => None,
    };
    // As lines: a mirrored bearing says as much as a direct one.
    let off = |sight: &Sight, place: [f32; 2]| {
        let residual = sight.residual(place.map(f64::from)).abs();
        residual.min(std::f64::consts::PI - residual) / sight.sigma
    };
    let (kept, rejected) = sights
        .iter()
        .partition(|sight| fix.is_none_or(|fix| off(sight, fix.position) < 3.0));
    let [x, y, _] = locator.columns();
    let rates = locator.shares();
    Map {
        title: format!("Track {}: {} bearings", track.name, sights.len()),
        caption: format!(
            "30 % of the bearings are outliers and 10 % mirrored, which it does not know; learned so far: {:.0} % and {:.0} %",
            100.0 * rates.wild,
            100.0 * rates.mirror,
        ),
        sights: kept,
        rejected,
        track: track.receivers[..sights.len()].to_vec(),
        particles: (x.iter().zip(y))
            .filter(|_| fix.is_some())
            .map(|(x, y)| [f64::from(*x), f64::from(*y)])
            .collect(),
        hypotheses: locator
            .hypotheses()
            .filter(|h| h.mass > 1e-3)
            .map(|h| {
                (
                    Ellipse::of_normal(h.position, h.covariance, 0.95),
                    h.mass.into(),
                )
            })
            .collect(),
        ellipses: fix.iter().map(|fix| fix.ellipse(0.95)).collect(),
        truths: vec![track.source],
        ..Map::default()
    }
}
