//! The tracker: packets in, and the place of a tag out.
//!
//! A particle filter that weighs places by the map itself, not by a place that a match has found: a scan that fits two
//! places makes two clouds, and the walk decides between them (Cui et al. 2017 match first, see
//! [`super::published`]).
//!
//! * Packets of half a second, say, make one update. It compares their mean levels with every point of the map, and
//!   particles are weighed by interpolation between the points.
//! * Particles start from the first match, and are spread over all places that fit.
//! * A particle carries its place as a sample, and its velocity as the mean of a normal distribution whose variance is
//!   the same for all (Rao-Blackwellised: the motion is linear, so this is exact, and 300 particles do the work of
//!   thousands that sample the velocity as well).
//! * A tag may read otherwise than the one of the survey: its offset is estimated along with the places, and costs
//!   nothing when there is none.
//! * A reading that fits nowhere counts no more than one that is a few deviations off, and likelihoods are tempered,
//!   because readings that follow each other err alike.
//! * When the evidence has gone against the particles for a while, a share of them is drawn anew from the match.
//!
//! One [`Site`] and one [`Workspace`] serve any number of trackers: see [`Trackers`] for many tags.

mod field;
mod fix;
mod offset;
mod pending;
mod settings;
mod site;
mod tags;
mod walls;

use core::fmt;

use crate::estimate;
use crate::math::{exp, ln, sqrt};
use crate::particles::Particles;
use crate::random::{Rng, normal, uniform};
use crate::resample::{Scheme, resample};
use crate::weights::{self, Normalised};
use field::{Field, Level};
use fix::seconds;
use offset::OffsetBelief;
use pending::Pending;

pub use fix::{Fix, State};
pub use settings::{Channel, Motion, Offset, Settings, SettingsError};
pub use site::Site;
pub use tags::{Tag, Trackers};
pub use walls::{Piece, Walls};

/// What an update of `N` particles works in, with a map of up to `P` points: 12 P + 4 N + 8 bytes, which hold nothing of use
/// between updates. One serves all trackers.
#[derive(Debug, Clone)]
pub struct Workspace<const N: usize, const P: usize> {
    field: Field<P>,
    weights: [f32; N],
}

impl<const N: usize, const P: usize> Workspace<N, P> {
    /// For a `static` as well.
    pub const fn new() -> Self {
        Self {
            field: Field::new(),
            weights: [0.0; N],
        }
    }
}

impl<const N: usize, const P: usize> Default for Workspace<N, P> {
    fn default() -> Self {
        Self::new()
    }
}

/// One beacon of a scan.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Heard {
    /// Its number, see [`super::RadioMap::beacon_index`].
    pub beacon: u8,
    /// Mean strength of its packets, in dBm.
    pub mean_dbm: f32,
    /// How many there were.
    pub packets: u16,
}

/// Why a packet was not taken. The tracker is as before.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum PushError {
    /// The map has no beacon of that number, or the tracker no room for it.
    Beacon,
    /// No radio can report such a strength.
    Strength,
    /// It is older than the last update.
    TimeBackwards,
    /// The map has more points than the workspace.
    Points,
}

impl fmt::Display for PushError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Beacon => "a beacon that the map has not",
            Self::Strength => "a strength that no radio can report",
            Self::TimeBackwards => "older than the last update",
            Self::Points => "the map has more points than the workspace",
        })
    }
}

impl core::error::Error for PushError {}

