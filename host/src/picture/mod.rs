//! Pictures, as SVG and as PNG.
//!
//! Nothing of the machine is used, no font of the system either: the letters are measured, and drawn
//! in the PNG, with the one that comes along.

mod curves;
mod frame;
mod heat;
mod map;
mod walks;

pub use curves::{Axis, Curve, Curves, Style};
pub use frame::outline;
pub use heat::{Field, Heat};
pub use map::Map;
pub use walks::{Walk, Walks};

use std::{fs, path::Path, sync::Once};

use anyhow::{Context, Result, anyhow};
use plotters::{
    coord::Shift,
    prelude::*,
    style::{FontStyle, register_font},
};
use resvg::{
    tiny_skia::{Pixmap, Transform},
    usvg,
};

/// Ink of text, and of what was there before any estimate: the track, the truth.
const INK: RGBColor = RGBColor(38, 50, 56);
const GRID: RGBColor = RGBColor(226, 230, 233);

/// Pixels of the PNG for one of the SVG.
const SCALE: f32 = 1.5;

/// Writes a picture beside `stem`, with the endings `.svg` and `.png`.
///
/// # Errors
/// If the files cannot be written.
pub fn save(svg: &str, stem: &Path) -> Result<()> {
    if let Some(directory) = stem.parent() {
        fs::create_dir_all(directory)
            .with_context(|| format!("cannot make {}", directory.display()))?;
    }
    let write = |ending, bytes: &[u8]| {
        let file = stem.with_extension(ending);
        fs::write(&file, bytes).with_context(|| format!("cannot write {}", file.display()))
    };
    write("svg", svg.as_bytes())?;
    write("png", &png(svg)?)
}

/// The picture in pixels.
fn png(svg: &str) -> Result<Vec<u8>> {
    let mut options = usvg::Options::default();
    let fonts = options.fontdb_mut();
    fonts.load_font_data(notosans::REGULAR_TTF.to_vec());
    fonts.set_sans_serif_family("Noto Sans");
    let tree = usvg::Tree::from_str(svg, &options)?;
    let size = tree
        .size()
        .to_int_size()
        .scale_by(SCALE)
        .context("the picture is empty")?;
    let mut pixels = Pixmap::new(size.width(), size.height()).context("the picture is empty")?;
    resvg::render(
        &tree,
        Transform::from_scale(SCALE, SCALE),
        &mut pixels.as_mut(),
    );
    Ok(pixels.encode_png()?)
}

/// Pixels that `text` takes: what plotters measures is a few percent short.
fn width<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    text: &str,
    style: &TextStyle,
) -> Result<i32>
where
    DB::ErrorType: 'static,
{
    let (measured, _) = area.estimate_text_size(text, style)?;
    Ok((1.1 * f64::from(measured)) as i32)
}

fn font(size: u32) -> TextStyle<'static> {
    ("sans-serif", size).into_font().color(&INK)
}

/// Lets plotters measure text; to be called before it does.
fn use_font() -> Result<()> {
    static FONT: Once = Once::new();
    let mut registered = Ok(());
    FONT.call_once(|| {
        registered = register_font("sans-serif", FontStyle::Normal, notosans::REGULAR_TTF)
            .map_err(|_| anyhow!("the font is damaged"));
    });
    registered
}
