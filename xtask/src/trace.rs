//! Drives and packets through the firmwares in the emulator, and through the same gateways on the host.

use std::{
    env, fs,
    io::Write,
    path::Path,
    process::{Command, Stdio},
    thread,
    time::Duration,
};

use anyhow::{Context, Result, ensure};
use foxhunt_host::{
    array::Method,
    measured::{Measured, SIGMA_DEGREES},
    packets::{self, Scene},
    passes::{Build, Pass},
    replay,
    scripts::Script,
};
use foxhunt_simulation::people::EXAMPLE_SEED;
use rayon::prelude::*;

use crate::{
    board::{self, BEACONS, PLAIN, QUERY, ROBUST, VEHICLES, ensure_same},
    drive::EXAMPLE,
    project,
    qemu::Machine,
    tunnel::{self, Framed},
};

/// A drive through a firmware.
struct Trial {
    name: String,
    firmware: &'static str,
    bytes: Vec<u8>,
}

impl Trial {
    /// The drive, and the query that ends it.
    fn new(name: &str, firmware: &'static str, drive: &[u8]) -> Self {
        Self {
            name: name.to_owned(),
            firmware,
            bytes: [drive, QUERY].concat(),
        }
    }

    /// Fails unless the board answers as the host does, and both find something.
    fn compare(&self) -> Result<()> {
        let host = match self.firmware {
            PLAIN => replay::Replay::of(&self.bytes).output().to_vec(),
            other => on_host(other, &self.bytes)?,
        };
        ensure!(lines(&host).contains("\n$PFOXF"), "nothing was found");
        ensure_same(&on_board(self.firmware, &self.bytes)?, &host)
    }
}

/// Fails unless the firmware answers the shipped drive, and the measured ones where they are at hand, byte for
/// byte as the host does, the firmwares with refinements a part of the shipped drive, and the robust one a drive past two
/// sources and one with the newest build of the KrakenSDR's software.
pub fn compare() -> Result<()> {
    let drive = fs::read(project::root().join(EXAMPLE))?;
    let part = first_lines(&drive, PART);
    let mut trials = vec![Trial::new("the shipped drive", PLAIN, &drive)];
    trials.extend(
        VEHICLES.map(|firmware| Trial::new("a part of the shipped drive", firmware, &part)),
    );
    trials.push(scripted(Script::TwoSources));
    trials.push(passed(Build::Suite2026));
    if let Some(data) = env::var_os("FOXHUNT_DATA") {
        let set = Path::new(&data).join("wsr/los_set_a.csv");
        for transmitter in ["tx2", "tx3", "tx4"] {
            let drive = Measured::read(&set, transmitter)?.drive(SIGMA_DEGREES)?;
            trials.push(Trial::new(transmitter, PLAIN, drive.bytes()));
        }
    } else {
        println!("measured drives are skipped: FOXHUNT_DATA does not name their directory");
    }
    project::build_firmwares(&VEHICLES)?;
    compare_each(trials)
}

/// Fails unless the robust firmware answers every drive on which something happens, and a drive with every build of the
/// KrakenSDR's software, as the host does.
pub fn compare_all() -> Result<()> {
    let scripted = Script::ALL.map(scripted).into_iter();
    compare_each(scripted.chain(Build::ALL.map(passed)).collect())
}

/// A drive on which something happens.
fn scripted(script: Script) -> Trial {
    Trial::new(script.name(), ROBUST, script.scene(1).drive.bytes())
}

/// A drive past a source with a build of the KrakenSDR's software.
fn passed(build: Build) -> Trial {
    let pass = Pass::new(build, Method::Music, 0.0, 1, 1);
    Trial::new(build.name(), ROBUST, &pass.bytes)
}

fn compare_each(trials: Vec<Trial>) -> Result<()> {
    trials.into_par_iter().try_for_each(|trial| {
        let of = || format!("{} through {}", trial.name, trial.firmware);
        trial.compare().with_context(of)
    })
}

/// Seconds that a full gateway is compared for.
const CROWD_S: f64 = 20.0;

/// Fails unless the firmwares of the tunnel answer the shipped packets, as sentences and as frames, and those of as many tags
/// as they have trackers, byte for byte as the host does; or if a damaged map compiles.
pub fn compare_tunnel() -> Result<()> {
    let scene = tunnel::scene()?;
    let crowd = packets::crowd(EXAMPLE_SEED, CROWD_S);
    ensure!(scene.map == crowd.map, "the map is not that of the seed");
    project::build_firmwares(&BEACONS)?;
    let trials = [
        (&scene, Framed::Lines),
        (&scene, Framed::Frames),
        (&crowd, Framed::Lines),
    ];
    trials
        .into_par_iter()
        .try_for_each(|(scene, framed)| compare_people(scene, framed).context(framed.firmware()))?;
    damaged_map()
}

/// Fails unless a firmware of the tunnel tracks all people of a scene, byte for byte as the host does.
fn compare_people(scene: &Scene, framed: Framed) -> Result<()> {
    let bytes = framed.bytes(&scene.recording);
    let mut replay = packets::Replay::new(scene, framed.framing())?;
    replay.push(&bytes);
    let host = lines(replay.output());
    for tag in scene.recording.truth.keys() {
        ensure!(
            host.contains(&format!(",{tag},TRACKING,")),
            "{tag} was not tracked"
        );
    }
    ensure_same(&on_board(framed.firmware(), &bytes)?, replay.output())
}

/// Fails if a firmware with a damaged map compiles, or another reason keeps it from compiling.
fn damaged_map() -> Result<()> {
    let mut map = fs::read(project::root().join(tunnel::MAP))?;
    let last = map.last_mut().context("the map is empty")?;
    *last ^= 1;
    let directory = project::root().join("target");
    fs::create_dir_all(&directory)?;
    let file = directory.join("damaged.map");
    fs::write(&file, map)?;
    let check = project::cargo()
        .args(["check", "--quiet", "--example", "beacon_gateway"])
        .env("FOXHUNT_MAP", &file)
        .output()?;
    let said = String::from_utf8_lossy(&check.stderr);
    ensure!(
        !check.status.success() && said.contains("is no radio map, or a damaged one"),
        "a damaged map was not refused: {said}"
    );
    Ok(())
}

/// Lines of the shipped drive that firmwares with refinements are given: the search, the first fix and many moves.
const PART: usize = 400;

fn first_lines(drive: &[u8], lines: usize) -> Vec<u8> {
    let lines = drive.split_inclusive(|byte| *byte == b'\n').take(lines);
    lines.flatten().copied().collect()
}

/// Longer than any drive takes on a busy machine.
const LIMIT: Duration = Duration::from_secs(300);

/// What the firmware sends, up to its status.
fn on_board(firmware: &str, bytes: &[u8]) -> Result<Vec<u8>> {
    let mut machine = Machine::boot(&project::firmware(firmware)?, LIMIT)?;
    board::answer(&mut machine, bytes)
}

/// What the same example writes on the host.
fn on_host(firmware: &str, bytes: &[u8]) -> Result<Vec<u8>> {
    let mut child = Command::new(project::executable(&["--example", firmware])?)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()?;
    let mut input = child.stdin.take().context("standard input is piped")?;
    let bytes = bytes.to_vec();
    let sender = thread::spawn(move || input.write_all(&bytes));
    let output = child.wait_with_output()?;
    sender.join().expect("writing does not panic")?;
    ensure!(output.status.success(), "{firmware} failed on the host");
    Ok(output.stdout)
}

fn lines(output: &[u8]) -> String {
    String::from_utf8_lossy(output).into_owned()
}
