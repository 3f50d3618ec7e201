//! Bytes in, results out.

use std::{
    fs,
    io::{Read, Write},
    net::{TcpListener, TcpStream, UdpSocket},
    thread,
    time::{Duration, Instant},
};

use serde_json::{Value, json};

use crate::program::{Folder, Live, PATIENCE, drive, free_port, free_udp_port, post, printed, run};

/// A bearing on a source 1 km north of 48.1, 11.5, as chasemapper is told of it.
fn bearing(k: i64) -> Value {
    let east: f64 = 100.0 * k as f64;
    let degrees = (500.0 - east).atan2(1_000.0).to_degrees().rem_euclid(360.0);
    json!({
        "type": "BEARING", "bearing_type": "absolute", "source": "yagi", "latitude": 48.1,
        "longitude": 11.5 + east / 74_400.0, "bearing": degrees, "sigma_deg": 2.0,
        "timestamp": 1_795_339_800.0 + 10.0 * k as f64,
    })
}

fn send(socket: &UdpSocket, port: u16, message: &Value) {
    let sent = socket.send_to(message.to_string().as_bytes(), ("127.0.0.1", port));
    sent.unwrap();
}

#[test]
fn a_bearing_by_udp_is_a_fix_and_can_be_taken_back() {
    let folder = Folder::new();
    let port = free_udp_port();
    let settings = format!(
        "[[input]]\nname = \"horus\"\nudp = \"127.0.0.1:{port}\"\n\
         [[output]]\nname = \"out\"\nstdout = true\nform = \"geojson\"\n\
         [[output]]\nname = \"cot\"\nfile = \"cot.xml\"\nform = \"cot\"\n"
    );
    let live = Live::start(&folder, &settings, &["--log", "raw.jsonl"]);
    live.said("horus: open");
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    for k in 0..9 {
        send(&socket, port, &bearing(k));
    }
    live.until("nine bearings", |live| (live.bearings() == 9).then_some(()));
    send(&socket, port, &bearing(9));
    live.until("ten bearings", |live| (live.bearings() == 10).then_some(()));
    let fix = live.answer()["sources"][0].clone();
    assert!(
        (fix["lat"].as_f64().unwrap() - 48.109).abs() < 2e-3,
        "{fix}"
    );

    // Taken back by the page, by the station, and what was taken back again.
    let (status, _) = post(&live.address, "/api/retract", "{\"id\": 4}");
    assert_eq!(status, 200);
    let without = live.answer()["sources"][0].clone();
    assert_ne!(without, fix);
    let (status, body) = post(&live.address, "/api/retract", "{\"id\": 4}");
    assert!(
        status == 409 && body.contains("already taken back"),
        "{body}"
    );
    let (status, _) = post(&live.address, "/api/undo", "{}");
    assert_eq!(status, 200);
    assert_eq!(live.answer()["sources"][0], fix);
    let mut delete = bearing(9);
    delete["delete"] = true.into();
    send(&socket, port, &delete);
    live.until("a retract", |live| live.messages("retracted").pop());
    assert_eq!(live.messages("retracted")[0]["by"], "device");
    // Rubbish is counted.
    socket
        .send_to(b"{\"type\":\"BEARING\"}", ("127.0.0.1", port))
        .unwrap();
    socket
        .send_to(b"\xff\xfe\x00rubbish", ("127.0.0.1", port))
        .unwrap();
    let said = live.said("line cannot be parsed: ");
    assert!(said.ends_with("rubbish"), "{said}");
    live.until("two refusals", |live| {
        let health = live.messages("health").pop()?;
        let refused = health["inputs"][0]["refused"].as_object()?.len();
        (refused == 2).then_some(())
    });
    let last = live.answer();
    let out = live.stop();
    let features: Vec<Value> = out
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    assert!(
        features
            .iter()
            .any(|one| one["properties"]["kind"] == "fix")
    );
    another_library_reads_the_events(&folder, &last["sources"][0]);

    // The raw log leads to the same.
    let replayed = run(&folder, &["replay", "raw.jsonl", "--json"]);
    let replayed: Value = serde_json::from_str(&printed(&replayed)).unwrap();
    assert_eq!(replayed["bearings"], 9);
    let row = replayed["fixes"].as_array().unwrap().last().unwrap();
    assert_eq!(row["latitude"], last["sources"][0]["lat"], "{row}");
}

