//! The task `load`: how many tags a broker on this computer takes, or how many bearings of others one `foxhunt live` does, and
//! what gives way first.

mod bearings;

use std::{
    fs::{self, File},
    net::{TcpListener, TcpStream},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, ensure};
use comfy_table::{Table, presets::ASCII_MARKDOWN};
use foxhunt_host::figures::Figure;
use indicatif::ProgressBar;
use serde::Deserialize;

use crate::{
    figures, project,
    setup::{self, Need},
};

/// The options of `cargo xtask load`.
#[derive(clap::Args)]
pub struct Options {
    /// Gateways, each with a connection of its own.
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=900))]
    gateways: u32,
    /// Tags of each gateway. Each has a fix a second at first, then twice as many, until the limit is found.
    #[arg(long, default_value_t = 50, value_parser = clap::value_parser!(u32).range(1..=1_000))]
    tags: u32,
    /// Bearings of so many stations, into one `foxhunt live`, in place of tags.
    #[arg(long, value_name = "STATIONS", value_parser = clap::value_parser!(u32).range(1..=63))]
    stations: Option<u32>,
    /// Seconds for which each rate is held.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(4..=60))]
    seconds: u32,
    /// Write the figures to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// What became of the fixes that were published, as the publisher prints it.
#[derive(Debug, Deserialize)]
struct Published {
    fixes: u64,
    lost: u64,
    queued: u64,
    seconds: f64,
}

/// What was found at a rate.
struct Step {
    /// Fixes a second of each tag, or bearings of each station.
    rate: f64,
    /// Those a second of all, as they were published.
    published: f64,
    /// Messages that did not arrive.
    lost: u64,
    /// Seconds from a fix to its arrival at another client: half of them, and 99 of 100.
    latency: [f64; 2],
    /// Of a processor core, by the broker, the publisher and the other client.
    cores: [f64; 3],
}

impl Step {
    /// Of latencies from the least to the largest, in seconds.
    fn of(rate: f64, published: &Published, latencies: &[f64], cores: [f64; 3]) -> Self {
        let at = |part: f64| latencies[((latencies.len() - 1) as f64 * part) as usize];
        let missing = published.fixes.saturating_sub(latencies.len() as u64);
        Self {
            rate,
            published: published.fixes as f64 / published.seconds,
            lost: missing.max(published.lost + published.queued),
            latency: [at(0.5), at(0.99)],
            cores,
        }
    }
}

/// Seconds beyond which a map is not live any more.
const LATE: f64 = 1.0;

impl Step {
    /// Whether everything came in time, and was published at the rate that was asked for.
    fn holds(&self, options: &Options) -> bool {
        let wanted = f64::from(options.all()) * self.rate;
        self.lost == 0 && self.latency[1] <= LATE && self.published > 0.95 * wanted
    }

    fn figures(&self, options: &Options) -> Vec<Figure> {
        let of = options.stations.map_or("", |_| "bearings.");
        let all = f64::from(options.all()) * self.rate;
        let name = |what: &str| format!("load.{of}{all}_a_second.{what}");
        let [broker, publisher, client] = self.cores;
        vec![
            Figure::new(name("published"), self.published, "messages/s"),
            Figure::new(name("lost"), self.lost as f64, "messages"),
            Figure::new(name("latency_p50"), 1e3 * self.latency[0], "ms"),
            Figure::new(name("latency_p99"), 1e3 * self.latency[1], "ms"),
            Figure::new(name("broker"), broker, "cores"),
            Figure::new(name("publisher"), publisher, "cores"),
            Figure::new(name("client"), client, "cores"),
        ]
    }
}

