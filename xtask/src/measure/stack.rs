//! The deepest stack that a firmware can need, from its machine code.
//!
//! Each function's frame is what its instructions take from the stack; calls are followed through the
//! whole firmware, library routines in assembly included. A call through a pointer may reach every function
//! whose address stands anywhere in the firmware. Interrupts have one priority here, so at most one handler
//! lies above the main thread.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};

use anyhow::{Context, Result, bail, ensure};
use object::{Object, ObjectSection, SectionKind, read::File};

use super::disassembly::{self, Function, Instruction};

/// What the core stacks before a handler when the FPU is in use: 26 words, and one to align them.
const EXCEPTION_FRAME: u32 = 108;

/// The deepest stack: of the main thread, and of the whole firmware.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stack {
    /// Bytes needed at most.
    pub bytes: u32,
    /// The functions of the deepest path of the main thread, with their frames.
    pub path: Vec<(String, u32)>,
}

/// Finds the deepest stack of the firmware in `elf`.
pub fn deepest(elf: &Path) -> Result<Stack> {
    let data = fs::read(elf).with_context(|| format!("cannot read {}", elf.display()))?;
    let file = File::parse(data.as_slice())?;
    let functions = disassembly::functions(elf)?;
    let mut graph = Graph::new(&functions, constants(&file)?)?;

    let table = file
        .section_by_name(".vector_table")
        .context("there is no vector table")?;
    let vectors = words(table.data()?).skip(1).filter(|&vector| vector != 0);
    let vectors: Vec<u32> = vectors.map(|vector| vector & !1).collect();
    // Only the core calls what the vector table names.
    graph
        .pointed_at
        .retain(|function| !vectors.contains(function));
    let (&reset, handlers) = vectors.split_first().context("the vector table is empty")?;
    let main = graph.deepest_from(reset)?;
    let mut deepest_handler = 0;
    for &handler in handlers {
        deepest_handler = deepest_handler.max(graph.deepest_from(handler)?.bytes);
    }
    Ok(Stack {
        bytes: main.bytes + EXCEPTION_FRAME + deepest_handler,
        path: main.path,
    })
}

/// The words of every section that is loaded, but for the vector table.
fn constants(file: &File) -> Result<BTreeSet<u32>> {
    let mut constants = BTreeSet::new();
    for section in file.sections() {
        let loaded = matches!(
            section.kind(),
            SectionKind::Text | SectionKind::ReadOnlyData | SectionKind::Data
        );
        if loaded && section.name()? != ".vector_table" {
            constants.extend(words(section.data()?));
        }
    }
    Ok(constants)
}

fn words(data: &[u8]) -> impl Iterator<Item = u32> {
    data.chunks_exact(4)
        .map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]))
}

/// Functions by address, what each takes from the stack, and whom it calls.
struct Graph {
    nodes: BTreeMap<u32, Node>,
    /// The functions whose address stands in the firmware: calls through pointers may reach them.
    pointed_at: Vec<u32>,
}

struct Node {
    name: String,
    frame: u32,
    calls: BTreeSet<u32>,
    calls_through_pointer: bool,
}

impl Graph {
    fn new(functions: &[Function], mut constants: BTreeSet<u32>) -> Result<Self> {
        let mut nodes = BTreeMap::new();
        // Symbols without instructions are data.
        let functions = functions
            .iter()
            .filter(|function| !function.instructions.is_empty());
        let starts: BTreeSet<u32> = functions.clone().map(|function| function.address).collect();
        for function in functions {
            let name = function.name();
            let calls = function.instructions.iter().filter_map(branch_target);
            let calls = calls
                .filter_map(|target| starts.range(..=target).next_back().copied())
                .filter(|&callee| callee != function.address)
                .collect();
            let mut frame = 0;
            for instruction in &function.instructions {
                frame += pushed(instruction).with_context(|| format!("in {name}"))?;
            }
            constants.extend(built_constants(&function.instructions));
            let calls_through_pointer = function.instructions.iter().any(is_indirect);
            let node = Node {
                name,
                frame,
                calls,
                calls_through_pointer,
            };
            nodes.insert(function.address, node);
        }
        let pointed_at = starts
            .into_iter()
            .filter(|start| constants.contains(&(start | 1)));
        Ok(Self {
            pointed_at: pointed_at.collect(),
            nodes,
        })
    }

    /// The deepest path from the function at `address`.
    fn deepest_from(&self, address: u32) -> Result<Stack> {
        self.descend(address, &mut Vec::new(), &mut BTreeMap::new())
    }

