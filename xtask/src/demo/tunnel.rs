//! The task `demo tunnel`: people through the firmware `beacon_gateway` on the emulated board.

mod assessment;
mod screen;

use std::{
    fs,
    io::{IsTerminal, stdout},
    path::{Path, PathBuf},
    thread,
    time::Duration,
};

use anyhow::{Context, Result, ensure};
use foxhunt_host::{
    packets::{self, Replay, Scene},
    picture, tetam,
};
use indicatif::{ProgressBar, ProgressStyle};

use self::{assessment::Assessment, screen::Screen};
use crate::{
    board::{ensure_same, has_status},
    project,
    qemu::Machine,
    reports::beacon::{self, Report},
    setup,
    tunnel::Framed,
};

/// The options of `cargo xtask demo tunnel`.
#[derive(clap::Args)]
pub struct Options {
    /// Track a measured walk instead of the simulated tunnel: the directory of the data set, with `survey.csv`,
    /// `sensors.csv` and `walks`. The firmware is built with the map of its survey.
    #[arg(long, value_name = "DIRECTORY")]
    data: Option<PathBuf>,
    /// The walk: one of the data set's.
    #[arg(long, value_name = "NAME", requires = "data", default_value = tetam::WALKS[0])]
    walk: String,
    /// Send packets as binary frames, to `beacon_gateway_frames`.
    #[arg(long)]
    frames: bool,
}

/// The board is switched off after this time at the latest.
const LIMIT: Duration = Duration::from_secs(300);
/// By how much a terminal is faster than the walks, so that the fixes can be seen to come.
const HASTE: f64 = 6.0;

/// Streams the packets through the firmware and says how good its fixes are.
pub fn run(options: &Options) -> Result<()> {
    let (name, title, scene) = scene(options)?;
    let framed = match options.frames {
        false => Framed::Lines,
        true => Framed::Frames,
    };
    let packets = &scene.recording.packets;
    println!(
        "{} packets of {} tags, by {} radios",
        packets.len(),
        scene.recording.truth.len(),
        scene.radios.len()
    );

    setup::ensure(setup::FIRMWARE)?;
    let stem = project::root().join("target/demo").join(&name);
    let map = save_map(&scene, &stem.with_extension("map"))?;
    println!(
        "building the firmware `{}` for {}, with a map of {} bytes",
        framed.firmware(),
        project::BOARD,
        scene.map.len()
    );
    let variables = [
        ("FOXHUNT_MAP", map.as_os_str()),
        ("FOXHUNT_WALKS", scene.walks.name().as_ref()),
    ];
    let elf = project::firmware_with(framed.firmware(), &variables)?;
    println!("booting it on QEMU's mps2-an386, a Cortex-M4F");
    let mut machine = Machine::boot(&elf, LIMIT)?;
    let output = stream(&mut machine, &scene, framed)?;

    let mut replay = Replay::new(&scene, framed.framing())?;
    replay.push(&framed.bytes(&scene.recording));
    ensure_same(&output, replay.output())?;
    println!("the gateway on this machine gives the same reports, byte for byte");

    let reports = beacon::parse(&output);
    if let Some(Report::Status(status)) = reports.last() {
        println!("{status}");
    }
    let assessment = Assessment::new(&scene, &reports)?;
    println!("{assessment}");
    let walks = assessment.walks(&title, &scene, &replay)?;
    picture::save(&walks.svg()?, &stem)?;
    let errors = stem.with_file_name(format!("{name}-errors"));
    picture::save(&assessment.errors()?, &errors)?;
    println!(
        "pictures: {} and {}, and .png",
        stem.with_extension("svg").display(),
        errors.with_extension("svg").display()
    );
    Ok(())
}

/// What is tracked, under which name, and in which words.
fn scene(options: &Options) -> Result<(String, String, Scene)> {
    let Some(data) = &options.data else {
        let title = "Eight people in a tunnel, tracked by four radios".into();
        return Ok(("tunnel".into(), title, crate::tunnel::scene()?));
    };
    ensure!(
        tetam::WALKS.contains(&options.walk.as_str()),
        "no walk {}; there are {}",
        options.walk,
        tetam::WALKS.join(", ")
    );
    let scene = packets::measured(data, &options.walk)?;
    let title = format!(
        "The measured walk {}, tracked by twelve radios",
        options.walk
    );
    Ok((format!("tunnel-{}", options.walk), title, scene))
}

/// Writes the map where the compiler finds it; not again if it is there, so that nothing is built twice.
fn save_map(scene: &Scene, file: &Path) -> Result<PathBuf> {
    if fs::read(file).is_ok_and(|bytes| bytes == scene.map) {
        return Ok(file.to_owned());
    }
    let directory = file.parent().context("a file is in a directory")?;
    fs::create_dir_all(directory)?;
    fs::write(file, &scene.map).with_context(|| format!("cannot write {}", file.display()))?;
    Ok(file.to_owned())
}

/// Sends the packets and a query, shows the fixes as they come, and returns all that the firmware sent.
fn stream(machine: &mut Machine, scene: &Scene, framed: Framed) -> Result<Vec<u8>> {
    let messages = framed.messages(&scene.recording);
    let bar = ProgressBar::new(messages.len() as u64).with_style(ProgressStyle::with_template(
        "{wide_bar} {pos} of {len} messages",
    )?);
    let pace = stdout().is_terminal();
    let mut screen = Screen::new(scene, &bar)?;
    let mut output = Vec::new();
    let mut now_ms = 0;
    for (time_ms, message) in messages {
        if pace && time_ms > now_ms {
            let seconds = 1e-3 * f64::from(time_ms - now_ms) / HASTE;
            thread::sleep(Duration::from_secs_f64(seconds));
        }
        now_ms = time_ms;
        machine.send(&message)?;
        bar.inc(1);
        output.extend(machine.received());
        screen.show(&output);
    }
    // The status is the last of the answer to the query.
    while !has_status(&output) {
        output.extend(
            machine
                .receive()
                .context("the firmware ended before it answered")?,
        );
        screen.show(&output);
    }
    bar.finish_and_clear();
    Ok(output)
}
