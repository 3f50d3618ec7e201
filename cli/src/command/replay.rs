//! `foxhunt replay`: logs from the field through a gateway, and what came of them as files for people.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail, ensure};
use indicatif::ProgressBar;
use serde_json::json;

use super::{failure::NothingUsed, refusals::Refusals, summary};
use crate::{
    engine::{Engine, Happened, Piece, Setup, What},
    log::{self, Log},
    reading::{Belief, Kind, Reading},
    screen,
};

/// Run logs through a gateway, and write tables, maps and a picture of what came of them
///
/// Reads logs as they came over the lines of receivers and direction finders, or a raw log of `foxhunt live`, and writes
/// fixes.csv, bearings.csv, archive.geojson, archive.kml, archive.gpx and picture.svg (and .png).
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  foxhunt replay drive.nmea\n  foxhunt replay receiver.nmea kraken.csv --output tuesday\n  \
                  foxhunt replay foxhunt.jsonl --json"
)]
pub struct Options {
    /// The logs, or `-` for the standard input. Several are merged by the times that their lines state.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Several logs are of one line, and not each of a direction finder or receiver of its own.
    #[arg(long)]
    one_line: bool,
    /// The directory to write to; made if need be. Unless given, replay/ and the name of the first file.
    #[arg(long, short, value_name = "DIRECTORY")]
    output: Option<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    pub told: Told,
}

/// What gateway and locator are told.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Told {
    /// What takes the bearings. A raw log says it itself, and so it does all that follows, unless one of these options is given.
    #[arg(long, value_enum, default_value_t = Kind::Robust)]
    pub locator: Kind,
    #[command(flatten)]
    pub reading: Reading,
    #[command(flatten)]
    pub belief: Belief,
}

impl Told {
    fn is_default(&self) -> bool {
        self.locator == Kind::default()
            && self.reading == Reading::default()
            && self.belief == Belief::default()
    }
}

/// Runs the command.
pub fn run(options: &Options) -> Result<()> {
    // It is said before a long log is read.
    let directory = options.directory();
    if let Some(there) = directory.ancestors().find(|path| path.exists()) {
        let (wanted, file) = (directory.display(), there.display());
        ensure!(
            there.is_dir(),
            "cannot write to {wanted}: {file} is no directory"
        );
    }
    let mut shown = 0;
    let is_quiet = options.json;
    let mut refusals = Refusals::of(&options.files);
    let (engine, bytes) = read_with(
        &options.files,
        options.one_line,
        &options.told,
        &mut |engine, bar| {
            let answers = engine.answers();
            if !is_quiet && answers.len() > shown {
                let news = summary::news(answers, shown);
                shown = answers.len();
                bar.set_message(format!("{shown} bearings"));
                bar.suspend(|| news.iter().try_for_each(screen::line))?;
            }
            Ok(())
        },
        &mut |_, happened| refusals.note(&happened),
    )?;
    if !options.json {
        screen::line(summary::lines(bytes, engine.counters()))?;
        for refused in refusals.sorted() {
            let places = refused.where_they_are();
            screen::line(format_args!("rejected: {}: {places}", refused.reason))?;
        }
    }
    let Ok(archive) = engine.archive() else {
        let files: Vec<String> = options.files.iter().map(|file| log::name(file)).collect();
        let hint = refusals.hint().map(|hint| format!("; {hint}"));
        bail!(NothingUsed(format!(
            "no bearing of {} was used: there is nothing to keep{}",
            files.join(", "),
            hint.unwrap_or_default()
        )));
    };
    if !options.json {
        screen::line(summary::answer(&archive).trim_end())?;
    }
    let files = archive.write(&directory, &title(&options.files))?;
    if options.json {
        return screen::json(&json!({
            "bytes": bytes, "lines": summary::object(engine.counters()), "rejected": refusals.sorted(), "bearings": archive.bearings.len(),
            "fixes": archive.fix_rows().iter().rev().take(archive.last().sources.len().max(1)).rev().collect::<Vec<_>>(),
            "files": files,
        }));
    }
    for file in files {
        screen::line(format_args!("wrote {}", file.display()))?;
    }
    Ok(())
}

/// Called now and then while logs are read.
type Watch<'a> = &'a mut dyn FnMut(&Engine, &ProgressBar) -> Result<()>;

/// Reads logs to their end; the search, and the number of bytes.
pub fn read(files: &[PathBuf], one_line: bool, told: &Told, watch: Watch) -> Result<(Engine, u64)> {
    read_with(files, one_line, told, watch, &mut |_, _| {})
}

