//! What a particle knows of its floor.

use crate::snapshot::{Persist, by_value, value_as};

/// What a particle knows of its floor: [`OneFloor`], which takes no memory, or a number. Nobody else implements it.
pub trait Floor: Copy + PartialEq + core::fmt::Debug + Persist {
    /// The lowest, in bits that are all zero.
    #[doc(hidden)]
    const LOWEST: Self;

    /// Of its number, counted from 0.
    #[doc(hidden)]
    fn of(number: u8) -> Self;

    /// Its number.
    #[doc(hidden)]
    fn number(self) -> u8;
}

/// The floor of a site that has no other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OneFloor;

impl Floor for OneFloor {
    const LOWEST: Self = Self;

    #[inline(always)]
    fn of(_: u8) -> Self {
        Self
    }

    #[inline(always)]
    fn number(self) -> u8 {
        0
    }
}

value_as!(OneFloor as [u8; 0]: |_| [], |_| Some(Self));
by_value!(OneFloor);

impl Floor for u8 {
    const LOWEST: Self = 0;

    #[inline(always)]
    fn of(number: u8) -> Self {
        number
    }

    #[inline(always)]
    fn number(self) -> u8 {
        self
    }
}
