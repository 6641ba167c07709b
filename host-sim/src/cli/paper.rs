//! The bare command: the paper's two examples. Each is flown as printed, as the planners here fly it by default, and by
//! look-ahead.

use std::path::Path;

use anyhow::Result;

use crate::mission::definition::Mission;
use crate::mission::recording::Recording;
use crate::mission::scenario::{self, Overrides};
use crate::output::file::{make_folder, prepare};
use crate::report::examples::{Flown, side_by_side};
use crate::report::page::{Chapter, Page};
use crate::report::picture::Picture;
use crate::report::text;

/// A flight of one of the examples.
pub struct Flight {
    /// The example, for titles.
    example: &'static str,
    /// The scenario file's text.
    scenario: &'static str,
    /// Who flies it.
    planner: &'static str,
    /// How the mission is changed.
    change: fn(Mission) -> Mission,
    /// Whether it is the paper's own, to be told step by step with the paper's estimate first.
    is_printed: bool,
    /// The file of its figure, in `out/`.
    pub figure: &'static str,
}

/// The page that steps through all flights, in `out/`.
const REPORT: &str = "report.html";

const REPORT_TITLE: &str = "The paper's two examples";

const NOISELESS: &str = "The paper's noiseless example (Section V)";
const NOISY: &str = "The paper's noisy example (Section V)";

/// All flights, in the order in which they are told.
pub const FLIGHTS: [Flight; 6] = [
    Flight {
        example: NOISELESS,
        scenario: scenario::PAPER_NOISELESS,
        planner: "Algorithm 1 as printed",
        change: Mission::as_printed,
        is_printed: true,
        figure: "paper-noiseless.svg",
    },
    Flight {
        example: NOISELESS,
        scenario: scenario::PAPER_NOISELESS,
        planner: "Algorithm 1, defaults",
        change: |mission| mission,
        is_printed: false,
        figure: "paper-noiseless-defaults.svg",
    },
    Flight {
        example: NOISELESS,
        scenario: scenario::PAPER_NOISELESS,
        planner: "look-ahead",
        change: Mission::by_lookahead,
        is_printed: false,
        figure: "paper-noiseless-lookahead.svg",
    },
    Flight {
        example: NOISY,
        scenario: scenario::PAPER_NOISY,
        planner: "Algorithm 2 as printed",
        change: Mission::as_printed,
        is_printed: true,
        figure: "paper-noisy.svg",
    },
    Flight {
        example: NOISY,
        scenario: scenario::PAPER_NOISY,
        planner: "Algorithm 2, defaults",
        change: |mission| mission,
        is_printed: false,
        figure: "paper-noisy-defaults.svg",
    },
    Flight {
        example: NOISY,
        scenario: scenario::PAPER_NOISY,
        planner: "look-ahead",
        change: Mission::by_lookahead,
        is_printed: false,
        figure: "paper-noisy-lookahead.svg",
    },
];

/// What the names in the table mean.
const NAMES: &str = "\
As printed, P2 takes any slope that is left, and all label sequences are alike beforehand. By default Algorithm 1 holds
P2 to the bisector of the slopes left, and Algorithm 2 weighs sequences by the measure of their lines.
Look-ahead makes the motion whose label, and the one after it, tell the most for their cost.";

/// How to read the noiseless example.
const ONE_DRAW: &str = "\
In this draw Algorithm 1's default is nearer in slope by chance, as it knows 4.6 bits less. Over 1,000 random fields
look-ahead is nearer.";

/// By how much, and what the paper came to itself.
const PAPER: &str = "\
Its slope is 1.07 deg off (median) to 1.35 after 10 steps, and 0.033 to 0.17 after 20.
The paper's own runs, from points and labels that are not known: noiseless, slope 20.8 deg (1.5 off) and intercept
3.6 m (0.1 off); noisy, slope 18.42 to 25.81 deg and intercept 3.12 to 3.76 m with probability 0.84.";

/// What the printed noisy example leaves open, in a figure of its own.
const CANDIDATES: &str = "paper-noisy-candidates.svg";

const CANDIDATES_TITLE: &str = "Its labels do not tell which line is true: fewest violations";

impl Flight {
    fn title(&self) -> String {
        format!("{}, {}", self.example, self.planner)
    }

    /// Flies it.
    ///
    /// # Errors
    /// Never: the examples are sound.
    pub fn fly(&self) -> Result<Recording> {
        let mission = scenario::parse("", self.scenario, Overrides::default())?;
        Recording::of(&(self.change)(mission))
    }

    /// Its figure.
    pub fn picture(&self, recording: &Recording) -> Picture {
        let picture = Picture::of(&self.title(), recording);
        if self.is_printed { picture.with_printed_estimate(recording) } else { picture }
    }

    fn told(&self, recording: &Recording) -> String {
        let tell = if self.is_printed { text::printed } else { text::outcome_alone };
        tell(&self.title(), &recording.results)
    }
}

/// Flies all, writes their figures, and tells what came of them.
pub(crate) fn tell() -> Result<String> {
    const FIGURES: usize = FLIGHTS.len() + 1;
    make_folder("", Path::new("out"))?;
    let names: [_; FIGURES + 1] = std::array::from_fn(|k| match k {
        FIGURES => REPORT,
        _ => FLIGHTS.get(k).map_or(CANDIDATES, |flight| flight.figure),
    });
    let places = names.map(|name| (name, Path::new("out").join(name)));
    let asked = places.each_ref().map(|(name, path)| (*name, Some(path.as_path())));
    let outputs = prepare(&[], asked)?;
    let recordings = FLIGHTS.iter().map(Flight::fly).collect::<Result<Vec<_>>>()?;
    let flights = || FLIGHTS.iter().zip(&recordings);
    // All is drawn before anything is written.
    let mut figures: Vec<_> = flights().map(|(flight, it)| flight.picture(it)).collect();
    let printed = flights().filter(|(flight, _)| flight.is_printed);
    figures.extend(printed.filter_map(|(_, it)| Picture::of_candidates(CANDIDATES_TITLE, it)));
    let mut drawn: Vec<_> = figures.iter().map(Picture::svg).collect();
    drawn.push(page(&recordings));
    for (output, content) in outputs.into_iter().flatten().zip(drawn) {
        output.write(content)?;
    }
    let told: Vec<_> = flights().map(|(flight, it)| flight.told(it)).collect();
    let flown = flights().map(|(flight, recording)| Flown {
        example: flight.example,
        planner: flight.planner,
        is_printed: flight.is_printed,
        recording,
    });
    Ok(format!(
        "{}\n{}\n{NAMES}\n{ONE_DRAW}\n{PAPER}\n\nFigures in out/: {}\nTo step through all of them, open out/{REPORT} in a browser.\n",
        told.join("\n"),
        side_by_side(flown),
        names[..FIGURES].join(", ")
    ))
}

/// The page of all [`FLIGHTS`] as they went, those of an example side by side: look-ahead first, as printed last.
pub fn page(recordings: &[Recording]) -> String {
    let chapter = |(example, note): (_, Option<&str>)| {
        let flights =
            FLIGHTS.iter().zip(recordings).rev().filter(|(flight, _)| flight.example == example);
        let flights = flights.map(|(flight, recording)| (flight.planner, recording));
        Chapter::new(example, flights).noting(note)
    };
    let chapters = [(NOISELESS, Some(ONE_DRAW)), (NOISY, None)].map(chapter);
    Page::new(REPORT_TITLE, chapters.into()).html()
}
