//! The main loop of a vehicle's firmware, round the gateway that the example names.

use cortex_m::Peripherals;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::{entry, exception};
use foxhunt::gateway::Event;
use heapless::spsc::Queue;

use super::{uart, uart::Uart, watchdog::Watchdog};
use crate::{Gateway, gateway};

/// What arrives in a third of a second at 115,200 baud, while the locator works on a bearing.
const RECEIVED_BYTES: usize = 4_096;
const SENT_BYTES: usize = 1_024;
/// No byte leads to a longer report.
const REPORT_BYTES: usize = 320;

const WATCHDOG_SECONDS: u32 = 10;
/// Ten times a second at 25 MHz: an idle board wakes to feed its watchdog.
const TICKS: u32 = 2_500_000;

#[entry]
fn main() -> ! {
    static mut GATEWAY: Gateway = gateway();
    static mut RECEIVED: Queue<u8, RECEIVED_BYTES> = Queue::new();
    static mut TO_SEND: Queue<u8, SENT_BYTES> = Queue::new();

    if let Some(mut core) = Peripherals::take() {
        core.SYST.set_clock_source(SystClkSource::Core);
        core.SYST.set_reload(TICKS - 1);
        core.SYST.clear_current();
        core.SYST.enable_interrupt();
        core.SYST.enable_counter();
    }
    let mut watchdog = Watchdog::start(WATCHDOG_SECONDS);
    let mut uart = Uart::start(RECEIVED, TO_SEND);
    let mut overruns = 0;
    defmt::info!("ready");

    // One byte a turn: the work between two feedings of the watchdog is bounded.
    loop {
        watchdog.feed();
        // With interrupts held back none can slip in between the question and the sleep; a held one wakes.
        cortex_m::interrupt::free(|_| {
            if !is_ready(&uart) {
                cortex_m::asm::wfi();
            }
        });
        // A byte is taken when there is room for all that it can lead to: reports are never cut.
        if is_ready(&uart)
            && let Some(byte) = uart.read()
            && let Some(event) = GATEWAY.push(byte)
        {
            uart.write(GATEWAY.report().as_bytes());
            log(&event);
        }
        if uart.overruns() != overruns {
            overruns = uart.overruns();
            defmt::warn!("{} overruns of the receiver", overruns);
        }
    }
}

fn is_ready(uart: &Uart) -> bool {
    uart.has_received() && uart.room() >= REPORT_BYTES
}

fn log(event: &Event) {
    match event {
        Event::Rejected(reason) => defmt::debug!("rejected: {}", reason),
        event => defmt::info!("{}", event),
    }
}

#[exception]
fn SysTick() {}

#[exception]
unsafe fn DefaultHandler(number: i16) {
    uart::interrupt(number);
}

unsafe extern "C" {
    // SAFETY: it does not exist, so a firmware in which it could be called does not link.
    safe fn the_firmware_can_panic() -> !;
}

/// The proof that nothing in the firmware panics: it links.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    the_firmware_can_panic()
}
