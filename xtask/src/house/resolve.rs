//! What a path stands for: the file that defines it, and the files that hand it on.

use std::{collections::BTreeSet, iter::successors, path::Path};

use super::modules::{Module, Modules, Reference};

/// What a path leads to.
pub enum Target {
    /// A module, by its number.
    Module(usize),
    /// An item of the module with this number.
    Item(usize, String),
}

/// The search for what a path leads to.
#[derive(Default)]
struct Search {
    /// Names that are being looked up, so that imports of each other end.
    open: BTreeSet<(usize, String)>,
    /// Modules from which the name was had that another defines.
    through: Vec<usize>,
}

/// A file that a reference needs.
#[derive(PartialEq)]
pub struct Need<'a> {
    /// The file.
    pub file: &'a Path,
    /// Whether it defines what is named, or only hands the name on.
    pub defines: bool,
    /// Whether it is that of a module around the reference.
    pub around: bool,
}

impl Modules {
    /// The other files that a reference needs.
    pub fn needs(&self, reference: &Reference) -> Vec<Need<'_>> {
        let from = reference.module;
        let path = &reference.path;
        let anchored = ["crate", "self", "super"].contains(&&*path[0]);
        // In code a single word has been imported, and so has a type before its function.
        let named = path.len() > 1 && (anchored || self.names_module(from, &path[0]));
        let mut search = Search::default();
        let target = self
            .resolve(from, path, &mut search)
            .filter(|_| reference.import || named);
        let Some(Target::Module(last) | Target::Item(last, _)) = target else {
            return Vec::new();
        };
        let around: Vec<usize> =
            successors(Some(from), |&module| self.modules[module].parent).collect();
        let need = |module: usize, defines| Need {
            file: &self.modules[module].file,
            defines,
            around: around.contains(&module),
        };
        let handed = search.through.into_iter().map(|module| need(module, false));
        handed
            .chain([need(last, true)])
            .filter(|need| need.file != self.modules[from].file)
            .collect()
    }

    /// What `path` leads to from the module `from`; `None` outside of the crate.
    pub fn target(&self, from: usize, path: &[String]) -> Option<Target> {
        self.resolve(from, path, &mut Search::default())
    }

    fn names_module(&self, from: usize, word: &str) -> bool {
        let target = self.target(from, &[word.to_owned()]);
        matches!(target, Some(Target::Module(_)))
    }

    fn resolve(&self, from: usize, path: &[String], search: &mut Search) -> Option<Target> {
        let mut module = from;
        let mut words = path.iter().peekable();
        while let Some(word) = words.next() {
            module = match word.as_str() {
                "crate" => 0,
                "self" => module,
                "super" => self.modules[module].parent?,
                name => match self.look_up(module, name, words.peek().is_none(), search)? {
                    Target::Module(module) => module,
                    // What follows is an item's own: a variant, a function.
                    item => return Some(item),
                },
            };
        }
        Some(Target::Module(module))
    }

    /// What `name` stands for in a module. Of a module and an item of one name, the last word of a path means the item.
    fn look_up(
        &self,
        number: usize,
        name: &str,
        last: bool,
        search: &mut Search,
    ) -> Option<Target> {
        let module = &self.modules[number];
        let child = module
            .children
            .get(name)
            .map(|&(child, _)| Target::Module(child));
        if module.items.contains_key(name) && (last || child.is_none()) {
            return Some(Target::Item(number, name.to_owned()));
        }
        if child.is_some() && !last {
            return child;
        }
        if !search.open.insert((number, name.to_owned())) {
            return child;
        }
        let imported = self.imported(number, module, name, search);
        search.open.remove(&(number, name.to_owned()));
        match imported {
            Some(target) => {
                search.through.push(number);
                Some(target)
            }
            None => child,
        }
    }

    fn imported(
        &self,
        number: usize,
        module: &Module,
        name: &str,
        search: &mut Search,
    ) -> Option<Target> {
        if let Some(import) = module.imports.get(name) {
            return self.resolve(number, &import.path, search);
        }
        module.globs.iter().find_map(|glob| {
            let Target::Module(source) = self.resolve(number, &glob.path, search)? else {
                return None;
            };
            self.look_up(source, name, true, search)
        })
    }
}
