//! `GeoTIFF` files: one band of values, in a frame whose axes are east and north.
//!
//! Of a file the first image is read. Tag numbers are those of TIFF, key numbers those of OGC's `GeoTIFF` 1.1.

use std::io::{Read, Seek};

use anyhow::{Context as _, Result, bail};
use nalgebra::Point2;
use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::{PhotometricInterpretation, PlanarConfiguration, Tag};

use crate::world::grid::{Axes, Grid, check_cells, check_size};

/// The directory of geographic keys has four numbers a key.
const KEY: usize = 4;

/// Latitudes and longitudes of WGS 84, ETRS89 and NAD83, which are two metres apart at most.
const GLOBES: [u16; 3] = [4326, 4258, 4269];

/// Reads a file, and what it says of its coordinates.
///
/// # Errors
/// What was found, and what was expected.
pub fn read(file: impl Read + Seek) -> Result<(Grid, Option<Axes>)> {
    let mut decoder = Decoder::new(file)?;
    let (width, height) = decoder.dimensions()?;
    let [columns, rows] = [width, height].map(|it| it as usize);
    check_cells(columns, rows)?;
    check_band(&mut decoder)?;
    let (is_of_points, axes) = keys(&mut decoder)?;
    let (corner, cell) = frame(&mut decoder, rows, is_of_points)?;
    let missing = missing(&mut decoder)?;
    let values = values(decoder.read_image()?, missing);
    if values.len() != columns * rows {
        bail!("found {} values, expected {columns} x {rows}", values.len());
    }
    Ok((Grid { corner, cell, columns, values }, axes))
}

/// The numbers of a tag; `None` if the file has none.
fn numbers<R: Read + Seek>(decoder: &mut Decoder<R>, tag: Tag) -> Result<Option<Vec<f64>>> {
    let found = decoder.find_tag(tag)?;
    let numbers = found.map(|it| it.into_f64_vec().with_context(|| format!("found {tag:?}")));
    numbers.transpose()
}

/// Whether a file has one band, whose values are as they are stored.
fn check_band<R: Read + Seek>(decoder: &mut Decoder<R>) -> Result<()> {
    let one = |it: Option<u16>, default| it.unwrap_or(default);
    let bands = one(decoder.find_tag_unsigned(Tag::SamplesPerPixel)?, 1);
    if bands != 1 {
        bail!("found {bands} bands, expected one");
    }
    let bits = one(decoder.find_tag_unsigned(Tag::BitsPerSample)?, 1);
    if ![8, 16, 32, 64].contains(&bits) {
        bail!("found values of {bits} bits, expected 8, 16, 32 or 64");
    }
    let plain = PhotometricInterpretation::BlackIsZero.to_u16();
    let shown = one(decoder.find_tag_unsigned(Tag::PhotometricInterpretation)?, plain);
    if shown != plain {
        bail!("found PhotometricInterpretation {shown}, expected {plain}, values as they are");
    }
    let chunky = PlanarConfiguration::Chunky.to_u16();
    let planes = one(decoder.find_tag_unsigned(Tag::PlanarConfiguration)?, chunky);
    if planes != chunky {
        bail!("found PlanarConfiguration {planes}, expected {chunky}");
    }
    Ok(())
}

/// The corner with the least coordinates, and the size of a cell.
fn frame<R: Read + Seek>(
    decoder: &mut Decoder<R>,
    rows: usize,
    is_of_points: bool,
) -> Result<(Point2<f64>, [f64; 2])> {
    if decoder.find_tag(Tag::ModelTransformationTag)?.is_some() {
        bail!("found ModelTransformation (34264), expected a frame that is not rotated");
    }
    let scale = numbers(decoder, Tag::ModelPixelScaleTag)?;
    let scale = scale.context("expected ModelPixelScale (33550): a plain TIFF has no place")?;
    let ties = numbers(decoder, Tag::ModelTiepointTag)?;
    let ties = ties.context("expected ModelTiepoint (33922): a plain TIFF has no place")?;
    let &[width, height, ..] = &scale[..] else {
        bail!("found ModelPixelScale {scale:?}, expected two numbers");
    };
    let cell = [width, height];
    check_size("ModelPixelScale", cell)?;
    let &[column, row, _, x, y, _] = &ties[..] else {
        bail!("found ModelTiepoint with {} numbers, expected one point, six numbers", ties.len());
    };
    // A point of the image is a cell's upper left corner, or its middle.
    let middle = if is_of_points { 0.5 } else { 0.0 };
    let left = x - (column + middle) * width;
    let top = y + (row + middle) * height;
    let corner = Point2::new(left, top - rows as f64 * height);
    if !(corner.x.abs() <= 1e8 && corner.y.abs() <= 1e8) {
        bail!("found its corner at ({}, {}), expected up to 1e8 m", corner.x, corner.y);
    }
    Ok((corner, cell))
}

