//! The radio map and the packets that come with the project, and the task `tunnel` that remakes them.

use std::fs;

use anyhow::{Context, Result};
use foxhunt::gateway::beacon::Framing;
use foxhunt_host::packets::{self, Message, Recording, Scene, example};
use foxhunt_simulation::people::EXAMPLE_SEED;

use crate::project;

/// The radio map of the demo.
pub const MAP: &str = "examples/data/tunnel.map";
/// What its radios hear.
pub const PACKETS: &str = "examples/data/tunnel.packets";

/// How packets go to the firmware, and to which.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Framed {
    Lines,
    Frames,
}

impl Framed {
    pub fn framing(self) -> Framing {
        match self {
            Self::Lines => Framing::Lines,
            Self::Frames => Framing::Frames,
        }
    }

    pub fn firmware(self) -> &'static str {
        match self {
            Self::Lines => "beacon_gateway",
            Self::Frames => "beacon_gateway_frames",
        }
    }

    /// The recording, and at last the query that the firmware answers with its status.
    pub fn messages(self, recording: &Recording) -> Vec<Message> {
        let [line, frame] = packets::query();
        let (mut messages, query) = match self {
            Self::Lines => (recording.lines(), line),
            Self::Frames => (recording.frames(), frame),
        };
        let end = messages.last().map_or(0, |(time, _)| *time);
        messages.push((end, query));
        messages
    }

    /// The same in one piece.
    pub fn bytes(self, recording: &Recording) -> Vec<u8> {
        let messages = self.messages(recording).into_iter();
        messages.flat_map(|(_, message)| message).collect()
    }
}

/// The files that come with the project.
pub fn scene() -> Result<Scene> {
    let read = |file| {
        let path = project::root().join(file);
        fs::read(path).with_context(|| format!("cannot read {file}: run `cargo xtask tunnel`"))
    };
    Ok(Scene {
        map: read(MAP)?,
        recording: Recording::read(&String::from_utf8(read(PACKETS)?)?)?,
        ..example(EXAMPLE_SEED)
    })
}

/// Simulates both and writes their files.
pub fn run() -> Result<()> {
    let Scene { map, recording, .. } = example(EXAMPLE_SEED);
    let lines = recording.line_bytes();
    for (file, bytes) in [(MAP, map), (PACKETS, lines)] {
        fs::write(project::root().join(file), &bytes)
            .with_context(|| format!("cannot write {file}"))?;
        println!("{file}: {} bytes, seed {EXAMPLE_SEED}", bytes.len());
    }
    Ok(())
}
