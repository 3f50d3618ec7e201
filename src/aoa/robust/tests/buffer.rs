//! Merging of bearings in the buffer.

use super::*;
use crate::aoa::core::{Buffer, Comparison};
use crate::aoa::robust::evidence::Lines;
use crate::math::wrap;

/// Information of all bearings at their source, in those of one reading.
fn worth<const B: usize>(evidence: &Evidence<B, PLAIN>, errors: &Errors) -> f32 {
    let terms = evidence.terms(errors);
    let precisions = terms.iter().map(Term::precision);
    SIGMA * SIGMA * precisions.sum::<f32>()
}

#[test]
fn readings_of_one_place_are_one_bearing() {
    let errors = Errors {
        correlation: Correlation {
            distance_m: 20.0,
            ..Correlation::DEFAULT
        },
        ..Errors::DEFAULT
    };
    let mut evidence = Evidence::<8, PLAIN>::EMPTY;
    for _ in 0..1000 {
        push(
            &mut evidence,
            towards([0.0, 0.0], SOURCE, 0.0, SIGMA),
            None,
            &errors,
        );
    }
    assert_eq!(
        (evidence.entries().len(), evidence.bearings.count()),
        (1, 1000)
    );
    // Nine tenths of the variance are common to all, the rest averages out.
    let exact = 1.0 / (0.9 + 0.1 / 1000.0);
    assert!((worth(&evidence, &errors) / exact - 1.0).abs() < 1e-3);
    // One that contradicts is not joined, and excludes the others.
    let reflected = towards([0.0, 0.0], [-500.0, 900.0], 0.0, SIGMA);
    assert!(push(&mut evidence, reflected, None, &errors).old.is_none());
    let terms = evidence.terms(&errors);
    let ends: Vec<bool> = terms.iter().map(Term::is_last_of_place).collect();
    assert_eq!(ends, [false, true]);
}

#[test]
fn bearings_with_errors_in_common_count_for_what_they_tell() {
    let errors = Errors {
        correlation: Correlation {
            distance_m: 20.0,
            ..Correlation::DEFAULT
        },
        ..Errors::DEFAULT
    };
    let mut evidence = Evidence::<2, PLAIN>::EMPTY;
    for east in [0.0, 20.0] {
        let far = [SOURCE[0] + east, SOURCE[1]];
        push(
            &mut evidence,
            towards([east, 0.0], far, 0.0, SIGMA),
            None,
            &errors,
        );
    }
    // The best estimate of what two equal ones with this correlation measure.
    let r = 0.9 * (-1.0_f32).exp();
    assert!((worth(&evidence, &errors) * (1.0 + r) / 2.0 - 1.0).abs() < 1e-3);
}

#[test]
fn an_error_of_a_stop_does_not_average_out() {
    let errors = Errors {
        stop_sigma_rad: 3.0 * SIGMA,
        correlation: Correlation::NONE,
        ..Errors::DEFAULT
    };
    for count in [1, 10, 500] {
        let mut evidence = Evidence::<8, PLAIN>::EMPTY;
        for _ in 0..count {
            let reading = towards([0.0, 0.0], SOURCE, 0.0, SIGMA);
            push(&mut evidence, reading, None, &errors);
        }
        let exact = 1.0 / (9.0 + 1.0 / count as f32);
        assert!((worth(&evidence, &errors) / exact - 1.0).abs() < 1e-3);
    }
}

