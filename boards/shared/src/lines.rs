//! Lines that are read together, whichever has something.

use embassy_futures::select::select_array;
use embassy_futures::yield_now;
use embedded_io::ReadReady;
use foxhunt::gateway::io::Input;

/// Stands for bytes that were lost or damaged, as a reader says by an error. No line has it, and it ends every frame, so that
/// the rest of either is rejected as a whole.
pub const LOST: u8 = 0;

/// Bytes that are taken from a reader at once.
const CHUNK: usize = 64;

/// Lines of one kind, numbered as the ports of a gateway.
#[derive(Debug)]
pub struct Lines<R, const PORTS: usize> {
    lines: [Line<R>; PORTS],
    failures: u32,
}

#[derive(Debug)]
struct Line<R> {
    reader: R,
    input: Input<CHUNK>,
    has_failed: bool,
}

impl<R, const PORTS: usize> Lines<R, PORTS> {
    /// The readers of port 0, 1 and so on.
    pub fn new(readers: [R; PORTS]) -> Self {
        let line = |reader| Line {
            reader,
            input: Input::EMPTY,
            has_failed: false,
        };
        Self {
            lines: readers.map(line),
            failures: 0,
        }
    }

    /// How often a reader said that bytes were lost or damaged.
    pub fn failures(&self) -> u32 {
        self.failures
    }

    #[cfg(test)]
    pub(crate) fn readers(&self) -> impl Iterator<Item = &R> {
        self.lines.iter().map(|line| &line.reader)
    }

    /// The next byte of a port, of those that were read.
    pub fn take(&mut self, port: usize) -> Option<u8> {
        let line = self.lines.get_mut(port)?;
        if let Some(byte) = line.input.take() {
            return Some(byte);
        }
        let has_failed = core::mem::take(&mut line.has_failed);
        self.failures = self.failures.wrapping_add(has_failed.into());
        has_failed.then_some(LOST)
    }
}

impl<R: embedded_io::Read + ReadReady, const PORTS: usize> Lines<R, PORTS> {
    /// Reads what there is, without waiting.
    pub fn poll(&mut self) {
        for line in &mut self.lines {
            line.poll();
        }
    }
}

impl<R: embedded_io_async::Read, const PORTS: usize> Lines<R, PORTS> {
    /// Waits until there is a byte to take. It can be dropped at any time, if the future of the readers can.
    pub async fn wait(&mut self) {
        select_array(self.lines.each_mut().map(Line::wait)).await;
        if self.lines.iter().any(|line| line.has_failed) {
            // A reader that fails again and again lets others work.
            yield_now().await;
        }
    }
}

impl<R: embedded_io::Read + ReadReady> Line<R> {
    fn poll(&mut self) {
        let read = match self.reader.read_ready() {
            Ok(true) => self.input.read(&mut self.reader).map(drop),
            Ok(false) => Ok(()),
            Err(error) => Err(error),
        };
        self.has_failed |= read.is_err();
    }
}

impl<R: embedded_io_async::Read> Line<R> {
    async fn wait(&mut self) {
        // A line that ends is one that is broken: those of a board have no end.
        let read = self.input.read_async(&mut self.reader).await;
        self.has_failed |= !matches!(read, Ok(true));
    }
}
