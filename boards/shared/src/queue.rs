//! Both ends of a line that belong to the main loop: its interrupt fills one queue and empties another. They are queues of
//! `heapless` 0.9.

use embedded_io::{ErrorType, Read, ReadReady, Write};
use heapless::spsc::{Consumer, Producer};

/// Bytes that an interrupt has received. Where some were damaged or did not fit into the queue, the interrupt must put a
/// [`LOST`](crate::lines::LOST), so that the line that they belong to is rejected as a whole.
pub struct Received<'a>(pub Consumer<'a, u8>);

impl ErrorType for Received<'_> {
    type Error = core::convert::Infallible;
}

impl ReadReady for Received<'_> {
    fn read_ready(&mut self) -> Result<bool, Self::Error> {
        Ok(self.0.ready())
    }
}

impl Read for Received<'_> {
    /// Does not wait: what there is was asked before.
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Self::Error> {
        let mut count = 0;
        for place in buffer {
            let Some(byte) = self.0.dequeue() else { break };
            *place = byte;
            count += 1;
        }
        Ok(count)
    }
}

/// Bytes that an interrupt sends.
pub struct ToSend<'a, F> {
    queue: Producer<'a, u8>,
    start: F,
}

impl<'a, F: FnMut()> ToSend<'a, F> {
    /// `start` must make the interrupt look at the queue, should it be idle: else nothing is sent.
    pub fn new(queue: Producer<'a, u8>, start: F) -> Self {
        Self { queue, start }
    }
}

impl<F> ErrorType for ToSend<'_, F> {
    type Error = core::convert::Infallible;
}

impl<F: FnMut()> Write for ToSend<'_, F> {
    /// Waits while the queue is full, which the line bounds.
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
        while !self.queue.ready() {
            (self.start)();
            core::hint::spin_loop();
        }
        let mut count = 0;
        for byte in bytes {
            if self.queue.enqueue(*byte).is_err() {
                break;
            }
            count += 1;
        }
        Ok(count)
    }

    /// What was written is on its way.
    fn flush(&mut self) -> Result<(), Self::Error> {
        (self.start)();
        Ok(())
    }
}
