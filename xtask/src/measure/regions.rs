//! Instructions and modelled cycles of marked regions of a firmware, from the emulator's log of every
//! block of instructions that it translates and that it executes.
//!
//! The firmware calls a function `region_edge`, which does nothing, at the beginning and at the end of each
//! region, and prints a line `region<TAB>name<TAB>items` for each, in the order of their execution. Its
//! other lines, `figure<TAB>name<TAB>value<TAB>unit`, are figures that it knows itself.

use std::{
    collections::HashMap,
    io::{BufRead, BufReader, Read},
    mem,
    path::Path,
    process::Stdio,
    thread,
};

use anyhow::{Context, Result, bail, ensure};
use foxhunt_host::figures::Figure;

use super::{
    cortex_m4::{TAKEN_BRANCH, Timing},
    disassembly,
};
use crate::qemu;

/// What a region cost, all of it together.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Cost {
    /// Executed instructions, exactly.
    pub instructions: u64,
    /// Cycles by the model of the Cortex-M4.
    pub cycles: u64,
}

/// Runs the firmware in `elf` and returns two figures of each region, per item, and its own figures.
pub fn measure(elf: &Path) -> Result<Vec<Figure>> {
    let program = Program::of(elf)?;
    let mut child = qemu::command()
        .args([
            "-chardev",
            "stdio,id=text",
            "-semihosting-config",
            "chardev=text",
        ])
        .args(["-serial", "none", "-d", "in_asm,exec,nochain"])
        .arg("-kernel")
        .arg(elf)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .context("cannot start qemu-system-arm")?;
    let mut stdout = child.stdout.take().expect("stdout is piped");
    let printed = thread::spawn(move || {
        let mut text = String::new();
        stdout.read_to_string(&mut text).map(|_| text)
    });
    let log = BufReader::with_capacity(1 << 20, child.stderr.take().expect("stderr is piped"));
    let costs = program.follow(log)?;
    let status = child.wait()?;
    let printed = printed.join().expect("reading does not panic")?;
    ensure!(status.success(), "the firmware failed:\n{printed}");
    figures(&costs, &printed)
}

/// Pairs the regions with what the firmware printed of them. Regions of one name are added up.
pub fn figures(costs: &[Cost], printed: &str) -> Result<Vec<Figure>> {
    let mut figures = Vec::new();
    let mut regions: Vec<(&str, f64, Cost)> = Vec::new();
    let mut costs = costs.iter();
    for line in printed.lines() {
        match line.split('\t').collect::<Vec<_>>().as_slice() {
            ["region", name, items] => {
                let cost = costs
                    .next()
                    .with_context(|| format!("{name} has not run"))?;
                let items: f64 = items.parse()?;
                match regions.iter_mut().find(|(known, ..)| known == name) {
                    Some((_, all_items, sum)) => {
                        *all_items += items;
                        sum.instructions += cost.instructions;
                        sum.cycles += cost.cycles;
                    }
                    None => regions.push((*name, items, *cost)),
                }
            }
            ["figure", name, value, unit] => {
                figures.push(Figure::new(*name, value.parse()?, *unit))
            }
            _ => bail!("the firmware printed: {line}"),
        }
    }
    ensure!(costs.next().is_none(), "a region has no name");
    for (name, items, cost) in regions {
        let figure =
            |what, count, unit| Figure::new(format!("{name}.{what}"), count as f64 / items, unit);
        figures.push(figure("instructions", cost.instructions, "instructions"));
        figures.push(figure("cycles_modelled", cost.cycles, "cycles"));
    }
    Ok(figures)
}

/// The instructions of a firmware by address, and the function that marks where regions begin and end.
struct Program {
    instructions: HashMap<u32, (u32, Timing)>,
    edge: std::ops::Range<u32>,
}

impl Program {
    fn of(elf: &Path) -> Result<Self> {
        let functions = disassembly::functions(elf)?;
        let edge = functions
            .iter()
            .find(|function| function.name().rsplit("::").next() == Some("region_edge"))
            .context("the firmware has no function region_edge")?;
        let last = edge
            .instructions
            .last()
            .context("region_edge has no instructions")?;
        let edge = edge.address..last.address + last.size;
        let instructions = functions.iter().flat_map(|function| &function.instructions);
        let instructions = instructions
            .map(|instruction| {
                (
                    instruction.address,
                    (instruction.size, Timing::of(instruction)),
                )
            })
            .collect();
        Ok(Self { instructions, edge })
    }

    /// Adds up the regions of the log.
    fn follow(&self, mut log: impl BufRead) -> Result<Vec<Cost>> {
        let mut sums = Sums::default();
        // By where the emulator keeps its translation.
        let mut blocks: HashMap<u64, Vec<u32>> = HashMap::new();
        let mut translated = Vec::new();
        // One for all lines: there are many millions.
        let mut line = String::new();
        while log.read_line(&mut line)? > 0 {
            if let Some(block) = executed(&line) {
                if !translated.is_empty() {
                    blocks.insert(block, mem::take(&mut translated));
                }
                let addresses = blocks.get(&block).context("a block without instructions")?;
                for address in addresses {
                    self.step(*address, &mut sums)?;
                }
            } else if line.starts_with("IN:") {
                translated.clear();
            } else {
                translated.extend(listed(&line));
            }
            line.clear();
        }
        ensure!(sums.region.is_none(), "the last region has no end");
        Ok(sums.costs)
    }

