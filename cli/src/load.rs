//! Many gateways at once, for a study of what a broker and another `foxhunt live` take: tags or bearings, published by the code of
//! `foxhunt live`.

use std::{
    f64::consts::TAU,
    sync::{Arc, atomic::Ordering::Relaxed},
    time::Duration,
};

use anyhow::{Context, Result, ensure};
use foxhunt_host::geodesy::Place;
use serde::Serialize;
use tokio::time::{Instant, MissedTickBehavior, interval, sleep};

use crate::{
    engine::message::{Bearing, Message, State, Tag},
    live::{
        Status,
        hub::{Hub, Out},
        now_ms,
    },
    output,
    settings::{Mqtt, Name, Output, Settings},
};

/// What is published.
#[derive(Debug, Clone)]
pub struct Load {
    /// The broker: host and port.
    pub broker: String,
    /// Gateways, each with a connection of its own.
    pub gateways: usize,
    /// Tags of each; none, if each is a station that takes bearings.
    pub tags: usize,
    /// Fixes a second of each tag, or bearings a second of each station.
    pub rate: f64,
    /// For so long.
    pub seconds: f64,
}

/// What became of it.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Published {
    /// Fixes or bearings that were handed to the outputs.
    pub fixes: u64,
    /// Messages that the broker has acknowledged; of health, too.
    pub acknowledged: u64,
    /// Messages that were given up.
    pub lost: u64,
    /// Messages that still wait.
    pub queued: u64,
    /// For how long fixes were handed out: longer than asked for, if this machine is too slow.
    pub seconds: f64,
}

struct Gateway {
    hub: Arc<Hub>,
    status: Arc<Status>,
}

/// Publishes, and waits a little for the broker.
///
/// # Errors
/// If the broker is not there.
pub fn publish(load: &Load) -> Result<Published> {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .enable_all()
        .build()
        .context("cannot begin")?;
    runtime.block_on(run(load))
}

async fn run(load: &Load) -> Result<Published> {
    const PATIENCE: Duration = Duration::from_secs(10);
    let mut gateways = Vec::with_capacity(load.gateways);
    for number in 0..load.gateways {
        gateways.push(gateway(load, number).await?);
    }
    let is_open = |gateway: &Gateway| gateway.status.state().0 == State::Open;
    ensure!(
        until(PATIENCE, || gateways.iter().all(is_open)).await,
        "the broker {} does not take {} connections",
        load.broker,
        load.gateways
    );
    let begin = Instant::now();
    let fixes = fixes(load, &gateways).await;
    let seconds = begin.elapsed().as_secs_f64();
    let is_done = |gateway: &Gateway| {
        gateway.status.read.load(Relaxed) >= gateway.hub.seq()
            && gateway.status.queued.load(Relaxed) == 0
    };
    until(PATIENCE, || gateways.iter().all(is_done)).await;
    let mut published = Published {
        fixes,
        seconds,
        ..Published::default()
    };
    for Gateway { status, .. } in &gateways {
        published.acknowledged += status.sent.load(Relaxed);
        published.lost += status.lost.load(Relaxed);
        published.queued += status.queued.load(Relaxed);
    }
    Ok(published)
}

async fn until(patience: Duration, is: impl Fn() -> bool) -> bool {
    let end = Instant::now() + patience;
    while !is() {
        if Instant::now() > end {
            return false;
        }
        sleep(Duration::from_millis(20)).await;
    }
    true
}

async fn gateway(load: &Load, number: usize) -> Result<Gateway> {
    let name = Name::try_from(format!("gateway-{number}")).map_err(anyhow::Error::msg)?;
    let settings = Settings {
        name,
        ..Settings::default()
    };
    let output = Output {
        mqtt: Some(Mqtt {
            broker: load.broker.clone(),
            ..Mqtt::default()
        }),
        ..Output::default()
    };
    let hub = Arc::new(Hub::new(now_ms() as u64));
    let status = Arc::new(Status::quiet(&settings.name));
    output::start(&settings, &output, hub.reader(hub.seq()), status.clone()).await?;
    Ok(Gateway { hub, status })
}

/// Hands out fixes at the rate, those of all gateways in turn; says how many.
async fn fixes(load: &Load, gateways: &[Gateway]) -> u64 {
    let all = (load.gateways * load.tags.max(1)) as u64;
    let wanted = (all as f64 * load.rate * load.seconds).round() as u64;
    let begin = Instant::now();
    let mut every = interval(Duration::from_millis(5));
    every.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut count = 0;
    while count < wanted && begin.elapsed().as_secs_f64() < 2.0 * load.seconds {
        every.tick().await;
        let due = begin.elapsed().as_secs_f64() * all as f64 * load.rate;
        while count < wanted && (count as f64) < due {
            let (gateway, tag) = (
                count as usize % load.gateways,
                count as usize / load.gateways,
            );
            let message = match load.tags {
                0 => Message::Bearing(bearing(gateway, load.gateways, count)),
                tags => Message::Tag(fix((tag % tags) as u32, count)),
            };
            gateways[gateway].hub.add([Out::Message(Box::new(message))]);
            count += 1;
        }
    }
    count
}

/// A fix of a tag in a tunnel; where it is makes no difference.
fn fix(id: u32, count: u64) -> Tag {
    let x = (count % 30_000) as f64 / 1_000.0;
    Tag {
        id,
        site: "tunnel".into(),
        time_ms: now_ms(),
        x,
        y: 0.0,
        covariance: [1.5625, 0.0, 0.0],
        lat: Some(52.229_675_6 + 1e-5 * x),
        lon: Some(21.012_228_7),
        state: "TRACKING".into(),
        floor: None,
        floor_probability: None,
        room: None,
        room_probability: None,
    }
}

/// A bearing of a station: all stand round the source, a kilometre from it.
fn bearing(station: usize, stations: usize, count: u64) -> Bearing {
    const CENTRE: Place = Place {
        latitude: 52.229_675_6,
        longitude: 21.012_228_7,
    };
    const RADIUS_M: f64 = 1_000.0;
    const SIGMA_DEG: f64 = 3.0;
    let angle = TAU * station as f64 / stations as f64;
    let place = CENTRE.offset([RADIUS_M * angle.sin(), RADIUS_M * angle.cos()]);
    // Errors that are spread evenly, by the golden ratio.
    let error = (count as f64 * 0.618_034).fract() - 0.5;
    let degrees = angle.to_degrees() + 180.0 + SIGMA_DEG * 12f64.sqrt() * error;
    Bearing {
        id: count,
        receiver: "finder".into(),
        time_ms: now_ms(),
        lat: place.latitude,
        lon: place.longitude,
        bearing_deg: degrees.rem_euclid(360.0),
        sigma_deg: SIGMA_DEG,
        used: true,
        reason: None,
        outlier: None,
        is_of_others: false,
    }
}
