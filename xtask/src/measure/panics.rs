//! Whether a firmware can panic.

use std::{fs, path::Path};

use anyhow::{Context, Result};
use object::{Object, ObjectSymbol, SymbolKind, read::File};
use rustc_demangle::demangle;

/// How many of the functions that begin a panic the firmware in `elf` holds: none if nothing in it can.
pub fn functions(elf: &Path) -> Result<usize> {
    let data = fs::read(elf).with_context(|| format!("cannot read {}", elf.display()))?;
    let file = File::parse(data.as_slice())?;
    let functions = file
        .symbols()
        .filter(|symbol| symbol.kind() == SymbolKind::Text);
    let names = functions.filter_map(|function| function.name().ok());
    Ok(names.filter(|name| begins_panic(name)).count())
}

fn begins_panic(symbol: &str) -> bool {
    format!("{:#}", demangle(symbol)).starts_with("core::panicking::")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_of_the_core_library_begin_a_panic() {
        assert!(begins_panic(
            "_ZN4core9panicking18panic_bounds_check17h0123456789abcdefE"
        ));
        assert!(!begins_panic("_ZN7foxhunt3aoa4push17h0123456789abcdefE"));
    }
}
