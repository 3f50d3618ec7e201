//! Tables as the tasks print them.

use comfy_table::{CellAlignment, Table, presets::ASCII_MARKDOWN};

/// An empty table of these columns: the first `words` of them hold words, the others numbers.
pub fn table<S: AsRef<str>>(header: impl IntoIterator<Item = S>, words: usize) -> Table {
    let mut table = Table::new();
    let header = header.into_iter().map(|name| name.as_ref().to_owned());
    table
        .load_style(ASCII_MARKDOWN)
        .set_header(header.collect::<Vec<String>>());
    for column in table.column_iter_mut().skip(words) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}
