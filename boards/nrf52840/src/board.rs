//! The chip: its clocks and its watchdog.

use embassy_executor::{Executor, SpawnError, SpawnToken};
use embassy_nrf::config::{Config, HfclkSource, LfclkSource};
use embassy_nrf::peripherals::WDT;
use embassy_nrf::uarte::{self, Baudrate};
use embassy_nrf::wdt::{self, HaltConfig, SleepConfig, Watchdog, WatchdogHandle};
use embassy_nrf::{Peri, Peripherals};
use embassy_time::{Duration, Instant, Ticker};
use foxhunt_boards::Board;

/// What arrives in a third of a second at 115,200 baud, while a gateway works on a message.
pub const RECEIVED_BYTES: usize = 4_096;

/// What waits to be sent.
pub const SENT_BYTES: usize = 1_024;

const WATCHDOG_SECONDS: u32 = 10;

/// Runs a task for ever, the only one of the firmware.
pub fn run<F>(
    executor: &'static mut Option<Executor>,
    task: Result<SpawnToken<F>, SpawnError>,
) -> ! {
    executor.insert(Executor::new()).run(|spawner| {
        // There is room for one.
        if let Ok(task) = task {
            spawner.spawn(task);
        }
    })
}

/// Starts the clocks by both crystals of the development kit, and the regulator that takes least.
pub fn start() -> Peripherals {
    let mut config = Config::default();
    config.hfclk_source = HfclkSource::ExternalXtal;
    config.lfclk_source = LfclkSource::ExternalXtal;
    config.dcdc.reg1 = true;
    embassy_nrf::init(config)
}

/// The settings of a line with this rate.
pub fn rate(baudrate: Baudrate) -> uarte::Config {
    let mut config = uarte::Config::default();
    config.baudrate = baudrate;
    config
}

/// The two lines of a gateway: to and from a computer, and from somebody who only speaks, on the pins of the README.
///
/// It takes them out of the chip's parts, which leaves the rest; `Interrupts` binds `UARTE0` and `UARTE1`.
#[macro_export]
macro_rules! lines {
    ($nrf:ident, $interrupts:ident, $bauds:expr, $received:expr, $sent:expr) => {{
        let ([computer_baud, other_baud], [from_computer, from_other]) = ($bauds, $received);
        let computer = embassy_nrf::buffered_uarte::BufferedUarte::new(
            $nrf.UARTE0,
            $nrf.TIMER1,
            $nrf.PPI_CH0,
            $nrf.PPI_CH1,
            $nrf.PPI_GROUP0,
            $nrf.P0_08,
            $nrf.P0_06,
            $interrupts,
            $crate::board::rate(computer_baud),
            from_computer,
            $sent,
        );
        let other = embassy_nrf::buffered_uarte::BufferedUarteRx::new(
            $nrf.UARTE1,
            $nrf.TIMER2,
            $nrf.PPI_CH2,
            $nrf.PPI_CH3,
            $nrf.PPI_GROUP1,
            $interrupts,
            $nrf.P1_01,
            $crate::board::rate(other_baud),
            from_other,
        );
        (computer, other)
    }};
}

/// Milliseconds since the start; they overflow after 49 days.
pub fn now_ms() -> u32 {
    Instant::now().as_millis() as u32
}

/// The watchdog and a clock of seconds.
pub struct Chip {
    watchdog: Option<WatchdogHandle>,
    ticker: Ticker,
}

impl Chip {
    /// Starts the watchdog. One that runs already, with other settings, resets the board, and is then started anew.
    pub fn new(watchdog: Peri<'static, WDT>) -> Self {
        let mut config = wdt::Config::default();
        config.timeout_ticks = 32_768 * WATCHDOG_SECONDS;
        config.action_during_sleep = SleepConfig::Run;
        config.action_during_debug_halt = HaltConfig::Pause;
        let started = Watchdog::try_new::<_, 1>(watchdog, config);
        Self {
            watchdog: started.ok().map(|(_, [handle])| handle),
            ticker: Ticker::every(Duration::from_secs(1)),
        }
    }
}

impl Board for Chip {
    fn feed(&mut self) {
        if let Some(watchdog) = &mut self.watchdog {
            watchdog.pet();
        }
    }

    async fn tick(&mut self) {
        self.ticker.next().await;
    }
}
