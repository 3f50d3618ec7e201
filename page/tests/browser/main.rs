//! The page in Chromium: alone, it computes what the host computes, to the last bit; live, it shows what it is told.
//!
//! One browser for all, and no more than one at a time. Without Chromium nothing is tested, which is said.

mod server;

use std::{
    env, fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use foxhunt_browser::Browser;
use foxhunt_wasm::{Hunt, Log, LogOptions, Walkers};
use serde_json::{Value, json};
use server::Live;

#[test]
fn the_page_in_a_browser() {
    let Some(program) = foxhunt_browser::program() else {
        eprintln!("Chromium was not found, so the page was not tested: cargo xtask setup");
        return;
    };
    let directory = pictures().join("profile");
    let mut browser = Browser::start(&program, &directory);
    alone(&mut browser);
    live(&mut browser);
    let outside = |address: &&String| {
        let own = ["http://127.0.0.1:", "data:", "blob:", "about:", "chrome:"];
        !own.iter().any(|start| address.starts_with(start))
    };
    bless();
    let strangers: Vec<&String> = browser.requests.iter().filter(outside).collect();
    assert!(
        strangers.is_empty(),
        "requests left the machine: {strangers:?}"
    );
}

fn alone(browser: &mut Browser) {
    let address = server::serve(Arc::new(Live::default()));
    browser.size(1280, 800, false);
    browser.theme("light");
    browser.open(&address);
    hunts(browser);
    log(browser);
    unreadable(browser);
    walkers(browser);
    // That there is nothing live is found by asking for it.
    browser
        .complaints
        .retain(|text| !text.contains("api/state"));
    assert!(browser.complaints.is_empty(), "{:?}", browser.complaints);
}

/// Every scenario from its beginning to its end, and once to and fro.
fn hunts(browser: &mut Browser) {
    let names = browser.value("import('./scenarios.js').then((m) => Object.keys(m.SCENARIOS))");
    for name in names.as_array().unwrap().iter().filter_map(Value::as_str) {
        browser.value(&format!(
            "(() => {{ const s = document.querySelector('#settings select'); s.value = '{name}';
             s.dispatchEvent(new Event('change')); }})()"
        ));
        let count = browser.value("foxhunt.hunt.state.count").as_u64().unwrap() as usize;
        browser.value(&format!("foxhunt.hunt.player.go({count})"));
        let shown = browser.value("foxhunt.hunt.engine.text");
        let options = browser.value(
            "import('./scenarios.js').then((m) => JSON.stringify(m.engineOptions(foxhunt.hunt.settings)))",
        );
        let mut hunt = Hunt::new(serde_json::from_str(options.as_str().unwrap()).unwrap()).unwrap();
        hunt.seek(count);
        let host = serde_json::to_string(&hunt.state()).unwrap();
        assert!(!hunt.state().answer.sources.is_empty(), "{name}: no fix");
        assert!(
            shown == host.as_str(),
            "{name}: the browser computes otherwise"
        );
        browser.picture(&pictures().join(format!("desk-{name}.png")));
        // Back to the middle, and to the end again.
        browser.value(&format!("foxhunt.hunt.player.go({})", count / 2));
        browser.picture(&pictures().join(format!("desk-{name}-half.png")));
        browser.value(&format!("foxhunt.hunt.player.go({count})"));
        assert_eq!(
            browser.value("foxhunt.hunt.engine.text"),
            shown,
            "{name}: rewound"
        );
    }
    play_by_hand(browser);
}

/// Draws a track and drops a source with the mouse, and plays.
fn play_by_hand(browser: &mut Browser) {
    browser.click("#tool-track");
    for [x, y] in [[200.0, 600.0], [500.0, 600.0], [600.0, 400.0]] {
        browser.click_at(x, y);
    }
    browser.click("#tool-source");
    browser.click_at(420.0, 350.0);
    browser.click("#tool-done");
    browser.wait("foxhunt.hunt.state && foxhunt.hunt.settings.vehicle.corners.length === 3");
    assert_eq!(browser.value("foxhunt.hunt.settings.sources.length"), 1);
    browser.value("foxhunt.hunt.player.speed = 400");
    browser.click("#play");
    browser.wait(
        "!foxhunt.hunt.player.playing && foxhunt.hunt.state.position === foxhunt.hunt.state.count",
    );
    browser.click("#rewind");
    browser.wait("foxhunt.hunt.state.position === 0");
    for _ in 0..3 {
        browser.click("#step");
    }
    browser.wait("foxhunt.hunt.state.position === 3");
    browser.click("#back");
    browser.wait("foxhunt.hunt.state.position === 2");
}

