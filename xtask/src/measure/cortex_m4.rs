//! How long instructions take on a Cortex-M4F: a model, from the timings of its Technical Reference
//! Manual, with memory that never makes it wait. Nothing here was checked on silicon.
//!
//! Loads and stores through the FPU take 2 cycles, an integer load 2 (1 after another load or a store),
//! a store 1 thanks to the write buffer, lists 1 + n, a multiply-accumulate 3, a division or a square root
//! 14, an integer division 7, everything else 1. One more if an instruction needs the result of the
//! floating-point instruction just before it. Two more for a branch that is taken, whichever way.

use super::disassembly::Instruction;

/// What the model needs to know of an instruction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Timing {
    cycles: u32,
    class: Class,
    /// The register that the next instruction cannot have without waiting.
    late_result: Option<Register>,
    /// The floating-point registers that must be there when the instruction starts.
    sources: Vec<Register>,
}

/// A single-precision register, by number.
type Register = u32;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Class {
    IntegerLoad,
    IntegerStore,
    Other,
}

/// Extra cycles of any change of the program counter: the pipeline is filled again.
pub const TAKEN_BRANCH: u32 = 2;

const CONDITIONS: [&str; 16] = [
    "eq", "ne", "hs", "cs", "lo", "cc", "mi", "pl", "vs", "vc", "hi", "ls", "ge", "lt", "gt", "le",
];
const MULTIPLY_ACCUMULATE: [&str; 8] = [
    "vmla", "vmls", "vnmla", "vnmls", "vfma", "vfms", "vfnma", "vfnms",
];
const FLOAT_ARITHMETIC: [&str; 5] = ["vadd", "vsub", "vmul", "vnmul", "vcvt"];
const DIVISION: [&str; 2] = ["vdiv", "vsqrt"];

impl Timing {
    /// Classifies an instruction.
    pub fn of(instruction: &Instruction) -> Self {
        let name = instruction.mnemonic.split('.').next().unwrap_or_default();
        let operands = instruction.operands.as_str();
        let is = |names: &[&str]| names.iter().any(|&known| is_named(name, known));
        let starts = |prefixes: &[&str]| prefixes.iter().any(|&prefix| name.starts_with(prefix));

        let late = is(&FLOAT_ARITHMETIC) || is(&MULTIPLY_ACCUMULATE) || is(&DIVISION);
        let list = || {
            operands
                .find('{')
                .map_or(0, |at| list_length(&operands[at..]))
        };
        let (cycles, class) = if is(&DIVISION) {
            (14, Class::Other)
        } else if is(&MULTIPLY_ACCUMULATE) {
            (3, Class::Other)
        } else if starts(&["vldr", "vstr"]) {
            (2, Class::Other)
        } else if starts(&["vldm", "vstm", "vpush", "vpop", "ldm", "stm", "push", "pop"]) {
            (1 + list(), Class::Other)
        } else if is(&["vmov"]) && operands.matches(',').count() == 3 {
            (2, Class::Other)
        } else if starts(&["ldrd", "strd"]) {
            (3, Class::Other)
        } else if starts(&["ldr"]) {
            (2, Class::IntegerLoad)
        } else if starts(&["str"]) {
            (1, Class::IntegerStore)
        } else if is(&["sdiv", "udiv"]) {
            (7, Class::Other)
        } else if is(&["tbb", "tbh"]) {
            (2, Class::Other)
        } else {
            (1, Class::Other)
        };

        let registers = float_registers(operands);
        // The destination comes first, except where there is none among these registers. A
        // multiply-accumulate needs its first operand late, after the multiplication.
        let only_sources = is(&["vcmp", "vcmpe"])
            || starts(&["vstr", "vstm", "vpush"])
            || (is(&["vmov"]) && !operands.starts_with(['s', 'd']));
        let only_destinations = starts(&["vldr", "vldm", "vpop"])
            || (is(&["vmov"]) && operands.matches(',').count() == 3 && !only_sources);
        let sources = match registers.as_slice() {
            _ if !name.starts_with('v') || only_destinations => Vec::new(),
            all if only_sources => all.to_vec(),
            all => all.get(1..).unwrap_or_default().to_vec(),
        };
        let late_result = registers.first().copied().filter(|_| late);
        Self {
            cycles,
            class,
            late_result,
            sources,
        }
    }

    /// The cycles of this instruction after `previous`, whose successor in memory it is.
    pub fn cycles_after(&self, previous: Option<&Self>) -> u32 {
        let Some(previous) = previous else {
            return self.cycles;
        };
        let stall = previous
            .late_result
            .is_some_and(|result| self.sources.contains(&result));
        let follows_memory = matches!(previous.class, Class::IntegerLoad | Class::IntegerStore);
        let overlapped = self.class == Class::IntegerLoad && follows_memory;
        self.cycles - u32::from(overlapped) + u32::from(stall)
    }
}

