//! The firmware of a tunnel's gateway on an nRF52840: it hears tags by its own radio, and other radios by a wired line. Where
//! the tags are goes out to a computer. Its radio map and its snapshots are in pages of flash. The pins are in the README
//! beside this crate.

#![no_std]
#![no_main]

use defmt_rtt as _;
use panic_probe as _;

use embassy_executor::Executor;
use embassy_futures::join::join;
use embassy_nrf::buffered_uarte::InterruptHandler;
use embassy_nrf::nvmc::Nvmc;
use embassy_nrf::radio::ieee802154::Radio;
use embassy_nrf::uarte::Baudrate;
use embassy_nrf::{bind_interrupts, peripherals, radio};
use embassy_sync::{blocking_mutex::raw::NoopRawMutex, pipe::Pipe};
use foxhunt::snapshot;
use foxhunt_boards::either::Either;
use foxhunt_boards::kept::Kept;
use foxhunt_boards::tunnel::{self, State, Tunnel};
use foxhunt_boards::{Application, MainLoop, slots::Slots};
use foxhunt_gateways::corridor::{self, Gateway, MAP_BYTES};
use foxhunt_nrf52840::board::{self, Chip, RECEIVED_BYTES, SENT_BYTES};
use foxhunt_nrf52840::{hear::hear, lines, storage};

const COMPUTER_BAUD: Baudrate = Baudrate::Baud115200;
const RADIOS_BAUD: Baudrate = Baudrate::Baud115200;

/// Seven snapshots fill the pages: each is then erased once in seven hours, and lasts for eight years.
const SECONDS_BETWEEN_SNAPSHOTS: u32 = 3_600;

const SNAPSHOT: usize = snapshot::largest::<State<Gateway>>().next_multiple_of(4);

/// Frames of the own radio that wait for the gateway.
const HEARD_BYTES: usize = 512;

bind_interrupts!(struct Interrupts {
    UARTE0 => InterruptHandler<peripherals::UARTE0>;
    UARTE1 => InterruptHandler<peripherals::UARTE1>;
    RADIO => radio::InterruptHandler<peripherals::RADIO>;
});

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut STATE: State<Gateway> = State::new(Gateway::EMPTY);
    static mut BUFFER: [u8; SNAPSHOT] = [0; SNAPSHOT];
    static mut NEW_MAP: [u8; MAP_BYTES] = [0; MAP_BYTES];
    static mut EXECUTOR: Option<Executor> = None;
    board::run(EXECUTOR, firmware(STATE, BUFFER, NEW_MAP))
}

#[embassy_executor::task]
async fn firmware(
    state: &'static mut State<Gateway>,
    buffer: &'static mut [u8],
    new_map: &'static mut [u8],
) {
    let nrf = board::start();
    let chip = Chip::new(nrf.WDT);
    let mut received = [[0; RECEIVED_BYTES]; 2];
    let mut sent = [0; SENT_BYTES];
    let bauds = [COMPUTER_BAUD, RADIOS_BAUD];
    let (computer, radios) = lines!(nrf, Interrupts, bauds, &mut received, &mut sent);
    let (computer, writer) = computer.split();
    let radio = Radio::new(nrf.RADIO, Interrupts);
    let heard = Pipe::<NoopRawMutex, HEARD_BYTES>::new();

    let map = storage::map().unwrap_or(corridor::EXAMPLE);
    let slots = Slots::new(Nvmc::new(nrf.NVMC), storage::SNAPSHOTS, SNAPSHOT).ok();
    let tunnel = Tunnel::<_, 3>::new(state, corridor::config(map), board::now_ms, new_map);
    let site = Site(Kept::new(tunnel, slots, buffer, SECONDS_BETWEEN_SNAPSHOTS));
    let lines = [
        Either::One(computer),
        Either::One(radios),
        Either::Other(&heard),
    ];
    defmt::info!(
        "ready, {} radios and {} points",
        map.beacons(),
        map.lattice().points()
    );
    let gateway = MainLoop::new(site, lines, writer).run_async(chip);
    join(gateway, hear(radio, &heard)).await;
}

/// A tunnel whose map is replaced by a reset.
struct Site<'a, A>(Kept<'a, A, Nvmc<'static>>);

impl<G: tunnel::Gateway, const PORTS: usize> Application for Site<'_, Tunnel<'_, G, PORTS>> {
    fn push(&mut self, port: usize, byte: u8) -> bool {
        self.0.push(port, byte)
    }

    fn report(&self) -> &str {
        self.0.report()
    }

    /// By then the computer has been told that the map is whole.
    fn tick(&mut self) {
        let Kept {
            application, slots, ..
        } = &mut self.0;
        let (Some(map), Some(slots)) = (application.new_map(), slots) else {
            return self.0.tick();
        };
        // Where tags are on one map says nothing on another.
        let cleared = slots.clear().is_ok();
        if cleared && storage::keep_map(slots.flash(), map).is_ok() {
            defmt::info!("the new map is kept");
        }
        cortex_m::peripheral::SCB::sys_reset()
    }
}
