//! UART0 of the MPS2 boards (a CMSDK APB UART), asked again and again: the emulator holds the sender back.

use core::convert::Infallible;
use core::future::poll_fn;
use core::task::{Context, Poll};

use embedded_io_async::{ErrorType, Read, Write};

const BASE: usize = match env!("FOXHUNT_MACHINE").as_bytes() {
    b"an505" => 0x4020_0000,
    _ => 0x4000_4000,
};
const DATA: usize = 0x0;
const STATE: usize = 0x4;
const CONTROL: usize = 0x8;
const BAUD_DIVIDER: usize = 0x10;

const TRANSMIT_FULL: u32 = 1 << 0;
const RECEIVE_FULL: u32 = 1 << 1;
/// Transmitter and receiver on.
const ON: u32 = 0b11;

/// Either half of it.
pub struct Uart(());

impl Uart {
    /// Switches both halves on.
    pub fn start() -> Self {
        write(BAUD_DIVIDER, 16);
        write(CONTROL, ON);
        Self(())
    }
}

impl ErrorType for Uart {
    type Error = Infallible;
}

impl Read for Uart {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        let Some(place) = buffer.first_mut() else {
            return Ok(0);
        };
        poll_fn(|context| ready(context, read(STATE) & RECEIVE_FULL != 0)).await;
        *place = read(DATA) as u8;
        Ok(1)
    }
}

impl Write for Uart {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        let Some(byte) = bytes.first() else {
            return Ok(0);
        };
        poll_fn(|context| ready(context, read(STATE) & TRANSMIT_FULL == 0)).await;
        write(DATA, u32::from(*byte));
        Ok(1)
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

/// Asks again at once, after everybody else.
fn ready(context: &Context<'_>, is_ready: bool) -> Poll<()> {
    if is_ready {
        return Poll::Ready(());
    }
    context.waker().wake_by_ref();
    Poll::Pending
}

fn read(register: usize) -> u32 {
    // SAFETY: the UART is there on these machines, and its registers may be read at any time.
    unsafe { ((BASE + register) as *const u32).read_volatile() }
}

fn write(register: usize, value: u32) {
    // SAFETY: the UART is there on these machines, and these registers may be written at any time.
    unsafe { ((BASE + register) as *mut u32).write_volatile(value) }
}
