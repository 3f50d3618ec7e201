//! What can be saved and restored.
//!
//! | trait | for | implemented by |
//! |---|---|---|
//! | [`Persist`] | state of any size, read in place | [`persist!`](crate::persist!), or `by_value!` for a [`Value`] |
//! | [`Value`] | a value small enough to be returned | `value!` by its fields, `value_as!` by another value |

use super::{Error, Reader, Writer};
use crate::random::{SeedableRng, Xoshiro128PlusPlus};

/// State that can be saved and restored in place.
///
/// Locators, filters, planes and generators are; so are tuples of two to four of them and mutable references to them, for
/// states that are kept apart: `snapshot::save(&(&mut locator, &mut generator), &mut buffer)`. For a type of your own,
/// [`persist!`](crate::persist!) names the fields that a snapshot holds:
///
/// ```
/// use foxhunt::filter::ParticleFilter;
/// use foxhunt::snapshot::{self, Error};
///
/// struct Hunt { filter: ParticleFilter<2, 100>, steps: u32 }
///
/// foxhunt::persist!(Hunt { filter, steps });
///
/// let hunt = Hunt { filter: ParticleFilter::new(), steps: 7 };
/// let mut buffer = [0; snapshot::largest::<Hunt>()];
/// let bytes = snapshot::save(&hunt, &mut buffer)?;
/// let mut restored = Hunt { filter: ParticleFilter::new(), steps: 0 };
/// snapshot::restore(&mut restored, bytes)?;
/// assert_eq!(restored.steps, 7);
/// # Ok::<(), Error>(())
/// ```
pub trait Persist {
    /// A hash of the type's name, its constants, its fields' names and their shapes, by [`shape`]. It does not see the
    /// types of a plain value's fields beyond their size.
    const SHAPE: u32;

    /// The most bytes that it takes.
    const BYTES: usize;

