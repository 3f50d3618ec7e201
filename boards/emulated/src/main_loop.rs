//! The main loop of a gateway's firmware.
//!
//! It is not that of real boards, in `boards/shared`, which reads a queue of each line: of more than one queue the compiler
//! does not see the length, and keeps the check against a division by zero, in which a firmware could panic.

use cortex_m::Peripherals;
use cortex_m::peripheral::syst::SystClkSource;
use heapless::spsc::Queue;

use crate::{
    uart::{Received, Uarts},
    watchdog::Watchdog,
};

/// What arrives in a sixth of a second at 115,200 baud, while a gateway works on a message.
const RECEIVED_BYTES: usize = 2_048;
const SENT_BYTES: usize = 1_024;

const WATCHDOG_SECONDS: u32 = 10;
/// Ten times a second at 25 MHz: an idle board wakes to feed its watchdog.
const TICKS: u32 = 2_500_000;

/// The queues between the UARTs and the gateway.
pub struct Queues {
    received: Queue<Received, RECEIVED_BYTES>,
    to_send: Queue<u8, SENT_BYTES>,
}

impl Queues {
    /// Empty ones.
    #[allow(clippy::new_without_default, reason = "they are for a static")]
    pub const fn new() -> Self {
        Self {
            received: Queue::new(),
            to_send: Queue::new(),
        }
    }
}

/// Feeds the gateway with the bytes of the UARTs and sends its reports by UART0, for ever.
pub fn run<G, E: defmt::Format>(
    gateway: &'static mut G,
    push: impl Fn(&mut G, usize, u8) -> Option<E>,
    report: impl Fn(&G) -> &str,
    queues: &'static mut Queues,
) -> ! {
    if let Some(mut core) = Peripherals::take() {
        core.SYST.set_clock_source(SystClkSource::Core);
        core.SYST.set_reload(TICKS - 1);
        core.SYST.clear_current();
        core.SYST.enable_interrupt();
        core.SYST.enable_counter();
    }
    let mut watchdog = Watchdog::start(WATCHDOG_SECONDS);
    let mut uarts = Uarts::start(&mut queues.received, &mut queues.to_send);
    let mut overruns = 0;
    // Bytes of the present report that were handed to the UART.
    let mut sent = 0;
    defmt::info!("ready");

    // One byte a turn: the work between two feedings of the watchdog is bounded.
    loop {
        watchdog.feed();
        let unsent = report(gateway).as_bytes().get(sent..).unwrap_or_default();
        // With interrupts held back none can slip in between the question and the sleep; a held one wakes.
        cortex_m::interrupt::free(|_| {
            let is_ready = match unsent {
                [] => uarts.has_received(),
                _ => uarts.has_room(),
            };
            if !is_ready {
                cortex_m::asm::wfi();
            }
        });
        // The next byte is taken when the report of the last one is on its way: reports are never cut.
        if !unsent.is_empty() {
            sent += uarts.write(unsent);
        } else if let Some((port, byte)) = uarts.read()
            && let Some(event) = push(gateway, port, byte)
        {
            sent = 0;
            defmt::info!("{}", event);
        }
        if uarts.overruns() != overruns {
            overruns = uarts.overruns();
            defmt::warn!("{} overruns of the receiver", overruns);
        }
    }
}
