//! `foxhunt simulate`: logs of drives that nobody has driven.

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail, ensure};
use foxhunt_host::{
    drive::{self, Drive},
    geodesy::Place,
    packets,
    scripts::Script,
};
use foxhunt_simulation::{people, scenario::Scenario};
use serde_json::json;

use crate::screen;

/// Simulate a drive, or people in a tunnel, and write what a receiver, a direction finder or radios would have sent
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  foxhunt simulate two-sources --output two.nmea\n  foxhunt replay two.nmea\n\n\
                  A scenario of your own, scenario.toml:\n  seed = 1\n  interval_s = 3.0\n  sigma_rad = 0.05\n  \
                  outlier_rate = 0.05\n  mirrored_rate = 0.0\n  bias_rad = 0.0\n  [vehicle]\n  \
                  corners = [[0.0, 0.0], [1500.0, 0.0], [1500.0, 1500.0]]\n  speed_m_s = 12.0\n  start_s = 0.0\n  \
                  [[sources]]\n  corners = [[900.0, 1000.0]]\n  speed_m_s = 1.0\n  start_s = 0.0"
)]
pub struct Options {
    /// What happens: drive, tunnel, outage, frozen-course, departure, two-sources; or a scenario in a TOML file.
    scenario: String,
    /// The seed of its errors [default: 1; of `drive` and `tunnel` that of the files that come with the project; of a scenario its
    /// own].
    #[arg(long, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// The file to write it to; overwritten if there is one. Of a tunnel, the radio map is written beside it, as .map.
    #[arg(long, short)]
    output: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(options: &Options) -> Result<()> {
    let output = options.output.clone();
    let scripted = Script::ALL
        .into_iter()
        .find(|script| script.name() == options.scenario);
    let (seed, files) = match (&*options.scenario, scripted) {
        ("drive", _) => {
            let seed = options.seed.unwrap_or(drive::EXAMPLE_SEED);
            (seed, vec![(output, drive::example(seed).bytes().to_vec())])
        }
        ("tunnel", _) => {
            let seed = options.seed.unwrap_or(people::EXAMPLE_SEED);
            let scene = packets::example(seed);
            let map = output.with_extension("map");
            let lines = scene.recording.line_bytes();
            (seed, vec![(output, lines), (map, scene.map)])
        }
        (_, Some(script)) => {
            let seed = options.seed.unwrap_or(1);
            let bytes = script.scene(seed).drive.bytes().to_vec();
            (seed, vec![(output, bytes)])
        }
        (file, None) => {
            let mut scenario = read(file)?;
            scenario.seed = options.seed.unwrap_or(scenario.seed);
            let bytes = log(&scenario).with_context(|| file.to_owned())?;
            (scenario.seed, vec![(output, bytes)])
        }
    };
    for (file, bytes) in &files {
        let name = file.display();
        fs::write(file, bytes).with_context(|| format!("cannot write {name}"))?;
        if !options.json {
            screen::line(format_args!("{name}: {} bytes, seed {seed}", bytes.len()))?;
        }
    }
    if options.json {
        let files = files
            .iter()
            .map(|(file, bytes)| json!({"file": file, "bytes": bytes.len()}));
        screen::json(&json!({"seed": seed, "files": files.collect::<Vec<_>>()}))?;
    }
    Ok(())
}

fn read(file: &str) -> Result<Scenario> {
    ensure!(
        Path::new(file)
            .extension()
            .is_some_and(|ending| ending == "toml"),
        "there is no scenario {file}; one of your own is a .toml file"
    );
    let text = fs::read_to_string(file).with_context(|| format!("cannot read {file}"))?;
    match toml::from_str(&text) {
        Ok(scenario) => Ok(scenario),
        Err(error) => {
            let before = error.span().and_then(|span| text.get(..span.start));
            let line = before.map_or(1, |before| 1 + before.matches('\n').count());
            bail!("{file}:{line}: {}", error.message())
        }
    }
}

/// The log of a scenario: the receiver's sentences, and bearings as JSON, in the order of time.
fn log(scenario: &Scenario) -> Result<Vec<u8>> {
    const ORIGIN: Place = Place {
        latitude: 52.229_675_6,
        longitude: 21.012_228_7,
    };
    /// Seconds after midnight, and midnight of the day of all simulated drives in seconds after 1970.
    const DEPARTURE: f64 = 9.0 * 3600.0;
    const MIDNIGHT: f64 = 1_795_305_600.0;
    let readings = scenario.readings()?;
    let end = readings
        .last()
        .map_or(0.0, |last| f64::from(last.sight.time_ms) * 1e-3);
    let mut bytes = Vec::new();
    let mut add = |write: &dyn Fn(&mut Drive)| {
        let mut drive = Drive::default();
        write(&mut drive);
        bytes.extend_from_slice(drive.bytes());
    };
    for place in scenario.places(end) {
        add(&|drive| drive.truth(ORIGIN.offset(place)));
    }
    // A receiver that has been on for two seconds is believed.
    if let Some(first) = readings.first() {
        for early in [2.0, 1.0] {
            let time = DEPARTURE + f64::from(first.sight.time_ms) * 1e-3 - early;
            add(&|drive| drive.position(time, ORIGIN.offset(first.sight.position), 0.0, 0.0));
        }
    }
    let mut log = bytes;
    for reading in &readings {
        let sight = reading.sight;
        let time = DEPARTURE + f64::from(sight.time_ms) * 1e-3;
        let place = ORIGIN.offset(sight.position);
        let compass = |radians: f64| (90.0 - radians.to_degrees()).rem_euclid(360.0);
        let mut drive = Drive::default();
        let speed = scenario.vehicle.speed_m_s;
        drive.position(time, place, speed, compass(reading.heading));
        log.extend_from_slice(drive.bytes());
        let bearing = json!({
            "type": "BEARING", "bearing_type": "absolute", "latitude": place.latitude, "longitude": place.longitude,
            "bearing": compass(sight.bearing), "sigma_deg": sight.sigma.to_degrees(), "timestamp": MIDNIGHT + time,
        });
        log.extend_from_slice(format!("{bearing}\n").as_bytes());
    }
    Ok(log)
}