/// Runs the task.
pub fn run(options: &Options) -> Result<()> {
    let steps = study(options)?;
    let mut table = Table::new();
    table.load_style(ASCII_MARKDOWN).set_header([
        "a second of each",
        "published/s",
        "lost",
        "p50, ms",
        "p99, ms",
        "broker, cores",
        "publisher, cores",
        "client, cores",
        "",
    ]);
    for step in &steps {
        let [broker, publisher, client] = step.cores.map(|cores| format!("{cores:.2}"));
        table.add_row([
            format!("{}", step.rate),
            format!("{:.0}", step.published),
            step.lost.to_string(),
            format!("{:.1}", 1e3 * step.latency[0]),
            format!("{:.1}", 1e3 * step.latency[1]),
            broker,
            publisher,
            client,
            if step.holds(options) { "" } else { "too much" }.into(),
        ]);
    }
    let what = match options.stations {
        Some(stations) => {
            format!("bearings of {stations} stations through mosquitto into one `foxhunt live`")
        }
        None => format!(
            "{} gateways with {} tags each through mosquitto",
            options.gateways, options.tags
        ),
    };
    println!("{what}\n{table}");
    let all: Vec<Figure> = steps
        .iter()
        .flat_map(|step| step.figures(options))
        .collect();
    if let Some(file) = &options.json {
        figures::write_json(&all, file)?;
    }
    let first = steps.first().context("no rate was tried")?;
    ensure!(
        first.holds(options),
        "one a second of each of {} is too much for this computer",
        options.all()
    );
    Ok(())
}

/// As a check: 200 gateways with 50 tags each.
pub fn check() -> Result<()> {
    run(&Options {
        gateways: 200,
        tags: 50,
        stations: None,
        seconds: 10,
        json: None,
    })
}

impl Options {
    /// Tags or stations.
    fn all(&self) -> u32 {
        self.stations.unwrap_or(self.gateways * self.tags)
    }
}

/// Doubles the rate until it is too much; halves it, if it was at first.
fn study(options: &Options) -> Result<Vec<Step>> {
    /// Doublings at most: what is told in the end takes less than four minutes.
    const MOST: i32 = 6;
    setup::ensure(&[Need::Mosquitto])?;
    let publisher = project::executable(&["--package", "foxhunt-cli", "--example", "load"])?;
    if options.stations.is_some() {
        bearings::program()?;
    }
    let folder = project::target_directory()?.join("load");
    fs::create_dir_all(&folder)?;
    let bar = ProgressBar::new_spinner();
    bar.enable_steady_tick(Duration::from_millis(200));
    let mut steps: Vec<Step> = Vec::new();
    for doublings in 0..MOST {
        let is_down = steps.first().is_some_and(|first| !first.holds(options));
        let rate = 2f64.powi(if is_down { -doublings } else { doublings });
        bar.set_message(format!("{rate} a second of each"));
        let step = match options.stations {
            Some(stations) => {
                bearings::measured(stations, options.seconds, rate, &publisher, &folder)?
            }
            None => measured(options, rate, &publisher, &folder)?,
        };
        let is_over = !steps.is_empty() && step.holds(options) == is_down;
        steps.push(step);
        if is_over {
            break;
        }
    }
    bar.finish_and_clear();
    Ok(steps)
}

/// A process that is killed when it is of no use any more.
struct Running(Child);

impl Running {
    fn start(command: &mut Command) -> Result<Self> {
        let line = project::command_line(command);
        let child = command.stdin(Stdio::null()).spawn();
        Ok(Self(child.with_context(|| format!("cannot run {line}"))?))
    }

    /// Seconds for which it has kept a core busy; not a number where the system does not tell.
    fn cpu_s(&self) -> f64 {
        /// Of which a second has so many, whatever the machine.
        const TICKS: f64 = 100.0;
        let stat = fs::read_to_string(format!("/proc/{}/stat", self.0.id())).unwrap_or_default();
        // The name before may hold blanks; its own time and that of the kernel are the 12th and 13th of the rest.
        let rest = stat.rsplit(')').next().unwrap_or_default();
        let ticks = |place| rest.split_whitespace().nth(place)?.parse::<f64>().ok();
        ticks(11)
            .zip(ticks(12))
            .map_or(f64::NAN, |(own, kernel)| (own + kernel) / TICKS)
    }

