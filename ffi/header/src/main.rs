//! Writes the header of the library for C, `include/foxhunt.h` and `include/foxhunt_sizes.h`.
//!
//! `foxhunt-ffi-header FOLDER ARCHIVE_32 ARCHIVE_64` takes the sizes of types from the library as it was built for a machine
//! with pointers of 32 bits and for one with 64, and writes both files to the folder. The README of the library has the whole
//! command.

use std::{
    env,
    fmt::Write,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail, ensure};
use cbindgen::{Builder, Config, DocumentationStyle, EnumConfig, Language, RenameRule, Style};
use object::{
    Object, ObjectSection, ObjectSymbol,
    read::{File, archive::ArchiveFile},
};

/// The variable of the library that holds the sizes, and what an entry of it takes.
const TABLE: &str = "FOXHUNT_TYPES";
const NAME: usize = 40;
const ENTRY: usize = NAME + 12;

fn main() -> Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [folder, narrow, wide] = arguments.as_slice() else {
        bail!("usage: foxhunt-ffi-header FOLDER ARCHIVE_32 ARCHIVE_64");
    };
    let [narrow, wide] = [table(Path::new(narrow))?, table(Path::new(wide))?];
    let names = |types: &[Type]| types.iter().map(|one| one.name.clone()).collect::<Vec<_>>();
    ensure!(
        names(&narrow) == names(&wide),
        "the libraries are of different versions"
    );
    let folder = Path::new(folder);
    fs::create_dir_all(folder)?;
    fs::write(folder.join("foxhunt_sizes.h"), sizes(&narrow, &wide)?)?;
    fs::write(folder.join("foxhunt.h"), header(&narrow)?)?;
    Ok(())
}

/// A type with its size.
struct Type {
    name: String,
    size: u32,
    align: u32,
    is_opaque: bool,
}

impl Type {
    /// `FoxhuntCleanConfig` as `FOXHUNT_CLEAN_CONFIG`.
    fn macro_name(&self) -> String {
        let mut name = String::new();
        for letter in self.name.chars() {
            if letter.is_uppercase() && !name.is_empty() {
                name.push('_');
            }
            name.push(letter.to_ascii_uppercase());
        }
        name
    }
}

/// The types that a library says it has.
fn table(archive: &Path) -> Result<Vec<Type>> {
    let data = fs::read(archive).with_context(|| format!("cannot read {}", archive.display()))?;
    let members = ArchiveFile::parse(data.as_slice())?;
    for member in members.members() {
        let Ok(file) = File::parse(member?.data(data.as_slice())?) else {
            continue;
        };
        let Some(symbol) = file.symbols().find(|symbol| symbol.name() == Ok(TABLE)) else {
            continue;
        };
        if symbol.is_undefined() {
            continue;
        }
        let section = symbol.section_index().context("the table has a section")?;
        let section = file.section_by_index(section)?;
        let start = usize::try_from(symbol.address() - section.address())?;
        let bytes = section
            .data()?
            .get(start..start + usize::try_from(symbol.size())?);
        return Ok(bytes
            .context("the table is whole")?
            .chunks_exact(ENTRY)
            .map(entry)
            .collect());
    }
    bail!("{} has no {TABLE}", archive.display())
}

fn entry(bytes: &[u8]) -> Type {
    let number = |index: usize| {
        let at = NAME + 4 * index;
        u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes"))
    };
    let name = bytes[..NAME].split(|byte| *byte == 0).next();
    Type {
        name: String::from_utf8_lossy(name.unwrap_or_default()).into_owned(),
        size: number(0),
        align: number(1),
        is_opaque: number(2) != 0,
    }
}

const BEGIN: &str = "\
/* The sizes of foxhunt's types. Written by foxhunt-ffi-header, not by hand.
 *
 * The library for each machine checks them again when storage is initialised. */

