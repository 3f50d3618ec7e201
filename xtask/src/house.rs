//! The task `house`: how the code of the repository is laid out, and the words that it uses.

mod circles;
mod count;
mod docs;
mod lengths;
mod modules;
mod resolve;
mod sources;
#[cfg(test)]
mod tests;
mod words;

use std::path::Path;

use anyhow::{Result, bail};

use self::sources::Sources;
use crate::project;

/// Fails, listing everything found, unless files need each other one way, are short, keep to the glossary, and doc
/// comments end where their items begin.
pub fn check() -> Result<()> {
    let found = find(project::root())?;
    if !found.is_empty() {
        bail!("{}\n{} findings", found.join("\n"), found.len());
    }
    Ok(())
}

/// Prints how large the library is.
pub fn print_count() -> Result<()> {
    let count = count::count(&Sources::read(project::root())?, Path::new("src/lib.rs"))?;
    println!("{:6} files in `src`, without tests", count.files);
    println!(
        "{:6} lines of code in them, without comments, blank lines and tests",
        count.lines
    );
    println!("{:6} public types", count.types);
    Ok(())
}

fn find(root: &Path) -> Result<Vec<String>> {
    let sources = Sources::read(root)?;
    let mut found = circles::find(&sources)?;
    found.extend(lengths::find(&sources));
    found.extend(docs::find(&sources));
    found.extend(words::find(&sources));
    Ok(found)
}
