//! Finds the modes of the posterior, afresh from where random pairs of bearings cross.

use heapless::Vec;

use super::config::Config;
use super::density::Density;
use super::evidence::{Evidence, Terms};
use super::mode::{MODES, Mode, Modes, weigh};
use super::term::{SCALE, State, Term};
use crate::aoa::core::{BLOCK, Entry, Target};
use crate::aoa::triangulation::random_crossing;
use crate::math::ln;
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
struct Candidate<const D: usize> {
    state: State<D>,
    score: f32,
}

/// The modes of all bearings, from those `known` before and from random crossings.
#[inline(never)]
pub(super) fn search<R: Rng + ?Sized, const D: usize, const B: usize>(
    evidence: &Evidence<B, D>,
    terms: &[Term<D>],
    config: &Config,
    known: &Modes<D>,
    rng: &mut R,
) -> Modes<D> {
    let errors = &config.errors;
    let density = evidence.density(terms, config);
    let mut modes = climb_again(&density, known);
    let bias = errors.bias_sigma_rad;
    let mut wide = Terms::<D, B>::new();
    for term in terms {
        let _ = wide.push(term.widened(WIDENING, bias));
    }
    let wide = Density {
        terms: &wide,
        scale_sigma: 0.0,
        ..density
    };
    let mut candidates = candidates(evidence.entries(), &wide, rng);
    for _ in 0..CLIMBS {
        let Some(start) = take_best(&mut candidates, &modes, &wide) else {
            break;
        };
        let Some(rough) = Mode::climb(&wide, start, ROUGH) else {
            continue;
        };
        for scale in scales(errors.scale_sigma) {
            let mut start = rough.mean;
            start[SCALE] = scale;
            if let Some(mode) = Mode::climb(&density, start, FINE) {
                add(&mut modes, mode);
            }
        }
    }
    weigh(&mut modes);
    modes
}

/// Scales to climb from, in prior sigmas: as is expected, and as large as the widened bearings have them. Good bearings
/// beside outliers, or worse ones beside none: each may be a mode.
fn scales(sigma: f32) -> impl Iterator<Item = f32> {
    const LN_WIDENING: f32 = ln(WIDENING);
    let wide = (sigma > 0.0).then(|| LN_WIDENING / sigma);
    core::iter::once(0.0).chain(wide)
}

/// Where the modes of other bearings are by these.
pub(super) fn climb_again<const D: usize>(density: &Density<'_, D>, known: &Modes<D>) -> Modes<D> {
    let mut modes = Modes::new();
    for mode in known {
        if let Some(mode) = Mode::climb(density, mode.mean, AGAIN) {
            add(&mut modes, mode);
        }
    }
    modes
}

/// Random crossings of the bearings as lines, for each of a pair may be mirrored.
fn candidates<R: Rng + ?Sized, const D: usize>(
    entries: &[Entry],
    wide: &Density<'_, D>,
    rng: &mut R,
) -> Vec<Candidate<D>, CANDIDATES> {
    let mut candidates = Vec::new();
    for _ in 0..BLOCKS {
        let mut states = [[0.0; D]; BLOCK];
        let mut valid = [false; BLOCK];
        for (state, valid) in states.iter_mut().zip(&mut valid) {
            let fits = |a: &Entry, b: &Entry, _: &_| !a.excludes(b);
            if let Some(place) = random_crossing(entries, LEAST_SINE, TRIES, rng, fits) {
                (state[0], state[1]) = (place[0], place[1]);
                *valid = true;
            }
        }
        let block = core::array::from_fn(|d| states.map(|state| state[d]));
        let scores = wide.log_densities(&block);
        for ((state, score), valid) in states.into_iter().zip(scores).zip(valid) {
            if valid {
                let _ = candidates.push(Candidate { state, score });
            }
        }
    }
    candidates
}

/// The best candidate that is not near a mode which the widened bearings find at least as good. It is not taken twice.
fn take_best<const D: usize>(
    candidates: &mut [Candidate<D>],
    modes: &Modes<D>,
    wide: &Density<'_, D>,
) -> Option<State<D>> {
    let mut known = [f32::NEG_INFINITY; MODES];
    for (known, mode) in known.iter_mut().zip(modes) {
        let mut place = [0.0; D];
        (place[0], place[1]) = (mode.mean[0], mode.mean[1]);
        *known = wide.log_density(&place);
    }
    let mut best: Option<&mut Candidate<D>> = None;
    for candidate in candidates {
        let above = best.as_ref().map_or(f32::NEG_INFINITY, |best| best.score);
        let near = |(mode, known): (&Mode<D>, &f32)| {
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
pub(super) fn add<const D: usize>(modes: &mut Modes<D>, mode: Mode<D>) {
    // Each near the other: a mode that is long, along a ray, lies about everything on it, but not the other way round.
    let same = |other: &&mut Mode<D>| {
        other.distance(&mode.mean) < SAME && mode.distance(&other.mean) < SAME
    };
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
