//! A gateway at the other end of a line: a survey is recorded by it, and the map of that sent to it.

use std::{
    fs,
    io::{Read, Write},
    net::{TcpListener, TcpStream},
    process::{Output, Stdio},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc,
    },
    thread,
    time::{Duration, Instant},
};

use foxhunt::gateway::beacon::{Event, Spot};
use foxhunt_gateways::corridor::{self, EXAMPLE, Gateway};

use crate::program::{Folder, command, printed, run};

const TAG: u32 = 7;

/// A board of a corridor, whose radios hear the tag as the example's map says where it stands; its line loses some sentences.
struct Board {
    address: String,
    is_over: Arc<AtomicBool>,
    /// Maps that came whole.
    maps: mpsc::Receiver<Vec<u8>>,
}

impl Board {
    /// Of each so many sentences, both ways, one is lost.
    fn start(one_of: u64) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let is_over = Arc::new(AtomicBool::new(false));
        let (sender, maps) = mpsc::channel();
        let over = is_over.clone();
        listener.set_nonblocking(true).unwrap();
        thread::spawn(move || {
            let mut gateway = Box::new(Gateway::EMPTY);
            while !over.load(Ordering::Relaxed) {
                match listener.accept() {
                    Ok((stream, _)) => serve(&mut gateway, stream, one_of, &over, &sender),
                    Err(_) => thread::sleep(Duration::from_millis(5)),
                }
            }
        });
        Self {
            address,
            is_over,
            maps,
        }
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
    }
}

/// Until the connection ends.
fn serve(
    gateway: &mut Gateway,
    mut stream: TcpStream,
    one_of: u64,
    is_over: &AtomicBool,
    maps: &mpsc::Sender<Vec<u8>>,
) {
    let config = corridor::config(EXAMPLE);
    let mut room = vec![0; corridor::MAP_BYTES];
    let mut lines = 0;
    let mut is_lost = || {
        lines += 1;
        lines % one_of == 0
    };
    stream.set_nonblocking(false).unwrap();
    stream
        .set_read_timeout(Some(Duration::from_millis(10)))
        .unwrap();
    let begin = Instant::now();
    let mut stands = None;
    let mut bytes = [0; 256];
    let mut line = Vec::new();
    while !is_over.load(Ordering::Relaxed) {
        match stream.read(&mut bytes) {
            Ok(0) => return,
            Ok(read) => line.extend_from_slice(&bytes[..read]),
            Err(_) => {}
        }
        let mut said = String::new();
        while let Some(end) = line.iter().position(|byte| *byte == b'\n') {
            let sentence: Vec<u8> = line.drain(..=end).collect();
            if is_lost() {
                continue;
            }
            for byte in sentence {
                match gateway.push(byte, &config) {
                    Some(Event::Survey(spot)) => stands = spot,
                    Some(Event::MapPiece(piece)) => {
                        if let Ok(Some(_)) = gateway.take_map(&piece, &mut room) {
                            maps.send(room[..piece.total as usize].to_vec()).unwrap();
                        }
                        said += gateway.report();
                    }
                    _ => {}
                }
            }
        }
        if let Some(spot) = stands {
            for packet in packets(&spot, begin.elapsed()) {
                for byte in packet.bytes() {
                    if gateway.push(byte, &config).is_some() {
                        said += gateway.report();
                    }
                }
            }
        }
        for sentence in said.split_inclusive('\n').filter(|_| !is_lost()) {
            if stream.write_all(sentence.as_bytes()).is_err() {
                return;
            }
        }
    }
}

/// A packet of the tag by each radio.
fn packets(spot: &Spot, time: Duration) -> impl Iterator<Item = String> {
    let point = EXAMPLE.lattice().nearest(spot.place);
    let heard = move |beacon: usize| {
        let radio = EXAMPLE.beacon(beacon)?.identifier;
        let mean_dbm = EXAMPLE.moments(beacon, point)?.mean_dbm.round();
        Some(format!(
            "PFOXB,{},{radio},{TAG},{mean_dbm}",
            time.as_millis()
        ))
    };
    (0..EXAMPLE.beacons()).filter_map(move |beacon| Some(foxhunt_decode::sentence(&heard(beacon)?)))
}

/// Records what is heard at places, two seconds at each.
fn record(folder: &Folder, board: &Board, places: &str) -> Output {
    let tag = TAG.to_string();
    let mut child = command(
        folder,
        &[
            "survey",
            "record",
            "survey.csv",
            "--tag",
            &tag,
            "--seconds",
            "2",
            "--tcp",
            &board.address,
        ],
    )
    .stdin(Stdio::piped())
    .stdout(Stdio::piped())
    .stderr(Stdio::piped())
    .spawn()
    .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    stdin.write_all(places.as_bytes()).unwrap();
    drop(stdin);
    child.wait_with_output().unwrap()
}

