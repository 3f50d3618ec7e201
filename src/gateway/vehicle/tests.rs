//! The whole gateway, line by line.

extern crate std;
use super::*;
use crate::aoa::{Clean, clean};
use crate::gateway::config::BearingReference;
use crate::gateway::sentence::checksum;
use std::{format, string::String, vec::Vec};

mod headings;
mod lines;
mod positions;
mod spectrum;
mod strays;
mod times;

type Plain = Gateway<Clean<60, 16>>;

/// Every position is believed at once: what else is tested begins with one.
const CONFIG: Config<clean::Config> = Config {
    max_speed_m_s: f32::INFINITY,
    ..Config::new(clean::Config::DEFAULT)
};

fn gateway(config: Config<clean::Config>) -> Plain {
    Gateway::new(config).unwrap()
}

fn sentence(payload: &str) -> String {
    format!("${payload}*{:02X}\r\n", checksum(payload.as_bytes()))
}

/// Position, moving east at 50 knots.
fn rmc(time: &str) -> String {
    sentence(&format!(
        "GPRMC,{time},A,4807.038,N,01131.000,E,50.0,090.0,221126,,,A"
    ))
}

fn kraken(milliseconds: i64, degrees: f32, place: &str) -> String {
    format!("{milliseconds}, {degrees}, 80.0, -30, 433920000, UCA, 0, fox, {place}, R, R, R, R\n")
}

/// 12:00:00 UTC on 22 November 2026.
const NOON: i64 = 1_795_348_800_000;
const NOWHERE: &str = "0.0, 0.0, 0, 0, GPS";

fn push(gateway: &mut Plain, text: &str) -> Vec<Event> {
    text.bytes()
        .filter_map(|byte| gateway.push(0, byte))
        .collect()
}

/// What the last line leads to, if it is a bearing: degrees clockwise from north, or the reason.
fn last_bearing(config: Config<clean::Config>, text: &str) -> Result<f32, Rejected> {
    let mut gateway = gateway(config);
    match push(&mut gateway, text).last() {
        Some(Event::Rejected(reason)) => Err(*reason),
        _ => Ok(gateway
            .vehicle()
            .observation()
            .unwrap()
            .bearing()
            .compass_degrees()),
    }
}

/// Two seconds apart, 100 m further east each, a source 100 m ahead and 600 m to the left.
fn drive(lines: i32) -> String {
    (0..lines)
        .map(|k| {
            let (east, time) = (100.0 * k as f32, 2 * k);
            let longitude = sentence(&format!(
                "GPRMC,1200{time:02},A,4807.038,N,01131.{:06.0},E,97.2,090.0,221126,,,A",
                east / 1_240.0 * 1e6,
            ));
            let relative = (0.0f32 - 600.0)
                .atan2(500.0 - east)
                .to_degrees()
                .rem_euclid(360.0);
            format!("{longitude}%{relative:03.0}/8\r")
        })
        .collect()
}
