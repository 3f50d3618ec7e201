//! Values that the compiler cannot see.

use core::hint::black_box;

/// Any value at all, as far as the compiler knows.
pub fn any<T>(value: T) -> T {
    black_box(value)
}

/// A slice of any length.
pub fn some<T>(slice: &[T]) -> &[T] {
    slice.get(..any(slice.len())).unwrap_or_default()
}

/// A slice of any length.
pub fn some_mut<T>(slice: &mut [T]) -> &mut [T] {
    let length = any(slice.len());
    slice.get_mut(..length).unwrap_or_default()
}
