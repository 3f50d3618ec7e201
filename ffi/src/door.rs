//! The door: where pointers of C become references of Rust. No other file has `unsafe` code.
//!
//! What can be told of a pointer is told here, and refused: null, not aligned, storage of another size, storage that was not
//! initialised or is of another type. What cannot be told is up to the caller, as the header says: that a pointer leads to
//! memory of its type, that what must be kept is kept, that the pointers of a call do not overlap, and that no two calls
//! use one storage at the same time. This crate makes no Rust library, so pointers come from C alone.

use core::slice;

use crate::result::FoxhuntResult;

/// What lies in the caller's storage: a mark that says so, the configuration, and the state.
#[repr(C, align(8))]
pub struct Kept<C, S> {
    mark: u32,
    config: C,
    state: S,
}

/// A type of which C knows nothing but the size.
///
/// # Safety
/// It must be transparent over [`Kept`] of its configuration and its state.
pub unsafe trait Opaque {
    /// Its configuration.
    type Config;
    /// Its state.
    type State;
    /// The mark of storage that holds it: differs from those of all others.
    const MARK: u32;
    /// What is returned where there is no such storage.
    const MISSING: FoxhuntResult;
    /// The state at first.
    const EMPTY: Self::State;
}

/// Makes an [`Opaque`] type: `opaque!(Name = b"Mark": Config, State = EMPTY)`, with what is returned where there is none, if
/// that is not [`FoxhuntResult::Uninitialised`].
macro_rules! opaque {
    ($(#[$doc:meta])* $name:ident = $mark:literal: $config:ty, $state:ty = $empty:expr) => {
        $crate::door::opaque!($(#[$doc])* $name = $mark: $config, $state = $empty, Uninitialised);
    };
    ($(#[$doc:meta])* $name:ident = $mark:literal: $config:ty, $state:ty = $empty:expr, $missing:ident) => {
        $(#[$doc])*
        #[repr(transparent)]
        pub struct $name(pub $crate::door::Kept<$config, $state>);

        // SAFETY: it is transparent over it.
        unsafe impl $crate::door::Opaque for $name {
            type Config = $config;
            type State = $state;
            const MARK: u32 = u32::from_be_bytes(*$mark);
            const MISSING: $crate::result::FoxhuntResult = $crate::result::FoxhuntResult::$missing;
            const EMPTY: $state = $empty;
        }
    };
}
pub(crate) use opaque;

/// A plain struct that C and Rust both know.
///
/// # Safety
/// Every pattern of bits must be a value of it: it consists of numbers.
pub unsafe trait Plain: Copy {}

/// Says that structs are [`Plain`].
macro_rules! plain {
    ($($name:ty),+ $(,)?) => {$(
        // SAFETY: it consists of numbers, which the fields above show.
        unsafe impl $crate::door::Plain for $name {}
    )+};
}
pub(crate) use plain;

plain!(u8, u32, u64);

/// Refuses a pointer that is null or not aligned.
fn fits<T>(pointer: *const T) -> Result<(), FoxhuntResult> {
    if pointer.is_null() {
        Err(FoxhuntResult::NullPointer)
    } else if !pointer.is_aligned() {
        Err(FoxhuntResult::Misaligned)
    } else {
        Ok(())
    }
}

/// Makes storage hold an empty state and its configuration. `size` is what the caller takes for its size.
pub fn init<T: Opaque>(
    pointer: *mut T,
    size: usize,
    config: T::Config,
) -> Result<(), FoxhuntResult> {
    fits(pointer)?;
    if size != size_of::<T>() {
        return Err(FoxhuntResult::Size);
    }
    let kept = pointer.cast::<Kept<T::Config, T::State>>();
    // SAFETY: by its contract, the caller's storage is as large as the caller says, which is the size of `T`, and `T` is
    // transparent over `Kept`. It is aligned. The fields are written in place and not read, for there may be anything.
    unsafe {
        (&raw mut (*kept).state).write(T::EMPTY);
        (&raw mut (*kept).config).write(config);
        (&raw mut (*kept).mark).write(T::MARK);
    }
    Ok(())
}

/// Refuses storage that does not hold what it should.
fn holds<T: Opaque>(pointer: *const T) -> Result<(), FoxhuntResult> {
    fits(pointer)?;
    let kept = pointer.cast::<Kept<T::Config, T::State>>();
    // SAFETY: the pointer is aligned and, by its contract, leads to storage. That may not have been initialised: hence the
    // volatile read, of which the compiler assumes nothing.
    let mark = unsafe { (&raw const (*kept).mark).read_volatile() };
    if mark == T::MARK {
        Ok(())
    } else {
        Err(T::MISSING)
    }
}

/// Calls `work` with the configuration and the state in a storage, to change the state.
pub fn change<T: Opaque, R>(
    pointer: *mut T,
    work: impl FnOnce(&T::Config, &mut T::State) -> R,
) -> Result<R, FoxhuntResult> {
    holds(pointer)?;
    let kept = pointer.cast::<Kept<T::Config, T::State>>();
    // SAFETY: the mark says that `init` has written all of it. By its contract the caller does not use it for anything else
    // during the call, and the reference ends with it.
    let kept = unsafe { &mut *kept };
    Ok(work(&kept.config, &mut kept.state))
}

/// The same, to look at it.
pub fn look<T: Opaque, R>(
    pointer: *const T,
    work: impl FnOnce(&T::Config, &T::State) -> R,
) -> Result<R, FoxhuntResult> {
    holds(pointer)?;
    let kept = pointer.cast::<Kept<T::Config, T::State>>();
    // SAFETY: as in `change`.
    let kept = unsafe { &*kept };
    Ok(work(&kept.config, &kept.state))
}

/// The struct at a pointer.
pub fn get<T: Plain>(pointer: *const T) -> Result<T, FoxhuntResult> {
    fits(pointer)?;
    // SAFETY: it is aligned, leads to a struct of this type by the caller's contract, and every pattern of bits is one.
    Ok(unsafe { pointer.read() })
}

/// A list that the caller keeps for as long as anything that was told of it is used; none where the length is zero.
pub fn list<T: Plain>(pointer: *const T, length: usize) -> Result<&'static [T], FoxhuntResult> {
    if length == 0 {
        return Ok(&[]);
    }
    fits(pointer)?;
    if length > isize::MAX as usize / size_of::<T>().max(1) {
        return Err(FoxhuntResult::Size);
    }
    // SAFETY: it is aligned and, by the caller's contract, leads to so many values that stay as they are. Every pattern of
    // bits is one.
    Ok(unsafe { slice::from_raw_parts(pointer, length) })
}

/// Where a result is to be written.
pub struct Out<T>(*mut T);

impl<T: Copy> Out<T> {
    /// Refuses a pointer that is null or not aligned.
    pub fn new(pointer: *mut T) -> Result<Self, FoxhuntResult> {
        fits(pointer)?;
        Ok(Self(pointer))
    }

    /// The same, but that null stands for nowhere.
    pub fn optional(pointer: *mut T) -> Result<Self, FoxhuntResult> {
        if !pointer.is_null() {
            fits(pointer)?;
        }
        Ok(Self(pointer))
    }

    /// Writes it.
    pub fn write(self, value: T) {
        if !self.0.is_null() {
            // SAFETY: it is aligned, and leads to memory of this type by the caller's contract.
            unsafe { self.0.write(value) }
        }
    }
}

#[cfg(not(test))]
unsafe extern "C" {
    // SAFETY: it does not exist, so a program in which it could be called does not link.
    safe fn foxhunt_can_panic() -> !;
}

/// The proof that nothing panics: it links.
#[cfg(not(test))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    foxhunt_can_panic()
}
