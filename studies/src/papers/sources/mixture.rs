//! Expectation maximisation with a known number of sources, over one bearing a stop.
//!
//! Every reading is of one of the sources, with an error of one standard deviation for all, or an outlier. The readings of a
//! stop that are of one source are averaged: however many they are, they count as one bearing. All may have a bias in common,
//! of which a normal prior is known.

use std::f64::consts::TAU;

use foxhunt_host::channel::Reading;
use foxhunt_simulation::{Sight, random::generator, sight::wrap};
use nalgebra::{Matrix2, Vector2};
use rand::{Rng, RngExt};

/// Random starts, of which the likeliest end counts.
const STARTS: u64 = 20;
/// Places, of which the one that adds most to the likelihood is where a source starts; and readings by which that is judged.
const CANDIDATES: usize = 20;
const JUDGES: usize = 100;
/// Steps from each.
const STEPS: usize = 60;
/// Of the errors and of the outliers at the start.
const SIGMA: f64 = 0.2;
const OUTLIERS: f64 = 0.1;

/// The places of so many sources, with a bias of this standard deviation in radians; zero is none.
pub fn locate(readings: &[Reading], count: usize, bias_sigma: f64, seed: u64) -> Vec<[f64; 2]> {
    let sights: Vec<Sight> = readings.iter().map(|reading| reading.sight).collect();
    let ends = (0..STARTS).filter_map(|start| {
        let mut rng = generator(seed, start);
        let mut mixture = Mixture::start(&sights, count, bias_sigma, &mut rng)?;
        let mut likelihood = f64::NEG_INFINITY;
        for _ in 0..STEPS {
            likelihood = mixture.step(&sights);
        }
        Some((likelihood, mixture))
    });
    let best = ends.max_by(|(a, _), (b, _)| a.total_cmp(b));
    best.map_or(Vec::new(), |(_, mixture)| mixture.places())
}

struct Mixture {
    sources: Vec<Vector2<f64>>,
    /// Of the sources, and of the outliers last.
    rates: Vec<f64>,
    sigma: f64,
    bias: f64,
    /// What is known of the bias.
    bias_sigma: f64,
}

impl Mixture {
    /// One source after the other where two bearings cross: each at the best of some random crossings.
    fn start(sights: &[Sight], count: usize, bias_sigma: f64, rng: &mut impl Rng) -> Option<Self> {
        let draw = |_| {
            sights
                .get(rng.random_range(0..sights.len().max(1)))
                .copied()
        };
        let judges: Vec<Sight> = (0..JUDGES).map(draw).collect::<Option<_>>()?;
        let mut densities = vec![OUTLIERS / TAU; JUDGES];
        let each = (1.0 - OUTLIERS) / count as f64;
        let density = |sight: &Sight, place: &Vector2<f64>| {
            each * normal(sight.residual((*place).into()), SIGMA)
        };
        let mut sources = Vec::new();
        for _ in 0..count {
            let gain = |place: &Vector2<f64>| -> f64 {
                let judges = judges.iter().zip(&densities);
                let gains =
                    judges.map(|(sight, so_far)| (1.0 + density(sight, place) / so_far).ln());
                gains.sum()
            };
            let crossings = (0..CANDIDATES).filter_map(|_| crossing(sights, rng));
            let best = crossings.map(|place| (gain(&place), place));
            let (_, place) = best.max_by(|(a, _), (b, _)| a.total_cmp(b))?;
            for (so_far, sight) in densities.iter_mut().zip(&judges) {
                *so_far += density(sight, &place);
            }
            sources.push(place);
        }
        let mut rates = vec![each; count];
        rates.push(OUTLIERS);
        Some(Self {
            sources,
            rates,
            sigma: SIGMA,
            bias: 0.0,
            bias_sigma,
        })
    }

    fn places(&self) -> Vec<[f64; 2]> {
        self.sources.iter().map(|place| (*place).into()).collect()
    }