/// Whether places are those of the cells' middles, and what coordinates are, by the geographic keys.
fn keys<R: Read + Seek>(decoder: &mut Decoder<R>) -> Result<(bool, Option<Axes>)> {
    const MODEL: u16 = 1024;
    const RASTER: u16 = 1025;
    const GLOBE: u16 = 2048;
    const ANGLES: u16 = 2054;
    const DEGREE: u16 = 9102;
    const SYSTEM: u16 = 3072;
    const UNITS: u16 = 3076;
    const METRE: u16 = 9001;
    /// A system that has no number.
    const OWN: u16 = 32767;
    let found = decoder.find_tag_unsigned_vec::<u16>(Tag::GeoKeyDirectoryTag)?;
    let directory = found.unwrap_or_default();
    // Those that are stored in the directory itself.
    let key = |number| {
        let mut all = directory.chunks_exact(KEY).skip(1);
        all.find(|key| key[..2] == [number, 0]).map(|key| key[3])
    };
    let axes = match key(MODEL) {
        Some(3) => bail!("found GTModelType 3, expected a map"),
        Some(2) => {
            let globe = key(GLOBE);
            if !globe.is_some_and(|it| GLOBES.contains(&it)) {
                let found = globe.map_or("none".to_owned(), |it| it.to_string());
                bail!("found latitude and longitude of GeodeticCRS {found}, expected 4326, WGS 84");
            }
            if let Some(unit) = key(ANGLES).filter(|it| *it != DEGREE) {
                bail!("found GeogAngularUnits {unit}, expected {DEGREE}, degrees");
            }
            Some(Axes::Degrees)
        }
        _ => key(SYSTEM).filter(|it| ![0, OWN].contains(it)).map(Axes::Metres),
    };
    if let Some(unit) = key(UNITS).filter(|it| *it != METRE) {
        bail!("found ProjLinearUnits {unit}, expected {METRE}, metres");
    }
    Ok((key(RASTER) == Some(2), axes))
}

/// The value that stands for none.
fn missing<R: Read + Seek>(decoder: &mut Decoder<R>) -> Result<Option<f64>> {
    let Some(found) = decoder.find_tag(Tag::GdalNodata)? else { return Ok(None) };
    let text = found.into_string().context("found GDAL_NODATA (42113)")?;
    let text = text.trim_matches(['\0', ' ']);
    let number = text.parse().ok();
    let number = number.with_context(|| format!("found GDAL_NODATA {text}, expected a number"))?;
    Ok(Some(number))
}