/// The same; what follows from the bytes is told, too.
pub fn read_with(
    files: &[PathBuf],
    one_line: bool,
    told: &Told,
    watch: Watch,
    say: &mut dyn FnMut(&Piece, Happened<'_>),
) -> Result<(Engine, u64)> {
    let setup = |inputs: &[PathBuf]| Setup {
        name: "vehicle".into(),
        locator: told.locator,
        reading: told.reading.clone(),
        belief: told.belief.clone(),
        inputs: inputs
            .iter()
            .map(|file| (title(std::slice::from_ref(file)), None))
            .collect(),
        sites: Vec::new(),
    };
    let mut total = 0;
    // What is told is checked before a log is opened.
    let engine = Engine::new(&setup(if one_line { &files[..1] } else { files }))?;
    let (engine, pieces, bar) = match files {
        [file] => single(file, told, engine)?,
        files => several(files, one_line, engine)?,
    };
    let engine = run_pieces(engine, pieces, &bar, watch, say, &mut total)?;
    Ok((engine, total))
}

/// One log: a raw one has settings of its own.
fn single(file: &Path, told: &Told, engine: Engine) -> Result<(Engine, Pieces, ProgressBar)> {
    Ok(match log::open(file)? {
        (Log::Raw { settings, pieces }, size) => {
            let mut own = Setup::from(&*settings);
            if !told.is_default() {
                (own.locator, own.reading, own.belief) =
                    (told.locator, told.reading.clone(), told.belief.clone());
            }
            (Engine::new(&own)?, Box::new(pieces), screen::bytes(size))
        }
        (Log::Bytes(input), size) => {
            let pieces = Chunks {
                input,
                name: log::name(file),
                is_over: false,
            };
            (engine, Box::new(pieces), screen::bytes(size))
        }
    })
}

/// Several logs, merged by time; or the parts of a raw one.
fn several(
    files: &[PathBuf],
    one_line: bool,
    engine: Engine,
) -> Result<(Engine, Pieces, ProgressBar)> {
    let (mut logs, mut raw) = (Vec::new(), Vec::new());
    for file in files {
        match log::open(file)?.0 {
            Log::Raw { settings, pieces } => raw.push((settings, pieces)),
            bytes => logs.push(log::bytes_of(bytes, &log::name(file))?),
        }
    }
    let bar = screen::bytes(None);
    let Some((first, _)) = raw.first() else {
        let sized = |piece: Piece| {
            let size = match &piece.what {
                What::Bytes { bytes, .. } => bytes.len(),
                _ => 0,
            };
            Ok((piece, size as u64))
        };
        let merged = log::merged(&logs, one_line).into_iter().map(sized);
        return Ok((engine, Box::new(merged), bar));
    };
    ensure!(
        logs.is_empty(),
        "a raw log has all inputs in it: it is replayed without other logs"
    );
    ensure!(
        raw.iter().all(|(settings, _)| settings == first),
        "these raw logs are not parts of one"
    );
    let engine = Engine::new(&Setup::from(&**first))?;
    let pieces = raw.into_iter().flat_map(|(_, pieces)| pieces);
    Ok((engine, Box::new(pieces), bar))
}

type Pieces = Box<dyn Iterator<Item = Result<(Piece, u64)>>>;

fn run_pieces(
    mut engine: Engine,
    pieces: Pieces,
    bar: &ProgressBar,
    watch: Watch,
    say: &mut dyn FnMut(&Piece, Happened<'_>),
    total: &mut u64,
) -> Result<Engine> {
    for piece in pieces {
        let (piece, bytes) = piece?;
        // A command that could not be done then cannot be done now.
        let _ = engine.take(&piece, &mut |happened| say(&piece, happened));
        *total += bytes;
        bar.inc(bytes);
        watch(&engine, bar)?;
    }
    bar.finish_and_clear();
    Ok(engine)
}

/// The bytes of a log, in pieces.
struct Chunks {
    input: Box<dyn std::io::Read>,
    name: String,
    is_over: bool,
}

impl Iterator for Chunks {
    type Item = Result<(Piece, u64)>;

    fn next(&mut self) -> Option<Self::Item> {
        /// Bytes that are read at a time.
        const PIECE: usize = 1 << 14;
        if self.is_over {
            return None;
        }
        let mut bytes = vec![0; PIECE];
        let read = loop {
            match self.input.read(&mut bytes) {
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
                Err(error) => {
                    self.is_over = true;
                    let error = anyhow::Error::new(error);
                    return Some(Err(error.context(format!("cannot read {}", self.name))));
                }
                Ok(read) => break read,
            }
        };
        bytes.truncate(read);
        let what = if read == 0 {
            self.is_over = true;
            // The last line may lack its end.
            What::End { input: 0 }
        } else {
            What::Bytes {
                input: 0,
                bytes,
                is_message: false,
            }
        };
        Some(Ok((Piece { time_ms: 0, what }, read as u64)))
    }
}

/// The names of logs without their directories.
fn title(files: &[PathBuf]) -> String {
    let name = |file: &PathBuf| match file.file_name() {
        Some(name) if file != Path::new("-") => name.to_string_lossy().into_owned(),
        _ => "standard input".into(),
    };
    files.iter().map(name).collect::<Vec<_>>().join(", ")
}

impl Options {
    fn directory(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| {
            let stem = match self.files.first().and_then(|file| file.file_stem()) {
                Some(stem) if stem != "-" => stem,
                _ => "standard-input".as_ref(),
            };
            Path::new("replay").join(stem)
        })
    }
}

#[cfg(test)]
mod tests;
