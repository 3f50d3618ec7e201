//! What is known of the source of a track, beside where it is.

use crate::aoa::robust::{of_log_odds, probability};
use crate::math::{larger, smaller};
use crate::snapshot::value;

/// What is kept of a track.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slot {
    /// `None` while it is free.
    pub(super) identity: Option<u16>,
    /// Its source is no longer heard: it is kept, but not reported, until another source needs the place.
    pub(super) is_silent: bool,
    /// How many bearings of the channel were of this source, of so many.
    pub(super) heard: f32,
    pub(super) of: f32,
    /// How much more likely it is that the source has gone than that it is still heard as often as before, as a logarithm.
    pub(super) silence: f32,
    /// The largest of these since it was zero, and the largest after which it was zero again.
    pub(super) peak: f32,
    pub(super) longest: f32,
    /// Logarithm of how many times as likely the bearings of the channel are with the source as without it.
    pub(super) log_factor: f32,
    /// The silence after which it is likelier than not that the source has gone.
    pub(super) limit: f32,
}

value!(Slot {
    identity,
    is_silent,
    heard,
    of,
    silence,
    peak,
    longest,
    log_factor,
    limit
});

pub(super) const FREE: Slot = Slot {
    identity: None,
    is_silent: false,
    heard: 0.0,
    of: 0.0,
    silence: 0.0,
    peak: 0.0,
    longest: 0.0,
    log_factor: 0.0,
    limit: 0.0,
};

/// How many times as long as it has been before, a source may be silent, for those that are heard in bursts: more keeps false
/// tracks for longer.
const LONGER: f32 = 3.0;

/// Logarithm of how much more often a source is heard than outliers look like it: more deletes a source that is heard seldom
/// later, and false tracks, too.
const HEARD: f32 = 2.0;

impl Slot {
    pub(super) fn is_live(&self) -> bool {
        self.identity.is_some() && !self.is_silent
    }

    /// What part of the bearings of the channel are of this source.
    pub(super) fn rate(&self) -> f32 {
        if self.is_live() {
            self.heard / self.of
        } else {
            0.0
        }
    }

    /// Takes the logarithm of how many times as likely a bearing is with the source as without it.
    pub(super) fn weigh(&mut self, log_factor: f32) {
        /// Beyond this nothing is learned, and nothing forgotten: more takes as many bearings longer to take back.
        const MOST: f32 = 30.0;
        self.log_factor = (self.log_factor + log_factor).clamp(-MOST, MOST);
    }

    /// Whether it is more likely that there is no such source.
    pub(super) fn is_unlikely(&self) -> bool {
        probability(self.log_factor) < 0.5
    }

    /// The probability that there is such a source, and that it is still heard.
    pub(super) fn probability(&self) -> f32 {
        probability(self.log_factor) * of_log_odds(self.limit - self.silence)
    }

    /// Counts a bearing of the channel. The source has gone if its silence exceeds `most` and what it was before; it is back
    /// when some more bearings are its own.
    pub(super) fn count(&mut self, is_own: bool, most: f32) {
        let limit = most + LONGER * self.longest;
        self.limit = limit;
        self.of += 1.0;
        if is_own {
            self.heard += 1.0;
            let silence = smaller(self.silence, limit);
            self.silence = larger(0.0, silence - HEARD);
            self.is_silent &= self.silence > 0.5 * limit;
            if self.silence == 0.0 {
                self.longest = larger(self.longest, self.peak);
                self.peak = 0.0;
            }
        } else {
            self.silence += self.heard / self.of;
            self.peak = larger(self.peak, self.silence);
            self.is_silent |= self.identity.is_some() && self.silence > limit;
        }
    }
}
