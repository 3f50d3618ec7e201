//! What an update does: predict, weigh, judge, summarise, resample.

use super::cloud::{Moments, Sample, Sums};
use super::comparison::{Comparison, error_variance, packet_variance};
use super::field::Field;
use super::fix::seconds;
use super::memory::Memory;
use super::motion::{Noise, Step};
use super::offset::OffsetBelief;
use super::pending::Level;
use super::stored::{Grain, Stored};
use super::{Fix, Floor, Ground, State, Tracker, Walls, Workspace};
use crate::estimate::Symmetric2;
use crate::fingerprint::map::LOWEST_MEAN_DBM;
use crate::math::{exp, larger, ln, smaller, sqrt};
use crate::random::{Rng, normal, uniform};

/// Seconds over which the evidence is smoothed: fewer take a few bad scans for a lost tag, more leave a lost tag lost for
/// longer.
const EVIDENCE_S: f32 = 6.0;
/// The smoothed evidence below which particles are drawn anew. Higher draws clouds anew that were right; without any, one
/// walk in a thousand is lost for good.
const LOST_BELOW: f32 = -0.7;

/// How far beyond the gate, in variances, a reading is no longer kept for those after it: it is an outlier, not an error of
/// the map.
const OUTLIER: f32 = 1.5;

impl<const N: usize, const B: usize, const D: usize, S: Stored> Tracker<N, B, D, S> {
    #[inline(never)]
    pub(super) fn update<const P: usize, G: Ground<Floor = S::Floor>, R: Rng + ?Sized>(
        &mut self,
        time_ms: u32,
        scan: &[Level; B],
        site: &G,
        workspace: &mut Workspace<N, P, S::Floor>,
        rng: &mut R,
    ) {
        let (config, lattice) = (site.config(), site.lattice());
        let grain = Grain::of(lattice, config);
        let sums = if let Some(last) = self.fix() {
            let dt = seconds(time_ms.wrapping_sub(last.time_ms) as i32);
            // Two updates at one time are two looks at one place.
            let dt = larger(dt, 1e-3);
            self.offset.drift(config, dt);
            let moved_m = self.predict(dt, site, &grain, workspace, rng);
            let length_m = site.map(self.floor.number()).error_length_m();
            self.memory.fade(dt, moved_m, length_m, config);
            let evidence = self.compare(time_ms, scan, &last, moved_m / dt, site, workspace);
            self.exclude_walls(site, &grain, workspace);
            if let Some(redrawn_s) = &mut self.redrawn_s {
                *redrawn_s += dt;
            }
            let sums = workspace.cloud.weigh();
            if sums.is_some() && self.is_right(evidence, dt, site, &workspace.field) {
                sums
            } else {
                self.start_again(sums, scan, site, workspace, rng)
            }
        } else {
            self.offset = OffsetBelief::prior(config);
            self.memory = Memory::EMPTY;
            self.match_all(scan, site, workspace);
            self.draw(1.0, site, workspace, rng)
        };
        if let Some(sums) = sums {
            self.teach(&sums, site, workspace);
            self.conclude(time_ms, &sums, site, workspace);
            self.remember(scan, site);
            (workspace.cloud).resample(sums.weights, &mut self.particles, &grain, rng);
        }
    }

    /// Compares a scan with the map where the particles are, which move at this speed, and returns how likely it is there,
    /// relative to the best point.
    #[inline(never)]
    fn compare<const P: usize, G: Ground<Floor = S::Floor>>(
        &self,
        time_ms: u32,
        scan: &[Level; B],
        last: &Fix,
        speed_m_s: f32,
        site: &G,
        workspace: &mut Workspace<N, P, S::Floor>,
    ) -> f32 {
        let (config, lattice) = (site.config(), site.lattice());
        let Workspace { field, cloud } = workspace;
        let age_s = self.memory.age_s;
        let velocity = lattice.along_axes(last.velocity.map(|v| v * lattice.per_metre()));
        let moved = velocity.map(|v| age_s * v);
        cloud.find_cells(lattice);
        field.begin();
        field.mark(&cloud.cells);
        let mut sample = Sample::EMPTY;
        for floor in 0..site.floors() {
            let map = site.map(floor);
            let memory = Some(&self.memory);
            let compared = Comparison::new(map, config, &self.offset, memory, scan);
            field.look_up_marked(floor, lattice, &compared, moved);
            // What is remembered of the error would explain any place that has been wrong for long.
            let anew = Comparison::new(map, config, &self.offset, None, scan);
            field.sample(map, &anew, time_ms);
            cloud.sample(Floor::of(floor), &anew, lattice, time_ms, &mut sample);
        }
        // Slopes are taken over a step: they say little of who moved further.
        let steps = age_s * speed_m_s * lattice.per_metre();
        let far = 1.0 + steps * steps;
        cloud.look_up(field, lattice, age_s / (far * far), velocity);
        sample.mean(field.top())
    }

