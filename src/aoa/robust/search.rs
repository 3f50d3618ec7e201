//! Finds the modes of the posterior, afresh from where random pairs of bearings cross.

use heapless::Vec;

use super::config::Config;
use super::density::Density;
use super::evidence::{Evidence, Terms};
use super::mode::{MODES, Mode, Modes, weigh};
use super::term::{State, Term};
use crate::aoa::core::{BLOCK, Entry, Target};
use crate::aoa::triangulation::random_crossing;
use crate::math::sqrt;
use crate::random::Rng;

/// How many times as large the sigmas are while candidates are compared, because crossings scatter much more widely than
/// the posterior: less misses modes, more makes all candidates equal.
const WIDENING: f32 = 3.0;
/// Blocks of crossings: more find the source among more outliers, for `16 B` likelihoods each.
const BLOCKS: usize = 4;
const CANDIDATES: usize = BLOCKS * BLOCK;
/// Pairs that are tried for each crossing: more lose fewer crossings while most bearings are parallel, for time.
const TRIES: u32 = 8;
/// Least sine of the angle of two bearings that are crossed: less crosses ever more parallel ones, far away.
const LEAST_SINE: f32 = 0.02;
/// Candidates that are climbed from: more find more hypotheses at once, for time.
const CLIMBS: u32 = 3;
/// Steps of a climb by the widened bearings: enough to come near a mode, which the next climb reaches.
const ROUGH: u32 = 4;
/// Steps of a climb by the bearings themselves: most take fewer, slow ones end early.
const FINE: u32 = 12;
/// Steps of a climb from a known mode, which one more bearing moves little.
const AGAIN: u32 = 8;
/// Squared sigmas of a mode within which a candidate is not a new one: less climbs to the same mode again, more misses a
/// second one nearby.
const NEAR: f32 = 100.0;
/// Squared sigmas within which two modes are one: less keeps one mode twice, more loses one of two.
const SAME: f32 = 4.0;

/// A place to climb from, and what the widened bearings say of it.
#[derive(Clone, Copy)]
struct Candidate {
    state: State,
    score: f32,
}

/// The modes of all bearings, from those `known` before and from random crossings.
#[inline(never)]
pub(super) fn search<R: Rng + ?Sized, const B: usize>(
    evidence: &Evidence<B>,
    terms: &[Term],
    config: &Config,
    known: &Modes,
    rng: &mut R,
) -> Modes {
    let errors = &config.errors;
    let density = evidence.density(terms, config);
    let mut modes = climb_again(&density, known);
    let bias = errors.bias_sigma_rad;
    let mut wide = Terms::<B>::new();
    for entry in evidence.entries() {
        let sigma = WIDENING * sqrt(evidence.variance(entry, errors));
        let term = Term::new(&entry.observation, errors, sigma * sigma + bias * bias);
        let _ = wide.push(term.with_probability(entry.probability));
    }
    let wide = Density {
        terms: &wide,
        bias_sigma_rad: 0.0,
        ..density
    };
    let mut candidates = candidates(evidence.entries(), &wide, rng);
    for _ in 0..CLIMBS {
        let Some(start) = take_best(&mut candidates, &modes, &wide) else {
            break;
        };
        if let Some(rough) = Mode::climb(&wide, start, ROUGH)
            && let Some(mode) = Mode::climb(&density, rough.mean, FINE)
        {
            add(&mut modes, mode);
        }
    }
    weigh(&mut modes);
    modes
}

/// Where the modes of other bearings are by these.
pub(super) fn climb_again(density: &Density<'_>, known: &Modes) -> Modes {
    let mut modes = Modes::new();
    for mode in known {
        if let Some(mode) = Mode::climb(density, mode.mean, AGAIN) {
            add(&mut modes, mode);
        }
    }
    modes
}

/// Random crossings of the bearings as lines, for each of a pair may be mirrored.
fn candidates<R: Rng + ?Sized>(
    entries: &[Entry],
    wide: &Density<'_>,
    rng: &mut R,
) -> Vec<Candidate, CANDIDATES> {
    let mut candidates = Vec::new();
    for _ in 0..BLOCKS {
        let mut block = [[0.0; BLOCK]; 3];
        let mut valid = [false; BLOCK];
        let [xs, ys, _] = &mut block;
        for ((x, y), valid) in xs.iter_mut().zip(ys).zip(&mut valid) {
            let fits = |a: &Entry, b: &Entry, _: &_| !a.excludes(b);
            if let Some(place) = random_crossing(entries, LEAST_SINE, TRIES, rng, fits) {
                ([*x, *y], *valid) = (place, true);
            }
        }
        let scores = wide.log_densities(&block);
        let [xs, ys, _] = block;
        for (((x, y), score), valid) in xs.into_iter().zip(ys).zip(scores).zip(valid) {
            if valid {
                let state = [x, y, 0.0];
                let _ = candidates.push(Candidate { state, score });
            }
        }
    }
    candidates
}

/// The best candidate that is not near a mode which the widened bearings find at least as good. It is not taken twice.
fn take_best(candidates: &mut [Candidate], modes: &Modes, wide: &Density<'_>) -> Option<State> {
    let mut known = [f32::NEG_INFINITY; MODES];
    for (known, mode) in known.iter_mut().zip(modes) {
        *known = wide.log_density(&[mode.mean[0], mode.mean[1], 0.0]);
    }
    let mut best: Option<&mut Candidate> = None;
    for candidate in candidates {
        let above = best.as_ref().map_or(f32::NEG_INFINITY, |best| best.score);
        let near = |(mode, known): (&Mode, &f32)| {
            *known >= candidate.score && mode.distance_of_position(&candidate.state) < NEAR
        };
        if candidate.score > above && !modes.iter().zip(&known).any(near) {
            best = Some(candidate);
        }
    }
    best.map(|candidate| {
        candidate.score = f32::NEG_INFINITY;
        candidate.state
    })
}

/// Adds a mode, if it is a new one or the better of two; in place of the lightest when there are too many.
pub(super) fn add(modes: &mut Modes, mode: Mode) {
    // Each near the other: a mode that is long, along a ray, lies about everything on it, but not the other way round.
    let same =
        |other: &&mut Mode| other.distance(&mode.mean) < SAME && mode.distance(&other.mean) < SAME;
    let rival = if let Some(same) = modes.iter_mut().find(same) {
        Some(same)
    } else if modes.is_full() {
        modes
            .iter_mut()
            .min_by(|a, b| a.log_mass.total_cmp(&b.log_mass))
    } else {
        let _ = modes.push(mode);
        None
    };
    if let Some(rival) = rival
        && mode.log_mass > rival.log_mass
    {
        *rival = mode;
    }
}