    /// Writes what [`load`](Persist::load) needs.
    fn save(&self, to: &mut Writer<'_>);

    /// Reads as [`load`](Persist::load) does, without writing anything.
    ///
    /// # Errors
    /// For every reason for which that would fail.
    fn check(&self, from: &mut Reader<'_>) -> Result<(), Error>;

    /// Reads what [`save`](Persist::save) wrote, in place.
    ///
    /// # Errors
    /// Not after a [`check`](Persist::check) of the same bytes.
    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error>;

    /// Saves several, one after the other: a column of numbers in one go.
    #[doc(hidden)]
    fn save_all(all: &[Self], to: &mut Writer<'_>)
    where
        Self: Sized,
    {
        for one in all {
            one.save(to);
        }
    }

    /// Checks several.
    #[doc(hidden)]
    fn check_all(all: &[Self], from: &mut Reader<'_>) -> Result<(), Error>
    where
        Self: Sized,
    {
        all.iter().try_for_each(|one| one.check(from))
    }

    /// Loads several.
    #[doc(hidden)]
    fn load_all(all: &mut [Self], from: &mut Reader<'_>) -> Result<(), Error>
    where
        Self: Sized,
    {
        all.iter_mut().try_for_each(|one| one.load(from))
    }
}

/// Implements [`Persist`](crate::snapshot::Persist) by the fields that a snapshot holds, in this order.
///
/// `persist!(Hunt { filter, steps })` is enough for a type without generic parameters. `persist!(impl[const N: usize]
/// Track<N> as "Track"(N) { filter, steps } without { scratch })` gives, in this order: the generic parameters, the type,
/// its name in the shape and its constants, the fields, and those that a snapshot does not hold because they follow from
/// the others or mean nothing. A field that is in neither list does not compile.
#[macro_export]
macro_rules! persist {
    ($type:ident { $($field:ident),+ $(,)? }) => {
        $crate::persist!(@ [] $type, stringify!($type), [] { $($field),+ });
    };
    (impl[$($generics:tt)*] $type:ty as $name:literal($($constant:expr),*) $($fields:tt)+) => {
        $crate::persist!(@ [$($generics)*] $type, $name, [$($constant),*] $($fields)+);
    };
    (
        @ [$($generics:tt)*] $type:ty, $name:expr, [$($constant:expr),*]
        { $($field:ident),+ $(,)? } $(without { $($left_out:ident),+ $(,)? })?
    ) => {
        impl<$($generics)*> $crate::snapshot::Persist for $type {
            const SHAPE: u32 = $crate::snapshot::shape(
                concat!($name $(, " ", stringify!($field))+),
                &[$($constant as u32,)* $($crate::snapshot::of_field(|s: &Self| &s.$field).0),+],
            );
            const BYTES: usize = 0 $(+ $crate::snapshot::of_field(|s: &Self| &s.$field).1)+;

            fn save(&self, to: &mut $crate::snapshot::Writer<'_>) {
                let Self { $($field,)+ $($($left_out: _),+)? } = self;
                $($crate::snapshot::Persist::save($field, to);)+
            }

            fn check(
                &self,
                from: &mut $crate::snapshot::Reader<'_>,
            ) -> Result<(), $crate::snapshot::Error> {
                $($crate::snapshot::Persist::check(&self.$field, from)?;)+
                Ok(())
            }

            fn load(
                &mut self,
                from: &mut $crate::snapshot::Reader<'_>,
            ) -> Result<(), $crate::snapshot::Error> {
                $($crate::snapshot::Persist::load(&mut self.$field, from)?;)+
                Ok(())
            }
        }
    };
}

/// A number for a type of this name with these constants, and shapes of its parts: their 32-bit FNV-1a hash.
pub const fn shape(name: &str, constants: &[u32]) -> u32 {
    const fn mix(hash: u32, byte: u8) -> u32 {
        (hash ^ byte as u32).wrapping_mul(0x0100_0193)
    }
    let mut hash = 0x811c_9dc5;
    let mut rest = name.as_bytes();
    while let [byte, behind @ ..] = rest {
        hash = mix(hash, *byte);
        rest = behind;
    }
    let mut rest = constants;
    while let [constant, behind @ ..] = rest {
        let [a, b, c, d] = constant.to_le_bytes();
        hash = mix(mix(mix(mix(hash, a), b), c), d);
        rest = behind;
    }
    hash
}

/// What is small enough to be read by value.
pub(crate) trait Value: Sized {
    /// The most bytes that it takes.
    const SIZE: usize;

    fn write(&self, to: &mut Writer<'_>);

    fn read(from: &mut Reader<'_>) -> Result<Self, Error>;
}

/// A structure that is a value: its fields, in this order.
macro_rules! value {
    ($type:ident { $($field:ident),+ $(,)? }) => {
        $crate::snapshot::value!(impl[] $type as stringify!($type), { $($field),+ });
    };
    (impl[$($generics:tt)*] $type:ty as $name:expr, { $($field:ident),+ $(,)? }) => {
        impl<$($generics)*> $crate::snapshot::Value for $type {
            const SIZE: usize = 0 $(+ $crate::snapshot::size_of_field(|v: &Self| &v.$field))+;

            fn write(&self, to: &mut $crate::snapshot::Writer<'_>) {
                $($crate::snapshot::Value::write(&self.$field, to);)+
            }

            fn read(
                from: &mut $crate::snapshot::Reader<'_>,
            ) -> Result<Self, $crate::snapshot::Error> {
                Ok(Self { $($field: $crate::snapshot::Value::read(from)?),+ })
            }
        }
        $crate::snapshot::by_value!(impl[$($generics)*] $type, concat!($name $(, " ", stringify!($field))+));
    };
}
pub(crate) use value;

/// A value that is written as another one, of which some are malformed: how it is written, and how it is read.
macro_rules! value_as {
    ($type:ty as $code:ty: $write:expr, $read:expr $(,)?) => {
        impl $crate::snapshot::Value for $type {
            const SIZE: usize = <$code as $crate::snapshot::Value>::SIZE;

            fn write(&self, to: &mut $crate::snapshot::Writer<'_>) {
                let write: fn(&Self) -> $code = $write;
                $crate::snapshot::Value::write(&write(self), to);
            }

            fn read(
                from: &mut $crate::snapshot::Reader<'_>,
            ) -> Result<Self, $crate::snapshot::Error> {
                let read: fn($code) -> Option<Self> = $read;
                let code = $crate::snapshot::Value::read(from)?;
                read(code).ok_or($crate::snapshot::Error::Malformed)
            }
        }
    };
}
pub(crate) use value_as;

/// A state on its own that is a value.
macro_rules! by_value {
    ($($type:ident),+) => {
        $($crate::snapshot::by_value!(impl[] $type, stringify!($type));)+
    };
    (impl[$($generics:tt)*] $type:ty, $name:expr) => {
        impl<$($generics)*> $crate::snapshot::Persist for $type {
            const SHAPE: u32 = $crate::snapshot::shape($name, &[Self::BYTES as u32]);
            const BYTES: usize = <Self as $crate::snapshot::Value>::SIZE;

            fn save(&self, to: &mut $crate::snapshot::Writer<'_>) {
                $crate::snapshot::Value::write(self, to);
            }

            fn check(
                &self,
                from: &mut $crate::snapshot::Reader<'_>,
            ) -> Result<(), $crate::snapshot::Error> {
                <Self as $crate::snapshot::Value>::read(from).map(drop)
            }

            fn load(
                &mut self,
                from: &mut $crate::snapshot::Reader<'_>,
            ) -> Result<(), $crate::snapshot::Error> {
                *self = $crate::snapshot::Value::read(from)?;
                Ok(())
            }
        }
    };
}
pub(crate) use by_value;

macro_rules! numbers {
    ($($number:ty),+) => {$(
        impl Value for $number {
            const SIZE: usize = size_of::<Self>();

            #[inline(always)]
            fn write(&self, to: &mut Writer<'_>) {
                to.bytes(self.to_le_bytes());
            }

            #[inline(always)]
            fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
                from.bytes().map(Self::from_le_bytes)
            }
        }
    )+};
}

numbers!(u8, u16, u32, u64, i8, i16, i32, i64, f32);
by_value!(
    u8,
    u16,
    u32,
    u64,
    i8,
    i16,
    i32,
    i64,
    bool,
    Xoshiro128PlusPlus
);
by_value!(impl[T: Value] Option<T>, "Option");

/// Any bits are a number: columns are copied and skipped whole.
impl Persist for f32 {
    const SHAPE: u32 = shape("f32", &[]);
    const BYTES: usize = 4;

    fn save(&self, to: &mut Writer<'_>) {
        self.write(to);
    }

    fn check(&self, from: &mut Reader<'_>) -> Result<(), Error> {
        from.skip(4).map(drop)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        *self = Value::read(from)?;
        Ok(())
    }

    fn save_all(all: &[Self], to: &mut Writer<'_>) {
        to.column(all);
    }

    fn check_all(all: &[Self], from: &mut Reader<'_>) -> Result<(), Error> {
        from.skip(size_of_val(all)).map(drop)
    }

    fn load_all(all: &mut [Self], from: &mut Reader<'_>) -> Result<(), Error> {
        from.column(all)
    }
}

impl<T: Persist, const K: usize> Persist for [T; K] {
    const SHAPE: u32 = shape("array", &[K as u32, T::SHAPE]);
    const BYTES: usize = K * T::BYTES;

    fn save(&self, to: &mut Writer<'_>) {
        T::save_all(self, to);
    }

    fn check(&self, from: &mut Reader<'_>) -> Result<(), Error> {
        T::check_all(self, from)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        T::load_all(self, from)
    }
}

impl<T: Value + Copy + Default, const K: usize> Value for [T; K] {
    const SIZE: usize = K * T::SIZE;

    fn write(&self, to: &mut Writer<'_>) {
        for value in self {
            value.write(to);
        }
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
        let mut values = [T::default(); K];
        for value in &mut values {
            *value = T::read(from)?;
        }
        Ok(values)
    }
}

impl<A: Value, B: Value> Value for (A, B) {
    const SIZE: usize = A::SIZE + B::SIZE;

    fn write(&self, to: &mut Writer<'_>) {
        self.0.write(to);
        self.1.write(to);
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
        Ok((A::read(from)?, B::read(from)?))
    }
}

value_as!(bool as u8: |flag| u8::from(*flag), |code| match code {
    0 => Some(false),
    1 => Some(true),
    _ => None,
});

/// Whether there is one, and which.
impl<T: Value> Value for Option<T> {
    const SIZE: usize = bool::SIZE + T::SIZE;

    fn write(&self, to: &mut Writer<'_>) {
        self.is_some().write(to);
        if let Some(value) = self {
            value.write(to);
        }
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
        Ok(if bool::read(from)? {
            Some(T::read(from)?)
        } else {
            None
        })
    }
}

/// The state of the generator, which is never all zero.
impl Value for Xoshiro128PlusPlus {
    const SIZE: usize = 16;

    fn write(&self, to: &mut Writer<'_>) {
        to.bytes(self.state());
    }

    fn read(from: &mut Reader<'_>) -> Result<Self, Error> {
        let state = from.bytes()?;
        if state == [0; 16] {
            return Err(Error::Malformed);
        }
        Ok(Self::from_seed(state))
    }
}

impl<T: Persist> Persist for &mut T {
    const SHAPE: u32 = T::SHAPE;
    const BYTES: usize = T::BYTES;

    fn save(&self, to: &mut Writer<'_>) {
        T::save(self, to);
    }

    fn check(&self, from: &mut Reader<'_>) -> Result<(), Error> {
        T::check(self, from)
    }

    fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        T::load(self, from)
    }
}

macro_rules! tuples {
    ($(($($part:ident $place:tt),+))+) => {$(
        impl<$($part: Persist),+> Persist for ($($part,)+) {
            const SHAPE: u32 = shape("tuple", &[$($part::SHAPE),+]);
            const BYTES: usize = 0 $(+ $part::BYTES)+;

            fn save(&self, to: &mut Writer<'_>) {
                $(self.$place.save(to);)+
            }

            fn check(&self, from: &mut Reader<'_>) -> Result<(), Error> {
                $(self.$place.check(from)?;)+
                Ok(())
            }

            fn load(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
                $(self.$place.load(from)?;)+
                Ok(())
            }
        }
    )+};
}

tuples! {
    (A 0, B 1)
    (A 0, B 1, C 2)
    (A 0, B 1, C 2, D 3)
}

/// What a macro cannot see: the shape and the bytes of a field's type.
#[doc(hidden)]
pub const fn of_field<S, F: Persist>(_: fn(&S) -> &F) -> (u32, usize) {
    (F::SHAPE, F::BYTES)
}

/// The bytes of a field's type.
pub(crate) const fn size_of_field<S, F: Value>(_: fn(&S) -> &F) -> usize {
    F::SIZE
}