    /// One step; returns the logarithm of the posterior before it.
    fn step(&mut self, sights: &[Sight]) -> f64 {
        let count = self.sources.len();
        let mut normals = vec![Normal::default(); count];
        let mut totals = vec![1.0; count + 1];
        let (mut squares, mut direct, mut likelihood) = (0.0, 1e-9, 0.0);
        for stop in sights.chunk_by(|a, b| a.position == b.position) {
            let mut sums = vec![[0.0; 2]; count];
            for sight in stop {
                let (probabilities, density) = self.expect(sight);
                likelihood += density.ln();
                for (total, (probability, _)) in totals.iter_mut().zip(&probabilities) {
                    *total += probability;
                }
                for (sum, (probability, residual)) in sums.iter_mut().zip(&probabilities) {
                    sum[0] += probability;
                    sum[1] += probability * residual;
                    squares += probability * residual * residual;
                    direct += probability;
                }
            }
            let position = Vector2::from(stop[0].position);
            for ((normal, sum), place) in normals.iter_mut().zip(&sums).zip(&self.sources) {
                let [weight, residuals] = *sum;
                if weight > 1e-6 {
                    normal.add(place - position, residuals / weight, weight.min(1.0));
                }
            }
        }
        let turn = self.turn(&normals);
        if self.bias_sigma > 0.0 {
            likelihood -= 0.5 * (self.bias / self.bias_sigma).powi(2);
        }
        self.bias += turn;
        for (place, normal) in self.sources.iter_mut().zip(&normals) {
            *place += normal.step(turn);
        }
        let all: f64 = totals.iter().sum();
        self.rates = totals.iter().map(|total| total / all).collect();
        self.sigma = (squares / direct).sqrt().max(1e-3);
        likelihood
    }

    /// How much the bias changes, if all places change with it.
    fn turn(&self, normals: &[Normal]) -> f64 {
        if self.bias_sigma == 0.0 {
            return 0.0;
        }
        let prior = (self.sigma / self.bias_sigma).powi(2);
        let (mut weight, mut pull) = (prior, -prior * self.bias);
        for normal in normals {
            let [own, residuals] = normal.beside_place();
            weight += own;
            pull += residuals;
        }
        pull / weight
    }

    /// Probabilities and residuals of a reading for each source and for an outlier, and its density.
    fn expect(&self, sight: &Sight) -> (Vec<(f64, f64)>, f64) {
        let of = |place: &Vector2<f64>, rate: f64| {
            let residual = wrap(sight.residual((*place).into()) - self.bias);
            (rate * normal(residual, self.sigma), residual)
        };
        let sources = self.sources.iter().zip(&self.rates);
        let mut all: Vec<(f64, f64)> = sources.map(|(place, rate)| of(place, *rate)).collect();
        all.push((self.rates[self.sources.len()] / TAU, 0.0));
        let density: f64 = all.iter().map(|(density, _)| density).sum();
        for (probability, _) in &mut all {
            *probability /= density;
        }
        (all, density)
    }
}

/// The normal equations of a place and of the bias by bearings.
#[derive(Clone, Default)]
struct Normal {
    information: Matrix2<f64>,
    pull: Vector2<f64>,
    /// Of the bias with the place, and its own.
    coupling: Vector2<f64>,
    weight: f64,
    residuals: f64,
    /// The least range of a bearing that counts, in metres.
    nearest: Option<f64>,
}

impl Normal {
    /// A bearing from so far away that is off by an angle.
    fn add(&mut self, offset: Vector2<f64>, residual: f64, weight: f64) {
        let square = offset.norm_squared().max(1e-12);
        let gradient = Vector2::new(-offset.y, offset.x) / square;
        self.information += weight * gradient * gradient.transpose();
        self.pull += weight * residual * gradient;
        self.coupling += weight * gradient;
        self.weight += weight;
        self.residuals += weight * residual;
        let range = square.sqrt();
        self.nearest = Some(self.nearest.map_or(range, |nearest| nearest.min(range)));
    }