    /// Compares a scan with all points of the map, by nothing that is remembered.
    #[inline(never)]
    fn match_all<const P: usize, G: Ground>(
        &self,
        scan: &[Level; B],
        site: &G,
        workspace: &mut Workspace<N, P, S::Floor>,
    ) {
        workspace.field.begin();
        for floor in 0..site.floors() {
            let map = site.map(floor);
            let anew = Comparison::new(map, site.config(), &self.offset, None, scan);
            workspace.field.look_up_all(floor, map, &anew);
        }
    }

    /// Draws a fraction of the particles anew, or all if none is possible.
    fn start_again<const P: usize, G: Ground<Floor = S::Floor>, R: Rng + ?Sized>(
        &mut self,
        sums: Option<Sums>,
        scan: &[Level; B],
        site: &G,
        workspace: &mut Workspace<N, P, S::Floor>,
        rng: &mut R,
    ) -> Option<Sums> {
        let config = site.config();
        let grain = Grain::of(site.lattice(), config);
        if let Some(sums) = sums {
            (workspace.cloud).resample(sums.weights, &mut self.particles, &grain, rng);
            workspace.cloud.unpack(&self.particles, &grain);
        }
        let fraction = sums.map_or(1.0, |_| config.redraw_fraction);
        self.evidence = 0.0;
        self.redrawn_s = Some(0.0);
        self.memory = Memory::EMPTY;
        self.match_all(scan, site, workspace);
        self.draw(fraction, site, workspace, rng)
    }

    /// Keeps a scan for those that will be heard nearby, except what is an outlier where the tag is.
    fn remember<G: Ground>(&mut self, scan: &[Level; B], site: &G) {
        let (map, config) = (site.map(self.floor.number()), site.config());
        let lattice = map.lattice();
        let point = lattice.nearest(self.fix.position);
        let packet = packet_variance(map);
        let mismatch = 4.0 * config.mismatch_sigma_db * config.mismatch_sigma_db;
        let offset = self.fix.offset_db;
        let gate = OUTLIER * config.gate_sigmas * config.gate_sigmas;
        self.memory.learn(scan, |beacon, level| {
            let [sigma, mean] = *map.moments_row(beacon)?.get(point)?;
            let error = error_variance(sigma) + mismatch;
            let noise = packet / f32::from(level.packets);
            let above = 2.0 * (level.mean_dbm - offset - LOWEST_MEAN_DBM) - f32::from(mean);
            (above * above < gate * (error + noise)).then_some(noise / error)
        });
    }

    /// Unpacks all particles, moved by `dt` seconds, and returns by how many metres they moved: the root mean square.
    #[inline(never)]
    pub(super) fn predict<const P: usize, G: Ground<Floor = S::Floor>, R: Rng + ?Sized>(
        &mut self,
        dt: f32,
        site: &G,
        grain: &Grain,
        workspace: &mut Workspace<N, P, S::Floor>,
        rng: &mut R,
    ) -> f32 {
        let lattice = site.lattice();
        let scale = lattice.per_metre();
        let [first, second] = &mut self.velocity_variance;
        let first = Step::of(dt, first, site.config(), scale);
        let cloud = &mut workspace.cloud;
        let squares = if lattice.is_plane() {
            let second = Step::of(dt, second, site.config(), scale);
            let [x, y] = Noise::in_plane(rng);
            let along = cloud.advance::<0, S>(&self.particles, grain, &first, x);
            let across = cloud.advance::<1, S>(&self.particles, grain, &second, y);
            along + across
        } else {
            let noise = Noise::on_line(rng);
            cloud.advance::<0, S>(&self.particles, grain, &first, noise)
        };
        cloud.take_floors(&self.particles);
        site.change_floors(&cloud.places, &mut cloud.floors, dt, rng);
        lattice.spacing() * sqrt(squares)
    }

