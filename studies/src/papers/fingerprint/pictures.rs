//! One walk, as it was tracked.

use anyhow::Result;
use foxhunt::fingerprint::{
    RadioMap,
    tracker::{Config, Site},
};
use foxhunt_host::{
    experiment::{SAMPLES, SURVEYED, WALKED},
    picture::{self, Axis, Curve, Curves, Walks},
    walks::{Office, Walk, follow, of_simulated_packets, tunnel_map},
};
use foxhunt_simulation::{
    random::generator,
    tunnel::{Radio, Tunnel},
};

use super::windows::{NOISE, RATE, SPEED};
use crate::papers::study::Study;

/// Seconds between two places of a picture.
const EVERY: f64 = 0.5;

/// A walk through the simulated tunnel.
pub fn simulated(study: &Study) -> Result<()> {
    let mut rng = generator(study.seed ^ 0x77, 0);
    let site = Tunnel::default().draw(&mut rng);
    let radio = Radio::new(NOISE);
    let places: Vec<[f64; 2]> = (0..=80).map(|x| [f64::from(x), SURVEYED]).collect();
    let map = tunnel_map(&site.survey(&places, SAMPLES, &radio, &mut rng))?;
    let seconds = site.tunnel.length / SPEED;
    let path = |time: f64| [SPEED * time, WALKED];
    let packets = site.walk(path, seconds, RATE, &radio, &mut rng);
    let times = times(1.0, seconds);
    let tracked = Site::new(RadioMap::new(&map)?, of_simulated_packets())?;
    let found = follow(&tracked, &packets, &times, study.seed)?;
    let truth: Vec<[f64; 2]> = times.iter().map(|time| path(*time)).collect();
    let walks = Walks {
        title: "A simulated walk through a tunnel, tracked".into(),
        caption: format!(
            "{SPEED} m/s, four beacons heard {RATE} times a second each, noise of {NOISE} dB"
        ),
        map: [[0.0, 0.0], [site.tunnel.length, site.tunnel.width]],
        is_line: true,
        radios: site.tunnel.beacons.clone(),
        walks: vec![picture::Walk {
            name: "walk".into(),
            truth: at(&times, &truth),
            fixes: at(&times, &found),
            particles: Vec::new(),
        }],
    };
    study.save(&walks.svg()?, "fingerprint-walk-simulated")
}

/// A walk in the plane, and the errors on it.
pub fn measured(study: &Study, office: &Office, walk: &Walk) -> Result<()> {
    let name = walk.name.replace('_', " ");
    let (first, last) = (
        walk.packets[0].time,
        walk.packets[walk.packets.len() - 1].time,
    );
    let times = times(first + 2.0, last);
    let found = walk.follow(&walk.packets, &times, Config::DEFAULT, study.seed)?;
    let matched = walk.matched(&walk.packets, &times)?;
    let truth: Vec<[f64; 2]> = times.iter().map(|time| walk.truth_at(*time)).collect();
    let walks = Walks {
        title: "A measured walk in an office, tracked".into(),
        caption: format!(
            "{name}, {} receivers, the library's own settings",
            office.receivers.len()
        ),
        map: [[-0.25, -0.5], [20.75, 18.5]],
        is_line: false,
        radios: office.receivers.clone(),
        walks: vec![picture::Walk {
            name: name.clone(),
            truth: at(&times, &truth),
            fixes: at(&times, &found),
            particles: Vec::new(),
        }],
    };
    study.save(&walks.svg()?, "fingerprint-walk-measured")?;
    let curve = |name: &str, places: &[[f64; 2]]| Curve {
        name: name.into(),
        points: times
            .iter()
            .copied()
            .zip(walk.errors(&times, places))
            .collect(),
        ..Curve::default()
    };
    let errors = Curves {
        title: format!("Error over time, measured walk {name}"),
        horizontal: Axis::linear("seconds"),
        vertical: Axis::linear("error in m"),
        curves: vec![
            curve("tracker", &found),
            curve("match of the last 2 s, no memory", &matched),
        ],
    };
    study.save(&errors.svg()?, "fingerprint-errors-measured")
}

fn times(first: f64, last: f64) -> Vec<f64> {
    let steps = ((last - first) / EVERY) as u32;
    (0..=steps)
        .map(|step| first + EVERY * f64::from(step))
        .collect()
}

fn at(times: &[f64], places: &[[f64; 2]]) -> Vec<(f64, [f64; 2])> {
    times.iter().copied().zip(places.iter().copied()).collect()
}
