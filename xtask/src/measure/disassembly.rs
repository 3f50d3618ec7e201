//! A firmware's functions and instructions, read from what `llvm-objdump --disassemble` prints.

use std::{collections::HashMap, fs, path::Path};

use anyhow::{Context, Result, bail};
use object::{Object, ObjectSymbol, SymbolKind, read::File};
use rustc_demangle::demangle;

use crate::llvm;

/// A function: from its symbol to the next one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Function {
    /// The symbol, mangled as it stands in the file.
    pub symbol: String,
    /// The address of the first instruction.
    pub address: u32,
    /// The instructions by address; constants between them are left out.
    pub instructions: Vec<Instruction>,
}

impl Function {
    /// The function's path as it stands in the source.
    pub fn name(&self) -> String {
        format!("{:#}", demangle(&self.symbol))
    }
}

/// One instruction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Instruction {
    /// Where it lies.
    pub address: u32,
    /// Its length in bytes: 2 or 4.
    pub size: u32,
    /// `vmul.f32`, with its condition, if it has one, and its type suffixes.
    pub mnemonic: String,
    /// `s0, s1, s2`, as printed.
    pub operands: String,
}

/// Disassembles the firmware in `elf`.
pub fn functions(elf: &Path) -> Result<Vec<Function>> {
    let mut functions = parse(&llvm::disassembly(elf)?)?;
    let sizes = sizes(elf)?;
    for function in &mut functions {
        // What the linker fills the gap to the next function with also looks like instructions.
        if let Some(size) = sizes.get(&function.address) {
            let end = function.address + size;
            function
                .instructions
                .retain(|instruction| instruction.address < end);
        }
    }
    Ok(functions)
}

/// The sizes of the functions by address, where they are known.
fn sizes(elf: &Path) -> Result<HashMap<u32, u32>> {
    let data = fs::read(elf).with_context(|| format!("cannot read {}", elf.display()))?;
    let file = File::parse(data.as_slice())?;
    let functions = file
        .symbols()
        .filter(|symbol| symbol.kind() == SymbolKind::Text);
    let functions = functions.filter(|symbol| symbol.size() > 0);
    // The lowest bit of an address only says that the code is Thumb.
    Ok(functions
        .map(|symbol| (symbol.address() as u32 & !1, symbol.size() as u32))
        .collect())
}

fn parse(text: &str) -> Result<Vec<Function>> {
    let mut functions: Vec<Function> = Vec::new();
    for line in text.lines() {
        if let Some((address, symbol)) = header(line) {
            functions.push(Function {
                symbol,
                address,
                instructions: Vec::new(),
            });
        } else if let Some(instruction) = instruction(line) {
            match functions.last_mut() {
                Some(function) => function.instructions.push(instruction),
                None => bail!("an instruction before the first symbol: {line}"),
            }
        }
    }
    functions
        .last()
        .context("there are no functions in the disassembly")?;
    Ok(functions)
}

/// `000004a8 <main>:`
fn header(line: &str) -> Option<(u32, String)> {
    let (address, symbol) = line.split_once(" <")?;
    let address = u32::from_str_radix(address, 16).ok()?;
    Some((address, symbol.strip_suffix(">:")?.to_owned()))
}

/// `     4b2: ee20 0a01    <TAB>vmul.f32<TAB>s0, s0, s2`
fn instruction(line: &str) -> Option<Instruction> {
    let mut columns = line.splitn(3, '\t');
    let (address, encoding) = columns.next()?.split_once(':')?;
    let mnemonic = columns.next()?.trim();
    // Constants between the code: `.word`, `.short`; and what is not a known instruction.
    if mnemonic.starts_with(['.', '<']) {
        return None;
    }
    let operands = columns.next().unwrap_or_default();
    // A comment follows some operands: `@ imm = #0x1e`.
    let operands = operands.split('@').next().unwrap_or_default().trim();
    let digits = encoding.bytes().filter(u8::is_ascii_hexdigit).count();
    Some(Instruction {
        address: u32::from_str_radix(address.trim(), 16).ok()?,
        size: digits as u32 / 2,
        mnemonic: mnemonic.to_owned(),
        operands: operands.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LISTING: &str = "\
cost:\tfile format elf32-littlearm

Disassembly of section .text:

00000400 <Reset>:
     400: f000 f83a    \tbl\t0x478 <main>                @ imm = #0x74
     404: b580         \tpush\t{r7, lr}
     406: 00 bf        \t.short\t0xbf00

00000478 <main>:
     478: ee20 0a01    \tvmul.f32\ts0, s0, s2
";

    #[test]
    fn functions_hold_their_instructions_without_the_constants() {
        let functions = parse(LISTING).unwrap();
        assert_eq!(functions.len(), 2);
        assert_eq!(functions[0].symbol, "Reset");
        assert_eq!(functions[0].instructions.len(), 2);
        let branch = &functions[0].instructions[0];
        assert_eq!((branch.address, branch.size), (0x400, 4));
        assert_eq!(branch.operands, "0x478 <main>");
        let multiply = &functions[1].instructions[0];
        assert_eq!(multiply.mnemonic, "vmul.f32");
        assert_eq!(multiply.operands, "s0, s0, s2");
    }
}
