//! A report in one file: a page that shows missions step by step, side by side if there are several.
//!
//! The file contains everything, and the page may load nothing: what it shows without a script, and the data from which a
//! script draws the scenes. The same page shows a mission that is still flown: then it asks the program that serves it for
//! the scenes, and for nothing else.

pub(crate) mod scene;
mod words;

use std::fmt::Write as _;

use nalgebra::Point2;
use serde::Serialize;

use crate::mission::definition::Mission;
use crate::mission::recording::Recording;
use crate::mission::results::Start;
use crate::report::page::scene::{Flight, MapPlace, Moved, Scene, Scenes};
use crate::report::page::words::{Told, minus, signed, small};
use crate::report::text;

const TEMPLATE: &str = include_str!("page.html");
const CONTROLS: &str = include_str!("controls.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: [&str; 4] = [
    include_str!("svg.js"),
    include_str!("map.js"),
    include_str!("charts.js"),
    include_str!("page.js"),
];
const LIVE_SCRIPT: &str = include_str!("live.js");
const LIVE_STATUS: &str = "<p id=\"live\" class=\"live\" role=\"status\"></p>\n";

/// A page of missions.
#[derive(Debug, Serialize)]
pub struct Page {
    title: String,
    chapters: Vec<Chapter>,
    /// Of a mission that is still flown, what the ids of its events begin with.
    #[serde(skip_serializing_if = "Option::is_none")]
    live: Option<String>,
}

/// Missions that are shown side by side, in step.
#[derive(Debug, Serialize)]
pub struct Chapter {
    title: String,
    #[serde(skip)]
    about: Vec<String>,
    flights: Vec<Flight>,
}

impl Page {
    /// A page under a title.
    pub fn new(title: impl Into<String>, chapters: Vec<Chapter>) -> Self {
        Self { title: title.into(), chapters, live: None }
    }

    /// A page of a mission that is still flown. Its server sends the scenes in events whose ids begin with a token.
    pub(crate) fn live(title: &str, chapter: Chapter, token: &str) -> Self {
        Self { live: Some(token.to_owned()), ..Self::new(title, vec![chapter]) }
    }

    /// The page as an HTML document.
    pub fn html(&self) -> String {
        filled(TEMPLATE, |slot| match slot {
            "title" => escaped(&self.title),
            "style" => STYLE.to_owned(),
            "chapters" => {
                (0..).zip(&self.chapters).map(|(number, it)| chapter(number, it)).collect()
            }
            "controls" => CONTROLS.trim_end().to_owned(),
            "data" => json(self),
            "script" => {
                let live = self.live.as_ref().map(|_| LIVE_SCRIPT);
                SCRIPT.into_iter().chain(live).collect::<Vec<_>>().join("\n")
            }
            "connect" => self.live.as_ref().map_or("", |_| "; connect-src 'self'").to_owned(),
            "live" => self.live.as_ref().map_or("", |_| LIVE_STATUS).to_owned(),
            other => unreachable!("the template has no {other}"),
        })
    }
}

impl Chapter {
    /// Missions in the same world, each with the name of who planned it.
    pub fn new<'a>(
        title: impl Into<String>,
        flights: impl IntoIterator<Item = (&'a str, &'a Recording)>,
    ) -> Self {
        let flights: Vec<_> = flights.into_iter().collect();
        let about =
            flights.first().map_or(Vec::new(), |(_, first)| words::about(&first.results.start));
        let shown = flights.into_iter().map(|(name, recording)| Flight::of(name, recording));
        Self { title: title.into(), about, flights: shown.collect() }
    }

    /// A mission that begins, with the scene of its start.
    pub(crate) fn begun(title: impl Into<String>, mission: &Mission, scene: Scene) -> Self {
        let mut flight = Flight::begun(mission.algorithm.title(), mission);
        flight.scenes.push(scene);
        Self {
            title: title.into(),
            about: words::about(&Start::of(mission)),
            flights: vec![flight],
        }
    }

    /// The same with a note on how to read it.
    #[must_use]
    pub fn noting(mut self, note: Option<&str>) -> Self {
        self.about.extend(note.map(str::to_owned));
        self
    }
}

/// A template with its slots, `{{name}}`, filled. What fills them is not looked at again.
fn filled(template: &str, value: impl Fn(&str) -> String) -> String {
    let mut parts = template.split("{{");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (slot, rest) = part.split_once("}}").expect("a slot is closed");
        text += &value(slot);
        text += rest;
    }
    text
}

