//! The player detects a chip that takes in, estimates or asks for something different.

use std::io::{Read as _, Write as _};
use std::net::TcpStream;
use std::thread;

use host_sim::hil::player::Player;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use host_sim::report::live::Live;
use host_sim::report::page::{Chapter, Page};
use planner_core::link::frame::{Decoder, Envelope, Frame};
use planner_core::link::message::{
    Accepted, Capacity, ClockRate, EndReason, LabelSource, MissionEnd, Move, PROTOCOL, Reply,
    Request, Took,
};
use planner_core::{Belief as _, Estimates, FrontState, LocalLine, Motion, Pose, Reading, Waist};
use tests::fronts::following;
use tests::missions::{mission, reading};

/// A player and what a chip of our own says to it.
struct Liar {
    player: Player,
    link: (u32, u32),
}

impl Liar {
    fn new(player: Player) -> Self {
        let mut liar = Self { player, link: (0, 0) };
        liar.begins();
        liar
    }

    /// A chip begins: it asks for the mission, and takes it up.
    fn begins(&mut self) {
        self.link = (0, self.link.1);
        self.says(Request::Hello { protocol: PROTOCOL }).expect("it offers a mission");
        self.says(ready()).expect("it takes note");
    }

    fn of(mission: &Mission) -> Self {
        Self::new(player(mission, LabelSource::Vehicle))
    }

    fn says(&mut self, request: Request) -> anyhow::Result<Reply> {
        self.link.1 += 1;
        let frame = Frame::of(&Envelope::new(self.link.0, self.link.1, request));
        let mut decoder = Decoder::default();
        for byte in frame.bytes() {
            let Some(answer) = self.player.hear(*byte)? else { continue };
            let envelope = answer.bytes().iter().find_map(|byte| decoder.feed::<Reply>(*byte));
            let envelope = envelope.expect("a whole frame");
            self.link.0 = envelope.session;
            return Ok(envelope.message);
        }
        panic!("no answer");
    }

    /// Says what the player does not believe, and why it does not.
    fn lies(&mut self, request: Request) -> String {
        self.says(request).expect_err("it was found out").to_string()
    }
}

fn player(mission: &Mission, labels: LabelSource) -> Player {
    Player::new(mission, labels, 1).expect("a mission for a chip")
}

fn ready() -> Request {
    let capacity = Capacity { samples: 68, hypotheses: 1 };
    let clock = ClockRate { per_second: 1, emulated: false };
    Request::Ready(Accepted { capacity, clock })
}

fn asks(motion: Motion, last: Option<Reading>) -> Request {
    Request::Move(Move { motion, last, took: Took::default() })
}

fn ends(last: Option<Reading>, estimates: Estimates) -> Request {
    Request::End(MissionEnd { reason: EndReason::Steps, last, took: Took::default(), estimates })
}

/// What a chip may say wrongly that it took in, where it was told a label.
fn others(told: Option<Reading>) -> [Option<Reading>; 3] {
    let Some(Reading::Side(label)) = told else { panic!("{told:?}") };
    [None, Some(Reading::Boundary), Some((-label).into())]
}

/// At the end of a motion and on its way. And a chip that goes on with no motion, or begins the next before the end of one,
/// is none.
#[test]
fn a_player_finds_out_a_chip_that_took_in_another_reading() {
    let ends = mission(0);
    let steps = Recording::of(&ends).expect("labels are true").steps;
    let begun = |mission: &Mission| {
        let mut liar = Liar::of(mission);
        match liar.says(asks(steps[0].motion, None)) {
            Ok(Reply::Arrived { reading, .. } | Reply::OnTheWay { reading, .. }) => (liar, reading),
            other => panic!("{other:?}"),
        }
    };
    let (mut liar, told) = begun(&ends);
    for last in others(told) {
        let error = begun(&ends).0.lies(asks(steps[1].motion, last));
        assert!(error.contains("step 1: sensed"), "{error}");
    }
    assert!(liar.says(asks(steps[1].motion, told)).is_ok());

    let on_the_way = reading(ends);
    let (mut liar, told) = begun(&on_the_way);
    for last in others(told) {
        let error = begun(&on_the_way).0.lies(Request::Onward { last });
        assert!(error.contains("step 1: read Some"), "{error}");
    }
    let early = begun(&on_the_way).0.lies(asks(steps[1].motion, None));
    assert!(early.contains("step 1: the board asks for the next motion before its end"), "{early}");
    let reply = liar.says(Request::Onward { last: told });
    let Ok(Reply::OnTheWay { reading: last, .. }) = reply else { panic!("{reply:?}") };
    let reply = liar.says(Request::Onward { last });
    assert!(matches!(reply, Ok(Reply::Arrived { .. })), "{reply:?}");
    let late = liar.lies(Request::Onward { last });
    assert!(late.starts_with("after step 1: the board goes on with a motion"), "{late}");
}

