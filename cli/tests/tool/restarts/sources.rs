//! Sources that are killed now and then.

use std::{
    io::{ErrorKind, Read, Write},
    net::{Shutdown, TcpListener, TcpStream, UdpSocket},
    process::{Command, Stdio},
    sync::atomic::{AtomicI64, Ordering},
    thread::sleep,
    time::{Duration, Instant},
};

use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus, uniform};
use foxhunt_decode::Navigation;
use serde_json::{Value, json};

/// When everything is, and the seed of what happens.
pub struct Plan {
    end: Instant,
    seed: u64,
    next: AtomicI64,
}

/// The first bearing's time, in milliseconds after 1970, and that from one to the next.
const BEGIN: i64 = 1_795_339_800_000;
const STEP: i64 = 100;

/// Random times.
pub struct Dice(Xoshiro128PlusPlus);

impl Dice {
    pub fn between(&mut self, least: f32, most: f32) -> f32 {
        least + (most - least) * uniform(&mut self.0)
    }

    /// Whether something happens that does so with a probability.
    pub fn is(&mut self, probability: f32) -> bool {
        uniform(&mut self.0) < probability
    }

    /// Sleeps for a time in seconds.
    pub fn sleep(&mut self, least: f32, most: f32) {
        sleep(Duration::from_secs_f32(self.between(least, most)));
    }
}

impl Plan {
    pub fn new(length: Duration, seed: u64) -> Self {
        let end = Instant::now() + length;
        let next = AtomicI64::new(0);
        Self { end, seed, next }
    }

    pub fn goes_on(&self) -> bool {
        Instant::now() < self.end
    }

    /// Random numbers of a source.
    pub fn dice(&self, source: u64) -> Dice {
        Dice(Xoshiro128PlusPlus::seed_from_u64(100 * self.seed + source))
    }

    /// How long a source works until it is killed.
    fn life(&self, dice: &mut Dice) -> Instant {
        let life = Instant::now() + Duration::from_secs_f32(dice.between(0.5, 5.0));
        life.min(self.end)
    }

    /// A time that no other bearing has.
    fn time_ms(&self) -> i64 {
        BEGIN + STEP * self.next.fetch_add(1, Ordering::Relaxed)
    }
}

/// A place 100 m further for each time, again and again, and the bearing from there.
fn place(time_ms: i64) -> (f64, f64) {
    let east = 100.0 * ((time_ms - BEGIN) / STEP % 20) as f64;
    let degrees = (500.0 - east).atan2(1_000.0).to_degrees();
    (11.5 + east / 74_400.0, degrees.rem_euclid(360.0))
}

fn bearing(time_ms: i64, source: &str) -> Value {
    let (longitude, degrees) = place(time_ms);
    json!({
        "type": "BEARING", "bearing_type": "absolute", "source": source, "latitude": 48.1, "longitude": longitude,
        "bearing": degrees, "sigma_deg": 2.0, "timestamp": time_ms as f64 / 1e3,
    })
}

/// What went out over a line.
#[derive(Debug, Default)]
pub struct Sent {
    /// The times of bearings that went out whole.
    pub whole: Vec<i64>,
    /// How many were cut.
    pub cut: u64,
    pub kills: u64,
}

/// A server of lines.
pub fn tcp(plan: &Plan, port: u16) -> Sent {
    let (mut sent, mut dice) = (Sent::default(), plan.dice(1));
    while plan.goes_on() {
        let server = TcpListener::bind(("127.0.0.1", port)).unwrap();
        server.set_nonblocking(true).unwrap();
        let mut stream = loop {
            match server.accept() {
                Ok((stream, _)) => break stream,
                Err(error) if error.kind() != ErrorKind::WouldBlock => panic!("{error}"),
                Err(_) if !plan.goes_on() => return sent,
                Err(_) => sleep(Duration::from_millis(10)),
            }
        };
        let life = plan.life(&mut dice);
        while Instant::now() < life {
            let time = plan.time_ms();
            writeln!(stream, "{}", bearing(time, "tcp")).unwrap();
            sent.whole.push(time);
            dice.sleep(0.3, 0.9);
        }
        if dice.is(0.5) {
            let line = bearing(plan.time_ms(), "tcp").to_string();
            stream
                .write_all(&line.as_bytes()[..line.len() / 2])
                .unwrap();
            sent.cut += 1;
        }
        drop((stream, server));
        sent.kills += 1;
        dice.sleep(0.0, 1.5);
    }
    sent
}

