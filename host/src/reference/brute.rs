//! The posterior by brute force: a uniform grid, which [`Posterior`](super::Posterior) is checked with.

use std::{
    collections::HashSet,
    f64::consts::{PI, TAU},
};

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

use super::{Biases, ByDirection, Model, Prior, Square, turns};
use foxhunt_simulation::{Sight, faults::Faults};

/// What a uniform grid says of the posterior that [`Posterior`](super::Posterior) computes; it shares no code with it.
///
/// The grid covers a box round all maxima that are found from crossings of bearings and a coarse grid, with all places whose
/// likelihood is within a factor of e^-24 of the largest.
#[derive(Debug, Clone, Copy)]
pub struct Brute {
    /// The largest log-likelihood that was found, and where it is.
    pub maximum: (f64, [f64; 2]),
    /// `None` if the finest is too coarse.
    pub grid: Option<Grid>,
}

/// What the grid says.
#[derive(Debug, Clone, Copy)]
pub struct Grid {
    /// In metres east and north.
    pub mean: [f64; 2],
    /// In square metres.
    pub covariance: Matrix2<f64>,
    /// Logarithm of the density of the bearings, if the source is anywhere in the square, or with the prior's density there.
    pub log_evidence: f64,
    /// How far a grid with cells twice as wide is off this one.
    pub error: Difference,
}

/// How far one posterior is from another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Distance of the means, in standard deviations along it.
    pub mean: f64,
    /// The largest ratio of standard deviations along any line, less one.
    pub sigma: f64,
}

impl Difference {
    /// Of a mean and covariance, from another one, whose standard deviations count.
    pub fn new(mean: [f64; 2], covariance: &Matrix2<f64>, from: ([f64; 2], &Matrix2<f64>)) -> Self {
        let Some(factor) = from
            .1
            .cholesky()
            .and_then(|factor| factor.l().try_inverse())
        else {
            return Self {
                mean: f64::INFINITY,
                sigma: f64::INFINITY,
            };
        };
        let offset = Vector2::from(mean) - Vector2::from(from.0);
        let ratios = (factor * covariance * factor.transpose()).symmetric_eigenvalues();
        Self {
            mean: (factor * offset).norm(),
            sigma: ratios.map(|v| (v.sqrt() - 1.0).abs()).max(),
        }
    }
}

/// Places this far below the maximum, in log-likelihood, are outside the box.
const HOPELESS: f64 = 24.0;
/// Cells along a side of the first grid.
const FIRST: usize = 64;
/// Halving ends when it moves means by less than this fraction of a standard deviation, and these by less of themselves.
const ENOUGH: f64 = 1e-3;

impl Brute {
    /// Of `sights` by the `model` on a source in the `square`, with at most `finest` cells a side.
    pub fn new(square: &Square, sights: &[Sight], model: &Model, finest: usize) -> Self {
        let scales = Scaled::all(sights, model);
        let log = |place: Vector2<f64>| {
            let errors = sights.iter().map(|sight| sight.residual(place.into()));
            let errors = DVector::from_iterator(sights.len(), errors);
            if let Biases::ByDirection(biases) = &model.biases {
                let all = scales.iter().map(|s| {
                    s.log_weight + biased(sights, &s.sigmas, biases, place, errors.as_slice())
                });
                return log_of_sum(all) + log_prior(&model.prior, place);
            }
            let all = scales
                .iter()
                .map(|s| s.log_weight + s.log_likelihood(&errors));
            log_of_sum(all) + log_prior(&model.prior, place)
        };
        let low = Vector2::from(square.centre).add_scalar(-square.side / 2.0);
        let whole = [low, low.add_scalar(square.side)];
        let maxima = maxima(whole, sights, &log);
        let (best, mode) = (maxima.iter().copied())
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .unwrap_or((f64::NEG_INFINITY, low));
        let near = (maxima.iter())
            .filter(|(height, _)| *height > best - HOPELESS)
            .map(|(_, place)| place);
        let inner = [
            near.clone().fold(mode, |low, place| low.inf(place)),
            near.fold(mode, |high, place| high.sup(place)),
        ];
        let outer = grown(inner, whole, best, &log);
        let flat = match model.prior {
            Prior::Flat => 2.0 * square.side.ln(),
            Prior::Ranged { .. } => 0.0,
        };
        Self {
            maximum: (best, mode.into()),
            grid: finer(outer, whole, best, finest, &log).map(|(moments, error)| Grid {
                mean: moments.mean,
                covariance: moments.covariance,
                log_evidence: best + moments.integral.ln() - flat,
                error,
            }),
        }
    }
}

