//! `join`: the maps of several robots on one front, as one map.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use anyhow::{Result, bail};
use clap::Args;

use crate::cli::format::Format;
use crate::cli::help;
use crate::cli::replay::write;
use crate::output::file::prepare;
use crate::output::notes::warn;
use crate::replay::joined::JoinedMap;
use crate::world::crs::Crs;

#[derive(Debug, Args)]
#[command(after_help = help::JOIN)]
pub(crate) struct JoinArgs {
    /// The maps, as --map of run, hil, fly and replay --front writes them
    #[arg(value_name = "MAP.csv", required = true, num_args = 2..)]
    pub(crate) maps: Vec<PathBuf>,
    /// The coordinate system of positions in metres, such as EPSG:25832 (UTM zone 32), to place them on a map
    #[arg(long, value_name = "EPSG:N", value_parser = Crs::from_str)]
    pub(crate) crs: Option<Crs>,
    /// Write the joined map here, a row for each place on it
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) map: Option<PathBuf>,
    /// Write a figure here
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) figure: Option<PathBuf>,
    /// Write the joined map for a map here; positions are to be latitude and longitude, or metres with --crs
    #[arg(long, value_name = "FILE.geojson")]
    pub(crate) geojson: Option<PathBuf>,
    /// What to print
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

/// Joins them, and what to print.
pub(crate) fn join(args: &JoinArgs) -> Result<String> {
    let inputs: Vec<(&str, &Path)> = args.maps.iter().map(|it| ("a map", &**it)).collect();
    let asked = [
        ("--map", args.map.as_deref()),
        ("--figure", args.figure.as_deref()),
        ("--geojson", args.geojson.as_deref()),
    ];
    let [map, figure, geojson] = prepare(&inputs, asked)?;
    let real = |it: &PathBuf| it.canonicalize().unwrap_or_else(|_| it.clone());
    let files: Vec<PathBuf> = args.maps.iter().map(real).collect();
    for (number, (map, file)) in args.maps.iter().zip(&files).enumerate() {
        if files[..number].contains(file) {
            bail!("{}: found twice, expected a map of another robot", map.display());
        }
    }
    let joined = JoinedMap::read(&args.maps, args.crs.as_ref())?;
    let (text, warning) = write(&joined, [figure, geojson, map], args.format)?;
    if let Some(why) = warning {
        warn("join", why);
    }
    Ok(text)
}
