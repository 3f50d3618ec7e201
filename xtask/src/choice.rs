//! How many particles: what they cost, and how near the exact answer they come.

use std::path::Path;

use anyhow::{Context, Result};
use foxhunt::{
    aoa::{Clean, Locator, clean},
    random::{SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_host::{
    figures::Figure,
    reference::{Posterior, mahalanobis},
    simulate,
    tracks::Track,
};
use foxhunt_simulation::random;
use rayon::prelude::*;

use crate::marks;

/// Runs on each of the published tracks.
const RUNS: u64 = 400;
const SEED: u64 = 12;

/// Clocks of the table, in MHz.
const CLOCKS: [f64; 3] = [64.0, 84.0, 150.0];

/// By how many sigmas of the exact posterior the locator's mean differs from that one's, with each number of particles.
pub fn distances() -> Result<Vec<Figure>> {
    Ok(vec![
        distance::<25>()?,
        distance::<50>()?,
        distance::<100>()?,
        distance::<200>()?,
        distance::<400>()?,
        distance::<800>()?,
        distance::<1600>()?,
    ])
}

fn distance<const N: usize>() -> Result<Figure> {
    let tracks = [Track::a1(), Track::a2()];
    let runs = tracks
        .iter()
        .flat_map(|track| (0..RUNS).map(move |run| (track, run)));
    let runs: Vec<(&Track, u64)> = runs.collect();
    let squares = runs.par_iter().map(|(track, run)| square::<N>(track, *run));
    let squares: Vec<f64> = squares.collect::<Result<_>>()?;
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    Ok(Figure::new(
        format!("choice.n{N}.distance"),
        mean.sqrt(),
        "sigma",
    ))
}

/// The squared distance at the end of a run.
fn square<const N: usize>(track: &Track, run: u64) -> Result<f64> {
    let sights = simulate::bearings(track, &mut random::generator(SEED, run));
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(run);
    let mut locator = Box::new(Locator::<Clean<N>>::new(clean::Config::DEFAULT)?);
    for sight in &sights {
        locator.push(&(*sight).try_into()?, &mut rng)?;
    }
    let fix = locator.fix().context("no fix at the end of a track")?;
    let posterior = Posterior::new(&sights).context("a track locates its source")?;
    let apart = [0, 1].map(|axis| f64::from(fix.position[axis]) - posterior.mean[axis]);
    Ok(mahalanobis(apart, &posterior.covariance).powi(2))
}

/// Writes the table of these figures into a page of the guide.
pub fn write(figures: &[Figure], page: &Path) -> Result<()> {
    marks::write(page, "vehicle", &vehicle(figures)?)?;
    marks::write(page, "tags", &tags(figures)?)
}

fn vehicle(figures: &[Figure]) -> Result<String> {
    let mut table = String::from(
        "| particles | bytes | instructions, mean | at worst | bearings a second at 64, 84, 150 MHz | worst at 64 MHz | sigmas from the exact mean |\n\
         |--:|--:|--:|--:|--:|--:|--:|\n",
    );
    let pace = pace(figures)?;
    for particles in [25, 50, 100, 200, 400, 800, 1600] {
        let value = |what: &str| value(figures, &format!("choice.n{particles}.{what}"));
        let (mean, worst) = (value("mean.instructions")?, value("worst.instructions")?);
        let rates = CLOCKS.map(|clock| format!("{:.0}", clock * 1e6 / (mean * pace)));
        table += &format!(
            "| {particles} | {:.0} | {mean:.0} | {worst:.0} | {} | {:.0} ms | {:.2} |\n",
            value("bytes")?,
            rates.join(", "),
            worst * pace / 64e3,
            value("distance")?,
        );
    }
    Ok(table)
}

fn tags(figures: &[Figure]) -> Result<String> {
    let mut table = String::from(
        "| particles of a tag | bytes | instructions, mean | tags at 64, 84, 150 MHz |\n\
         |--:|--:|--:|--:|\n",
    );
    let pace = pace(figures)?;
    for particles in [50, 100, 200, 300, 600] {
        let value = |what: &str| value(figures, &format!("choice.tag.n{particles}.{what}"));
        let mean = value("mean.instructions")?;
        // Two updates a second each.
        let tags = CLOCKS.map(|clock| format!("{:.0}", clock * 1e6 / (2.0 * mean * pace)));
        table += &format!(
            "| {particles} | {:.0} | {mean:.0} | {} |\n",
            value("bytes")?,
            tags.join(", "),
        );
    }
    Ok(table)
}

/// Cycles for an instruction, as those of a locator take them.
fn pace(figures: &[Figure]) -> Result<f64> {
    let value = |what: &str| value(figures, &format!("m4f.robust.n64.update.{what}"));
    Ok(value("cycles_modelled")? / value("instructions")?)
}

fn value(figures: &[Figure], name: &str) -> Result<f64> {
    let figure = figures.iter().find(|figure| figure.name == name);
    let figure = figure.with_context(|| format!("no {name} was measured"));
    figure.map(|figure| figure.value)
}