/// A chip that knows another front, none, or one before its motion has ended.
#[test]
fn a_player_compares_the_front_after_every_motion_to_the_last_bit() {
    const STEP: usize = 21;
    let mission = following(3, 0, 40);
    let steps = Recording::of(&mission).expect("no label contradicts a front").steps;
    // What is known after each step, up to one where there is a front.
    let mut planner = mission.planner();
    let mut pose = mission.start;
    let known: Vec<_> = steps[..=STEP]
        .iter()
        .map(|step| {
            let _ = planner.plan(pose);
            pose = step.pose;
            planner.observe(pose, step.reading).expect("no label contradicts a front");
            planner.front().expect("it follows a front")
        })
        .collect();
    let right = known[STEP];
    let waist = right.waist.expect("a front");
    let near = f32::from_bits(waist.curvature.to_bits() ^ 1);
    let other = FrontState { waist: Some(Waist { curvature: near, ..waist }), ..right };
    let closed = FrontState { is_closed: !right.is_closed, ..right };
    let none = FrontState { waist: None, ..right };
    let step = format!("step {}: the front", STEP + 1);
    for (said, error) in [
        (Some(right), None),
        (Some(other), Some(&*step)),
        (Some(closed), Some(&*step)),
        (Some(none), Some(&*step)),
        (None, Some("the front: found None")),
    ] {
        let mut liar = Liar::of(&mission);
        let mut last = None;
        for (k, step) in steps[..=STEP].iter().enumerate() {
            assert!(liar.says(asks(step.motion, last)).is_ok(), "{k}");
            last = step.reading;
            let state = if k == STEP { said } else { Some(known[k]) };
            let noted = state.map(|it| liar.says(Request::Front(it)));
            assert!(matches!(noted, None | Some(Ok(Reply::Noted))), "{k}: {noted:?}");
        }
        let found = liar.says(asks(steps[STEP + 1].motion, last));
        match error {
            None => assert!(found.is_ok(), "{found:?}"),
            Some(error) => {
                let found = found.expect_err("it was found out").to_string();
                assert!(found.contains(error), "{found}");
            }
        }
    }
    let early = Liar::of(&mission).lies(Request::Front(FrontState::default()));
    assert!(early.contains("no motion has ended"), "{early}");
}

#[test]
fn a_player_compares_every_estimate_to_the_last_bit() {
    let mission = mission(0);
    let right = mission.lines().estimates();
    let centre = right.centre.expect("a line");
    let intercept = f32::from_bits(centre.intercept().to_bits() + 1);
    let near = LocalLine::new(centre.about(), centre.along(), centre.slope(), intercept);
    for (said, name) in [
        (right, None),
        (Estimates { bisector: None, ..right }, Some("the bisector")),
        (Estimates { centre: near, ..right }, Some("the centre")),
        (Estimates { maximum_margin: right.bisector, ..right }, Some("the maximum margin")),
    ] {
        let mut liar = Liar::of(&mission);
        assert!(matches!(liar.says(ends(None, said)), Ok(Reply::Noted)));
        let error = liar.player.finish().err().map(|error| error.to_string());
        let is_right = error.as_deref().zip(name).is_some_and(|(it, name)| it.starts_with(name));
        assert!(is_right || (&error, name) == (&None, None), "{name:?}: {error:?}");
    }
}

