//! Sources and the broker are killed and begun again at random while the program runs: what was acknowledged arrives, is
//! counted once by its id, and every other loss is counted and reported.
//!
//! A short while with a seed, or as long as `FOXHUNT_RESTARTS_SECONDS` says with the seed `FOXHUNT_RESTARTS_SEED`; figures go to
//! the file `FOXHUNT_RESTARTS_JSON`.

mod heard;
mod sources;

use std::{
    collections::BTreeMap,
    env, fs,
    net::TcpListener,
    process::Child,
    thread,
    time::{Duration, Instant},
};

use serde_json::{Value, json};

use crate::{
    broker::Broker,
    live::terminal,
    program::{Folder, Live, free_udp_port},
};
use heard::Heard;
use sources::{Plan, Posted, Sent};

/// Seconds of the short form.
const SHORT: u64 = 15;

fn number(variable: &str, otherwise: u64) -> u64 {
    env::var(variable).map_or(otherwise, |text| text.parse().expect("a number"))
}

/// Ports of everything.
struct Ports {
    tcp: u16,
    udp: u16,
    posts: u16,
    gpsd: u16,
    broker: u16,
}

/// Ports that the system gives to nobody while their owners are away.
fn lasting_ports() -> [u16; 4] {
    let begin = 20_000 + (std::process::id() % 1_000) as u16 * 10;
    let mut free = (begin..).filter(|port| TcpListener::bind(("127.0.0.1", *port)).is_ok());
    [(); 4].map(|()| free.next().unwrap())
}

fn settings(ports: &Ports) -> String {
    let Ports {
        tcp,
        udp,
        posts,
        gpsd,
        broker,
    } = ports;
    format!(
        "name = \"own\"\nlocator = \"plain\"\n\
         [[input]]\nname = \"tcp\"\ntcp = \"127.0.0.1:{tcp}\"\n\
         [[input]]\nname = \"udp\"\nudp = \"127.0.0.1:{udp}\"\n\
         [[input]]\nname = \"posts\"\nhttp-listen = \"127.0.0.1:{posts}\"\n\
         [[input]]\nname = \"gpsd\"\ngpsd = \"127.0.0.1:{gpsd}\"\n\
         [[input]]\nname = \"others\"\nmqtt = {{ broker = \"127.0.0.1:{broker}\" }}\n\
         [[output]]\nname = \"broker\"\nmqtt = {{ broker = \"127.0.0.1:{broker}\", queue = \"queue\" }}\n"
    )
}

#[test]
fn what_was_acknowledged_arrives_whatever_is_killed() {
    let seconds = number("FOXHUNT_RESTARTS_SECONDS", SHORT);
    let seed = number("FOXHUNT_RESTARTS_SEED", 1);
    let folder = Folder::new();
    let [tcp, posts, gpsd_port, broker] = lasting_ports();
    let ports = Ports {
        tcp,
        udp: free_udp_port(),
        posts,
        gpsd: gpsd_port,
        broker,
    };
    let Some(broker) = Broker::start(&folder, ports.broker) else {
        eprintln!("skipped: mosquitto is not installed");
        return;
    };
    let live = Live::start(&folder, &settings(&ports), &["--log", "raw.jsonl"]);
    let heard = Heard::start(&live.address);
    let client = heard::Client::start(&folder, ports.broker);
    live.until("two connections", |live| {
        let health = live.messages("health").pop()?;
        let open = |list: &str, k: usize| health[list][k]["state"] == "open";
        (open("inputs", 4) && open("outputs", 0)).then_some(())
    });
    let plan = Plan::new(Duration::from_secs(seconds), seed);
    // A bearing that is older than the first of all is refused, as it should be.
    sources::first(&plan, ports.udp);
    live.until("the first", |live| (live.bearings() == 1).then_some(()));
    let (sent, kills, _broker) = thread::scope(|scope| {
        let tcp = scope.spawn(|| sources::tcp(&plan, ports.tcp));
        let udp = scope.spawn(|| sources::udp(&plan, ports.udp));
        let posts = scope.spawn(|| sources::posts(&plan, ports.posts));
        let others = scope.spawn(|| sources::others(&plan, ports.broker));
        let gpsd = scope.spawn(|| gpsd(&plan, ports.gpsd));
        let (broker, killed) = brokers(&plan, broker, &folder, ports.broker);
        let sent = [tcp, udp].map(|source| source.join().unwrap());
        let posted = [posts, others].map(|source| source.join().unwrap());
        ((sent, posted), (killed, gpsd.join().unwrap()), broker)
    });
    settle(&live);
    let health = live.messages("health").pop().unwrap();
    let features = client.stop();
    let figures = check(&sent, kills, &heard.bearings(), &features, &health, &live);
    eprintln!("{figures}");
    if let Ok(file) = env::var("FOXHUNT_RESTARTS_JSON") {
        fs::write(file, figures.to_string()).unwrap();
    }
}

/// Waits until nothing is under way any more.
fn settle(live: &Live) {
    let mut last = (Value::Null, Instant::now());
    live.until("quiet", |live| {
        let health = live.messages("health").pop()?;
        let now = json!([health["inputs"][4]["lines"], health["outputs"][0]["sent"]]);
        if now != last.0 {
            last = (now, Instant::now());
        }
        let is_sent = health["outputs"][0]["queued"] == 0;
        // What a broker kept for somebody who was away is told when they are back.
        (is_sent && last.1.elapsed() > Duration::from_secs(5)).then_some(())
    });
}

