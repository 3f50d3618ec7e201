//! The program, and what tests need of it.

use std::{
    env, fs,
    io::{BufRead, BufReader, Read, Write},
    net::{TcpListener, TcpStream, UdpSocket},
    path::{Path, PathBuf},
    process::{Child, Command, Output, Stdio},
    sync::{
        atomic::{AtomicU32, Ordering},
        mpsc,
    },
    thread,
    time::{Duration, Instant},
};

use serde_json::Value;

/// How long anything may take.
pub const PATIENCE: Duration = Duration::from_secs(20);

/// The drive that comes with the project.
pub fn drive() -> PathBuf {
    example("drive.nmea")
}

/// A file that comes with the project.
pub fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../examples/data")
        .join(name)
}

/// A directory for one test, removed at its end.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new() -> Self {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let name = format!("foxhunt-tool-{}-{number}", std::process::id());
        let folder = env::temp_dir().join(name);
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    pub fn file(&self, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
        let file = self.0.join(name);
        fs::write(&file, text).unwrap();
        file
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Runs the program to its end in a folder.
pub fn run(folder: &Folder, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

/// The program in a folder.
pub fn command(folder: &Folder, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_foxhunt"));
    command.args(arguments).current_dir(&folder.0);
    command
}

/// What a run printed, if it was done.
pub fn printed(output: &Output) -> String {
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// `foxhunt live` while it runs.
pub struct Live {
    child: Child,
    errors: mpsc::Receiver<String>,
    /// Where the page is, with a slash at its end.
    pub page: String,
    pub address: String,
}

impl Live {
    /// With the settings; the page is at a free port unless they say otherwise.
    pub fn start(folder: &Folder, settings: &str, more: &[&str]) -> Self {
        let file = folder.file("foxhunt.toml", settings);
        let mut arguments = vec!["live", file.to_str().unwrap()];
        arguments.extend(more);
        if !settings.contains("\nlisten =") {
            arguments.extend(["--listen", "127.0.0.1:0"]);
        }
        let mut child = command(folder, &arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stderr.take().unwrap()).lines();
        let (sender, errors) = mpsc::channel();
        thread::spawn(move || {
            lines
                .map_while(Result::ok)
                .try_for_each(|line| sender.send(line))
        });
        let mut live = Self {
            child,
            errors,
            page: String::new(),
            address: String::new(),
        };
        let line = live.said("page: ");
        live.page = line.trim_start_matches("page: ").to_owned();
        let rest = live.page.trim_start_matches("http://");
        live.address = rest
            .split('/')
            .next()
            .unwrap()
            .replace("0.0.0.0", "127.0.0.1");
        live
    }

    /// Waits for a line of the program's errors that holds a text.
    pub fn said(&self, text: &str) -> String {
        let end = Instant::now() + PATIENCE;
        let mut all = Vec::new();
        while let Some(left) = end.checked_duration_since(Instant::now()) {
            match self.errors.recv_timeout(left) {
                Ok(line) if line.contains(text) => return line,
                Ok(line) => all.push(line),
                Err(_) => break,
            }
        }
        panic!("never said {text}: {all:?}");
    }

    /// The lines of its errors that nobody has waited for yet.
    pub fn all_said(&self) -> Vec<String> {
        self.errors.try_iter().collect()
    }

    pub fn stdin(&mut self) -> &mut impl Write {
        self.child.stdin.as_mut().unwrap()
    }

    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Messages of a type that the page would show.
    pub fn messages(&self, kind: &str) -> Vec<Value> {
        let (status, body) = get(&self.address, "/api/state", "");
        assert_eq!(status, 200, "{body}");
        let state: Value = serde_json::from_str(&body).unwrap();
        let messages = state["messages"].as_array().unwrap().iter();
        let of_kind = messages.filter(|message| message["type"] == kind);
        of_kind.cloned().collect()
    }

    /// Waits until the page would show something.
    pub fn until<T>(&self, what: &str, mut is: impl FnMut(&Self) -> Option<T>) -> T {
        let end = Instant::now() + PATIENCE;
        while Instant::now() < end {
            if let Some(found) = is(self) {
                return found;
            }
            thread::sleep(Duration::from_millis(30));
        }
        panic!("never {what}");
    }

    pub fn bearings(&self) -> usize {
        self.messages("bearing").len()
    }

    pub fn answer(&self) -> Value {
        self.messages("answer").pop().unwrap()
    }

    /// Ends it as Ctrl-C does; what it wrote to its standard output.
    pub fn stop(self) -> String {
        self.end("-INT")
    }

    /// The same by another signal.
    pub fn end(mut self, signal: &str) -> String {
        let killed = Command::new("kill")
            .args([signal, &self.id().to_string()])
            .status();
        assert!(killed.unwrap().success());
        let mut out = String::new();
        self.child
            .stdout
            .take()
            .unwrap()
            .read_to_string(&mut out)
            .unwrap();
        assert!(self.child.wait().unwrap().success());
        out
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A request; the status and the body.
pub fn get(address: &str, path: &str, headers: &str) -> (u16, String) {
    ask(
        address,
        &format!("GET {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n{headers}\r\n"),
    )
}

/// A post of JSON.
pub fn post(address: &str, path: &str, body: &str) -> (u16, String) {
    let length = body.len();
    ask(
        address,
        &format!(
            "POST {path} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Type: application/json\r\n\
             Content-Length: {length}\r\n\r\n{body}"
        ),
    )
}

pub fn ask(address: &str, request: &str) -> (u16, String) {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    stream.write_all(request.as_bytes()).unwrap();
    let mut bytes = Vec::new();
    let _ = stream.read_to_end(&mut bytes);
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let (head, body) = text.split_once("\r\n\r\n").unwrap_or((&text, ""));
    let status = head
        .split(' ')
        .nth(1)
        .and_then(|status| status.parse().ok());
    (status.unwrap_or(0), body.to_owned())
}

/// A port that nobody listens at.
pub fn free_port() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    listener.local_addr().unwrap().port()
}

pub fn free_udp_port() -> u16 {
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.local_addr().unwrap().port()
}
