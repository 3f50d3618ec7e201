//! The page that `foxhunt live` serves, in Chromium: what comes in by UDP is seen, a click takes it back, a reload loses
//! nothing. Without Chromium nothing is tested, which is said.

use std::{
    fs,
    io::{BufRead, BufReader},
    net::UdpSocket,
    path::Path,
    process::{Child, Command, Stdio},
    sync::mpsc::{self, Receiver},
    thread,
    time::{Duration, Instant},
};

use foxhunt_browser::{Browser, program};

/// The state of the page in a few words: how many bearings there are, how many count, and when the answer is of.
const STATE: &str = "(() => { const s = foxhunt.live.store; const all = [...s.bearings.values()];
    return [all.length, all.filter((b) => !b.retracted).length, s.answer?.time_ms ?? 0]; })()";

#[test]
fn what_comes_in_is_seen_on_the_page() {
    let Some(program) = program() else {
        eprintln!("Chromium was not found, so the page was not tested: cargo xtask setup");
        return;
    };
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join("page");
    let mut browser = Browser::start(&program, &directory.join("profile"));
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    let port = free_port();
    let live = Live::start(&directory, &port);
    socket.connect(&port).unwrap();
    let send = |line: &str| {
        socket.send(format!("{line}\r\n").as_bytes()).unwrap();
    };

    let drive = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/data/drive.nmea");
    let drive = fs::read_to_string(drive).unwrap();
    let last = drive.lines().rfind(|line| !line.starts_with('$')).unwrap();
    for line in drive.lines().take_while(|line| *line != last) {
        send(line);
        // A receiver takes much longer, and no line is to be lost.
        thread::sleep(Duration::from_millis(1));
    }
    browser.size(1280, 800, false);
    browser.theme("light");
    browser.open(&live.address);
    browser.wait("foxhunt.live?.store.answer?.sources.length > 0");
    thread::sleep(Duration::from_millis(1_500));

    tiles_are_drawn(&mut browser);
    refusals_are_told(&mut browser, &send);

    let before = state(&mut browser);
    let start = Instant::now();
    send(last);
    browser.wait(&format!(
        "{STATE}[0] > {} && {STATE}[2] > {}",
        before[0], before[2]
    ));
    // Told, not judged: a busy machine is no fault.
    let taken = start.elapsed().as_millis();
    println!("from a datagram to the page: {taken} ms");
    browser.picture(&directory.join("desk.png"));

    retract(&mut browser);
    let after = state(&mut browser);
    browser.picture(&directory.join("retracted.png"));
    browser.open(&live.address);
    browser.wait("foxhunt.live?.store.answer");
    assert_eq!(
        state(&mut browser)[..2],
        after[..2],
        "a reload loses something"
    );
    browser.size(390, 844, true);
    browser.picture(&directory.join("phone.png"));
    browser.click("#undo");
    browser.wait(&format!("{STATE}[1] === {}", after[1] + 1.0));

    let own =
        |address: &&String| address.starts_with(&live.address) || address.starts_with("about:");
    let outside: Vec<&String> = browser.requests.iter().filter(|a| !own(a)).collect();
    assert!(outside.is_empty(), "requests left the machine: {outside:?}");
}

#[test]
fn the_demo_shows_a_drive_and_a_tunnel() {
    let Some(program) = program() else {
        return;
    };
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join("demo");
    let mut browser = Browser::start(&program, &directory.join("profile"));
    let live = Live::run(
        &directory,
        &["live", "--demo", "--speed", "30", "--listen", "127.0.0.1:0"],
    );
    browser.size(1280, 800, false);
    browser.open(&live.address);
    browser.wait("foxhunt.live?.store.answer?.sources.length === 2");
    // Each by the number that outputs tell, too.
    browser.wait(
        "[0, 1].every((n) => document.querySelector('#answer').textContent.includes(`Source ${n}: `))",
    );
    browser.picture(&directory.join("drive.png"));
    // A planned end is no fault.
    let ended = "[...document.querySelectorAll('#health b')].filter((b) => b.textContent.includes(': ended'))";
    browser.wait(&format!("{ended}.length === 2"));
    assert_eq!(
        browser.value(&format!("{ended}.some((b) => b.className === 'bad')")),
        false
    );
    browser.click("#tabs button:nth-child(2)");
    browser.wait("foxhunt.stage.mode.title === 'Site' && foxhunt.live.store.tags.size === 8");
    browser.picture(&directory.join("tunnel.png"));
    // That there is no background is found by asking for it.
    browser.complaints.retain(|text| !text.contains("404"));
    assert!(browser.complaints.is_empty(), "{:?}", browser.complaints);
}