/// Ends the broker and begins it again, at random; the last one, and how often that was.
fn brokers(plan: &Plan, mut broker: Broker, folder: &Folder, port: u16) -> (Broker, u64) {
    let mut dice = plan.dice(9);
    let mut kills = 0;
    while plan.goes_on() {
        dice.sleep(2.0, 8.0);
        // It saves what it keeps when it is asked to end; if it was killed by force, it would lose what came since it last did.
        broker.end();
        kills += 1;
        dice.sleep(0.0, 2.0);
        broker = Broker::start(folder, port).unwrap();
    }
    (broker, kills)
}

/// gpsd at a pseudo-terminal, killed and begun again; how often. None at all, where there is no gpsd.
fn gpsd(plan: &Plan, port: u16) -> u64 {
    let (line, name) = terminal();
    let start = || -> Option<Child> {
        let mut gpsd = std::process::Command::new("gpsd");
        gpsd.args(["-N", "-n", "-b", "-S", &port.to_string(), &name]);
        gpsd.spawn().ok()
    };
    let mut dice = plan.dice(8);
    thread::scope(|scope| {
        scope.spawn(|| sources::receiver(plan, line));
        let mut kills = 0;
        while let Some(mut gpsd) = start() {
            dice.sleep(2.0, 6.0);
            gpsd.kill().unwrap();
            gpsd.wait().unwrap();
            if !plan.goes_on() {
                return kills;
            }
            kills += 1;
            dice.sleep(0.0, 2.0);
        }
        kills
    })
}

/// How often each time of a list is among bearings: never more than once.
fn missing(times: &[i64], bearings: &BTreeMap<i64, u32>) -> Vec<i64> {
    let is_missing = |time: &&i64| !bearings.contains_key(*time);
    times.iter().filter(is_missing).copied().collect()
}

type All = ([Sent; 2], [Posted; 2]);

fn check(
    ([tcp, udp], [posts, others]): &All,
    (broker_kills, gpsd_kills): (u64, u64),
    bearings: &BTreeMap<i64, u32>,
    features: &BTreeMap<i64, u32>,
    health: &Value,
    live: &Live,
) -> Value {
    // Each has a time of its own, so that it is known by it.
    let twice: Vec<_> = bearings.iter().filter(|(_, count)| **count > 1).collect();
    assert!(twice.is_empty(), "counted twice: {twice:?}");
    for (name, times) in [
        ("tcp", &tcp.whole),
        ("udp", &udp.whole),
        ("posts", &posts.acknowledged),
        ("others", &others.acknowledged),
    ] {
        let missing = missing(times, bearings);
        assert!(missing.is_empty(), "{name} lost {missing:?}: {health}");
        assert!(!times.is_empty(), "{name} hardly said anything");
    }
    let input = |k: usize| &health["inputs"][k];
    let count = |value: &Value| value.as_u64().unwrap_or_default();
    let refused = |k: usize| {
        let all = input(k)["refused"].as_object().unwrap().values();
        all.map(count).sum::<u64>()
    };
    // Lines that were cut when their source was killed are told, and nothing else was refused.
    assert_eq!(refused(0), tcp.cut, "{}", input(0));
    assert_eq!(refused(1), 0, "{}", input(1));
    // What was said again, because nobody had heard that it was taken, is told.
    let again = count(&input(2)["refused"]["message has come before"]);
    assert_eq!(refused(2), again, "{}", input(2));
    assert_eq!(again, posts.again, "{}", input(2));
    // What is published by this vehicle is at the other client, each once by its id.
    let own = bearings.keys().filter(|time| !others.tried.contains(time));
    let own: Vec<i64> = own.copied().collect();
    let unpublished = missing(&own, features);
    assert!(unpublished.is_empty(), "not published: {unpublished:?}");
    assert_eq!(own.len(), features.len());
    let output = &health["outputs"][0];
    assert_eq!((&output["lost"], &output["queued"]), (&json!(0), &json!(0)));
    // Whatever went away is told.
    let said = live.all_said();
    let lost = |name: &str| {
        let start = format!("{name}: lost");
        said.iter().filter(|line| line.starts_with(&start)).count() as u64
    };
    for (name, kills) in [
        ("tcp", tcp.kills),
        ("gpsd", gpsd_kills),
        ("broker", broker_kills),
    ] {
        assert!(lost(name) >= kills, "{name}: {} of {kills}", lost(name));
    }
    json!({
        "kills": {
            "tcp": tcp.kills, "udp": udp.kills, "gpsd": gpsd_kills, "poster": posts.kills,
            "publisher": others.kills, "broker": broker_kills,
        },
        "lines by TCP": {"whole": tcp.whole.len(), "used": tcp.whole.len(), "cut": tcp.cut, "refused": refused(0)},
        "datagrams": {"sent": udp.whole.len(), "used": udp.whole.len()},
        "posts": {
            "tried": posts.tried.len(), "acknowledged": posts.acknowledged.len(),
            "used": used(&posts.tried, bearings), "again": posts.again, "refused as known": again,
        },
        "published by others": {
            "tried": others.tried.len(), "acknowledged": others.acknowledged.len(),
            "used": used(&others.tried, bearings), "refused": input(4)["refused"],
        },
        "published": {"bearings": own.len(), "arrived": features.len(), "acknowledged": output["sent"], "lost": 0},
        "gpsd": {"lines": input(3)["lines"], "used": input(3)["used"], "refused": input(3)["refused"]},
    })
}

fn used(times: &[i64], bearings: &BTreeMap<i64, u32>) -> usize {
    times.len() - missing(times, bearings).len()
}
