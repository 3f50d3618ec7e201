//! What cases compute, in one number.

use core::fmt::{self, Write};

/// One number for everything that a case computed: a 64-bit FNV-1a hash.
pub struct Digest(pub u64);

impl Digest {
    /// Of nothing.
    #[allow(
        clippy::new_without_default,
        reason = "it is no value that one would leave out"
    )]
    pub fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Adds numbers by their bits. Which NaN a platform makes is its own affair: all of them count as the same.
    pub fn add(&mut self, numbers: &[f32]) {
        for number in numbers {
            let bits = if number.is_nan() {
                f32::NAN.to_bits()
            } else {
                number.to_bits()
            };
            self.add_bytes(&bits.to_le_bytes());
        }
    }

    /// Adds numbers of things.
    pub fn add_counts(&mut self, counts: &[usize]) {
        for count in counts {
            self.add_bytes(&(*count as u64).to_le_bytes());
        }
    }

    /// Adds all that a value shows of itself.
    pub fn add_shown(&mut self, value: &impl fmt::Debug) {
        // Writing to a digest cannot fail.
        let _ = write!(self, "{value:?};");
    }

    /// Adds bytes.
    pub fn add_bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

impl Write for Digest {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.add_bytes(text.as_bytes());
        Ok(())
    }
}

/// Columns of numbers hold none that some core takes for zero, and no NaN: a core that flushes subnormal numbers computes
/// what the others do.
///
/// # Panics
/// When one does.
pub fn assert_normal(columns: &[&[f32]]) {
    let numbers = columns.iter().copied().flatten();
    for number in numbers {
        assert!(
            !number.is_subnormal() && !number.is_nan(),
            "a column holds {number:e}"
        );
    }
}