/// Text as it stands in HTML, also within an attribute.
fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            '\'' => safe += "&#39;",
            other => safe.push(other),
        }
    }
    safe
}

/// What comes last on a live page: why the mission ended.
#[derive(Debug, Serialize)]
pub(crate) struct End {
    ended: Vec<Told>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    rest: Vec<MapPlace>,
}

impl End {
    /// Of a mission whose scenes were made so.
    pub(crate) fn of(recording: &Recording, scenes: &Scenes) -> Self {
        let results = &recording.results;
        Self { ended: words::ended(results).collect(), rest: scenes.rest(&results.end.mapped) }
    }

    /// Of a mission that came to nothing.
    pub(crate) fn broken_off(why: &str) -> Self {
        Self { ended: vec![Told::new("Ended", format!("{why}."))], rest: Vec::new() }
    }

    /// As JSON, in one line.
    pub(crate) fn json(&self) -> String {
        json(self)
    }
}

/// JSON in one line that cannot end the script element. A `<` occurs only within strings, where it may be escaped.
fn json(it: &impl Serialize) -> String {
    let json = serde_json::to_string(it).expect("a plain structure");
    json.replace('<', "\\u003c")
}

fn chapter(number: usize, Chapter { title, about, flights }: &Chapter) -> String {
    let mut html = format!(
        "<section class=\"chapter\" id=\"chapter-{number}\" aria-labelledby=\"chapter-{number}-title\">\n\
         <h2 id=\"chapter-{number}-title\">{}</h2>\n<ul class=\"about\">\n",
        escaped(title)
    );
    html.extend(about.iter().map(|fact| format!("<li>{}</li>\n", escaped(fact))));
    html += "</ul>\n<div class=\"stage\" hidden></div>\n";
    for flight in flights {
        html += "<noscript>\n";
        html += &still(flight);
        html += "</noscript>\n";
    }
    html += "<section class=\"steps\">\n<h3>All steps</h3>\n";
    for flight in flights {
        html += &steps(flight);
    }
    html + "</section>\n</section>\n"
}

/// The picture of a mission's end, if it has ended.
fn still(flight: &Flight) -> String {
    let Some(picture) = &flight.picture else { return String::new() };
    // Within HTML it needs no name space, and a page that names no address can be seen to load none.
    let svg = picture.svg().replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
    format!("<h3>{}</h3>\n<div class=\"still\">{svg}</div>\n", escaped(&flight.planner))
}

/// The steps as a table.
fn steps(flight: &Flight) -> String {
    const HEADS: [&str; 8] = [
        "step",
        "problem",
        "motion",
        "to, m",
        "chance of +1",
        "bits expected",
        "read",
        "bits so far",
    ];
    const OF_LINE: [&str; 3] = ["slopes left, deg", "intercepts left, m", "estimate off, deg"];
    const OF_FRONT: [&str; 3] = ["front at, m", "half-width of the front, m", "front off, m"];
    let known = if flight.follows { OF_FRONT } else { OF_LINE };
    let planner = escaped(&flight.planner);
    let mut html = format!(
        "<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"Steps of {planner}\">\n\
         <table class=\"told\">\n<caption>{planner}</caption>\n<thead><tr>"
    );
    for head in HEADS.into_iter().chain(known).chain(["cost so far"]) {
        // Writing to a string cannot fail.
        let _ = write!(html, "<th scope=\"col\">{head}</th>");
    }
    html += "</tr></thead>\n<tbody>\n";
    html.extend(
        flight.scenes.iter().enumerate().map(|(k, scene)| scene.row(k, flight.follows) + "\n"),
    );
    html + "</tbody>\n</table>\n</div>\n"
}

impl Scene {
    /// As JSON, in one line: as the page has it.
    pub(crate) fn json(&self) -> String {
        json(self)
    }

    /// Its row of the table of steps, in one line.
    pub(crate) fn row(&self, number: usize, follows: bool) -> String {
        let cells = cells(self, follows).map(|cell| format!("<td>{}</td>", escaped(&cell)));
        format!("<tr><th scope=\"row\">{number}</th>{}</tr>", cells.concat())
    }
}