/// Events of Cursor on Target, by a parser of others.
fn another_library_reads_the_events(folder: &Folder, source: &Value) {
    let cot = fs::read_to_string(folder.0.join("cot.xml")).unwrap();
    let cot = cot_proto::detail::parse(cot.lines().last().unwrap()).unwrap();
    assert_eq!((&*cot.uid, &*cot.cot_type), ("foxhunt.vehicle.0", "a-u-G"));
    assert_eq!(
        [cot.point.lat, cot.point.lon].map(Value::from),
        [&source["lat"], &source["lon"]].map(Value::clone)
    );
    assert!(
        (f64::from(cot.point.ce) - source["ellipse"]["semi_major_m"].as_f64().unwrap()).abs()
            < 0.06
    );
    assert_eq!((cot.stale - cot.time).num_seconds(), 120);
    assert!(
        cot.detail
            .iter()
            .any(|one| one == "<contact callsign=\"vehicle fox 0\"/>")
    );
}

#[test]
fn what_is_sent_over_tcp_is_what_the_log_would_give() {
    let folder = Folder::new();
    let (port, out) = (free_port(), free_port());
    let settings = format!(
        "[[input]]\nname = \"line\"\ntcp-listen = \"127.0.0.1:{port}\"\n\
         [[output]]\nname = \"plotter\"\ntcp-listen = \"127.0.0.1:{out}\"\nform = \"nmea\"\n"
    );
    let live = Live::start(&folder, &settings, &[]);
    live.said("line: open");
    let mut plotter = TcpStream::connect(("127.0.0.1", out)).unwrap();
    thread::sleep(Duration::from_millis(200));
    let mut line = TcpStream::connect(("127.0.0.1", port)).unwrap();
    line.write_all(&fs::read(drive()).unwrap()).unwrap();
    drop(line);
    live.until("all bearings", |live| (live.bearings() == 55).then_some(()));
    let answer = live.answer();
    assert_eq!(answer["sources"][0]["lat"], 52.2401175);
    thread::sleep(Duration::from_millis(200));
    live.stop();
    let mut text = String::new();
    plotter.read_to_string(&mut text).unwrap();
    let last = text
        .lines()
        .rfind(|line| line.starts_with("$PFOXF"))
        .unwrap();
    assert!(last.contains(",5214.407"), "{last}");
    assert!(text.contains("$GPWPL,5214.407"));
}

#[test]
fn a_server_that_comes_and_goes_is_found_again() {
    let folder = Folder::new();
    let port = free_port();
    let settings = format!("[[input]]\nname = \"line\"\ntcp = \"127.0.0.1:{port}\"\n");
    let live = Live::start(&folder, &settings, &[]);
    live.said("line: ");
    let log = fs::read(drive()).unwrap();
    let (first, second) = log.split_at(log.len() / 2);
    for part in [first, second] {
        let server = TcpListener::bind(("127.0.0.1", port)).unwrap();
        let (mut stream, _) = server.accept().unwrap();
        stream.write_all(part).unwrap();
        drop(stream);
        drop(server);
        live.said("closed");
    }
    live.until("nearly all bearings", |live| {
        (live.bearings() >= 53).then_some(())
    });
}