#[test]
fn a_survey_is_recorded_and_its_map_sent_over_a_line_that_loses_sentences() {
    let folder = Folder::new();
    let board = Board::start(7);
    // What is no place is told, and costs no other; the survey goes on with what was recorded before.
    let first = record(&folder, &board, "5 0\nhere\n15 0\n");
    let said = String::from_utf8_lossy(&first.stderr).into_owned();
    assert_eq!(said, "\"here\": a place is x y, or x y floor\n");
    let told = printed(&first);
    let second = printed(&record(&folder, &board, "25 0\n35.5, 0.25\n45 0\n\n55 0\n"));
    let told: Vec<&str> = told.lines().chain(second.lines()).collect();
    assert_eq!(told.len(), 5, "{told:?}");
    for (line, place) in told
        .iter()
        .zip(["5 0", "15 0", "25 0", "35.5 0.25", "45 0"])
    {
        assert!(line.starts_with(&format!("{place}, floor 0: ")), "{line}");
        assert!(line.contains(" readings, in the mean -"), "{line}");
    }

    let survey = fs::read_to_string(folder.0.join("survey.csv")).unwrap();
    for row in survey.lines().skip(1) {
        let fields: Vec<f64> = row.split(',').map(|field| field.parse().unwrap()).collect();
        let [x, y, _, radio, rssi] = fields[..] else {
            panic!("{row}");
        };
        let point = EXAMPLE.lattice().nearest([x as f32, y as f32]);
        let beacon = EXAMPLE.beacon_index(radio as u32).unwrap();
        let expected = EXAMPLE.moments(beacon, point).unwrap().mean_dbm;
        assert_eq!(rssi, f64::from(expected.round()), "{row}");
    }

    printed(&run(
        &folder,
        &[
            "survey",
            "build",
            "survey.csv",
            "-o",
            "site.map",
            "--spacing",
            "2",
        ],
    ));
    let sent = printed(&run(
        &folder,
        &["survey", "send", "site.map", "--tcp", &board.address],
    ));
    let bytes = fs::read(folder.0.join("site.map")).unwrap();
    let begin = format!(
        "the gateway has checked the map, for its firmware to use: {} bytes, ",
        bytes.len()
    );
    assert!(sent.starts_with(&begin), "{sent}");
    let whole: Vec<Vec<u8>> = board.maps.try_iter().collect();
    assert_eq!(whole, [bytes]);
}

#[test]
fn what_is_no_map_or_fits_nowhere_is_refused_with_the_reason() {
    let folder = Folder::new();
    let board = Board::start(u64::MAX);
    let mut damaged = fs::read(crate::program::example("tunnel.map")).unwrap();
    damaged[100] ^= 1;
    folder.file("damaged.map", damaged);
    folder.file("plane.csv", plane());
    printed(&run(
        &folder,
        &["survey", "build", "plane.csv", "-o", "plane.map"],
    ));
    for (file, why) in [
        ("none.map", "cannot read none.map"),
        ("damaged.map", "damaged.map: "),
        (
            "plane.map",
            "plane.map: the gateway refuses the map, and goes on with its own",
        ),
    ] {
        let output = run(&folder, &["survey", "send", file, "--tcp", &board.address]);
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success(), "{file}");
        assert!(error.starts_with(&format!("error: {why}")), "{error}");
    }
    assert_eq!(board.maps.try_iter().count(), 0);
    // Readings are not mixed with columns of another order.
    folder.file("survey.csv", "x,y,beacon,rssi\n");
    let output = record(&folder, &board, "1 0\n");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(
        error.contains("only added to a survey that begins with x,y,floor"),
        "{error}"
    );
}

/// A survey of a square.
fn plane() -> String {
    let mut csv = String::from("x,y,beacon,rssi\n");
    for (x, y) in (0..36).map(|place| (place % 6, place / 6)) {
        for (beacon, source) in [(1, [0, 0]), (2, [5, 0]), (3, [0, 5])] {
            let [dx, dy] = [x - source[0], y - source[1]];
            let strength = -50.0 - 8.0 * f64::from(1 + dx * dx + dy * dy).log10();
            csv += &format!("{x},{y},{beacon},{strength:.0}\n");
        }
    }
    csv
}
