//! Tables of the documentation that a task prints, between two marks of their page.

use std::{fs, path::Path};

use anyhow::{Context, Result, ensure};

use crate::project;

/// The README's table of boards.
pub const BOARDS: Table = Table {
    name: "boards",
    page: "README.md",
    task: "boards",
};

/// Where a table stands, and what writes it.
pub struct Table {
    name: &'static str,
    page: &'static str,
    task: &'static str,
}

impl Table {
    /// Fails unless the page has this table, or writes it there.
    pub fn keep(&self, table: &str, bless: bool) -> Result<()> {
        let Self { name, page, task } = self;
        let file = project::root().join(page);
        if bless {
            return write(&file, name, table);
        }
        let old = read(&file)?;
        ensure!(
            old == inserted(&old, name, table, &file)?,
            "{page} has another table: `cargo xtask {task} --bless` writes it"
        );
        Ok(())
    }
}

/// Writes a table into a page, between the marks of this name.
pub fn write(file: &Path, name: &str, table: &str) -> Result<()> {
    let page = inserted(&read(file)?, name, table, file)?;
    fs::write(file, page).with_context(|| format!("cannot write {}", file.display()))
}

fn read(file: &Path) -> Result<String> {
    fs::read_to_string(file).with_context(|| format!("cannot read {}", file.display()))
}

fn inserted(page: &str, name: &str, table: &str, file: &Path) -> Result<String> {
    let page = insert(page, name, table);
    page.with_context(|| format!("{} has no marks for the table `{name}`", file.display()))
}

fn insert(page: &str, name: &str, table: &str) -> Option<String> {
    let (begin, end) = (format!("<!-- {name} -->\n"), format!("<!-- /{name} -->"));
    let (before, rest) = page.split_once(&begin)?;
    let (_, after) = rest.split_once(&end)?;
    let table = table.trim_end();
    Some(format!("{before}{begin}{table}\n{end}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_takes_the_place_of_the_last_one() {
        let page = |table: &str| format!("a\n<!-- x -->\n{table}\n<!-- /x -->\nb\n");
        assert_eq!(insert(&page("old"), "x", "new\n"), Some(page("new")));
        assert_eq!(insert(&page("old"), "y", "new"), None);
    }
}
