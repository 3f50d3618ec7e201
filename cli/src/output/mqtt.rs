//! MQTT 5: results to a broker. Every message waits in a queue until the broker has acknowledged it.

use std::{
    collections::{BTreeSet, VecDeque},
    fs,
    sync::{Arc, atomic::Ordering::Relaxed},
    time::Duration,
};

use anyhow::{Context, Result};
use rumqttc::{
    Outgoing, Transport,
    v5::{
        AsyncClient, Event, EventLoop, Incoming, MqttOptions,
        mqttbytes::{QoS, v5::LastWill},
    },
};
use serde_json::json;
use tokio::{
    sync::mpsc,
    task::JoinHandle,
    time::{MissedTickBehavior, interval, sleep},
};

use super::{feature, queue::Queue};
use crate::{
    engine::message::Message,
    live::{
        Status,
        hub::{Item, Out, Reader},
    },
    settings::Mqtt,
};

/// Messages that are under way at once.
const UNDER_WAY: usize = 100;

/// What the client of a broker is told.
pub fn options(mqtt: &Mqtt, client: String) -> Result<MqttOptions> {
    let (host, port) = mqtt.address()?;
    let mut options = MqttOptions::new(client, host, port);
    options.set_keep_alive(Duration::from_secs(10));
    options.set_connection_timeout(5);
    if let Some(user) = &mqtt.user {
        let password = match &mqtt.password_file {
            Some(file) => fs::read_to_string(file)
                .with_context(|| format!("cannot read the password in {}", file.display()))?,
            None => String::new(),
        };
        options.set_credentials(user, password.trim_end_matches(['\r', '\n']));
    }
    if mqtt.tls == Some(true) {
        options.set_transport(match &mqtt.certificates {
            Some(file) => {
                let ca = fs::read(file)
                    .with_context(|| format!("cannot read certificates in {}", file.display()))?;
                Transport::tls(ca, None, None)
            }
            None => Transport::tls_with_default_config(),
        });
    }
    Ok(options)
}

struct Publisher {
    told: Mqtt,
    name: String,
    run: u64,
    status: Arc<Status>,
    queue: Queue,
    /// The health that was told last: only what is new is told.
    health: String,
    /// There will be no more results.
    is_over: bool,
}

/// Begins to publish; the task ends when there are no more results.
///
/// # Errors
/// If the queue, the password or the certificates cannot be read.
pub fn start(
    told: &Mqtt,
    name: &str,
    reader: Reader,
    status: Arc<Status>,
) -> Result<JoinHandle<()>> {
    options(told, String::new())?;
    let limit = told.queue_limit.unwrap_or(100_000);
    let publisher = Publisher {
        told: told.clone(),
        name: name.to_owned(),
        run: reader.after(),
        queue: Queue::new(told.queue.as_deref(), &status.name, limit)?,
        status,
        health: String::new(),
        is_over: false,
    };
    Ok(tokio::spawn(publisher.run(reader)))
}

/// How a connection ended.
enum End {
    /// Everything is published.
    Done,
    /// It was lost, for this reason.
    Lost(String),
}

/// What the task of a connection tells.
enum Told {
    Connected,
    /// A message went out, under this number.
    Sent(u16),
    /// The broker has it.
    Acknowledged(u16),
    Closed(String),
}

/// Runs a connection in a task of its own: nothing else may interrupt it.
fn watched(mut events: EventLoop) -> (JoinHandle<()>, mpsc::UnboundedReceiver<Told>) {
    let (teller, told) = mpsc::unbounded_channel();
    let task = tokio::spawn(async move {
        loop {
            let tell = match events.poll().await {
                Ok(Event::Incoming(Incoming::ConnAck(_))) => Told::Connected,
                Ok(Event::Incoming(Incoming::PubAck(ack))) => Told::Acknowledged(ack.pkid),
                Ok(Event::Outgoing(Outgoing::Publish(id))) => Told::Sent(id),
                Ok(_) => continue,
                Err(error) => Told::Closed(error.to_string()),
            };
            let is_closed = matches!(tell, Told::Closed(_));
            if teller.send(tell).is_err() || is_closed {
                return;
            }
        }
    });
    (task, told)
}

impl Publisher {
    async fn run(mut self, mut reader: Reader) {
        loop {
            match self.connection(&mut reader).await {
                Ok(End::Done) => return self.status.ended(),
                Ok(End::Lost(why)) => self.status.lost(format_args!("{}: {why}", self.told)),
                Err(error) => self.status.lost(format_args!("{error:#}")),
            }
            // What comes meanwhile waits.
            let pause = sleep(Duration::from_secs(1));
            tokio::pin!(pause);
            loop {
                tokio::select! {
                    () = &mut pause => break,
                    items = reader.next(), if !self.is_over => self.take(items),
                }
                if self.is_over {
                    return;
                }
            }
        }
    }

    /// The topic of the health.
    fn topic_of_health(&self) -> String {
        format!("{}/{}/health", self.told.prefix(), self.name)
    }

    /// What is said of the health when there is nothing more to say of it.
    fn last_health(&self, state: &str) -> String {
        json!({"station": self.name, "state": state}).to_string()
    }

