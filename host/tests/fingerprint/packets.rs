//! Single packets, which weigh particles.

use foxhunt::{
    fingerprint::{Config, Encoding, PacketModel, RadioMap, Reading, ReadingError},
    model::Likelihood,
};
use foxhunt_host::radio_map::{self, Options, SiteSurvey};

use crate::site::*;

/// Bilinear interpolation in f64.
fn interpolated(map: &RadioMap, beacon: usize, place: [f64; 2]) -> [f64; 2] {
    let lattice = map.lattice();
    let cell = |axis: usize, points: usize| {
        let u = (place[axis] - f64::from(lattice.origin()[axis])) / f64::from(lattice.spacing());
        let u = u.clamp(0.0, (points - 1) as f64);
        let before = (u as usize).min(points.saturating_sub(2));
        (before, u - before as f64)
    };
    let (column, right) = cell(0, lattice.columns());
    let (row, up) = cell(1, lattice.rows());
    let mut sums = [0.0; 2];
    for (dy, wy) in [(0, 1.0 - up), (1, up)] {
        for (dx, wx) in [(0, 1.0 - right), (1, right)] {
            if wx * wy > 0.0 {
                let point = (row + dy) * lattice.columns() + column + dx;
                let m = map.moments(beacon, point).unwrap();
                sums[0] += wx * wy * f64::from(m.mean_dbm);
                sums[1] += wx * wy * f64::from(m.sigma_db);
            }
        }
    }
    sums
}

#[test]
fn packets_weigh_particles_by_the_interpolated_map() {
    let model = PacketModel::new(&Config::DEFAULT).unwrap();
    let turned = {
        // The tunnel along y: one column.
        let survey = SiteSurvey::new(line().into_iter().flat_map(|[y, x]| {
            (0..BEACONS * EACH).map(move |i| radio_map::Reading {
                x,
                y,
                beacon: (i / EACH) as u32,
                rssi: f64::from(sample(i / EACH, [y, x], i % EACH)),
            })
        }));
        let lattice = survey.lattice(1.0).unwrap();
        survey
            .radio_map(&lattice, Encoding::Moments, &Options::default())
            .unwrap()
    };
    for bytes in [tunnel(Encoding::Moments), hall_map(), turned] {
        let map = RadioMap::new(&bytes).unwrap();
        let (mut x, mut y) = (vec![], vec![]);
        for i in 0..2000 {
            // All over the map, and beyond it.
            let [u, v] = [0.618_034, 0.754_878].map(|step: f64| (step * f64::from(i)).fract());
            let lattice = map.lattice();
            let reach = |n: usize| (n as f32 - 1.0) * lattice.spacing();
            let [x0, y0] = lattice.origin();
            x.push(x0 + (1.2 * u as f32 - 0.1) * reach(lattice.columns()));
            y.push(y0 + (1.2 * v as f32 - 0.1) * reach(lattice.rows()));
        }
        // The points themselves, too.
        for point in 0..map.lattice().points() {
            let [px, py] = map.lattice().position(point);
            x.push(px);
            y.push(py);
        }
        let mut out = vec![0.0; x.len()];
        for (beacon, rssi_dbm, offset) in [(0, -55.0, 0.0), (1, -70.0, 10.0), (3, -62.0, -3.25)] {
            let packet = Reading { beacon, rssi_dbm };
            let likelihood = map.packet_likelihood(packet, offset, &model).unwrap();
            likelihood.log_likelihoods(&[&x, &y], &mut out);
            let of_four = map.packet_likelihood(packet, offset, &model).unwrap();
            for (i, got) in out.iter().enumerate() {
                let one = of_four.log_likelihood(&[x[i], y[i], 0.0, 0.0]);
                assert_eq!(one, *got);
                let place = [x[i], y[i]].map(f64::from);
                let [mean, sigma] = interpolated(&map, beacon.into(), place);
                let distance = f64::from(rssi_dbm) - f64::from(offset) - mean;
                let of = |sigma: f64| {
                    let density = 0.999 * normal_density(distance, sigma.hypot(4.0));
                    0.5 * density.max(1e-3 / 120.0).ln()
                };
                // The place is rounded to a 256th of the spacing, the sigma to a quarter of a dB.
                let slope = if i < 2000 { 0.02 } else { 2e-5 } * (1.0 + distance.abs() / 8.0);
                let (low, high) = (of((sigma - 0.13).max(0.0)), of(sigma + 0.13));
                let (low, high) = (low.min(high), low.max(high));
                assert!(
                    (low.min(of(sigma)) - slope..=high.max(of(sigma)) + slope)
                        .contains(&f64::from(*got)),
                    "{place:?} {got} {low} {high}"
                );
            }
        }
        for nowhere in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30] {
            let packet = Reading {
                beacon: 0,
                rssi_dbm: -60.0,
            };
            let likelihood = map.packet_likelihood(packet, 0.0, &model).unwrap();
            likelihood.log_likelihoods(&[&[nowhere; 3], &[0.0, nowhere, 1.0]], &mut out[..3]);
            assert!(out[..3].iter().all(|l| l.is_finite()));
        }
    }
}

#[test]
fn packets_that_say_nothing_are_refused() {
    let (moments, levels) = (tunnel(Encoding::Moments), tunnel(Encoding::Levels));
    let (moments, levels) = (
        RadioMap::new(&moments).unwrap(),
        RadioMap::new(&levels).unwrap(),
    );
    let model = PacketModel::new(&UNTEMPERED).unwrap();
    let refusal = |map: RadioMap, beacon, rssi_dbm, offset| {
        let packet = Reading { beacon, rssi_dbm };
        map.packet_likelihood::<2>(packet, offset, &model).err()
    };
    let (beacon, strength) = (Some(ReadingError::Beacon), Some(ReadingError::Strength));
    assert_eq!(refusal(moments, 0, -60.0, 0.0), None);
    assert_eq!(refusal(levels, 0, -60.0, 0.0), beacon);
    assert_eq!(refusal(moments, 4, -60.0, 0.0), beacon);
    for rssi_dbm in [42.0, f32::NAN] {
        assert_eq!(refusal(moments, 0, rssi_dbm, 0.0), strength);
    }
    assert_eq!(refusal(moments, 0, -60.0, f32::NAN), strength);
}
