//! Recording a survey: what each radio hears of a tag that stands at a stated place.

use crate::persist;
use crate::snapshot::value;

/// Where somebody stands with a tag.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Spot {
    /// The tag whose packets are recorded.
    pub tag: u32,
    /// Where it is, in metres.
    pub place: [f32; 2],
    /// On which floor.
    pub floor: u8,
}

value!(Spot { tag, place, floor });

/// Whether a survey is recorded, and where.
#[derive(Debug)]
pub(super) struct Survey {
    spot: Option<Spot>,
}

impl Survey {
    pub const EMPTY: Self = Self { spot: None };

    /// Records at another spot; at none, no more.
    pub fn turn_to(&mut self, spot: Option<Spot>) {
        self.spot = spot;
    }

    /// The spot, if a packet of this tag was heard there.
    pub fn of(&self, tag: u32) -> Option<&Spot> {
        self.spot.as_ref().filter(|spot| spot.tag == tag)
    }
}

persist!(Survey { spot });
