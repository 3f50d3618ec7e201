//! Sentences with a checksum, as NMEA 0183 has them.

use alloc::{format, string::String};
use core::fmt::Display;

use foxhunt::gateway::beacon::Packet;

/// `$payload*hh`, with its line end.
pub fn sentence(payload: impl Display) -> String {
    let payload = format!("{payload}");
    let checksum = payload.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${payload}*{checksum:02X}\r\n")
}

/// The sentence of a packet that a radio heard.
pub fn of_packet(packet: &Packet) -> String {
    let Packet {
        time_ms,
        radio,
        tag,
        rssi_dbm,
    } = packet;
    sentence(format_args!("PFOXB,{time_ms},{radio},{tag},{rssi_dbm}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_has_its_checksum() {
        assert_eq!(sentence("PFOXQ"), "$PFOXQ*50\r\n");
    }
}
