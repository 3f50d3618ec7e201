//! The size of the library.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    str::FromStr,
};

use anyhow::{Result, anyhow};
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use syn::{
    Item,
    spanned::Spanned,
    visit::{self, Visit},
};

use super::{
    modules::Modules,
    resolve::Target,
    sources::{Sources, attributes, is_test},
};

/// What is counted.
#[derive(Debug, PartialEq, Eq)]
pub struct Count {
    /// Files of the library, without tests.
    pub files: usize,
    /// Their lines that hold code: no comments, no blank lines, no tests.
    pub lines: usize,
    /// Structs, enums, unions, traits and aliases of types that a user can name.
    pub types: usize,
}

/// Counts the library whose root is the file `root`.
pub fn count(sources: &Sources, root: &Path) -> Result<Count> {
    let modules = Modules::read(sources, root);
    let files: BTreeSet<&PathBuf> = modules.modules.iter().map(|module| &module.file).collect();
    let mut lines = 0;
    for file in &files {
        let tokens = TokenStream::from_str(&sources.texts[*file]);
        let mut code = BTreeSet::new();
        add_code(tokens.map_err(|error| anyhow!("{error}"))?, &mut code);
        Tests(&mut code).visit_file(&sources.syntax[*file]);
        lines += code.len();
    }
    let mut public = Public {
        modules: &modules,
        seen: BTreeSet::new(),
        types: BTreeSet::new(),
    };
    public.visit(0);
    Ok(Count {
        files: files.len(),
        lines,
        types: public.types.len(),
    })
}

/// Adds the lines on which tokens lie. Documentation is an attribute `doc` to the lexer.
fn add_code(tokens: TokenStream, lines: &mut BTreeSet<usize>) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let mut i = 0;
    while i < tokens.len() {
        i += match &tokens[i..] {
            [TokenTree::Punct(hash), TokenTree::Group(group), ..]
                if hash.as_char() == '#' && is_documentation(group) =>
            {
                2
            }
            [
                TokenTree::Punct(hash),
                TokenTree::Punct(inner),
                TokenTree::Group(group),
                ..,
            ] if hash.as_char() == '#' && inner.as_char() == '!' && is_documentation(group) => 3,
            [TokenTree::Group(group), ..] => {
                if group.delimiter() != Delimiter::None {
                    lines.insert(group.span_open().start().line);
                    lines.insert(group.span_close().end().line);
                }
                add_code(group.stream(), lines);
                1
            }
            [token, ..] => {
                lines.extend(token.span().start().line..=token.span().end().line);
                1
            }
            [] => 1,
        };
    }
}

fn is_documentation(attribute: &proc_macro2::Group) -> bool {
    let first = attribute.stream().into_iter().next();
    matches!(first, Some(TokenTree::Ident(name)) if name == "doc")
}

/// Takes the lines of tests away.
struct Tests<'a>(&'a mut BTreeSet<usize>);

impl<'ast> Visit<'ast> for Tests<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if is_test(attributes(item)) {
            let attributes = attributes(item).iter();
            let first = attributes
                .map(|attribute| attribute.span().start().line)
                .min();
            let first = first.unwrap_or(item.span().start().line);
            for line in first..=item.span().end().line {
                self.0.remove(&line);
            }
        } else {
            visit::visit_item(self, item);
        }
    }
}

/// Walks through what a user can name.
struct Public<'a> {
    modules: &'a Modules,
    seen: BTreeSet<usize>,
    types: BTreeSet<(usize, String)>,
}

impl Public<'_> {
    fn visit(&mut self, number: usize) {
        if !self.seen.insert(number) {
            return;
        }
        let module = &self.modules.modules[number];
        let types = module.items.iter().filter(|(_, public_type)| **public_type);
        self.types
            .extend(types.map(|(name, _)| (number, name.clone())));
        for (child, _) in module.children.values().filter(|(_, public)| *public) {
            self.visit(*child);
        }
        let imports = module.imports.values().chain(&module.globs);
        for import in imports.filter(|import| import.public) {
            match self.modules.target(number, &import.path) {
                Some(Target::Module(module)) => self.visit(module),
                Some(Target::Item(module, name)) if self.modules.modules[module].items[&name] => {
                    self.types.insert((module, name));
                }
                _ => {}
            }
        }
    }
}
