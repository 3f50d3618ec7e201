//! What a page and another client of the broker hear.

use std::{
    collections::BTreeMap,
    fs::{self, File},
    io::{BufRead, BufReader, Write},
    net::TcpStream,
    path::PathBuf,
    process::{Child, Command},
    sync::{Arc, Mutex},
    thread,
};

use serde_json::Value;

use crate::program::Folder;

/// How often a bearing of a time came.
type Counts = BTreeMap<i64, u32>;

/// The bearings that the page is told.
pub struct Heard(Arc<Mutex<Counts>>);

impl Heard {
    /// From now on.
    pub fn start(address: &str) -> Self {
        let mut stream = TcpStream::connect(address).unwrap();
        write!(
            stream,
            "GET /api/events?after=0 HTTP/1.1\r\nHost: localhost\r\n\r\n"
        )
        .unwrap();
        let counts = Arc::new(Mutex::new(Counts::new()));
        let heard = counts.clone();
        thread::spawn(move || {
            for line in BufReader::new(stream).lines().map_while(Result::ok) {
                let Some(json) = line.strip_prefix("data:") else {
                    continue;
                };
                let message: Value = serde_json::from_str(json).unwrap();
                if message["type"] == "bearing" {
                    let time = message["time_ms"].as_i64().unwrap();
                    *heard.lock().unwrap().entry(time).or_default() += 1;
                }
            }
        });
        Self(counts)
    }

    pub fn bearings(&self) -> Counts {
        self.0.lock().unwrap().clone()
    }
}

/// Another client of the broker, for which the broker keeps what comes while they have no connection.
pub struct Client {
    child: Child,
    file: PathBuf,
}

impl Client {
    pub fn start(folder: &Folder, port: u16) -> Self {
        let file = folder.0.join("published.txt");
        let out = File::create(&file).unwrap();
        let child = Command::new("mosquitto_sub")
            .args(["-V", "5", "-q", "1", "-c", "-x", "3600", "-i", "client"])
            .args(["-p", &port.to_string(), "-t", "foxhunt/own/bearing"])
            .stdout(out)
            .spawn()
            .unwrap();
        Self { child, file }
    }

    /// Ends it; how many messages of different ids each time has.
    pub fn stop(mut self) -> Counts {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").arg(id).status().unwrap().success());
        self.child.wait().unwrap();
        let text = fs::read_to_string(&self.file).unwrap();
        let mut ids = std::collections::BTreeSet::new();
        let mut counts = Counts::new();
        for line in text.lines() {
            let feature: Value = serde_json::from_str(line).unwrap();
            let properties = &feature["properties"];
            if ids.insert(properties["id"].as_str().unwrap().to_owned()) {
                let time = properties["time_ms"].as_i64().unwrap();
                *counts.entry(time).or_default() += 1;
            }
        }
        counts
    }
}