#[test]
fn correlation_may_end_with_time() {
    let errors = Errors {
        correlation: Correlation {
            distance_m: 20.0,
            time_s: 2.0,
            ..Correlation::DEFAULT
        },
        ..Errors::DEFAULT
    };
    let of = |ms: u32| {
        let mut evidence = Evidence::<8, PLAIN>::EMPTY;
        for i in 0..100 {
            let observation = at(i * ms, &towards([0.0, 0.0], SOURCE, 0.0, SIGMA));
            evidence.push(Entry::new(observation, 1.0), &errors, false);
        }
        worth(&evidence, &errors)
    };
    // Of a part of 0.9 that is forgotten in 2 s, the mean over 99 s varies by 2 (x - 1 + e^-x) / x^2.
    let x = 99.0_f32 / 2.0;
    let exact = 1.0 / (0.9 * 2.0 * (x - 1.0) / (x * x) + 0.1 / 100.0);
    assert!((of(1000) / exact - 1.0).abs() < 1e-3);
    assert!(of(100_000) > 100.0);
}

#[test]
fn a_full_buffer_never_averages_what_disagrees() {
    let errors = independent();
    let mut evidence = Evidence::<4, PLAIN>::EMPTY;
    let source = SOURCE;
    let outlier = |east| towards([east, 0.0], [east, -900.0], 0.0, SIGMA);
    // Pairs that contradict each other, closer to each other than to the next pair: the likelier stays.
    for i in 0..6 {
        let east = 300.0 * i as f32;
        push(
            &mut evidence,
            towards([east, 0.0], SOURCE, 0.0, SIGMA),
            Some(source),
            &errors,
        );
        push(&mut evidence, outlier(east + 1.0), Some(source), &errors);
    }
    for o in evidence.bearings.observations() {
        let [x, y] = o.position();
        let error = wrap(o.bearing().radians() - (SOURCE[1] - y).atan2(SOURCE[0] - x));
        let stray = wrap(o.bearing().radians() + core::f32::consts::FRAC_PI_2);
        assert!(error.abs() < 1e-3 || stray.abs() < 1e-3, "{o:?}");
    }
    // A mirrored one says the same, once the source is known: together they are a direct one.
    let mut evidence = Evidence::<2, PLAIN>::EMPTY;
    let turned = towards([1.0, 0.0], SOURCE, core::f32::consts::PI, SIGMA);
    for o in [
        turned,
        towards([0.0, 0.0], SOURCE, 0.0, SIGMA),
        towards([900.0, 0.0], SOURCE, 0.0, SIGMA),
    ] {
        push(&mut evidence, o, Some(source), &errors);
    }
    let merged = evidence.bearings.observations().next().unwrap();
    assert!((merged.sigma_rad() * 2f32.sqrt() / SIGMA - 1.0).abs() < 1e-3);
    let expected = (SOURCE[1]).atan2(SOURCE[0] - merged.position()[0]);
    assert!(wrap(merged.bearing().radians() - expected).abs() < 1e-3);
}

#[test]
fn bearings_of_different_stations_are_never_merged() {
    let errors = Errors::DEFAULT;
    let mut evidence = Evidence::<4, PLAIN>::EMPTY;
    for i in 0..40_u8 {
        let east = 100.0 * f32::from(i / 8);
        let observation = towards([east, 0.0], SOURCE, 0.0, SIGMA).from_station(i % 3);
        push(&mut evidence, observation, None, &errors);
    }
    let stations: Vec<u8> = evidence
        .bearings
        .observations()
        .map(|o| o.station())
        .collect();
    assert_eq!(stations.len(), 4);
    assert!((0..3).all(|station| stations.contains(&station)));
    // With more stations than places, the bearing that was taken first goes.
    for i in 0..8 {
        let observation = towards([0.0, 0.0], SOURCE, 0.0, SIGMA).from_station(10 + i);
        push(&mut evidence, observation, None, &errors);
    }
    let mut stations: Vec<u8> = evidence
        .bearings
        .observations()
        .map(|o| o.station())
        .collect();
    stations.sort_unstable();
    assert_eq!(stations, [14, 15, 16, 17]);
}

