//! The LLVM tools that belong to the compiler (rustup's component `llvm-tools`).

use std::{
    env::consts::EXE_SUFFIX,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context, Result, ensure};

use crate::project;

/// Where the tool `name` is, or would be if the component were installed.
pub fn tool(name: &str) -> Result<PathBuf> {
    let host = project::rustc(&["--print", "host-tuple"])?;
    let tools = project::sysroot()?
        .join("lib/rustlib")
        .join(host)
        .join("bin");
    Ok(tools.join(format!("{name}{EXE_SUFFIX}")))
}

/// The disassembly of the firmware in `elf`, as `llvm-objdump` prints it.
pub fn disassembly(elf: &Path) -> Result<String> {
    let output = Command::new(tool("llvm-objdump")?)
        .args(["--disassemble", "--mcpu=cortex-m4"])
        .arg(elf)
        .output()
        .context("cannot run llvm-objdump")?;
    ensure!(
        output.status.success(),
        "llvm-objdump failed on {}",
        elf.display()
    );
    Ok(String::from_utf8(output.stdout)?)
}
