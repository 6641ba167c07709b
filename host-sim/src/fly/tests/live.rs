//! A flight that is watched on a live page.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::thread;

use super::*;
use crate::report::live::Live;
use crate::report::page::{Chapter, Page};

/// A viewer gets each step, the end, and what became of the vehicle: the scenes of the report. The flight is the same as unwatched.
#[test]
fn a_flight_is_watched() {
    let mission = mission();
    let address = "127.0.0.1:0".parse().expect("an address");
    let mut live = Live::open(&address, "a flight", &mission).expect("a free port");
    let link = live.link();
    let host = link.trim_start_matches("http://").trim_end_matches('/');
    let mut viewer = TcpStream::connect(host).expect("it listens");
    write!(viewer, "GET /scenes HTTP/1.1\r\nHost: {host}\r\n\r\n").expect("it hears");
    let viewer = thread::spawn(move || {
        let mut seen = String::new();
        viewer.read_to_string(&mut seen).expect("text");
        seen
    });
    let labels = LabelSource::new("WET".parse().expect("a name"), None);
    let ideal = Ideal::new(&mission, SYSTEM, labels.clone());
    let mut control = Control::new(ideal, Pilot::new(SYSTEM, labels, LIMITS), || None);
    let flight = flight::fly_shown(mission, &mut control, Some(&mut live));
    let seen = viewer.join().expect("a stream");
    let flown = Flown { flight, sent: Vec::new(), gone: [0; 2] };
    assert_eq!(flown.trace(), of_run());
    let recording = &flown.flight.as_ref().expect("it flew").recording;
    let report = Page::new("a flight", vec![Chapter::new("", [("it", recording)])]).html();
    let scenes: Vec<_> = seen.lines().filter_map(|it| it.strip_prefix("data: {\"motion")).collect();
    // The start is shown again where the vehicle is. Who comes late does not see it twice.
    let again = scenes.len() - recording.steps.len() - 1;
    assert!(report.contains(&scenes[again..].join(",{\"motion")), "{seen}");
    assert!(seen.contains("\ndata: it was told to stop, and says that it is at rest\n"), "{seen}");
    assert!(seen.contains("event: end\ndata: {\"ended\":[{\"of\":\"Ended\""), "{seen}");
}
