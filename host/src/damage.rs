//! Damaged lines: how often a vehicle's gateway believes a position that its receiver never had.
//!
//! Each sentence of real logs is damaged with some probability, by one of six kinds in equal parts. A position that
//! the gateway uses is wrong if it is further than [`FAR_M`] from all that the receiver stated just then.

use std::{fs, path::Path};

use anyhow::{Context, Result, ensure};
use foxhunt::{
    aoa::geodesy::{Geodetic, LocalPlane},
    gateway::{Config, Event, Vehicle, formats::All},
    random::{Rng, SeedableRng, Xoshiro128PlusPlus},
};
use foxhunt_gateways::plain;

use crate::figures::Figure;

/// A position further off than this is wrong.
pub const FAR_M: f32 = 200.0;

/// The most of them in a whole study of two million sentences.
pub const LIMIT: f64 = 5.0;

/// One sentence in so many is damaged.
const ONE_IN: u32 = 10;

/// What happens to a sentence.
#[derive(Debug, Clone, Copy)]
enum Kind {
    /// One to four bits are flipped.
    Flips,
    /// One to four bytes are lost.
    Losses,
    /// One to four bytes come twice.
    Doubles,
    /// One to eight bytes of noise come in between.
    Noise,
    /// The end is lost.
    Truncation,
    /// One to eight bytes are replaced by noise.
    Overwriting,
}

impl Kind {
    const ALL: [Self; 6] = [
        Self::Flips,
        Self::Losses,
        Self::Doubles,
        Self::Noise,
        Self::Truncation,
        Self::Overwriting,
    ];

    fn damage(self, line: &mut Vec<u8>, mut below: impl FnMut(usize) -> usize) {
        if line.is_empty() {
            return;
        }
        let many = |below: &mut dyn FnMut(usize) -> usize, most| 1 + below(most);
        match self {
            Self::Flips => {
                for _ in 0..many(&mut below, 4) {
                    let place = below(line.len());
                    line[place] ^= 1 << below(8);
                }
            }
            Self::Losses => {
                let count = many(&mut below, 4).min(line.len());
                for _ in 0..count {
                    line.remove(below(line.len()));
                }
            }
            Self::Doubles => {
                for _ in 0..many(&mut below, 4) {
                    let place = below(line.len());
                    line.insert(place, line[place]);
                }
            }
            Self::Noise => {
                let place = below(line.len() + 1);
                for _ in 0..many(&mut below, 8) {
                    line.insert(place, below(256) as u8);
                }
            }
            Self::Truncation => line.truncate(below(line.len())),
            Self::Overwriting => {
                let place = below(line.len());
                let count = many(&mut below, 8);
                for byte in line.iter_mut().skip(place).take(count) {
                    *byte = below(256) as u8;
                }
            }
        }
    }
}

/// A line of a log, and where the vehicle was by it.
struct Line {
    bytes: Vec<u8>,
    place: Option<Geodetic>,
}

/// The logs of a folder.
pub struct Logs(Vec<Vec<Line>>);

impl Logs {
    /// Reads all logs of the folder `nmea` of the measured data.
    ///
    /// # Errors
    /// If they cannot be read.
    pub fn read(data: &Path) -> Result<Self> {
        let folder = data.join("nmea/logs");
        let files = fs::read_dir(&folder).with_context(|| format!("no {}", folder.display()))?;
        let mut files = files
            .map(|file| Ok(file?.path()))
            .collect::<Result<Vec<_>>>()?;
        files.sort();
        let mut logs = Vec::new();
        for file in files {
            let bytes = fs::read(&file)?;
            let lines = bytes.split_inclusive(|byte| *byte == b'\n');
            let lines = lines.map(|line| Line {
                bytes: line.to_vec(),
                place: stated(line),
            });
            logs.push(lines.collect());
        }
        ensure!(!logs.is_empty(), "{} is empty", folder.display());
        Ok(Self(logs))
    }
}

