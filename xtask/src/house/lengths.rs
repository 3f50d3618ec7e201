//! Functions and files that are too long, and modules that lie elsewhere.

use std::path::Path;

use syn::{
    Block, ImplItemFn, ItemFn, ItemMod, Signature, TraitItemFn,
    spanned::Spanned,
    visit::{self, Visit},
};

use super::sources::Sources;

/// Most lines of a file.
const FILE: usize = 500;
/// Most lines of a function of the library.
const LIBRARY_FUNCTION: usize = 60;
/// Most lines of another function.
const FUNCTION: usize = 80;

/// Every file and every function with too many lines.
pub fn find(sources: &Sources) -> Vec<String> {
    let mut found = Vec::new();
    for (path, file) in &sources.syntax {
        let lines = sources.texts[path].lines().count();
        if lines > FILE {
            found.push(format!("{}: {lines} lines, at most {FILE}", path.display()));
        }
        let limit = if path.starts_with("src") {
            LIBRARY_FUNCTION
        } else {
            FUNCTION
        };
        let mut reader = Reader {
            path,
            limit,
            found: &mut found,
        };
        reader.visit_file(file);
    }
    found
}

struct Reader<'a> {
    path: &'a Path,
    limit: usize,
    found: &'a mut Vec<String>,
}

impl Reader<'_> {
    /// A function's lines are those from its `fn` to its closing brace.
    fn function(&mut self, signature: &Signature, body: &Block) {
        let first = signature.span().start().line;
        let lines = body.span().end().line + 1 - first;
        if lines > self.limit {
            self.found.push(format!(
                "{}:{first}: `{}` has {lines} lines, at most {}",
                self.path.display(),
                signature.ident,
                self.limit
            ));
        }
    }
}

impl<'ast> Visit<'ast> for Reader<'_> {
    fn visit_item_fn(&mut self, item: &'ast ItemFn) {
        self.function(&item.sig, &item.block);
        visit::visit_item_fn(self, item);
    }

    fn visit_impl_item_fn(&mut self, item: &'ast ImplItemFn) {
        self.function(&item.sig, &item.block);
        visit::visit_impl_item_fn(self, item);
    }

    fn visit_trait_item_fn(&mut self, item: &'ast TraitItemFn) {
        if let Some(body) = &item.default {
            self.function(&item.sig, body);
        }
        visit::visit_trait_item_fn(self, item);
    }

    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        if item
            .attrs
            .iter()
            .any(|attribute| attribute.path().is_ident("path"))
        {
            self.found.push(format!(
                "{}:{}: the module `{}` has an attribute `path`",
                self.path.display(),
                item.span().start().line,
                item.ident
            ));
        }
        visit::visit_item_mod(self, item);
    }
}
