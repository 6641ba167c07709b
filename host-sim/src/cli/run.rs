//! `run`: one mission.

use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use anyhow::{Context as _, Result, anyhow, bail};
use clap::{Args, ValueEnum};

use crate::cli::campaign_flags::check_once;
use crate::cli::done::{Done, REFUSED};
use crate::cli::help;
use crate::mission::algorithm::Algorithm;
use crate::mission::definition::Mission;
use crate::mission::recording::Recording;
use crate::mission::scenario::{self, Overrides};
use crate::mission::setting::Setting;
use crate::mission::trace;
use crate::output::file::{Output, prepare, prepare_all};
use crate::output::plain;
use crate::report::examples::{Flown, side_by_side};
use crate::report::live::{Address, Live, USUAL};
use crate::report::page::{Chapter, Page};
use crate::report::picture::Picture;
use crate::report::pieces::Pieces;
use crate::report::{flat, log, on_map, text};

#[derive(Debug, Args)]
pub(crate) struct Run {
    /// The mission, a TOML file
    pub(crate) scenario: PathBuf,
    /// Who plans [default: the file's]
    #[arg(long)]
    pub(crate) algorithm: Option<Algorithm>,
    /// Steps at most, 1 to 10000, and fewer where labels may be wrong [default: the file's]
    #[arg(long)]
    pub(crate) steps: Option<u32>,
    /// Seed of whatever is random [default: the file's]
    #[arg(long)]
    pub(crate) seed: Option<u64>,
    /// Any key of the scenario, as noise.p=0.9; as often as there are keys
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<Setting>,
    /// Write the trace here, as JSON Lines
    #[arg(long, value_name = "FILE.jsonl")]
    pub(crate) trace: Option<PathBuf>,
    /// Write a figure here
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) figure: Option<PathBuf>,
    /// Write a figure of the lines with the fewest violations here (scc)
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) candidates: Option<PathBuf>,
    /// Write a page to step through the mission here
    #[arg(long, value_name = "FILE.html")]
    pub(crate) report: Option<PathBuf>,
    /// Write a log for Foxglove, Rerun or `PlotJuggler` here
    #[arg(long, value_name = "FILE.mcap")]
    pub(crate) mcap: Option<PathBuf>,
    /// Write the map of the front here, a row for each place on it (track)
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) map: Option<PathBuf>,
    /// Write track, samples and what was found here, in an area from a map
    #[arg(long, value_name = "FILE.geojson")]
    pub(crate) geojson: Option<PathBuf>,
    /// The same as tracks and waypoints, for chart plotters and phones
    #[arg(long, value_name = "FILE.gpx")]
    pub(crate) gpx: Option<PathBuf>,
    /// Serve the page while the mission is flown, here or at [HOST:]PORT; port 0 takes any [default: 127.0.0.1:8043]
    #[arg(
        long,
        value_name = "ADDRESS",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = USUAL
    )]
    pub(crate) live: Option<Address>,
    /// What to print
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For people
    #[default]
    Text,
    /// The trace, for programs
    Json,
    /// A line a step without lists, for data frames
    Flat,
}

#[derive(Debug, Args)]
#[command(after_help = help::RUN)]
pub(crate) struct RunArgs {
    #[command(flatten)]
    run: Run,
    /// Who plans, one after the other from the same start: the page shows them in step
    #[arg(
        long,
        value_enum,
        value_name = "PLANNER,...",
        value_delimiter = ',',
        requires = "report",
        conflicts_with_all = ["algorithm", "trace", "figure", "candidates", "mcap", "map", "geojson", "gpx", "live"]
    )]
    compare: Vec<Algorithm>,
    /// Time between steps with --live, 0 to 3600 [default: 1]
    #[arg(long, value_name = "SECONDS", requires = "live", value_parser = pace)]
    pace: Option<Duration>,
}

fn pace(text: &str) -> Result<Duration> {
    let found = text.parse().ok().filter(|it| (0.0..=3600.0).contains(it));
    found.map(Duration::from_secs_f64).ok_or_else(|| anyhow!("expected seconds, 0 to 3600"))
}

