//! What an update does: predict, weigh, judge, summarise, resample.

use super::field::Field;
use super::fix::seconds;
use super::offset::OffsetBelief;
use super::pending::Level;
use super::{Fix, Site, State, Tracker, Workspace};
use crate::estimate::{self, Symmetric2};
use crate::math::{ln, sqrt};
use crate::random::{Rng, normal, uniform};
use crate::resample::Scheme;
use crate::weights::{UpdateError, Weights};

/// Seconds over which the evidence is smoothed: fewer take a few bad scans for a lost tag, more leave a lost tag lost for
/// longer.
const EVIDENCE_S: f32 = 6.0;
/// The smoothed evidence below which particles are drawn anew. Higher draws clouds anew that were right; without any, one
/// walk in a thousand is lost for good.
const LOST_BELOW: f32 = -0.7;

impl<const N: usize, const B: usize> Tracker<N, B> {
    #[inline(never)]
    pub(super) fn update<const P: usize, R: Rng + ?Sized>(
        &mut self,
        time_ms: u32,
        scan: &[Level; B],
        site: &Site<'_>,
        workspace: &mut Workspace<N, P>,
        rng: &mut R,
    ) {
        let Site { map, config, .. } = site;
        let Workspace { field, weights } = workspace;
        let weighed = if let Some(last) = self.fix() {
            let dt = seconds(time_ms.wrapping_sub(last.time_ms) as i32);
            // Two updates at one time are two looks at one place.
            let dt = if dt > 1e-3 { dt } else { 1e-3 };
            self.offset.drift(config, dt);
            field.look_up(map, config, &self.offset, scan);
            let log_likelihoods = weights.log_likelihoods_mut();
            self.predict(dt, site, log_likelihoods, rng);
            if let Some(redrawn_s) = &mut self.redrawn_s {
                *redrawn_s += dt;
            }
            self.add_likelihoods(site, field, log_likelihoods);
            self.judge(weights.update(), dt, site, workspace, rng)
        } else {
            self.offset = OffsetBelief::prior(config);
            field.look_up(map, config, &self.offset, scan);
            self.draw(1.0, site, workspace, rng)
        };
        match weighed {
            Ok(()) => self.conclude(time_ms, site, workspace, rng),
            Err(UpdateError::AllWeightsZero) => workspace.weights.make_equal(),
        }
    }

    /// Adds the log-likelihoods of the places.
    fn add_likelihoods<const P: usize>(
        &self,
        site: &Site<'_>,
        field: &Field<P>,
        log_likelihoods: &mut [f32; N],
    ) {
        let lattice = site.map.lattice();
        let [x0, y0] = lattice.origin();
        let [x, y, ..] = self.particles.columns();
        let mut add_along = |places: &[f32], origin: f32| {
            for (log_likelihood, place) in log_likelihoods.iter_mut().zip(places) {
                *log_likelihood += field.on_line(lattice, *place, origin);
            }
        };
        match lattice.extends() {
            [_, false] => add_along(x, x0),
            [false, true] => add_along(y, y0),
            [true, true] => {
                for ((log_likelihood, x), y) in log_likelihoods.iter_mut().zip(x).zip(y) {
                    *log_likelihood += field.in_plane(lattice, [*x, *y]);
                }
            }
        }
    }

    /// Smooths the evidence, which is how well the scan fits the particles, against as many spread over the whole map; and
    /// draws particles anew from the match if it is against them.
    fn judge<const P: usize, R: Rng + ?Sized>(
        &mut self,
        log_evidence: Result<f32, UpdateError>,
        dt: f32,
        site: &Site<'_>,
        workspace: &mut Workspace<N, P>,
        rng: &mut R,
    ) -> Result<(), UpdateError> {
        let mut fraction = 1.0;
        if let Ok(log_evidence) = log_evidence {
            let smoothing = dt * (1.0 / EVIDENCE_S);
            let smoothing = if smoothing < 1.0 { smoothing } else { 1.0 };
            let evidence = log_evidence - ln(workspace.field.mean);
            self.evidence += smoothing * (evidence.clamp(-20.0, 20.0) - self.evidence);
            fraction = site.config.redraw_fraction;
            if !(self.evidence < LOST_BELOW && fraction > 0.0) {
                return Ok(());
            }
            self.resample(site, workspace, rng);
        }
        self.evidence = 0.0;
        self.redrawn_s = Some(0.0);
        self.draw(fraction, site, workspace, rng)
    }

    /// Summarises the cloud; then resamples.
    fn conclude<const P: usize, R: Rng + ?Sized>(
        &mut self,
        time_ms: u32,
        site: &Site<'_>,
        workspace: &mut Workspace<N, P>,
        rng: &mut R,
    ) {
        let [x, y, ..] = self.particles.columns();
        let Workspace { field, weights } = &*workspace;
        // Particles that were just drawn have not been tried yet.
        if self.redrawn_s != Some(0.0) {
            let lattice = site.map.lattice();
            let places = weights.weights().iter().zip(x.iter().zip(y));
            let opinions =
                places.map(|(weight, (x, y))| (*weight, field.offset_at(lattice, [*x, *y])));
            self.offset.learn(field.precision, opinions);
        }
        self.fix = self.summarise(time_ms, site, weights);
        self.has_fix = true;
        self.resample(site, workspace, rng);
    }

