//! The page that shows a hunt: static files, without a framework and without anything from outside.
//!
//! Whoever serves [`FILES`] serves the page. If the same server answers `api/state`, the page shows what that tells: see
//! `foxhunt live`. Otherwise it is on its own, and simulates. It works with [`POLICY`].
//!
//! ```
//! let (path, mime, bytes) = foxhunt_page::file("").expect("the page itself");
//! assert_eq!((*path, *mime), ("index.html", "text/html; charset=utf-8"));
//! assert!(bytes.starts_with(b"<!doctype html>"));
//! ```

/// The path of a file, its media type, and what it holds.
pub type File = (&'static str, &'static str, &'static [u8]);

/// The `Content-Security-Policy` under which the page works: it asks for nothing from other servers.
pub const POLICY: &str = "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; base-uri 'none'; \
                          form-action 'none'; frame-ancestors 'none'";

const HTML: &str = "text/html; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const STYLE: &str = "text/css; charset=utf-8";
const IMAGE: &str = "image/svg+xml";
const WASM: &str = "application/wasm";

macro_rules! files {
    ($($path:literal $mime:ident),+ $(,)?) => {
        &[$(($path, $mime, include_bytes!(concat!("../static/", $path)))),+]
    };
}

/// All files of the page.
pub const FILES: &[File] = files![
    "index.html" HTML,
    "style.css" STYLE,
    "icon.svg" IMAGE,
    "foxhunt.wasm" WASM,
    "background.js" SCRIPT,
    "connection.js" SCRIPT,
    "dom.js" SCRIPT,
    "draw.js" SCRIPT,
    "engine.js" SCRIPT,
    "geo.js" SCRIPT,
    "health.js" SCRIPT,
    "hunt.js" SCRIPT,
    "live.js" SCRIPT,
    "main.js" SCRIPT,
    "palette.js" SCRIPT,
    "player.js" SCRIPT,
    "replay.js" SCRIPT,
    "scenarios.js" SCRIPT,
    "site.js" SCRIPT,
    "store.js" SCRIPT,
    "view.js" SCRIPT,
    "walkers.js" SCRIPT,
    "words.js" SCRIPT,
];

/// The file of a path without its first slash; that of the empty path is the page itself.
pub fn file(path: &str) -> Option<&'static File> {
    let path = if path.is_empty() { "index.html" } else { path };
    FILES.iter().find(|(name, ..)| *name == path)
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeSet, fs, path::Path};

    use super::*;

    #[test]
    fn every_file_is_served() {
        let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("static");
        let there: BTreeSet<String> = fs::read_dir(directory)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        let served: BTreeSet<String> = FILES.iter().map(|(path, ..)| (*path).into()).collect();
        assert_eq!(there, served);
    }

    #[test]
    fn nothing_comes_from_outside() {
        for (path, mime, bytes) in FILES.iter().filter(|(_, mime, _)| *mime != WASM) {
            let text = str::from_utf8(bytes).unwrap();
            let outside = text.replace("http://www.w3.org/2000/svg", "");
            assert!(
                !outside.contains("://"),
                "{path} ({mime}) names another server"
            );
        }
    }
}
