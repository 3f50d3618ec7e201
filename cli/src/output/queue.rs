//! Messages that wait for a broker, in memory and in a file, so that they survive a restart.

use std::{
    collections::VecDeque,
    fs::{self, File, OpenOptions},
    io::{BufRead, BufReader, BufWriter, Write},
    path::{Path, PathBuf},
};

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

/// A message that waits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Waiting {
    /// Rises from message to message.
    pub id: u64,
    /// Its topic.
    pub topic: String,
    /// What it says.
    pub payload: String,
}

/// A line of the file.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Line {
    Message(Waiting),
    Acknowledged { acknowledged: u64 },
}

/// Messages in their order.
#[derive(Debug)]
pub struct Queue {
    waiting: VecDeque<Waiting>,
    next: u64,
    limit: usize,
    disk: Option<Disk>,
}

#[derive(Debug)]
struct Disk {
    path: PathBuf,
    file: BufWriter<File>,
    lines: usize,
}

impl Queue {
    /// A queue for at most so many messages, kept in a file of a folder, if there is one.
    ///
    /// # Errors
    /// If the file cannot be read or written.
    pub fn new(folder: Option<&Path>, name: &str, limit: usize) -> Result<Self> {
        let mut queue = Self {
            waiting: VecDeque::new(),
            next: 1,
            limit: limit.max(1),
            disk: None,
        };
        if let Some(folder) = folder {
            fs::create_dir_all(folder)
                .with_context(|| format!("cannot make {}", folder.display()))?;
            let path = folder.join(format!("{name}.jsonl"));
            queue.load(&path)?;
            queue.disk = Some(queue.written(&path)?);
        }
        Ok(queue)
    }

    fn load(&mut self, path: &Path) -> Result<()> {
        let Ok(file) = File::open(path) else {
            return Ok(());
        };
        for line in BufReader::new(file).split(b'\n') {
            let line = line.with_context(|| format!("cannot read {}", path.display()))?;
            // The last line of a program that was killed may be cut.
            match serde_json::from_slice(&line) {
                Ok(Line::Message(message)) => {
                    self.next = self.next.max(message.id + 1);
                    self.waiting.push_back(message);
                }
                Ok(Line::Acknowledged { acknowledged }) => self.remove(acknowledged),
                Err(_) => {}
            }
        }
        Ok(())
    }

    fn remove(&mut self, id: u64) {
        let place = self.waiting.binary_search_by_key(&id, |waiting| waiting.id);
        if let Ok(place) = place {
            self.waiting.remove(place);
        }
    }

    /// The file, with nothing but what waits.
    fn written(&self, path: &Path) -> Result<Disk> {
        let new = path.with_extension("new");
        let cannot = || format!("cannot write {}", new.display());
        let mut file = BufWriter::new(File::create(&new).with_context(cannot)?);
        for waiting in &self.waiting {
            serde_json::to_writer(&mut file, &waiting)?;
            file.write_all(b"\n")?;
        }
        file.flush().with_context(cannot)?;
        drop(file);
        fs::rename(&new, path).with_context(cannot)?;
        let file = OpenOptions::new()
            .append(true)
            .open(path)
            .with_context(cannot)?;
        Ok(Disk {
            path: path.to_owned(),
            file: BufWriter::new(file),
            lines: self.waiting.len(),
        })
    }

    fn write(&mut self, line: &Line) -> Result<()> {
        let Some(disk) = &mut self.disk else {
            return Ok(());
        };
        serde_json::to_writer(&mut disk.file, line)?;
        disk.file.write_all(b"\n")?;
        disk.lines += 1;
        // What was acknowledged takes no more room than what waits.
        if disk.lines > 2 * self.waiting.len() + 10_000 {
            let path = disk.path.clone();
            self.disk = Some(self.written(&path)?);
        }
        Ok(())
    }

    /// Adds a message; says how many of the oldest were given up for it.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn push(&mut self, topic: String, payload: String) -> Result<u64> {
        let message = Waiting {
            id: self.next,
            topic,
            payload,
        };
        self.next += 1;
        self.write(&Line::Message(message.clone()))?;
        self.waiting.push_back(message);
        let mut lost = 0;
        while self.waiting.len() > self.limit {
            if let Some(oldest) = self.waiting.pop_front() {
                let acknowledged = oldest.id;
                self.write(&Line::Acknowledged { acknowledged })?;
                lost += 1;
            }
        }
        Ok(lost)
    }

    /// The broker has a message.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn acknowledged(&mut self, id: u64) -> Result<()> {
        self.remove(id);
        self.write(&Line::Acknowledged { acknowledged: id })
    }

    /// The first message after a number.
    pub fn after(&self, id: u64) -> Option<&Waiting> {
        let place = self.waiting.partition_point(|waiting| waiting.id <= id);
        self.waiting.get(place)
    }

    /// How many wait.
    pub fn len(&self) -> usize {
        self.waiting.len()
    }

    /// Writes out what waits in memory.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn flush(&mut self) -> Result<()> {
        match &mut self.disk {
            Some(disk) => {
                (disk.file.flush()).with_context(|| format!("cannot write {}", disk.path.display()))
            }
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_waits_survives_a_restart() {
        let folder = std::env::temp_dir().join(format!("foxhunt-queue-{}", std::process::id()));
        let open = || Queue::new(Some(&folder), "broker", 4).unwrap();
        let mut queue = open();
        for k in 1..=5 {
            let lost = queue.push("topic".into(), k.to_string()).unwrap();
            assert_eq!(lost, u64::from(k == 5));
        }
        queue.acknowledged(3).unwrap();
        queue.flush().unwrap();
        drop(queue);
        // Killed while it wrote.
        let file = OpenOptions::new()
            .append(true)
            .open(folder.join("broker.jsonl"));
        file.unwrap().write_all(b"{\"id\":9,\"to").unwrap();
        let mut queue = open();
        assert_eq!(queue.len(), 3);
        let ids = [0, 2, 4].map(|id| queue.after(id).unwrap().id);
        assert_eq!(ids, [2, 4, 5]);
        assert_eq!(queue.after(5), None);
        queue.push("topic".into(), "6".into()).unwrap();
        assert_eq!(queue.after(5).unwrap().payload, "6");
        for _ in 0..11_000 {
            queue.push("topic".into(), String::new()).unwrap();
        }
        queue.flush().unwrap();
        let size = fs::metadata(folder.join("broker.jsonl")).unwrap().len();
        assert!(size < 1_000_000, "{size}");
        fs::remove_dir_all(folder).unwrap();
    }
}
