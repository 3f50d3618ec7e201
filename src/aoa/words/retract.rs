//! Bearings that are taken back.

/// Which bearings are taken back.
///
/// ```
/// use foxhunt::aoa::{Bearing, Clean, Locator, Observation, Retract, clean::Config};
/// use foxhunt::random::{SeedableRng, Xoshiro128PlusPlus};
///
/// let mut rng = Xoshiro128PlusPlus::seed_from_u64(1);
/// let mut locator = Locator::<Clean<100>>::new(Config::DEFAULT)?;
/// for (second, east, degrees) in [(0, 0.0, 36.6), (20, 300.0, 20.8), (40, 600.0, 270.0), (60, 900.0, 339.9)] {
///     let bearing = Bearing::from_compass_degrees(degrees);
///     locator.push(&Observation::new(1000 * second, [east, 0.0], bearing, 0.02)?, &mut rng)?;
/// }
/// // The third was taken while the antenna was being turned.
/// let retracted = locator.retract(&Retract::Bearing { time_ms: 40_000, station: 0 }, &mut rng);
/// assert_eq!((retracted.bearings, retracted.merged), (1, 0));
/// assert!(locator.fix().expect("three cross").ellipse(0.95).contains([600.0, 800.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Retract {
    /// One, by its time and station.
    Bearing {
        /// When it was taken, in milliseconds.
        time_ms: u32,
        /// Number of the antenna array that took it.
        station: u8,
    },
    /// All that were taken in a span of time, both ends included.
    Span {
        /// Its beginning, in milliseconds.
        from_ms: u32,
        /// Its end, in milliseconds; not before the beginning, nor more than 24 days after it.
        until_ms: u32,
    },
    /// All that were taken near a place.
    Place {
        /// In metres east and north.
        position: [f32; 2],
        /// In metres.
        radius_m: f32,
    },
}

/// What became of the bearings that were to be taken back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Retracted {
    /// How many were taken back.
    pub bearings: u32,
    /// How many bearings stand in means of which some, but not all, were to be taken back: these stay.
    pub merged: u32,
}

impl Retracted {
    /// Nothing was taken back.
    pub(in crate::aoa) const NOTHING: Self = Self {
        bearings: 0,
        merged: 0,
    };

    /// Those of both.
    pub(in crate::aoa) const fn plus(self, other: Self) -> Self {
        Self {
            bearings: self.bearings + other.bearings,
            merged: self.merged + other.merged,
        }
    }
}