/// Tracks one tag with `N` particles, by up to `B` beacons: 20 N + 8 B + 100 bytes at most, of which nothing moves.
///
/// ```
/// use foxhunt::fingerprint::tracker::{Settings, Site, Tracker, Workspace};
/// use foxhunt::fingerprint::RadioMap;
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
///
/// // A tunnel of 80 m with four beacons.
/// static TUNNEL: &[u8] =
///     include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/data/tunnel.map"));
/// let map = RadioMap::new(TUNNEL)?;
/// let site = Site::new(map, Settings::new())?;
/// let mut workspace = Workspace::<300, 81>::new();
/// let mut tracker = Tracker::<300, 4>::new();
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// // Somebody walks for 30 s and is heard twice a second by each beacon, as the survey says.
/// for time in (0..30_000).step_by(500) {
///     let point = 5 + time as usize / 1000;
///     for beacon in 0..4 {
///         let level = map.moments(beacon, point).unwrap().mean_dbm;
///         tracker.push(time, beacon as u8, level, &site, &mut workspace, &mut rng)?;
///     }
/// }
/// let fix = tracker.fix().unwrap();
/// assert!((fix.position_at(30_000)[0] - 35.0).abs() < 5.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Tracker<const N: usize, const B: usize = 16> {
    /// Places, and the means of velocities.
    particles: Particles<4, N>,
    log_weights: [f32; N],
    /// Of every particle's velocity, along x and along y.
    velocity_variance: [f32; 2],
    offset: OffsetBelief,
    pending: Pending<B>,
    fix: Option<Fix>,
    /// Smoothed logarithm of how much better the scans fit the particles than the whole map.
    trust: f32,
    /// Seconds since the particles were drawn anew; infinite if they never were.
    recovering_s: f32,
    /// Packets in a row that were older than the last update.
    backwards: u8,
}

impl<const N: usize, const B: usize> Tracker<N, B> {
    /// After so many packets in a row that run backwards it is the last update that was wrong.
    const BELIEF: u8 = 5;
    /// A gap of so many milliseconds ends a walk: the next packet begins another.
    const GAP_MS: i32 = 60_000;
    /// Seconds over which the evidence is smoothed.
    const PATIENCE_S: f32 = 6.0;
    /// The smoothed logarithm below which the evidence is against the particles. Without a way back one walk in a thousand
    /// is lost for good.
    const DOUBT: f32 = -0.7;

    /// Knows nothing yet. Fit for a `static`.
    pub const fn new() -> Self {
        Self {
            particles: Particles::EMPTY,
            log_weights: [0.0; N],
            velocity_variance: [0.0; 2],
            offset: OffsetBelief::new(),
            pending: Pending::new(),
            fix: None,
            trust: 0.0,
            recovering_s: f32::INFINITY,
            backwards: 0,
        }
    }

    /// Forgets all.
    pub fn reset(&mut self) {
        self.log_weights.fill(0.0);
        self.offset = OffsetBelief::new();
        self.pending.clear();
        self.fix = None;
        self.trust = 0.0;
        self.recovering_s = f32::INFINITY;
        self.backwards = 0;
    }

    /// Where the tag was at the last update; none before the first.
    pub const fn fix(&self) -> Option<Fix> {
        self.fix
    }

    /// Places and velocities: x, y, vx, vy. They mean nothing before the first fix.
    pub fn particles(&self) -> &Particles<4, N> {
        &self.particles
    }

    /// Takes a packet in: the tag, heard by beacon number `beacon` with so many dBm. Returns the fix if the packet led to an
    /// update: by the packets before it, because it is the first of another window (see [`Settings::with_window_ms`]) and
    /// waits for the next; with a window of 0 each leads to one.
    ///
    /// # Errors
    /// When the packet cannot be used.
    pub fn push<const P: usize, R: Rng + ?Sized>(
        &mut self,
        time_ms: u32,
        beacon: u8,
        rssi_dbm: f32,
        site: &Site<'_>,
        workspace: &mut Workspace<N, P>,
        rng: &mut R,
    ) -> Result<Option<Fix>, PushError> {
        if usize::from(beacon) >= site.map.beacons().min(B) {
            return Err(PushError::Beacon);
        }
        if !site.settings.accepts(rssi_dbm) {
            return Err(PushError::Strength);
        }
        if site.map.lattice().points() > P {
            return Err(PushError::Points);
        }
        self.check_time(time_ms)?;
        let window = site.settings.window_ms;
        let mut led = None;
        if window > 0 && self.pending.is_due(time_ms, window) {
            led = self.flush(site, workspace, rng);
        }
        let heard = Heard {
            beacon,
            mean_dbm: rssi_dbm,
            packets: 1,
        };
        self.pending.add(time_ms, &heard);
        if window == 0 {
            led = self.flush(site, workspace, rng);
        }
        Ok(led)
    }