#ifndef FOXHUNT_SIZES_H
#define FOXHUNT_SIZES_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
#define FOXHUNT_ASSERT(holds, text) static_assert(holds, text)
#define FOXHUNT_ALIGNMENT(type) alignof(type)
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define FOXHUNT_ASSERT(holds, text) _Static_assert(holds, text)
#define FOXHUNT_ALIGNMENT(type) _Alignof(type)
#else
/* C99 has neither. */
#define FOXHUNT_ASSERT(holds, text) extern const char foxhunt_assert[(holds) ? 1 : -1]
#define FOXHUNT_ALIGNMENT(type) offsetof(struct { char first; type second; }, second)
#endif

";

/// The sizes for both kinds of machines, and the types of which C knows nothing else.
fn sizes(narrow: &[Type], wide: &[Type]) -> Result<String> {
    let mut text = BEGIN.to_owned();
    for (condition, types) in [("#if UINTPTR_MAX == 0xFFFFFFFFu", narrow), ("#else", wide)] {
        writeln!(text, "{condition}")?;
        for one in types {
            writeln!(text, "#define {}_SIZE {}u", one.macro_name(), one.size)?;
        }
    }
    text += "#endif\n";
    for one in narrow.iter().filter(|one| one.is_opaque) {
        let (name, size) = (&one.name, one.macro_name());
        ensure!(one.align == 8, "{name} is aligned to {}", one.align);
        write!(
            text,
            "\n/** See the functions that take it. May be copied, but not while it is used. */\n\
             typedef struct {name} {{\n  uint64_t storage[{size}_SIZE / 8u];\n}} {name};\n\
             FOXHUNT_ASSERT(sizeof({name}) == {size}_SIZE, \"{name} has another size\");\n\
             FOXHUNT_ASSERT(FOXHUNT_ALIGNMENT({name}) == 8, \"{name} is aligned otherwise\");\n"
        )?;
    }
    text += "\n#endif\n";
    Ok(text)
}

const HEADER: &str = "\
/* foxhunt for C. Written by foxhunt-ffi-header, not by hand.
 *
 * All memory is the caller's: a type of foxhunt_sizes.h is storage, to be initialised by its `..._init` with its own size.
 * Nothing is allocated, nothing waits, and a program in which the library could panic does not link. A function that does
 * not return FOXHUNT_RESULT_OK has changed nothing.
 *
 * What is refused: null, pointers that are not aligned, storage of another size, storage that was not initialised or is of
 * another type, numbers that are out of range. What is up to the caller: that pointers lead to what they should, that those
 * of one call do not overlap, and that no two calls use the same storage at the same time. */";

/// The header, with the sizes of plain types checked at the end.
fn header(types: &[Type]) -> Result<String> {
    let mut checks = String::new();
    for one in types.iter().filter(|one| !one.is_opaque) {
        let (name, size) = (&one.name, one.macro_name());
        writeln!(
            checks,
            "FOXHUNT_ASSERT(sizeof({name}) == {size}_SIZE, \"{name} has another size\");"
        )?;
    }
    let library = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let config = Config {
        language: Language::C,
        style: Style::Both,
        cpp_compat: true,
        header: Some(HEADER.into()),
        include_guard: Some("FOXHUNT_H".into()),
        sys_includes: vec!["stddef.h".into(), "stdint.h".into()],
        includes: vec!["foxhunt_sizes.h".into()],
        no_includes: true,
        documentation_style: DocumentationStyle::Doxy,
        line_length: 120,
        usize_is_size_t: true,
        trailer: Some(checks),
        enumeration: EnumConfig {
            rename_variants: RenameRule::QualifiedScreamingSnakeCase,
            ..EnumConfig::default()
        },
        ..Config::default()
    };
    let builder = Builder::new().with_config(config);
    let bindings = sources(&library.join("src"))?
        .iter()
        .fold(builder, |builder, file| builder.with_src(file))
        .generate()?;
    let mut text = Vec::new();
    bindings.write(&mut text);
    Ok(String::from_utf8(text)?)
}

/// Files of the library that C knows nothing of.
const OWN: [&str; 4] = ["door.rs", "lib.rs", "table.rs", "types.rs"];

/// The other files, in the order of their names, so that the header is always the same.
fn sources(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if !OWN.iter().any(|own| entry.file_name() == *own) {
            files.push(entry.path());
        }
    }
    files.sort();
    Ok(files)
}
