//! The modules of a crate: in which file each lies, what it defines, and what it takes from others.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use proc_macro2::{Spacing, TokenStream, TokenTree};
use syn::{
    Block, Ident, ImplItem, Item, ItemMod, ItemUse, Macro, UseTree, Visibility,
    spanned::Spanned,
    visit::{self, Visit},
};

use super::sources::{Sources, attributes, is_test};

/// The modules of a crate, the root first.
#[derive(Default)]
pub struct Modules {
    /// By number.
    pub modules: Vec<Module>,
    /// Everything that a module takes from another.
    pub references: Vec<Reference>,
}

/// A module.
#[derive(Default)]
pub struct Module {
    /// The file it lies in; several inline modules lie in one.
    pub file: PathBuf,
    /// Where the files of its own modules lie.
    directory: PathBuf,
    /// The module around it.
    pub parent: Option<usize>,
    /// Modules in it, and whether they are public.
    pub children: BTreeMap<String, (usize, bool)>,
    /// Items that it defines, and whether they are public types.
    pub items: BTreeMap<String, bool>,
    /// Names that it has from elsewhere.
    pub imports: BTreeMap<String, Import>,
    /// Paths of which it has every name.
    pub globs: Vec<Import>,
}

/// What a name stands for.
pub struct Import {
    /// The path.
    pub path: Vec<String>,
    /// Whether it is handed on to everybody.
    pub public: bool,
}

/// A path that names what another module may define.
pub struct Reference {
    /// The module in which it stands.
    pub module: usize,
    /// The line on which it begins.
    pub line: usize,
    /// Its words.
    pub path: Vec<String>,
    /// Whether a `use` names it, or code does.
    pub import: bool,
}

impl Modules {
    /// The modules of the crate whose root is the file `root`. Tests, files that are not there and files with an
    /// attribute `path` are left out.
    pub fn read(sources: &Sources, root: &Path) -> Self {
        let mut reader = Reader {
            sources,
            modules: Self::default(),
            module: 0,
            blocks: 0,
        };
        reader.modules.modules.push(Module {
            file: root.to_owned(),
            directory: root.parent().unwrap_or(Path::new("")).to_owned(),
            ..Module::default()
        });
        reader.read_file(root);
        reader.modules
    }
}

/// Walks through the files of a crate.
struct Reader<'a> {
    sources: &'a Sources,
    modules: Modules,
    /// Where it is.
    module: usize,
    /// In how many blocks of code it is: what they define is nobody else's.
    blocks: usize,
}

impl Reader<'_> {
    fn here(&mut self) -> &mut Module {
        &mut self.modules.modules[self.module]
    }

    fn read_file(&mut self, path: &Path) {
        let sources = self.sources;
        if let Some(file) = sources.syntax.get(path) {
            self.visit_file(file);
        }
    }

    /// Where the file of the module `name` is, and where those of its own modules are.
    fn file_of(&mut self, name: &str) -> Option<(PathBuf, PathBuf)> {
        let directory = self.here().directory.join(name);
        let candidates = [directory.with_extension("rs"), directory.join("mod.rs")];
        let mut found = candidates.into_iter();
        let file = found.find(|file| self.sources.syntax.contains_key(file))?;
        Some((file, directory))
    }

    fn refer(&mut self, line: usize, path: Vec<String>, import: bool) {
        self.modules.references.push(Reference {
            module: self.module,
            line,
            path,
            import,
        });
    }

    fn define(&mut self, name: &Ident, public_type: bool) {
        if self.blocks == 0 {
            self.here().items.insert(name.to_string(), public_type);
        }
    }

    /// Follows the branches of a `use`.
    fn import(&mut self, tree: &UseTree, mut path: Vec<String>, visibility: &Visibility) {
        let public = matches!(visibility, Visibility::Public(_));
        let line = tree.span().start().line;
        let name = match tree {
            UseTree::Path(branch) => {
                path.push(branch.ident.to_string());
                return self.import(&branch.tree, path, visibility);
            }
            UseTree::Group(group) => {
                for tree in &group.items {
                    self.import(tree, path.clone(), visibility);
                }
                return;
            }
            UseTree::Glob(_) => {
                if self.blocks == 0 {
                    let path = path.clone();
                    self.here().globs.push(Import { path, public });
                }
                None
            }
            UseTree::Name(name) if name.ident == "self" => path.last().cloned(),
            UseTree::Name(name) => {
                path.push(name.ident.to_string());
                path.last().cloned()
            }
            UseTree::Rename(rename) => {
                if rename.ident != "self" {
                    path.push(rename.ident.to_string());
                }
                Some(rename.rename.to_string())
            }
        };
        if let Some(name) = name.filter(|_| self.blocks == 0) {
            let path = path.clone();
            self.here().imports.insert(name, Import { path, public });
        }
        if matches!(visibility, Visibility::Inherited) {
            self.refer(line, path, true);
        }
    }

    /// Finds paths in what is given to a macro. Those that begin with `$crate` are of the macro's own crate.
    fn read_tokens(&mut self, tokens: TokenStream) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut i = 0;
        while i < tokens.len() {
            match &tokens[i] {
                TokenTree::Group(group) => self.read_tokens(group.stream()),
                TokenTree::Ident(first) if i == 0 || !continues(&tokens[i - 1]) => {
                    let line = first.span().start().line;
                    let mut path = vec![first.to_string()];
                    while let [
                        TokenTree::Punct(a),
                        TokenTree::Punct(b),
                        TokenTree::Ident(next),
                        ..,
                    ] = &tokens[i + 1..]
                        && a.as_char() == ':'
                        && a.spacing() == Spacing::Joint
                        && b.as_char() == ':'
                    {
                        path.push(next.to_string());
                        i += 3;
                    }
                    self.refer(line, path, false);
                }
                _ => {}
            }
            i += 1;
        }
    }
}