    /// Publishes until the connection ends, or everything is published; says why.
    async fn connection(&mut self, reader: &mut Reader) -> Result<End> {
        let health = self.topic_of_health();
        let mut options = options(&self.told, format!("foxhunt-{}", self.name))?;
        let will = self.last_health("lost");
        let will = LastWill::new(health.clone(), will, QoS::AtLeastOnce, true, None);
        options.set_last_will(will);
        let (client, events) = AsyncClient::new(options, UNDER_WAY + 16);
        let (task, mut told) = watched(events);
        let mut is_open = false;
        let (mut last, mut handed) = (0, VecDeque::new());
        let mut under_way: Vec<(u16, u64)> = Vec::new();
        // Of a number that was used before, the acknowledgement may come first.
        let mut early: BTreeSet<u16> = BTreeSet::new();
        let mut flush = interval(Duration::from_millis(500));
        flush.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let end = loop {
            while is_open && handed.len() + under_way.len() < UNDER_WAY {
                let Some(next) = self.queue.after(last) else {
                    break;
                };
                let is_health = next.topic == health;
                let sent = client.try_publish(
                    next.topic.clone(),
                    QoS::AtLeastOnce,
                    is_health,
                    next.payload.clone(),
                );
                if sent.is_err() {
                    break;
                }
                last = next.id;
                handed.push_back(next.id);
            }
            if self.is_over && is_open && self.queue.len() == 0 {
                self.part(&client, &mut told).await?;
                self.queue.flush()?;
                break End::Done;
            }
            tokio::select! {
                items = reader.next(), if !self.is_over => self.take(items),
                _ = flush.tick() => self.queue.flush()?,
                tell = told.recv() => match tell {
                    None => break End::Lost("closed".into()),
                    Some(Told::Closed(why)) => break End::Lost(why),
                    Some(Told::Connected) => {
                        is_open = true;
                        self.status.opened();
                        self.health.clear();
                    }
                    Some(Told::Sent(number)) => {
                        if let Some(id) = handed.pop_front() {
                            if early.remove(&number) {
                                self.done(id)?;
                            } else {
                                under_way.push((number, id));
                            }
                        }
                    }
                    Some(Told::Acknowledged(number)) => {
                        match under_way.iter().position(|(other, _)| *other == number) {
                            Some(place) => {
                                let (_, id) = under_way.swap_remove(place);
                                self.done(id)?;
                            }
                            None => {
                                early.insert(number);
                            }
                        }
                    }
                },
            }
            self.status.queued.store(self.queue.len() as u64, Relaxed);
        };
        task.abort();
        Ok(end)
    }

    /// Says that this program has stopped, and closes the connection, so that the broker does not publish the last will.
    async fn part(
        &self,
        client: &AsyncClient,
        told: &mut mpsc::UnboundedReceiver<Told>,
    ) -> Result<()> {
        let stopped = self.last_health("stopped");
        let topic = self.topic_of_health();
        (client.publish(topic, QoS::AtLeastOnce, true, stopped)).await?;
        while let Some(tell) = told.recv().await {
            match tell {
                Told::Acknowledged(_) => client.disconnect().await?,
                Told::Closed(_) => break,
                Told::Connected | Told::Sent(_) => {}
            }
        }
        Ok(())
    }

    fn done(&mut self, id: u64) -> Result<()> {
        self.status.sent.fetch_add(1, Relaxed);
        self.queue.acknowledged(id)
    }

    /// Results wait; or there are no more.
    fn take(&mut self, items: Option<(Vec<Arc<Item>>, u64)>) {
        let Some((items, lost)) = items else {
            self.is_over = true;
            return;
        };
        self.status.lost.fetch_add(lost, Relaxed);
        for item in items {
            if let Out::Message(message) = &item.out {
                for (topic, payload) in self.messages(message, item.seq) {
                    let topic = format!("{}/{}/{topic}", self.told.prefix(), self.name);
                    match self.queue.push(topic, payload) {
                        Ok(lost) => {
                            self.status.lost.fetch_add(lost, Relaxed);
                        }
                        Err(error) => {
                            self.status.lost.fetch_add(1, Relaxed);
                            self.status.lost(error);
                        }
                    }
                }
            }
            self.status.read.store(item.seq, Relaxed);
        }
        self.status.queued.store(self.queue.len() as u64, Relaxed);
    }

    fn messages(&mut self, message: &Message, seq: u64) -> Vec<(String, String)> {
        if let Message::Health(health) = message {
            let states = |names: Vec<(&str, crate::engine::message::State)>| json!(names);
            let inputs = health.inputs.iter().map(|one| (&*one.name, one.state));
            let inputs = states(inputs.collect()).to_string();
            // Counts alone are no news; a broker that was away is told again.
            if self.health == inputs {
                return Vec::new();
            }
            self.health = inputs;
            let told = json!({"station": self.name, "state": "open", "health": health});
            return vec![("health".into(), told.to_string())];
        }
        let features = feature::features(message, &self.name, self.run, seq).into_iter();
        features
            .map(|(topic, feature)| (topic, feature.to_string()))
            .collect()
    }
}
