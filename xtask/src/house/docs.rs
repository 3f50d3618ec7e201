//! Doc comments that go on at the next item: rustdoc shows each alone.

use super::sources::Sources;

/// Every doc comment above an item that ends in a comma.
pub fn find(sources: &Sources) -> Vec<String> {
    let mut found = Vec::new();
    for path in sources.syntax.keys() {
        let mut lines = sources.texts[path]
            .lines()
            .map(str::trim)
            .zip(1..)
            .peekable();
        while let Some((line, number)) = lines.next() {
            let goes_on = lines.peek().is_some_and(|(next, _)| is_doc(next));
            if is_doc(line) && line.ends_with(',') && !goes_on {
                found.push(format!(
                    "{}:{number}: the doc comment ends in a comma",
                    path.display()
                ));
            }
        }
    }
    found
}

fn is_doc(line: &str) -> bool {
    line.starts_with("///")
}
