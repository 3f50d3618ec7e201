//! Which input is read how.

use super::{feed::Feed, file, http, mqtt, post, serial, stdin, tcp, udp, websocket};
use crate::settings::Source;

/// Reads an input for as long as there is one.
pub async fn run(source: Source, feed: Feed, own: String) {
    match source {
        Source::Serial { path, baud } => serial::run(path, baud, feed).await,
        Source::Tcp(address) => tcp::connect(address, b"", feed).await,
        Source::TcpListen(address) => tcp::listen(address, feed).await,
        Source::Udp(address) => udp::run(address, feed).await,
        Source::File {
            path,
            from_beginning,
        } => file::run(path, from_beginning, feed).await,
        Source::Stdin => stdin::run(feed).await,
        Source::Gpsd(address) => {
            let watch = b"?WATCH={\"enable\":true,\"json\":true};\n";
            tcp::connect(address, watch, feed).await;
        }
        Source::Http { url, every_ms } => http::run(url, every_ms, feed).await,
        Source::HttpListen(address) => post::run(address, feed).await,
        Source::WebSocket(url) => websocket::run(url, feed).await,
        Source::Mqtt(mqtt) => mqtt::run(mqtt, own, feed).await,
    }
}
