//! How much of the library its tests run.

use std::path::Path;

use anyhow::{Context, Result, ensure};
use foxhunt_host::figures::Figure;
use serde::Deserialize;

use crate::{
    figures,
    project::{self, cargo},
    setup::Need,
};

/// What cargo-llvm-cov writes.
#[derive(Deserialize)]
struct Report {
    data: [Export; 1],
}

#[derive(Deserialize)]
struct Export {
    files: Vec<File>,
}

#[derive(Deserialize)]
struct File {
    filename: String,
    summary: Summary,
}

#[derive(Deserialize)]
struct Summary {
    functions: Part,
    lines: Part,
    regions: Part,
}

#[derive(Deserialize)]
struct Part {
    count: u64,
    covered: u64,
}

/// Runs the library's tests and prints how much of its sources they have run. Tests beside the code count as code.
pub fn print() -> Result<()> {
    super::need(&[Need::LlvmTools, Need::CargoLlvmCov])?;
    let mut tests = cargo();
    tests.args(["llvm-cov", "--package", "foxhunt", "--lib", "--tests"]);
    tests.args(["--features", "gateway,serde", "--json", "--summary-only"]);
    let output = tests.output().context("cannot run cargo llvm-cov")?;
    let log = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{log}");
    let report: Report = serde_json::from_slice(&output.stdout)?;
    figures::print(&summary(&report, &project::root().join("src"))?);
    Ok(())
}

/// The parts of the files below a folder that were run.
fn summary(report: &Report, folder: &Path) -> Result<Vec<Figure>> {
    let [export] = &report.data;
    let files = export.files.iter();
    let files = files.filter(|file| Path::new(&file.filename).starts_with(folder));
    let files: Vec<&Summary> = files.map(|file| &file.summary).collect();
    let figure = |name, part: fn(&Summary) -> &Part| {
        let parts = files.iter().map(|summary| part(summary));
        let (covered, count) = parts.fold((0, 0), |(covered, count), part| {
            (covered + part.covered, count + part.count)
        });
        ensure!(count > 0, "nothing of the library was run");
        let percent = 100.0 * covered as f64 / count as f64;
        Ok(Figure::new(format!("coverage.{name}"), percent, "%"))
    };
    Ok(vec![
        figure("lines", |summary| &summary.lines)?,
        figure("regions", |summary| &summary.regions)?,
        figure("functions", |summary| &summary.functions)?,
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_the_library_count() {
        let part = |covered: u64| format!(r#"{{"count": 8, "covered": {covered}, "percent": 0}}"#);
        let file = |name: &str, covered| {
            let part = part(covered);
            format!(
                r#"{{"filename": "{name}", "summary": {{"lines": {part}, "functions": {part}, "regions": {part}}}}}"#
            )
        };
        let json = format!(
            r#"{{"data": [{{"files": [{}, {}, {}]}}]}}"#,
            file("/a/src/one.rs", 8),
            file("/a/src/b/two.rs", 4),
            file("/a/host/src/three.rs", 0)
        );
        let report: Report = serde_json::from_str(&json).unwrap();
        let figures = summary(&report, Path::new("/a/src")).unwrap();
        assert!(figures.iter().all(|figure| figure.value == 75.0));
        assert!(summary(&report, Path::new("/b")).is_err());
    }
}
