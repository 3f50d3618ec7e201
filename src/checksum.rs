//! The checksum of all that is stored or framed: CRC-32 as of Ethernet and zip.

use crc::{CRC_32_ISO_HDLC, Crc, NoTable, Table};

/// Without a table: a kilobyte of flash would save microseconds.
const CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// The CRC-32 of `bytes`.
pub(crate) const fn crc32(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// A kilobyte in the flash of firmware that takes snapshots, which are long and many.
static TABLE: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// The CRC-32 of `bytes`, five times as fast.
pub(crate) fn crc32_by_table(bytes: &[u8]) -> u32 {
    TABLE.checksum(bytes)
}
