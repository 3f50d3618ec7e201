//! The firmware of a radio of a tunnel on an nRF52840: it hears tags, hands on what radios further out have heard, and sends
//! both to the next board inwards.

#![no_std]
#![no_main]

use defmt_rtt as _;
use panic_probe as _;

use embassy_executor::Executor;
use embassy_futures::join::join;
use embassy_nrf::buffered_uarte::{self, BufferedUarte};
use embassy_nrf::radio::ieee802154::Radio;
use embassy_nrf::uarte::Baudrate;
use embassy_nrf::{bind_interrupts, peripherals, radio};
use embassy_sync::{blocking_mutex::raw::NoopRawMutex, pipe::Pipe};
use foxhunt_boards::{either::Either, radio::relay};
use foxhunt_nrf52840::board::{self, Chip, SENT_BYTES};
use foxhunt_nrf52840::hear::{IDENTIFIER, hear};

const RADIOS_BAUD: Baudrate = Baudrate::Baud115200;

/// Frames that wait to be handed on.
const WAITING_BYTES: usize = 512;

bind_interrupts!(struct Interrupts {
    UARTE1 => buffered_uarte::InterruptHandler<peripherals::UARTE1>;
    RADIO => radio::InterruptHandler<peripherals::RADIO>;
});

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut EXECUTOR: Option<Executor> = None;
    board::run(EXECUTOR, firmware())
}

#[embassy_executor::task]
async fn firmware() {
    let nrf = board::start();
    let chip = Chip::new(nrf.WDT);
    let mut received = [0; WAITING_BYTES];
    let mut sent = [0; SENT_BYTES];
    let line = BufferedUarte::new(
        nrf.UARTE1,
        nrf.TIMER1,
        nrf.PPI_CH0,
        nrf.PPI_CH1,
        nrf.PPI_GROUP0,
        nrf.P1_01,
        nrf.P1_02,
        Interrupts,
        board::rate(RADIOS_BAUD),
        &mut received,
        &mut sent,
    );
    let (outwards, inwards) = line.split();
    let heard = Pipe::<NoopRawMutex, WAITING_BYTES>::new();
    let lines = [Either::One(outwards), Either::Other(&heard)];
    defmt::info!("ready, radio {}", IDENTIFIER);
    let radio = Radio::new(nrf.RADIO, Interrupts);
    join(relay(lines, inwards, chip), hear(radio, &heard)).await;
}
