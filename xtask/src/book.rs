//! The check of the guide: its chapters, and the links of all pages.

use std::{
    collections::BTreeSet,
    fs,
    path::{Component, Path, PathBuf},
};

use anyhow::{Context, Result, bail};

use crate::project;

/// Fails, listing everything found, unless the guide has its chapters and every link of every page leads somewhere.
pub fn check() -> Result<()> {
    let found = find(project::root())?;
    if !found.is_empty() {
        bail!("{}\n{} findings", found.join("\n"), found.len());
    }
    Ok(())
}

/// Folders with pages that are not of the project.
const SKIPPED: [&str; 3] = ["target", "node_modules", "corpus"];
/// The pages of the guide, and the file that tests their examples.
const GUIDE: &str = "docs/src";
const EXAMPLES: &str = "src/guide.rs";
/// Where files of the repository are on the web, for links out of the guide.
const ON_THE_WEB: [&str; 2] = [
    "https://github.com/foxhunt-rs/foxhunt/blob/main/",
    "https://github.com/foxhunt-rs/foxhunt/tree/main/",
];

fn find(root: &Path) -> Result<Vec<String>> {
    let mut pages = Vec::new();
    collect(root, &mut pages)?;
    pages.sort();
    let mut found = chapters(root, &pages)?;
    for page in &pages {
        found.extend(broken_links(root, page)?);
    }
    Ok(found)
}

/// All Markdown files below a folder.
fn collect(folder: &Path, pages: &mut Vec<PathBuf>) -> Result<()> {
    for entry in fs::read_dir(folder).with_context(|| format!("{}", folder.display()))? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if path.is_dir() {
            if !name.starts_with('.') && !SKIPPED.contains(&&*name) {
                collect(&path, pages)?;
            }
        } else if name.ends_with(".md") {
            pages.push(path);
        }
    }
    Ok(())
}

/// Chapters that are missing, in the table of contents or on the disk, and those whose examples nobody tests.
fn chapters(root: &Path, pages: &[PathBuf]) -> Result<Vec<String>> {
    let guide = root.join(GUIDE);
    let summary = fs::read_to_string(guide.join("SUMMARY.md"))?;
    let examples = fs::read_to_string(root.join(EXAMPLES))?;
    let listed: BTreeSet<PathBuf> = links(&summary).map(|(_, link)| guide.join(link)).collect();
    let mut found = Vec::new();
    for page in &listed {
        if !page.is_file() {
            found.push(format!("{}: in SUMMARY.md, but missing", shown(root, page)));
        }
    }
    let in_guide = pages.iter().filter(|page| page.starts_with(&guide));
    for page in in_guide.filter(|page| !page.ends_with("SUMMARY.md")) {
        let name = shown(root, page);
        if !listed.contains(page) {
            found.push(format!("{name}: not in SUMMARY.md"));
        }
        let has_examples = fs::read_to_string(page)?.contains("```rust");
        if has_examples && !examples.contains(&name) {
            found.push(format!("{name}: its examples are not in {EXAMPLES}"));
        }
    }
    Ok(found)
}

/// Links of a page to files or headings that are not there.
fn broken_links(root: &Path, page: &Path) -> Result<Vec<String>> {
    let text = fs::read_to_string(page)?;
    let folder = page.parent().unwrap_or(root);
    let mut found = Vec::new();
    for (line, link) in links(&text) {
        let on_the_web = ON_THE_WEB.iter().find_map(|url| link.strip_prefix(url));
        let (base, link) = match on_the_web {
            Some(path) => (root, path),
            None if link.contains("://") || link.starts_with("mailto:") => continue,
            None => (folder, link),
        };
        let (path, heading) = link.split_once('#').unwrap_or((link, ""));
        let target = match path {
            "" => page.to_owned(),
            path => plain(&base.join(path)),
        };
        let guide = root.join(GUIDE);
        let leaves = page.starts_with(&guide) && !target.starts_with(&guide);
        let what = if !target.exists() {
            "leads nowhere"
        } else if on_the_web.is_none() && leaves {
            "leaves the guide: link to the repository on the web"
        } else if !heading.is_empty() && !has_heading(&target, heading)? {
            "leads to a heading that is not there"
        } else {
            continue;
        };
        found.push(format!("{}:{line}: `{link}` {what}", shown(root, page)));
    }
    Ok(found)
}

