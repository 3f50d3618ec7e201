//! Browsers, and what is none.

use std::{
    io::{BufRead, BufReader, Read, Write},
    net::TcpStream,
    time::Duration,
};

use crate::program::{Folder, Live, PATIENCE, ask, free_port, get, post};

#[test]
fn the_page_comes_with_all_its_files() {
    let folder = Folder::new();
    let live = Live::start(&folder, "[[input]]\nname = \"a\"\nstdin = true\n", &[]);
    let (status, page) = get(&live.address, "/", "");
    assert!(status == 200 && page.contains("foxhunt"), "{page}");
    assert_eq!(get(&live.address, "/foxhunt.wasm", "").0, 200);
    assert_eq!(get(&live.address, "/../Cargo.toml", "").0, 404);
    assert_eq!(get(&live.address, "/api/tiles", "").0, 404);
    assert_eq!(get(&live.address, "/api/tiles/1/2/3", "").0, 404);
    assert_eq!(get(&live.address, "/api/background.geojson", "").0, 404);
    // A name of another site that leads here.
    let rebound = "GET /api/state HTTP/1.1\r\nHost: example.org\r\nConnection: close\r\n\r\n";
    assert_eq!(ask(&live.address, rebound).0, 403);
    // What a page of another site can send without asking.
    let form = "POST /api/undo HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Type: text/plain\r\n\
                Content-Length: 2\r\n\r\n{}";
    assert_eq!(ask(&live.address, form).0, 415);
    assert_eq!(post(&live.address, "/api/undo", "{}").0, 409);
    assert_eq!(post(&live.address, "/api/retract", "{\"id\": -1}").0, 400);
    assert_eq!(
        post(
            &live.address,
            "/api/mark",
            "{\"lat\": 91, \"lon\": 0, \"text\": \"\"}"
        )
        .0,
        409
    );
    assert_eq!(
        post(&live.address, "/api/mark", &"x".repeat(100_000)).0,
        400
    );
    let (status, _) = post(
        &live.address,
        "/api/mark",
        "{\"lat\": 1, \"lon\": 2, \"text\": \"here\"}",
    );
    assert_eq!(status, 200);
    let mark = live.messages("mark").pop().unwrap();
    assert_eq!(
        (mark["text"].as_str(), mark["id"].as_u64()),
        (Some("here"), Some(1))
    );
}

#[test]
fn beyond_this_machine_a_token_is_needed() {
    let folder = Folder::new();
    let settings = "[[input]]\nname = \"a\"\nstdin = true\n[web]\nlisten = \"0.0.0.0:0\"\ntoken = \"a-long-token\"\n";
    let live = Live::start(&folder, settings, &[]);
    assert!(live.page.ends_with("/?token=a-long-token"), "{}", live.page);
    for path in [
        "/",
        "/api/state",
        "/?token=",
        "/?token=a-long-tokeN",
        "/foxhunt.wasm",
    ] {
        assert_eq!(get(&live.address, path, "").0, 401, "{path}");
    }
    assert_eq!(get(&live.address, "/", "Cookie: foxhunt=wrong\r\n").0, 401);
    assert_eq!(get(&live.address, "/?token=a-long-token", "").0, 200);
    let cookie = "Cookie: other=1; foxhunt=a-long-token\r\n";
    assert_eq!(get(&live.address, "/api/state", cookie).0, 200);
}

#[test]
fn rubbish_and_idlers_keep_nobody_out() {
    let folder = Folder::new();
    let posts = format!("127.0.0.1:{}", free_port());
    let settings = format!("[[input]]\nname = \"posts\"\nhttp-listen = \"{posts}\"\n");
    let live = Live::start(&folder, &settings, &[]);
    live.said("posts: open");
    rlimit::increase_nofile_limit(2_048).unwrap();
    let mut idle = Vec::new();
    for k in 0..1_000 {
        let address = if k % 2 == 0 { &live.address } else { &posts };
        match TcpStream::connect(address) {
            Ok(stream) => idle.push(stream),
            Err(error) => panic!("{k}: {error}"),
        }
    }
    assert_eq!(get(&live.address, "/api/state", "").0, 200);
    for rubbish in [
        &b"\0\0\0\0\r\n\r\n"[..],
        b"GET\r\n\r\n",
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
        b"GET / HTTP/9.9\r\n\r\n",
        &[b'x'; 100_000],
    ] {
        for address in [&live.address, &posts] {
            let mut stream = TcpStream::connect(address).unwrap();
            let _ = stream.write_all(rubbish);
        }
    }
    assert_eq!(get(&live.address, "/api/state", "").0, 200);
    for body in ["", "{", "[1]", "<DATA>", "\u{0}", "a=%zz"] {
        let status = post(&posts, "/", body).0;
        assert!(matches!(status, 200 | 400), "{body}: {status}");
    }
    let bearing = "{\"type\":\"BEARING\",\"bearing_type\":\"absolute\",\"latitude\":48.1,\"longitude\":11.5,\
                   \"bearing\":10,\"timestamp\":1795339800}";
    assert_eq!(post(&posts, "/", bearing).0, 200);
}

#[test]
fn events_go_on_where_a_page_was() {
    let folder = Folder::new();
    let mut live = Live::start(&folder, "[[input]]\nname = \"a\"\nstdin = true\n", &[]);
    let state = get(&live.address, "/api/state", "").1;
    let state: serde_json::Value = serde_json::from_str(&state).unwrap();
    let seq = state["seq"].as_u64().unwrap();
    live.stdin()
        .write_all(&std::fs::read(crate::program::drive()).unwrap())
        .unwrap();
    live.until("all bearings", |live| (live.bearings() == 55).then_some(()));
    let events = |after: &str, most: usize| {
        let mut stream = TcpStream::connect(&live.address).unwrap();
        stream
            .set_read_timeout(Some(Duration::from_secs(2)))
            .unwrap();
        write!(
            stream,
            "GET /api/events{after} HTTP/1.1\r\nHost: localhost\r\n"
        )
        .unwrap();
        if after.is_empty() {
            write!(stream, "Last-Event-ID: {seq}\r\n").unwrap();
        }
        write!(stream, "\r\n").unwrap();
        let lines = BufReader::new(stream).lines().map_while(Result::ok);
        let ids = lines.filter(|line| line.starts_with("id:"));
        ids.take(most).collect::<Vec<_>>()
    };
    let by_query = events(&format!("?after={seq}"), 100);
    assert_eq!(by_query.len(), 100);
    assert_eq!(by_query, events("", 100));
    // A number of another run: everything is told anew.
    assert!(!events("?after=1", 10).is_empty());
    assert!(PATIENCE > Duration::ZERO);
    let mut rest = Vec::new();
    let _ = TcpStream::connect(&live.address)
        .unwrap()
        .take(0)
        .read_to_end(&mut rest);
}
