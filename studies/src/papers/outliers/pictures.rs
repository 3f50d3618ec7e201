//! One drive with many outliers: while hypotheses compete, and at its end.

use anyhow::Result;
use foxhunt::{
    aoa::{Locator, Robust, robust},
    estimate::Ellipse,
    random::{SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_host::{picture::Map, simulate, tracks::Track};
use foxhunt_simulation::{Sight, faults::Faults, random};

use crate::papers::study::Study;

/// Draws the pictures.
pub fn draw(study: &Study) -> Result<()> {
    let seed = study.seed;
    let track = Track::a2();
    let mut sights = simulate::bearings(&track, &mut random::generator(seed, 0));
    let faults = Faults {
        outlier_rate: 0.3,
        mirrored_rate: 0.1,
        bias_sigma: 0.0,
    };
    faults.spoil(&mut sights, &mut random::generator(!seed, 0));
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
    let mut locator = Box::new(Locator::<Robust<256>>::new(robust::Config::DEFAULT)?);
    let mut competing = false;
    for k in 1..=sights.len() {
        locator.push(&sights[k - 1].try_into()?, &mut rng)?;
        let last = k == sights.len();
        // Early on, when a few bearings cross here and there.
        let heavy = locator
            .hypotheses()
            .filter(|h| h.probability > 0.02)
            .count();
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

fn map(track: &Track, sights: &[Sight], locator: &Locator<Robust<256>>) -> Map {
    let fix = locator.fix();
    // As lines: a mirrored bearing says as much as a direct one.
    let off = |sight: &Sight, place: [f32; 2]| {
        let residual = sight.residual(place.map(f64::from)).abs();
        residual.min(std::f64::consts::PI - residual) / sight.sigma
    };
    let (kept, rejected) = sights
        .iter()
        .partition(|sight| fix.is_none_or(|fix| off(sight, fix.position) < 3.0));
    let [x, y, ..] = locator.state().columns();
    let rates = locator.rates();
    Map {
        title: format!("Track {}: {} bearings", track.name, sights.len()),
        caption: format!(
            "30 % of the bearings are outliers and 10 % mirrored, which it does not know; learned so far: {:.0} % and {:.0} %",
            100.0 * rates.map_or(0.0, |rates| rates.outlier),
            100.0 * rates.map_or(0.0, |rates| rates.mirrored),
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
            .filter(|h| h.probability > 1e-3)
            .map(|h| {
                (
                    Ellipse::of_normal(h.position, h.covariance, 0.95),
                    h.probability.into(),
                )
            })
            .collect(),
        ellipses: fix.iter().map(|fix| fix.ellipse(0.95)).collect(),
        truths: vec![track.source],
        ..Map::default()
    }
}
