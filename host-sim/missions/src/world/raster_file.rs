//! Rasters as files have them: PNG images, grids of ESRI's ASCII format, and `GeoTIFF`.

use std::io;
#[cfg(not(target_family = "wasm"))]
use std::io::BufReader;
use std::path::Path;

use anyhow::{Context as _, Result, anyhow, bail};
use nalgebra::Point2;
#[cfg(not(target_family = "wasm"))]
use png::{BitDepth, ColorType, Decoder, Transformations};

use crate::world::files;
use crate::world::grid::{Axes, Grid, check_cells};

/// The longest file, bytes.
const MOST_BYTES: u64 = 1 << 27;

/// Reads a file by the end of its name: `.png`, `.asc`, `.tif` or `.tiff`. An image is stretched over a rectangle. Also
/// what the file says of its coordinates.
///
/// # Errors
/// What was expected.
pub fn read(path: &Path, rectangle: [Point2<f64>; 2]) -> Result<(Grid, Option<Axes>)> {
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let is_tiff = ending == "tif" || ending == "tiff";
    if !is_tiff && ending != "png" && ending != "asc" {
        bail!("a PNG image (.png), an ESRI ASCII grid (.asc) or a GeoTIFF (.tif)");
    }
    let found = files::size(path).filter(|it| *it <= MOST_BYTES);
    found.with_context(|| format!("a file, of {} MB at most", MOST_BYTES >> 20))?;
    if ending == "asc" {
        let text = files::open(path).and_then(io::read_to_string);
        let text = text.map_err(|why| anyhow!("a text file: {why}"))?;
        let grid = ascii(&text).map_err(|why| anyhow!("an ESRI ASCII grid: {why:#}"))?;
        Ok((grid, None))
    } else if is_tiff {
        tiff(path).map_err(|why| anyhow!("a GeoTIFF: {why:#}"))
    } else {
        let grid = image(path, rectangle).map_err(|why| anyhow!("a PNG image: {why:#}"))?;
        Ok((grid, None))
    }
}

#[cfg(target_family = "wasm")]
use in_a_browser::{image, tiff};

/// What reads these there would be a seventh of the page. The page itself brings images to a grid.
#[cfg(target_family = "wasm")]
mod in_a_browser {
    use super::{Axes, Grid, Path, Point2, Result, bail};

    pub(super) fn tiff(_: &Path) -> Result<(Grid, Option<Axes>)> {
        bail!("a browser reads none, but an ESRI ASCII grid (.asc)")
    }

    pub(super) fn image(path: &Path, _: [Point2<f64>; 2]) -> Result<Grid> {
        tiff(path).map(|it| it.0)
    }
}

#[cfg(not(target_family = "wasm"))]
fn tiff(path: &Path) -> Result<(Grid, Option<Axes>)> {
    crate::world::geotiff::read(BufReader::new(files::open(path)?))
}

/// The luminance of each pixel, as the file has it: up to 255, with 16 bits up to 65535.
#[cfg(not(target_family = "wasm"))]
fn image(path: &Path, [min, max]: [Point2<f64>; 2]) -> Result<Grid> {
    let mut decoder = Decoder::new(BufReader::new(files::open(path)?));
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info()?;
    let [columns, rows] = [reader.info().width, reader.info().height].map(|it| it as usize);
    check_cells(columns, rows)?;
    let mut bytes = vec![0; reader.output_buffer_size().context("it is too large")?];
    let frame = reader.next_frame(&mut bytes)?;
    bytes.truncate(frame.buffer_size());
    let samples: Vec<f64> = if frame.bit_depth == BitDepth::Sixteen {
        let pairs = bytes.chunks_exact(2);
        pairs.map(|pair| u16::from_be_bytes([pair[0], pair[1]]).into()).collect()
    } else {
        bytes.into_iter().map(f64::from).collect()
    };
    let pixels = samples.chunks_exact(frame.color_type.samples());
    let values = pixels.map(|pixel| match (frame.color_type, pixel) {
        (ColorType::Rgb | ColorType::Rgba, [red, green, blue, ..]) => {
            // The weights of Rec. 709, so that grey keeps its value.
            (2126.0 * red + 7152.0 * green + 722.0 * blue) / 10_000.0
        }
        _ => pixel[0],
    });
    let values = values.collect();
    let size = max - min;
    Ok(Grid { corner: min, cell: [size.x / columns as f64, size.y / rows as f64], columns, values })
}