/// What a step has beside its number. Of a front it is where the front is known best, and not a line.
fn cells(scene: &Scene, follows: bool) -> [String; 11] {
    let none = || "\u{2013}".to_owned();
    let place = |at: Point2<f64>| minus(&format!("({:.3}, {:.3})", at.x, at.y));
    let motion = scene.motion.as_ref();
    let expected = |of: fn(&Moved) -> Option<f64>| motion.and_then(of);
    let wrong = |motion: &Moved| if motion.is_wrong { ", wrong" } else { "" };
    let label = |motion: &Moved| Some(format!("{}{}", signed(motion.label?), wrong(motion)));
    let off = scene.estimate.as_ref().and_then(|line| line.off_deg);
    let front = scene.front.as_ref();
    let known = if follows {
        let off = front.and_then(|it| it.off);
        [front.map(|it| place(it.at)), front.map(|it| small(it.half_width)), off.map(small)]
    } else {
        [Some(text::arcs(&scene.slopes)), Some(text::range(scene.intercepts)), off.map(small)]
    };
    let [first, second, third] = known.map(|it| it.map_or_else(none, |it| minus(&it)));
    [
        motion.map_or_else(none, |it| it.problem.clone()),
        motion.map_or_else(none, |it| it.motion.clone()),
        place(scene.at),
        expected(|it| it.chance).map_or_else(none, |it| format!("{:.0} %", 100.0 * it)),
        expected(|it| it.expected).map_or_else(none, |bits| format!("{bits:.3}")),
        motion.and_then(label).unwrap_or_else(none),
        text::fixed(scene.bits, 2),
        first,
        second,
        third,
        format!("{:.1}", scene.cost),
    ]
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;
    use crate::mission::recording::Recording;
    use crate::mission::scenario::{self, Overrides};
    use crate::report::pieces::Pieces;

    #[test]
    fn what_fills_a_slot_is_not_filled_again() {
        let page = filled("<h1>{{title}}</h1>{{data}}", |slot| match slot {
            "title" => "{{data}}".to_owned(),
            _ => "1".to_owned(),
        });
        assert_eq!(page, "<h1>{{data}}</h1>1");
    }

    #[test]
    fn no_text_ends_its_script_or_its_element() {
        let page = Page::new("</script><!--<script>&'\"", Vec::new());
        let data = json(&page);
        assert!(!data.contains('<'), "{data}");
        let read: serde_json::Value = serde_json::from_str(&data).unwrap();
        assert_eq!(read["title"], page.title);
        assert_eq!(
            escaped("<a href='x' id=\"y\">&"),
            "&lt;a href=&#39;x&#39; id=&quot;y&quot;&gt;&amp;"
        );
    }

    /// What the scenes and the end have of a map, by its pieces, is what the trace has: a follower drops what it doubts.
    #[test]
    fn the_map_that_is_drawn_is_that_of_the_trace() {
        let text = "algorithm = \"track\"\nsteps = 600\noracle = []\nstart = { x = 10, z = 4 }\nnoise = { p = 0.95 }\n\
                    vehicle = { kind = \"unicycle\", reach = 4.0, step = 0.5 }\narea = { x = [0, 100], z = [0, 80] }\n\
                    truth = { polygon = [[40, 53], [52, 64], [60, 54.5], [74, 57.5], [80, 40], [62, 28], [42, 32]] }";
        for (seed, pieces) in [(7, 6), (8, 4)] {
            let overrides = Overrides { seed: Some(seed), ..Overrides::default() };
            let mission = scenario::parse("m", text, overrides).unwrap();
            let recording = Recording::of(&mission).unwrap();
            let flight = Flight::of("track", &recording);
            let mut drawn: Vec<Vec<Point2<f64>>> = Vec::new();
            for it in flight.scenes.iter().flat_map(|it| &it.mapped).chain(&flight.rest) {
                if it.begins {
                    drawn.push(Vec::new());
                }
                drawn.last_mut().expect("a piece has begun").push(it.at);
            }
            let expected: Vec<_> = Pieces::of(&recording.results).ways().collect();
            assert_eq!((drawn.len(), expected.len()), (pieces, pieces), "seed {seed}");
            for (drawn, expected) in drawn.iter().zip(&expected) {
                assert_eq!(drawn.len(), expected.len(), "seed {seed}");
                let is_near = |(a, b): (&Point2<f64>, &Point2<f64>)| (a - b).amax() < 0.01;
                assert!(drawn.iter().zip(expected).all(is_near), "seed {seed}");
            }
        }
    }
}
