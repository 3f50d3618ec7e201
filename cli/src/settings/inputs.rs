//! What comes in.

use std::{fmt, path::PathBuf};

use axum::http::Uri;
use serde::{Deserialize, Serialize};

use super::Name;
use crate::wrong::{Wrong, address};

/// An input: exactly one of the fields from `serial` to `mqtt` says where it is.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Input {
    /// What it is called: in the log, on the page, in the status.
    pub name: Name,
    /// A serial port, such as `/dev/ttyUSB0`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub serial: Option<PathBuf>,
    /// Bits a second of the serial port; 9600 if nothing is said.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub baud: Option<u32>,
    /// A server to connect to: host and port.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tcp: Option<String>,
    /// Where others connect to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tcp_listen: Option<String>,
    /// Where datagrams come in: lines, or messages of chasemapper.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub udp: Option<String>,
    /// A file that grows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// A file is read from its beginning, and not only what is added to it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from_beginning: Option<bool>,
    /// The standard input.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stdin: Option<bool>,
    /// gpsd: host and port.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gpsd: Option<String>,
    /// A page that is fetched again and again: `DOA_value.html` or `doa.xml` of a KrakenSDR.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub http: Option<String>,
    /// Milliseconds from one fetch to the next; 200 if nothing is said.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub every_ms: Option<u64>,
    /// Where a KrakenSDR posts its readings to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub http_listen: Option<String>,
    /// A WebSocket to connect to: `ws://host:port/path`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub websocket: Option<String>,
    /// A broker with bearings of others: host and port.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mqtt: Option<super::Mqtt>,
    /// Packets of tags come in, of the radios of this site.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub site: Option<Name>,
    /// Seconds after which it is called silent; 10 if nothing is said.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub silent_s: Option<u64>,
}

/// Where an input is.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    Serial { path: PathBuf, baud: u32 },
    Tcp(String),
    TcpListen(String),
    Udp(String),
    File { path: PathBuf, from_beginning: bool },
    Stdin,
    Gpsd(String),
    Http { url: String, every_ms: u64 },
    HttpListen(String),
    WebSocket(String),
    Mqtt(super::Mqtt),
}

/// Where it is, as people say it.
impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial { path, baud } => write!(f, "serial {}, {baud} baud", path.display()),
            Self::Tcp(address) => write!(f, "tcp {address}"),
            Self::TcpListen(address) => write!(f, "tcp-listen {address}"),
            Self::Udp(address) => write!(f, "udp {address}"),
            Self::File {
                path,
                from_beginning,
            } => {
                let from = if *from_beginning {
                    ", from its beginning"
                } else {
                    ""
                };
                write!(f, "file {}{from}", path.display())
            }
            Self::Stdin => f.write_str("the standard input"),
            Self::Gpsd(address) => write!(f, "gpsd {address}"),
            Self::Http { url, every_ms } => write!(f, "http {url}, every {every_ms} ms"),
            Self::HttpListen(address) => write!(f, "http-listen {address}"),
            Self::WebSocket(url) => write!(f, "websocket {url}"),
            Self::Mqtt(mqtt) => write!(f, "{mqtt}"),
        }
    }
}

impl Input {
    /// Where it is.
    ///
    /// # Errors
    /// Unless it is at exactly one place that can be, or if a setting is for another kind of place.
    pub fn source(&self) -> Result<Source, Wrong> {
        let text = |text: &Option<String>, source: fn(String) -> Source| text.clone().map(source);
        let all = [
            self.serial.clone().map(|path| Source::Serial {
                path,
                baud: self.baud.unwrap_or(9600),
            }),
            text(&self.tcp, Source::Tcp),
            text(&self.tcp_listen, Source::TcpListen),
            text(&self.udp, Source::Udp),
            self.file.clone().map(|path| Source::File {
                path,
                from_beginning: self.from_beginning.unwrap_or(false),
            }),
            self.stdin.filter(|is| *is).map(|_| Source::Stdin),
            text(&self.gpsd, Source::Gpsd),
            self.http.clone().map(|url| Source::Http {
                url,
                every_ms: self.every_ms.unwrap_or(200).clamp(10, 3_600_000),
            }),
            text(&self.http_listen, Source::HttpListen),
            text(&self.websocket, Source::WebSocket),
            self.mqtt.clone().map(Source::Mqtt),
        ];
        let mut given = all.into_iter().flatten();
        let first = given.next().ok_or_else(|| {
            Wrong::new(
                "",
                "one of serial, tcp, tcp-listen, udp, file, stdin, gpsd, http, http-listen, websocket or mqtt is needed",
            )
        })?;
        if given.next().is_some() {
            return Err(Wrong::new("", "it can only be at one place"));
        }
        for (fits, given, field) in [
            (self.serial.is_some(), self.baud.is_some(), "baud"),
            (
                self.file.is_some(),
                self.from_beginning.is_some(),
                "from-beginning",
            ),
            (self.http.is_some(), self.every_ms.is_some(), "every-ms"),
        ] {
            if given && !fits {
                return Err(Wrong::new(field, "is of no use here"));
            }
        }
        first.check()?;
        Ok(first)
    }
}

impl Source {
    /// Fails unless it can be.
    fn check(&self) -> Result<(), Wrong> {
        match self {
            Self::Serial { .. } | Self::File { .. } | Self::Stdin => Ok(()),
            Self::Tcp(text) => address("tcp", text),
            Self::TcpListen(text) => address("tcp-listen", text),
            Self::Udp(text) => address("udp", text),
            Self::Gpsd(text) => address("gpsd", text),
            Self::HttpListen(text) => address("http-listen", text),
            Self::Http { url, .. } => page("http", url, "http://"),
            Self::WebSocket(url) => page("websocket", url, "ws://"),
            Self::Mqtt(mqtt) => mqtt.address().map(drop),
        }
    }
}

/// Fails unless a text is the address of a page.
fn page(field: &'static str, url: &str, begin: &str) -> Result<(), Wrong> {
    if !url.starts_with(begin) {
        let what = format!("must begin with {begin}: {url}");
        return Err(Wrong::new(field, what));
    }
    let host = url
        .parse::<Uri>()
        .ok()
        .and_then(|uri| Some(uri.host()?.to_owned()));
    match host {
        Some(host) if !host.is_empty() => Ok(()),
        _ => Err(Wrong::new(field, format!("is no address: {url}"))),
    }
}
