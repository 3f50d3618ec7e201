//! Bearings of other vehicles, from a broker. A message is acknowledged when the search has it.

use std::time::Duration;

use rumqttc::v5::{AsyncClient, Event, Incoming, mqttbytes::QoS};
use tokio::sync::mpsc;

use super::{
    again::{Failure, Never, again},
    feed::Feed,
};
use crate::{output, settings::Mqtt};

/// Messages that the broker sends before the first of them is acknowledged.
const WAITING: u16 = 200;

/// Takes what others publish under the prefix; not what this vehicle, of the name `own`, does.
pub async fn run(mqtt: Mqtt, own: String, feed: Feed) {
    again(&feed.status, || read(&mqtt, &own, &feed)).await;
}

async fn read(mqtt: &Mqtt, own: &str, feed: &Feed) -> Result<Never, Failure> {
    let mut options = output::broker(mqtt, format!("foxhunt-{own}-in")).map_err(Failure::closed)?;
    options.set_manual_acks(true);
    // The broker keeps what comes while this program is away for a moment.
    options.set_clean_start(false);
    options.set_session_expiry_interval(Some(600));
    options.set_receive_maximum(Some(WAITING));
    let (client, mut events) = AsyncClient::new(options, 64);
    // The connection must never wait for who reads it, who may wait for the connection to take an acknowledgement: it is the
    // broker that waits.
    let (sender, mut received) = mpsc::unbounded_channel();
    let task = tokio::spawn(async move {
        loop {
            let event = events.poll().await;
            let is_over = event.is_err();
            if sender.send(event).is_err() || is_over {
                return;
            }
        }
    });
    let mut was_open = false;
    let topic = format!("{}/+/bearing", mqtt.prefix());
    let own = format!("{}/{own}/", mqtt.prefix());
    let why = loop {
        match received.recv().await {
            Some(Ok(Event::Incoming(Incoming::ConnAck(_)))) => {
                if let Err(error) = client.subscribe(&topic, QoS::AtLeastOnce).await {
                    break error.to_string();
                }
                feed.status.opened();
                was_open = true;
            }
            Some(Ok(Event::Incoming(Incoming::Publish(publish)))) => {
                if !publish.topic.starts_with(own.as_bytes()) {
                    // Of no use or not: it need not come again.
                    let _ = feed.taken(&publish.payload).await;
                }
                if let Err(error) = client.ack(&publish).await {
                    break error.to_string();
                }
            }
            Some(Ok(_)) => {}
            Some(Err(error)) => break error.to_string(),
            None => break "closed".into(),
        }
    };
    let why = format!("{mqtt}: {why}");
    task.abort();
    tokio::time::sleep(Duration::from_millis(100)).await;
    Err(if was_open {
        Failure::open(why)
    } else {
        Failure::closed(why)
    })
}
