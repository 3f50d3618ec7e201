//! The thread of the search.

use std::sync::{Arc, atomic::Ordering::Relaxed};

use anyhow::Result;
use foxhunt::gateway::Event;
use foxhunt_decode::Refusal;
use tokio::sync::{mpsc, oneshot};

use super::{
    clock::now_ms,
    hub::{Hub, Out},
    status::Status,
};
use crate::{
    engine::{
        Command, Engine, Happened, Piece, What,
        message::{Health, InputHealth, Message, OutputHealth},
    },
    log::Writer,
};

/// What is asked of the search.
pub enum Ask {
    /// A piece has come in. Whoever sent it may wait until it is taken and in the log.
    Piece(Piece, Option<oneshot::Sender<Result<u64, String>>>),
    /// A second has passed.
    Tick,
    /// There will be no more.
    Stop,
}

/// Pieces that wait at most; then inputs do.
const WAITING: usize = 4_096;

/// A way to the search.
#[derive(Clone)]
pub struct Search(mpsc::Sender<Ask>);

impl Search {
    /// The way, and where it ends.
    pub fn new() -> (Self, mpsc::Receiver<Ask>) {
        let (sender, receiver) = mpsc::channel(WAITING);
        (Self(sender), receiver)
    }

    /// Sends; false if the search is over.
    pub async fn send(&self, ask: Ask) -> bool {
        self.0.send(ask).await.is_ok()
    }

    /// The same from a thread.
    pub fn send_blocking(&self, ask: Ask) -> bool {
        self.0.blocking_send(ask).is_ok()
    }

    /// Sends a piece, and waits until it is taken; the number of the last result.
    ///
    /// # Errors
    /// Why it was of no use.
    pub async fn taken(&self, piece: Piece) -> Result<u64, String> {
        let (sender, receiver) = oneshot::channel();
        let over = || "the search is over".to_owned();
        if !self.send(Ask::Piece(piece, Some(sender))).await {
            return Err(over());
        }
        receiver.await.unwrap_or_else(|_| Err(over()))
    }

    /// Sends a command, and waits until it is done.
    ///
    /// # Errors
    /// Why it cannot be done.
    pub async fn command(&self, command: Command) -> Result<u64, String> {
        let what = What::Command(command);
        let time_ms = now_ms();
        self.taken(Piece { time_ms, what }).await
    }
}

/// What the thread has.
pub struct Core {
    /// The search.
    pub engine: Engine,
    /// The raw log.
    pub log: Option<Writer>,
    /// Where results go.
    pub hub: Arc<Hub>,
    /// Of the inputs.
    pub inputs: Vec<Arc<Status>>,
    /// Of the outputs.
    pub outputs: Vec<Arc<Status>>,
}

impl Core {
    /// Runs until there is nothing more; gives the search back.
    ///
    /// # Errors
    /// If the log cannot be written.
    pub fn run(mut self, mut asks: mpsc::Receiver<Ask>) -> Result<Engine> {
        let mut outs = Vec::new();
        self.engine
            .begin(&mut |happened| outs.extend(out(happened)));
        self.hub.add(outs);
        self.health();
        let mut ticks = 0u64;
        while let Some(ask) = asks.blocking_recv() {
            match ask {
                Ask::Piece(piece, waiting) => self.piece(&piece, waiting)?,
                Ask::Tick => {
                    ticks += 1;
                    self.flush()?;
                    for status in &self.inputs {
                        status.check();
                    }
                    if ticks.is_multiple_of(2) {
                        self.health();
                    }
                }
                Ask::Stop => break,
            }
        }
        self.flush()?;
        self.health();
        Ok(self.engine)
    }

    fn flush(&mut self) -> Result<()> {
        self.log.as_mut().map_or(Ok(()), Writer::flush)
    }

    fn piece(
        &mut self,
        piece: &Piece,
        waiting: Option<oneshot::Sender<Result<u64, String>>>,
    ) -> Result<()> {
        if let Some(log) = &mut self.log {
            log.write(piece)?;
        }
        // What one piece comes to is seen at once: a bearing never without the answer that knows of it.
        let mut outs = Vec::new();
        let mut refused = None;
        let done = self.engine.take(piece, &mut |happened| {
            match &happened {
                // Who did not hear that it was taken says it again.
                Happened::Refused {
                    reason: Refusal::Known,
                    ..
                } => {}
                Happened::Refused { reason, .. } => refused = Some(reason.to_string()),
                Happened::Line {
                    event: Event::Rejected(reason),
                    ..
                } => refused = Some(reason.to_string()),
                _ => {}
            }
            outs.extend(out(happened));
        });
        self.hub.add(outs);
        if let Some(waiting) = waiting {
            // What is confirmed is in the log.
            self.flush()?;
            let answer = match (done, refused) {
                (Err(error), _) => Err(format!("{error:#}")),
                (Ok(()), Some(reason)) => Err(reason),
                (Ok(()), None) => Ok(self.hub.seq()),
            };
            let _ = waiting.send(answer);
        }
        Ok(())
    }

    fn health(&self) {
        let heard = self.engine.heard();
        let inputs = heard.into_iter().zip(&self.inputs).map(|(heard, status)| {
            let (state, since_ms) = status.state();
            InputHealth {
                name: status.name.clone(),
                state,
                since_ms,
                lines: heard.lines,
                used: heard.used,
                refused: heard.refused,
            }
        });
        let outputs = self.outputs.iter().map(|status| {
            let (state, _) = status.state();
            OutputHealth {
                name: status.name.clone(),
                state,
                queued: status.queued.load(Relaxed),
                sent: status.sent.load(Relaxed),
                lost: status.lost.load(Relaxed),
            }
        });
        let health = Health {
            inputs: inputs.collect(),
            outputs: outputs.collect(),
        };
        let message = Message::Health(health);
        self.hub.add([Out::Message(Box::new(message))]);
    }
}

/// What of it is a result.
fn out(happened: Happened<'_>) -> Option<Out> {
    match happened {
        Happened::Message(message) => {
            if let Message::Refused(refused) = &message {
                let (input, reason) = (&refused.input, &refused.reason);
                eprintln!("{input}: not used: {reason}: {}", refused.text);
            }
            Some(Out::Message(Box::new(message)))
        }
        Happened::Report(report) => Some(Out::Report(report.to_owned())),
        Happened::Line { .. } | Happened::Refused { .. } => None,
    }
}
