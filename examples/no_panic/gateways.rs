//! The gateway of a vehicle.

use core::hint::black_box;

use foxhunt::{
    aoa::{
        Bearing,
        locator::{self, Locator},
        robust::{self, RobustLocator},
        spectrum::{Spectrum, SpectrumLikelihood, Temper},
    },
    gateway::{
        self, BearingReference, DeviationTable, Finder, KrakenConfidence, LONG_REPORT, Sense,
        SpectrumReader, UbloxQuality, Vehicle,
    },
    model::Likelihood,
};

use crate::values::{any, some, some_mut};

pub fn gateway() {
    let settings = gateway::Settings::new()
        .with_reference(any(BearingReference::Relative))
        .with_seed(any(0))
        .with_undated_bearings(any(0))
        .with_sense(any(Sense::Clockwise))
        .with_kraken_confidence(any(KrakenConfidence::Percent))
        .with_ublox_quality(any(UbloxQuality::Best))
        .with_deviation_table(any(Finder::Any), any(&DeviationTable::AGRELO))
        .with_deviations(any(0.0), any(0.0))
        .and_then(|settings| settings.with_minimum_quality(any(0.0)))
        .and_then(|settings| settings.with_kraken_frequency_hz(any(0)))
        .and_then(|settings| settings.with_maximum_age_ms(any(0)))
        .and_then(|settings| settings.with_minimum_speed_m_s(any(0.0)))
        .and_then(|settings| settings.with_report_interval_ms(any(0)));
    let Ok(settings) = settings else { return };
    let knots = any([(0.0, 0.0); 10]);
    if let Ok(table) = DeviationTable::new(some(&knots)) {
        black_box(table.deviation_rad(any(0.0)));
    }
    let mut vehicle = any(Vehicle::<Locator<50, 16>>::new(
        settings,
        any(Locator::new(locator::Settings::new())),
    ));
    for _ in 0..any(100) {
        black_box(vehicle.push(any(0)));
        black_box((
            vehicle.report(),
            vehicle.counters(),
            vehicle.plane(),
            vehicle.locator(),
        ));
        let mut buffer = any([0; 2000]);
        _ = black_box(vehicle.snapshot(some_mut(&mut buffer)));
        _ = black_box(vehicle.restore(some(&any(buffer))));
    }
    vehicle.restart();
    spectrum(settings);
}

fn spectrum(settings: gateway::Settings) {
    let Ok(temper) = Temper::new(any(0.0)) else {
        return;
    };
    let mut vehicle = any(Vehicle::<_, LONG_REPORT, _>::with_spectrum(
        settings,
        RobustLocator::<50, 16>::new(robust::Settings::default()),
        SpectrumReader::new(temper),
    ));
    let mut spectrum = any(Spectrum::new());
    for _ in 0..any(100) {
        black_box(vehicle.push(any(0)));
        black_box((vehicle.line(), vehicle.spectrum().spectrum()));
        _ = black_box(spectrum.push(any(0.0)));
    }
    black_box(spectrum.peaks(temper));
    black_box(spectrum.log_likelihood(any(0.0), temper));
    let axis = Bearing::from_radians(any(0.0));
    let likelihood = SpectrumLikelihood::new(&spectrum, any([0.0; 2]), axis, temper);
    let mut out = any([0.0; 50]);
    let [x, y] = any([[0.0; 50]; 2]);
    likelihood.log_likelihoods(&[some(&x), some(&y)], some_mut(&mut out));
    black_box((likelihood.log_likelihood(&any([0.0; 2])), out));
    spectrum.clear();
}