/// Flies it, and what to print.
pub(crate) fn run(args: &RunArgs) -> Result<Done> {
    let RunArgs { run, compare, pace } = args;
    if !compare.is_empty() {
        return run.compare(compare);
    }
    let mission = run.mission()?;
    let mut live = run.live(&mission)?;
    let outputs = prepare_all(&[run.input()], &run.outputs())?;
    let pace = pace.unwrap_or(Duration::from_secs(1));
    let pause = |live: &Option<Live>| live.is_some().then(|| thread::sleep(pace));
    pause(&live);
    let (recording, refusal) = Recording::until_refusal_watched(&mission, |recorder| {
        if let Some(live) = &mut live {
            live.step(recorder);
        }
        pause(&live);
    });
    if let Some(live) = &mut live {
        if let Some(why) = &refusal {
            live.say(why);
        }
        live.end(&recording);
    }
    let text = run.tell(outputs, &recording)?;
    Ok(run.done(text, refusal))
}

/// Where a file goes that a mission writes.
type Place = fn(&Run) -> &Option<PathBuf>;

/// What is in it.
type Make = fn(&Run, &Recording) -> Result<Vec<u8>>;

/// The files that a mission writes, each with its flag.
const OUTPUTS: [(&str, Place, Make); 8] = [
    ("--trace", |run| &run.trace, |_, it| Ok(trace::lines(&it.results).into())),
    ("--figure", |run| &run.figure, |run, it| Ok(Picture::of(&run.title(), it).svg().into())),
    (
        "--candidates",
        |run| &run.candidates,
        |run, it| {
            let fewest = Picture::of_candidates(&run.title(), it);
            Ok(fewest.context("--candidates: found no hypotheses")?.svg().into())
        },
    ),
    ("--report", |run| &run.report, |run, it| Ok(page(&run.title(), &[it]).into())),
    ("--mcap", |run| &run.mcap, |_, it| log::mcap(it)),
    ("--map", |run| &run.map, |_, it| Ok(Pieces::of(&it.results).csv("step", None, &[])?.into())),
    ("--geojson", |run| &run.geojson, |_, it| Ok(on_map::geojson(it)?.into())),
    ("--gpx", |run| &run.gpx, |run, it| Ok(on_map::gpx(&run.title(), it)?.into())),
];

/// A page of missions that were flown from the same start, under the scenario's name.
fn page(scenario: &str, recordings: &[&Recording]) -> String {
    let planners: Vec<_> = recordings.iter().map(|it| it.mission.algorithm.title()).collect();
    let title = format!("Flown by {}", planners.join(", "));
    let flights = planners.into_iter().zip(recordings.iter().copied());
    Page::new(scenario, vec![Chapter::new(title, flights)]).html()
}

impl Run {
    pub(crate) fn name(&self) -> String {
        plain::name(&self.scenario.display().to_string())
    }

    /// What figures and pages are called.
    fn title(&self) -> String {
        plain::name(&self.scenario.file_stem().unwrap_or_default().to_string_lossy())
    }

    /// The live page of a mission, if one is asked for.
    pub(crate) fn live(&self, mission: &Mission) -> Result<Option<Live>> {
        self.live.as_ref().map(|it| Live::open(it, &self.title(), mission)).transpose()
    }

    pub(crate) fn mission(&self) -> Result<Mission> {
        self.mission_by(self.algorithm, scenario::read)
    }

