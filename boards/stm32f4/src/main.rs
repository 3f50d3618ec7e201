//! The firmware of a vehicle on an STM32F411: a navigation receiver and a direction finder on lines of their
//! own, a computer by the debugger's USB port. What the three say comes in, where the transmitter is goes out
//! to the computer. The pins are in the README beside this crate.

#![no_std]
#![no_main]

use defmt_rtt as _;
use panic_probe as _;

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use cortex_m::peripheral::syst::SystClkSource;
    use foxhunt_boards::lines::LOST;
    use foxhunt_boards::queue::{Received, ToSend};
    use foxhunt_boards::{MainLoop, vehicle::Hunt};
    use foxhunt_gateways::board::{CONFIG, Gateway};
    use heapless::spsc::{Consumer, Producer, Queue};
    use stm32f4xx_hal::pac::{Interrupt, USART1, USART2, USART6};
    use stm32f4xx_hal::rcc;
    use stm32f4xx_hal::serial::{Instance, Rx, Tx};
    use stm32f4xx_hal::watchdog::IndependentWatchdog;
    use stm32f4xx_hal::{nb, prelude::*};

    const RECEIVER_BAUD: u32 = 9_600;
    const FINDER_BAUD: u32 = 115_200;
    const COMPUTER_BAUD: u32 = 115_200;

    /// The most at the core voltage that the chip has after a reset.
    const CLOCK_HZ: u32 = 84_000_000;
    const WATCHDOG_SECONDS: u32 = 10;
    /// Ten times a second an idle board wakes to feed its watchdog.
    const TICKS: u32 = CLOCK_HZ / 10;

    /// What arrives in a third of a second at 115,200 baud, while the locator works on a bearing.
    const RECEIVED_BYTES: usize = 4_096;
    const SENT_BYTES: usize = 1_024;

    /// The emulator has no clocks to set up.
    const IS_EMULATED: bool = cfg!(feature = "emulated");

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        receiver: Port<USART1>,
        finder: Port<USART6>,
        computer: Port<USART2>,
        transmitter: Tx<USART2>,
        to_transmit: Consumer<'static, u8>,
        readers: [Received<'static>; 3],
        writer: ToSend<'static, fn()>,
        watchdog: IndependentWatchdog,
    }

    #[init(local = [
        from_receiver: Queue<u8, RECEIVED_BYTES> = Queue::new(),
        from_finder: Queue<u8, RECEIVED_BYTES> = Queue::new(),
        from_computer: Queue<u8, RECEIVED_BYTES> = Queue::new(),
        to_computer: Queue<u8, SENT_BYTES> = Queue::new(),
    ])]
    fn init(context: init::Context) -> (Shared, Local) {
        let device = context.device;
        // First of all: it also ends a wait for a clock that does not come.
        let mut watchdog = IndependentWatchdog::new(device.IWDG);
        watchdog.stop_on_debug(&device.DBGMCU, true);
        watchdog.start(WATCHDOG_SECONDS.secs());

        // On a NUCLEO the debugger drives the clock input. A Black Pill has a crystal: `rcc::Config::hse(25.MHz())`.
        let clocks = rcc::Config::hse(8.MHz()).bypass_hse_oscillator();
        let mut rcc = match IS_EMULATED {
            false => device.RCC.freeze(clocks.sysclk(CLOCK_HZ.Hz())),
            true => device.RCC.constrain(),
        };

        let a = device.GPIOA.split(&mut rcc);
        let c = device.GPIOC.split(&mut rcc);
        // An open line reads as silence.
        let receiver_pin = a.pa10.into_alternate::<7>().internal_pull_up(true);
        let finder_pin = c.pc7.into_alternate::<8>().internal_pull_up(true);
        let computer_pin = a.pa3.into_alternate::<7>().internal_pull_up(true);
        let (uart1, uart2, uart6) = (device.USART1, device.USART2, device.USART6);
        let receiver = uart1.rx(receiver_pin, RECEIVER_BAUD.bps(), &mut rcc);
        let finder = uart6.rx(finder_pin, FINDER_BAUD.bps(), &mut rcc);
        let computer = uart2.serial((a.pa2, computer_pin), COMPUTER_BAUD.bps(), &mut rcc);
        let (transmitter, computer) = or_reset(computer).split();

        let (receiver, from_receiver) = connect(or_reset(receiver), context.local.from_receiver);
        let (finder, from_finder) = connect(or_reset(finder), context.local.from_finder);
        let (computer, from_computer) = connect(computer, context.local.from_computer);
        let (to_send, to_transmit) = context.local.to_computer.split();

        let mut timer = context.core.SYST;
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(TICKS - 1);
        timer.clear_current();
        timer.enable_interrupt();
        timer.enable_counter();

        defmt::info!("ready");
        let local = Local {
            receiver,
            finder,
            computer,
            transmitter,
            to_transmit,
            readers: [from_receiver, from_finder, from_computer],
            writer: ToSend::new(to_send, || rtic::pend(Interrupt::USART2)),
            watchdog,
        };
        (Shared {}, local)
    }

    #[idle(local = [
        readers, writer, watchdog,
        gateway: Gateway = Gateway::EMPTY,
    ])]
    fn idle(context: idle::Context) -> ! {
        let idle::LocalResources {
            readers,
            writer,
            watchdog,
            gateway,
            ..
        } = context.local;
        // `wfe` returns at once if there was an interrupt since the last time: none is slept through.
        MainLoop::new(Hunt::new(gateway, &CONFIG), readers.each_mut(), writer)
            .run(|| watchdog.feed(), cortex_m::asm::wfe)
    }

    /// What the chip can do; else its watchdog starts it again, until somebody looks.
    fn or_reset<T, E>(result: Result<T, E>) -> T {
        match result {
            Ok(value) => value,
            Err(_) => loop {
                cortex_m::asm::wfe();
            },
        }
    }

    /// Wakes the loop.
    #[task(binds = SysTick)]
    fn tick(_: tick::Context) {}

    #[task(binds = USART1, local = [receiver])]
    fn receiver(context: receiver::Context) {
        context.local.receiver.receive();
    }

    #[task(binds = USART6, local = [finder])]
    fn finder(context: finder::Context) {
        context.local.finder.receive();
    }

    #[task(binds = USART2, local = [computer, transmitter, to_transmit])]
    fn computer(context: computer::Context) {
        let computer::LocalResources {
            computer,
            transmitter,
            to_transmit,
            ..
        } = context.local;
        computer.receive();
        while let Some(byte) = to_transmit.peek()
            && transmitter.write(*byte).is_ok()
        {
            to_transmit.dequeue();
        }
        if to_transmit.ready() {
            transmitter.listen();
        } else {
            transmitter.unlisten();
        }
    }

    /// The end of a port that belongs to its interrupt.
    pub struct Port<U: Instance> {
        uart: Rx<U>,
        received: Producer<'static, u8>,
        has_lost: bool,
    }

    impl<U: Instance> Port<U> {
        fn receive(&mut self) {
            let byte = match self.uart.read() {
                Ok(byte) => byte,
                Err(nb::Error::Other(_)) => LOST,
                Err(nb::Error::WouldBlock) => return,
            };
            if self.has_lost {
                self.has_lost = self.received.enqueue(LOST).is_err();
            }
            self.has_lost |= self.received.enqueue(byte).is_err();
        }
    }

    fn connect<U: Instance>(
        mut uart: Rx<U>,
        queue: &'static mut Queue<u8, RECEIVED_BYTES>,
    ) -> (Port<U>, Received<'static>) {
        uart.listen();
        let (sender, received) = queue.split();
        let port = Port {
            uart,
            received: sender,
            has_lost: false,
        };
        (port, Received(received))
    }
}
