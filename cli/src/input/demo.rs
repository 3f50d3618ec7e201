//! Simulated inputs: a drive past two transmitters, and people in a tunnel.

use std::time::Duration;

use foxhunt_host::{packets, scripts::Script};
use foxhunt_simulation::people;
use tokio::time::{Instant, sleep_until};

use super::feed::Feed;
use crate::engine;
use crate::settings::{Input, Settings, Site, Walks};

/// What the inputs say, and when.
pub struct Demo {
    /// How many times as fast as it was.
    pub speed: f64,
    /// Seeds its errors.
    pub seed: u64,
}

/// The name of the tunnel.
const TUNNEL: &str = "tunnel";

impl Demo {
    /// The inputs, in place of those of the settings.
    pub fn settings(settings: Settings) -> Settings {
        let name = |name: &str| {
            let name = crate::settings::Name::try_from(name.to_owned());
            name.unwrap_or_default()
        };
        let input = |own: &str, site: Option<&str>| Input {
            name: name(own),
            stdin: Some(true),
            site: site.map(name),
            ..Input::default()
        };
        Settings {
            input: vec![input("drive", None), input("radios", Some(TUNNEL))],
            site: vec![Site {
                name: name(TUNNEL),
                map: engine::DEMO_MAP.into(),
                above: Vec::new(),
                walks: Walks::Tunnel,
                frames: false,
                latitude: None,
                longitude: None,
                turned_deg: None,
                passage: Vec::new(),
                room: Vec::new(),
            }],
            ..settings
        }
    }

    /// Sends everything at its time.
    pub async fn run(self, feeds: Vec<Feed>) {
        let scene = Script::TwoSources.scene(self.seed);
        let mut drive: Vec<(f64, Vec<u8>)> = Vec::new();
        let mut second = 0.0;
        for line in scene.drive.bytes().split_inclusive(|byte| *byte == b'\n') {
            // The receiver begins every second.
            if line.starts_with(b"$GPRMC") {
                second += 1.0;
            }
            drive.push((second, line.to_vec()));
        }
        let recording = packets::example(people::EXAMPLE_SEED).recording;
        let heard = recording.lines().into_iter();
        let heard: Vec<(f64, Vec<u8>)> = heard
            .map(|(time_ms, line)| (1e-3 * f64::from(time_ms), line))
            .collect();
        let speed = if self.speed > 0.0 { self.speed } else { 1.0 };
        let begin = Instant::now();
        let mut feeds = feeds.into_iter();
        let (Some(first), Some(second)) = (feeds.next(), feeds.next()) else {
            return;
        };
        tokio::join!(
            play(first, drive, begin, speed),
            play(second, heard, begin, speed)
        );
    }
}

async fn play(feed: Feed, lines: Vec<(f64, Vec<u8>)>, begin: Instant, speed: f64) {
    feed.status.opened();
    for (seconds, line) in lines {
        let wait = Duration::try_from_secs_f64(seconds / speed).unwrap_or_default();
        sleep_until(begin + wait).await;
        if !feed.bytes(&line).await {
            return;
        }
    }
    feed.end().await;
    feed.status.ended();
}
