//! Matching by a table of log-densities.

use super::{
    Encoding, MapError, Match, MatchError, Matcher, Missing, Posterior, RadioMap, Reading,
    Settings, check, for_each_accepted, missing, posterior::Exponentials,
};

/// Compares scans with a table of kernel densities by level: the samples are no part of the work any more
/// (Cui et al. 2017, eq. 1 to 7, with the samples of eq. 3 folded in beforehand).
///
/// The inflation and the outliers of the settings have no effect: the table has its own.
///
/// Takes some 620 bytes.
#[derive(Debug, Clone)]
pub struct TableMatcher<'a> {
    map: RadioMap<'a>,
    settings: Settings,
    exponentials: Exponentials,
}

impl<'a> TableMatcher<'a> {
    /// Of a map of [`Encoding::Levels`].
    ///
    /// # Errors
    /// [`MapError::Encoding`] for another.
    pub fn new(map: RadioMap<'a>, settings: &Settings) -> Result<Self, MapError> {
        if map.encoding() != Encoding::Levels {
            return Err(MapError::Encoding);
        }
        Ok(Self {
            map,
            settings: *settings,
            exponentials: Exponentials::new(map.levels().step * settings.tempering()),
        })
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

impl Matcher for TableMatcher<'_> {
    fn locate<const P: usize>(
        &self,
        scan: &[Reading],
        posterior: &mut Posterior<P>,
    ) -> Result<Match, MatchError> {
        check::<P>(&self.map, scan)?;
        let costs = posterior
            .costs_mut(self.map.lattice().points())
            .ok_or(MatchError::Points)?;
        costs.fill(0);
        let used = for_each_accepted(scan, &self.settings, |reading| {
            let level = self.map.level(reading.rssi_dbm);
            if let Some(row) = self.map.level_row(reading.beacon.into(), level) {
                add(row, costs);
            }
        })?;
        let levels = self.map.levels();
        if self.settings.missing() == Missing::Modelled {
            // The level after the last is the absence.
            let absence = usize::from(levels.count);
            let rows = missing(&self.map, scan, &self.settings)
                .filter_map(|beacon| self.map.level_row(beacon, absence));
            for row in rows {
                add(row, costs);
            }
        }
        let (located, cost) = posterior
            .of_costs(&self.map, &self.exponentials)
            .ok_or(MatchError::Survey)?;
        let log_likelihood = levels.top * used as f32 - levels.step * f32::from(cost);
        Ok(located.with(log_likelihood, used))
    }
}