/// Whether `name` is `known`, perhaps with a condition behind it.
fn is_named(name: &str, known: &str) -> bool {
    name.strip_prefix(known)
        .is_some_and(|rest| rest.is_empty() || CONDITIONS.contains(&rest))
}

/// How many words a list such as `{r4-r7, lr}` or `{d8, d9}` moves.
pub(super) fn list_length(list: &str) -> u32 {
    list.trim_matches(['{', '}'])
        .split(',')
        .map(|range| span(range).len() as u32)
        .sum()
}

/// The single-precision registers that `operands` name, in their order.
fn float_registers(operands: &str) -> Vec<Register> {
    let words = operands
        .split([',', '{', '}', '[', ']', '!'])
        .map(str::trim);
    words
        .filter(|word| word.starts_with(['s', 'd']))
        .flat_map(span)
        .collect()
}

/// The registers of `s3`, `d1` (two) or `s16-s19`; those with other names count as one.
fn span(range: &str) -> std::ops::Range<Register> {
    let range = range.trim();
    let (first, last) = range.split_once('-').unwrap_or((range, range));
    let words = if range.starts_with('d') { 2 } else { 1 };
    let number = |name: &str| name.trim().get(1..)?.parse::<Register>().ok();
    match (number(first), number(last)) {
        (Some(first), Some(last)) => first * words..(last + 1) * words,
        _ if range.starts_with(['s', 'd']) => 0..0,
        _ => 0..1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn timing(text: &str) -> Timing {
        let (mnemonic, operands) = text.split_once(' ').unwrap_or((text, ""));
        Timing::of(&Instruction {
            address: 0,
            size: 2,
            mnemonic: mnemonic.into(),
            operands: operands.into(),
        })
    }

    fn alone(text: &str) -> u32 {
        timing(text).cycles_after(None)
    }

    fn after(previous: &str, text: &str) -> u32 {
        timing(text).cycles_after(Some(&timing(previous)))
    }

    #[test]
    fn single_instructions_take_what_the_manual_says() {
        for (text, cycles) in [
            ("adds r0, r0, #1", 1),
            ("vadd.f32 s0, s1, s2", 1),
            ("vmla.f32 s0, s1, s2", 3),
            ("vmls.f32 s0, s1, s2", 3),
            ("vdiv.f32 s0, s1, s2", 14),
            ("vdivne.f32 s0, s1, s2", 14),
            ("vsqrt.f32 s0, s1", 14),
            ("vldr s0, [r0]", 2),
            ("vstr s0, [r0, #4]", 2),
            ("vldmia r0!, {s0, s1, s2, s3}", 5),
            ("vpush {d8, d9}", 5),
            ("push.w {r4, r5, r6, lr}", 5),
            ("push {r4-r7, lr}", 6),
            ("ldr r0, [r1]", 2),
            ("ldrd r0, r1, [r2]", 3),
            ("str r0, [r1]", 1),
            ("udiv r0, r1, r2", 7),
            ("vmov r0, r1, s0, s1", 2),
            ("vmov.f32 s0, s1", 1),
            ("bls 0x100 <main>", 1),
        ] {
            assert_eq!(alone(text), cycles, "{text}");
        }
    }

    #[test]
    fn a_result_of_the_fpu_is_late_for_the_next_instruction_only_if_it_needs_it() {
        let sum = "vadd.f32 s0, s1, s2";
        assert_eq!(after(sum, "vmul.f32 s3, s0, s4"), 2);
        assert_eq!(after(sum, "vmul.f32 s0, s3, s4"), 1);
        assert_eq!(after(sum, "vstr s0, [r0]"), 3);
        assert_eq!(after(sum, "vcmp.f32 s0, #0"), 2);
        assert_eq!(after(sum, "vmov r0, s0"), 2);
        assert_eq!(after(sum, "vmla.f32 s0, s3, s4"), 3);
        assert_eq!(after(sum, "vmla.f32 s5, s0, s4"), 4);
        assert_eq!(after(sum, "vstmia r0!, {s0-s3}"), 6);
        assert_eq!(after(sum, "vldmia r0!, {s0-s3}"), 5);
        assert_eq!(after("vneg.f32 s0, s1", "vmul.f32 s3, s0, s4"), 1);
    }

    #[test]
    fn a_load_overlaps_the_access_before_it() {
        assert_eq!(after("ldr r0, [r1]", "ldr r2, [r3]"), 1);
        assert_eq!(after("str r0, [r1]", "ldr r2, [r3]"), 1);
        assert_eq!(after("adds r0, r0, #1", "ldr r2, [r3]"), 2);
        assert_eq!(after("ldr r0, [r1]", "vldr s0, [r3]"), 2);
    }
}
