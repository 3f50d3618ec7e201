//! What comes in.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use serde::{Deserialize, Serialize};

use super::Name;

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

impl Input {
    /// Where it is.
    ///
    /// # Errors
    /// Unless it is at exactly one place, or if a setting is for another kind of place.
    pub fn source(&self) -> Result<Source> {
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
        let first = given.next().context(
            "one of serial, tcp, tcp-listen, udp, file, stdin, gpsd, http, http-listen, websocket or mqtt is needed",
        )?;
        ensure!(given.next().is_none(), "it can only be at one place");
        let is = |fits: bool, given: bool, name: &str| {
            ensure!(fits || !given, "{name} is of no use here");
            Ok(())
        };
        is(self.serial.is_some(), self.baud.is_some(), "baud")?;
        let is_file = self.file.is_some();
        is(is_file, self.from_beginning.is_some(), "from-beginning")?;
        is(self.http.is_some(), self.every_ms.is_some(), "every-ms")?;
        if let Source::Http { url, .. } = &first {
            ensure!(
                url.starts_with("http://"),
                "{url} does not begin with http://"
            );
        }
        if let Source::WebSocket(url) = &first {
            ensure!(url.starts_with("ws://"), "{url} does not begin with ws://");
        }
        Ok(first)
    }
}
