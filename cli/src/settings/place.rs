//! Where something stands in a settings file.

use toml::{
    Spanned,
    de::{DeTable, DeValue},
};

/// The byte at which a field begins, by the names of the tables that lead to it and its own, or numbers in arrays, with points
/// between them; of the innermost table that is there, if the field is not.
pub fn find(text: &str, path: &str) -> Option<usize> {
    let file = DeTable::parse(text).ok()?;
    let mut table = file.get_ref();
    let mut start = None;
    let mut names = path.split('.');
    while let Some(name) = names.next() {
        let Some((key, value)) = table.get_key_value(name) else {
            break;
        };
        start = Some(key.span().start);
        let mut value: &Spanned<DeValue<'_>> = value;
        if let DeValue::Array(array) = value.get_ref() {
            let number: usize = names.next()?.parse().ok()?;
            value = array.get(number)?;
            start = Some(value.span().start);
        }
        match value.get_ref() {
            DeValue::Table(inner) => table = inner,
            _ => break,
        }
    }
    start
}

/// The line and column of a byte, from 1 on.
pub fn line_and_column(text: &str, start: usize) -> (usize, usize) {
    let before = text.get(..start).unwrap_or(text);
    let line = 1 + before.matches('\n').count();
    let column = 1 + before.rsplit('\n').next().unwrap_or("").chars().count();
    (line, column)
}