/// The first bearing of all.
pub fn first(plan: &Plan, port: u16) {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let message = bearing(plan.time_ms(), "udp").to_string();
    (socket.send_to(message.as_bytes(), ("127.0.0.1", port))).unwrap();
}

/// Datagrams.
pub fn udp(plan: &Plan, port: u16) -> Sent {
    let (mut sent, mut dice) = (Sent::default(), plan.dice(2));
    while plan.goes_on() {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        let life = plan.life(&mut dice);
        while Instant::now() < life {
            let time = plan.time_ms();
            let message = bearing(time, "udp").to_string();
            (socket.send_to(message.as_bytes(), ("127.0.0.1", port))).unwrap();
            sent.whole.push(time);
            dice.sleep(0.3, 0.9);
        }
        sent.kills += 1;
        dice.sleep(0.0, 1.5);
    }
    sent
}

/// What went out to somebody who acknowledges it.
#[derive(Debug, Default)]
pub struct Posted {
    pub tried: Vec<i64>,
    pub acknowledged: Vec<i64>,
    /// Messages that were said again although they had been taken.
    pub again: u64,
    pub kills: u64,
}

/// Somebody who posts, and is killed before, within and after a post.
pub fn posts(plan: &Plan, port: u16) -> Posted {
    let (mut posted, mut dice) = (Posted::default(), plan.dice(3));
    let open = || TcpStream::connect(("127.0.0.1", port)).unwrap();
    let is_taken = |mut stream: TcpStream| {
        let mut answer = String::new();
        let _ = stream.read_to_string(&mut answer);
        answer.starts_with("HTTP/1.1 200")
    };
    while plan.goes_on() {
        let time = plan.time_ms();
        let body = bearing(time, "posts").to_string();
        let request = format!(
            "POST / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Length: {}\r\n\r\n{body}",
            body.len()
        );
        posted.tried.push(time);
        let mut stream = open();
        if dice.is(0.15) {
            (stream.write_all(&request.as_bytes()[..request.len() - body.len() / 2])).unwrap();
            posted.kills += 1;
        } else {
            stream.write_all(request.as_bytes()).unwrap();
            if dice.is(0.15) {
                // Nobody hears the answer.
                let _ = stream.shutdown(Shutdown::Read);
                posted.kills += 1;
            } else {
                assert!(is_taken(stream), "a post was not taken");
                posted.acknowledged.push(time);
                if dice.is(0.15) {
                    // As if the answer had been lost.
                    let mut stream = open();
                    stream.write_all(request.as_bytes()).unwrap();
                    assert!(is_taken(stream), "a post that is said again is taken");
                    posted.again += 1;
                }
            }
        }
        dice.sleep(0.3, 0.9);
    }
    posted
}

/// Another vehicle, as another client of the broker: killed now and then before it is told that the broker has its message.
pub fn others(plan: &Plan, port: u16) -> Posted {
    let (mut posted, mut dice) = (Posted::default(), plan.dice(4));
    while plan.goes_on() {
        let time = plan.time_ms();
        let (longitude, degrees) = place(time);
        let feature = json!({
            "type": "Feature", "geometry": {"type": "Point", "coordinates": [longitude, 48.1]},
            "properties": {
                "kind": "bearing", "station": "north", "id": time.to_string(), "time_ms": time,
                "bearing_deg": degrees, "sigma_deg": 2.0,
            },
        });
        posted.tried.push(time);
        let mut client = Command::new("mosquitto_pub")
            .args(["-V", "5", "-q", "1", "-p", &port.to_string()])
            .args(["-t", "foxhunt/north/bearing", "-m", &feature.to_string()])
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        if dice.is(0.2) {
            dice.sleep(0.0, 0.02);
            let _ = client.kill();
            posted.kills += 1;
        }
        if client.wait().unwrap().success() {
            posted.acknowledged.push(time);
        }
        dice.sleep(0.3, 0.9);
    }
    posted
}

/// What a receiver of satellites says to gpsd.
pub fn receiver(plan: &Plan, mut line: impl Write) {
    while plan.goes_on() {
        let navigation = Navigation {
            time_ms: BEGIN + STEP * plan.next.load(Ordering::Relaxed),
            latitude: 48.1,
            longitude: 11.5,
            speed_m_s: Some(0.0),
            course_deg: Some(90.0),
            heading_deg: None,
        };
        // Nobody reads it while gpsd is away.
        let _ = line.write_all(&navigation.lines());
        sleep(Duration::from_millis(200));
    }
}
