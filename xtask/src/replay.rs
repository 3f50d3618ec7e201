//! The task `replay`: a log from the field through a gateway, and what came of it as files for people.

mod options;
mod summary;

use std::{
    fs::File,
    io::{self, Read},
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail, ensure};
use foxhunt::aoa::{Locate, Manoeuvring, Robust, clean, manoeuvring, multi};
use foxhunt_gateways::{plain, robust};
use foxhunt_host::archive::Recorder;
use indicatif::{ProgressBar, ProgressStyle};

use self::options::{Belief, Input, Kind};
use crate::project;

/// The options of `cargo xtask replay`.
///
/// Reads a log, as it came over the line of a receiver and a direction finder, through the gateway of the firmware, and
/// writes fixes.csv, bearings.csv, archive.geojson and picture.svg (and .png).
#[derive(clap::Args)]
pub struct Options {
    /// The log, or `-` for the standard input.
    file: PathBuf,
    /// The directory to write to; made if need be. Unless given, target/replay/ and the name of the file.
    #[arg(long, short, value_name = "DIRECTORY")]
    output: Option<PathBuf>,
    /// What takes the bearings.
    #[arg(long, value_enum, default_value_t = Kind::Robust)]
    locator: Kind,
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    belief: Belief,
}

/// Bytes that are read at a time.
const PIECE: usize = 1 << 14;

/// Runs the task.
pub fn run(options: &Options) -> Result<()> {
    match options.locator {
        Kind::Plain => {
            options.belief.ensure_default()?;
            options.replay::<plain::Locator>(clean::Config::DEFAULT)
        }
        Kind::Robust => {
            let track = manoeuvring::Config::new(options.belief.config()?);
            options.replay::<robust::Locator>(multi::Config::new(track))
        }
        Kind::Single => options.replay::<Robust<256>>(options.belief.config()?),
        Kind::Moving => {
            let config = manoeuvring::Config::new(options.belief.config()?);
            options.replay::<Manoeuvring<Robust<256>>>(config)
        }
    }
}

impl Options {
    fn replay<L: Locate>(&self, locator: L::Config) -> Result<()> {
        let mut recorder = Recorder::<L>::new(self.input.config(locator)?)?;
        // It is said before a long log is read.
        let directory = self.directory();
        if let Some(there) = directory.ancestors().find(|path| path.exists()) {
            let (wanted, file) = (directory.display(), there.display());
            ensure!(
                there.is_dir(),
                "cannot write to {wanted}: {file} is no directory"
            );
        }
        let bytes = self.read(&mut recorder)?;
        println!(
            "{}",
            summary::lines(bytes, recorder.replay().gateway().counters())
        );
        let Ok(archive) = recorder.archive() else {
            bail!(
                "no bearing of {} was used: there is nothing to keep",
                self.path()
            );
        };
        print!("{}", summary::answer(&archive));
        for file in archive.write(&directory, &self.name())? {
            println!("wrote {}", file.display());
        }
        Ok(())
    }

    /// Everything, to its end; the number of bytes.
    fn read<L: Locate>(&self, recorder: &mut Recorder<L>) -> Result<u64> {
        let (mut input, bar): (Box<dyn Read>, _) = if self.is_standard_input() {
            let style = ProgressStyle::with_template("{spinner} {bytes} {msg}")?;
            (
                Box::new(io::stdin().lock()),
                ProgressBar::new_spinner().with_style(style),
            )
        } else {
            let name = self.file.display();
            let file = File::open(&self.file).with_context(|| format!("cannot open {name}"))?;
            let bytes = file.metadata()?.len();
            let style = ProgressStyle::with_template("{wide_bar} {bytes} of {total_bytes} {msg}")?;
            (Box::new(file), ProgressBar::new(bytes).with_style(style))
        };
        let mut piece = vec![0; PIECE];
        let mut shown = 0;
        let mut total = 0;
        loop {
            let read = match input.read(&mut piece) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                read => read.with_context(|| format!("cannot read {}", self.path()))?,
            };
            if read == 0 {
                // The last line may lack its end.
                recorder.push(b"\n");
                bar.finish_and_clear();
                break;
            }
            recorder.push(&piece[..read]);
            total += read as u64;
            bar.inc(read as u64);
            let answers = recorder.answers();
            for known in &answers[shown..] {
                bar.set_message(format!("{} bearings", known.bearings));
            }
            let news = summary::news(answers, shown);
            shown = answers.len();
            for line in news {
                bar.suspend(|| println!("{line}"));
            }
        }
        for line in summary::news(recorder.answers(), shown) {
            println!("{line}");
        }
        Ok(total)
    }

    fn is_standard_input(&self) -> bool {
        self.file == Path::new("-")
    }

    /// The log as it was named.
    fn path(&self) -> String {
        if self.is_standard_input() {
            self.name()
        } else {
            self.file.display().to_string()
        }
    }

    /// The same without its directory.
    fn name(&self) -> String {
        let name = self.file.file_name().filter(|_| !self.is_standard_input());
        name.map_or("standard input".into(), |name| {
            name.to_string_lossy().into()
        })
    }

    fn directory(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| {
            let stem = match self.file.file_stem() {
                Some(stem) if !self.is_standard_input() => stem,
                _ => "standard-input".as_ref(),
            };
            project::root().join("target/replay").join(stem)
        })
    }
}

#[cfg(test)]
mod tests;
