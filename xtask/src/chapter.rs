//! The check of the chapter about your board: its files make a firmware, which does in the emulator what the host does.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process,
    time::Duration,
};

use anyhow::{Context, Result, ensure};
use foxhunt_host::replay::Replay;

use crate::{
    board::{self, QUERY, ensure_same},
    drive::EXAMPLE,
    measure::{panics, sections},
    project,
    qemu::Machine,
};

const CHAPTER: &str = "docs/src/your-board.md";

/// What the chapter promises: so much flash and RAM are enough, and as little is not zero at first.
const FLASH_BYTES: u64 = 64 * 1024;
const RAM_BYTES: u64 = 20 * 1024;
const DATA_BYTES: u64 = 256;

/// Longer than the drive takes on a busy machine.
const LIMIT: Duration = Duration::from_secs(300);

/// Builds and runs it.
pub fn check() -> Result<()> {
    let text = fs::read_to_string(project::root().join(CHAPTER))?;
    // Outside of the repository, whose configuration of cargo counts in all of its folders.
    let folder = env::temp_dir().join(format!("foxhunt-chapter-{}", process::id()));
    let elf = write(&text, &folder).and_then(|()| build(&folder));
    fs::remove_dir_all(&folder)?;
    let elf = elf?;
    let occupied = sections::occupied(&elf)?;
    ensure!(
        occupied.flash <= FLASH_BYTES && occupied.ram <= RAM_BYTES && occupied.data <= DATA_BYTES,
        "the firmware of the chapter takes more than it says: {occupied:?}"
    );
    ensure!(panics::functions(&elf)? == 0, "it could panic");
    let drive = fs::read(project::root().join(EXAMPLE))?;
    let bytes = [&drive[..], QUERY].concat();
    let mut machine = Machine::boot(&elf, LIMIT)?;
    let said = board::answer(&mut machine, &bytes)?;
    ensure_same(&said, Replay::of(&bytes).output())
}

/// Writes the files of the chapter into a folder.
fn write(text: &str, folder: &Path) -> Result<()> {
    let file = |after: &str| block(text, after).with_context(|| format!("no file after `{after}`"));
    let library = project::root().display();
    let manifest = file("## 1. Cargo.toml")?.replace(
        "git = \"https://github.com/foxhunt-rs/foxhunt\"",
        &format!("path = \"{library}\""),
    );
    ensure!(
        manifest.contains("path = "),
        "the manifest names no library"
    );
    // The chapter's own table says where the emulator has its memories.
    let [flash, ram] = origins(text, "Cortex-M4F").context("no origins of a Cortex-M4F")?;
    let memory = file("## 2. memory.x")?;
    let memory = memory.replace("0x08000000", flash);
    let memory = memory.replace("0x20000000", ram);
    let main = file("## 4. src/main.rs")? + &file("## 6. Prove")?;
    let files = [
        ("Cargo.toml", manifest + "\n[workspace]\n"),
        ("memory.x", memory),
        (".cargo/config.toml", file("## 3. .cargo/config.toml")?),
        ("src/main.rs", main),
        ("src/board.rs", file("What is yours is")?),
    ];
    for (name, content) in files {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap_or(folder))?;
        fs::write(path, content)?;
    }
    Ok(())
}

fn build(folder: &Path) -> Result<PathBuf> {
    let mut cargo = project::cargo();
    cargo.current_dir(folder);
    cargo.env(
        "CARGO_TARGET_DIR",
        project::target_directory()?.join("chapter"),
    );
    project::executable_by(cargo, &["--release", "--bin", "hunter"])
        .context("the chapter does not build")
}

/// The first block of code after some words.
fn block(text: &str, after: &str) -> Option<String> {
    let (_, rest) = text.split_once(after)?;
    let (_, rest) = rest.split_once("\n```")?;
    let (_, rest) = rest.split_once('\n')?;
    let (block, _) = rest.split_once("```")?;
    Some(block.to_owned())
}

/// Those of the flash and of the RAM, in the row of a core that has four columns.
fn origins<'a>(text: &'a str, core: &str) -> Option<[&'a str; 2]> {
    let rows = text.lines().map(|line| line.split('|').map(str::trim));
    let mut rows = rows.map(|row| row.collect::<Vec<_>>());
    rows.find_map(|row| match row.as_slice() {
        ["", name, machine, flash, ram, ""] if *name == core && machine.contains("mps2") => {
            Some([flash.trim_matches('`'), ram.trim_matches('`')])
        }
        _ => None,
    })
}