/// The position that a line states.
fn stated(line: &[u8]) -> Option<Geodetic> {
    let config = Config {
        max_speed_m_s: f32::INFINITY,
        ..plain::CONFIG
    };
    let mut vehicle = Box::new(Vehicle::<plain::Locator, All>::EMPTY);
    for byte in line {
        vehicle.push(0, *byte, &config);
    }
    Some(vehicle.receiver().place?.value)
}

/// What came of damaged sentences.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Outcome {
    /// Sentences, of which one in ten was damaged.
    pub sentences: u64,
    /// Those that were.
    pub damaged: u64,
    /// Positions that were used.
    pub believed: u64,
    /// Positions that wait or waited for a later one.
    pub waited: u64,
    /// Positions that were used and are wrong.
    pub wrong: u64,
    /// The most of them in a row.
    pub in_a_row: u64,
}

impl Outcome {
    /// Replays the logs, over and over, until there were so many sentences; each time from a start. With or without
    /// positions that wait to be confirmed.
    #[must_use]
    pub fn of(logs: &Logs, sentences: u64, seed: u64, confirmed: bool) -> Self {
        let mut rng = Xoshiro128PlusPlus::seed_from_u64(seed);
        let mut outcome = Self::default();
        while outcome.sentences < sentences {
            for log in &logs.0 {
                outcome.drive(log, &mut rng, confirmed);
            }
        }
        outcome
    }

    fn drive(&mut self, log: &[Line], rng: &mut Xoshiro128PlusPlus, confirmed: bool) {
        let mut config = plain::CONFIG;
        if !confirmed {
            config.max_speed_m_s = f32::INFINITY;
        }
        let mut vehicle = Box::new(Vehicle::<plain::Locator, All>::EMPTY);
        let mut below = |limit: usize| (rng.next_u32() as usize) % limit;
        // The last three places that were stated.
        let mut places: Vec<Geodetic> = Vec::new();
        let mut in_a_row = 0;
        for line in log {
            let mut bytes = line.bytes.clone();
            if bytes.starts_with(b"$") {
                self.sentences += 1;
                if below(ONE_IN as usize) == 0 {
                    self.damaged += 1;
                    Kind::ALL[below(Kind::ALL.len())].damage(&mut bytes, &mut below);
                }
            }
            if let Some(place) = line.place {
                places.insert(0, place);
                places.truncate(3);
            }
            for byte in bytes {
                if vehicle.push(0, byte, &config) != Some(Event::Used) {
                    continue;
                }
                let states_a_place = match vehicle.line(0) {
                    [b'$', _, _, b'R', b'M', b'C', ..] | [b'$', _, _, b'G', b'G', b'A', ..] => true,
                    other => other.starts_with(&[0xb5, 0x62, 1, 7]),
                };
                let place = vehicle.receiver().place.filter(|_| states_a_place);
                let Some(place) = place else {
                    continue;
                };
                self.believed += 1;
                let is_near = |stated: &Geodetic| {
                    let plane = LocalPlane::new(*stated);
                    let way = plane.and_then(|plane| plane.to_local(place.value));
                    way.is_ok_and(|[east, north]| east.hypot(north) <= FAR_M)
                };
                if places.iter().any(is_near) {
                    in_a_row = 0;
                } else {
                    in_a_row += 1;
                    self.wrong += 1;
                    self.in_a_row = self.in_a_row.max(in_a_row);
                }
            }
        }
        let waited = foxhunt::gateway::Rejected::Unconfirmed;
        self.waited += u64::from(vehicle.counters().rejected(waited));
    }

    /// As figures with their limits.
    #[must_use]
    pub fn figures(&self, prefix: &str) -> Vec<Figure> {
        let figure = |name: &str, value: u64, unit: &str| {
            Figure::new(format!("{prefix}.{name}"), value as f64, unit)
        };
        vec![
            figure("sentences", self.sentences, "sentences"),
            figure("damaged", self.damaged, "sentences"),
            figure("believed", self.believed, "positions"),
            figure("waited", self.waited, "positions"),
            figure("wrong", self.wrong, "positions"),
            figure("in_a_row", self.in_a_row, "positions"),
        ]
    }
}