    /// Makes the places impossible that lie behind a wall.
    pub(super) fn exclude_walls<const P: usize, G: Ground<Floor = S::Floor>>(
        &self,
        site: &G,
        grain: &Grain,
        workspace: &mut Workspace<N, P, S::Floor>,
    ) {
        let lattice = site.lattice();
        let floors = 0..site.floors();
        if !floors.clone().all(|floor| site.map(floor).is_complete()) {
            workspace.cloud.exclude(lattice, |floor, point| {
                site.map(floor.number()).is_possible(point)
            });
        }
        if floors
            .clone()
            .all(|floor| *site.walls(floor) == Walls::None)
        {
            return;
        }
        let cloud = &mut workspace.cloud;
        let [x, y] = &cloud.places;
        let places = x.iter().zip(y).zip(&cloud.floors);
        let to = cloud.weights.iter_mut().zip(places);
        for (particle, (weight, ((x, y), floor))) in self.particles.iter().zip(to) {
            let from = [particle.place::<0>(grain), particle.place::<1>(grain)];
            let [from, to] = [from, [*x, *y]].map(|steps| lattice.place_of(steps));
            if !site.walls(floor.number()).allow(from, to) {
                *weight = f32::NEG_INFINITY;
            }
        }
    }

    /// Smooths the evidence, which is how likely the scan is at the particles, against as many spread over the whole map; returns
    /// whether it supports the particles.
    fn is_right<const P: usize, G: Ground<Floor = S::Floor>>(
        &mut self,
        evidence: f32,
        dt: f32,
        site: &G,
        field: &Field<P>,
    ) -> bool {
        let smoothing = dt * (1.0 / EVIDENCE_S);
        let smoothing = smaller(smoothing, 1.0);
        let evidence = ln(evidence / field.mean());
        // Of nothing, the logarithm is none.
        let evidence = if evidence.is_finite() {
            evidence
        } else {
            -20.0
        };
        self.evidence += smoothing * (evidence.clamp(-20.0, 20.0) - self.evidence);
        !(self.evidence < LOST_BELOW && site.config().redraw_fraction > 0.0)
    }

    /// Learns the tag's offset from the weighted cloud.
    fn teach<const P: usize, G: Ground<Floor = S::Floor>>(
        &mut self,
        sums: &Sums,
        site: &G,
        workspace: &mut Workspace<N, P, S::Floor>,
    ) {
        let Workspace { field, cloud } = workspace;
        // Particles that were just drawn have not been tried yet.
        if self.redrawn_s != Some(0.0) {
            field.teach(
                &mut self.offset,
                site.lattice(),
                (&cloud.places, &cloud.floors, &cloud.weights),
                site.points(),
                sums.weights,
            );
        }
    }

    /// Summarises the weighted cloud.
    pub(super) fn conclude<const P: usize, G: Ground<Floor = S::Floor>>(
        &mut self,
        time_ms: u32,
        sums: &Sums,
        site: &G,
        workspace: &Workspace<N, P, S::Floor>,
    ) {
        let lattice = site.lattice();
        let cloud = &workspace.cloud;
        let (floor, weights) = cloud.likeliest(site.floors(), sums.weights);
        if floor != self.floor {
            // What is remembered of the error is that of another map.
            (self.floor, self.memory) = (floor, Memory::EMPTY);
        }
        let Moments {
            place,
            velocity,
            covariance,
        } = cloud.moments(lattice.is_plane(), floor, weights);
        let step = lattice.spacing();
        let Symmetric2 { xx, xy, yy } = covariance.scaled(step * step);
        let [xx, yy] = lattice.along_axes([xx, yy]);
        let position = lattice.place_of(place);
        self.follow(time_ms, position, site.config().error_memory_s);
        let look_m = site.map(floor.number()).rest_error_m();
        let variance = (xx + yy) / lattice.axes() as f32;
        self.widening = self.widening_at(position, variance, look_m * look_m / (xx + yy));
        self.fix = Fix {
            time_ms,
            state: State::Tracking,
            position,
            covariance: Symmetric2 { xx, xy, yy }.scaled(self.widening),
            velocity: lattice.along_axes(velocity.map(|velocity| step * velocity)),
            offset_db: self.offset.probability() * self.offset.mean_db,
            effective_sample_size: sums.weights * sums.weights / sums.squares,
        };
        self.fix.state = match self.redrawn_s {
            Some(0.0) => State::Lost,
            _ if self.fix.sigma_m() > site.config().uncertain_sigma_m => State::Uncertain,
            Some(seconds) if seconds < EVIDENCE_S => State::Recovered,
            _ => State::Tracking,
        };
        self.has_fix = true;
    }

