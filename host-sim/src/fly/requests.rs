//! The messages that a vehicle is asked to send: one after the other, each again until it is acknowledged.
//!
//! An acknowledgement names the command and not the message. A late or doubled one could be taken for that of the next
//! message, so a pause comes before the next request. A message that does not arrive although it was acknowledged is
//! requested anew.

use std::time::Duration;

use mavlink::MessageData as _;
use mavlink::dialects::common::{
    ATTITUDE_DATA, COMMAND_ACK_DATA, FENCE_STATUS_DATA, LOCAL_POSITION_NED_DATA, MavCmd,
    MavMessage, MavResult, RC_CHANNELS_DATA,
};

use crate::fly::failure::Failure;
use crate::fly::label::Source;
use crate::fly::orders::Envelope;

/// The interval of the messages that are requested.
const INTERVAL: Duration = Duration::from_millis(100);

/// How long an answer may take before the vehicle is asked again. Also the pause before the next request.
const REPEAT: Duration = Duration::from_millis(500);

/// A message that is asked for.
#[derive(Clone, Copy, Debug)]
struct Request {
    id: u32,
    name: &'static str,
    /// Whether nothing can be flown without it.
    is_needed: bool,
}

/// All that is asked for.
#[derive(Clone, Debug)]
pub struct Requests {
    all: Vec<Request>,
    /// How many of them have been answered.
    answered: usize,
    /// Whether all were, before they were asked for anew.
    is_anew: bool,
    /// How often the next has been sent, and when last.
    sent: Option<(u8, Duration)>,
    /// When the one before was answered.
    completed: Duration,
}

impl Requests {
    /// Position, attitude, the geofence, and channels where they tell labels.
    pub fn new(labels: &Source) -> Self {
        let request = |id, name, is_needed| Request { id, name, is_needed };
        let mut all = vec![
            request(LOCAL_POSITION_NED_DATA::ID, LOCAL_POSITION_NED_DATA::NAME, true),
            request(ATTITUDE_DATA::ID, ATTITUDE_DATA::NAME, true),
            // Not every vehicle has a fence.
            request(FENCE_STATUS_DATA::ID, FENCE_STATUS_DATA::NAME, false),
        ];
        if matches!(labels, Source::Channel(_)) {
            all.push(request(RC_CHANNELS_DATA::ID, RC_CHANNELS_DATA::NAME, true));
        }
        Self { all, answered: 0, is_anew: false, sent: None, completed: Duration::ZERO }
    }

    /// Asks for another one, without which nothing can be flown.
    pub fn want(&mut self, id: u32, name: &'static str) {
        self.all.push(Request { id, name, is_needed: true });
    }

    /// Whether this message is asked for.
    pub fn has(&self, id: u32) -> bool {
        self.all.iter().any(|it| it.id == id)
    }

    /// The message whose request was never answered.
    pub fn missing(&self) -> Option<&'static str> {
        self.all.get(self.answered).filter(|_| !self.is_anew).map(|it| it.name)
    }

    /// Begins anew if all was answered some time ago.
    pub fn renew(&mut self, now: Duration) {
        if self.answered == self.all.len() && now >= self.completed + 4 * REPEAT {
            (self.answered, self.is_anew, self.sent) = (0, true, None);
        }
    }

    /// What is to be sent now.
    pub fn due(&mut self, envelope: Envelope) -> Option<MavMessage> {
        let request = self.all.get(self.answered)?;
        let repeats = match self.sent {
            Some((_, last)) if envelope.now < last + REPEAT => return None,
            Some((repeats, _)) => repeats.saturating_add(1),
            None if self.answered > 0 && envelope.now < self.completed + REPEAT => return None,
            None => 0,
        };
        self.sent = Some((repeats, envelope.now));
        Some(envelope.interval(request.id, INTERVAL, repeats))
    }

    /// Takes in an acknowledgement.
    ///
    /// # Errors
    /// When the vehicle declines what is needed.
    pub fn answer(&mut self, now: Duration, ack: &COMMAND_ACK_DATA) -> Result<(), Failure> {
        let Some(request) = self.all.get(self.answered) else { return Ok(()) };
        let is_answer = self.sent.is_some() && ack.command == MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL;
        match ack.result {
            // It is asked again.
            MavResult::MAV_RESULT_TEMPORARILY_REJECTED | MavResult::MAV_RESULT_IN_PROGRESS => {
                return Ok(());
            }
            MavResult::MAV_RESULT_ACCEPTED => {}
            other if is_answer && request.is_needed => {
                return Err(Failure::Declined(request.name, format!("{other:?}")));
            }
            _ => {}
        }
        if is_answer {
            self.answered += 1;
            (self.sent, self.completed) = (None, now);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_that_comes_twice_is_not_the_next_one_s() {
        let mut requests = Requests::new(&Source::Named("WET".to_owned()));
        let ack = COMMAND_ACK_DATA {
            command: MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
            result: MavResult::MAV_RESULT_ACCEPTED,
            ..COMMAND_ACK_DATA::default()
        };
        let mut asked = Vec::new();
        for tenth in 0..40 {
            let now = tenth * Duration::from_millis(100);
            if let Some(MavMessage::COMMAND_LONG(it)) = requests.due(Envelope { system: 1, now }) {
                asked.push((tenth, it.param1 as u32, it.confirmation));
                // The first is not answered; others are at once, and again later.
                if tenth == 0 {
                    continue;
                }
                requests.answer(now, &ack).expect("it is accepted");
            }
            if tenth % 5 == 3 {
                requests.answer(now, &ack).expect("it is accepted");
            }
        }
        assert_eq!(asked, [(0, 32, 0), (8, 30, 0), (13, 162, 0)]);
        assert_eq!(requests.missing(), None);
        // What does not arrive all the same is asked for anew, after a while.
        for (later, due) in [(3, None), (4, Some(32))] {
            let now = requests.completed + later * REPEAT;
            requests.renew(now);
            let asks = |it| match it {
                MavMessage::COMMAND_LONG(it) => it.param1 as u32,
                other => panic!("{other:?}"),
            };
            assert_eq!(requests.due(Envelope { system: 1, now }).map(asks), due);
            assert_eq!(requests.missing(), None);
        }
    }
}