    fn descend(
        &self,
        address: u32,
        above: &mut Vec<u32>,
        known: &mut BTreeMap<u32, Stack>,
    ) -> Result<Stack> {
        if let Some(stack) = known.get(&address) {
            return Ok(stack.clone());
        }
        let node = self
            .nodes
            .get(&address)
            .with_context(|| format!("no function begins at {address:#x}"))?;
        ensure!(
            !above.contains(&address),
            "{} calls itself: its stack has no bound",
            node.name
        );
        above.push(address);
        let mut deepest = Stack {
            bytes: 0,
            path: Vec::new(),
        };
        let pointed_at = self
            .pointed_at
            .iter()
            .filter(|_| node.calls_through_pointer);
        for &callee in node.calls.iter().chain(pointed_at) {
            let stack = self.descend(callee, above, known)?;
            if stack.bytes > deepest.bytes {
                deepest = stack;
            }
        }
        above.pop();
        deepest.bytes += node.frame;
        deepest.path.insert(0, (node.name.clone(), node.frame));
        known.insert(address, deepest.clone());
        Ok(deepest)
    }
}

/// Where a branch with a fixed target goes, be it a call, a tail call or a jump.
fn branch_target(instruction: &Instruction) -> Option<u32> {
    if !instruction.mnemonic.starts_with(['b', 'c']) || !instruction.operands.ends_with('>') {
        return None;
    }
    let (_, target) = instruction
        .operands
        .rsplit_once("0x")
        .filter(|(_, rest)| rest.contains(" <"))
        .or_else(|| instruction.operands.split_once("0x"))?;
    u32::from_str_radix(target.split(' ').next()?, 16).ok()
}

/// Whether it is a call or a tail call through a register.
fn is_indirect(instruction: &Instruction) -> bool {
    matches!(instruction.mnemonic.as_str(), "blx" | "bx") && instruction.operands.starts_with('r')
}

/// The bytes that an instruction takes from the stack.
fn pushed(instruction: &Instruction) -> Result<u32> {
    let (name, operands) = (instruction.mnemonic.as_str(), instruction.operands.as_str());
    if name.starts_with("push") || name.starts_with("vpush") {
        return Ok(4 * super::cortex_m4::list_length(operands));
    }
    if operands.starts_with("sp!") && (name.starts_with("stmdb") || name.starts_with("vstmdb")) {
        return Ok(4 * super::cortex_m4::list_length(operands.trim_start_matches("sp!, ")));
    }
    if let Some(bytes) = operands
        .split_once("[sp, #-")
        .and_then(|(_, rest)| rest.strip_suffix("]!"))
    {
        return number(bytes);
    }
    let Some(difference) = operands
        .strip_prefix("sp, ")
        .filter(|_| name.starts_with("sub"))
    else {
        return Ok(0);
    };
    match difference.trim_start_matches("sp, ").strip_prefix('#') {
        Some(bytes) => number(bytes),
        // An epilogue that computes the old stack pointer from the frame pointer.
        None if difference.contains('#') => Ok(0),
        None => bail!("the stack grows by a variable amount: {name} {operands}"),
    }
}

/// The constants that pairs of `movw` and `movt` build in a function, whichever pairs they are.
fn built_constants(instructions: &[Instruction]) -> BTreeSet<u32> {
    let halves = |name: &str| {
        let halves = instructions
            .iter()
            .filter(|instruction| instruction.mnemonic == name);
        let halves = halves.filter_map(|instruction| {
            let (register, half) = instruction.operands.split_once(", #")?;
            Some((register, number(half).ok()?))
        });
        halves.collect::<BTreeSet<_>>()
    };
    let (low, high) = (halves("movw"), halves("movt"));
    let pair = |&(register, low): &(&str, u32)| {
        let of_register = high.iter().filter(|(other, _)| *other == register);
        of_register
            .map(|(_, high)| high << 16 | low)
            .collect::<Vec<_>>()
    };
    // Without `movt` the upper half is zero.
    low.iter()
        .map(|&(_, low)| low)
        .chain(low.iter().flat_map(pair))
        .collect()
}

/// `24` or `0x18`.
fn number(text: &str) -> Result<u32> {
    let parsed = match text.strip_prefix("0x") {
        Some(digits) => u32::from_str_radix(digits, 16),
        None => text.parse(),
    };
    parsed.with_context(|| format!("not a number: {text}"))
}
