//! What the radios of a tunnel hear of tags, as the bytes that they put on their line.

mod example;
mod measured;
mod replay;
mod scenarios;

pub use example::{crowd, example};
pub use measured::measured;
pub use replay::{Gateway, Replay};
pub use scenarios::{Floors, building, tunnel};

use std::collections::BTreeMap;

use anyhow::{Context, Result};
use foxhunt::{fingerprint::tracker, gateway::beacon::Packet};
use foxhunt_simulation::{
    path::Path,
    sentence::{of_packet, sentence},
};

/// A place with a radio map, and what was heard there.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The bytes of a [`foxhunt::fingerprint::RadioMap`].
    pub map: Vec<u8>,
    /// Packets, and where the tags were.
    pub recording: Recording,
    /// Where the radios are, in metres, in the order of the map.
    pub radios: Vec<[f64; 2]>,
    /// How people walk there.
    pub walks: Walks,
}

/// What the firmware is told of how people walk: the value of `FOXHUNT_WALKS`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Walks {
    /// Along a tunnel.
    Tunnel,
    /// About an office floor.
    Floor,
}

impl Walks {
    /// The value.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tunnel => "tunnel",
            Self::Floor => "floor",
        }
    }

    /// The configuration that the firmware then takes.
    pub(crate) fn config(self) -> tracker::Config {
        match self {
            Self::Tunnel => tracker::Config::TUNNEL,
            Self::Floor => tracker::Config::DEFAULT,
        }
    }
}

/// Packets in the order in which they were heard, and where the tags were.
///
/// On a line of sentences it is `$PFOXG,time,tag,x,y` that says where a tag was (milliseconds, metres): the gateway ignores
/// it, and whoever replays the line can tell how good the fixes are.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Recording {
    /// By rising time.
    pub packets: Vec<Packet>,
    /// The way of each tag.
    pub truth: BTreeMap<u32, Path>,
}

/// One message to the gateway, and the time that it states, in milliseconds.
pub type Message = (u32, Vec<u8>);

impl Recording {
    /// All sentences, one after the other.
    pub fn line_bytes(&self) -> Vec<u8> {
        self.lines()
            .into_iter()
            .flat_map(|(_, line)| line)
            .collect()
    }

    /// As sentences, where the tags are first.
    pub fn lines(&self) -> Vec<Message> {
        let truth = self.truth.iter().flat_map(|(tag, path)| {
            path.corners().iter().map(move |(seconds, [x, y])| {
                let time_ms = (1e3 * seconds).round() as u32;
                let place = sentence(format_args!("PFOXG,{time_ms},{tag},{x:.3},{y:.3}"));
                (0, place.into_bytes())
            })
        });
        let packets =
            (self.packets.iter()).map(|packet| (packet.time_ms, of_packet(packet).into_bytes()));
        truth.chain(packets).collect()
    }

    /// As binary frames, without where the tags are.
    pub fn frames(&self) -> Vec<Message> {
        let packets = self.packets.iter();
        packets
            .map(|packet| (packet.time_ms, stuffed(&packet.to_frame())))
            .collect()
    }

    /// Reads sentences; those that are neither packets nor places are left out.
    ///
    /// # Errors
    /// When a packet or a place is malformed; the error names the line.
    pub fn read(lines: &str) -> Result<Self> {
        let mut recording = Self::default();
        for (number, line) in lines.lines().enumerate() {
            let payload = line.strip_prefix('$').and_then(|rest| rest.split_once('*'));
            let fields: Vec<&str> = payload
                .map_or("", |(payload, _)| payload)
                .split(',')
                .collect();
            match fields.as_slice() {
                ["PFOXB", numbers @ ..] => {
                    packet(numbers).map(|packet| recording.packets.push(packet))
                }
                ["PFOXG", numbers @ ..] => place(numbers).map(|(tag, seconds, place)| {
                    recording.truth.entry(tag).or_default().push(seconds, place);
                }),
                _ => Some(()),
            }
            .with_context(|| format!("line {}: {line}", number + 1))?;
        }
        Ok(recording)
    }
}

/// Asks the gateway for all fixes and its status, as a sentence and as a frame.
pub fn query() -> [Vec<u8>; 2] {
    [sentence("PFOXQ").into_bytes(), stuffed(b"Q")]
}

fn packet(fields: &[&str]) -> Option<Packet> {
    let [time, radio, tag, rssi] = fields else {
        return None;
    };
    Some(Packet {
        time_ms: time.parse().ok()?,
        radio: radio.parse().ok()?,
        tag: tag.parse().ok()?,
        rssi_dbm: rssi.parse().ok()?,
    })
}

fn place(fields: &[&str]) -> Option<(u32, f64, [f64; 2])> {
    let [time, tag, x, y] = fields else {
        return None;
    };
    let seconds = 1e-3 * time.parse::<f64>().ok()?;
    Some((
        tag.parse().ok()?,
        seconds,
        [x.parse().ok()?, y.parse().ok()?],
    ))
}

/// A frame on the line: stuffed, so that a zero ends it and stands nowhere else.
fn stuffed(frame: &[u8]) -> Vec<u8> {
    let mut bytes = cobs::encode_vec(frame);
    bytes.push(0);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_bring_back_what_went_in() {
        let Scene { recording, .. } = example(1);
        let lines: Vec<u8> = recording
            .lines()
            .into_iter()
            .flat_map(|(_, line)| line)
            .collect();
        let read = Recording::read(str::from_utf8(&lines).unwrap()).unwrap();
        assert_eq!(read, recording);
        let error = Recording::read("$GPHDT,1,T*00\n$PFOXB,1,2,3*00\n").unwrap_err();
        assert!(format!("{error:#}").contains("line 2"));
    }

    #[test]
    fn frames_say_what_lines_say() {
        let scene = example(1);
        let recording = &scene.recording;
        let run = |framing, messages: Vec<Message>, query: &[u8]| {
            let mut replay = Replay::new(&scene, framing).unwrap();
            for (_, message) in messages {
                replay.push(&message);
            }
            replay.push(query);
            let output = String::from_utf8(replay.output().to_vec()).unwrap();
            let (fixes, status) = output.rsplit_once("$PFOXS,").unwrap();
            (fixes.to_owned(), status.to_owned())
        };
        use foxhunt::gateway::beacon::Framing;
        let [line, frame] = query();
        let lines = run(Framing::Lines, recording.lines(), &line);
        let frames = run(Framing::Frames, recording.frames(), &frame);
        assert_eq!(lines.0, frames.0);
        assert!(lines.0.contains(",LOST,") && lines.0.contains(",SILENT*"));
        let count = recording.packets.len();
        let status = format!("{},{count},0,1,0,0,0,0,0,0,0,0,8,0,0*", count + 1);
        assert!(frames.1.starts_with(&status), "{}", frames.1);
    }
}
