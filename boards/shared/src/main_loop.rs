//! The main loop of a firmware.

use embassy_futures::select::{Either, select};
use embedded_io::ReadReady;
use foxhunt::gateway::io::Output;

use crate::Lines;

/// What a firmware does with the bytes of its lines.
pub trait Application {
    /// Takes the next byte of a port, and says whether a message ended with it. The work is bounded: the watchdog is fed once
    /// a byte.
    fn push(&mut self, port: usize, byte: u8) -> bool;

    /// What to send for the message that has ended, or nothing.
    fn report(&self) -> &str;

    /// Is called at every [tick](Board::tick) of a board that has them.
    fn tick(&mut self) {}
}

/// What the loop needs of a board with an executor.
pub trait Board {
    /// Lets the watchdog count from the start.
    fn feed(&mut self);

    /// Ends once a second, a fraction of the watchdog's time. A future that was dropped has not used up its second.
    fn tick(&mut self) -> impl Future<Output = ()>;
}

/// Ticks after which a computer that takes nothing is given up: the rest of that report is dropped.
const PATIENCE: u32 = 3;

/// An application, the lines that it reads, and the computer that gets its reports.
#[derive(Debug)]
pub struct MainLoop<A, R, W, const PORTS: usize> {
    application: A,
    lines: Lines<R, PORTS>,
    computer: W,
    output: Output,
    /// Failures of the lines that were told of.
    failures: u32,
}

impl<A: Application, R, W, const PORTS: usize> MainLoop<A, R, W, PORTS> {
    /// A loop that has not begun.
    pub fn new(application: A, readers: [R; PORTS], computer: W) -> Self {
        Self {
            application,
            lines: Lines::new(readers),
            computer,
            output: Output::EMPTY,
            failures: 0,
        }
    }

    /// Tells of bytes that were lost since the last time.
    fn tell(&mut self) {
        let failures = self.lines.failures();
        if failures != self.failures {
            self.failures = failures;
            #[cfg(target_os = "none")]
            defmt::warn!("bytes were lost or damaged {} times", failures);
        }
    }
}

impl<A, R, W, const PORTS: usize> MainLoop<A, R, W, PORTS>
where
    A: Application,
    R: embedded_io::Read + ReadReady,
    W: embedded_io::Write,
{
    /// Goes round for ever. `feed` feeds the watchdog. `sleep` waits until a line may have something; it must end well within
    /// the watchdog's time also if no line has.
    pub fn run(mut self, mut feed: impl FnMut(), mut sleep: impl FnMut()) -> ! {
        loop {
            feed();
            if !self.turn() {
                self.tell();
                sleep();
            }
        }
    }

    /// Takes a byte of every line that has one, and sends what it leads to. False if none had.
    pub fn turn(&mut self) -> bool {
        self.lines.poll();
        let mut has_worked = false;
        for port in 0..PORTS {
            let Some(byte) = self.lines.take(port) else {
                continue;
            };
            has_worked = true;
            if self.application.push(port, byte) {
                self.output.begin();
                // The next byte is taken when the report of the last one is on its way: reports are never cut. A computer
                // that takes none is no reason not to go on.
                let report = self.application.report();
                let _ = self.output.write(report, &mut self.computer);
            }
        }
        has_worked
    }
}

impl<A, R, W, const PORTS: usize> MainLoop<A, R, W, PORTS>
where
    A: Application,
    R: embedded_io_async::Read,
    W: embedded_io_async::Write,
{
    /// The same where others work while this one waits.
    pub async fn run_async(mut self, mut board: impl Board) -> ! {
        loop {
            self.turn_async(&mut board).await;
        }
    }

    /// Waits for bytes or a tick, takes the bytes, and sends what they lead to.
    pub async fn turn_async(&mut self, board: &mut impl Board) {
        if let Either::Second(()) = select(self.lines.wait(), board.tick()).await {
            self.application.tick();
            self.tell();
        }
        board.feed();
        for port in 0..PORTS {
            while let Some(byte) = self.lines.take(port) {
                let has_ended = self.application.push(port, byte);
                board.feed();
                if has_ended && !self.application.report().is_empty() {
                    self.send(board).await;
                }
            }
        }
    }

    async fn send(&mut self, board: &mut impl Board) {
        self.output.begin();
        for _ in 0..PATIENCE {
            let report = self.application.report();
            let written = self.output.write_async(report, &mut self.computer);
            let has_ended = select(written, board.tick()).await;
            board.feed();
            if let Either::First(_) = has_ended {
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests;
