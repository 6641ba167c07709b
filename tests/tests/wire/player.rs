//! The player detects a chip that takes in, or estimates, something different.

use host_sim::hil::player::Player;
use host_sim::mission::definition::Mission;
use host_sim::mission::recording::Recording;
use planner_core::link::frame::{Decoder, Envelope, Frame};
use planner_core::link::message::{
    self, Capacity, ClockRate, LabelSource, PROTOCOL, Reply, Request,
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
    fn new(mission: &Mission) -> Self {
        Self::with(mission, LabelSource::Vehicle)
    }

    fn with(mission: &Mission, labels: LabelSource) -> Self {
        let player = Player::new(mission, labels, 1).expect("a mission for a chip");
        let mut liar = Self { player, link: (0, 0) };
        liar.says(Request::Hello { protocol: PROTOCOL }).expect("it offers a mission");
        let capacity = Capacity { samples: 68, hypotheses: 1 };
        let clock = ClockRate { per_second: 1, emulated: false };
        liar.says(Request::Ready(message::Accepted { capacity, clock })).expect("it takes note");
        liar
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
}

#[test]
fn a_player_finds_out_a_chip_that_took_in_another_reading() {
    let mission = mission(0);
    let took = message::Took::default();
    let steps = Recording::of(&mission).expect("labels are true").steps;
    let motion = |n: usize| steps[n].motion;
    let mut liar = Liar::new(&mission);
    let reply = liar.says(Request::Move(message::Move { motion: motion(0), last: None, took }));
    let Ok(Reply::Arrived { reading: Some(Reading::Side(sensed)), .. }) = reply else {
        panic!("{reply:?}")
    };
    for last in [None, Some(Reading::Boundary), Some((-sensed).into())] {
        let mut liar = Liar::new(&mission);
        let moved = liar.says(Request::Move(message::Move { motion: motion(0), last: None, took }));
        assert!(moved.is_ok());
        let lie = liar.says(Request::Move(message::Move { motion: motion(1), last, took }));
        let error = lie.expect_err("it was found out").to_string();
        assert!(error.contains("step 1: sensed"), "{error}");
    }
    let last = Some(sensed.into());
    assert!(liar.says(Request::Move(message::Move { motion: motion(1), last, took })).is_ok());
}

/// On the way too. And a chip that goes on with no motion, or begins the next before the end of one, is none.
#[test]
fn a_player_finds_out_a_chip_that_took_in_another_reading_on_the_way() {
    let mission = reading(mission(0));
    let took = message::Took::default();
    let steps = Recording::of(&mission).expect("labels are true").steps;
    let moves =
        |n: usize, last| Request::Move(message::Move { motion: steps[n].motion, last, took });
    let begun = || {
        let mut liar = Liar::new(&mission);
        let reply = liar.says(moves(0, None));
        let Ok(Reply::OnTheWay { reading: Some(Reading::Side(told)), .. }) = reply else {
            panic!("{reply:?}")
        };
        (liar, told)
    };
    let error =
        |liar: &mut Liar, request| liar.says(request).expect_err("it was found out").to_string();
    let (mut liar, told) = begun();
    for last in [None, Some(Reading::Boundary), Some((-told).into())] {
        let (mut liar, _) = begun();
        let error = error(&mut liar, Request::Onward { last });
        assert!(error.contains("step 1: read Some"), "{error}");
    }
    let early = error(&mut begun().0, moves(1, None));
    assert!(early.contains("step 1: the board asks for the next motion before its end"), "{early}");

    let last = Some(told.into());
    let reply = liar.says(Request::Onward { last });
    let Ok(Reply::OnTheWay { reading: last, .. }) = reply else { panic!("{reply:?}") };
    let reply = liar.says(Request::Onward { last });
    assert!(matches!(reply, Ok(Reply::Arrived { .. })), "{reply:?}");
    let late = error(&mut liar, Request::Onward { last });
    assert!(late.starts_with("after step 1: the board goes on with a motion"), "{late}");
}

/// A chip that knows another front, none, or one before its motion has ended.
#[test]
fn a_player_compares_the_front_after_every_motion_to_the_last_bit() {
    let mission = following(3, 0, 40);
    let took = message::Took::default();
    let steps = Recording::of(&mission).expect("no label contradicts a front").steps;
    let moves =
        |n: usize, last| Request::Move(message::Move { motion: steps[n].motion, last, took });
    let mut planner = mission.planner();
    let mut liar = Liar::new(&mission);
    let (mut pose, mut compared, mut last) = (mission.start, 0, None);
    for n in 0..steps.len() - 1 {
        let _ = planner.plan(pose);
        assert!(liar.says(moves(n, last)).is_ok());
        (pose, last) = (steps[n].pose, steps[n].reading);
        planner.observe(pose, last).expect("no label contradicts a front");
        let right = planner.front().expect("it follows a front");
        if let Some(waist) = right.waist.filter(|_| n > 20) {
            let near = f32::from_bits(waist.curvature.to_bits() ^ 1);
            let other = FrontState { waist: Some(Waist { curvature: near, ..waist }), ..right };
            let closed = FrontState { is_closed: !right.is_closed, ..right };
            for wrong in [other, closed, FrontState { waist: None, ..right }] {
                let mut liar = Liar::new(&mission);
                let mut last = None;
                let mut planner = mission.planner();
                let mut pose = mission.start;
                for (k, step) in steps.iter().enumerate().take(n + 1) {
                    let _ = planner.plan(pose);
                    assert!(liar.says(moves(k, last)).is_ok());
                    (pose, last) = (step.pose, step.reading);
                    planner.observe(pose, last).expect("no label contradicts a front");
                    let said = if k == n { wrong } else { planner.front().expect("a front") };
                    assert!(matches!(liar.says(Request::Front(said)), Ok(Reply::Noted)));
                }
                let error = liar.says(moves(n + 1, last)).expect_err("it was found out");
                assert!(
                    error.to_string().contains(&format!("step {}: the front", n + 1)),
                    "{error}"
                );
                compared += 1;
            }
            let none = liar.says(moves(n + 1, last)).expect_err("it says nothing").to_string();
            assert!(none.contains("the front: found None"), "{none}");
            break;
        }
        assert!(matches!(liar.says(Request::Front(right)), Ok(Reply::Noted)));
    }
    assert_eq!(compared, 3);
    let early = Liar::new(&mission).says(Request::Front(FrontState::default()));
    assert!(early.expect_err("no motion yet").to_string().contains("no motion has ended"));
}

#[test]
fn a_player_compares_every_estimate_to_the_last_bit() {
    let mission = mission(0);
    let right = mission.lines().estimates();
    let end = |estimates| {
        let (last, took) = (None, message::Took::default());
        Request::End(message::MissionEnd {
            reason: message::EndReason::Steps,
            last,
            took,
            estimates,
        })
    };
    let judge = |estimates| {
        let mut liar = Liar::new(&mission);
        assert!(matches!(liar.says(end(estimates)), Ok(Reply::Noted)));
        liar.player.finish().map(drop).map_err(|error| error.to_string())
    };
    assert_eq!(judge(right), Ok(()));
    let centre = right.centre.expect("a line");
    let intercept = f32::from_bits(centre.intercept().to_bits() + 1);
    let near = LocalLine::new(centre.about(), centre.along(), centre.slope(), intercept);
    for (wrong, name) in [
        (Estimates { bisector: None, ..right }, "the bisector"),
        (Estimates { centre: near, ..right }, "the centre"),
        (Estimates { maximum_margin: right.bisector, ..right }, "the maximum margin"),
    ] {
        let error = judge(wrong).expect_err("it was found out");
        assert!(error.starts_with(name), "{error}");
    }
}

/// The board's sensor reads what cannot be: what was flown until then is there all the same.
#[test]
fn a_player_keeps_what_was_flown_until_a_contradiction() {
    let mission = mission(0);
    let known = mission.given.samples()[0];
    let took = message::Took::default();
    let first = Recording::of(&mission).expect("labels are true").steps[0].motion;
    let to_known = Motion { target: Pose { site: known.site, ..first.target }, ..first };
    let mut chip = Liar::with(&mission, LabelSource::Chip);
    let asks = |motion, last| Request::Move(message::Move { motion, last, took });
    let certain = Some(Reading::Side(known.label));
    for (motion, last) in [(to_known, None), (to_known, certain)] {
        assert!(matches!(chip.says(asks(motion, last)), Ok(Reply::Arrived { .. })));
    }
    let end = message::MissionEnd {
        reason: message::EndReason::Steps,
        last: Some((-known.label).into()),
        took,
        estimates: mission.lines().estimates(),
    };
    assert!(matches!(chip.says(Request::End(end)), Ok(Reply::Noted)));
    let (played, failure) = chip.player.finish_as_far_as_flown().expect("it has begun");
    let error = failure.expect("a contradiction").to_string();
    assert!(error.starts_with("step 2: label ") && error.contains("contradicts"), "{error}");
    assert_eq!(played.recording.results.end.reason, "broken off");
    assert_eq!(played.recording.results.steps.len(), 1);
}
