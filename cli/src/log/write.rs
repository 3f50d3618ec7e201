//! Writes a raw log.

use std::{
    fs::{self, File, OpenOptions},
    io::{BufWriter, Write},
    path::{Path, PathBuf},
};

use anyhow::{Context, Result};

use super::entry::{Entry, Head, VERSION};
use crate::{
    engine::Piece,
    settings::{self, Settings},
};

/// A raw log that is written to. At its size limit another file is begun, with the same first line.
pub struct Writer {
    told: settings::Log,
    head: Vec<u8>,
    file: BufWriter<File>,
    size: u64,
}

impl Writer {
    /// Begins a log; one that is there is kept under another name.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn new(told: &settings::Log, settings: &Settings) -> Result<Self> {
        // A log needs no passwords.
        let mut settings = settings.clone();
        settings.web = settings::Web::default();
        settings.output.clear();
        let head = Head {
            foxhunt: VERSION,
            settings: settings.text()?,
        };
        let mut head = serde_json::to_vec(&head)?;
        head.push(b'\n');
        let file = begin(told, &head)?;
        Ok(Self {
            told: told.clone(),
            size: head.len() as u64,
            head,
            file,
        })
    }

    /// Writes a piece.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&mut self, piece: &Piece) -> Result<()> {
        let mut line = serde_json::to_vec(&Entry::of(piece))?;
        line.push(b'\n');
        let limit = u64::from(self.told.megabytes) * 1_000_000;
        if self.size + line.len() as u64 > limit && self.size > self.head.len() as u64 {
            self.flush()?;
            self.file = begin(&self.told, &self.head)?;
            self.size = self.head.len() as u64;
        }
        self.size += line.len() as u64;
        let name = self.told.file.display();
        (self.file.write_all(&line)).with_context(|| format!("cannot write {name}"))
    }

    /// Writes out what waits in memory.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn flush(&mut self) -> Result<()> {
        let name = self.told.file.display();
        (self.file.flush()).with_context(|| format!("cannot write {name}"))
    }
}

fn begin(told: &settings::Log, head: &[u8]) -> Result<BufWriter<File>> {
    let name = told.file.display();
    let is_there = fs::metadata(&told.file).is_ok_and(|file| file.len() > 0);
    if is_there {
        // One that is not there cannot be renamed.
        for number in (0..told.files.saturating_sub(1)).rev() {
            let _ = fs::rename(rotated(&told.file, number), rotated(&told.file, number + 1));
        }
    }
    let file = OpenOptions::new()
        .create(true)
        .write(true)
        .truncate(true)
        .open(&told.file)
        .with_context(|| format!("cannot write the log {name}"))?;
    let mut file = BufWriter::new(file);
    file.write_all(head)
        .with_context(|| format!("cannot write the log {name}"))?;
    Ok(file)
}

/// The files of a log that was rotated, the oldest first: `log.2.jsonl`, `log.1.jsonl`, `log.jsonl`.
fn rotated(file: &Path, number: u32) -> PathBuf {
    if number == 0 {
        return file.to_owned();
    }
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    match file.extension() {
        Some(ending) => {
            file.with_file_name(format!("{stem}.{number}.{}", ending.to_string_lossy()))
        }
        None => file.with_file_name(format!("{stem}.{number}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotated_files_keep_their_ending() {
        assert_eq!(
            rotated(Path::new("a/log.jsonl"), 2),
            Path::new("a/log.2.jsonl")
        );
        assert_eq!(rotated(Path::new("log"), 1), Path::new("log.1"));
        assert_eq!(rotated(Path::new("log.x"), 0), Path::new("log.x"));
    }
}
