//! The computer: a serial line by USB.

use embassy_rp::interrupt::typelevel::{Binding, USBCTRL_IRQ};
use embassy_rp::{Peri, peripherals::USB, usb};
use embassy_usb::class::cdc_acm::{BufferedReceiver, CdcAcmClass, CdcAcmError, Sender, State};
use embassy_usb::{Builder, Config, UsbDevice};
use embedded_io_async::{ErrorType, Read, Write};

/// Of full speed.
const PACKET_BYTES: u16 = 64;

type Driver<'d> = usb::Driver<'d, USB>;

/// What the device needs while it runs.
pub struct Memory<'d> {
    config: [u8; 256],
    bos: [u8; 64],
    control: [u8; 64],
    packet: [u8; PACKET_BYTES as usize],
    state: State<'d>,
}

impl Memory<'_> {
    /// Fresh memory.
    pub fn new() -> Self {
        Self {
            config: [0; 256],
            bos: [0; 64],
            control: [0; 64],
            packet: [0; PACKET_BYTES as usize],
            state: State::new(),
        }
    }
}

/// The device, which is to be run, and what comes from the computer and goes to it.
pub fn start<'d>(
    usb: Peri<'d, USB>,
    interrupts: impl Binding<USBCTRL_IRQ, usb::InterruptHandler<USB>>,
    memory: &'d mut Memory<'d>,
) -> (UsbDevice<'d, Driver<'d>>, Terminal<'d>, Computer<'d>) {
    // Of pid.codes, for tests; who sells boards needs a number of his own.
    let mut config = Config::new(0x1209, 0x0001);
    config.manufacturer = Some("foxhunt");
    config.product = Some("foxhunt vehicle gateway");
    let driver = usb::Driver::new(usb, interrupts);
    let Memory {
        config: descriptors,
        bos,
        control,
        packet,
        state,
    } = memory;
    let mut builder = Builder::new(driver, config, descriptors, bos, &mut [], control);
    let serial = CdcAcmClass::new(&mut builder, state, PACKET_BYTES);
    let device = builder.build();
    let (sender, receiver) = serial.split();
    (
        device,
        Terminal(receiver.into_buffered(packet)),
        Computer {
            sender,
            is_open: false,
        },
    )
}

/// What the computer says.
pub struct Terminal<'d>(BufferedReceiver<'d, Driver<'d>>);

impl ErrorType for Terminal<'_> {
    type Error = CdcAcmError;
}

impl Read for Terminal<'_> {
    /// Waits as long as no computer is there.
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Self::Error> {
        self.0.wait_connection().await;
        self.0.read(buffer).await
    }
}

/// What is said to the computer.
pub struct Computer<'d> {
    sender: Sender<'d, Driver<'d>>,
    /// The last packet was full: the computer waits for more, or for an empty one.
    is_open: bool,
}

impl ErrorType for Computer<'_> {
    type Error = CdcAcmError;
}

impl Write for Computer<'_> {
    /// While nobody has opened the line, bytes go nowhere.
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
        if !self.sender.dtr() {
            self.is_open = false;
            return Ok(bytes.len());
        }
        let written = self.sender.write(bytes).await?;
        self.is_open = written == usize::from(PACKET_BYTES);
        Ok(written)
    }

    async fn flush(&mut self) -> Result<(), Self::Error> {
        if self.is_open && self.sender.dtr() {
            self.sender.write(&[]).await?;
        }
        self.is_open = false;
        Ok(())
    }
}
