//! What a firmware occupies of the chip's memories.

use std::{fs, path::Path};

use anyhow::{Context, Result};
use object::{Object, ObjectSection, SectionFlags, SectionKind, elf::SHF_ALLOC, read::File};

/// Bytes of memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Occupied {
    /// Vector table, code, constants, and the initial values of variables.
    pub flash: u64,
    /// Variables, initialised or not; the stack is not among them.
    pub ram: u64,
    /// Those of the variables that have an initial value other than zero: they take flash, too.
    pub data: u64,
}

/// Adds up the sections of the firmware in `elf` that are loaded or reserved. Debugging information and
/// defmt's strings stay on the host.
pub fn occupied(elf: &Path) -> Result<Occupied> {
    let data = fs::read(elf).with_context(|| format!("cannot read {}", elf.display()))?;
    let file = File::parse(data.as_slice())?;
    let mut occupied = Occupied {
        flash: 0,
        ram: 0,
        data: 0,
    };
    for section in file.sections() {
        let SectionFlags::Elf { sh_flags, .. } = section.flags() else {
            continue;
        };
        if !sh_flags.contains(SHF_ALLOC) {
            continue;
        }
        let zeroed = section.kind() == SectionKind::UninitializedData;
        if !zeroed {
            occupied.flash += section.size();
        }
        let initialised = section.kind() == SectionKind::Data;
        if zeroed || initialised {
            occupied.ram += section.size();
        }
        if initialised {
            occupied.data += section.size();
        }
    }
    Ok(occupied)
}