    /// Lets the mean place of the last seconds follow that of the tag: of those from which it remembers the error of the map.
    fn follow(&mut self, time_ms: u32, place: [f32; 2], memory_s: f32) {
        match self.fix() {
            Some(last) if self.redrawn_s != Some(0.0) => {
                let dt = seconds(time_ms.wrapping_sub(last.time_ms) as i32);
                let fraction = 1.0 - exp(-dt / memory_s);
                for (rest, place) in self.rest.iter_mut().zip(place) {
                    *rest += fraction * (place - *rest);
                }
            }
            _ => self.rest = place,
        }
    }

    /// By how much the covariance of the particles is too small, whose variance along an axis is this.
    ///
    /// Particles hold that the error of the map changes as they move; a tag at rest keeps it, and however long it rests, it is
    /// known no better than by one look without noise. That has `excess` times the variance of the particles. The tag is at
    /// rest as far as the mean of its last places is one that it may have now.
    fn widening_at(&self, place: [f32; 2], variance: f32, excess: f32) -> f32 {
        let [dx, dy] = [place[0] - self.rest[0], place[1] - self.rest[1]];
        let squared = (dx * dx + dy * dy) / variance;
        // Particles that are all at one place have no variance.
        if excess > 1.0 && excess.is_finite() {
            1.0 + (excess - 1.0) * exp(-0.5 * squared)
        } else {
            1.0
        }
    }

    /// Draws a fraction of the particles from the match: systematically over the points, uniformly within the cell of each.
    #[inline(never)]
    fn draw<const P: usize, G: Ground<Floor = S::Floor>, R: Rng + ?Sized>(
        &mut self,
        fraction: f32,
        site: &G,
        workspace: &mut Workspace<N, P, S::Floor>,
        rng: &mut R,
    ) -> Option<Sums> {
        let Workspace { field, cloud } = workspace;
        let sigma = site.config().velocity_sigma_m_s;
        let prior = sigma * sigma;
        let count = ((fraction * N as f32) as usize).clamp(1, N);
        if count == N {
            self.velocity_variance = [prior; 2];
        }
        let lattice = site.lattice();
        // What the common variance lacks is drawn.
        let spread = self.velocity_variance.map(|variance| {
            lattice.per_metre()
                * sqrt(if variance < prior {
                    prior - variance
                } else {
                    0.0
                })
        });
        let mut likelihoods = field.likelihoods(site.points()).enumerate();
        let gap = field.mean() * site.points() as f32 / count as f32;
        let mut next = uniform(rng) * gap;
        let (mut point, mut sum) = (0, 0.0);
        let stride = N.checked_div(count).unwrap_or(1).max(1);
        let ([x, y], [vx, vy]) = (cloud.places.each_mut(), cloud.velocities.each_mut());
        let columns = x.iter_mut().zip(y).zip(vx.iter_mut().zip(vy));
        let columns = columns.zip(&mut cloud.floors);
        let particles = cloud.weights.iter_mut().zip(columns);
        for (weight, (((x, y), (vx, vy)), floor)) in particles.step_by(stride).take(count) {
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
            let (number, steps) = steps_in_cell(point, site, rng);
            let is_possible = sum > 0.0 && site.walls(number).contain(lattice.place(steps));
            *floor = Floor::of(number);
            [*x, *y] = lattice.along_axes(steps);
            [*vx, *vy] = spread.map(|spread| spread * normal(rng));
            *weight = if is_possible { 1.0 } else { 0.0 };
        }
        let weights = cloud.weights.iter().sum();
        // Each is 0 or 1.
        (weights > 0.0).then_some(Sums {
            weights,
            squares: weights,
        })
    }
}

/// A place in the cell of a point, in steps, within the walls if that takes no more than four tries; and its floor. Points are
/// counted through all floors.
fn steps_in_cell<G: Ground, R: Rng + ?Sized>(
    number: usize,
    site: &G,
    rng: &mut R,
) -> (u8, [f32; 2]) {
    let lattice = site.lattice();
    let mut point = number;
    let mut floor = 0;
    while point >= lattice.points() && floor + 1 < site.floors() {
        point -= lattice.points();
        floor += 1;
    }
    let mut steps = [0.0; 2];
    for _ in 0..4 {
        steps = lattice.in_cell(point, [uniform(rng), uniform(rng)]);
        if site.walls(floor).contain(lattice.place(steps)) {
            break;
        }
    }
    (floor, steps)
}