    /// Updates by the packets that wait, if there are any: at the end of a walk, or when somebody asks.
    pub fn flush<const P: usize, R: Rng + ?Sized>(
        &mut self,
        site: &Site<'_>,
        workspace: &mut Workspace<N, P>,
        rng: &mut R,
    ) -> Option<Fix> {
        if self.pending.is_empty() || site.map.lattice().points() > P {
            return None;
        }
        let pending = self.pending.take();
        self.update(pending.time_ms(), pending.levels(), site, workspace, rng);
        self.fix
    }

    /// Takes a whole scan in, whose packets were all heard at one time, and updates by it at once. Packets that wait go first;
    /// readings that cannot be used are left out, and a scan with none leads to nothing.
    ///
    /// # Errors
    /// [`PushError::TimeBackwards`] or [`PushError::Points`].
    pub fn scan<const P: usize, R: Rng + ?Sized>(
        &mut self,
        time_ms: u32,
        scan: &[Heard],
        site: &Site<'_>,
        workspace: &mut Workspace<N, P>,
        rng: &mut R,
    ) -> Result<Option<Fix>, PushError> {
        if site.map.lattice().points() > P {
            return Err(PushError::Points);
        }
        self.flush(site, workspace, rng);
        self.check_time(time_ms)?;
        for heard in scan {
            if usize::from(heard.beacon) < site.map.beacons()
                && site.settings.accepts(heard.mean_dbm)
            {
                self.pending.add(time_ms, heard);
            }
        }
        Ok(self.flush(site, workspace, rng))
    }

    fn check_time(&mut self, time_ms: u32) -> Result<(), PushError> {
        let Some(fix) = self.fix else {
            return Ok(());
        };
        let since = time_ms.wrapping_sub(fix.time_ms) as i32;
        if since < 0 {
            self.backwards = self.backwards.saturating_add(1);
            if self.backwards < Self::BELIEF {
                return Err(PushError::TimeBackwards);
            }
        }
        self.backwards = 0;
        if !(0..Self::GAP_MS).contains(&since) {
            self.reset();
        }
        Ok(())
    }

    #[inline(never)]
    fn update<const P: usize, R: Rng + ?Sized>(
        &mut self,
        time_ms: u32,
        scan: &[Level; B],
        site: &Site<'_>,
        workspace: &mut Workspace<N, P>,
        rng: &mut R,
    ) {
        let Settings {
            channel, offset, ..
        } = &site.settings;
        let Some(last) = self.fix else {
            self.offset = OffsetBelief::prior(offset);
            workspace
                .field
                .look_up(&site.map, channel, &self.offset, scan);
            self.draw(1.0, site, &workspace.field, rng);
            let log_weights = &mut self.log_weights;
            let drawn = weights::normalise(log_weights, &mut workspace.weights);
            self.conclude(time_ms, drawn, site, workspace, rng);
            return;
        };
        let dt = seconds(time_ms.wrapping_sub(last.time_ms) as i32);
        // Two updates at one time are two looks at one place.
        let dt = if dt > 1e-3 { dt } else { 1e-3 };
        self.offset.drift(offset, dt);
        workspace
            .field
            .look_up(&site.map, channel, &self.offset, scan);
        self.predict(dt, site, workspace, rng);
        self.recovering_s += dt;
        let lattice = site.map.lattice();
        let [x, y, ..] = self.particles.columns();
        for ((weight, &x), &y) in workspace.weights.iter_mut().zip(x).zip(y) {
            *weight += workspace.field.at(lattice, [x, y]);
        }
        let log_weights = &mut self.log_weights;
        let mut weighed = weights::reweigh(log_weights, &mut workspace.weights);
        if let Some(Normalised { shift, log_sum, .. }) = weighed {
            let smoothing = dt * (1.0 / Self::PATIENCE_S);
            let smoothing = if smoothing < 1.0 { smoothing } else { 1.0 };
            // Against as many particles spread over the whole map.
            let evidence = shift + log_sum - ln(N as f32 * workspace.field.mean);
            self.trust += smoothing * (evidence.clamp(-20.0, 20.0) - self.trust);
        }
        let share = if weighed.is_none() {
            1.0
        } else if self.trust < Self::DOUBT {
            site.settings.recovery
        } else {
            0.0
        };
        if share > 0.0 {
            if weighed.is_some() {
                self.resample(site, workspace, rng);
            }
            self.redraw(share, site, workspace, rng);
            let log_weights = &mut self.log_weights;
            weighed = weights::normalise(log_weights, &mut workspace.weights);
        }
        self.conclude(time_ms, weighed, site, workspace, rng);
    }

