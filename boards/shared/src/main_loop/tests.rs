extern crate std;

use std::{collections::VecDeque, string::String, vec::Vec};

use embassy_futures::block_on;
use embedded_io::{ErrorKind, ErrorType};
use foxhunt_gateways::board::{CONFIG, Gateway};

use super::*;
use crate::vehicle::Hunt;

const DRIVE: &[u8] = include_bytes!("../../../../examples/data/drive.nmea");
const QUERY: &[u8] = b"$PFOXQ*50\r\n";

/// A line by which pieces come, or an error.
#[derive(Clone)]
struct Script(VecDeque<Result<Vec<u8>, ErrorKind>>);

impl Script {
    fn of(bytes: &[u8]) -> Self {
        let pieces = bytes.chunks(7).map(|piece| Ok(piece.to_vec()));
        Self(pieces.collect())
    }

    fn next(&mut self, buffer: &mut [u8]) -> Result<usize, ErrorKind> {
        let Some(piece) = self.0.pop_front() else {
            return Ok(0);
        };
        let piece = piece?;
        buffer[..piece.len()].copy_from_slice(&piece);
        Ok(piece.len())
    }
}

impl ErrorType for Script {
    type Error = ErrorKind;
}

impl embedded_io::Read for Script {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, ErrorKind> {
        self.next(buffer)
    }
}

impl ReadReady for Script {
    fn read_ready(&mut self) -> Result<bool, ErrorKind> {
        Ok(!self.0.is_empty())
    }
}

impl embedded_io_async::Read for Script {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, ErrorKind> {
        if self.0.is_empty() {
            core::future::pending::<()>().await;
        }
        self.next(buffer)
    }
}

/// What was sent; a computer may take nothing.
#[derive(Default)]
struct Computer {
    sent: Vec<u8>,
    is_stuck: bool,
}

impl ErrorType for Computer {
    type Error = ErrorKind;
}

impl embedded_io::Write for Computer {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        let count = bytes.len().min(5);
        self.sent.extend(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

impl embedded_io_async::Write for Computer {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        if self.is_stuck {
            core::future::pending::<()>().await;
        }
        embedded_io::Write::write(self, bytes)
    }

    async fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

/// A watchdog that counts how often it was fed, and a clock whose second passes at once.
#[derive(Default)]
struct Desk {
    fed: u32,
}

impl Board for &mut Desk {
    fn feed(&mut self) {
        self.fed += 1;
    }

    async fn tick(&mut self) {}
}

/// What the gateway says to bytes that come one by one.
fn expected(bytes: &[u8]) -> String {
    let mut gateway = Gateway::EMPTY;
    let mut reports = String::new();
    for byte in bytes {
        if gateway.push(0, *byte, &CONFIG).is_some() {
            reports.push_str(gateway.report());
        }
    }
    reports
}

fn blocking<const PORTS: usize>(lines: [Script; PORTS]) -> (String, u32) {
    let mut gateway = Gateway::EMPTY;
    let hunt = Hunt::new(&mut gateway, &CONFIG);
    let mut main_loop = MainLoop::new(hunt, lines, Computer::default());
    while main_loop.turn() {}
    let sent = String::from_utf8(main_loop.computer.sent).unwrap();
    (sent, main_loop.lines.failures())
}

fn asynchronous<const PORTS: usize>(lines: [Script; PORTS], is_stuck: bool) -> (String, u32) {
    let mut gateway = Gateway::EMPTY;
    let hunt = Hunt::new(&mut gateway, &CONFIG);
    let computer = Computer {
        is_stuck,
        ..Computer::default()
    };
    let mut main_loop = MainLoop::new(hunt, lines, computer);
    let mut desk = Desk::default();
    while main_loop.lines.has_more() {
        block_on(main_loop.turn_async(&mut &mut desk));
    }
    let sent = String::from_utf8(main_loop.computer.sent).unwrap();
    (sent, desk.fed)
}

impl<const PORTS: usize> Lines<Script, PORTS> {
    fn has_more(&mut self) -> bool {
        self.readers().any(|reader| !reader.0.is_empty())
    }
}

#[test]
fn both_forms_send_what_the_gateway_says() {
    let bytes = [DRIVE, QUERY].concat();
    let expected = expected(&bytes);
    assert!(expected.matches("$PFOXF,").count() > 40);
    let (sent, failures) = blocking([Script::of(&bytes)]);
    assert_eq!((sent, failures), (expected.clone(), 0));
    let (sent, fed) = asynchronous([Script::of(&bytes)], false);
    assert_eq!(sent, expected);
    assert!(fed as usize > bytes.len());
}

#[test]
fn an_error_of_a_line_damages_that_line_and_no_other() {
    let line = b"$GPRMC,093000.000,A,5213.8,N,02100.1,E,30.0,90.0,010626,,*0";
    let mut first = Script::of(line);
    first.0.insert(3, Err(ErrorKind::Other));
    let (sent, failures) = blocking([first.clone(), Script::of(QUERY)]);
    assert_eq!(failures, 1);
    assert!(sent.starts_with("$PFOXN,,FEW,0,,*07\r\n$PFOXS,1,"));
    let (same, _) = asynchronous([first, Script::of(QUERY)], false);
    assert_eq!(same, sent);
}

#[test]
fn a_computer_that_takes_nothing_holds_up_nothing() {
    let bytes = [QUERY, QUERY].concat();
    let (sent, fed) = asynchronous([Script::of(&bytes)], true);
    assert_eq!(sent, "");
    assert!(fed >= bytes.len() as u32 + 2 * PATIENCE);
}