    /// Asks it to end, and waits for that.
    fn end(&mut self) -> Result<()> {
        let id = self.0.id().to_string();
        project::run(Command::new("kill").arg(id))?;
        self.0.wait()?;
        Ok(())
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A broker that loses nothing by its settings.
fn broker(folder: &Path) -> Result<(Running, u16)> {
    const PATIENCE: Duration = Duration::from_secs(5);
    let port = TcpListener::bind("127.0.0.1:0")?.local_addr()?.port();
    let file = folder.join("mosquitto.conf");
    let text = format!(
        "listener {port} 127.0.0.1\nallow_anonymous true\nmax_queued_messages 0\nmax_connections -1\n"
    );
    fs::write(&file, text)?;
    let mut mosquitto = Command::new("mosquitto");
    mosquitto.arg("-c").arg(file).stderr(Stdio::null());
    let broker = Running::start(&mut mosquitto)?;
    let begin = Instant::now();
    while TcpStream::connect(("127.0.0.1", port)).is_err() {
        ensure!(begin.elapsed() < PATIENCE, "mosquitto does not listen");
        sleep(Duration::from_millis(50));
    }
    Ok((broker, port))
}

fn measured(options: &Options, rate: f64, publisher: &Path, folder: &Path) -> Result<Step> {
    let (broker, port) = broker(folder)?;
    let heard = folder.join("heard.txt");
    let port_text = port.to_string();
    let mut client = Running::start(
        Command::new("mosquitto_sub")
            .args(["-V", "5", "-q", "1", "-p", &port_text])
            .args(["-t", "foxhunt/+/tag/#", "-F", "%U %p"])
            .stdout(File::create(&heard)?),
    )?;
    sleep(Duration::from_millis(500));
    let mut publisher = Running::start(
        Command::new(publisher)
            .args(["--broker", &format!("127.0.0.1:{port}")])
            .args(["--gateways", &options.gateways.to_string()])
            .args(["--tags", &options.tags.to_string()])
            .args(["--rate", &rate.to_string()])
            .args(["--seconds", &options.seconds.to_string()])
            .stdout(Stdio::piped()),
    )?;
    // Once all are connected, until shortly before the end.
    let busy = || [broker.cpu_s(), publisher.cpu_s(), client.cpu_s()];
    sleep(Duration::from_secs(2));
    let (begin, before) = (Instant::now(), busy());
    sleep(Duration::from_secs(u64::from(options.seconds) - 3));
    let (after, elapsed) = (busy(), begin.elapsed().as_secs_f64());
    let cores = [0, 1, 2].map(|k| (after[k] - before[k]) / elapsed);
    let out = publisher.0.stdout.take().context("it is piped")?;
    let published: Published =
        serde_json::from_reader(out).context("the publisher has failed: see above")?;
    settled(&heard)?;
    client.end()?;
    let latencies = latencies(&fs::read_to_string(&heard)?)?;
    ensure!(!latencies.is_empty(), "nothing arrived");
    Ok(Step::of(rate, &published, &latencies, cores))
}

/// Waits until nothing more comes, for a few seconds at most.
fn settled(file: &Path) -> Result<()> {
    let mut last = 0;
    for _ in 0..8 {
        sleep(Duration::from_secs(1));
        let size = fs::metadata(file)?.len();
        if size == last {
            break;
        }
        last = size;
    }
    Ok(())
}

/// Seconds from each fix to its arrival, the shortest first; of messages that came twice, the first.
fn latencies(text: &str) -> Result<Vec<f64>> {
    #[derive(Deserialize)]
    struct Feature<'a> {
        #[serde(borrow)]
        properties: Properties<'a>,
    }
    #[derive(Deserialize)]
    struct Properties<'a> {
        station: &'a str,
        id: &'a str,
        time_ms: u64,
    }
    let mut known = std::collections::HashSet::new();
    let mut latencies = Vec::new();
    for line in text.lines() {
        let (time, feature) = line.split_once(' ').context("a time and a message")?;
        let Properties {
            station,
            id,
            time_ms,
        } = serde_json::from_str::<Feature>(feature)?.properties;
        if known.insert((station, id)) {
            latencies.push(time.parse::<f64>()? - 1e-3 * time_ms as f64);
        }
    }
    latencies.sort_by(f64::total_cmp);
    Ok(latencies)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_that_comes_twice_counts_once() {
        let line = |time: &str, id: u32| {
            format!(
                "{time} {{\"properties\":{{\"station\":\"a\",\"id\":\"{id}\",\"time_ms\":1000}}}}\n"
            )
        };
        let text = line("1.5", 1) + &line("1.25", 2) + &line("2.5", 1);
        assert_eq!(latencies(&text).unwrap(), [0.25, 0.5]);
    }
}
