//! Where a firmware could panic, by the crate whose line it is.
//!
//! Firmware of a real board has drivers that check what they are given, so it links only with a handler. But each call that
//! begins a panic names the line of its caller, and what is not called is not linked: those lines that the firmware holds are
//! those that could panic.

use std::{collections::BTreeSet, fs, path::Path};

use anyhow::{Context, Result};
use object::{Object, ObjectSection, SectionKind, read::File};

use crate::project;

/// A line that could panic.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Site {
    /// The crate, or the folder of this project, whose line it is.
    pub owner: String,
    /// The file and the line.
    pub line: String,
    /// Whether it begins asynchronous code: the compiler lets that panic if somebody polls it after its end, which no executor
    /// does.
    pub is_awaited: bool,
}

impl Site {
    /// Whether it is a line of this project.
    pub fn is_own(&self) -> bool {
        self.owner == LIBRARY || self.owner.contains('/')
    }
}

const LIBRARY: &str = "foxhunt";

/// All of the firmware in `elf`, whose package is in `folder`.
pub fn find(elf: &Path, folder: &Path) -> Result<BTreeSet<Site>> {
    let data = fs::read(elf).with_context(|| format!("cannot read {}", elf.display()))?;
    let file = File::parse(data.as_slice())?;
    let sections = file.sections().filter(|section| {
        matches!(
            section.kind(),
            SectionKind::Text
                | SectionKind::ReadOnlyData
                | SectionKind::ReadOnlyString
                | SectionKind::Data
        )
    });
    let sections = sections.map(|section| Ok((section.address(), section.data()?)));
    let sections: Vec<(u64, &[u8])> = sections.collect::<Result<_>>()?;
    let text = |address: u32, length: u32| {
        sections.iter().find_map(|(begin, bytes)| {
            let start = usize::try_from(u64::from(address).checked_sub(*begin)?).ok()?;
            let bytes = bytes.get(start..)?.get(..length as usize)?;
            str::from_utf8(bytes)
                .ok()
                .filter(|text| text.ends_with(".rs"))
        })
    };
    let locations = sections.iter().flat_map(|(_, bytes)| {
        bytes.windows(16).step_by(4).filter_map(|words| {
            let word = |number: usize| {
                words[4 * number..]
                    .first_chunk()
                    .copied()
                    .map(u32::from_le_bytes)
            };
            let file = text(word(0)?, word(1)?)?;
            Some((file, word(2)?, word(3)?))
        })
    });
    Ok(locations
        .filter_map(|(file, line, column)| site(file, line, column, folder))
        .collect())
}

/// That of a line; none for one of the core library.
fn site(file: &str, line: u32, column: u32, folder: &Path) -> Option<Site> {
    if file.starts_with("/rustc/") {
        return None;
    }
    let path = folder.join(file);
    let (owner, file) = owner(&path);
    Some(Site {
        owner,
        line: format!("{file}:{line}"),
        is_awaited: begins_future(&path, line, column),
    })
}

/// The crate of a source, and the source in it.
fn owner(file: &Path) -> (String, String) {
    let name = file.to_string_lossy();
    if let Some((_, rest)) = name.split_once("/registry/src/") {
        let mut parts = rest.splitn(3, '/').skip(1);
        let package = parts.next().unwrap_or_default();
        let owner = package.rsplit_once('-').map_or(package, |(name, _)| name);
        return (owner.into(), parts.next().unwrap_or_default().into());
    }
    let file = file.strip_prefix(project::root()).unwrap_or(file);
    let source = file.to_string_lossy();
    let owner = match source.split_once("src/") {
        Some(("", _)) => LIBRARY,
        Some((folder, _)) => folder,
        None => "/",
    };
    (owner.to_owned(), source.into_owned())
}

/// Whether a body stands there, as only that of asynchronous code does: other panics name an expression, a call or a macro.
fn begins_future(file: &Path, line: u32, column: u32) -> bool {
    let text = fs::read_to_string(file).unwrap_or_default();
    let line = text.lines().nth((line as usize).saturating_sub(1));
    let rest = line.and_then(|line| line.get((column as usize).saturating_sub(1)..));
    rest.is_some_and(|rest| rest.starts_with('{') || rest.starts_with("async "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_of_crates() {
        let of = |file: &str| site(file, 1, 1, project::root()).map(|site| site.owner);
        assert_eq!(of("/rustc/0123/library/core/src/option.rs"), None);
        let registry = "/home/me/.cargo/registry/src/index-01/embassy-nrf-0.11.0/src/wdt.rs";
        assert_eq!(of(registry).as_deref(), Some("embassy-nrf"));
        assert_eq!(of("src/weights.rs").as_deref(), Some(LIBRARY));
        let own = of("boards/pico2/src/usb.rs");
        assert_eq!(own.as_deref(), Some("boards/pico2/"));
    }

    #[test]
    fn bodies_begin_futures_and_calls_do_not() {
        let file = project::root().join("boards/shared/src/lines.rs");
        let text = fs::read_to_string(&file).unwrap();
        let at = |word: &str, end: &str| {
            let (line, text) = text
                .lines()
                .enumerate()
                .find(|(_, line)| line.contains(word))
                .unwrap();
            (line as u32 + 1, text.find(end).unwrap() as u32 + 1)
        };
        let (line, column) = at("pub async fn wait", "{");
        assert!(begins_future(&file, line, column));
        let (line, column) = at("select_array(", "select_array");
        assert!(!begins_future(&file, line, column));
    }
}
