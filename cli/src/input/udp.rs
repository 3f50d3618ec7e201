//! UDP: every datagram is a message of its own.

use std::net::Ipv4Addr;

use tokio::net::UdpSocket;

use super::{
    again::{Failure, Never, again},
    feed::Feed,
};

/// Takes datagrams; at the address of a group, it joins the group.
pub async fn run(address: String, feed: Feed) {
    again(&feed.status, || read(&address, &feed)).await;
}

async fn read(address: &str, feed: &Feed) -> Result<Never, Failure> {
    let cannot = |error| Failure::closed(format!("{address}: {error}"));
    let group = address
        .rsplit_once(':')
        .and_then(|(host, port)| Some((host.parse::<Ipv4Addr>().ok()?, port)))
        .filter(|(host, _)| host.is_multicast());
    let socket = match group {
        Some((host, port)) => {
            let bound = UdpSocket::bind(format!("0.0.0.0:{port}")).await;
            let socket = bound.map_err(cannot)?;
            socket
                .join_multicast_v4(host, Ipv4Addr::UNSPECIFIED)
                .map_err(cannot)?;
            socket
        }
        None => UdpSocket::bind(address).await.map_err(cannot)?,
    };
    feed.status.opened();
    let mut bytes = vec![0; 1 << 16];
    loop {
        match socket.recv_from(&mut bytes).await {
            Ok((read, _)) => {
                feed.message(&bytes[..read]).await;
            }
            Err(error) => return Err(Failure::open(format!("{address}: {error}"))),
        }
    }
}
