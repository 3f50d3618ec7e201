//! The check of the page of tuned constants: each is in the code, in the file and with the value that the page says.

use std::{fs, path::Path};

use anyhow::{Result, bail};

use crate::project;

const PAGE: &str = "docs/constants.md";

/// Fails, listing everything found, unless the page agrees with the code.
pub fn check() -> Result<()> {
    let found = find(project::root())?;
    if !found.is_empty() {
        bail!("{}\n{} findings", found.join("\n"), found.len());
    }
    Ok(())
}

fn find(root: &Path) -> Result<Vec<String>> {
    let page = fs::read_to_string(root.join(PAGE))?;
    let mut found = Vec::new();
    for (index, line) in page.lines().enumerate() {
        let mut cells = line.split('|').skip(1).map(str::trim);
        let (Some(names), Some(file), Some(values)) = (cells.next(), cells.next(), cells.next())
        else {
            continue;
        };
        let Some(file) = file.strip_prefix('`').and_then(|f| f.strip_suffix('`')) else {
            continue;
        };
        let at = format!("{PAGE}:{}: {file}", index + 1);
        let Ok(code) = fs::read_to_string(root.join(file)) else {
            found.push(format!("{at} is missing"));
            continue;
        };
        let values: Vec<&str> = values
            .split([';', ' '])
            .filter(|v| number(v).is_some())
            .collect();
        for (place, name) in names.split('`').skip(1).step_by(2).enumerate() {
            let told = values.get(place).and_then(|value| number(value));
            let given = definitions(&code, name);
            if given.is_empty() {
                found.push(format!("{at} has no {name}"));
            }
            // What is no number there is a name for one.
            let is = |text: &&str| number(text).is_none() || number(text) == told;
            if told.is_some() && !given.is_empty() && !given.iter().any(is) {
                found.push(format!("{at}: {name} is {}", given.join(", ")));
            }
        }
    }
    Ok(found)
}

/// What stands behind the name of a constant; or of a field, wherever it is given a value.
fn definitions<'a>(code: &'a str, name: &str) -> Vec<&'a str> {
    let is_constant = name.contains(char::is_uppercase);
    let before = match is_constant {
        true => format!("const {name}:"),
        false => format!("{name}: "),
    };
    let given = code.split(&before).skip(1);
    let values = given.filter_map(|rest| match is_constant {
        true => rest
            .split_once(';')?
            .0
            .split_once('=')
            .map(|(_, value)| value),
        false => rest.split([',', '\n']).next(),
    });
    values.map(str::trim).collect()
}

/// A number as the page or the code writes it: `20,000`, `20_000.0`, `1e-3`, `1/16` or `1.0 / 16.0`.
fn number(text: &str) -> Option<f64> {
    let plain = |text: &str| {
        let text = text.trim().trim_end_matches(',');
        let digits: String = text.chars().filter(|c| !",_".contains(*c)).collect();
        digits
            .parse::<f64>()
            .ok()
            .filter(|number| number.is_finite())
    };
    match text.split_once('/') {
        Some((above, below)) => Some(plain(above)? / plain(below)?),
        None => plain(text),
    }
}

#[cfg(test)]
mod tests {
    use std::{env, process};

    use super::*;

    const CODE: &str = "const FAR_M: f32 = 20_000.0;\nconst A: u8 = 3;\nconst B: f32 = 1.0 / 16.0;\n\
        Self { moves: 2, range_m: FAR_M }\nSelf { moves: 1, }\n";

    fn findings(name: &str, rows: &str) -> Vec<String> {
        let root = env::temp_dir().join(format!("foxhunt-constants-{}-{name}", process::id()));
        fs::create_dir_all(root.join("docs")).unwrap();
        fs::write(root.join("code.rs"), CODE).unwrap();
        fs::write(root.join(PAGE), rows).unwrap();
        let found = find(&root).unwrap();
        fs::remove_dir_all(&root).unwrap();
        found
    }

    #[test]
    fn a_page_that_is_right_has_no_findings() {
        let rows = "| name | file | value |\n|---|---|---|\n\
            | `FAR_M` | `code.rs` | 20,000 m |\n| `A`, `B` | `code.rs` | 3, 1/16 |\n\
            | `moves` | `code.rs` | 2 |\n| `range_m` | `code.rs` | 20,000 |\n";
        assert_eq!(findings("right", rows), [""; 0]);
    }

    #[test]
    fn a_planted_fault_is_found() {
        for (name, row, expected) in [
            (
                "value",
                "| `A` | `code.rs` | 4 |",
                "docs/constants.md:1: code.rs: A is 3",
            ),
            (
                "second",
                "| `A`, `B` | `code.rs` | 3, 1/8 |",
                "docs/constants.md:1: code.rs: B is 1.0 / 16.0",
            ),
            (
                "field",
                "| `moves` | `code.rs` | 3 |",
                "docs/constants.md:1: code.rs: moves is 2, 1",
            ),
            (
                "name",
                "| `C` | `code.rs` | 4 |",
                "docs/constants.md:1: code.rs has no C",
            ),
            (
                "file",
                "| `A` | `gone.rs` | 3 |",
                "docs/constants.md:1: gone.rs is missing",
            ),
        ] {
            assert_eq!(findings(name, row), [expected]);
        }
    }
}
