//! The board's own radio, which hears tags.

use embassy_nrf::radio::ieee802154::{Packet, Radio};
use embedded_io_async::Write;
use foxhunt::gateway::beacon;
use foxhunt_boards::radio::{dbm, frame, tag};

/// Which radio of the map this board is.
pub const IDENTIFIER: u16 = number(env!("FOXHUNT_RADIO"), 0, u16::MAX);

/// The channel on which tags send.
const CHANNEL: u8 = number(env!("FOXHUNT_CHANNEL"), 11, 26) as u8;

/// Listens for ever, and writes a frame for each packet of a tag.
pub async fn hear(mut radio: Radio<'_>, mut frames: impl Write) -> ! {
    radio.set_channel(CHANNEL);
    let mut packet = Packet::new();
    loop {
        if radio.receive(&mut packet).await.is_err() {
            continue;
        }
        let Some((tag, rssi_dbm)) = read(&packet) else {
            continue;
        };
        let packet = beacon::Packet {
            // The gateway takes its own.
            time_ms: 0,
            radio: IDENTIFIER,
            tag,
            rssi_dbm,
        };
        defmt::debug!("tag {} at {} dBm", tag, rssi_dbm);
        // A frame that finds no room is lost, as a packet is that no radio hears.
        let _ = frames.write_all(&frame(packet)).await;
    }
}

/// The tag that has sent a packet, and how strong it was.
fn read(packet: &Packet) -> Option<(u32, i8)> {
    // The first byte of a packet is its length by whoever has sent it, and may be any. Shorter ones are not rated.
    if !(3..=Packet::CAPACITY).contains(&packet.len()) {
        return None;
    }
    Some((tag(packet)?, dbm(packet.lqi())))
}

/// The number that a variable of the build holds.
const fn number(text: &str, least: u16, most: u16) -> u16 {
    match u16::from_str_radix(text, 10) {
        Ok(number) if least <= number && number <= most => number,
        _ => panic!("FOXHUNT_RADIO or FOXHUNT_CHANNEL is no number in its range"),
    }
}
