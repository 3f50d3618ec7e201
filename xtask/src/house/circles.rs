//! Files of a crate that need each other, in two views:
//!
//! * what each `use` names, in the file that defines it;
//! * everything that code names, with the files that hand a name on, but without what a file takes from the modules
//!   around it.
//!
//! Neither counts a `mod`, a `pub use`, or tests.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

use anyhow::Result;
use cargo_metadata::{MetadataCommand, TargetKind};

use super::{modules::Modules, resolve::Need, sources::Sources};

/// From one file to another: the lines that tie them, with the names.
type Ties = BTreeMap<PathBuf, BTreeMap<PathBuf, Vec<(usize, String)>>>;

/// Every circle of files in every crate, with what ties it.
pub fn find(sources: &Sources) -> Result<Vec<String>> {
    let mut found = BTreeSet::new();
    for root in roots(sources)? {
        let modules = Modules::read(sources, &root);
        let by_use = ties(&modules, |by_use, need| by_use && need.defines);
        let by_code = ties(&modules, |_, need| !need.around);
        let reported = circles(&by_use);
        let others = circles(&by_code).into_iter();
        let others = others.filter(|other| !reported.iter().any(|circle| other.is_subset(circle)));
        found.extend(others.map(|circle| describe(&circle, &by_code)));
        found.extend(reported.iter().map(|circle| describe(circle, &by_use)));
    }
    Ok(found.into_iter().collect())
}

/// The root files of all crates but those of tests.
pub fn roots(sources: &Sources) -> Result<BTreeSet<PathBuf>> {
    let (mut roots, mut known) = (BTreeSet::new(), BTreeSet::<PathBuf>::new());
    for manifest in sources
        .texts
        .keys()
        .filter(|path| path.ends_with("Cargo.toml"))
    {
        let manifest = sources.root.join(manifest);
        if known.contains(&manifest) {
            continue;
        }
        let metadata = MetadataCommand::new()
            .manifest_path(&manifest)
            .no_deps()
            .exec()?;
        for package in metadata.packages {
            known.insert(package.manifest_path.into());
            for target in package.targets {
                let skipped = [TargetKind::Test, TargetKind::Bench, TargetKind::CustomBuild];
                let root = target.src_path.strip_prefix(&sources.root);
                if let Some(root) = root.ok().filter(|_| !skipped.contains(&target.kind[0])) {
                    roots.insert(root.into());
                }
            }
        }
    }
    Ok(roots)
}

/// What ties the files of a crate, if `counts` says so of a reference by `use` or not and what it needs.
fn ties(modules: &Modules, counts: impl Fn(bool, &Need) -> bool) -> Ties {
    let mut ties = Ties::new();
    for reference in &modules.references {
        let needs = modules.needs(reference).into_iter();
        for need in needs.filter(|need| counts(reference.import, need)) {
            let from = modules.modules[reference.module].file.clone();
            let tie = (reference.line, reference.path.join("::"));
            let others = ties.entry(from).or_default();
            others.entry(need.file.to_owned()).or_default().push(tie);
        }
    }
    ties
}

/// The largest sets of files of which each needs each other, if through others.
fn circles(ties: &Ties) -> Vec<BTreeSet<&Path>> {
    let reached: BTreeMap<&Path, BTreeSet<&Path>> = ties
        .keys()
        .map(|file| (&**file, reach(file, ties)))
        .collect();
    let mut circles = BTreeSet::new();
    for (file, others) in &reached {
        let back = |other: &&Path| {
            reached
                .get(*other)
                .is_some_and(|others| others.contains(file))
        };
        let circle: BTreeSet<&Path> = others.iter().copied().filter(back).collect();
        if !circle.is_empty() {
            circles.insert(circle);
        }
    }
    circles.into_iter().collect()
}

/// Every file that `file` needs, also through others.
fn reach<'a>(file: &Path, ties: &'a Ties) -> BTreeSet<&'a Path> {
    let (mut reached, mut open) = (BTreeSet::new(), vec![file]);
    while let Some(file) = open.pop() {
        for next in ties.get(file).into_iter().flat_map(BTreeMap::keys) {
            if reached.insert(&**next) {
                open.push(next);
            }
        }
    }
    reached
}

fn describe(circle: &BTreeSet<&Path>, ties: &Ties) -> String {
    let mut text = format!("{} files need each other:", circle.len());
    for file in circle {
        for (other, ties) in ties.get(*file).into_iter().flatten() {
            if circle.contains(&**other) {
                let names: BTreeSet<&str> = ties.iter().map(|(_, name)| &**name).collect();
                let names: Vec<&str> = names.into_iter().collect();
                let line = ties.iter().map(|(line, _)| line).min().unwrap_or(&0);
                text += &format!(
                    "\n    {}:{line} needs {}: {}",
                    file.display(),
                    other.display(),
                    names.join(", ")
                );
            }
        }
    }
    text
}