/// Whether a token ties the word after it to something before.
fn continues(token: &TokenTree) -> bool {
    matches!(token, TokenTree::Punct(mark) if ['$', '.', ':'].contains(&mark.as_char()))
}

impl<'ast> Visit<'ast> for Reader<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if is_test(attributes(item)) {
            return;
        }
        let is_public = |visibility: &Visibility| matches!(visibility, Visibility::Public(_));
        match item {
            Item::Struct(item) => self.define(&item.ident, is_public(&item.vis)),
            Item::Enum(item) => self.define(&item.ident, is_public(&item.vis)),
            Item::Union(item) => self.define(&item.ident, is_public(&item.vis)),
            Item::Trait(item) => self.define(&item.ident, is_public(&item.vis)),
            Item::Type(item) => self.define(&item.ident, is_public(&item.vis)),
            Item::Const(item) => self.define(&item.ident, false),
            Item::Static(item) => self.define(&item.ident, false),
            Item::Fn(item) => self.define(&item.sig.ident, false),
            Item::Macro(item) => self.define_macro(item),
            _ => {}
        }
        visit::visit_item(self, item);
    }

    fn visit_impl_item(&mut self, item: &'ast ImplItem) {
        let attributes = match item {
            ImplItem::Const(item) => &item.attrs,
            ImplItem::Fn(item) => &item.attrs,
            ImplItem::Type(item) => &item.attrs,
            _ => return,
        };
        if !is_test(attributes) {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        let name = item.ident.to_string();
        let has_path = item.attrs.iter().any(|one| one.path().is_ident("path"));
        let (file, directory) = match &item.content {
            Some(_) => {
                let here = self.here();
                (here.file.clone(), here.directory.join(&name))
            }
            None if has_path => return,
            None => match self.file_of(&name) {
                Some(found) => found,
                None => return,
            },
        };
        let (parent, number) = (self.module, self.modules.modules.len());
        let public = matches!(item.vis, Visibility::Public(_));
        self.here().children.insert(name, (number, public));
        self.modules.modules.push(Module {
            file: file.clone(),
            directory,
            parent: Some(parent),
            ..Module::default()
        });
        self.module = number;
        match &item.content {
            Some(_) => visit::visit_item_mod(self, item),
            None => self.read_file(&file),
        }
        self.module = parent;
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        if item.leading_colon.is_none() {
            self.import(&item.tree, Vec::new(), &item.vis);
        }
    }

    fn visit_block(&mut self, block: &'ast Block) {
        self.blocks += 1;
        visit::visit_block(self, block);
        self.blocks -= 1;
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let words = path.segments.iter().map(|word| word.ident.to_string());
        self.refer(path.span().start().line, words.collect(), false);
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast Macro) {
        self.visit_path(&call.path);
        self.read_tokens(call.tokens.clone());
    }

    // They name modules, and take nothing from them.
    fn visit_visibility(&mut self, _: &'ast Visibility) {}

    fn visit_attribute(&mut self, _: &'ast syn::Attribute) {}
}

impl Reader<'_> {
    /// An exported macro is also the root's.
    fn define_macro(&mut self, item: &syn::ItemMacro) {
        let Some(name) = &item.ident else { return };
        self.define(name, false);
        let exported = |one: &syn::Attribute| one.path().is_ident("macro_export");
        if self.module != 0 && item.attrs.iter().any(exported) {
            let mut path = vec![name.to_string()];
            let mut module = self.module;
            while let Some(parent) = self.modules.modules[module].parent {
                let mut children = self.modules.modules[parent].children.iter();
                if let Some((name, _)) = children.find(|(_, (number, _))| *number == module) {
                    path.push(name.clone());
                }
                module = parent;
            }
            path.reverse();
            let import = Import { path, public: true };
            self.modules.modules[0]
                .imports
                .insert(name.to_string(), import);
        }
    }
}
