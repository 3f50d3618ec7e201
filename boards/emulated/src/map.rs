//! Radio maps for what is measured, written where they are read.

/// How many bytes a map by moments takes.
pub const fn bytes(beacons: usize, points: usize) -> usize {
    44 + 6 * beacons + points / 8 + 2 * beacons * points + 4
}

/// Writes a map by moments on a lattice of so many columns and rows, a metre apart: with beacons 0, 1, ..., an error of this
/// length, packets of 4 dB, and the code of the sigma and the mean that a beacon has at a point. `bytes` has its
/// [size](bytes).
pub fn write(
    bytes: &mut [u8],
    [beacons, columns, rows]: [u8; 3],
    length_m: f32,
    moments: impl Fn(usize, usize) -> [u8; 2],
) {
    let points = usize::from(columns) * usize::from(rows);
    let count = usize::from(beacons);
    let (content, checksum) = bytes.split_at_mut(bytes.len() - 4);
    let written = b"FXRM\x02\x01".iter().copied();
    let written = written
        .chain([beacons, 0, columns, 0, rows, 0])
        .chain([0; 8])
        .chain(1.0_f32.to_le_bytes())
        .chain([0; 10])
        .chain(length_m.to_le_bytes())
        .chain([0, 0, 0, 0, 16, 0])
        .chain((0..beacons).flat_map(|beacon| [beacon, 0, 0, 0, 0, 0]))
        .chain(core::iter::repeat_n(0xff, points / 8))
        .chain((0..count * points).flat_map(|i| moments(i / points, i % points)));
    for (to, from) in content.iter_mut().zip(written) {
        *to = from;
    }
    checksum.copy_from_slice(&crc32(content).to_le_bytes());
}

/// As of IEEE 802.3, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 }
        })
    })
}
