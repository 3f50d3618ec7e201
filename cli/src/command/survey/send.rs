//! `foxhunt survey send`: a new map over the line of a gateway that runs.

use std::{
    fmt::Write,
    fs,
    path::PathBuf,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, bail};
use foxhunt::{
    fingerprint::{Encoding, RadioMap},
    gateway::beacon::MapPiece,
};

use super::line::{self, Line};
use crate::screen;

/// The map, and where it is sent.
#[derive(clap::Args)]
pub struct Send {
    /// A radio map, as `foxhunt survey build` makes it.
    map: PathBuf,
    #[command(flatten)]
    line: line::Options,
}

/// How long the answer to a piece may take: a gateway of 64 tags works on an update of each before.
const PATIENCE: Duration = Duration::from_secs(3);
/// How often the same piece is sent.
const TRIES: u32 = 5;

/// Runs the command.
pub fn run(options: &Send) -> Result<()> {
    let file = options.map.display().to_string();
    let bytes = fs::read(&options.map).with_context(|| format!("cannot read {file}"))?;
    let map = RadioMap::new(&bytes).with_context(|| file.clone())?;
    if map.encoding() != Encoding::Moments {
        bail!("{file}: a gateway tracks by means and sigmas: build it with --encoding moments");
    }
    let lattice = map.lattice();
    let size = format!(
        "{} bytes, {} beacons at {} x {} points",
        bytes.len(),
        map.beacons(),
        lattice.columns(),
        lattice.rows(),
    );
    let mut line = Line::open(&options.line)?;
    let bar = screen::bytes(Some(bytes.len() as u64));
    let mut next = 0;
    let mut tries = 0;
    let mut has_answered = false;
    while tries < TRIES {
        tries += 1;
        line.say(&piece(&bytes, next))?;
        let answer = answer(&mut line, bytes.len())?;
        has_answered |= answer.is_some();
        match answer {
            Some(Answer::More(received)) => {
                if received > next {
                    tries = 0;
                }
                next = received;
                bar.set_position(next as u64);
            }
            Some(Answer::Ready) => {
                bar.finish_and_clear();
                return screen::line(format_args!(
                    "the gateway has checked the map, for its firmware to use: {size}"
                ));
            }
            Some(Answer::Refused) => bail!(
                "{file}: the gateway refuses the map, and goes on with its own: it has no room for {size}, or tracks along one row \
                 alone"
            ),
            None => {}
        }
    }
    if has_answered {
        bail!("the gateway has not taken the piece of the map at byte {next} in {TRIES} tries")
    }
    bail!("the gateway has not answered {TRIES} times: is it a gateway of tags, and on this line?")
}

/// The sentence's payload of the piece that begins there.
fn piece(map: &[u8], offset: usize) -> String {
    let rest = map.get(offset..).unwrap_or_default();
    let mut payload = format!("PFOXM,{offset},{},", map.len());
    for byte in rest.iter().take(MapPiece::BYTES) {
        write!(payload, "{byte:02X}").expect("a string takes all");
    }
    payload
}

/// What a gateway answers to a piece.
#[derive(Debug, PartialEq)]
enum Answer {
    /// The next piece begins there.
    More(usize),
    /// It was checked as a whole.
    Ready,
    Refused,
}

/// Waits for the answer to a piece of a map of so many bytes.
fn answer(line: &mut Line, total: usize) -> Result<Option<Answer>> {
    let until = Instant::now() + PATIENCE;
    while let Some(payload) = line.hear(until)? {
        let answer = read(&payload, total);
        if answer.is_some() {
            return Ok(answer);
        }
    }
    Ok(None)
}

fn read(payload: &str, total: usize) -> Option<Answer> {
    let fields: Vec<&str> = payload.strip_prefix("PFOXM,")?.split(',').collect();
    let [received, of, word] = fields[..] else {
        return None;
    };
    if of.parse() != Ok(total) {
        return None;
    }
    match word {
        "MORE" => {
            let received = received.parse().ok()?;
            (received < total).then_some(Answer::More(received))
        }
        "READY" if received.parse() == Ok(total) => Some(Answer::Ready),
        "REFUSED" => Some(Answer::Refused),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_an_answer_to_this_map_counts() {
        for (payload, expected) in [
            ("PFOXM,32,722,MORE", Some(Answer::More(32))),
            ("PFOXM,722,722,READY", Some(Answer::Ready)),
            ("PFOXM,0,722,REFUSED", Some(Answer::Refused)),
            ("PFOXM,32,722,READY", None),
            ("PFOXM,32,800,MORE", None),
            ("PFOXM,722,722,MORE", None),
            ("PFOXM,32,722", None),
            ("PFOXM,32,722,LESS", None),
            ("PFOXT,32,722,MORE", None),
        ] {
            assert_eq!(read(payload, 722), expected, "{payload}");
        }
    }

    #[test]
    fn the_last_piece_is_what_is_left() {
        let map: Vec<u8> = (0..34).collect();
        assert_eq!(piece(&map, 32), "PFOXM,32,34,2021");
    }
}