/// The board's sensor reads what cannot be: what was flown until then is there all the same.
#[test]
fn a_player_keeps_what_was_flown_until_a_contradiction() {
    let mission = mission(0);
    let known = mission.given.samples()[0];
    let first = Recording::of(&mission).expect("labels are true").steps[0].motion;
    let to_known = Motion { target: Pose { site: known.site, ..first.target }, ..first };
    let mut chip = Liar::new(player(&mission, LabelSource::Chip));
    for last in [None, Some(Reading::Side(known.label))] {
        assert!(matches!(chip.says(asks(to_known, last)), Ok(Reply::Arrived { .. })));
    }
    let end = ends(Some((-known.label).into()), mission.lines().estimates());
    assert!(matches!(chip.says(end), Ok(Reply::Noted)));
    let (played, failure) = chip.player.finish_as_far_as_flown().expect("it has begun");
    let error = failure.expect("a contradiction").to_string();
    assert!(error.starts_with("step 2: label ") && error.contains("contradicts"), "{error}");
    assert_eq!(played.recording.results.end.reason, "broken off");
    assert_eq!(played.recording.results.steps.len(), 1);
}

/// A chip that asks for something else when it flies again has another planner: the step is named, and nothing moves.
#[test]
fn a_chip_that_changed_its_mind_is_found_out() {
    let mission = mission(0);
    let steps = Recording::of(&mission).expect("labels are true").steps;
    let mut liar = Liar::new(player(&mission, LabelSource::Vehicle).resuming());
    let told = liar.says(asks(steps[0].motion, None)).expect("it moves");
    liar.says(asks(steps[1].motion, steps[0].reading)).expect("it moves");
    let error_after_one = |liar: &mut Liar, lie| {
        liar.begins();
        assert_eq!(liar.says(asks(steps[0].motion, None)).expect("as before"), told);
        liar.lies(lie)
    };
    let error = error_after_one(&mut liar, asks(steps[2].motion, steps[0].reading));
    assert!(error.contains("step 2: the board asks for action"), "{error}");
    // It says that it took in what it was told then, too.
    assert!(steps[0].reading.is_some());
    let error = error_after_one(&mut liar, asks(steps[1].motion, None));
    assert!(error.contains("step 1: sensed"), "{error}");
    // It does not get anywhere.
    let error = (0..1_000).find_map(|_| {
        liar.link.0 = 0;
        liar.says(Request::Hello { protocol: PROTOCOL }).expect("a mission");
        liar.says(ready()).err()
    });
    let error = error.expect("an end").to_string();
    assert!(error.contains("again and again after step 1"), "{error}");
}

/// A live page shows each step that a chip has taken in, and then the end: the scenes of the report.
#[test]
fn a_chips_mission_is_watched() {
    let mission = mission(0);
    let honest = Recording::of(&mission).expect("labels are true");
    let address = "127.0.0.1:0".parse().expect("an address");
    let live = Live::open(&address, "a chip", &mission).expect("a free port");
    let link = live.link();
    let host = link.trim_start_matches("http://").trim_end_matches('/');
    let mut viewer = TcpStream::connect(host).expect("it listens");
    write!(viewer, "GET /scenes HTTP/1.1\r\nHost: {host}\r\n\r\n").expect("it hears");
    let viewer = thread::spawn(move || {
        let mut seen = String::new();
        viewer.read_to_string(&mut seen).expect("text");
        seen
    });
    let mut chip = Liar::new(player(&mission, LabelSource::Vehicle).shown(Some(live)));
    let mut last = None;
    for step in &honest.steps {
        let Ok(Reply::Arrived { reading, .. }) = chip.says(asks(step.motion, last)) else {
            panic!("it arrives");
        };
        last = reading;
    }
    chip.says(ends(last, honest.belief.estimates())).expect("it is over");
    let mut played = chip.player.finish().expect("a mission");
    played.live.take().expect("a live page").end(&played.recording);
    let seen = viewer.join().expect("a stream");
    let report = Page::new("", vec![Chapter::new("", [("", &played.recording)])]).html();
    let scenes = seen.lines().filter_map(|it| it.strip_prefix("data: {\"motion"));
    let scenes: Vec<_> = scenes.map(|it| format!("{{\"motion{it}")).collect();
    assert!(report.contains(&format!("\"scenes\":[{}]", scenes.join(","))), "{seen}");
    assert!(seen.contains("event: end\n"), "{seen}");
}
