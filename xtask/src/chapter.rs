//! The check of the chapter about your board: its files make firmwares, which do in the emulator what the host does.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::{self, Command},
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

/// Builds and runs all of them.
pub fn check() -> Result<()> {
    let text = fs::read_to_string(project::root().join(CHAPTER))?;
    // Outside of the repository, whose configuration of cargo counts in all of its folders.
    let folder = env::temp_dir().join(format!("foxhunt-chapter-{}", process::id()));
    let chapter = Chapter { text, folder };
    let checks = [polls, example, interrupts];
    let checked = checks.into_iter().try_for_each(|check| check(&chapter));
    fs::remove_dir_all(&chapter.folder)?;
    checked
}

/// The firmware that asks its UARTs, at both levels of optimisation that the chapter says it links at.
fn polls(chapter: &Chapter) -> Result<()> {
    let drive = fs::read(project::root().join(EXAMPLE))?;
    let bytes = [&drive[..], QUERY].concat();
    // The chapter's own table says where the emulator has its memories.
    let [flash, ram] =
        origins(&chapter.text, "Cortex-M4F").context("no origins of a Cortex-M4F")?;
    let memory = chapter.block("## 2. memory.x")?;
    let memory = memory.replace("0x08000000", flash);
    let memory = memory.replace("0x20000000", ram);
    let main = chapter.block("## 4. src/main.rs")? + &chapter.block("## 5. Prove")?;
    chapter.write(&[
        ("Cargo.toml", chapter.manifest("")?),
        ("memory.x", memory),
        (
            ".cargo/config.toml",
            chapter.block("## 3. .cargo/config.toml")?,
        ),
        ("src/main.rs", main),
        ("src/board.rs", chapter.block("What is yours is")?),
    ])?;
    for level in ["3", "z"] {
        let elf = chapter.build(level)?;
        let occupied = sections::occupied(&elf)?;
        ensure!(
            occupied.flash <= FLASH_BYTES
                && occupied.ram <= RAM_BYTES
                && occupied.data <= DATA_BYTES,
            "the firmware of the chapter takes more than it says: {occupied:?}"
        );
        ensure!(panics::functions(&elf)? == 0, "it could panic");
        let mut machine = Machine::boot(&elf, LIMIT)?;
        let said = board::answer(&mut machine, &bytes)?;
        ensure_same(&said, Replay::of(&bytes).output())?;
    }
    Ok(())
}

/// The example for a checkout of the repository: it is looked at as one of this computer, with the lints of the library.
fn example(chapter: &Chapter) -> Result<()> {
    let main = chapter.block("## 4. src/main.rs")?;
    let declared = main
        .split_once("use foxhunt::")
        .and_then(|(_, rest)| rest.split_once("#[entry]"));
    let (declared, _) = declared.context("the firmware declares no gateway")?;
    let declared = format!("use foxhunt::{declared}").replace(", 2>;", ", 3>;");
    let example = chapter.block("In `examples/mine.rs`")?;
    let as_above = "// CONFIG and Gateway as above, but with three ports.";
    ensure!(example.contains(as_above), "the example declares a gateway");
    let emulated = project::root().join("boards/emulated");
    let manifest = chapter.manifest(&format!(
        "foxhunt-emulated = {{ path = \"{}\" }}\n",
        emulated.display()
    ))?;
    chapter.write(&[
        (
            "Cargo.toml",
            manifest + "[lints.rust]\nmissing_docs = \"deny\"\n",
        ),
        ("src/main.rs", example.replace(as_above, &declared)),
    ])?;
    fs::remove_dir_all(chapter.folder.join(".cargo"))?;
    project::run(chapter.cargo()?.args(["check", "--quiet"])).context("the example does not build")
}

/// The firmware with interrupts.
fn interrupts(chapter: &Chapter) -> Result<()> {
    let boards = chapter.block("## 8. With interrupts")?;
    let boards = boards.replace(ON_THE_WEB, &at(&project::root().join("boards/shared")));
    let main = chapter.block("This `src/main.rs`")? + &chapter.block("## 5. Prove")?;
    chapter.write(&[
        ("Cargo.toml", chapter.manifest(&boards)?),
        ("memory.x", chapter.block("## 2. memory.x")?),
        (
            ".cargo/config.toml",
            chapter.block("## 3. .cargo/config.toml")?,
        ),
        ("src/main.rs", main),
    ])?;
    let elf = chapter.build("3")?;
    ensure!(panics::functions(&elf)? == 0, "it could panic");
    let drive = fs::read(project::root().join(EXAMPLE))?;
    let mut machine = board::stm32f405(&elf, &["stdio"], LIMIT)?;
    let said = board::paced(&mut machine, &drive)?;
    ensure_same(&said, Replay::of(&drive).output()).context("the firmware with interrupts")
}

/// How a manifest of the chapter names a package of this repository.
const ON_THE_WEB: &str = "git = \"https://github.com/foxhunt-rs/foxhunt\"";

/// The same, as it is here.
fn at(folder: &Path) -> String {
    format!("path = \"{}\"", folder.display())
}

/// The text of the chapter, and where its files are written.
struct Chapter {
    text: String,
    folder: PathBuf,
}

impl Chapter {
    /// The first block of code after some words.
    fn block(&self, after: &str) -> Result<String> {
        block(&self.text, after).with_context(|| format!("no file after `{after}`"))
    }

    /// The manifest with more dependencies, and with the library as it is here.
    fn manifest(&self, dependencies: &str) -> Result<String> {
        const DEPENDENCIES: &str = "[dependencies]\n";
        let manifest = self.block("## 1. Cargo.toml")?;
        ensure!(manifest.contains(ON_THE_WEB) && manifest.contains(DEPENDENCIES));
        let manifest = manifest.replace(ON_THE_WEB, &at(project::root()));
        let manifest = manifest.replace(DEPENDENCIES, &format!("{DEPENDENCIES}{dependencies}"));
        Ok(manifest + "\n[workspace]\n")
    }

    /// Writes files into the folder.
    fn write(&self, files: &[(&str, String)]) -> Result<()> {
        for (name, content) in files {
            let path = self.folder.join(name);
            fs::create_dir_all(path.parent().unwrap_or(&self.folder))?;
            fs::write(path, content)?;
        }
        Ok(())
    }

    fn cargo(&self) -> Result<Command> {
        let mut cargo = project::cargo();
        cargo.current_dir(&self.folder);
        let built = project::target_directory()?.join("chapter");
        cargo.env("CARGO_TARGET_DIR", built);
        Ok(cargo)
    }

    /// Builds the firmware at a level of optimisation.
    fn build(&self, level: &str) -> Result<PathBuf> {
        let mut cargo = self.cargo()?;
        cargo.env("CARGO_PROFILE_RELEASE_OPT_LEVEL", level);
        project::executable_by(cargo, &["--release", "--bin", "hunter"])
            .with_context(|| format!("the chapter does not build at the level {level}"))
    }
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