/// Takes the last bearing back by a click on its line, and sees that the fix changes.
fn retract(browser: &mut Browser) {
    let fix = "foxhunt.live.store.answer.sources.map((s) => [s.lat, s.lon]).join()";
    let before = browser.value(fix);
    let at = browser.value(
        "import('./draw.js').then((m) => { const l = foxhunt.live, v = l.stage.view;
         const b = [...l.store.bearings.values()].at(-1);
         const [[a, c], [d, e]] = m.ray(v, l.scene(), b);
         const r = document.querySelector('#canvas').getBoundingClientRect();
         return [r.x + a + 0.2 * (d - a), r.y + c + 0.2 * (e - c)]; })",
    );
    let count = state(browser)[1];
    browser.click_at(at[0].as_f64().unwrap(), at[1].as_f64().unwrap());
    browser.wait("document.querySelector('#retract')");
    browser.click("#retract");
    let text = before.as_str().unwrap();
    browser.wait(&format!(
        "{STATE}[1] === {} && {fix} !== '{text}'",
        count - 1.0
    ));
}

/// A map of fields and roads round the drive, of the levels 10 to 15.
fn map(file: &Path) {
    let _ = fs::remove_file(file);
    let tile = "<svg xmlns='http://www.w3.org/2000/svg' width='256' height='256'><rect width='256' height='256' \
                fill='#f2e3a0'/><path d='M0 90H256M150 0V256' stroke='#b9a24c' stroke-width='9'/></svg>";
    let picture = file.with_file_name("tile");
    foxhunt_host::picture::save(tile, &picture).unwrap();
    let tile = fs::read(picture.with_extension("png")).unwrap();
    let mut tiles = rusqlite::Connection::open(file).unwrap();
    let open = tiles.transaction().unwrap();
    open.execute_batch(
        "CREATE TABLE metadata (name TEXT, value TEXT);
         INSERT INTO metadata VALUES ('format', 'png'), ('attribution', '<a href=\"#\">Nobody</a>');
         CREATE TABLE tiles (zoom_level INTEGER, tile_column INTEGER, tile_row INTEGER, tile_data BLOB);",
    )
    .unwrap();
    for zoom in 10..=15 {
        let side = f64::from(1 << zoom);
        let column = |longitude: f64| ((longitude + 180.0) / 360.0 * side) as u32;
        let row = |latitude: f64| {
            let up = latitude.to_radians().tan().asinh() / std::f64::consts::PI;
            ((1.0 + up) / 2.0 * side) as u32
        };
        for column in column(20.8)..=column(21.3) {
            for row in row(52.1)..=row(52.4) {
                let values = (zoom, column, row, &tile);
                open.execute("INSERT INTO tiles VALUES (?1, ?2, ?3, ?4)", values)
                    .unwrap();
            }
        }
    }
    open.commit().unwrap();
}

/// The fields of the map are nearly everywhere.
fn tiles_are_drawn(browser: &mut Browser) {
    browser.wait(
        "(() => { const c = document.querySelector('#canvas');
         const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
         let fields = 0;
         for (let i = 0; i < d.length; i += 4) fields += d[i] - d[i + 2] > 30 && d[i] > 200;
         return fields > 0.5 * (d.length / 4); })()",
    );
    browser.wait("document.querySelector('#attribution').textContent === 'Map: Nobody'");
}

/// A line that is of no use is told, and why.
fn refusals_are_told(browser: &mut Browser, send: &dyn Fn(&str)) {
    send("$GPRMC,this is,no sentence*00");
    browser.wait("document.querySelector('#refused')?.textContent.includes('this is,no sentence')");
}

fn state(browser: &mut Browser) -> [f64; 3] {
    let state = browser.value(STATE);
    [0, 1, 2].map(|index| state[index].as_f64().unwrap())
}

fn free_port() -> String {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.local_addr().unwrap().to_string()
}

/// The program, for as long as the test runs.
struct Live {
    process: Child,
    said: Receiver<String>,
    address: String,
}

impl Live {
    /// With lines that come by UDP.
    fn start(directory: &Path, input: &str) -> Self {
        let settings = directory.join("foxhunt.toml");
        map(&directory.join("map.mbtiles"));
        let text = format!(
            "[[input]]\nname = \"lines\"\nudp = \"{input}\"\n[web]\ntiles = \"map.mbtiles\"\n"
        );
        fs::write(&settings, text).unwrap();
        let settings = settings.to_str().unwrap();
        let mut live = Self::run(directory, &["live", "--listen", "127.0.0.1:0", settings]);
        live.after("lines: open");
        live
    }

    fn run(directory: &Path, arguments: &[&str]) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_foxhunt"))
            .args(arguments)
            .current_dir(directory)
            .stdin(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let (sender, said) = mpsc::channel();
        let lines = BufReader::new(process.stderr.take().unwrap()).lines();
        thread::spawn(move || {
            lines
                .map_while(Result::ok)
                .all(|line| sender.send(line).is_ok())
        });
        let mut live = Self {
            process,
            said,
            address: String::new(),
        };
        live.address = live.after("page: ");
        live
    }

    /// The rest of the first line that it says and that starts so.
    fn after(&mut self, start: &str) -> String {
        let said = || self.said.recv_timeout(Duration::from_secs(20)).ok();
        let mut rest =
            std::iter::from_fn(said).filter_map(|line| Some(line.strip_prefix(start)?.to_owned()));
        rest.next()
            .unwrap_or_else(|| panic!("it does not say `{start}`"))
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
