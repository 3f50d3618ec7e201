//! What all bearings say, in a bounded buffer.

use heapless::Vec;

use crate::aoa::gauss_newton::{Errors, Linearised, SolveError, linearise, solve};
use crate::aoa::{Bearing, BearingLikelihood, Observation, PushError};
use crate::math::{atan2, sin_cos, sqrt, wrap};
use crate::model::Likelihood;
use crate::snapshot::{Error, Persist, Reader, Value, Writer, list, shape};

use super::moves::Proposal;

/// The bearings that a locator rests on.
///
/// A full buffer makes room by averaging the two bearings that say most nearly the same, so a long drive thins
/// out where it was far from the source, a parked vehicle's readings become one, and nothing is forgotten.
#[derive(Debug, Clone)]
pub struct Evidence<const B: usize> {
    observations: Vec<Observation, B>,
    /// Of the observations, in the same order.
    likelihoods: Vec<BearingLikelihood, B>,
    latest: Option<Observation>,
    count: u32,
}

impl<const B: usize> Evidence<B> {
    pub(super) const EMPTY: Self = Self {
        observations: Vec::new(),
        likelihoods: Vec::new(),
        latest: None,
        count: 0,
    };

    pub(super) fn clear(&mut self) {
        self.observations.clear();
        self.likelihoods.clear();
        self.latest = None;
        self.count = 0;
    }

    pub(super) fn observations(&self) -> &[Observation] {
        &self.observations
    }

    /// How many bearings went in.
    pub(super) fn count(&self) -> u32 {
        self.count
    }

    /// The latest bearing.
    pub(super) fn latest(&self) -> Option<&Observation> {
        self.latest.as_ref()
    }

    /// Distance of a point from where the latest bearing was taken.
    pub(super) fn distance_to_latest(&self, point: [f32; 2]) -> f32 {
        let latest = self.latest().map_or([0.0; 2], Observation::position);
        sqrt(square_of_distance(point, latest))
    }

    /// Whether a bearing can be taken.
    pub(super) fn admit(&self, observation: &Observation) -> Result<(), PushError> {
        let Some(latest) = &self.latest else {
            return Ok(());
        };
        let same = |kept: &Observation| {
            (kept.time_ms(), kept.station()) == (observation.time_ms(), observation.station())
        };
        if same(latest) || self.observations.iter().any(same) {
            return Err(PushError::Duplicate);
        }
        let late = latest.since_ms(observation.time_ms());
        let age = |kept: &Observation| latest.since_ms(kept.time_ms()) as u32;
        if late > 0
            && !self
                .observations
                .iter()
                .any(|kept| age(kept) >= late as u32)
        {
            return Err(PushError::TooOld);
        }
        Ok(())
    }

    /// Takes a bearing. `source` is where the source is thought to be, if anywhere.
    pub(super) fn push(&mut self, observation: &Observation, source: Option<[f32; 2]>) {
        let observation = *observation;
        if (self.latest).is_none_or(|latest| observation.since_ms(latest.time_ms()) >= 0) {
            self.latest = Some(observation);
        }
        self.count = self.count.saturating_add(1);
        if self.observations.push(observation).is_ok() {
            let _ = self.likelihoods.push(BearingLikelihood::new(&observation));
        } else if let Some((i, j)) = self.most_alike(source) {
            if let Some((a, b)) = self.observations.get(i).zip(self.observations.get(j)) {
                self.replace(i, average(a, b, source));
            }
            self.replace(j, observation);
        }
    }

    /// The pair that was taken from places nearest to each other, in metres, or as seen from the source.
    #[inline(never)]
    fn most_alike(&self, source: Option<[f32; 2]>) -> Option<(usize, usize)> {
        let mut best = None;
        let mut least = f32::INFINITY;
        for (i, a) in self.observations.iter().enumerate() {
            let range = source.map_or(1.0, |source| square_of_distance(source, a.position()));
            for (j, b) in self.observations.iter().enumerate().skip(i + 1) {
                let difference = square_of_distance(a.position(), b.position()) / range;
                if difference < least {
                    least = difference;
                    best = Some((i, j));
                }
            }
        }
        best
    }

    fn replace(&mut self, place: usize, observation: Observation) {
        if let Some(slot) = self.observations.get_mut(place) {
            *slot = observation;
        }
        if let Some(slot) = self.likelihoods.get_mut(place) {
            *slot = BearingLikelihood::new(&observation);
        }
    }

    /// Log-density of the source being at `point`, up to a constant.
    #[inline(never)]
    fn log_density(&self, point: [f32; 2]) -> f32 {
        self.likelihoods
            .iter()
            .map(|likelihood| likelihood.log_likelihood(&point))
            .sum()
    }

