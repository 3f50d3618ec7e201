//! The line to a gateway: sentences out, sentences in.

use std::{
    io::{self, ErrorKind, Read, Write},
    net::TcpStream,
    time::{Duration, Instant},
};

use anyhow::{Context, Result, anyhow, bail};

use crate::wrong;

/// Where the gateway is.
#[derive(clap::Args)]
pub struct Options {
    #[command(flatten)]
    end: End,
    /// Speed of the serial port.
    #[arg(long, value_name = "BAUD", default_value_t = 115_200)]
    baud: u32,
}

/// What the computer opens.
#[derive(clap::Args)]
#[group(required = true, multiple = false)]
struct End {
    /// Serial port of the gateway, such as /dev/ttyACM0.
    #[arg(long, value_name = "PORT")]
    serial: Option<String>,
    /// A server of its serial port.
    #[arg(long, value_name = "HOST:PORT")]
    tcp: Option<String>,
}

/// A serial port or a connection.
trait Port: Read + Write {}

impl<T: Read + Write + ?Sized> Port for T {}

/// The line.
pub struct Line {
    name: String,
    port: Box<dyn Port>,
    /// What has come of a sentence that has not ended.
    begun: Vec<u8>,
}

impl Line {
    /// How long one read waits.
    const WAIT: Duration = Duration::from_millis(100);
    /// The most bytes of a line: what is longer is no sentence.
    const LONGEST: usize = 1 << 10;

    /// Opens it.
    ///
    /// # Errors
    /// If there is no such port, or nobody answers there.
    pub fn open(options: &Options) -> Result<Self> {
        let (name, port): (&str, Box<dyn Port>) = match (&options.end.serial, &options.end.tcp) {
            (Some(name), _) => {
                let port = serialport::new(name, options.baud).timeout(Self::WAIT);
                (name, Box::new(port.open().context(name.clone())?))
            }
            (None, Some(address)) => {
                wrong::address("tcp", address)?;
                let stream = TcpStream::connect(address).context(address.clone())?;
                stream.set_read_timeout(Some(Self::WAIT))?;
                (address, Box::new(stream))
            }
            (None, None) => bail!("--serial or --tcp has to say where the gateway is"),
        };
        Ok(Self {
            name: name.into(),
            port,
            begun: Vec::new(),
        })
    }

    /// Sends the sentence of a payload.
    ///
    /// # Errors
    /// If the line is closed.
    pub fn say(&mut self, payload: &str) -> Result<()> {
        let sentence = foxhunt_decode::sentence(payload);
        let sent = self.port.write_all(sentence.as_bytes());
        let sent = sent.and_then(|()| self.port.flush());
        sent.map_err(|error| self.failed(&error))
    }

    /// The payload of the next sentence that comes undamaged; none if none has come until then.
    ///
    /// # Errors
    /// If the line is closed.
    pub fn hear(&mut self, until: Instant) -> Result<Option<String>> {
        let mut bytes = [0; 256];
        loop {
            while let Some(end) = self.begun.iter().position(|byte| *byte == b'\n') {
                let line: Vec<u8> = self.begun.drain(..=end).collect();
                if let Some(payload) = payload(&line) {
                    return Ok(Some(payload));
                }
            }
            if self.begun.len() > Self::LONGEST {
                self.begun.clear();
            }
            if Instant::now() >= until {
                return Ok(None);
            }
            match self.port.read(&mut bytes) {
                Ok(0) => bail!("{}: closed", self.name),
                Ok(read) => self.begun.extend_from_slice(&bytes[..read]),
                Err(error) if is_no_failure(&error) => {}
                Err(error) => return Err(self.failed(&error)),
            }
        }
    }

    /// In words: an error of the line is none of what is printed, as a broken pipe would be.
    fn failed(&self, error: &io::Error) -> anyhow::Error {
        anyhow!("{}: {error}", self.name)
    }
}

/// Nothing has come yet.
fn is_no_failure(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted
    )
}

/// What a sentence holds whose checksum is right.
fn payload(line: &[u8]) -> Option<String> {
    let line = std::str::from_utf8(line).ok()?.trim();
    let (payload, _) = line.strip_prefix('$')?.split_once('*')?;
    let is_right = foxhunt_decode::sentence(payload).trim() == line;
    is_right.then(|| payload.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_that_is_damaged_says_nothing() {
        for (line, expected) in [
            ("$PFOXQ*50\r\n", Some("PFOXQ")),
            ("$PFOXQ*50\n", Some("PFOXQ")),
            ("$PFOXQ*51\r\n", None),
            ("$PFOXR*50\r\n", None),
            ("$PFOXQ\r\n", None),
            ("PFOXQ*50\r\n", None),
            ("\r\n", None),
        ] {
            assert_eq!(payload(line.as_bytes()).as_deref(), expected, "{line}");
        }
    }
}
