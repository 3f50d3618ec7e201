//! The particle filter of the paper.

use super::Model;
use foxhunt::filter::{ParticleFilter, UpdateError};
use foxhunt::model::ConstantVelocity;
use foxhunt::random::{Rng, normal, uniform};
use foxhunt::resample::Scheme;

/// A bootstrap filter of `N` particles (x, y, vx, vy) that takes matches for measurements: 24 N + 8 bytes.
#[derive(Debug, Clone)]
pub struct Cloud<const N: usize> {
    pub(super) filter: ParticleFilter<4, N>,
}

impl<const N: usize> Cloud<N> {
    /// All particles at the origin, in bits that are all zero: start it before use.
    pub const EMPTY: Self = Self {
        filter: ParticleFilter::EMPTY,
    };

    /// Starts around the first match: places scatter about it by the covariance of a match, velocities about zero.
    pub fn start_around<R: Rng + ?Sized>(&mut self, found: [f32; 2], model: &Model, rng: &mut R) {
        self.filter.initialise(rng, |rng| {
            let [dx, dy] = model.observation.colour([normal(rng), normal(rng)]);
            let [vx, vy] = model.velocity_sigma_m_s.map(|sigma| sigma * normal(rng));
            [found[0] + dx, found[1] + dy, vx, vy]
        });
    }

    /// Starts anywhere in a box, and takes the first match.
    ///
    /// # Errors
    /// When no particle explains the match, because it is far from the box or not finite; the particles are then anywhere
    /// in the box.
    pub fn start_within<R: Rng + ?Sized>(
        &mut self,
        least: [f32; 2],
        most: [f32; 2],
        found: [f32; 2],
        model: &Model,
        rng: &mut R,
    ) -> Result<(), UpdateError> {
        let sizes = [most[0] - least[0], most[1] - least[1]];
        self.filter.initialise(rng, |rng| {
            let x = least[0] + sizes[0] * uniform(rng);
            let y = least[1] + sizes[1] * uniform(rng);
            let [vx, vy] = model.velocity_sigma_m_s.map(|sigma| sigma * normal(rng));
            [x, y, vx, vy]
        });
        self.weigh(found, model)
    }

    /// Takes the match of a scan, `dt` seconds after the last one (eq. 8 to 16). Resamples before it moves the
    /// particles, so that [`Cloud::mean`] is that of the weighted cloud. An invalid interval counts as zero.
    ///
    /// # Errors
    /// When no particle explains the match: the particles have then moved, but not learned anything.
    pub fn step<R: Rng + ?Sized>(
        &mut self,
        dt: f32,
        found: [f32; 2],
        model: &Model,
        rng: &mut R,
    ) -> Result<(), UpdateError> {
        let dt = if dt > 0.0 && dt.is_finite() { dt } else { 0.0 };
        self.filter.resample(Scheme::Systematic, rng);
        let motion = ConstantVelocity {
            sigma_m_s2: model.acceleration_sigma_m_s2,
        };
        self.filter.predict(&motion, dt, rng);
        self.weigh(found, model)
    }

    fn weigh(&mut self, found: [f32; 2], model: &Model) -> Result<(), UpdateError> {
        let likelihood = |state: &[f32; 4]| {
            let white = (model.observation).whiten([found[0] - state[0], found[1] - state[1]]);
            -0.5 * (white[0] * white[0] + white[1] * white[1])
        };
        self.filter.update(&likelihood).map(drop)
    }

    /// The estimate: the weighted mean of the states.
    pub fn mean(&self) -> [f32; 4] {
        self.filter.mean()
    }
}
