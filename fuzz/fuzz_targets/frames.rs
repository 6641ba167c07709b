#![no_main]
//! The wire: whatever arrives, what is taken for a message is one, goes through a frame unchanged, and
//! can be acted on. Missions that it sets up are flown for some steps, so that no value that the wire
//! takes can overflow.

use std::fmt::Debug;

use crc::{CRC_32_ISO_HDLC, Crc};
use libfuzzer_sys::fuzz_target;
use planner_core::link::delivery::{Heard, Responder};
use planner_core::link::frame::{Decoder, Envelope, FRAME, Frame, Message};
use planner_core::link::message::{Algorithm, MissionArea, Reply, Request, Setup};
use planner_core::dynamics::check;
use planner_core::{Accuracy, AnySight, AnyVehicle, Label, Plan, Planner, Pose, Prior, Reading, sequences_of};

/// Steps that a mission is flown for.
const STEPS: usize = 6;

/// Samples and hypotheses that there is room for: as many as the seeds ask for.
const SAMPLES: usize = 24;
const HYPOTHESES: usize = sequences_of(20);

/// Content as it goes over the wire: with its check sum, and without zeros.
fn framed(content: &[u8]) -> Vec<u8> {
    let sum = Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(content).to_le_bytes();
    let content = [content, &sum].concat();
    let mut frame = vec![0; 2 + cobs::max_encoding_length(content.len())];
    let end = cobs::encode(&content, &mut frame[1..]) + 1;
    frame.truncate(end + 1);
    frame
}

fn messages<M: Message + Debug>(bytes: &[u8]) -> Vec<Envelope<M>> {
    let mut decoder = Decoder::default();
    let messages: Vec<_> = bytes.iter().filter_map(|byte| decoder.feed(*byte)).collect();
    for envelope in &messages {
        let frame = Frame::of(envelope);
        assert!(frame.bytes().len() <= FRAME);
        let mut decoder = Decoder::default();
        let mut again = frame.bytes().iter().filter_map(|byte| decoder.feed::<M>(*byte));
        let again = again.next().expect("a frame that was taken is taken again");
        assert_eq!(format!("{again:?}"), format!("{envelope:?}"));
    }
    messages
}

/// Plans and takes in readings by turns, as far as it goes.
fn fly<P: Planner>(planner: &mut P, setup: &Setup) {
    let Setup { config, start, .. } = setup;
    let mut pose: Pose = *start;
    for step in 0..STEPS {
        let Plan::Move(motion) = planner.plan(pose) else { return };
        let stays = config.area.contains(motion.target.site) || !config.area.contains(pose.site);
        assert!(stays, "out of the area: {motion:?}");
        pose = motion.target;
        let label = if step % 2 == 0 { Label::Positive } else { Label::Negative };
        let reading = motion.wants_label.then_some(Reading::Side(label));
        // It may contradict what is known: an error, and nothing else.
        if planner.observe(pose, reading).is_err() {
            return;
        }
    }
    let _ = planner.estimates();
}

fuzz_target!(|bytes: &[u8]| {
    // As it is, and as the content of a frame whose check sum is right.
    let (way, content) = (bytes.first().copied().unwrap_or_default(), bytes);
    let frame = framed(content);
    for stream in [bytes, &frame] {
        let requests = messages::<Request>(stream);
        let replies = messages::<Reply>(stream);
        assert!(stream == bytes || requests.is_empty() || way == Request::WAY);
        assert!(stream == bytes || replies.is_empty() || way == Reply::WAY);
        let mut responder = Responder::new(7);
        for byte in stream {
            if let Some(Heard::New(request)) = responder.hear(*byte) {
                // Of no session that was offered: only the one after 7 can be.
                assert!(!matches!(request, Request::Hello { .. }));
                responder.answer(Reply::Noted);
            }
        }
        for envelope in replies {
            let Reply::Setup(setup) = envelope.message else { continue };
            let Ok(terms) = setup.terms::<AnyVehicle, _>(MissionArea::from(setup.config.area))
            else {
                continue;
            };
            check(&terms.dynamics).expect("what is no vehicle is declined");
            match setup.algorithm {
                Algorithm::Cfc => {
                    if let Ok(mut prepared) = setup.cfc::<_, _, SAMPLES>(terms) {
                        fly(prepared.planner_mut(), &setup);
                    }
                }
                Algorithm::Lookahead { evaluations, goal, noise: None, sight } => {
                    let asked = (evaluations, sight);
                    if let Ok(mut prepared) = setup
                        .lookahead::<_, _, Accuracy, AnySight, SAMPLES>(terms, asked, goal)
                    {
                        fly(prepared.planner_mut(), &setup);
                    }
                }
                Algorithm::Lookahead { evaluations, goal, noise: Some((noise, prior)), sight } => {
                    let mut planner = setup.lookahead_in_noise::<_, _, _, SAMPLES, HYPOTHESES>(
                        terms,
                        evaluations,
                        goal,
                        sight,
                    );
                    if let Ok(mut prepared) = setup.prepare(&mut planner, prior, noise) {
                        fly(prepared.planner_mut(), &setup);
                    }
                }
                Algorithm::Track { front, noise, ends } => {
                    let mut planner = setup.track(terms, front, ends);
                    if let Ok(mut prepared) = setup.prepare(&mut planner, Prior::Area, noise) {
                        fly(prepared.planner_mut(), &setup);
                    }
                }
                Algorithm::Watch { front, noise, stretch } => {
                    let mut planner = setup.guard(terms, front, stretch);
                    if let Ok(mut prepared) = setup.prepare(&mut planner, Prior::Area, noise) {
                        fly(prepared.planner_mut(), &setup);
                    }
                }
                Algorithm::Scc { noise, policy, prior } => {
                    let mut planner = setup.scc::<_, _, SAMPLES, HYPOTHESES>(terms, policy);
                    if let Ok(mut prepared) = setup.prepare(&mut planner, prior, noise) {
                        fly(prepared.planner_mut(), &setup);
                    }
                }
            }
        }
    }
});