    /// Adds an instruction that was executed.
    fn step<'a>(&'a self, address: u32, sums: &mut Sums<'a>) -> Result<()> {
        let previous = sums.previous.take();
        let follows = previous
            .filter(|(next, _)| *next == address)
            .map(|(_, timing)| timing);
        if let Some(cost) = sums
            .region
            .as_mut()
            .filter(|_| previous.is_some() && follows.is_none())
        {
            cost.cycles += u64::from(TAKEN_BRANCH);
        }
        if address == self.edge.start {
            match sums.region.take() {
                Some(cost) => sums.costs.push(cost),
                None => sums.region = Some(Cost::default()),
            }
        } else if let Some(cost) = &mut sums.region
            && !self.edge.contains(&address)
        {
            let (size, timing) = self
                .instructions
                .get(&address)
                .with_context(|| format!("{address:#x} is not in the disassembly"))?;
            cost.instructions += 1;
            cost.cycles += u64::from(timing.cycles_after(follows));
            sums.previous = Some((address + size, timing));
        }
        Ok(())
    }
}

/// What was added up so far.
#[derive(Default)]
struct Sums<'a> {
    costs: Vec<Cost>,
    /// The region that has begun.
    region: Option<Cost>,
    /// The address after the last instruction of the region, and the timing of that instruction.
    previous: Option<(u32, &'a Timing)>,
}

/// The block in a line of the log: `Trace 0: 0x7f48 [00000000/00000400/00000110/ff000000]`.
fn executed(line: &str) -> Option<u64> {
    let fields = line.strip_prefix("Trace ")?.split_once(": 0x")?.1;
    u64::from_str_radix(fields.split_once(' ')?.0, 16).ok()
}

/// The address in a line of a block: `0x00000404:  480e       ldr      r0, [pc, #0x38]`.
fn listed(line: &str) -> Option<u32> {
    u32::from_str_radix(line.strip_prefix("0x")?.split_once(':')?.0, 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::disassembly::Instruction;

    fn program(listing: &[(u32, &str, &str)]) -> Program {
        let timing = |mnemonic: &str, operands: &str| {
            Timing::of(&Instruction {
                address: 0,
                size: 2,
                mnemonic: mnemonic.into(),
                operands: operands.into(),
            })
        };
        let instructions = listing
            .iter()
            .map(|&(address, mnemonic, operands)| (address, (2, timing(mnemonic, operands))))
            .collect();
        Program {
            instructions,
            edge: 0x10..0x14,
        }
    }

    /// What the emulator says of blocks that it executes, of each when it comes to it the first time.
    fn log(blocks: &[&[u32]]) -> String {
        let (mut log, mut known) = (String::new(), Vec::new());
        for block in blocks {
            if !known.contains(block) {
                known.push(*block);
                log += "----------------\nIN: main\n";
                let lines = block
                    .iter()
                    .map(|address| format!("0x{address:08x}:  bf00  nop\n"));
                log.extend(lines);
                log += "\n";
            }
            let kept = known.iter().position(|known| known == block).unwrap();
            log += &format!(
                "Trace 0: 0x7f{kept:02x} [00000000/{:08x}/00000110/ff000000]\n",
                block[0]
            );
        }
        log
    }

    #[test]
    fn a_region_is_what_runs_between_the_markers() {
        let program = program(&[
            (0x40, "vadd.f32", "s0, s1, s2"),
            (0x42, "vmul.f32", "s3, s0, s0"),
            (0x44, "bl", "0x10"),
        ]);
        let log = log(&[
            &[0x30],
            &[0x10, 0x12],
            &[0x40, 0x42, 0x44],
            &[0x10, 0x12],
            &[0x46],
        ]);
        // 1 + (1 + stall) + (1 + taken)
        let cost = Cost {
            instructions: 3,
            cycles: 6,
        };
        assert_eq!(program.follow(log.as_bytes()).unwrap(), [cost]);
    }

    #[test]
    fn a_branch_costs_more_only_when_taken() {
        let program = program(&[(0x40, "bne", "0x40"), (0x42, "nop", "")]);
        let log = log(&[&[0x10], &[0x40], &[0x40], &[0x42], &[0x10]]);
        let costs = program.follow(log.as_bytes()).unwrap();
        // Taken once, then the way on to the edge, which is not the next in memory.
        assert_eq!(
            costs,
            [Cost {
                instructions: 3,
                cycles: 1 + 2 + 1 + 1 + 2
            }]
        );
    }

    #[test]
    fn figures_are_per_item_and_regions_of_one_name_add_up() {
        let costs = [(30, 40), (1, 1), (50, 80)];
        let costs = costs.map(|(instructions, cycles)| Cost {
            instructions,
            cycles,
        });
        let printed = "region\tx\t10\nregion\ty\t1\nfigure\tbytes\t5\tbytes\nregion\tx\t10\n";
        let figures = figures(&costs, printed).unwrap();
        assert_eq!(figures[0], Figure::new("bytes", 5.0, "bytes"));
        assert_eq!(
            figures[1],
            Figure::new("x.instructions", 4.0, "instructions")
        );
        assert_eq!(figures[2], Figure::new("x.cycles_modelled", 6.0, "cycles"));
        assert_eq!(
            figures[3],
            Figure::new("y.instructions", 1.0, "instructions")
        );
    }
}