/// A log that is dropped onto the page.
fn log(browser: &mut Browser) {
    let file = root().join("examples/data/drive.nmea");
    let bytes = fs::read(&file).unwrap();
    browser.value(&format!(
        "(() => {{ const data = new DataTransfer(); data.items.add(new File([{}], 'drive.nmea'));
         document.querySelector('#canvas').dispatchEvent(
           new DragEvent('drop', {{ dataTransfer: data, bubbles: true }})); }})()",
        json!(str::from_utf8(&bytes).unwrap()),
    ));
    browser.wait("foxhunt.replay.isDone");
    let shown = browser.value("foxhunt.replay.engine.text");
    let mut log = Log::new(LogOptions { robust: true }).unwrap();
    log.push(&bytes);
    log.push(b"\n");
    assert!(shown == serde_json::to_string(&log.state()).unwrap().as_str());
    browser.picture(&pictures().join("desk-log.png"));
}

/// Files that cannot be read are said to be so, and nothing goes on being read.
fn unreadable(browser: &mut Browser) {
    let drop = |browser: &mut Browser, name: &str| {
        browser.value(&format!(
            "(() => {{ const data = new DataTransfer(); data.items.add(new File(['nothing'], '{name}'));
             document.querySelector('#canvas').dispatchEvent(
               new DragEvent('drop', {{ dataTransfer: data, bubbles: true }})); }})()"
        ));
        browser.wait(&format!(
            "(() => {{ const text = document.querySelector('#panel').textContent;
             return text.includes('{name} cannot be read') && !text.includes('% read'); }})()"
        ));
    };
    drop(browser, "roads.geojson");
    browser.value("foxhunt.replay.engine.pushLog = () => { throw new Error('broken'); }");
    drop(browser, "broken.nmea");
    browser.value("delete foxhunt.replay.engine.pushLog");
}

/// A minute in the tunnel.
fn walkers(browser: &mut Browser) {
    browser.click("#tabs button:last-child");
    browser.wait("foxhunt.walkers.state");
    browser.value("foxhunt.walkers.player.go(160)");
    let shown = browser.value("foxhunt.walkers.engine.text");
    let options = browser.value("JSON.stringify(foxhunt.walkers.options)");
    let mut walkers =
        Walkers::new(&serde_json::from_str(options.as_str().unwrap()).unwrap()).unwrap();
    walkers.seek(40_000);
    let state = walkers.state(40_000);
    assert_eq!(state.tags.len(), 8);
    assert!(shown == serde_json::to_string(&state).unwrap().as_str());
    browser.picture(&pictures().join("desk-tunnel.png"));
    browser.size(390, 844, true);
    browser.picture(&pictures().join("phone-tunnel.png"));
    browser.click("#tabs button:first-child");
    browser.value("foxhunt.hunt.player.go(60)");
    browser.picture(&pictures().join("phone-hunt.png"));
    browser.theme("dark");
    browser.picture(&pictures().join("phone-hunt-dark.png"));
    fingers(browser);
}

/// One finger moves the map, two zoom it.
fn fingers(browser: &mut Browser) {
    browser.fingers(&[[200.0, 300.0]], &[[260.0, 300.0]]);
    assert_eq!(browser.value("foxhunt.stage.view.following"), false);
    let before = browser.value("foxhunt.stage.view.scale").as_f64().unwrap();
    browser.fingers(
        &[[150.0, 300.0], [250.0, 300.0]],
        &[[100.0, 300.0], [300.0, 300.0]],
    );
    let after = browser.value("foxhunt.stage.view.scale").as_f64().unwrap();
    assert!((after / before - 2.0).abs() < 0.1, "{before} {after}");
}

fn live(browser: &mut Browser) {
    let live = Arc::new(Live::default());
    live.tell(&messages(6));
    let address = server::serve(Arc::clone(&live));
    browser.open(&address);
    browser.wait("document.querySelector('#connection').textContent.includes('live')");
    browser.picture(&pictures().join("phone-live-dark.png"));
    browser.theme("light");
    browser.picture(&pictures().join("phone-live.png"));
    browser.size(1280, 800, false);
    browser.wait("document.querySelector('.headline').textContent.includes('Fix')");
    browser.wait("foxhunt.live.shapes && [...foxhunt.live.tiles.kept.values()].some((tile) => tile.complete)");
    browser.picture(&pictures().join("desk-live.png"));
    // A bearing that comes is drawn.
    let start = std::time::Instant::now();
    live.tell(&[bearing(6)]);
    browser.wait("foxhunt.live.store.bearings.size === 7");
    println!(
        "a bearing was shown after {} ms",
        start.elapsed().as_millis()
    );
    // It is selected with a click on its line, and retracted.
    let at = browser.value(
        "import('./draw.js').then((m) => { const l = foxhunt.live, v = l.stage.view;
         const [[a, b], [c, d]] = m.ray(v, l.scene(), l.store.bearings.get(6));
         const r = document.querySelector('#canvas').getBoundingClientRect();
         return [r.x + a + 0.1 * (c - a), r.y + b + 0.1 * (d - b)]; })",
    );
    browser.click_at(at[0].as_f64().unwrap(), at[1].as_f64().unwrap());
    browser.wait("document.querySelector('#retract')");
    browser.picture(&pictures().join("desk-live-selected.png"));
    browser.click("#retract");
    wait_for(&live, "api/retract", &json!({ "id": 6 }));
    live.tell(&[json!({ "type": "retracted", "id": 6, "by": "page" })]);
    browser.wait("foxhunt.live.store.bearings.get(6).retracted");
    browser.click("#undo");
    wait_for(&live, "api/undo", &json!({}));
    browser.click("#tool-mark");
    browser.click_at(400.0, 300.0);
    browser.wait("document.querySelector('#save-mark')");
    browser.click("#save-mark");
    browser.wait("document.querySelector('#popup').hidden");
    // A reload loses nothing.
    browser.open(&address);
    browser.wait("foxhunt.live.store.bearings.get(6).retracted");
    assert!(browser.complaints.is_empty(), "{:?}", browser.complaints);
}

