//! `replay`: what samples recorded elsewhere determine.

use std::path::PathBuf;
use std::str::FromStr;

use anyhow::{Context as _, Result, anyhow};
use clap::Args;
use planner_core::Front;

use crate::cli::done::Done;
use crate::cli::format::Format;
use crate::cli::help;
use crate::mission::scenario;
use crate::output::file::{Output, prepare};
use crate::output::notes::warn;
use crate::output::plain;
use crate::replay::Report;
use crate::replay::answer::Trust;
use crate::replay::columns::Columns;
use crate::replay::front::FrontMap;
use crate::replay::line::Replay;
use crate::replay::rows::Layout;
use crate::replay::table_file;
use crate::world::crs::Crs;
use crate::world::errors::Errors;

#[derive(Debug, Args)]
#[command(after_help = help::REPLAY)]
pub(crate) struct ReplayArgs {
    /// The samples: a CSV file, a map of points (`.geojson`), GPX, or a trace of ours. A CSV file has the columns x, z
    /// (metres) or lat, lon (degrees), and label
    pub(crate) samples: PathBuf,
    /// The file's columns by title or number, as x=easting,z=northing,label=wet or lat=3,lon=4,label=7; for a map of
    /// points the property, and for GPX the element, that contains the label, as label=wet
    #[arg(long, value_name = "LIST", value_parser = Columns::from_str)]
    pub(crate) columns: Option<Columns>,
    /// The delimiter between columns, if it is not clear: comma, semicolon, tab, pipe, space
    #[arg(long, value_name = "NAME", value_parser = table_file::delimiter)]
    pub(crate) delimiter: Option<u8>,
    /// Labels are measured values: above this they are +1, else -1
    #[arg(long, value_name = "V", value_parser = threshold)]
    pub(crate) threshold: Option<f64>,
    /// Refuse a row without a position or a label; else such rows are skipped and counted. Also end with exit status 1
    /// if no straight line explains the labels, or --p is too high for them, or with --front if the front is not known in
    /// the end; else a warning says so
    #[arg(long)]
    pub(crate) strict: bool,
    /// The coordinate system of positions in metres, such as EPSG:25832 (UTM zone 32), to place them on a map
    #[arg(long, value_name = "EPSG:N", value_parser = Crs::from_str)]
    pub(crate) crs: Option<Crs>,
    /// Take positions about this place, in the file's own coordinates; the middle of the data where they are far away
    #[arg(long, value_name = "X,Z", value_parser = origin)]
    pub(crate) origin: Option<[f64; 2]>,
    /// Labels are true with this probability, above 0.5
    #[arg(long, value_name = "P", value_parser = probability)]
    pub(crate) p: Option<f64>,
    /// Positions may be off by so many metres
    #[arg(long, value_name = "METRES", value_parser = tolerance)]
    pub(crate) tolerance: Option<f64>,
    /// Map a front that bends and moves along the rows, as a recorded track: a radius, metres, of which only inf (straight)
    /// has an effect, and how far it may move from one row to the next, metres
    #[arg(long, value_name = "RADIUS[,SPEED]", value_parser = front)]
    pub(crate) front: Option<Front>,
    /// Write a figure here
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) figure: Option<PathBuf>,
    /// Write the answer for a map here; positions are to be latitude and longitude, or metres with --crs
    #[arg(long, value_name = "FILE.geojson")]
    pub(crate) geojson: Option<PathBuf>,
    /// Write the map of the front here, a row for each place on it
    #[arg(long, value_name = "FILE.csv", requires = "front")]
    pub(crate) map: Option<PathBuf>,
    /// What to print
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

fn origin(text: &str) -> Result<[f64; 2]> {
    let number = |part: &str| part.trim().parse::<f64>().ok().filter(|value| value.is_finite());
    let pair = text.split_once(',').and_then(|(a, b)| Some([number(a)?, number(b)?]));
    pair.context("expected two numbers with a comma between")
}

fn threshold(text: &str) -> Result<f64> {
    let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
    value.context("expected a finite number")
}

fn probability(text: &str) -> Result<f64> {
    scenario::told("--p", text.parse()?)
}

fn tolerance(text: &str) -> Result<f64> {
    scenario::position("--tolerance", Some(text.parse()?), Errors::default())
}

fn front(text: &str) -> Result<Front> {
    let (radius, speed) = text.split_once(',').unwrap_or((text, "0"));
    let number = |what, part: &str| {
        let number = part.trim().parse::<f64>();
        number.map_err(|_| anyhow!("found {part:?} for {what}, expected metres, as 40 or 40,0.02"))
    };
    let (radius, speed) = (number("the radius", radius)?, number("the speed", speed)?);
    let front = if radius == f64::INFINITY { Ok(Front::STRAIGHT) } else { Front::bending(radius) };
    let front = front.and_then(|front| front.moving(speed));
    front.map_err(|why| anyhow!("found {text}, expected metres, as 40 or 40,0.02 ({why})"))
}

/// The exit status if no straight line explains the labels, or no front is known, and `--strict` asks for one.
const UNEXPLAINED: u8 = 1;

/// Reads them, and what to print.
pub(crate) fn replay(args: &ReplayArgs) -> Result<Done> {
    let asked = [
        ("--figure", args.figure.as_deref()),
        ("--geojson", args.geojson.as_deref()),
        ("--map", args.map.as_deref()),
    ];
    let outputs = prepare(&[("the samples", &args.samples)], asked)?;
    let layout = Layout {
        columns: args.columns.clone(),
        delimiter: args.delimiter,
        origin: args.origin,
        crs: args.crs.clone(),
        threshold: args.threshold,
        strict: args.strict,
        keeps: args.geojson.is_some(),
    };
    let trust = Trust { p: args.p, tolerance: args.tolerance.unwrap_or(0.0) };
    let said: Box<dyn Report> = match args.front {
        Some(front) => Box::new(FrontMap::read(&args.samples, &layout, front, trust)?),
        None => Box::new(Replay::read(&args.samples, &layout, trust)?),
    };
    let (text, warning) = write(&*said, outputs, args.format)?;
    let name = plain::name(&args.samples.display().to_string());
    let failure = match warning {
        Some(why) if args.strict => Some((anyhow!("{name}: {why}"), UNEXPLAINED)),
        Some(why) => {
            warn(name, why);
            None
        }
        None => None,
    };
    Ok(Done { text, failure })
}

/// Writes a report as a figure, for a map and as a file of vertices, each if it is wanted. Returns what to print, and why
/// not to rely on it. All is made before anything is written.
pub(crate) fn write(
    said: &dyn Report,
    [figure, geojson, map]: [Option<Output>; 3],
    format: Format,
) -> Result<(String, Option<String>)> {
    let contents = [
        figure.map(|to| anyhow::Ok((to, said.figure()?))).transpose()?,
        geojson.map(|to| anyhow::Ok((to, said.geojson()?))).transpose()?,
        map.map(|to| anyhow::Ok((to, said.csv()?))).transpose()?,
    ];
    let text = match format {
        Format::Text => said.words(),
        Format::Json => said.json(),
    };
    for (output, content) in contents.into_iter().flatten() {
        output.write(content)?;
    }
    Ok((text, said.warning()))
}
