//! The firmware of a vehicle on a Raspberry Pi Pico 2: a navigation receiver and a direction finder on UARTs, a computer by
//! USB. What the three say comes in, where the transmitter is goes out to the computer. The pins are in the README beside
//! this crate.

#![no_std]
#![no_main]

use defmt_rtt as _;
use panic_probe as _;

mod usb;

use embassy_executor::Executor;
use embassy_futures::join::join;
use embassy_rp::uart::{self, BufferedInterruptHandler, BufferedUart};
use embassy_rp::watchdog::Watchdog;
use embassy_rp::{bind_interrupts, peripherals};
use embassy_time::{Duration, Ticker};
use foxhunt_boards::{Board, MainLoop, either::Either, vehicle::Hunt};
#[cfg(not(feature = "city"))]
use foxhunt_gateways::board::{CONFIG, Gateway};
#[cfg(feature = "city")]
use foxhunt_gateways::robust::{CONFIG, Gateway};
use usb::Memory;

const RECEIVER_BAUD: u32 = 9_600;
const FINDER_BAUD: u32 = 115_200;

/// The chip can count to 16.
const WATCHDOG: Duration = Duration::from_secs(10);

/// What arrives in a third of a second at 115,200 baud, while the locator works on a bearing.
const RECEIVED_BYTES: usize = 4_096;

bind_interrupts!(struct Interrupts {
    UART0_IRQ => BufferedInterruptHandler<peripherals::UART0>;
    UART1_IRQ => BufferedInterruptHandler<peripherals::UART1>;
    USBCTRL_IRQ => embassy_rp::usb::InterruptHandler<peripherals::USB>;
});

struct Pico {
    watchdog: Watchdog,
    ticker: Ticker,
}

impl Board for Pico {
    fn feed(&mut self) {
        self.watchdog.feed(WATCHDOG);
    }

    async fn tick(&mut self) {
        self.ticker.next().await;
    }
}

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut GATEWAY: Gateway = Gateway::EMPTY;
    static mut EXECUTOR: Option<Executor> = None;
    EXECUTOR.insert(Executor::new()).run(|spawner| {
        // There is room for one such task.
        if let Ok(task) = firmware(GATEWAY) {
            spawner.spawn(task);
        }
    })
}

#[embassy_executor::task]
async fn firmware(gateway: &'static mut Gateway) {
    let chip = embassy_rp::init(Default::default());
    let mut watchdog = Watchdog::new(chip.WATCHDOG);
    watchdog.pause_on_debug(true);
    watchdog.start(WATCHDOG);

    let mut buffers = [[0; RECEIVED_BYTES]; 2];
    // Nothing is sent by them.
    let [mut none, mut nothing] = [[0; 1]; 2];
    let [from_receiver, from_finder] = &mut buffers;
    let rate = |baudrate| {
        let mut config = uart::Config::default();
        config.baudrate = baudrate;
        config
    };
    let receiver = BufferedUart::new(
        chip.UART0,
        chip.PIN_0,
        chip.PIN_1,
        Interrupts,
        &mut none,
        from_receiver,
        rate(RECEIVER_BAUD),
    );
    let finder = BufferedUart::new(
        chip.UART1,
        chip.PIN_4,
        chip.PIN_5,
        Interrupts,
        &mut nothing,
        from_finder,
        rate(FINDER_BAUD),
    );
    let (_, receiver) = receiver.split();
    let (_, finder) = finder.split();

    let mut memory = Memory::new();
    let (mut device, terminal, computer) = usb::start(chip.USB, Interrupts, &mut memory);

    let hunt = Hunt::new(gateway, &CONFIG);
    let lines = [
        Either::One(terminal),
        Either::Other(receiver),
        Either::Other(finder),
    ];
    let pico = Pico {
        watchdog,
        ticker: Ticker::every(Duration::from_secs(1)),
    };
    defmt::info!("ready");
    join(
        device.run(),
        MainLoop::new(hunt, lines, computer).run_async(pico),
    )
    .await;
}