    /// Log-densities of several points, up to the same constant.
    pub(super) fn log_densities<const K: usize>(&self, [x, y]: &[[f32; K]; 2]) -> [f32; K] {
        let mut sums = [0.0; K];
        let mut one = [0.0; K];
        for likelihood in &self.likelihoods {
            likelihood.log_likelihoods(&[x.as_slice(), y.as_slice()], &mut one);
            for (sum, one) in sums.iter_mut().zip(one) {
                *sum += one;
            }
        }
        sums
    }

    /// What the bearings say to a source at `point`: the sum of the squares of their errors in sigmas.
    #[inline(never)]
    pub(super) fn misfit(&self, point: [f32; 2]) -> f32 {
        let square = |o| {
            let Linearised {
                residual,
                information,
                ..
            } = linearise(o, point);
            information * residual * residual
        };
        self.observations.iter().map(square).sum()
    }

    /// The same for a source so far away, in the direction that fits best, that all bearings are parallel; and the
    /// sum of their information, 1 / sigma^2.
    #[inline(never)]
    pub(super) fn misfit_at_infinity(&self) -> (f32, f32) {
        let mut sum = [0.0; 2];
        let mut total = 0.0;
        for o in &self.observations {
            let (sin, cos) = sin_cos(o.bearing().radians());
            sum[0] += o.information() * cos;
            sum[1] += o.information() * sin;
            total += o.information();
        }
        let direction = atan2(sum[1], sum[0]);
        let square = |o: &Observation| {
            let error = wrap(o.bearing().radians() - direction);
            o.information() * error * error
        };
        (self.observations.iter().map(square).sum(), total)
    }

    /// The mode nearest to `start`, and the normal distribution that has its curvature.
    #[inline(never)]
    pub(super) fn mode(&self, start: [f32; 2]) -> Result<Proposal, SolveError> {
        let solution = solve(&self.observations, Errors::Gaussian, start)?;
        Proposal::new(solution.position, solution.covariance).ok_or(SolveError::Parallel)
    }
}

/// The likelihood of all bearings; under a flat prior, the posterior.
impl<const B: usize> Likelihood<2> for Evidence<B> {
    fn log_likelihood(&self, point: &[f32; 2]) -> f32 {
        self.log_density(*point)
    }
}

fn square_of_distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    dx * dx + dy * dy
}

/// Two bearings as one, from the place between them, each counting by its information.
///
/// The error that it has at the source is the average of theirs; far sources see the two under equal angles.
fn average(a: &Observation, b: &Observation, source: Option<[f32; 2]>) -> Observation {
    let (ia, ib) = (a.information(), b.information());
    let part = ib / (ia + ib);
    let mix = |a: f32, b: f32| a + part * (b - a);
    let position = [
        mix(a.position()[0], b.position()[0]),
        mix(a.position()[1], b.position()[1]),
    ];
    let radians = match source {
        Some(source) => {
            let error = mix(linearise(a, source).residual, linearise(b, source).residual);
            atan2(source[1] - position[1], source[0] - position[0]) + error
        }
        None => {
            let turn = Bearing::from_radians(b.bearing().radians() - a.bearing().radians());
            a.bearing().radians() + part * turn.radians()
        }
    };
    let sigma = 1.0 / sqrt(ia + ib);
    let least = Observation::MIN_SIGMA_RAD;
    let sigma = if sigma > least { sigma } else { least };
    let latest = if b.since_ms(a.time_ms()) > 0 { b } else { a };
    // What lies between two observations is one.
    Observation::new(
        latest.time_ms(),
        position,
        Bearing::from_radians(radians),
        sigma,
    )
    .map_or(*b, |one| one.from_station(a.station()))
}

/// In a snapshot, what is behind the observations.
type Rest = (Option<Observation>, u32);

/// The likelihoods follow from the observations.
impl<const B: usize> Persist for Evidence<B> {
    const SHAPE: u32 = shape("Evidence", &[B as u32]);
    const BYTES: usize = list::bytes::<Observation>(B) + Rest::SIZE;

    fn save(&self, to: &mut Writer<'_>) {
        let Self {
            observations,
            likelihoods: _,
            latest,
            count,
        } = self;
        list::save(observations, to);
        Rest::write(&(*latest, *count), to);
    }

    fn check(&self, from: &mut Reader<'_>) -> Result<(), Error> {
        list::check::<Observation>(B, from)?;
        Rest::read(from).map(drop)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        list::load(&mut self.observations, from)?;
        self.likelihoods.clear();
        for observation in &self.observations {
            let _ = self.likelihoods.push(BearingLikelihood::new(observation));
        }
        (self.latest, self.count) = Rest::read(from)?;
        Ok(())
    }
}
