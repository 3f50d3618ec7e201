//! Lines of any kind for a gateway, by the traits of `embedded-io` and `embedded-io-async`.
//!
//! A gateway does no input or output. An [`Input`] keeps what was read of a line until the gateway has taken it, an
//! [`Output`] how much of a report has been written. Both work with any reader and writer, waiting or asynchronous, and
//! with several lines at once: one input a port.
//!
//! ```
//! use foxhunt::aoa::{Clean, clean};
//! use foxhunt::gateway::{Config, Gateway, io::{Input, Output}};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // On a board: both halves of a UART.
//! let mut reader: &[u8] = b"$PFOXQ*50\r\n";
//! let mut memory = [0; 256];
//! let mut writer: &mut [u8] = &mut memory;
//!
//! let mut gateway = Gateway::<Clean<100>>::new(Config::new(clean::Config::DEFAULT))?;
//! let (mut input, mut output) = (Input::<64>::EMPTY, Output::EMPTY);
//! while input.read(&mut reader)? {
//!     while let Some(byte) = input.take() {
//!         if gateway.push(0, byte).is_some() {
//!             output.begin();
//!             output.write(gateway.vehicle().report(), &mut writer)?;
//!         }
//!     }
//! }
//! assert!(memory.starts_with(b"$PFOXN,"));
//! # Ok(())
//! # }
//! ```
//!
//! With `embedded-io-async`, two ports are two inputs, of which whichever has something comes first:
//!
//! ```ignore
//! loop {
//!     select(inputs[0].read_async(&mut gnss), inputs[1].read_async(&mut finder)).await;
//!     for (port, input) in inputs.iter_mut().enumerate() {
//!         while let Some(byte) = input.take() {
//!             if gateway.push(port, byte, &CONFIG).is_some() {
//!                 output.begin();
//!                 output.write_async(gateway.report(), &mut computer).await?;
//!             }
//!         }
//!     }
//! }
//! ```
//!
//! A future of either can be dropped at any time: nothing is lost or sent twice, if the reader and the writer lose nothing
//! when theirs are dropped. Those of `embassy` with buffers of their own do not; a DMA transfer into the caller's buffer
//! does.

/// What was read of a line, up to `B` bytes, and not yet taken by the gateway.
#[derive(Debug, Clone)]
pub struct Input<const B: usize> {
    bytes: [u8; B],
    next: usize,
    end: usize,
}

impl<const B: usize> Input<B> {
    /// Nothing was read. All bits are zero.
    pub const EMPTY: Self = {
        assert!(B > 0, "bytes are read into it");
        Self {
            bytes: [0; B],
            next: 0,
            end: 0,
        }
    };

    /// The next byte for the gateway.
    pub fn take(&mut self) -> Option<u8> {
        let byte = self.bytes.get(self.next..self.end)?.first().copied()?;
        self.next += 1;
        Some(byte)
    }

    /// Waits until there is a byte to take. False when the line has ended.
    ///
    /// # Errors
    /// That of the reader.
    pub fn read<R: embedded_io::Read>(&mut self, reader: &mut R) -> Result<bool, R::Error> {
        if self.is_empty() {
            let read = reader.read(&mut self.bytes)?;
            self.hold(read);
        }
        Ok(!self.is_empty())
    }

    /// The same with a reader that lets others work meanwhile.
    ///
    /// # Errors
    /// That of the reader.
    pub async fn read_async<R: embedded_io_async::Read>(
        &mut self,
        reader: &mut R,
    ) -> Result<bool, R::Error> {
        if self.is_empty() {
            let read = reader.read(&mut self.bytes).await?;
            self.hold(read);
        }
        Ok(!self.is_empty())
    }

    fn is_empty(&self) -> bool {
        self.next >= self.end
    }

    fn hold(&mut self, read: usize) {
        (self.next, self.end) = (0, read.min(B));
    }
}

/// How much of a report has been written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Output {
    written: usize,
}

impl Output {
    /// Nothing has been written. All bits are zero.
    pub const EMPTY: Self = Self { written: 0 };

    /// Begins with a new report.
    pub fn begin(&mut self) {
        self.written = 0;
    }