fn wait_for(live: &Live, path: &str, body: &Value) {
    let is_there = || {
        let posted = live.posted.lock().unwrap();
        posted.iter().any(|(to, what)| to == path && what == body)
    };
    for _ in 0..500 {
        if is_there() {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    panic!("{path} was not posted: {:?}", live.posted.lock().unwrap());
}

/// A vehicle and a station with some bearings and an answer, made up.
fn messages(bearings: u32) -> Vec<Value> {
    let mut messages = vec![
        json!({ "type": "receiver", "name": "car", "kind": "vehicle", "lat": 52.2300, "lon": 21.0120, "heading_deg": 80.0, "time_ms": 1_000 }),
        json!({ "type": "receiver", "name": "tower", "kind": "station", "lat": 52.2330, "lon": 21.0250, "time_ms": 1_000 }),
    ];
    for id in 0..bearings {
        let longitude = 21.0120 + 0.0012 * f64::from(id);
        messages.push(json!({ "type": "receiver", "name": "car", "kind": "vehicle", "lat": 52.2300, "lon": longitude, "heading_deg": 88.0, "time_ms": 1_000 + 2_000 * id }));
        messages.push(bearing(id));
    }
    let ellipse = json!({ "semi_major_m": 180.0, "semi_minor_m": 60.0, "angle_deg": 20.0 });
    let particles: Vec<[f64; 2]> = (0..200)
        .map(|k| {
            let (turn, radius) = (2.4 * f64::from(k), 0.0009 * (f64::from(k) / 200.0).sqrt());
            [
                52.2370 + radius * turn.cos(),
                21.0160 + 0.8 * radius * turn.sin(),
            ]
        })
        .collect();
    messages.push(json!({
        "type": "answer", "time_ms": 12_000, "hypotheses": [], "particles": particles,
        "sources": [{ "number": 0, "lat": 52.2370, "lon": 21.0160, "covariance": [900.0, 200.0, 5_000.0],
                      "ellipse": ellipse, "probability": 1.0, "fix": true }],
        "advice": { "lat": 52.2300, "lon": 21.0300, "text": "Drive east for about 400 m." },
    }));
    messages
        .push(json!({ "type": "mark", "id": 1, "lat": 52.2320, "lon": 21.0100, "text": "Gate" }));
    messages.push(json!({
        "type": "health",
        "inputs": [
            { "name": "gps", "state": "open", "since_ms": 0, "lines": 240, "used": 238, "refused": { "checksum is wrong or missing": 2 } },
            { "name": "kraken", "state": "silent", "since_ms": now_ms() - 21_000, "lines": 6, "used": 6, "refused": {} },
        ],
        "outputs": [{ "name": "mqtt", "state": "open", "queued": 0, "sent": 12, "lost": 0 }],
    }));
    messages
}

fn now_ms() -> u64 {
    let since = std::time::UNIX_EPOCH.elapsed().unwrap();
    since.as_millis() as u64
}

fn bearing(id: u32) -> Value {
    let longitude = 21.0120 + 0.0012 * f64::from(id);
    let east = (21.0160 - longitude) * 68_300.0;
    let degrees = east.atan2(0.0070 * 111_200.0).to_degrees() + if id == 3 { 60.0 } else { 1.0 };
    json!({
        "type": "bearing", "id": id, "receiver": "car", "time_ms": 1_000 + 2_000 * id, "lat": 52.2300, "lon": longitude,
        "bearing_deg": degrees.rem_euclid(360.0), "sigma_deg": 3.0, "used": true, "outlier": if id == 3 { 0.97 } else { 0.02 },
    })
}

/// The pictures of the guide are made anew if `BLESS` is set.
fn bless() {
    if env::var_os("BLESS").is_none() {
        return;
    }
    for (picture, name) in [("desk-city", "page"), ("phone-live", "page-phone")] {
        let from = pictures().join(picture).with_extension("png");
        let to = root()
            .join("docs/src/images")
            .join(name)
            .with_extension("png");
        fs::create_dir_all(to.parent().unwrap()).unwrap();
        fs::copy(from, to).unwrap();
    }
}

/// Where pictures of the page go.
fn pictures() -> PathBuf {
    let target =
        env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    target.join("browser")
}

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}
