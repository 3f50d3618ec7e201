//! Bearings of many stations through a broker into one `foxhunt live`: how late they are taken, and how many it takes.

use std::{
    fs,
    io::{BufRead, BufReader},
    net::{TcpListener, TcpStream},
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::mpsc,
    thread::{self, sleep},
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use anyhow::{Context, Result, ensure};
use serde::Deserialize;

use super::{Published, Running, Step, broker};
use crate::project;

/// The program, built if need be.
pub fn program() -> Result<PathBuf> {
    project::executable(&["--package", "foxhunt-cli", "--bin", "foxhunt"])
}

/// A `foxhunt live` that listens to the broker, and hands on each bearing that it has taken.
fn listener(folder: &Path, broker: u16) -> Result<(Running, TcpStream)> {
    const PATIENCE: Duration = Duration::from_secs(10);
    let program = program()?;
    let port = TcpListener::bind("127.0.0.1:0")?.local_addr()?.port();
    let file = folder.join("listener.toml");
    let text = format!(
        "name = \"listener\"\n[web]\nenabled = false\n\
         [[input]]\nname = \"others\"\nmqtt = {{ broker = \"127.0.0.1:{broker}\" }}\n\
         [[output]]\nname = \"taken\"\ntcp-listen = \"127.0.0.1:{port}\"\nform = \"chasemapper\"\n"
    );
    fs::write(&file, text)?;
    let mut live = Command::new(program);
    live.arg("live").arg(file).stderr(Stdio::null());
    let live = Running::start(&mut live)?;
    let begin = Instant::now();
    loop {
        match TcpStream::connect(("127.0.0.1", port)) {
            Ok(stream) => return Ok((live, stream)),
            Err(_) => ensure!(begin.elapsed() < PATIENCE, "foxhunt live does not begin"),
        }
        sleep(Duration::from_millis(50));
    }
}

/// Publishes bearings, so many a second of each station.
pub fn measured(
    stations: u32,
    seconds: u32,
    rate: f64,
    publisher: &Path,
    folder: &Path,
) -> Result<Step> {
    let (broker, port) = broker(folder)?;
    let (live, stream) = listener(folder, port)?;
    let (sender, taken) = mpsc::channel();
    thread::spawn(move || {
        for line in BufReader::new(stream).lines().map_while(Result::ok) {
            if let Some(latency) = latency(&line)
                && sender.send(latency).is_err()
            {
                return;
            }
        }
    });
    // Until it has subscribed.
    sleep(Duration::from_secs(1));
    let mut publisher = Running::start(
        Command::new(publisher)
            .args(["--broker", &format!("127.0.0.1:{port}")])
            .args(["--gateways", &stations.to_string(), "--tags", "0"])
            .args(["--rate", &rate.to_string()])
            .args(["--seconds", &seconds.to_string()])
            .stdout(Stdio::piped()),
    )?;
    let busy = || [broker.cpu_s(), publisher.cpu_s(), live.cpu_s()];
    sleep(Duration::from_secs(2));
    let (begin, before) = (Instant::now(), busy());
    sleep(Duration::from_secs(u64::from(seconds) - 3));
    let (after, elapsed) = (busy(), begin.elapsed().as_secs_f64());
    let cores = [0, 1, 2].map(|k| (after[k] - before[k]) / elapsed);
    let out = publisher.0.stdout.take().context("it is piped")?;
    let published: Published =
        serde_json::from_reader(out).context("the publisher has failed: see above")?;
    let mut latencies = all_taken(&taken);
    ensure!(!latencies.is_empty(), "no bearing was taken");
    latencies.sort_by(f64::total_cmp);
    Ok(Step::of(rate, &published, &latencies, cores))
}

/// All that comes until nothing more does, for half a minute at most.
fn all_taken(taken: &mpsc::Receiver<f64>) -> Vec<f64> {
    const QUIET: Duration = Duration::from_secs(2);
    const MOST: Duration = Duration::from_secs(30);
    let begin = Instant::now();
    let mut all = Vec::new();
    while let Ok(latency) = taken.recv_timeout(QUIET) {
        all.push(latency);
        if begin.elapsed() > MOST {
            break;
        }
    }
    all
}

/// Seconds since the bearing of a line was taken by its station; `None` if the line is of no bearing.
fn latency(line: &str) -> Option<f64> {
    #[derive(Deserialize)]
    struct Line {
        r#type: String,
        timestamp: Option<f64>,
    }
    let line: Line = serde_json::from_str(line).ok()?;
    let time = line.timestamp.filter(|_| line.r#type == "BEARING")?;
    let now = SystemTime::now().duration_since(UNIX_EPOCH).ok()?;
    Some(now.as_secs_f64() - time)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_bearings_tell_when() {
        let late = latency("{\"type\":\"BEARING\",\"timestamp\":0.0}");
        assert!(late.is_some_and(|seconds| seconds > 1e9));
        let source = "{\"type\":\"PAYLOAD_SUMMARY\",\"time\":\"09:30:00\"}";
        assert_eq!(latency(source), None);
        assert_eq!(latency("no JSON"), None);
    }
}