/// The sums over the first grid that is fine enough, and how far one half as fine is off them.
fn finer(
    mut outer: [Vector2<f64>; 2],
    whole: [Vector2<f64>; 2],
    best: f64,
    finest: usize,
    log: &impl Fn(Vector2<f64>) -> f64,
) -> Option<(Moments, Difference)> {
    let mut count = FIRST;
    let mut coarse: Option<Moments> = None;
    while count <= finest {
        let moments = Moments::new(outer, count, best, log);
        let mut heavy = false;
        for (end, axis) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            if moments.edges[end][axis] > 1e-8 && outer[end][axis] != whole[end][axis] {
                let margin = [-0.25, 0.25][end] * (outer[1][axis] - outer[0][axis]);
                outer[end][axis] =
                    (outer[end][axis] + margin).clamp(whole[0][axis], whole[1][axis]);
                heavy = true;
            }
        }
        if heavy {
            coarse = None;
            continue;
        }
        if let Some(coarse) = coarse {
            let fine = (moments.mean, &moments.covariance);
            let error = Difference::new(coarse.mean, &coarse.covariance, fine);
            if error.mean.max(error.sigma) < ENOUGH {
                return Some((moments, error));
            }
        }
        coarse = Some(moments);
        count *= 2;
    }
    None
}

/// Sums over a grid.
struct Moments {
    mean: [f64; 2],
    covariance: Matrix2<f64>,
    integral: f64,
    /// The fractions in the cells at the low and high ends of each axis.
    edges: [[f64; 2]; 2],
}

impl Moments {
    fn new(
        [low, high]: [Vector2<f64>; 2],
        count: usize,
        best: f64,
        log: &impl Fn(Vector2<f64>) -> f64,
    ) -> Self {
        let (mut total, mut edges) = (0.0, [[0.0; 2]; 2]);
        let mut first = Vector2::zeros();
        let mut second = Matrix2::zeros();
        let step = (high - low) / count as f64;
        for row in 0..count {
            for column in 0..count {
                let offset = Vector2::new(column as f64 + 0.5, row as f64 + 0.5);
                let offset = step.component_mul(&offset);
                let weight = (log(low + offset) - best).exp();
                total += weight;
                first += offset * weight;
                second += offset * offset.transpose() * weight;
                for (axis, k) in [column, row].into_iter().enumerate() {
                    for (end, last) in [0, count - 1].into_iter().enumerate() {
                        if k == last {
                            edges[end][axis] += weight;
                        }
                    }
                }
            }
        }
        let mean = first / total;
        Self {
            mean: (low + mean).into(),
            covariance: second / total - mean * mean.transpose(),
            integral: total * step.x * step.y,
            edges: edges.map(|end| end.map(|edge| edge / total)),
        }
    }
}

/// The box with each side moved outwards until all along it is hopeless, or to the side of `whole`.
fn grown(
    inner: [Vector2<f64>; 2],
    whole: [Vector2<f64>; 2],
    best: f64,
    log: &impl Fn(Vector2<f64>) -> f64,
) -> [Vector2<f64>; 2] {
    let margin = 1e-5 * (whole[1] - whole[0]).x;
    let mut grown = [inner[0].add_scalar(-margin), inner[1].add_scalar(margin)];
    let mut moved = true;
    while moved {
        moved = false;
        for (end, axis) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let other = 1 - axis;
            let hopeful = (0..=400).any(|k| {
                let mut place = grown[end];
                let fraction = f64::from(k) / 400.0;
                place[other] = grown[0][other] + fraction * (grown[1][other] - grown[0][other]);
                log(place) > best - HOPELESS
            });
            if hopeful && grown[end][axis] != whole[end][axis] {
                let side = grown[1][axis] - grown[0][axis];
                let outwards = if end == 0 { -0.3 } else { 0.3 };
                let next = grown[end][axis] + outwards * side;
                grown[end][axis] = next.clamp(whole[0][axis], whole[1][axis]);
                moved = true;
            }
        }
    }
    [grown[0].sup(&whole[0]), grown[1].inf(&whole[1])]
}

