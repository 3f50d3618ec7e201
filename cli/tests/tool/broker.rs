//! mosquitto, and another client.

use std::{
    collections::BTreeSet,
    fs,
    io::{BufRead, BufReader, Write},
    net::UdpSocket,
    process::{Child, Command, Stdio},
    sync::mpsc,
    thread,
    time::{Duration, Instant},
};

use serde_json::{Value, json};

use crate::program::{Folder, Live, PATIENCE, free_port, free_udp_port};

/// mosquitto.
pub struct Broker(Child);

impl Broker {
    /// One that keeps what it has in a folder; none, if it is not installed.
    pub fn start(folder: &Folder, port: u16) -> Option<Self> {
        Self::with(folder, port, "allow_anonymous true\n")
    }

    /// The same with settings of who may connect, and how.
    fn with(folder: &Folder, port: u16, access: &str) -> Option<Self> {
        // It keeps what subscribers that are away have not got.
        let settings = format!(
            "listener {port} 127.0.0.1\n{access}user root\npersistence true\nautosave_interval 1\n\
             autosave_on_changes true\nmax_queued_messages 0\npersistence_location {}/\n",
            folder.0.display()
        );
        let file = folder.file("mosquitto.conf", settings);
        let child = Command::new("mosquitto")
            .arg("-c")
            .arg(file)
            .stderr(Stdio::null())
            .stdout(Stdio::null())
            .spawn()
            .ok()?;
        let end = Instant::now() + PATIENCE;
        while std::net::TcpStream::connect(("127.0.0.1", port)).is_err() && Instant::now() < end {
            thread::sleep(Duration::from_millis(50));
        }
        Some(Self(child))
    }

    /// Asks it to end, and waits until it has.
    pub fn end(&mut self) {
        let id = self.0.id().to_string();
        assert!(Command::new("kill").arg(id).status().unwrap().success());
        self.0.wait().unwrap();
    }
}

impl Drop for Broker {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Another client, that prints topics and messages.
struct Client(Child, mpsc::Receiver<(String, Value)>);

impl Client {
    fn start(port: u16, topic: &str) -> Self {
        Self::with(port, topic, &[])
    }

    fn with(port: u16, topic: &str, more: &[&str]) -> Self {
        let mut child = Command::new("mosquitto_sub")
            .args([
                "-V",
                "5",
                "-q",
                "1",
                "-v",
                "-p",
                &port.to_string(),
                "-t",
                topic,
            ])
            .args(more)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let (sender, messages) = mpsc::channel();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        thread::spawn(move || {
            for line in lines.map_while(Result::ok) {
                let (topic, text) = line.split_once(' ').unwrap();
                let message = serde_json::from_str(text).unwrap();
                if sender.send((topic.to_owned(), message)).is_err() {
                    return;
                }
            }
        });
        thread::sleep(Duration::from_millis(300));
        Self(child, messages)
    }

