//! Where results go.

use std::{fmt, path::PathBuf};

use serde::{Deserialize, Serialize};

use super::Name;
use crate::wrong::{Wrong, address};

/// What is sent.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Form {
    /// `$PFOX` sentences, and a waypoint `$GPWPL` for each source.
    #[default]
    Nmea,
    /// GeoJSON, a feature in each line.
    Geojson,
    /// Bearings as chasemapper reads them.
    Chasemapper,
    /// Cursor on Target, an event for each source.
    Cot,
}

/// An output: exactly one of `stdout`, `udp`, `tcp`, `tcp-listen`, `file` and `mqtt` says where it is.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Output {
    /// What it is called.
    pub name: Name,
    /// What is sent, `nmea` if nothing is said; a broker gets GeoJSON.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub form: Option<Form>,
    /// The standard output.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stdout: Option<bool>,
    /// Where datagrams go to: host and port; also the address of a broadcast or a group.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub udp: Option<String>,
    /// A server to connect to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tcp: Option<String>,
    /// Where others connect to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tcp_listen: Option<String>,
    /// A file that lines are added to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// A broker.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mqtt: Option<Mqtt>,
}

/// A broker of MQTT 5.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct Mqtt {
    /// Host and port.
    pub broker: String,
    /// Before all topics; `foxhunt` if nothing is said.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prefix: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub user: Option<String>,
    /// A file with nothing but the password.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub password_file: Option<PathBuf>,
    /// Whether TLS is used.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tls: Option<bool>,
    /// A file with the certificates that are trusted, in place of the system's.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub certificates: Option<PathBuf>,
    /// The folder in which messages wait while the broker is away; only in memory if nothing is said.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub queue: Option<PathBuf>,
    /// The most messages that wait; 100,000 if nothing is said. The oldest are lost first, and counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub queue_limit: Option<usize>,
}

/// Where an output is.
#[derive(Debug, Clone, PartialEq)]
pub enum Sink {
    Stdout(Form),
    Udp(Form, String),
    Tcp(Form, String),
    TcpListen(Form, String),
    File(Form, PathBuf),
    Mqtt(Mqtt),
}

/// Where it is, as people say it.
impl fmt::Display for Sink {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stdout(form) => write!(f, "{form} to the standard output"),
            Self::Udp(form, address) => write!(f, "{form} to udp {address}"),
            Self::Tcp(form, address) => write!(f, "{form} to tcp {address}"),
            Self::TcpListen(form, address) => write!(f, "{form} to tcp-listen {address}"),
            Self::File(form, file) => write!(f, "{form} to file {}", file.display()),
            Self::Mqtt(mqtt) => write!(f, "{} to {mqtt}", Form::Geojson),
        }
    }
}

impl fmt::Display for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Nmea => "nmea",
            Self::Geojson => "geojson",
            Self::Chasemapper => "chasemapper",
            Self::Cot => "cot",
        })
    }
}

impl fmt::Display for Mqtt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.address() {
            Ok((host, port)) => write!(f, "mqtt {host}:{port}, below {}", self.prefix()),
            Err(_) => write!(f, "mqtt {}", self.broker),
        }
    }
}

impl Output {
    /// Where it is.
    ///
    /// # Errors
    /// Unless it is at exactly one place that can be.
    pub fn sink(&self) -> Result<Sink, Wrong> {
        let form = self.form.unwrap_or_default();
        let text = |text: &Option<String>, sink: fn(Form, String) -> Sink| {
            text.clone().map(|text| sink(form, text))
        };
        let all = [
            self.stdout.filter(|is| *is).map(|_| Sink::Stdout(form)),
            text(&self.udp, Sink::Udp),
            text(&self.tcp, Sink::Tcp),
            text(&self.tcp_listen, Sink::TcpListen),
            self.file.clone().map(|file| Sink::File(form, file)),
            self.mqtt.clone().map(Sink::Mqtt),
        ];
        let mut given = all.into_iter().flatten();
        let first = given.next().ok_or_else(|| {
            Wrong::new(
                "",
                "one of stdout, udp, tcp, tcp-listen, file or mqtt is needed",
            )
        })?;
        if given.next().is_some() {
            return Err(Wrong::new("", "it can only be at one place"));
        }
        match &first {
            Sink::Stdout(_) | Sink::File(..) => {}
            Sink::Udp(_, text) => address("udp", text)?,
            Sink::Tcp(_, text) => address("tcp", text)?,
            Sink::TcpListen(_, text) => address("tcp-listen", text)?,
            Sink::Mqtt(mqtt) => {
                if self.form.is_some_and(|form| form != Form::Geojson) {
                    return Err(Wrong::new(
                        "form",
                        "must be geojson: a broker gets no other",
                    ));
                }
                mqtt.address()?;
            }
        }
        Ok(first)
    }
}

impl Mqtt {
    /// Host and port; 1883 unless one is given, 8883 with TLS.
    ///
    /// # Errors
    /// If there is no host, or the port is none.
    pub fn address(&self) -> Result<(String, u16), Wrong> {
        const FIELD: &str = "mqtt.broker";
        let usual = if self.tls == Some(true) { 8883 } else { 1883 };
        let (host, port) = match self.broker.rsplit_once(':') {
            Some((host, port)) => {
                address(FIELD, &self.broker)?;
                (host, port.parse().unwrap_or(usual))
            }
            None => (&*self.broker, usual),
        };
        if host.is_empty() {
            return Err(Wrong::new(FIELD, "is needed"));
        }
        Ok((host.to_owned(), port))
    }

    /// Before all topics.
    pub fn prefix(&self) -> &str {
        self.prefix.as_deref().unwrap_or("foxhunt")
    }
}
