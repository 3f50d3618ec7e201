//! The gateway of a vehicle.

use core::hint::black_box;

use foxhunt::{
    aoa::{Bearing, Clean, Locate, Robust, clean, robust, spectrum::Spectrum},
    gateway::{
        BearingReference, Config, FullReport, ReportForm, ShortReport, SigmaTable, Vehicle,
        formats::{self, Agrelo, All, Formats, Kraken, Nmea, Ublox},
    },
    model::Likelihood,
    snapshot::Persist,
};

use crate::values::{any, some, some_mut};

pub fn gateway() {
    let knots = any([(0.0, 0.0); 10]);
    if let Ok(table) = SigmaTable::new(some(&knots)) {
        black_box(table.sigma_rad(any(0.0)));
    }
    drive::<Clean<50, 16>, All, ShortReport, 2>(clean::Config::DEFAULT);
    drive::<Robust<50, 16>, (Nmea, Agrelo, Kraken<Spectrum>), FullReport, 1>(
        robust::Config::DEFAULT,
    );
    drive::<Clean<50, 16>, (Kraken, Ublox), FullReport, 1>(clean::Config::DEFAULT);
    spectrum();
}

fn config<C>(locator: C) -> Config<C> {
    Config {
        formats: any(formats::Config::DEFAULT),
        reference: any(BearingReference::Relative),
        station: any(None),
        seed: any(0),
        min_quality: any(0.0),
        best_sigma_rad: any(0.0),
        worst_sigma_rad: any(0.0),
        max_age_ms: any(0),
        undated_bearings: any(0),
        min_speed_m_s: any(0.0),
        max_turn_rate_deg_s: any(0.0),
        max_speed_m_s: any(0.0),
        variation_deg: any(None),
        report_interval_ms: any(0),
        ..Config::new(locator)
    }
}

fn drive<L: Locate + Persist, F: Formats, R: ReportForm, const PORTS: usize>(locator: L::Config) {
    let config = config(any(locator));
    if config.check().is_err() {
        return;
    }
    let mut vehicle = any(Vehicle::<L, F, R, PORTS>::EMPTY);
    for _ in 0..any(100) {
        black_box(vehicle.push(any(0), any(0), &config));
        black_box((
            vehicle.report(),
            vehicle.line(any(0)),
            vehicle.counters(),
            vehicle.plane(),
            vehicle.receiver(),
            vehicle.locator().answer(),
        ));
        let mut buffer = any([0; 2000]);
        _ = black_box(vehicle.snapshot(some_mut(&mut buffer)));
        _ = black_box(vehicle.restore(some(&any(buffer))));
    }
    vehicle.restart();
}

fn spectrum() {
    let temper = any(0.0);
    let mut spectrum = any(Spectrum::new());
    for _ in 0..any(100) {
        _ = black_box(spectrum.push(any(0.0)));
    }
    black_box(spectrum.peaks(temper));
    black_box(spectrum.log_likelihood(any(0.0), temper));
    let axis = Bearing::from_radians(any(0.0));
    let likelihood = spectrum.likelihood(any([0.0; 2]), axis, temper);
    let mut out = any([0.0; 50]);
    let [x, y] = any([[0.0; 50]; 2]);
    likelihood.log_likelihoods(&[some(&x), some(&y)], some_mut(&mut out));
    black_box((likelihood.log_likelihood(&any([0.0; 2])), out));
    spectrum.clear();
}
