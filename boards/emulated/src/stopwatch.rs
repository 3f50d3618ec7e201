//! A stopwatch that counts instructions: timer 0 of the MPS2 boards (a CMSDK APB timer), in an emulator that takes 64 ns
//! for each (QEMU's `-icount shift=6`). It counts down at 25 MHz, so eight ticks are five instructions.

const TIMER: usize = 0x4000_0000;
const CONTROL: usize = 0x0;
const VALUE: usize = 0x4;
const RELOAD: usize = 0x8;

/// A stopwatch that runs.
pub struct Stopwatch {
    /// Ticks from one reading to the next.
    overhead: u32,
}

impl Stopwatch {
    /// Starts the timer. Once round it takes 2,700 million instructions.
    pub fn start() -> Self {
        write(RELOAD, u32::MAX);
        write(VALUE, u32::MAX);
        write(CONTROL, 1);
        let mut stopwatch = Self { overhead: 0 };
        stopwatch.overhead = stopwatch.ticks(|| ()).1;
        stopwatch
    }

    /// The result of `work`, and how many instructions it took, to within two.
    pub fn instructions<T>(&self, work: impl FnOnce() -> T) -> (T, u64) {
        let (result, ticks) = self.ticks(work);
        (
            result,
            u64::from(ticks.saturating_sub(self.overhead)) * 5 / 8,
        )
    }

    #[inline(never)]
    fn ticks<T>(&self, work: impl FnOnce() -> T) -> (T, u32) {
        let before = read(VALUE);
        let result = work();
        (result, before.wrapping_sub(read(VALUE)))
    }
}

fn read(register: usize) -> u32 {
    // SAFETY: the timer is there on this board, and its registers may be read at any time.
    unsafe { ((TIMER + register) as *const u32).read_volatile() }
}

fn write(register: usize, value: u32) {
    // SAFETY: the timer is there on this board, and nobody else uses it.
    unsafe { ((TIMER + register) as *mut u32).write_volatile(value) }
}
