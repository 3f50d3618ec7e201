//! The files of the repository that are read: Rust and Markdown.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result};
use syn::{Attribute, Item, Meta, Token, punctuated::Punctuated};

/// Files by their path from the root of the repository.
pub struct Sources {
    /// The root.
    pub root: PathBuf,
    /// Text of every Rust file, Markdown file and manifest.
    pub texts: BTreeMap<PathBuf, String>,
    /// What Rust files say.
    pub syntax: BTreeMap<PathBuf, syn::File>,
}

impl Sources {
    /// Reads everything below `root` except hidden directories and those of builds.
    pub fn read(root: &Path) -> Result<Self> {
        let mut sources = Self {
            root: root.to_owned(),
            texts: BTreeMap::new(),
            syntax: BTreeMap::new(),
        };
        sources.add(Path::new(""))?;
        Ok(sources)
    }

    fn add(&mut self, directory: &Path) -> Result<()> {
        for entry in fs::read_dir(self.root.join(directory))? {
            let entry = entry?;
            let path = directory.join(entry.file_name());
            if entry.file_name().to_string_lossy().starts_with('.') {
                continue;
            }
            if entry.file_type()?.is_dir() {
                if !entry.path().join("CACHEDIR.TAG").exists() {
                    self.add(&path)?;
                }
            } else if has_extension(&path, &["rs", "md", "toml"]) {
                let text = fs::read_to_string(entry.path())
                    .with_context(|| format!("cannot read {}", path.display()))?;
                if has_extension(&path, &["rs"]) {
                    let file = syn::parse_file(&text)
                        .with_context(|| format!("cannot parse {}", path.display()))?;
                    self.syntax.insert(path.clone(), file);
                }
                self.texts.insert(path, text);
            }
        }
        Ok(())
    }
}

/// Whether the name of `path` ends with a dot and one of `extensions`.
pub fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    path.extension()
        .is_some_and(|own| extensions.iter().any(|extension| own == *extension))
}

/// Whether attributes say that an item exists in tests only.
pub fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let path = attribute.path();
        path.is_ident("test")
            || path.is_ident("cfg")
                && attribute
                    .parse_args()
                    .is_ok_and(|meta| requires_test(&meta))
    })
}

/// `test`, or `all(..)` with it.
fn requires_test(predicate: &Meta) -> bool {
    match predicate {
        Meta::Path(path) => path.is_ident("test"),
        Meta::List(list) if list.path.is_ident("all") => list
            .parse_args_with(Punctuated::<Meta, Token![,]>::parse_terminated)
            .is_ok_and(|all| all.iter().any(requires_test)),
        _ => false,
    }
}

/// The attributes of an item.
pub fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::ExternCrate(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::ForeignMod(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Union(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}
