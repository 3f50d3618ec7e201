//! Each check fails on a small tree with one fault in it.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process,
    sync::atomic::{AtomicU32, Ordering},
};

use super::{count, sources::Sources};

/// A tree of files that is removed in the end.
struct Tree(PathBuf);

impl Tree {
    fn new(files: &[(&str, &str)]) -> Self {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let tree = Self(env::temp_dir().join(format!("foxhunt-house-{}-{number}", process::id())));
        let manifest = "[package]\nname = \"planted\"\nedition = \"2024\"\n[workspace]\n";
        for (path, text) in [("Cargo.toml", manifest)].iter().chain(files) {
            let file = tree.0.join(path);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(file, text).unwrap();
        }
        tree
    }

    fn find(&self) -> Vec<String> {
        super::find(&self.0).unwrap()
    }
}

impl Drop for Tree {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// What is found in the files.
fn found(files: &[(&str, &str)]) -> Vec<String> {
    Tree::new(files).find()
}

#[test]
fn nothing_is_found_where_files_need_each_other_one_way() {
    let files = [
        ("src/lib.rs", "mod a;\nmod b;\npub use a::A;"),
        ("src/a.rs", "use crate::b::B;\npub struct A(B);"),
        (
            "src/b.rs",
            "pub struct B;\n#[cfg(test)]\nmod tests { use crate::A; }",
        ),
    ];
    assert_eq!(found(&files), [""; 0]);
}

#[test]
fn a_circle_is_found_with_its_lines() {
    let files = [
        ("src/lib.rs", "mod a;\nmod b;"),
        ("src/a.rs", "\nuse crate::b::{self, B};\npub struct A(B);"),
        ("src/b.rs", "use super::a::A;\npub struct B(A);"),
    ];
    let circle = "2 files need each other:\n    \
        src/a.rs:2 needs src/b.rs: crate::b, crate::b::B\n    \
        src/b.rs:1 needs src/a.rs: super::a::A";
    assert_eq!(found(&files), [circle]);
}

#[test]
fn a_circle_through_names_that_a_parent_hands_on_is_found() {
    let files = [
        ("src/lib.rs", "mod p;"),
        (
            "src/p/mod.rs",
            "mod a;\nmod b;\npub use a::*;\npub use b::B as C;",
        ),
        ("src/p/a.rs", "use super::C;\npub struct A(C);"),
        ("src/p/b.rs", "use crate::p::A;\npub struct B(A);"),
    ];
    let found = found(&files);
    assert!(
        matches!(&*found, [circle] if circle.contains("src/p/b.rs:1 needs src/p/a.rs")),
        "{found:?}"
    );
}

#[test]
fn a_circle_of_a_module_and_its_child_is_found() {
    let files = [
        ("src/lib.rs", "mod p;"),
        ("src/p.rs", "mod a;\nuse a::A;\npub struct P(A);"),
        ("src/p/a.rs", "use super::P;\npub struct A(P);"),
    ];
    let found = found(&files);
    assert!(
        matches!(&*found, [circle] if circle.contains("src/p.rs:2 needs src/p/a.rs")),
        "{found:?}"
    );
}

#[test]
fn a_circle_by_paths_in_code_and_in_macros_is_found() {
    let files = [
        ("src/lib.rs", "mod a;\nmod b;"),
        ("src/a.rs", "pub fn a() -> u32 { crate::b::b() }"),
        (
            "src/b.rs",
            "pub fn b() -> u32 { assert!(super::a::a() > 0); 0 }",
        ),
    ];
    assert_eq!(found(&files).len(), 1);
}

#[test]
fn a_circle_through_a_file_that_hands_a_name_on_is_found() {
    let files = [
        ("src/lib.rs", "mod p;\nmod q;"),
        (
            "src/p/mod.rs",
            "mod a;\npub use a::A;\nuse crate::q::Q;\npub struct P(Q);",
        ),
        ("src/p/a.rs", "pub struct A;"),
        ("src/q.rs", "use crate::p::A;\npub struct Q(A);"),
    ];
    let found = found(&files);
    assert!(
        matches!(&*found, [circle] if circle.contains("src/q.rs:1 needs src/p/mod.rs")),
        "{found:?}"
    );
}

#[test]
fn a_long_function_is_found() {
    let function = |lines: usize| format!("fn f() {{\n{}}}\n", "f();\n".repeat(lines - 2));
    let short = [
        ("src/lib.rs", &*function(60)),
        ("tests/t.rs", &*function(80)),
    ];
    assert_eq!(found(&short), [""; 0]);
    let long = [
        ("src/lib.rs", &*function(61)),
        ("tests/t.rs", &*function(81)),
    ];
    let expected = [
        "src/lib.rs:1: `f` has 61 lines, at most 60",
        "tests/t.rs:1: `f` has 81 lines, at most 80",
    ];
    assert_eq!(found(&long), expected);
}

#[test]
fn a_doc_comment_that_goes_on_at_the_next_item_is_found() {
    let text = "/// One,\n/// two.\npub struct A {\n    /// Before,\n    pub b: u32,\n    /// and after.\n    pub c: u32,\n}\n";
    assert_eq!(
        found(&[("src/lib.rs", text)]),
        ["src/lib.rs:4: the doc comment ends in a comma"]
    );
}

#[test]
fn a_long_file_is_found() {
    let file = "\n".repeat(501);
    assert_eq!(
        found(&[("src/lib.rs", &*file)]),
        ["src/lib.rs: 501 lines, at most 500"]
    );
}

#[test]
fn a_module_that_lies_elsewhere_is_found() {
    let files = [
        ("src/lib.rs", "#[path = \"b.rs\"]\nmod a;"),
        ("src/b.rs", ""),
    ];
    assert_eq!(
        found(&files),
        ["src/lib.rs:1: the module `a` has an attribute `path`"]
    );
}

#[test]
fn a_word_is_found_in_names_and_prose() {
    let text =
        "/// The\n/// wild one, of a standard\n/// deviation.\nstruct TrackShare { wild_m: u32 }\n";
    let found = found(&[
        ("src/lib.rs", text),
        ("README.md", "Parked, in the wilderness."),
        ("other.md", "wild"),
    ]);
    let expected = [
        "README.md: `Parked` (say: stationary), lines 1",
        "src/lib.rs: `wild` (say: outlier), lines 2, 4",
        "src/lib.rs: `Share` (say: weight, probability, fraction, rate), lines 4",
    ];
    assert_eq!(found, expected);
}

#[test]
fn the_name_of_a_file_is_of_words_too() {
    let found = found(&[("src/lib.rs", "mod wild;"), ("src/wild.rs", "")]);
    let expected = [
        "src/lib.rs: `wild` (say: outlier), lines 1",
        "src/wild.rs: `wild` (say: outlier), lines its name",
    ];
    assert_eq!(found, expected);
}

#[test]
fn lines_of_code_and_public_types_are_counted() {
    let library = "//! Words.\n\nmod a; // Words.\npub use a::A;\n#[cfg(test)]\nmod tests {\n}\n/// Words.\npub enum E {\n    /* words */\n}\n";
    let tree = Tree::new(&[
        ("src/lib.rs", library),
        (
            "src/a.rs",
            "pub struct A;\n\npub struct Hidden;\npub fn f() {}",
        ),
        ("src/tests.rs", "fn f() {}"),
    ]);
    let sources = Sources::read(&tree.0).unwrap();
    let expected = count::Count {
        files: 2,
        lines: 7,
        types: 2,
    };
    assert_eq!(
        count::count(&sources, Path::new("src/lib.rs")).unwrap(),
        expected
    );
}
