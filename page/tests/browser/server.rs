//! A small server of the page, and of messages that the test makes up.

use std::{
    io::{BufRead, BufReader, Read, Write},
    net::{TcpListener, TcpStream},
    sync::{Arc, Condvar, Mutex},
    thread,
    time::Duration,
};

use serde_json::{Value, json};

/// What `api/state` and `api/events` tell; `None` if there is no such thing.
#[derive(Default)]
pub struct Live {
    messages: Mutex<Option<Vec<Value>>>,
    came: Condvar,
    /// What was posted: the path and the body.
    pub posted: Mutex<Vec<(String, Value)>>,
}

impl Live {
    /// Adds messages, and sends them to whoever listens.
    pub fn tell(&self, new: &[Value]) {
        let mut messages = self.messages.lock().unwrap();
        messages.get_or_insert_default().extend_from_slice(new);
        self.came.notify_all();
    }
}

/// Serves for as long as the program runs; says at which address.
pub fn serve(live: Arc<Live>) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = format!("http://{}/", listener.local_addr().unwrap());
    thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let live = Arc::clone(&live);
            // Whoever goes away while being answered is not missed.
            thread::spawn(move || answer(stream, &live).ok());
        }
    });
    address
}

fn answer(stream: TcpStream, live: &Live) -> std::io::Result<()> {
    let mut reader = BufReader::new(stream.try_clone()?);
    let mut first = String::new();
    reader.read_line(&mut first)?;
    let mut length = 0;
    loop {
        let mut line = String::new();
        reader.read_line(&mut line)?;
        let line = line.trim().to_ascii_lowercase();
        if let Some(value) = line.strip_prefix("content-length:") {
            length = value.trim().parse().unwrap_or(0);
        }
        if line.is_empty() {
            break;
        }
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body)?;
    let target = first
        .split(' ')
        .nth(1)
        .unwrap_or("/")
        .trim_start_matches('/');
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    let messages = live.messages.lock().unwrap().clone();
    match (path, messages) {
        ("api/state", Some(messages)) => {
            let state = json!({ "seq": messages.len(), "messages": messages });
            respond(
                stream,
                "200 OK",
                "application/json",
                state.to_string().as_bytes(),
            )
        }
        ("api/events", Some(_)) => {
            let after = query
                .strip_prefix("after=")
                .and_then(|text| text.parse().ok());
            events(stream, live, after.unwrap_or(0))
        }
        ("api/background.geojson", Some(_)) => respond(
            stream,
            "200 OK",
            "application/geo+json",
            BACKGROUND.as_bytes(),
        ),
        ("api/tiles", Some(_)) => {
            let zooms = b"{\"min_zoom\": 0, \"max_zoom\": 18}";
            respond(stream, "200 OK", "application/json", zooms)
        }
        // Every tile is the same picture.
        (path, Some(_)) if path.starts_with("api/tiles/") => {
            respond(stream, "200 OK", "image/svg+xml", TILE.as_bytes())
        }
        (_, Some(_)) if first.starts_with("POST api/") || first.starts_with("POST /api/") => {
            let body = serde_json::from_slice(&body).unwrap_or_default();
            live.posted.lock().unwrap().push((path.into(), body));
            respond(stream, "200 OK", "application/json", b"{\"seq\": 0}")
        }
        _ => match foxhunt_page::file(path) {
            Some((_, mime, bytes)) => respond(stream, "200 OK", mime, bytes),
            None => respond(
                stream,
                "404 Not Found",
                "text/plain",
                b"there is no such file",
            ),
        },
    }
}

/// A street and a pond.
const BACKGROUND: &str = r#"{ "type": "FeatureCollection", "features": [
    { "type": "Feature", "properties": {}, "geometry": { "type": "LineString",
      "coordinates": [[21.005, 52.2298], [21.020, 52.2298], [21.030, 52.2340]] } },
    { "type": "Feature", "properties": {}, "geometry": { "type": "Polygon",
      "coordinates": [[[21.020, 52.2345], [21.026, 52.2345], [21.026, 52.2365], [21.020, 52.2345]]] } } ] }"#;
const TILE: &str = r##"<svg xmlns="http://www.w3.org/2000/svg" width="256" height="256"><rect width="256" height="256"
    fill="#eef3e8" stroke="#c5d0b5"/></svg>"##;

fn events(mut stream: TcpStream, live: &Live, mut told: usize) -> std::io::Result<()> {
    head(&mut stream, "200 OK", "text/event-stream", None)?;
    loop {
        let mut messages = live.messages.lock().unwrap();
        while messages.as_ref().map_or(0, Vec::len) <= told {
            messages = live
                .came
                .wait_timeout(messages, Duration::from_secs(1))
                .unwrap()
                .0;
        }
        let new = messages.as_ref().map(|all| all[told..].to_vec());
        drop(messages);
        for message in new.into_iter().flatten() {
            told += 1;
            write!(stream, "id: {told}\ndata: {message}\n\n")?;
        }
        stream.flush()?;
    }
}

fn respond(mut stream: TcpStream, status: &str, mime: &str, body: &[u8]) -> std::io::Result<()> {
    head(&mut stream, status, mime, Some(body.len()))?;
    stream.write_all(body)
}

fn head(
    stream: &mut TcpStream,
    status: &str,
    mime: &str,
    length: Option<usize>,
) -> std::io::Result<()> {
    let policy = foxhunt_page::POLICY;
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {mime}\r\nContent-Security-Policy: {policy}\r\n"
    )?;
    if let Some(length) = length {
        write!(stream, "Content-Length: {length}\r\n")?;
    }
    write!(
        stream,
        "Connection: close\r\nCache-Control: no-store\r\n\r\n"
    )
}