    /// Draws a share of the particles from the match, because the evidence is against where they are.
    #[inline(never)]
    fn redraw<const P: usize, R: Rng + ?Sized>(
        &mut self,
        share: f32,
        site: &Site<'_>,
        workspace: &mut Workspace<N, P>,
        rng: &mut R,
    ) {
        self.draw(share, site, &workspace.field, rng);
        self.trust = 0.0;
        self.recovering_s = 0.0;
    }

    /// What the cloud says, whose weights are in the workspace if it has any; then resamples.
    fn conclude<const P: usize, R: Rng + ?Sized>(
        &mut self,
        time_ms: u32,
        weighed: Option<Normalised>,
        site: &Site<'_>,
        workspace: &mut Workspace<N, P>,
        rng: &mut R,
    ) {
        let Some(normalised) = weighed else {
            return;
        };
        let [x, y, vx, vy] = self.particles.columns();
        let weights = &workspace.weights;
        let field = &workspace.field;
        let lattice = site.map.lattice();
        // Particles that were just drawn have not been tried yet.
        if self.recovering_s > 0.0 {
            let opinions = weights
                .iter()
                .zip(x.iter().zip(y))
                .map(|(weight, (x, y))| (*weight, field.offset_at(lattice, [*x, *y])));
            self.offset.learn(field.precision, opinions);
        }

        let (position, velocity, covariance);
        if lattice.rows() == 1 {
            let [px, pvx] = estimate::mean(&[x, vx], weights);
            let [[variance]] = estimate::covariance(&[x], weights);
            position = [px, lattice.origin()[1]];
            velocity = [pvx, 0.0];
            covariance = [[variance, 0.0], [0.0; 2]];
        } else {
            let [px, py, pvx, pvy] = estimate::mean(&[x, y, vx, vy], weights);
            position = [px, py];
            velocity = [pvx, pvy];
            covariance = estimate::covariance(&[x, y], weights);
        }
        let mut fix = Fix {
            time_ms,
            state: State::Tracking,
            position,
            covariance,
            velocity,
            offset_db: self.offset.probability() * self.offset.mean_db,
            effective_sample_size: normalised.effective_sample_size,
        };
        fix.state = if self.recovering_s == 0.0 {
            State::Lost
        } else if fix.deviation() > site.settings.uncertain_m {
            State::Uncertain
        } else if self.recovering_s < Self::PATIENCE_S {
            State::Recovered
        } else {
            State::Tracking
        };
        self.fix = Some(fix);
        self.resample(site, workspace, rng);
    }