/// The targets of all links outside of code, with the numbers of their lines.
fn links(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut is_code = false;
    let prose = text.lines().enumerate().filter(move |(_, line)| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_fence && !is_code
    });
    prose.flat_map(|(index, line)| {
        // Between backticks is code: every second part.
        let parts = line.split('`').step_by(2);
        let targets = parts.flat_map(|part| part.split("](").skip(1));
        targets
            .filter_map(|rest| rest.split_once(')'))
            .map(move |(target, _)| (index + 1, target))
    })
}

/// Whether a page has a heading of which the web makes this anchor.
fn has_heading(page: &Path, anchor: &str) -> Result<bool> {
    let text = fs::read_to_string(page)?;
    let mut headings = text.lines().filter(|line| line.starts_with('#'));
    Ok(headings.any(|heading| slug(heading.trim_start_matches('#').trim()) == anchor))
}

fn slug(heading: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    let lower = heading.to_lowercase();
    lower
        .chars()
        .filter(kept)
        .collect::<String>()
        .replace(' ', "-")
}

/// A path without `.` and `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for component in path.components() {
        match component {
            Component::ParentDir => {
                plain.pop();
            }
            Component::CurDir => {}
            other => plain.push(other),
        }
    }
    plain
}

fn shown(root: &Path, page: &Path) -> String {
    page.strip_prefix(root)
        .unwrap_or(page)
        .display()
        .to_string()
}

#[cfg(test)]
mod tests {
    use std::{env, process};

    use super::*;

    /// A repository with a guide, where `change` may break something.
    fn findings(name: &str, change: impl Fn(&Path)) -> Vec<String> {
        let root = env::temp_dir().join(format!("foxhunt-book-{}-{name}", process::id()));
        fs::create_dir_all(root.join(GUIDE)).unwrap();
        fs::create_dir_all(root.join("src")).unwrap();
        let write = |file: &str, text: &str| fs::write(root.join(file), text).unwrap();
        write("README.md", "[guide](docs/src/one.md) `[no](link)`\n");
        write("docs/src/SUMMARY.md", "- [One](one.md)\n- [Two](two.md)\n");
        write("docs/src/one.md", "# One\n\n[on](two.md#the-second-one)\n");
        write(
            "docs/src/two.md",
            "## The *second* one\n\n```rust\nlet x = y[0](0);\n```\n",
        );
        write(EXAMPLES, "\"../docs/src/two.md\"");
        change(&root);
        let found = find(&root).unwrap();
        fs::remove_dir_all(&root).unwrap();
        found
    }

    #[test]
    fn a_guide_in_order_has_no_findings() {
        assert_eq!(findings("order", |_| {}), [""; 0]);
    }

    #[test]
    fn a_planted_fault_is_found() {
        let page = |root: &Path, text: &str| fs::write(root.join("docs/src/one.md"), text).unwrap();
        type Case<'a> = (&'a str, &'a dyn Fn(&Path), &'a str);
        let cases: [Case<'_>; 6] = [
            (
                "missing",
                &|root| fs::remove_file(root.join("docs/src/one.md")).unwrap(),
                "docs/src/one.md: in SUMMARY.md, but missing",
            ),
            (
                "unlisted",
                &|root| fs::write(root.join("docs/src/three.md"), "").unwrap(),
                "docs/src/three.md: not in SUMMARY.md",
            ),
            (
                "untested",
                &|root| fs::write(root.join(EXAMPLES), "").unwrap(),
                "docs/src/two.md: its examples are not in src/guide.rs",
            ),
            (
                "nowhere",
                &|root| page(root, "\n[a](four.md)"),
                "docs/src/one.md:2: `four.md` leads nowhere",
            ),
            (
                "heading",
                &|root| page(root, "[a](two.md#third)"),
                "docs/src/one.md:1: `two.md#third` leads to a heading that is not there",
            ),
            (
                "outside",
                &|root| page(root, "[a](../../README.md)"),
                "docs/src/one.md:1: `../../README.md` leaves the guide: link to the repository on the web",
            ),
        ];
        for (name, plant, expected) in cases {
            let found = findings(name, plant);
            assert!(found.contains(&expected.to_owned()), "{name}: {found:?}");
        }
    }
}
