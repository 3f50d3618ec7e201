//! UARTs of the MPS2 boards (CMSDK APB UARTs), driven by their interrupts through two queues: three are read, and UART0
//! sends.
//!
//! Nothing here waits. When the queue of received bytes is full, the receive interrupt is switched off until
//! there is room: the emulator then holds the sender back, as a line with hardware flow control would.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use heapless::spsc::{Consumer, Producer, Queue};

/// How many UARTs are read, from UART0 on.
const PORTS: usize = 3;

/// The registers, each UART's 0x1000 bytes after those of the one before; the manual is that of the Cortex-M System Design
/// Kit.
#[repr(C)]
struct Registers {
    data: UnsafeCell<u32>,
    state: UnsafeCell<u32>,
    control: UnsafeCell<u32>,
    interrupts: UnsafeCell<u32>,
    baud_divider: UnsafeCell<u32>,
}

const STATE_TRANSMIT_FULL: u32 = 1 << 0;
const STATE_RECEIVE_FULL: u32 = 1 << 1;
const STATE_RECEIVE_OVERRUN: u32 = 1 << 3;
/// Transmitter and receiver on, with an interrupt each.
const CONTROL_ALL: u32 = 0b1111;
const TRANSMIT: u32 = 1 << 0;
const RECEIVE: u32 = 1 << 1;
/// 115,200 baud from 25 MHz.
const BAUD_DIVIDER: u32 = 217;

#[derive(Clone, Copy)]
#[repr(u16)]
enum Interrupt {
    Receive0 = 0,
    Transmit0 = 1,
    Receive1 = 2,
    Receive2 = 4,
}

// SAFETY: these are the numbers of the interrupts of UART0 to UART2.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self as u16
    }
}

const fn receive(port: usize) -> Interrupt {
    match port {
        0 => Interrupt::Receive0,
        1 => Interrupt::Receive1,
        _ => Interrupt::Receive2,
    }
}

/// A byte, and the number of the UART by which it came.
pub type Received = (u8, u8);

/// The ends of the queues that belong to the interrupts.
struct Ends {
    received: Producer<'static, Received>,
    to_send: Consumer<'static, u8>,
}

struct Shared(UnsafeCell<Option<Ends>>);

// SAFETY: `Uarts::start` writes it before the interrupts are on; afterwards only `interrupt` uses it, and that
// does not preempt itself, because all interrupts keep the priority that they have after a reset.
unsafe impl Sync for Shared {}

static ENDS: Shared = Shared(UnsafeCell::new(None));
static OVERRUNS: AtomicU32 = AtomicU32::new(0);

/// The UARTs, seen from the main loop.
pub struct Uarts {
    received: Consumer<'static, Received>,
    to_send: Producer<'static, u8>,
}

impl Uarts {
    /// Switches the UARTs and their interrupts on. To be called once.
    pub fn start<const R: usize, const S: usize>(
        received: &'static mut Queue<Received, R>,
        to_send: &'static mut Queue<u8, S>,
    ) -> Self {
        let (received_in, received_out) = received.split();
        let (to_send_in, to_send_out) = to_send.split();
        // SAFETY: the interrupts are off, so nobody else looks.
        unsafe {
            *ENDS.0.get() = Some(Ends {
                received: received_in,
                to_send: to_send_out,
            })
        };
        for port in 0..PORTS {
            let uart = registers(port);
            write(&uart.baud_divider, BAUD_DIVIDER);
            write(&uart.control, CONTROL_ALL);
            // SAFETY: no critical section relies on it being off.
            unsafe { NVIC::unmask(receive(port)) };
        }
        // SAFETY: as above.
        unsafe { NVIC::unmask(Interrupt::Transmit0) };
        Self {
            received: received_out,
            to_send: to_send_in,
        }
    }

    /// The number of a port and the next byte that it received, in the order in which bytes came.
    pub fn read(&mut self) -> Option<(usize, u8)> {
        let (port, byte) = self.received.dequeue()?;
        // There is room again, should the interrupts have switched themselves off.
        for port in 0..PORTS {
            // SAFETY: no critical section relies on it being off.
            unsafe { NVIC::unmask(receive(port)) };
        }
        Some((usize::from(port), byte))
    }

    /// Whether there is something to read.
    pub fn has_received(&self) -> bool {
        self.received.ready()
    }

    /// Whether there is room to write.
    pub fn has_room(&self) -> bool {
        self.to_send.ready()
    }

    /// Sends the bytes for which there is room, and says how many these are.
    pub fn write(&mut self, bytes: &[u8]) -> usize {
        let mut written = 0;
        for byte in bytes {
            if self.to_send.enqueue(*byte).is_err() {
                break;
            }
            written += 1;
        }
        // The transmitter may be idle: let the interrupt take the first byte.
        NVIC::pend(Interrupt::Transmit0);
        written
    }

    /// How often bytes were lost because the receiver was not read in time.
    pub fn overruns(&self) -> u32 {
        OVERRUNS.load(Ordering::Relaxed)
    }
}

/// To be called by the handler of the device's interrupts, with the number of the interrupt.
pub fn interrupt(number: i16) {
    // SAFETY: see the implementation of `Sync`.
    let Some(ends) = (unsafe { &mut *ENDS.0.get() }) else {
        return;
    };
    if number == Interrupt::Transmit0 as i16 {
        let uart = registers(0);
        write(&uart.interrupts, TRANSMIT);
        if read(&uart.state) & STATE_TRANSMIT_FULL == 0
            && let Some(byte) = ends.to_send.dequeue()
        {
            write(&uart.data, u32::from(byte));
        }
        return;
    }
    let port = usize::from(number as u16) / 2;
    if port >= PORTS {
        return;
    }
    if !ends.received.ready() {
        // Still pending: it comes back as soon as the main loop has made room.
        NVIC::mask(receive(port));
        return;
    }
    let uart = registers(port);
    write(&uart.interrupts, RECEIVE);
    let state = read(&uart.state);
    if state & STATE_RECEIVE_OVERRUN != 0 {
        write(&uart.state, STATE_RECEIVE_OVERRUN);
        OVERRUNS.fetch_add(1, Ordering::Relaxed);
    }
    if state & STATE_RECEIVE_FULL != 0 {
        // There is room: this was checked above.
        let _ = ends.received.enqueue((port as u8, read(&uart.data) as u8));
    }
}

fn registers(port: usize) -> &'static Registers {
    // SAFETY: UART0 to UART2 are there on this board, and all their registers may be read and written at any time.
    unsafe { &*((0x4000_4000 + 0x1000 * port) as *const Registers) }
}

fn read(register: &UnsafeCell<u32>) -> u32 {
    // SAFETY: only `registers` makes references to registers.
    unsafe { register.get().read_volatile() }
}

fn write(register: &UnsafeCell<u32>, value: u32) {
    // SAFETY: as above.
    unsafe { register.get().write_volatile(value) }
}
