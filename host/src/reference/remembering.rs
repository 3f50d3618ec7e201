//! Tracking along a corridor on a map that is wrong: a particle filter whose particles each know how wrong it was where they were.

use rand::{Rng, RngExt};

use super::corridor::LineMap;
use foxhunt_simulation::{random::normal, tunnel::Packet};

/// How somebody walks, and how wrong the map is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Model {
    /// The corridor runs from zero to this, in metres; every place is as likely at first.
    pub length: f64,
    /// Standard deviation of the first velocity, in metres a second.
    pub velocity: f64,
    /// Variance that a velocity gains every second, in m^2/s^3.
    pub acceleration: f64,
    /// Standard deviation of the map's error, in dB.
    pub error: f64,
    /// Distance over which its correlation falls to 1 / e, in metres.
    pub error_length: f64,
    /// Standard deviation of a packet, in dB.
    pub noise: f64,
    /// Seconds of packets that make one update.
    pub window: f64,
}

/// Most beacons.
const BEACONS: usize = 8;

#[derive(Clone, Copy)]
struct Particle {
    place: f64,
    velocity: f64,
    /// By beacon, the mean and the variance of the error where it is.
    errors: [[f64; 2]; BEACONS],
}

/// Where somebody is at each of `times`, by the packets before it: the posterior mean, in metres.
///
/// The error of the map along a way is an Ornstein-Uhlenbeck process for each beacon; given the way of a particle it is found
/// by a Kalman filter. With enough particles this is exact, but for ways that come back.
pub fn follow(
    map: &LineMap,
    model: &Model,
    packets: &[Packet],
    times: &[f64],
    particles: usize,
    rng: &mut impl Rng,
) -> Vec<f64> {
    let fresh = [0.0, model.error * model.error];
    let mut cloud: Vec<Particle> = (0..particles)
        .map(|n| Particle {
            place: model.length * (n as f64 + rng.random::<f64>()) / particles as f64,
            velocity: model.velocity * normal(rng),
            errors: [fresh; BEACONS],
        })
        .collect();
    let mut found = Vec::new();
    let mut last = packets.first().map_or(0.0, |packet| packet.time);
    let mut rest = packets;
    for time in times {
        loop {
            let end = (last + model.window).min(*time);
            let step = end - last;
            if step <= 0.0 {
                break;
            }
            let (now, later) = rest.split_at(rest.partition_point(|packet| packet.time < end));
            rest = later;
            // To the middle of the window, and on to its end.
            advance(&mut cloud, model, 0.5 * step, rng);
            if !now.is_empty() {
                update(&mut cloud, map, model, now, rng);
            }
            advance(&mut cloud, model, 0.5 * step, rng);
            last = end;
        }
        let n = cloud.len() as f64;
        let mean = cloud.iter().map(|particle| particle.place).sum::<f64>() / n;
        found.push(mean);
    }
    found
}

fn advance(cloud: &mut [Particle], model: &Model, dt: f64, rng: &mut impl Rng) {
    let sigma = (model.acceleration * dt).sqrt();
    for particle in cloud {
        let change = sigma * normal(rng);
        let moved = dt * (particle.velocity + 0.5 * change);
        particle.velocity += change;
        particle.place += moved;
        let kept = (-moved.abs() / model.error_length).exp();
        for [mean, variance] in &mut particle.errors {
            *mean *= kept;
            let all = model.error * model.error;
            *variance = all - kept * kept * (all - *variance);
        }
    }
}

/// Weighs the particles by packets, and resamples.
fn update(
    cloud: &mut Vec<Particle>,
    map: &LineMap,
    model: &Model,
    packets: &[Packet],
    rng: &mut impl Rng,
) {
    let mut sums = vec![(0.0, 0.0); map.levels.first().map_or(0, Vec::len)];
    for packet in packets {
        sums[packet.beacon].0 += 1.0;
        sums[packet.beacon].1 += packet.level;
    }
    let weigh = |particle: &mut Particle| {
        if !(0.0..=model.length).contains(&particle.place) {
            return f64::NEG_INFINITY;
        }
        let mut sum = 0.0;
        for (beacon, (count, level)) in sums.iter().enumerate() {
            if *count > 0.0 {
                let noise = model.noise * model.noise / count;
                let [mean, variance] = &mut particle.errors[beacon];
                let all = *variance + noise;
                let innovation = level / count - map.at(particle.place, beacon)[0] - *mean;
                sum -= 0.5 * (innovation * innovation / all + all.ln());
                let gain = *variance / all;
                *mean += gain * innovation;
                *variance *= 1.0 - gain;
            }
        }
        sum
    };
    let logs: Vec<f64> = cloud.iter_mut().map(weigh).collect();
    let top = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if top == f64::NEG_INFINITY {
        return;
    }
    let weights: Vec<f64> = logs.iter().map(|log| (log - top).exp()).collect();
    let gap = weights.iter().sum::<f64>() / cloud.len() as f64;
    let mut next = rng.random::<f64>() * gap;
    let (mut sum, mut number) = (weights[0], 0);
    let mut chosen = Vec::with_capacity(cloud.len());
    for _ in 0..cloud.len() {
        while sum < next && number + 1 < weights.len() {
            number += 1;
            sum += weights[number];
        }
        chosen.push(cloud[number]);
        next += gap;
    }
    *cloud = chosen;
}

#[cfg(test)]
mod tests {
    use super::*;
    use foxhunt_simulation::random::generator;

    #[test]
    fn with_a_right_map_it_finds_who_stands() {
        let level = |x: f64, beacon: f64| [-40.0 - 1.5 * (x - beacon).abs(), 1.0];
        let map = LineMap {
            spacing: 1.0,
            levels: (0..=40)
                .map(|x| vec![level(f64::from(x), 0.0), level(f64::from(x), 40.0)])
                .collect(),
        };
        let model = Model {
            length: 40.0,
            velocity: 1.0,
            acceleration: 0.1,
            error: 0.1,
            error_length: 2.0,
            noise: 2.0,
            window: 0.5,
        };
        let mut rng = generator(4, 0);
        let mut packets = Vec::new();
        for step in 0..80 {
            for (beacon, at) in [0.0, 40.0].into_iter().enumerate() {
                packets.push(Packet {
                    time: 0.25 * f64::from(step),
                    beacon,
                    level: level(15.0, at)[0] + 2.0 * normal(&mut rng),
                });
            }
        }
        let found = follow(&map, &model, &packets, &[10.0, 20.0], 1000, &mut rng);
        assert!(found.iter().all(|x| (x - 15.0).abs() < 1.0), "{found:?}");
    }
}