    fn until(&self, what: &str, mut is: impl FnMut(&str, &Value) -> bool) -> Value {
        let end = Instant::now() + PATIENCE;
        while let Some(left) = end.checked_duration_since(Instant::now()) {
            match self.1.recv_timeout(left) {
                Ok((topic, message)) if is(&topic, &message) => return message,
                Ok(_) => {}
                Err(_) => break,
            }
        }
        panic!("never {what}");
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn vehicle(folder: &Folder, name: &str, udp: u16, port: u16, more: &str) -> Live {
    let settings = format!(
        "name = \"{name}\"\nlocator = \"plain\"\n[[input]]\nname = \"horus\"\nudp = \"127.0.0.1:{udp}\"\n{more}\
         [[output]]\nname = \"broker\"\nmqtt = {{ broker = \"127.0.0.1:{port}\", queue = \"queue\" }}\n"
    );
    Live::start(folder, &settings, &[])
}

fn bearing(k: i64, at: f64) -> Vec<u8> {
    let degrees = (500.0 - at).atan2(1_000.0).to_degrees().rem_euclid(360.0);
    json!({
        "type": "BEARING", "bearing_type": "absolute", "latitude": 48.1, "longitude": 11.5 + at / 74_400.0,
        "bearing": degrees, "sigma_deg": 2.0, "timestamp": 1_795_339_800.0 + 10.0 * k as f64,
    })
    .to_string()
    .into_bytes()
}

/// Two vehicles, none of which could locate the source alone, meet at a broker, which is away for a while.
#[test]
fn vehicles_meet_at_a_broker() {
    let folder = Folder::new();
    let port = free_port();
    let Some(broker) = Broker::start(&folder, port) else {
        eprintln!("skipped: mosquitto is not installed");
        return;
    };
    let client = Client::start(port, "foxhunt/#");
    let (north, south) = (Folder::new(), Folder::new());
    let udp = [free_udp_port(), free_udp_port()];
    let others =
        format!("[[input]]\nname = \"others\"\nmqtt = {{ broker = \"127.0.0.1:{port}\" }}\n");
    let one = vehicle(&north, "north", udp[0], port, "");
    let two = vehicle(&south, "south", udp[1], port, &others);
    one.said("broker: open");
    two.said("others: open");
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let mut send = |k: i64| {
        for (station, at) in [(0, 0.0), (1, 1_000.0)] {
            let to = ("127.0.0.1", udp[station]);
            socket.send_to(&bearing(k, at), to).unwrap();
        }
    };
    (0..5).for_each(&mut send);
    two.until("ten bearings", |live| (live.bearings() == 10).then_some(()));
    let fix = two.answer()["sources"][0].clone();
    assert!(
        (fix["lat"].as_f64().unwrap() - 48.109).abs() < 3e-3,
        "{fix}"
    );
    assert!(one.answer()["sources"].as_array().unwrap().is_empty());
    let fix = client.until("a fix", |topic, _| topic == "foxhunt/south/fix/0");
    assert_eq!(fix["geometry"]["type"], "Point");
    assert_eq!(
        fix["properties"]["covariance_m2"].as_array().unwrap().len(),
        3
    );

    // The broker goes, bearings go on, the broker comes back: each arrives, and counts once.
    drop(broker);
    one.said("broker: lost");
    (5..10).for_each(&mut send);
    let _broker = Broker::start(&folder, port).unwrap();
    two.until("twenty bearings", |live| {
        (live.bearings() == 20).then_some(())
    });
    let receivers: BTreeSet<String> = (two.messages("bearing").iter())
        .map(|bearing| bearing["receiver"].as_str().unwrap().to_owned())
        .collect();
    assert_eq!(receivers, ["horus", "north"].map(str::to_owned).into());
    one.until("all sent", |live| {
        let health = live.messages("health").pop()?;
        let output = &health["outputs"][0];
        (output["queued"] == 0 && output["lost"] == 0).then_some(())
    });

    // A vehicle that is killed has said what is said then.
    drop(client);
    let client = Client::start(port, "foxhunt/north/health");
    client.until("open", |_, message| message["state"] == "open");
    drop(one);
    client.until("lost", |_, message| message["state"] == "lost");
    assert!(fs::metadata(north.0.join("queue/broker.jsonl")).is_ok());
}

/// More bearings at once than wait anywhere on the way.
#[test]
fn a_burst_of_bearings_is_taken() {
    const ALL: i64 = 2_000;
    let folder = Folder::new();
    let port = free_port();
    let Some(_broker) = Broker::start(&folder, port) else {
        eprintln!("skipped: mosquitto is not installed");
        return;
    };
    let settings = format!(
        "locator = \"plain\"\n[[input]]\nname = \"others\"\nmqtt = {{ broker = \"127.0.0.1:{port}\" }}\n"
    );
    let live = Live::start(&folder, &settings, &[]);
    live.said("others: open");
    thread::sleep(Duration::from_millis(300));
    let mut publisher = Command::new("mosquitto_pub")
        .args(["-V", "5", "-q", "1", "-l", "-p", &port.to_string()])
        .args(["-t", "foxhunt/other/bearing"])
        .stdin(Stdio::piped())
        .spawn()
        .unwrap();
    let lines: String = (0..ALL)
        .map(|k| {
            let feature = json!({
                "type": "Feature", "geometry": {"type": "Point", "coordinates": [11.5, 48.1]},
                "properties": {
                    "kind": "bearing", "station": "other", "id": k.to_string(), "bearing_deg": 10.0,
                    "sigma_deg": 2.0, "time_ms": 1_795_339_800_000 + 100 * k,
                },
            });
            format!("{feature}\n")
        })
        .collect();
    publisher
        .stdin
        .take()
        .unwrap()
        .write_all(lines.as_bytes())
        .unwrap();
    assert!(publisher.wait().unwrap().success());
    live.until("every bearing", |live| {
        let health = live.messages("health").pop()?;
        (health["inputs"][0]["lines"] == ALL).then_some(())
    });
}

/// A vehicle that is told to end has not been lost.
#[test]
fn a_vehicle_that_is_stopped_says_so() {
    let folder = Folder::new();
    let port = free_port();
    let Some(_broker) = Broker::start(&folder, port) else {
        eprintln!("skipped: mosquitto is not installed");
        return;
    };
    for (name, signal) in [("one", "-INT"), ("two", "-TERM")] {
        let own = Folder::new();
        let live = vehicle(&own, name, free_udp_port(), port, "");
        live.said("broker: open");
        live.end(signal);
        let client = Client::start(port, &format!("foxhunt/{name}/health"));
        let kept = client.until("its health", |_, _| true);
        assert_eq!(kept, json!({"station": name, "state": "stopped"}));
    }
}

/// A broker that wants a password, over TLS.
#[test]
fn a_broker_is_reached_by_tls_and_password() {
    let folder = Folder::new();
    let own = rcgen::generate_simple_self_signed(["localhost".to_owned()]).unwrap();
    let certificate = folder.file("certificate.pem", own.cert.pem());
    let key = folder.file("key.pem", own.signing_key.serialize_pem());
    let passwords = folder.file("passwords", "");
    let made = Command::new("mosquitto_passwd")
        .args(["-b", passwords.to_str().unwrap(), "fox", "secret"])
        .status();
    if made.is_err() {
        eprintln!("skipped: mosquitto is not installed");
        return;
    }
    let port = free_port();
    let [certificate, key, passwords] =
        [certificate, key, passwords].map(|file| file.display().to_string());
    let access = format!(
        "certfile {certificate}\nkeyfile {key}\npassword_file {passwords}\nallow_anonymous false\n"
    );
    let _broker = Broker::with(&folder, port, &access).unwrap();
    let live = |password: &str| {
        let own = Folder::new();
        own.file("password.txt", format!("{password}\n"));
        let settings = format!(
            "name = \"safe\"\n[[input]]\nname = \"a\"\nstdin = true\n[[output]]\nname = \"broker\"\n\
             mqtt = {{ broker = \"localhost:{port}\", user = \"fox\", password-file = \"password.txt\", \
             tls = true, certificates = \"{certificate}\" }}\n"
        );
        (Live::start(&own, &settings, &[]), own)
    };
    let (refused, _folder) = live("wrong");
    refused.said("broker: lost");
    let more = [
        "-h",
        "localhost",
        "--cafile",
        &certificate,
        "-u",
        "fox",
        "-P",
        "secret",
    ];
    let client = Client::with(port, "foxhunt/safe/health", &more);
    let (right, _folder) = live("secret");
    right.said("broker: open");
    client.until("open", |_, message| message["state"] == "open");
}
