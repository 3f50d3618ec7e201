//! Walks through the library's tracker of tags: what the study of tunnels and its tests have in common.

mod office;

use anyhow::{Context, Result, bail};
use foxhunt::{
    fingerprint::{
        Lattice, RadioMap, Reading, ReadingError,
        tracker::{Config, Fix, OneFloor, Packed, Site, Stored, Tracker, Workspace},
    },
    random::{SeedableRng, Xoshiro128PlusPlus},
};

pub(crate) use office::lattice;
pub use office::{Office, Walk};

use crate::{
    experiment::{INTERVAL, MISMATCH, Run, SURVEYED},
    packets::Walks,
    radio_map::{Recipe, SiteSurvey},
};
use foxhunt_simulation::{survey::Survey, tunnel::Packet};

/// Particles of every tracker here.
pub const PARTICLES: usize = 300;
/// Points of the largest map here.
const POINTS: usize = 4096;

type Fresh<S> = (
    Tracker<PARTICLES, 16, 2, S>,
    Box<Workspace<PARTICLES, POINTS>>,
);

fn fresh<S: Stored<Floor = OneFloor>>() -> Fresh<S> {
    (Tracker::EMPTY, Box::new(Workspace::EMPTY))
}

/// For scans in the simulated tunnel: the motion of the exact filter, errors that are normal and independent but for the
/// mismatch of the map, and a radio that is that of the survey.
pub fn of_simulated_scans() -> Config {
    Config {
        velocity_sigma_m_s: 1.5,
        velocity_noise_m2_s3: 0.5,
        velocity_memory_s: f32::INFINITY,
        mismatch_sigma_db: MISMATCH.sqrt() as f32,
        tempering: 1.0,
        gate_sigmas: f32::INFINITY,
        offset_probability: 0.0,
        ..Config::DEFAULT
    }
}

/// For packets that come one by one while the person walks: as the firmware, but for a radio that is that of the survey.
pub fn of_simulated_packets() -> Config {
    Config {
        offset_probability: 0.0,
        ..Walks::Tunnel.config()
    }
}

/// The radio map of a survey along the middle of the simulated tunnel, every metre: the bytes that go to flash.
///
/// # Errors
/// If it cannot be made.
pub fn tunnel_map(survey: &Survey) -> Result<Vec<u8>> {
    let beacons: Vec<u32> = (0..survey.beacons() as u32).collect();
    let lattice = Lattice::new([0.0, SURVEYED as f32], 1.0, survey.places.len() as u16, 1)?;
    let made = SiteSurvey::of(survey, &beacons).map(&Recipe::on(lattice), &mut |_| ())?;
    Ok(made.bytes)
}

/// Where the tracker thinks each scan of a run was taken, in metres along the tunnel.
///
/// # Errors
/// If the bytes are no map or a scan is refused.
pub fn follow_scans(run: &Run, map: &[u8], config: Config, seed: u64) -> Result<Vec<f64>> {
    follow_scans_as::<Packed<2>>(run, map, config, seed)
}

/// The same with particles that are stored in another form.
///
/// # Errors
/// As [`follow_scans`].
pub fn follow_scans_as<S: Stored<Floor = OneFloor>>(
    run: &Run,
    map: &[u8],
    config: Config,
    seed: u64,
) -> Result<Vec<f64>> {
    let site = Site::new(RadioMap::new(map)?, config)?;
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
    let (mut tracker, mut workspace) = fresh::<S>();
    let mut places = Vec::new();
    for (step, scan) in run.scans.iter().enumerate() {
        for (beacon, level) in scan.iter().enumerate() {
            let Some(level) = level else { continue };
            let time_ms = (1000.0 * INTERVAL) as u32 * step as u32;
            let packet = Reading {
                beacon: beacon as u8,
                rssi_dbm: *level as f32,
            };
            // The level is the mean of so many packets.
            for _ in 0..run.packets {
                tracker.push(time_ms, packet, &site, &mut workspace, &mut rng)?;
            }
        }
        let fix = tracker.flush(&site, &mut workspace, &mut rng);
        places.push(fix.context("a scan led to nothing")?.position[0].into());
    }
    Ok(places)
}

/// Where the tracker thinks a tag is at each of `times`, by the packets before it.
///
/// # Errors
/// As [`fixes`].
pub fn follow(
    site: &Site<'_>,
    packets: &[Packet],
    times: &[f64],
    seed: u64,
) -> Result<Vec<[f64; 2]>> {
    let fixes = fixes(site, packets, times, seed)?;
    Ok(fixes
        .into_iter()
        .map(|fix| fix.position.map(f64::from))
        .collect())
}

/// What the tracker knows of a tag at each of `times`, by the packets before it, on any map of up to 4096 points: the last fix,
/// with the place where the tag is then if the velocity stays.
///
/// As a gateway does that is asked, packets that wait for the end of their window are taken in first.
///
/// # Errors
/// If a packet is refused for another reason than its strength, or there is none before the first time.
pub fn fixes(site: &Site<'_>, packets: &[Packet], times: &[f64], seed: u64) -> Result<Vec<Fix>> {
    fixes_as::<Packed<2>>(site, packets, times, seed)
}

/// The same with particles that are stored in another form.
///
/// # Errors
/// As [`fixes`].
pub fn fixes_as<S: Stored<Floor = OneFloor>>(
    site: &Site<'_>,
    packets: &[Packet],
    times: &[f64],
    seed: u64,
) -> Result<Vec<Fix>> {
    let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
    let (mut tracker, mut workspace) = fresh::<S>();
    let milliseconds = |time: f64| (1000.0 * time).round() as u32;
    let mut packets = packets.iter().peekable();
    let mut found = Vec::new();
    for time in times {
        while let Some(packet) = packets.next_if(|packet| packet.time < *time) {
            let time_ms = milliseconds(packet.time);
            let heard = Reading {
                beacon: packet.beacon as u8,
                rssi_dbm: packet.level as f32,
            };
            match tracker.push(time_ms, heard, site, &mut workspace, &mut rng) {
                Ok(_) | Err(ReadingError::Strength) => {}
                Err(error) => bail!("packet at {:.3} s: {error}", packet.time),
            }
        }
        tracker.flush(site, &mut workspace, &mut rng);
        let fix = tracker
            .fix()
            .with_context(|| format!("nothing was heard before {time} s"))?;
        found.push(Fix {
            position: fix.position_at(milliseconds(*time)),
            ..fix
        });
    }
    Ok(found)
}