    /// Inverse of the information of the place, damped.
    fn inverse(&self) -> Option<Matrix2<f64>> {
        let damping = Matrix2::identity() * (1e-3 * self.information.trace());
        (self.information + damping).try_inverse()
    }

    /// What the bearings say of the bias wherever the place is: its information, and that times what it is off by.
    fn beside_place(&self) -> [f64; 2] {
        let Some(inverse) = self.inverse() else {
            return [0.0; 2];
        };
        let by_place = inverse * self.coupling;
        [
            self.weight - by_place.dot(&self.coupling),
            self.residuals - by_place.dot(&self.pull),
        ]
    }

    /// The step to the solution if the bias changes by so much, damped, and no farther than half of the way to the nearest
    /// receiver or to infinity.
    fn step(&self, turn: f64) -> Vector2<f64> {
        let Some((inverse, nearest)) = self.inverse().zip(self.nearest) else {
            return Vector2::zeros();
        };
        let step = inverse * (self.pull - turn * self.coupling);
        let most = 0.5 * nearest.max(1.0 / self.information.trace().sqrt());
        step * (most / step.norm()).min(1.0)
    }
}

/// The density of a normal error.
fn normal(error: f64, sigma: f64) -> f64 {
    let z = error / sigma;
    (-0.5 * z * z).exp() / (TAU.sqrt() * sigma)
}

/// Where two random bearings cross, in front of both receivers; `None` where none are found.
fn crossing(sights: &[Sight], rng: &mut impl Rng) -> Option<Vector2<f64>> {
    const TRIES: usize = 1000;
    (0..TRIES).find_map(|_| {
        let [a, b] = [0, 1].map(|_| sights[rng.random_range(0..sights.len())]);
        let [u, v] = [a, b].map(|sight| Vector2::new(sight.bearing.cos(), sight.bearing.sin()));
        let way = Vector2::from(b.position) - Vector2::from(a.position);
        let sine = u.perp(&v);
        let [along_a, along_b] = [way.perp(&v) / sine, way.perp(&u) / sine];
        (along_a > 0.0 && along_b > 0.0 && sine.abs() > 0.1)
            .then(|| Vector2::from(a.position) + along_a * u)
    })
}

#[cfg(test)]
mod tests {
    use foxhunt_host::channel::Channel;

    use super::{super::gospa::Assignment, *};

    #[test]
    fn four_sources_are_found() {
        for (side, readings, outliers) in [(12.0, 1, 0.0), (1200.0, 1, 0.1), (12.0, 5, 0.1)] {
            let channel = Channel::stops(side, readings, 0.035, 0.0).with_outliers(outliers);
            let readings = channel.readings(&mut generator(1, 0));
            let found = locate(&readings, 4, 0.0, 1);
            let Assignment { estimates, gospa } =
                Assignment::new(&channel.sources, &found, 0.1 * side);
            assert!(estimates.iter().all(Option::is_some), "{found:?}");
            assert!(gospa.total().sqrt() < 0.15 * side);
        }
    }

    /// Turning all bearings turns nothing but the bias.
    #[test]
    fn a_bias_is_found() {
        let channel = Channel::stops(12.0, 1, 0.02, 0.0);
        let mut readings = channel.readings(&mut generator(3, 0));
        for reading in &mut readings {
            reading.sight.bearing = wrap(reading.sight.bearing + 0.1);
        }
        let error = |bias_sigma| {
            let found = locate(&readings, 4, bias_sigma, 1);
            let assignment = Assignment::new(&channel.sources, &found, 3.0);
            assignment.gospa.total().sqrt()
        };
        let [unknown, known] = [0.0, 0.07].map(error);
        assert!(known < 0.4 * unknown, "{known} {unknown}");
    }

    #[test]
    fn nothing_comes_of_nothing() {
        assert!(locate(&[], 2, 0.07, 1).is_empty());
    }
}