/// The values as numbers. What is missing is not a number.
fn values(found: DecodingResult, missing: Option<f64>) -> Vec<f64> {
    // The missing value may have more digits than the values can have.
    let narrow = missing.map(|it| f64::from(it as f32));
    let of = |value: f64, missing| if Some(value) == missing { f64::NAN } else { value };
    match found {
        DecodingResult::U8(all) => all.into_iter().map(|it| of(it.into(), missing)).collect(),
        DecodingResult::U16(all) => all.into_iter().map(|it| of(it.into(), missing)).collect(),
        DecodingResult::U32(all) => all.into_iter().map(|it| of(it.into(), missing)).collect(),
        DecodingResult::U64(all) => all.into_iter().map(|it| of(it as f64, missing)).collect(),
        DecodingResult::I8(all) => all.into_iter().map(|it| of(it.into(), missing)).collect(),
        DecodingResult::I16(all) => all.into_iter().map(|it| of(it.into(), missing)).collect(),
        DecodingResult::I32(all) => all.into_iter().map(|it| of(it.into(), missing)).collect(),
        DecodingResult::I64(all) => all.into_iter().map(|it| of(it as f64, missing)).collect(),
        DecodingResult::F16(all) => all.into_iter().map(|it| of(it.into(), missing)).collect(),
        DecodingResult::F32(all) => all.into_iter().map(|it| of(it.into(), narrow)).collect(),
        DecodingResult::F64(all) => all.into_iter().map(|it| of(it, missing)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use tiff::encoder::colortype::{ColorType, Gray8, Gray32Float, GrayI16, RGB8};
    use tiff::encoder::{Compression, DeflateLevel, TiffEncoder, TiffValue};

    use super::*;

    const SCALE: &[f64] = &[2.0, 3.0, 0.0];
    const TIE: &[f64] = &[0.0, 0.0, 0.0, 10.0, 20.0, 0.0];

    /// What a file has beside its values.
    #[derive(Clone, Copy)]
    struct Tags<'a> {
        scale: Option<&'a [f64]>,
        tie: Option<&'a [f64]>,
        turned: bool,
        keys: &'a [u16],
        missing: Option<&'a str>,
        compression: Compression,
    }

    const PLAIN: Tags = Tags {
        scale: Some(SCALE),
        tie: Some(TIE),
        turned: false,
        keys: &[],
        missing: None,
        compression: Compression::Uncompressed,
    };

    /// A file of two columns.
    fn file<C: ColorType>(tags: Tags, values: &[C::Inner]) -> Cursor<Vec<u8>>
    where
        [C::Inner]: TiffValue,
    {
        let mut file = Cursor::new(Vec::new());
        let encoder = TiffEncoder::new(&mut file).unwrap();
        let mut encoder = encoder.with_compression(tags.compression);
        let rows = (values.len() / 2 / C::BITS_PER_SAMPLE.len()) as u32;
        let mut image = encoder.new_image::<C>(2, rows).unwrap();
        let directory = image.encoder();
        if let Some(scale) = tags.scale {
            directory.write_tag(Tag::ModelPixelScaleTag, scale).unwrap();
        }
        if let Some(tie) = tags.tie {
            directory.write_tag(Tag::ModelTiepointTag, tie).unwrap();
        }
        if tags.turned {
            directory.write_tag(Tag::ModelTransformationTag, &[0.5; 16][..]).unwrap();
        }
        if !tags.keys.is_empty() {
            directory.write_tag(Tag::GeoKeyDirectoryTag, tags.keys).unwrap();
        }
        if let Some(missing) = tags.missing {
            directory.write_tag(Tag::GdalNodata, missing).unwrap();
        }
        image.write_data(values).unwrap();
        file.set_position(0);
        file
    }

    #[test]
    fn values_of_every_kind_are_read() {
        let tags = Tags { missing: Some("-9999"), ..PLAIN };
        let (grid, axes) = read(file::<GrayI16>(tags, &[1, 2, -9999, -4, 5, 6])).unwrap();
        assert_eq!(axes, None);
        assert_eq!(
            (grid.corner, grid.cell, grid.columns),
            (Point2::new(10.0, 11.0), [2.0, 3.0], 2)
        );
        assert!(grid.values[2].is_nan());
        assert_eq!((grid.values[1], grid.values[3], grid.values[5]), (2.0, -4.0, 6.0));
        for compression in [
            Compression::Uncompressed,
            Compression::Lzw,
            Compression::Deflate(DeflateLevel::default()),
            Compression::Packbits,
        ] {
            // More digits than a value of 32 bits can have.
            let tags = Tags { missing: Some("-0.1"), compression, ..PLAIN };
            let (grid, _) = read(file::<Gray32Float>(tags, &[0.5, 1.5, -0.1, 7.25])).unwrap();
            assert!(grid.values[2].is_nan());
            let others = [0, 1, 3].map(|k| grid.values[k].to_bits());
            assert_eq!(others, [0.5_f64, 1.5, 7.25].map(f64::to_bits));
        }
        let (grid, _) = read(file::<Gray8>(PLAIN, &[0, 255, 3, 4])).unwrap();
        assert_eq!(grid.values, [0.0, 255.0, 3.0, 4.0]);
    }

    #[test]
    fn the_frame_is_where_the_tags_say() {
        let corner = |tags| read(file::<Gray8>(tags, &[1, 2, 3, 4])).unwrap().0.corner;
        assert_eq!(corner(PLAIN), Point2::new(10.0, 14.0));
        // The same tie at another cell, and at the middle of a cell.
        let tie = Some(&[1.0, 2.0, 0.0, 12.0, 14.0, 0.0][..]);
        assert_eq!(corner(Tags { tie, ..PLAIN }), Point2::new(10.0, 14.0));
        let keys = &[1, 1, 0, 2, 1024, 0, 1, 1, 1025, 0, 1, 2][..];
        assert_eq!(corner(Tags { keys, ..PLAIN }), Point2::new(9.0, 15.5));
    }

    #[test]
    fn a_file_says_what_its_coordinates_are() {
        let axes = |keys: &[u16]| {
            let keys = &[&[1, 1, 0, 1], keys].concat();
            read(file::<Gray8>(Tags { keys, ..PLAIN }, &[1, 2, 3, 4])).unwrap().1
        };
        assert_eq!(axes(&[1024, 0, 1, 2, 2048, 0, 1, 4326]), Some(Axes::Degrees));
        assert_eq!(axes(&[1024, 0, 1, 1, 3072, 0, 1, 32635]), Some(Axes::Metres(32635)));
        // One of its own has no number.
        assert_eq!(axes(&[1024, 0, 1, 1, 3072, 0, 1, 32767]), None);
        assert_eq!(axes(&[1025, 0, 1, 1]), None);
    }

    #[test]
    fn what_is_not_understood_is_refused_by_name() {
        let refuses = |tags: Tags, said: &str| {
            let error = format!("{:#}", read(file::<Gray8>(tags, &[1, 2, 3, 4])).unwrap_err());
            assert!(error.contains(said), "{said}: {error}");
        };
        refuses(Tags { scale: None, ..PLAIN }, "expected ModelPixelScale (33550)");
        refuses(Tags { tie: None, ..PLAIN }, "expected ModelTiepoint (33922)");
        refuses(Tags { turned: true, ..PLAIN }, "found ModelTransformation (34264)");
        refuses(Tags { scale: Some(&[2.0, -3.0, 0.0]), ..PLAIN }, "found ModelPixelScale");
        refuses(Tags { tie: Some(&[0.0; 12]), ..PLAIN }, "with 12 numbers, expected one point");
        let far = Some(&[0.0, 0.0, 0.0, 5e8, 5.8e9, 0.0][..]);
        refuses(Tags { tie: far, ..PLAIN }, "found its corner at (500000000, 5799999994)");
        refuses(Tags { missing: Some("none"), ..PLAIN }, "found GDAL_NODATA none");
        for (keys, said) in [
            (&[1024, 0, 1, 2][..], "GeodeticCRS none, expected 4326"),
            (&[1024, 0, 1, 2, 2048, 0, 1, 4267], "GeodeticCRS 4267, expected 4326"),
            (&[1024, 0, 1, 2, 2048, 0, 1, 4326, 2054, 0, 1, 9101], "GeogAngularUnits 9101"),
            (&[1024, 0, 1, 3], "GTModelType 3"),
            (&[3076, 0, 1, 9002], "ProjLinearUnits 9002"),
        ] {
            refuses(Tags { keys: &[&[1, 1, 0, 1], keys].concat(), ..PLAIN }, said);
        }
        let error = read(file::<RGB8>(PLAIN, &[0; 12])).unwrap_err().to_string();
        assert_eq!(error, "found 3 bands, expected one");
        // JPEG, a compression that is not read.
        let mut bytes = file::<Gray8>(PLAIN, &[1, 2, 3, 4]).into_inner();
        let entry = [3, 1, 3, 0, 1, 0, 0, 0, 1, 0];
        let at = bytes.windows(entry.len()).position(|it| it == entry).expect("Compression");
        bytes[at + 8] = 7;
        let error = format!("{:#}", read(Cursor::new(bytes)).unwrap_err());
        assert!(error.contains("JPEG") || error.contains("ompression"), "{error}");
        // Cut short anywhere, it is an error and no panic.
        let whole = file::<Gray8>(PLAIN, &[1, 2, 3, 4]).into_inner();
        for length in 0..whole.len() {
            let _ = read(Cursor::new(whole[..length].to_vec()));
        }
    }
}