#[test]
fn files_grow_and_fall_silent() {
    let folder = Folder::new();
    let file = folder.file("growing.nmea", "");
    let settings = "[[input]]\nname = \"file\"\nfile = \"growing.nmea\"\nsilent-s = 1\n";
    let live = Live::start(&folder, settings, &[]);
    live.said("file: open");
    let mut log = fs::OpenOptions::new().append(true).open(file).unwrap();
    log.write_all(&fs::read(drive()).unwrap()).unwrap();
    live.until("all bearings", |live| (live.bearings() == 55).then_some(()));
    live.said("file: silent");
}

#[test]
fn posts_and_pages_of_a_kraken() {
    let folder = Folder::new();
    let (port, page) = (free_port(), free_port());
    let settings = format!(
        "[[input]]\nname = \"posts\"\nhttp-listen = \"127.0.0.1:{port}\"\n\
         [[input]]\nname = \"page\"\nhttp = \"http://127.0.0.1:{page}/DOA_value.html\"\nevery-ms = 50\n"
    );
    let live = Live::start(&folder, &settings, &[]);
    live.said("posts: open");
    let reading = json!({
        "station_id": "fox", "tStamp": 1_795_339_800_000_i64, "latitude": "48.1", "longitude": "11.5",
        "gpsBearing": "12.5", "radioBearing": "30", "conf": "7.3", "power": "-30", "freq": 433_920_000,
        "antType": "UCA", "latency": 0,
    });
    let address = format!("127.0.0.1:{port}");
    let (status, body) = post(&address, "/anywhere", &reading.to_string());
    assert_eq!(status, 200, "{body}");
    let (status, body) = post(&address, "/", "{\"radioBearing\": \"x\"}");
    assert!(status == 400 && body.contains("tStamp"), "{body}");
    let server = TcpListener::bind(("127.0.0.1", page)).unwrap();
    let line = "1795339801000, 31.0, 7.3, -30, 433920000, UCA, 0, fox, 48.1, 11.5, 12.5, 12.5, GPS, R, R, R, R\n";
    thread::spawn(move || {
        for stream in server.incoming() {
            let mut stream = stream.unwrap();
            let _ = stream.read(&mut [0; 4096]);
            let length = line.len();
            let head =
                format!("HTTP/1.1 200 OK\r\nConnection: close\r\nContent-Length: {length}\r\n\r\n");
            let _ = stream.write_all((head + line).as_bytes());
        }
    });
    live.until("two bearings", |live| (live.bearings() == 2).then_some(()));
    let begin = Instant::now();
    while begin.elapsed() < Duration::from_millis(500) {
        assert_eq!(live.bearings(), 2);
    }
    assert!(begin.elapsed() < PATIENCE);
}

#[test]
fn the_demo_shows_both_kinds() {
    let folder = Folder::new();
    let live = Live::start(&folder, "", &["--demo", "--speed", "200"]);
    let fixes = |live: &Live| {
        let answer = live.messages("answer").pop()?;
        (answer["sources"].as_array()?.len() == 2).then_some(())
    };
    live.until("two sources", fixes);
    live.until("eight tags", |live| {
        (live.messages("tag").len() == 8).then_some(())
    });
    assert_eq!(live.messages("site").len(), 1);
}

/// What a bearing is taken for changes as more is known.
#[test]
fn an_outlier_is_known_when_more_is_known() {
    let folder = Folder::new();
    let port = free_udp_port();
    let settings = format!("[[input]]\nname = \"horus\"\nudp = \"127.0.0.1:{port}\"\n");
    let live = Live::start(&folder, &settings, &[]);
    live.said("horus: open");
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let outlier = |live: &Live| live.messages("bearing")[1]["outlier"].as_f64();
    for k in 0..3 {
        let mut one = bearing(k);
        if k == 1 {
            one["bearing"] = 100.into();
        }
        send(&socket, port, &one);
    }
    live.until("three", |live| (live.bearings() == 3).then_some(()));
    let early = outlier(&live).unwrap_or(0.0);
    for k in 3..10 {
        send(&socket, port, &bearing(k));
    }
    live.until("ten", |live| (live.bearings() == 10).then_some(()));
    let late = outlier(&live).unwrap();
    assert!(early < 0.9 && late > 0.9, "{early} {late}");
}