    /// The fix by the weighted cloud.
    fn summarise(&self, time_ms: u32, site: &Site<'_>, weights: &Weights<N>) -> Fix {
        let lattice = site.map.lattice();
        let [x, y, vx, vy] = self.particles.columns();
        let mut fix = Fix {
            time_ms,
            position: lattice.origin(),
            offset_db: self.offset.probability() * self.offset.mean_db,
            effective_sample_size: weights.effective_sample_size(),
            ..Fix::EMPTY
        };
        let weights = weights.weights();
        let along = |places: &[f32], velocities: &[f32]| {
            let [[variance]] = estimate::covariance(&[places], weights);
            (estimate::mean(&[places, velocities], weights), variance)
        };
        match lattice.extends() {
            [true, true] => {
                let [px, py, pvx, pvy] = estimate::mean(&[x, y, vx, vy], weights);
                fix.position = [px, py];
                fix.velocity = [pvx, pvy];
                fix.covariance = Symmetric2::from(estimate::covariance(&[x, y], weights));
            }
            [_, false] => {
                ([fix.position[0], fix.velocity[0]], fix.covariance.xx) = along(x, vx);
            }
            [false, true] => {
                ([fix.position[1], fix.velocity[1]], fix.covariance.yy) = along(y, vy);
            }
        }
        fix.state = match self.redrawn_s {
            Some(0.0) => State::Lost,
            _ if fix.sigma_m() > site.config.uncertain_sigma_m => State::Uncertain,
            Some(seconds) if seconds < EVIDENCE_S => State::Recovered,
            _ => State::Tracking,
        };
        fix
    }

    /// Draws a fraction of the particles from the match: systematically over the points, uniformly within the cell of each.
    #[inline(never)]
    fn draw<const P: usize, R: Rng + ?Sized>(
        &mut self,
        fraction: f32,
        site: &Site<'_>,
        workspace: &mut Workspace<N, P>,
        rng: &mut R,
    ) -> Result<(), UpdateError> {
        let Workspace { field, weights } = workspace;
        let sigma = site.config.velocity_sigma_m_s;
        let prior = sigma * sigma;
        let count = ((fraction * N as f32) as usize).clamp(1, N);
        if count == N {
            self.velocity_variance = [prior; 2];
        }
        // What the common variance lacks is drawn.
        let spread = self.velocity_variance.map(|variance| {
            sqrt(if variance < prior {
                prior - variance
            } else {
                0.0
            })
        });
        let lattice = site.map.lattice();
        let mut likelihoods = field.likelihoods(lattice).enumerate();
        let gap = field.mean * lattice.points() as f32 / count as f32;
        let mut next = uniform(rng) * gap;
        let (mut point, mut sum) = (0, 0.0);
        let stride = N.checked_div(count).unwrap_or(1);
        for i in (0..N).step_by(stride).take(count) {
            while sum <= next {
                let Some((number, likelihood)) = likelihoods.next() else {
                    break;
                };
                // Rounding may leave a place beyond the last point that is possible.
                if likelihood > 0.0 {
                    point = number;
                }
                sum += likelihood;
            }
            next += gap;
            let place = place_in_cell(point, site, rng);
            let velocity = spread.map(|spread| spread * normal(rng));
            self.particles
                .set(i, [place[0], place[1], velocity[0], velocity[1]]);
            let log_weight = if sum > 0.0 && site.walls.contain(place) {
                0.0
            } else {
                f32::NEG_INFINITY
            };
            if let Some(slot) = weights.log_weights_mut().get_mut(i) {
                *slot = log_weight;
            }
        }
        weights.normalise()
    }

    #[inline(never)]
    fn resample<const P: usize, R: Rng + ?Sized>(
        &mut self,
        site: &Site<'_>,
        workspace: &mut Workspace<N, P>,
        rng: &mut R,
    ) {
        // Across a line the places are the same for all.
        let [along_x, along_y] = site.map.lattice().extends();
        let wanted = [along_x, along_y, along_x, along_y];
        let columns = self.particles.columns_mut().into_iter().zip(wanted);
        (workspace.weights).resample(Scheme::Systematic, rng, |ancestors, scratch| {
            for (column, _) in columns.filter(|(_, wanted)| *wanted) {
                ancestors.gather(column, scratch);
            }
        });
    }
}

/// A place in the cell of a point, within the walls if that takes no more than four tries.
fn place_in_cell<R: Rng + ?Sized>(point: usize, site: &Site<'_>, rng: &mut R) -> [f32; 2] {
    let lattice = site.map.lattice();
    let mut place = lattice.position(point);
    for _ in 0..4 {
        place = lattice.in_cell(point, [uniform(rng), uniform(rng)]);
        if site.walls.contain(place) {
            break;
        }
    }
    place
}