    /// The mission as this one plans it, or who the file names, by a way to read the file.
    pub(crate) fn mission_by(
        &self,
        algorithm: Option<Algorithm>,
        read: fn(&Path, Overrides<'_>) -> Result<Mission>,
    ) -> Result<Mission> {
        let &Self { steps, seed, ref set, .. } = self;
        let mission = read(&self.scenario, Overrides { algorithm, steps, seed, set })?;
        if self.candidates.is_some() && !mission.is_noisy() {
            bail!("--candidates: found a mission without noise, expected one with noisy labels");
        }
        if self.map.is_some() && mission.algorithm.seeks_line() {
            let planner = mission.algorithm.name();
            bail!("--map: found algorithm {planner}, expected track, which maps a front");
        }
        let of_map = [("--geojson", self.geojson.is_some()), ("--gpx", self.gpx.is_some())];
        let asked = of_map.into_iter().find(|(_, is_asked)| *is_asked && mission.lake.is_none());
        if let Some((flag, _)) = asked {
            bail!("{flag}: found an area in metres, expected one from a map (area.geojson)");
        }
        mission.warn(&self.name());
        Ok(mission)
    }

    /// Flies the mission by each of these, and writes the page that shows them; what to print.
    fn compare(&self, planners: &[Algorithm]) -> Result<Done> {
        check_once(planners)?;
        let mission = |&planner: &Algorithm| {
            let mission = self
                .mission_by(Some(planner), scenario::read)
                .with_context(|| format!("--compare {}", planner.name()))?;
            if mission.noise.is_some() && !mission.is_noisy() {
                let (name, planner) = (self.name(), planner.name());
                bail!("{name}: noise: found --compare {planner}, which takes labels to be true");
            }
            Ok(mission)
        };
        let missions = planners.iter().map(mission).collect::<Result<Vec<_>>>()?;
        let [report] = prepare(&[self.input()], [("--report", self.report.as_deref())])?;
        let name = self.name();
        let flown = missions.iter().map(Recording::until_refusal);
        let (recordings, refusals): (Vec<_>, Vec<_>) = flown.unzip();
        let refusals = planners.iter().zip(refusals).filter_map(|(planner, refusal)| {
            refusal.map(|it| format!("--compare {}: {it:#}", planner.name()))
        });
        let refusals = refusals.collect::<Vec<_>>();
        let refusal = (!refusals.is_empty()).then(|| anyhow!(refusals.join("; ")));
        let page = page(&self.title(), &recordings.iter().collect::<Vec<_>>());
        if let Some(report) = report {
            report.write(page)?;
        }
        let text = match self.format {
            Format::Text => side_by_side(recordings.iter().map(|recording| Flown {
                example: &name,
                planner: recording.mission.algorithm.title(),
                is_printed: false,
                recording,
            })),
            Format::Json => recordings.iter().map(|it| trace::lines(&it.results)).collect(),
            Format::Flat => recordings.iter().map(|it| flat::lines(&it.results)).collect(),
        };
        Ok(self.done(text, refusal))
    }

    /// What was done, and the refusal that broke the mission off, if one did.
    pub(crate) fn done(&self, text: String, refusal: Option<anyhow::Error>) -> Done {
        let name = self.name();
        let failure = refusal.map(|it| (anyhow!("{name}: {it:#}"), REFUSED));
        Done { text, failure }
    }

    pub(crate) fn input(&self) -> (&'static str, &Path) {
        ("the scenario", &self.scenario)
    }

    pub(crate) fn outputs(&self) -> Vec<(&'static str, Option<&Path>)> {
        OUTPUTS.iter().map(|(flag, path, _)| (*flag, path(self).as_deref())).collect()
    }

    /// Writes the files that were asked for, in the order of [`outputs`](Self::outputs); what to print.
    pub(crate) fn tell(
        &self,
        outputs: impl IntoIterator<Item = Option<Output>>,
        recording: &Recording,
    ) -> Result<String> {
        let asked = outputs.into_iter().zip(OUTPUTS);
        let made = asked.filter_map(|(output, (.., make))| Some((output?, make(self, recording))));
        // All is made before anything is written.
        for (output, content) in
            made.map(|(it, made)| Ok((it, made?))).collect::<Result<Vec<_>>>()?
        {
            output.write(content)?;
        }
        let (name, lines) = (self.name(), trace::lines(&recording.results));
        Ok(match self.format {
            Format::Text => text::mission(&name, &recording.results),
            Format::Json => lines,
            Format::Flat => flat::lines(&recording.results),
        })
    }
}