/// The maxima that are reached from crossings of bearings and a coarse grid, each with its log-likelihood.
fn maxima(
    [low, high]: [Vector2<f64>; 2],
    sights: &[Sight],
    log: &impl Fn(Vector2<f64>) -> f64,
) -> Vec<(f64, Vector2<f64>)> {
    const COARSE: u32 = 96;
    let mut starts: Vec<Vector2<f64>> = (0..COARSE * COARSE)
        .map(|k| Vector2::new(f64::from(k % COARSE) + 0.5, f64::from(k / COARSE) + 0.5))
        .map(|k| low + (high - low).component_mul(&k) / f64::from(COARSE))
        .collect();
    let stride = sights.len().div_ceil(80);
    for (k, a) in sights.iter().enumerate().step_by(stride) {
        for b in sights[..k].iter().step_by(stride) {
            let [u, v] = [a, b].map(|s| Vector2::new(s.bearing.cos(), s.bearing.sin()));
            let apart = Vector2::from(b.position) - Vector2::from(a.position);
            let crossing = Vector2::from(a.position) + u * (apart.perp(&v) / u.perp(&v));
            if (0..2).all(|d| crossing[d] > low[d] && crossing[d] < high[d]) {
                starts.push(crossing);
            }
        }
    }
    let mut starts: Vec<_> = starts
        .into_iter()
        .map(|place| (log(place), place))
        .collect();
    starts.sort_by(|a, b| b.0.total_cmp(&a.0));
    // The best of each part of the square, so that no maximum hides behind a higher one.
    let mut parts = HashSet::new();
    starts.retain(|(_, place)| {
        let part = (place - low).component_div(&(high - low)) * 12.0;
        parts.insert((part.x as i32, part.y as i32))
    });
    for (height, place) in &mut starts {
        let mut step = (high - low).x / f64::from(COARSE);
        for _ in 0..300 {
            let next = (0..8)
                .map(|k| f64::from(k) * PI / 4.0)
                .map(|angle| *place + Vector2::new(angle.cos(), angle.sin()) * step)
                .map(|next| next.sup(&low).inf(&high))
                .find(|next| log(*next) > *height);
            match next {
                Some(next) => {
                    (*height, *place) = (log(next), next);
                    step *= 1.5;
                }
                None => step *= 0.5,
            }
        }
    }
    starts
}

/// At a place, by the definition.
fn log_prior(prior: &Prior, place: Vector2<f64>) -> f64 {
    let Prior::Ranged {
        centre,
        nearest_m: a,
        range_m: b,
    } = *prior
    else {
        return 0.0;
    };
    let r = (place - Vector2::from(centre)).norm();
    let ratio = (b / a).powi(2);
    let whole = match ratio {
        1.0 => PI * a * a,
        _ => PI * a * a * ratio / (ratio - 1.0) * ratio.ln(),
    };
    (1.0 / (whole * (1.0 + (r / a).powi(2)) * (1.0 + (r / b).powi(2)))).ln()
}

/// The bearings at one of many scales, and the logarithm of its weight.
struct Scaled<'a> {
    log_weight: f64,
    sigmas: Vec<f64>,
    faults: &'a Faults,
    /// What makes errors with biases independent and of sigma one, and the logarithm of its determinant.
    whitened: Option<(DMatrix<f64>, f64)>,
}

