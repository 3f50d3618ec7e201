//! The firmware of a vehicle on an nRF52840: a computer or a direction finder on one line, a navigation receiver on the other.
//! What they say comes in, where the transmitter is goes out by the first. It goes on after a moment without power. The pins
//! are in the README beside this crate.

#![no_std]
#![no_main]

use defmt_rtt as _;
use panic_probe as _;

use embassy_executor::Executor;
use embassy_nrf::buffered_uarte::InterruptHandler;
use embassy_nrf::nvmc::Nvmc;
use embassy_nrf::uarte::Baudrate;
use embassy_nrf::{bind_interrupts, peripherals};
use foxhunt::snapshot;
use foxhunt_boards::{MainLoop, kept::Kept, slots::Slots, vehicle::Hunt};
use foxhunt_gateways::board::{CONFIG, Gateway};
use foxhunt_nrf52840::board::{self, Chip, RECEIVED_BYTES, SENT_BYTES};
use foxhunt_nrf52840::{lines, storage::SNAPSHOTS};

const COMPUTER_BAUD: Baudrate = Baudrate::Baud115200;
const RECEIVER_BAUD: Baudrate = Baudrate::Baud9600;

/// Every page is then erased once in an hour, and lasts for more than a year of driving.
const SECONDS_BETWEEN_SNAPSHOTS: u32 = 60;

const SNAPSHOT: usize = snapshot::largest::<Gateway>().next_multiple_of(4);

bind_interrupts!(struct Interrupts {
    UARTE0 => InterruptHandler<peripherals::UARTE0>;
    UARTE1 => InterruptHandler<peripherals::UARTE1>;
});

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut GATEWAY: Gateway = Gateway::EMPTY;
    static mut BUFFER: [u8; SNAPSHOT] = [0; SNAPSHOT];
    static mut EXECUTOR: Option<Executor> = None;
    board::run(EXECUTOR, firmware(GATEWAY, BUFFER))
}

#[embassy_executor::task]
async fn firmware(gateway: &'static mut Gateway, buffer: &'static mut [u8]) {
    let nrf = board::start();
    let chip = Chip::new(nrf.WDT);
    let mut received = [[0; RECEIVED_BYTES]; 2];
    let mut sent = [0; SENT_BYTES];
    let bauds = [COMPUTER_BAUD, RECEIVER_BAUD];
    let (computer, receiver) = lines!(nrf, Interrupts, bauds, &mut received, &mut sent);
    let (computer, writer) = computer.split();

    let slots = Slots::new(Nvmc::new(nrf.NVMC), SNAPSHOTS, SNAPSHOT).ok();
    let hunt = Hunt::new(gateway, &CONFIG);
    let hunt = Kept::new(hunt, slots, buffer, SECONDS_BETWEEN_SNAPSHOTS);
    defmt::info!("ready");
    MainLoop::new(hunt, [computer, receiver], writer)
        .run_async(chip)
        .await
}