    /// Draws a share of the particles from the match: systematically over the points, uniformly within the cell of each.
    fn draw<const P: usize, R: Rng + ?Sized>(
        &mut self,
        share: f32,
        site: &Site<'_>,
        field: &Field<P>,
        rng: &mut R,
    ) {
        let prior = site.settings.motion.velocity_m_s * site.settings.motion.velocity_m_s;
        let count = ((share * N as f32) as usize).clamp(1, N);
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
            let place = Self::place_in_cell(point, site, rng);
            let velocity = spread.map(|spread| spread * normal(rng));
            self.particles
                .set(i, [place[0], place[1], velocity[0], velocity[1]]);
            let log_weight = if sum > 0.0 && site.walls.contain(place) {
                0.0
            } else {
                f32::NEG_INFINITY
            };
            if let Some(slot) = self.log_weights.get_mut(i) {
                *slot = log_weight;
            }
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

    /// Moves all particles by `dt` seconds, and marks in the weights of the workspace, as log-weights, those that would
    /// have to pass a wall.
    ///
    /// The velocity falls to v' = keep v + n, with normal n of variance `fresh`, and the place moves by the mean of both
    /// velocities. Given the move of a particle, which is sampled, its velocity is normal again (Kalman).
    fn predict<const P: usize, R: Rng + ?Sized>(
        &mut self,
        dt: f32,
        site: &Site<'_>,
        workspace: &mut Workspace<N, P>,
        rng: &mut R,
    ) {
        let Motion {
            agility, memory_s, ..
        } = site.settings.motion;
        let keep = exp(-dt / memory_s);
        // The second is the limit of the first, which cancels.
        let fresh = if keep < 0.999 {
            0.5 * agility * memory_s * (1.0 - keep * keep)
        } else {
            agility * dt
        };
        let half = 0.5 * dt * (1.0 + keep);
        let steps = self.velocity_variance.each_mut().map(|variance| {
            let square = half * half * *variance + 0.25 * dt * dt * fresh;
            let covariance = half * keep * *variance + 0.5 * dt * fresh;
            let gain = covariance / square;
            *variance = keep * keep * *variance + fresh - gain * covariance;
            Step {
                half,
                keep,
                deviation: sqrt(square),
                gain,
            }
        });
        let [along_x, along_y] = steps;
        let is_line = site.map.lattice().rows() == 1;
        let is_free = site.walls == Walls::None;
        let [x, y, vx, vy] = self.particles.columns_mut();
        let x = x.iter_mut().zip(vx);
        let y = y.iter_mut().zip(vy);
        for (((x, vx), (y, vy)), mark) in x.zip(y).zip(&mut workspace.weights) {
            let from = [*x, *y];
            along_x.take(x, vx, rng);
            if !is_line {
                along_y.take(y, vy, rng);
            }
            *mark = if is_free || site.walls.allow(from, [*x, *y]) {
                0.0
            } else {
                f32::NEG_INFINITY
            };
        }
    }

    #[inline(never)]
    fn resample<const P: usize, R: Rng + ?Sized>(
        &mut self,
        site: &Site<'_>,
        workspace: &mut Workspace<N, P>,
        rng: &mut R,
    ) {
        // On a line y is the same for all.
        let is_plane = site.map.lattice().rows() > 1;
        let wanted = [true, is_plane, true, is_plane];
        let weights = &mut workspace.weights;
        let ancestors = resample(Scheme::Systematic, weights, &mut self.log_weights, rng);
        for (column, wanted) in self.particles.columns_mut().into_iter().zip(wanted) {
            if wanted {
                ancestors.gather(column, weights);
            }
        }
        self.log_weights = [0.0; N];
        *weights = [1.0 / N as f32; N];
    }
}

/// A move along one axis.
#[derive(Clone, Copy)]
struct Step {
    half: f32,
    keep: f32,
    deviation: f32,
    gain: f32,
}

impl Step {
    #[inline(always)]
    fn take<R: Rng + ?Sized>(&self, place: &mut f32, velocity: &mut f32, rng: &mut R) {
        let step = self.deviation * normal(rng);
        *place += self.half * *velocity + step;
        *velocity = self.keep * *velocity + self.gain * step;
    }
}

impl<const N: usize, const B: usize> Default for Tracker<N, B> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
pub(crate) mod tests;