#[test]
fn a_late_bearing_is_joined_with_the_readings_of_its_time() {
    let correlation = Correlation {
        time_s: 2.0,
        distance_m: 20.0,
        ..Correlation::DEFAULT
    };
    let errors = Errors {
        correlation,
        ..Errors::DEFAULT
    };
    let worth = |times: [u32; 3]| {
        let mut evidence = Evidence::<8, PLAIN>::EMPTY;
        for time_ms in times {
            let observation = at(time_ms, &towards([0.0, 0.0], SOURCE, 0.0, SIGMA));
            evidence.push(Entry::new(observation, 1.0), &errors, false);
        }
        assert_eq!(evidence.bearings.latest().unwrap().time_ms(), 60_000);
        worth(&evidence, &errors)
    };
    // A second before the first of them, or within their span, rather than a minute after.
    assert_eq!(worth([1_000, 60_000, 0]), worth([0, 1_000, 60_000]));
    assert_eq!(worth([0, 60_000, 30_000]), worth([0, 30_000, 60_000]));
}

#[test]
fn a_correlation_and_a_range_are_checked() {
    let field = |errors| with(errors).check().map_err(|error| error.field());
    let errors = Errors::DEFAULT;
    let correlation = |at_rest, distance_m, time_s| {
        let correlation = Correlation {
            at_rest,
            distance_m,
            time_s,
            ..Correlation::NONE
        };
        field(Errors {
            correlation,
            ..errors
        })
    };
    assert_eq!(correlation(1.0, 1.0, 1.0), Err("at_rest"));
    assert_eq!(correlation(0.5, f32::INFINITY, 1.0), Err("distance_m"));
    assert_eq!(correlation(0.5, 1.0, 0.0), Err("time_s"));
    let range = |range_m| Config {
        range_m,
        ..Config::DEFAULT
    };
    assert_eq!(range(0.0).check().unwrap_err().field(), "range_m");
    assert!(range(10.0).check().is_ok());
}

/// Of more bearings than there is room for, those at the beginning make it; the last ones stay as they are.
#[test]
fn bearings_that_are_handed_on_become_one_from_the_first_on() {
    let entries: Vec<Entry> = (0..6)
        .map(|step| {
            let position = [300.0 * step as f32, 0.0];
            Entry::new(towards(position, SOURCE, 0.0, SIGMA), 1.0)
        })
        .collect();
    let lines = Lines {
        source: Some(SOURCE),
        extent_m: 0.0,
        errors: Errors::DEFAULT,
        of_several: false,
    };
    let mut buffer = Buffer::<4>::EMPTY;
    buffer.adopt(entries.iter(), None, &lines);
    let readings: Vec<f32> = buffer
        .entries()
        .iter()
        .map(|entry| entry.readings)
        .collect();
    assert_eq!(readings, [2.0, 2.0, 1.0, 1.0]);
    assert_eq!(buffer.count(), 6);
}

/// Of several sources, readings beyond the first are at stake, and the more readings the better; of one, the sharper bearing.
#[test]
fn what_is_merged_depends_on_how_many_sources_there_may_be() {
    let entry = |readings: f32, sigma: f32| {
        let seen = towards([0.0, 0.0], SOURCE, 0.0, sigma);
        Entry {
            readings,
            ..Entry::new(seen, 1.0)
        }
    };
    let [many, few] = [entry(8.0, 2.0 * SIGMA), entry(3.0, SIGMA)];
    let lines = |of_several| Evidence::<8, PLAIN>::EMPTY.lines(&Errors::DEFAULT, of_several);
    let (several, one) = (lines(true), lines(false));
    assert_eq!(several.stake(&many, &few), 2.0 / 8.0);
    assert_eq!(several.stake(&few, &many), 2.0 / 8.0);
    assert_eq!(one.stake(&many, &few), 0.0);
    assert!(several.prefers(&many, &few) && !several.prefers(&few, &many));
    assert!(one.prefers(&few, &many) && !one.prefers(&many, &few));
    assert!(several.prefers(&many, &many) && one.prefers(&many, &many));
}
