//! The tiles of a map from a file in the format MBTiles.

use std::{
    path::Path,
    sync::{Mutex, PoisonError},
};

use anyhow::{Context, Result, bail, ensure};
use rusqlite::{Connection, OpenFlags, OptionalExtension};
use serde::Serialize;

/// Tiles of pictures.
pub struct Tiles {
    file: Mutex<Connection>,
    /// The media type of a tile.
    pub kind: &'static str,
    /// What a page is told of them.
    pub about: About,
}

/// What a page is told of them.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct About {
    min_zoom: u32,
    max_zoom: u32,
    /// Whose they are, as HTML.
    #[serde(skip_serializing_if = "Option::is_none")]
    attribution: Option<String>,
}

/// The deepest level that there can be.
const DEEPEST: u32 = 30;

impl Tiles {
    /// Opens a file.
    ///
    /// # Errors
    /// If it is none, or its tiles are no pictures.
    pub fn open(file: &Path) -> Result<Self> {
        let name = file.display();
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let open = Connection::open_with_flags(file, flags);
        let open = open.with_context(|| format!("cannot open the tiles {name}"))?;
        let about = |what: &str| -> rusqlite::Result<Option<String>> {
            let query = "SELECT value FROM metadata WHERE name = ?1";
            open.query_row(query, [what], |row| row.get(0)).optional()
        };
        let none = || format!("{name} is no MBTiles file");
        let kind = match about("format").with_context(none)?.as_deref() {
            Some("png") => "image/png",
            Some("jpg" | "jpeg") => "image/jpeg",
            Some("webp") => "image/webp",
            Some(other) => bail!("the tiles of {name} are {other}; png, jpg and webp can be shown"),
            None => bail!("{name} does not say what its tiles are"),
        };
        let zoom = |which: &str| -> rusqlite::Result<Option<u32>> {
            let query = format!("SELECT {which}(zoom_level) FROM tiles");
            open.query_row(&query, [], |row| row.get(0))
        };
        let zooms = (zoom("min").with_context(none)?).zip(zoom("max").with_context(none)?);
        let (min_zoom, max_zoom) = zooms.with_context(|| format!("{name} has no tiles"))?;
        ensure!(
            max_zoom <= DEEPEST,
            "{name} has tiles of level {max_zoom}, beyond {DEEPEST}"
        );
        let about = About {
            min_zoom,
            max_zoom,
            attribution: about("attribution").with_context(none)?,
        };
        Ok(Self {
            file: Mutex::new(open),
            kind,
            about,
        })
    }

    /// A tile, if the file has it; rows count from the north.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn tile(&self, [zoom, column, row]: [u32; 3]) -> Result<Option<Vec<u8>>> {
        let side = 1_u64.checked_shl(zoom).unwrap_or(0);
        let Some(from_south) = side.checked_sub(1 + u64::from(row)) else {
            return Ok(None);
        };
        let file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let query = "SELECT tile_data FROM tiles WHERE zoom_level = ?1 AND tile_column = ?2 AND tile_row = ?3";
        let mut query = file.prepare_cached(query)?;
        let tile = query.query_row((zoom, column, from_south as i64), |row| row.get(0));
        Ok(tile.optional()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file with a tile, and what its metadata say.
    fn with(metadata: &[(&str, &str)], zoom: u32) -> Result<Tiles> {
        static NUMBER: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let name = format!("foxhunt-tiles-{}-{number}.mbtiles", std::process::id());
        let file = std::env::temp_dir().join(name);
        let open = Connection::open(&file)?;
        open.execute_batch(
            "CREATE TABLE metadata (name TEXT, value TEXT);
             CREATE TABLE tiles (zoom_level INTEGER, tile_column INTEGER, tile_row INTEGER, tile_data BLOB);",
        )?;
        for pair in metadata {
            open.execute("INSERT INTO metadata VALUES (?1, ?2)", *pair)?;
        }
        let tile = (zoom, 2, 5, b"picture");
        open.execute("INSERT INTO tiles VALUES (?1, ?2, ?3, ?4)", tile)?;
        let tiles = Tiles::open(&file);
        std::fs::remove_file(&file)?;
        tiles
    }

    #[test]
    fn rows_count_from_the_north() {
        let tiles = with(&[("format", "png"), ("attribution", "me")], 3).unwrap();
        assert_eq!(tiles.kind, "image/png");
        let about = serde_json::to_string(&tiles.about).unwrap();
        assert_eq!(
            about,
            "{\"min_zoom\":3,\"max_zoom\":3,\"attribution\":\"me\"}"
        );
        assert_eq!(tiles.tile([3, 2, 2]).unwrap().unwrap(), b"picture");
        for none in [[3, 2, 5], [4, 2, 2], [3, 2, 8], [99, 0, 0], [u32::MAX; 3]] {
            assert_eq!(tiles.tile(none).unwrap(), None);
        }
    }

    #[test]
    fn what_cannot_be_shown_is_said() {
        let wrong = |tiles: Result<Tiles>| tiles.err().unwrap().to_string();
        assert!(wrong(with(&[("format", "pbf")], 3)).contains("are pbf"));
        assert!(wrong(with(&[], 3)).contains("does not say"));
        assert!(wrong(with(&[("format", "png")], 31)).contains("level 31"));
        let none = std::env::temp_dir().join("foxhunt-no-tiles");
        assert!(wrong(Tiles::open(&none)).contains("cannot open"));
        std::fs::write(&none, b"SQLite format 3\0 but that is all").unwrap();
        assert!(wrong(Tiles::open(&none)).contains("no MBTiles"));
        std::fs::remove_file(none).unwrap();
    }
}
