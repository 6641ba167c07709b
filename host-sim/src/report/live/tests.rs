//! A mission and its viewers, by plain connections.

use std::collections::HashSet;
use std::io::{self, Read as _, Write as _};
use std::net::TcpStream;
use std::path::Path;
use std::thread;

use super::*;
use crate::mission::scenario::{self, Overrides};
use crate::mission::trace;
use crate::report::live::feed::MOST_VIEWERS;

const HERE: &str = "127.0.0.1:0";

fn mission(name: &str) -> Mission {
    let file = format!("{}/scenarios/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let overrides = Overrides { algorithm: None, steps: Some(60), seed: None, set: &[] };
    scenario::read(Path::new(&file), overrides).expect("a good file")
}

fn open(mission: &Mission) -> Live {
    Live::open(&HERE.parse().unwrap(), "a mission", mission).expect("a free port")
}

/// Sends a request, with the right `Host` unless it has one.
fn ask(live: &Live, request: &str) -> TcpStream {
    let link = live.link();
    let address = link.trim_start_matches("http://").trim_end_matches('/');
    let mut to = TcpStream::connect(address).unwrap();
    let host =
        if request.contains("Host:") { String::new() } else { format!("Host: {address}\r\n") };
    to.write_all(format!("{request}{host}\r\n").as_bytes()).unwrap();
    to
}

fn view(live: &Live) -> TcpStream {
    ask(live, "GET /scenes HTTP/1.1\r\n")
}

/// All that comes until the connection is closed.
fn read(mut from: TcpStream) -> String {
    let mut text = String::new();
    from.read_to_string(&mut text).unwrap();
    text
}

fn status(answer: &str) -> &str {
    answer.get(9..12).unwrap_or(answer)
}

/// The events of a stream: the id, the kind and the lines of data of each. A part of one does not count, as in a browser.
fn events(answer: &str) -> Vec<(String, String, Vec<String>)> {
    let stream = answer.split_once("\r\n\r\n").map_or(answer, |(_, stream)| stream);
    let (whole, _) = stream.rsplit_once("\n\n").expect("an event");
    let of = |event: &str, key: &str| {
        let lines = event.lines().filter_map(|it| it.strip_prefix(key)?.strip_prefix(": "));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    let all = whole.split("\n\n").filter(|it| it.contains("id: "));
    all.map(|it| (of(it, "id").concat(), of(it, "event").concat(), of(it, "data"))).collect()
}

/// Flies a mission in sight; `watch` sees the number of each step.
fn fly(mission: &Mission, live: &mut Live, mut watch: impl FnMut(usize, &Live)) -> Recording {
    let (recording, refusal) = Recording::until_refusal_watched(mission, |recorder| {
        live.step(recorder);
        watch(recorder.steps().len(), live);
    });
    assert!(refusal.is_none(), "{refusal:?}");
    live.end(&recording);
    recording
}

/// The report's page of a mission.
fn report(recording: &Recording) -> String {
    let planner = recording.mission.algorithm.title();
    Page::new("a mission", vec![Chapter::new("", [(planner, recording)])]).html()
}

#[test]
fn what_is_streamed_is_what_the_report_has() {
    for name in [
        "begin-line",
        "begin-noisy",
        "begin-spill",
        "closed-front",
        "moving-front",
        "car-among-keep-outs",
        "lake",
    ] {
        let mission = mission(name);
        let mut live = open(&mission);
        let early = view(&live);
        let early = thread::spawn(|| read(early));
        let recording = fly(&mission, &mut live, |_, _| ());
        let page = read(ask(&live, "GET / HTTP/1.1\r\n"));
        let late = events(&read(view(&live)));
        assert_eq!(events(&early.join().unwrap()), late, "{name}");
        let (end, scenes) = late.split_last().unwrap();
        assert_eq!(scenes.len(), recording.steps.len() + 1, "{name}");
        assert!(scenes.iter().all(|it| it.1 == "scene" && it.2.len() == 2), "{name}");
        let part = |k: usize| scenes.iter().map(|it| &*it.2[k]).collect::<Vec<_>>();
        let report = report(&recording);
        assert!(report.contains(&format!("\"scenes\":[{}]", part(0).join(","))), "{name}: scenes");
        assert!(
            report.contains(&format!("<tbody>\n{}\n</tbody>", part(1).join("\n"))),
            "{name}: rows"
        );
        assert_eq!(end.1, "end");
        let ended = end.2[0].trim_matches(['{', '}']);
        assert!(report.contains(ended), "{name}: {ended}");
        // All but what the scenes show is there from the start, and they show what moves.
        let begun = |html: &str| {
            let (_, flight) = html.split_once("\"flights\":").expect("a mission");
            flight.split_once(",\"scenes\":").expect("scenes").0.to_owned()
        };
        assert_eq!(begun(&page), begun(&report), "{name}");
        let boundary = |scene: &str| {
            let (_, after) = scene.split_once(",\"boundary\":")?;
            after.split_once(",\"slopes\":").map(|it| it.0.to_owned())
        };
        let shown: HashSet<_> = part(0).iter().filter_map(|it| boundary(it)).collect();
        let expected = if mission.world.moves() { scenes.len() } else { 0 };
        assert_eq!(shown.len(), expected, "{name}: where the boundary was");
        assert!(page.contains(&format!("\"scenes\":[{}]", part(0)[0])), "{name}: the page");
        assert!(page.contains("connect-src 'self'") && !report.contains("connect-src"));
        assert!(!report.contains("EventSource"), "a report asks for nothing");
    }
}

#[test]
fn a_viewer_who_comes_again_misses_nothing_and_gets_nothing_twice() {
    let mission = mission("begin-line");
    let mut live = open(&mission);
    let (mut got, mut stream) = (Vec::new(), None);
    fly(&mission, &mut live, |step, live| {
        let last = got.last().map_or(String::new(), |it: &(String, _, _)| it.0.clone());
        let from = stream.get_or_insert_with(|| {
            ask(live, &format!("GET /scenes HTTP/1.1\r\nLast-Event-ID: {last}\r\n"))
        });
        if step % 3 == 0 {
            // It has got the last step, and what follows is lost.
            let text = read_until(from, &format!(".{step}\n"));
            got.extend(events(&text));
            stream = None;
        }
    });
    let last = got.last().unwrap().0.clone();
    let rest = read(ask(&live, &format!("GET /scenes HTTP/1.1\r\nLast-Event-ID: {last}\r\n")));
    got.extend(events(&rest));
    let all = events(&read(view(&live)));
    assert!(all.len() > 8);
    assert_eq!(got, all);
    // An id of another mission says nothing of this one.
    for id in ["other.3", "", "3", &all[0].0.replace(".0", ".x")] {
        let again = read(ask(&live, &format!("GET /scenes HTTP/1.1\r\nLast-Event-ID: {id}\r\n")));
        assert_eq!(events(&again), all, "{id}");
    }
}

#[test]
fn viewers_do_not_change_a_mission_and_do_not_delay_it() {
    let mission = mission("begin-noisy");
    let alone = Recording::of(&mission).unwrap();
    let mut live = open(&mission);
    let stalled = view(&live);
    let viewers: Vec<_> = (0..4).map(|_| view(&live)).collect();
    let viewers: Vec<_> = viewers.into_iter().map(|it| thread::spawn(|| read(it))).collect();
    let recording = fly(&mission, &mut live, |_, _| ());
    let seen: Vec<_> = viewers.into_iter().map(|it| events(&it.join().unwrap())).collect();
    assert!(seen.iter().all(|it| *it == seen[0] && it.len() == recording.steps.len() + 2));
    assert_eq!(trace::lines(&recording.results), trace::lines(&alone.results));
    drop(stalled);
}

#[test]
fn a_viewer_who_never_reads_holds_nobody_up() {
    let mission = mission("begin-line");
    let mut live = open(&mission);
    let stalled = view(&live);
    let reader = view(&live);
    let reader = thread::spawn(move || io::copy(&mut &reader, &mut io::sink()).unwrap());
    // Far more than all buffers of a connection take.
    let large = "x".repeat(1 << 20);
    for _ in 0..64 {
        live.server.feed().push("scene", &[&large]);
    }
    live.break_off("test");
    assert!(reader.join().unwrap() > 64 << 20);
    drop(stalled);
}

#[test]
fn others_are_refused() {
    let mission = mission("begin-line");
    let live = open(&mission);
    let answer = |request: &str| read(ask(&live, request));
    assert_eq!(status(&answer("GET / HTTP/1.1\r\n")), "200");
    for foreign in ["evil.example", "localhost.evil.example:80", "192.0.2.1"] {
        for path in ["/", "/scenes"] {
            assert_eq!(
                status(&answer(&format!("GET {path} HTTP/1.1\r\nHost: {foreign}\r\n"))),
                "403"
            );
        }
    }
    let posted = answer("POST / HTTP/1.1\r\nContent-Length: 3\r\n");
    assert_eq!(status(&posted), "405");
    assert!(posted.contains("Allow: GET\r\n"));
    assert_eq!(status(&answer("DELETE /scenes HTTP/1.1\r\n")), "405");
    assert_eq!(status(&answer("GET /etc/passwd HTTP/1.1\r\n")), "404");
    assert_eq!(status(&answer("nonsense\r\n")), "400");
    let long = format!("GET / HTTP/1.1\r\nX: {}\r\n", "x".repeat(10_000));
    assert!(["400", "403"].contains(&status(&answer(&long))));
}

#[test]
fn a_ninth_viewer_is_refused_until_one_has_left() {
    let mission = mission("begin-line");
    let mut live = open(&mission);
    let status = |viewer: &mut TcpStream| {
        let mut head = [0; 12];
        viewer.read_exact(&mut head).unwrap();
        status(std::str::from_utf8(&head).unwrap()).to_owned()
    };
    let mut viewers: Vec<_> = (0..MOST_VIEWERS).map(|_| view(&live)).collect();
    assert!(viewers.iter_mut().all(|viewer| status(viewer) == "200"));
    assert_eq!(status(&mut view(&live)), "503");
    assert_eq!(status(&mut ask(&live, "GET / HTTP/1.1\r\n")), "503");
    drop(viewers.pop());
    // That it has left is seen after a beat or two.
    let mut ninth = loop {
        let mut viewer = view(&live);
        if status(&mut viewer) == "200" {
            break viewer;
        }
    };
    live.break_off("test");
    ninth.read_to_end(&mut Vec::new()).unwrap();
}

#[test]
fn an_address_in_use_is_refused() {
    let mission = mission("begin-line");
    let live = open(&mission);
    let link = live.link();
    let taken = link.trim_start_matches("http://").trim_end_matches('/');
    let why = Live::open(&taken.parse().unwrap(), "another", &mission).unwrap_err().to_string();
    assert_eq!(
        why,
        format!("--live: found {taken} in use, expected a free port, as --live={HERE} finds")
    );
}

#[test]
fn a_mission_that_begins_again_is_told_from_the_start() {
    let mission = mission("begin-line");
    let mut live = open(&mission);
    let viewer = view(&live);
    let first = events(&read_until(&viewer, ".0\n"));
    live.say("waiting for\na vehicle");
    assert!(read_until(&viewer, "notice").ends_with("data: waiting for a vehicle\n\n"));
    live.begin(&mission);
    fly(&mission, &mut live, |_, _| ());
    let again = events(&read(viewer));
    assert_ne!(first[0].0, again[0].0);
    assert_eq!(first[0].2, again[0].2);
    assert_eq!(again, events(&read(view(&live))));
}

/// What comes until a text and an empty line have come.
fn read_until(mut from: &TcpStream, end: &str) -> String {
    let mut bytes = Vec::new();
    loop {
        let mut part = [0; 512];
        let read = from.read(&mut part).unwrap();
        assert!(read > 0, "it ends before {end}");
        bytes.extend(&part[..read]);
        let text = String::from_utf8_lossy(&bytes);
        if text.contains(end) && text.ends_with("\n\n") {
            return text.into_owned();
        }
    }
}