    /// What is left to write of the report.
    pub fn rest<'a>(&self, report: &'a str) -> &'a [u8] {
        report.as_bytes().get(self.written..).unwrap_or_default()
    }

    /// Writes what is left of the report.
    ///
    /// # Errors
    /// That of the writer. What it took is not written again.
    pub fn write<W: embedded_io::Write>(
        &mut self,
        report: &str,
        writer: &mut W,
    ) -> Result<(), W::Error> {
        while let rest @ [_, ..] = self.rest(report) {
            self.written += writer.write(rest)?;
        }
        writer.flush()
    }

    /// The same with a writer that lets others work meanwhile.
    ///
    /// # Errors
    /// That of the writer. What it took is not written again.
    pub async fn write_async<W: embedded_io_async::Write>(
        &mut self,
        report: &str,
        writer: &mut W,
    ) -> Result<(), W::Error> {
        while let rest @ [_, ..] = self.rest(report) {
            self.written += writer.write(rest).await?;
        }
        writer.flush().await
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::{pin::pin, task::Context, vec::Vec};

    use core::{future::Future, task::Poll, task::Waker};

    use super::*;

    /// A line that lets wait two of three times, and then moves few bytes.
    #[derive(Default)]
    struct Slow {
        bytes: Vec<u8>,
        place: usize,
        calls: usize,
    }

    impl Slow {
        async fn wait(&mut self) {
            core::future::poll_fn(|_| {
                self.calls += 1;
                match self.calls % 3 {
                    0 => Poll::Ready(()),
                    _ => Poll::Pending,
                }
            })
            .await;
        }
    }

    impl embedded_io_async::ErrorType for Slow {
        type Error = core::convert::Infallible;
    }

    impl embedded_io_async::Read for Slow {
        async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Self::Error> {
            self.wait().await;
            let rest = self.bytes.get(self.place..).unwrap_or_default();
            let count = rest.len().min(buffer.len()).min(1 + self.calls % 5);
            buffer[..count].copy_from_slice(&rest[..count]);
            self.place += count;
            Ok(count)
        }
    }

    impl embedded_io_async::Write for Slow {
        async fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
            self.wait().await;
            let count = bytes.len().min(1 + self.calls % 4);
            self.bytes.extend_from_slice(&bytes[..count]);
            Ok(count)
        }

        async fn flush(&mut self) -> Result<(), Self::Error> {
            self.wait().await;
            Ok(())
        }
    }

    /// The future, polled once and then dropped.
    fn polled_once<F: Future>(future: F) -> Option<F::Output> {
        match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
            Poll::Ready(output) => Some(output),
            Poll::Pending => None,
        }
    }

    #[test]
    fn futures_that_are_dropped_lose_nothing() {
        let sent: Vec<u8> = (0..=255).collect();
        let mut reader = Slow {
            bytes: sent.clone(),
            ..Slow::default()
        };
        let (mut input, mut received) = (Input::<7>::EMPTY, Vec::new());
        loop {
            match polled_once(input.read_async(&mut reader)) {
                Some(Ok(false)) => break,
                _ => received.extend(core::iter::from_fn(|| input.take())),
            }
        }
        assert_eq!(received, sent);

        let report = "$PFOXN,,FEW,0,,*00\r\n";
        let (mut writer, mut output) = (Slow::default(), Output::EMPTY);
        while polled_once(output.write_async(report, &mut writer)).is_none() {}
        assert_eq!(writer.bytes, report.as_bytes());
        // The next one begins at its beginning.
        output.begin();
        while polled_once(output.write_async(report, &mut writer)).is_none() {}
        assert_eq!(writer.bytes, [report, report].concat().as_bytes());
    }

    /// Takes two bytes at a time, and has to be flushed.
    #[derive(Default)]
    struct Pairs {
        bytes: Vec<u8>,
        flushed: usize,
    }

    impl embedded_io::ErrorType for Pairs {
        type Error = core::convert::Infallible;
    }

    impl embedded_io::Write for Pairs {
        fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
            let count = bytes.len().min(2);
            self.bytes.extend_from_slice(&bytes[..count]);
            Ok(count)
        }

        fn flush(&mut self) -> Result<(), Self::Error> {
            self.flushed = self.bytes.len();
            Ok(())
        }
    }

    #[test]
    fn a_report_is_written_whole_and_once() {
        let (mut writer, mut output) = (Pairs::default(), Output::EMPTY);
        assert_eq!(output.write("$PFOXN\r\n1", &mut writer), Ok(()));
        assert_eq!(writer.bytes, b"$PFOXN\r\n1");
        assert_eq!(writer.flushed, 9);
        assert_eq!(output.write("$PFOXN\r\n1", &mut writer), Ok(()));
        output.begin();
        assert_eq!(output.write("2", &mut writer), Ok(()));
        assert_eq!(writer.bytes, b"$PFOXN\r\n12");
    }

    #[test]
    fn a_reader_that_ends_is_noticed_after_its_last_byte() {
        let (mut reader, mut input): (&[u8], _) = (b"ab", Input::<8>::EMPTY);
        assert_eq!(input.take(), None);
        assert_eq!(input.read(&mut reader), Ok(true));
        assert_eq!(input.take(), Some(b'a'));
        // What was read is taken first.
        assert_eq!(input.read(&mut reader), Ok(true));
        assert_eq!(input.take(), Some(b'b'));
        assert_eq!(input.read(&mut reader), Ok(false));
    }
}
