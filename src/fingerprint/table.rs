//! Matching by a table of log-densities.

use super::{RadioMap, Reading};

/// Sets the costs of all points to those of the readings.
pub(super) fn set<'a>(
    map: &RadioMap<'_>,
    readings: impl Iterator<Item = &'a Reading>,
    costs: &mut [u16],
) {
    costs.fill(0);
    for reading in readings {
        let level = map.level(reading.rssi_dbm);
        if let Some(row) = map.level_row(reading.beacon.into(), level) {
            add(row, costs);
        }
    }
}

/// Adds the cost of the absence of a beacon, which is the level after the last.
pub(super) fn add_missing(map: &RadioMap<'_>, beacon: usize, costs: &mut [u16]) {
    if let Some(row) = map.level_row(beacon, map.levels().count.into()) {
        add(row, costs);
    }
}

/// Adds the codes of a row to the sums of its points.
fn add(row: &[u8], sums: &mut [u16]) {
    let (words, _) = row.as_chunks::<4>();
    let (blocks, rest) = sums.as_chunks_mut::<8>();
    for (sums, bytes) in blocks.iter_mut().zip(words) {
        let word = u32::from_le_bytes(*bytes);
        sums[0] += (word & 15) as u16;
        sums[1] += (word >> 8 & 15) as u16;
        sums[2] += (word >> 16 & 15) as u16;
        sums[3] += (word >> 24 & 15) as u16;
        sums[4] += (word >> 4 & 15) as u16;
        sums[5] += (word >> 12 & 15) as u16;
        sums[6] += (word >> 20 & 15) as u16;
        sums[7] += (word >> 28) as u16;
    }
    if let Some(bytes) = words.get(blocks.len()) {
        let codes = bytes.map(|byte| byte & 15).into_iter();
        let codes = codes.chain(bytes.map(|byte| byte >> 4));
        for (sum, code) in rest.iter_mut().zip(codes) {
            *sum += u16::from(code);
        }
    }
}