/// A KrakenSDR's WebSocket, which is closed and opened again.
#[test]
fn a_websocket_is_read() {
    use tokio_tungstenite::tungstenite::{Message, accept};

    let folder = Folder::new();
    let server = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = server.local_addr().unwrap().port();
    let settings =
        format!("[[input]]\nname = \"kraken\"\nwebsocket = \"ws://127.0.0.1:{port}/\"\n");
    let live = Live::start(&folder, &settings, &[]);
    for k in 0..2 {
        let (stream, _) = server.accept().unwrap();
        let mut socket = accept(stream).unwrap();
        socket.send(Message::Ping(Vec::new().into())).unwrap();
        let [text, bytes] = [2 * k, 2 * k + 1].map(|k| bearing(k).to_string());
        socket.send(Message::text(text)).unwrap();
        socket.send(Message::binary(bytes.into_bytes())).unwrap();
        let all = 2 * k as usize + 2;
        live.until("both", |live| (live.bearings() == all).then_some(()));
        drop(socket);
        live.said("kraken: lost");
    }
}

/// A serial port, at the other end of which a receiver and a direction finder speak.
#[test]
#[cfg(target_os = "linux")]
fn a_serial_port_is_read() {
    let folder = Folder::new();
    let (mut line, name) = terminal();
    let settings = format!("[[input]]\nname = \"receiver\"\nserial = \"{name}\"\nbaud = 115200\n");
    let live = Live::start(&folder, &settings, &[]);
    live.said("receiver: open");
    for piece in fs::read(drive()).unwrap().chunks(512) {
        line.write_all(piece).unwrap();
        line.flush().unwrap();
    }
    live.until("all bearings", |live| (live.bearings() == 55).then_some(()));
}

/// gpsd reads a pseudo-terminal, and tells where it is.
#[test]
#[cfg(target_os = "linux")]
fn gpsd_is_read() {
    let is_there = std::process::Command::new("gpsd").arg("-V").output();
    if is_there.is_err() {
        eprintln!("skipped: gpsd is not installed");
        return;
    }
    let folder = Folder::new();
    let (mut line, name) = terminal();
    let port = free_port();
    let mut gpsd = std::process::Command::new("gpsd")
        .args(["-N", "-n", "-b", "-S", &port.to_string(), &name])
        .spawn()
        .unwrap();
    let settings = format!("[[input]]\nname = \"gpsd\"\ngpsd = \"127.0.0.1:{port}\"\n");
    let live = Live::start(&folder, &settings, &[]);
    let log = fs::read_to_string(drive()).unwrap();
    let sentences: Vec<&str> = log
        .lines()
        .filter(|line| line.starts_with("$GPRMC") && line.contains(",A,"))
        .collect();
    let end = Instant::now() + PATIENCE;
    let mut found = false;
    for sentence in sentences.iter().cycle() {
        let _ = line.write_all(format!("{sentence}\r\n").as_bytes());
        thread::sleep(Duration::from_millis(50));
        found = !live.messages("receiver").is_empty();
        if found || Instant::now() > end {
            break;
        }
    }
    let _ = gpsd.kill();
    let _ = gpsd.wait();
    assert!(found, "gpsd told no place");
}

/// The end of a pseudo-terminal that writes, and the name of the other.
#[cfg(target_os = "linux")]
pub fn terminal() -> (impl Write, String) {
    use std::os::unix::fs::OpenOptionsExt;

    use serialport::SerialPort;

    /// It is not to be the terminal of this program.
    const NOCTTY: i32 = 0o400;
    let (own, other) = serialport::TTYPort::pair().unwrap();
    let name = other.name().unwrap();
    // It must stay open, but not locked.
    let open = fs::OpenOptions::new()
        .read(true)
        .custom_flags(NOCTTY)
        .open(&name);
    std::mem::forget(open.unwrap());
    (own, name)
}
