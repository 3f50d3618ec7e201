//! `foxhunt survey record`: a survey, by a gateway that hears a tag at one place after another.

use std::{
    collections::BTreeMap,
    fmt,
    fs::{File, OpenOptions},
    io::{self, IsTerminal, Read, Write},
    path::{Path, PathBuf},
    str::FromStr,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, bail, ensure};
use foxhunt::fingerprint::Lattice;

use super::{
    counted,
    line::{self, Line},
};
use crate::screen;

/// Whose packets are recorded, and where they are written.
#[derive(clap::Args)]
pub struct Record {
    /// CSV to which the readings are added: a survey may take more than one day.
    survey: PathBuf,
    #[command(flatten)]
    line: line::Options,
    /// Number of the tag that is carried from place to place.
    #[arg(long, value_name = "NUMBER")]
    tag: u32,
    /// For how long it stands at each place.
    #[arg(long, value_name = "SECONDS", default_value_t = 20,
          value_parser = clap::value_parser!(u32).range(1..=3600))]
    seconds: u32,
}

const COLUMNS: &str = "x,y,floor,beacon,rssi";
/// After so long without a reading the gateway is told again where the tag is.
const AGAIN: Duration = Duration::from_secs(1);

/// Runs the command: a place of each line of the input.
pub fn run(options: &Record) -> Result<()> {
    let mut line = Line::open(&options.line)?;
    let mut survey = open(&options.survey)?;
    let asks = io::stdin().is_terminal();
    let mut places = io::stdin().lines();
    loop {
        if asks {
            eprint!(
                "where does tag {} stand (x y, or x y floor; nothing ends the survey)? ",
                options.tag
            );
        }
        let Some(text) = places.next().transpose()? else {
            break;
        };
        if text.trim().is_empty() {
            break;
        }
        match text.parse::<Spot>() {
            Ok(spot) => {
                let heard = stand(&spot, options, &mut line, &mut survey)?;
                screen::line(format_args!("{spot}: {heard}"))?;
            }
            Err(error) => eprintln!("{:?}: {error}", text.trim()),
        }
    }
    Ok(())
}

/// Opens a survey to add to it.
fn open(file: &Path) -> Result<File> {
    let name = file.display();
    let mut survey = (OpenOptions::new().read(true).append(true).create(true))
        .open(file)
        .with_context(|| format!("cannot open {name}"))?;
    let mut before = String::new();
    let read = survey.read_to_string(&mut before);
    read.with_context(|| format!("cannot read {name}"))?;
    let begin = match before.lines().next() {
        None => COLUMNS,
        Some(first) if first.trim() != COLUMNS => {
            bail!("{name}: readings are only added to a survey that begins with {COLUMNS}")
        }
        Some(_) if before.ends_with('\n') => return Ok(survey),
        // Ends the last line.
        Some(_) => "",
    };
    writeln!(survey, "{begin}").with_context(|| format!("cannot write {name}"))?;
    Ok(survey)
}

/// Writes down what is heard while the tag stands there.
fn stand(spot: &Spot, options: &Record, line: &mut Line, survey: &mut File) -> Result<Heard> {
    let bar = screen::percent("listening");
    let begin = Instant::now();
    let length = Duration::from_secs(options.seconds.into());
    let [x, y] = spot.place;
    let mut heard = Heard::default();
    let mut told = None;
    while begin.elapsed() < length {
        // A command may be lost.
        if heard.0.is_empty() && told.is_none_or(|told: Instant| told.elapsed() >= AGAIN) {
            line.say(&spot.command(options.tag))?;
            told = Some(Instant::now());
        }
        let until = Instant::now() + Duration::from_millis(200);
        if let Some(payload) = line.hear(until.min(begin + length))?
            && let Some((radio, rssi)) = spot.reading(&payload)
        {
            let row = format!("{x},{y},{},{radio},{rssi}\n", spot.floor);
            (survey.write_all(row.as_bytes()))
                .with_context(|| format!("cannot write {}", options.survey.display()))?;
            heard.add(radio, rssi);
        }
        bar.set_position((100.0 * begin.elapsed().div_duration_f64(length)) as u64);
    }
    bar.finish_and_clear();
    // On its way to the next place it is nowhere.
    line.say("PFOXV")?;
    Ok(heard)
}

/// Where the tag stands.
#[derive(Debug, PartialEq)]
struct Spot {
    /// Metres.
    place: [f64; 2],
    floor: u8,
}