/// A grid as text: keys with their values, then the cells.
fn ascii(text: &str) -> Result<Grid> {
    let mut words = text.split_ascii_whitespace().peekable();
    let [mut columns, mut rows] = [None; 2];
    let (mut cell, mut missing) = ([None; 2], None);
    let mut corner = [None; 2];
    // A cell may be nan.
    let is_key = |word: &&str| {
        word.starts_with(|c: char| c.is_ascii_alphabetic()) && word.parse::<f64>().is_err()
    };
    while let Some(key) = words.next_if(is_key) {
        let key = key.to_ascii_lowercase();
        let word = words.next().with_context(|| format!("found {key} without a value"))?;
        let number: f64 =
            word.parse().map_err(|_| anyhow!("found {key} {word}, expected a number"))?;
        let count =
            || word.parse::<usize>().map_err(|_| anyhow!("found {key} {word}, expected a count"));
        match key.as_str() {
            "ncols" => columns = Some(count()?),
            "nrows" => rows = Some(count()?),
            "xllcorner" => corner[0] = Some((number, 0.0)),
            "yllcorner" => corner[1] = Some((number, 0.0)),
            "xllcenter" => corner[0] = Some((number, 0.5)),
            "yllcenter" => corner[1] = Some((number, 0.5)),
            "cellsize" => cell = [Some(number); 2],
            "dx" => cell[0] = Some(number),
            "dy" => cell[1] = Some(number),
            "nodata_value" => missing = Some(number),
            _ => bail!(
                "found {key}, expected ncols, nrows, xllcorner, yllcorner, cellsize (or dx and dy) or nodata_value"
            ),
        }
    }
    let columns = columns.context("expected ncols")?;
    let rows = rows.context("expected nrows")?;
    let [Some(dx), Some(dy)] = cell.map(|it| it.filter(|it| (1e-6..=1e6).contains(it))) else {
        bail!("expected a cellsize in metres, above 0");
    };
    let cell = [dx, dy];
    check_cells(columns, rows)?;
    let least = |axis: usize, name| {
        let (at, cells) = corner[axis].with_context(|| format!("expected {name}"))?;
        if f64::abs(at) <= 1e8 {
            Ok(at - cells * cell[axis])
        } else {
            bail!("found {name} {at}, expected up to 1e8 m")
        }
    };
    let corner = Point2::new(least(0, "xllcorner")?, least(1, "yllcorner")?);
    let value = |word: &str| match word.parse::<f64>() {
        Ok(value) if Some(value) == missing => Ok(f64::NAN),
        Ok(value) => Ok(value),
        Err(_) => bail!("found {word}, expected a number"),
    };
    let values = words.map(value).collect::<Result<Vec<_>>>()?;
    if values.len() != columns * rows {
        bail!("found {} values, expected {columns} x {rows}", values.len());
    }
    Ok(Grid { corner, cell, columns, values })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ascii_grid_is_read() {
        let text = "NCOLS 3\nnrows 2\nxllcenter 10.5\nYLLCORNER -2\ncellsize 1\nNODATA_value -9999\n1 2 3\n4 -9999 6.5\n";
        let grid = ascii(text).unwrap();
        assert_eq!((grid.corner, grid.cell, grid.columns), (Point2::new(10.0, -2.0), [1.0; 2], 3));
        assert_eq!(grid.values[..4], [1.0, 2.0, 3.0, 4.0]);
        assert!(grid.values[4].is_nan() && grid.values[5..] == [6.5]);
        for (good, bad, said) in [
            ("NCOLS 3\n", "", "expected ncols"),
            ("nrows 2", "nrows two", "found nrows two"),
            ("nrows 2", "nrows 2.5", "expected a count"),
            ("nrows 2", "nrows 3", "found 6 values, expected 3 x 3"),
            ("nrows 2", "nrows 0", "found 3 x 0 cells"),
            ("nrows 2", "nrows 99999999999999999999", "expected a count"),
            ("nrows 2", "nrows 9999999", "expected 1 to 4000000"),
            ("xllcenter 10.5\n", "", "expected xllcorner"),
            ("YLLCORNER -2", "YLLCORNER 2e8", "expected up to 1e8 m"),
            ("cellsize 1", "cellsize 0", "expected a cellsize in metres"),
            ("cellsize 1", "dx 1 dz 2", "found dz, expected ncols"),
            ("cellsize 1", "dx 1", "expected a cellsize in metres"),
            ("6.5", "six", "found six, expected a number"),
            ("6.5", "", "found 5 values"),
        ] {
            assert!(text.contains(good), "{good}");
            let error = ascii(&text.replace(good, bad)).unwrap_err().to_string();
            assert!(error.contains(said), "{bad}: {error}");
        }
    }
}