impl<'a> Scaled<'a> {
    fn all(sights: &[Sight], model: &'a Model) -> Vec<Self> {
        let steps = if model.scale_sigma > 0.0 { 24 } else { 0 };
        let value = |k: i32| 0.5 * f64::from(k);
        let prior = |z: f64| -(1.0 + z * z).sqrt();
        let total: f64 = (-steps..=steps).map(|k| prior(value(k)).exp()).sum();
        let turns = model.turns(sights.len());
        let one = |z: f64| {
            let scale = (model.scale_sigma * z).exp();
            let sigmas: Vec<f64> = sights.iter().map(|sight| scale * sight.sigma).collect();
            let covariance = DMatrix::from_fn(sights.len(), sights.len(), |i, j| {
                let common: f64 = turns[i].iter().zip(&turns[j]).map(|(a, b)| a * b).sum();
                common + if i == j { sigmas[i].powi(2) } else { 0.0 }
            });
            let whitened = || {
                let factor = covariance.cholesky()?.l().try_inverse()?;
                let log = factor.diagonal().iter().map(|v| v.ln()).sum();
                Some((factor, log))
            };
            Self {
                log_weight: prior(z) - total.ln(),
                sigmas,
                faults: &model.faults,
                whitened: turns
                    .first()
                    .filter(|t| !t.is_empty())
                    .and_then(|_| whitened()),
            }
        };
        (-steps..=steps).map(value).map(one).collect()
    }

    /// Of these errors.
    fn log_likelihood(&self, errors: &DVector<f64>) -> f64 {
        if let Some((factor, log)) = &self.whitened {
            let flat = 0.5 * errors.len() as f64 * TAU.ln();
            return log - flat - 0.5 * (factor * errors).norm_squared();
        }
        let (outlier, mirrored) = (self.faults.outlier_rate, self.faults.mirrored_rate);
        let direct = 1.0 - outlier - mirrored;
        let normal = |x: f64, variance: f64| -0.5 * (x * x / variance + (TAU * variance).ln());
        let one = |(error, sigma): (&f64, &f64)| {
            let own = sigma * sigma;
            let kinds = [
                (direct, normal(*error, own)),
                (mirrored, normal(PI - error.abs(), own)),
                (outlier, -TAU.ln()),
            ];
            let possible = || kinds.iter().filter(|(rate, _)| *rate > 0.0);
            let best = possible().map(|(_, log)| *log).fold(f64::MIN, f64::max);
            let sum: f64 = possible()
                .map(|(rate, log)| rate * (log - best).exp())
                .sum();
            best + sum.ln()
        };
        errors.iter().zip(&self.sigmas).map(one).sum()
    }
}

/// Bearing by bearing, where biases depend on the direction of the place: they are estimated from the bearings before each.
fn biased(
    sights: &[Sight],
    sigmas: &[f64],
    biases: &ByDirection,
    place: Vector2<f64>,
    errors: &[f64],
) -> f64 {
    let mut mean = biases.mean.clone();
    let mut covariance = &biases.root * biases.root.transpose();
    let mut log = 0.0;
    for (k, (sight, error)) in sights.iter().zip(errors).enumerate() {
        let [x, y] = [0, 1].map(|d| place[d] - sight.position[d]);
        let relative = y.atan2(x) - biases.headings[k];
        let terms = turns(relative, biases.harmonics, biases.sigma);
        let terms = DVector::from_iterator(mean.len(), terms);
        let gain = &covariance * &terms;
        let variance = terms.dot(&gain) + sigmas[k].powi(2);
        let surprise = error - terms.dot(&mean);
        log -= 0.5 * (surprise * surprise / variance + (TAU * variance).ln());
        mean += &gain * (surprise / variance);
        covariance -= &gain * gain.transpose() / variance;
    }
    log
}

fn log_of_sum(logs: impl IntoIterator<Item = f64>) -> f64 {
    let logs: Vec<f64> = logs.into_iter().collect();
    let best = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    best + (logs.iter())
        .map(|log| (log - best).exp())
        .sum::<f64>()
        .ln()
}