impl FromStr for Spot {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let fields = text
            .split([' ', ',', '\t'])
            .filter(|field| !field.is_empty());
        let fields: Vec<&str> = fields.collect();
        ensure!(
            matches!(fields.len(), 2 | 3),
            "a place is x y, or x y floor"
        );
        let metres = |axis: usize, name| -> Result<f64> {
            let value: f64 = fields[axis]
                .parse()
                .with_context(|| format!("{name} is no number"))?;
            let most = f64::from(Lattice::MAX_COORDINATE_M);
            // False for NaN.
            ensure!(
                value.abs() <= most,
                "{name} is not within 1000 km of the origin"
            );
            Ok(value)
        };
        let floor = fields.get(2).map_or(Ok(0), |floor| floor.parse());
        Ok(Self {
            place: [metres(0, "x")?, metres(1, "y")?],
            floor: floor.context("a floor is a number from 0 to 255")?,
        })
    }
}

impl fmt::Display for Spot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = self.place;
        write!(f, "{x} {y}, floor {}", self.floor)
    }
}

impl Spot {
    /// What tells the gateway that a tag stands there.
    fn command(&self, tag: u32) -> String {
        let [x, y] = self.place;
        format!("PFOXV,{tag},{x:.3},{y:.3},{}", self.floor)
    }

    /// The radio and the strength in dBm, of a reading of a tag that stands there.
    fn reading(&self, payload: &str) -> Option<(u32, i8)> {
        let fields: Vec<&str> = payload.strip_prefix("PFOXV,")?.split(',').collect();
        let [x, y, floor, radio, rssi] = fields[..] else {
            return None;
        };
        // The gateway has a place as an f32, and writes it to the millimetre.
        let is_near = |text: &str, metres: f64| {
            let stated = text.parse::<f64>();
            stated.is_ok_and(|stated| (stated - metres).abs() <= 0.002 + 1e-6 * metres.abs())
        };
        let is_here = is_near(x, self.place[0])
            && is_near(y, self.place[1])
            && floor.parse() == Ok(self.floor);
        is_here.then_some((radio.parse().ok()?, rssi.parse().ok()?))
    }
}

/// How many readings of each radio, and their sum in dBm.
#[derive(Default)]
struct Heard(BTreeMap<u32, (u32, i32)>);

impl Heard {
    fn add(&mut self, radio: u32, rssi: i8) {
        let (count, sum) = self.0.entry(radio).or_default();
        *count += 1;
        *sum += i32::from(rssi);
    }
}

impl fmt::Display for Heard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str("nothing was heard: is the tag on, and is its number right?");
        }
        let count: u32 = self.0.values().map(|(count, _)| count).sum();
        write!(f, "{}, in the mean", counted(count as usize, "reading"))?;
        for (number, (radio, (count, sum))) in self.0.iter().enumerate() {
            let comma = if number > 0 { "," } else { "" };
            let mean_dbm = f64::from(*sum) / f64::from(*count);
            write!(f, "{comma} {mean_dbm:.0} dBm by radio {radio}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_has_two_numbers_and_a_floor_if_any() {
        for (text, place, floor) in [
            ("1.5 -2", [1.5, -2.0], 0),
            ("1.5, -2, 3", [1.5, -2.0], 3),
            (" 0\t0 ", [0.0, 0.0], 0),
        ] {
            assert_eq!(text.parse::<Spot>().unwrap(), Spot { place, floor });
        }
        for (text, why) in [
            ("1", "a place is x y, or x y floor"),
            ("1 2 3 4", "a place is x y, or x y floor"),
            ("1 b", "y is no number"),
            ("nan 1", "x is not within 1000 km of the origin"),
            ("0 1000001", "y is not within 1000 km of the origin"),
            ("0 0 -1", "a floor is a number from 0 to 255"),
        ] {
            let error = text.parse::<Spot>().unwrap_err().to_string();
            assert_eq!(error, why, "{text}");
        }
    }

    #[test]
    fn a_reading_of_another_place_is_not_taken() {
        let spot: Spot = "12.5 0.25 1".parse().unwrap();
        assert_eq!(spot.command(7), "PFOXV,7,12.500,0.250,1");
        for (payload, expected) in [
            ("PFOXV,12.500,0.250,1,900,-60", Some((900, -60))),
            ("PFOXV,12.600,0.250,1,900,-60", None),
            ("PFOXV,12.500,0.250,0,900,-60", None),
            ("PFOXV,12.500,0.250,1,900", None),
            ("PFOXV,12.500,0.250,1,900,-5000", None),
            ("PFOXT,12.500,0.250,1,900,-60", None),
        ] {
            assert_eq!(spot.reading(payload), expected, "{payload}");
        }
    }
}
