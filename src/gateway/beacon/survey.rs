//! Recording a survey: what each radio hears of a tag that stands at a stated place.

use super::Rejected;
use crate::gateway::sentence::{columns, fixed};
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

impl Spot {
    /// Reads the fields `tag,x,y,floor`, in metres.
    pub(super) fn from_fields(fields: &[u8]) -> Result<Self, Rejected> {
        let [tag, x, y, floor]: [&[u8]; 4] = columns(fields).ok_or(Rejected::Unparsable)?;
        let number = |text, places| fixed(text, places).ok_or(Rejected::Unparsable);
        let place = [number(x, 3)?, number(y, 3)?];
        // As far as a map may reach, in millimetres.
        if place.iter().any(|metres| metres.abs() > 1_000_000_000) {
            return Err(Rejected::OutOfRange);
        }
        let out_of_range = |_| Rejected::OutOfRange;
        Ok(Self {
            tag: u32::try_from(number(tag, 0)?).map_err(out_of_range)?,
            place: place.map(|millimetres| millimetres as f32 / 1e3),
            floor: u8::try_from(number(floor, 0)?).map_err(out_of_range)?,
        })
    }
}

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
