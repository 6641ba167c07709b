//! What a flight waits for before it begins.

use std::time::Duration;

use mavlink::MessageData as _;
use mavlink::dialects::common::GPS_GLOBAL_ORIGIN_DATA;

use crate::fly::failure::Failure;
use crate::fly::pilot::Pilot;
use crate::fly::stage::Stage;
use crate::fly::vehicle::News;

impl Pilot {
    /// Before the flight a fault is no failure: its end is waited for. Where an operator drives, labels are taken.
    pub(super) fn attend(&mut self, now: Duration, complete: Option<Duration>, news: News) {
        if self.unheard(now).is_some() || self.requests.missing().is_some() {
            return;
        }
        let Some(by_hand) = &mut self.by_hand else { return };
        let came = match news {
            News::Fix(fix) => by_hand.locate(fix),
            News::Restart | News::Moved(_) => by_hand.moved(),
            News::Label(told) => return by_hand.hear(told),
            News::Status(_) | News::Breach | News::HeldBack => None,
        };
        if came.is_some() {
            // The wait begins anew.
            self.stage = Stage::Preparing { since: Some(now), complete };
        }
        self.news_by_hand.extend(came);
    }

    /// The first needed message that was not heard, in words.
    pub(super) fn unheard(&self, now: Duration) -> Option<String> {
        if self.fix(now).is_none() {
            Some(
                "its local position (LOCAL_POSITION_NED): without a fix its estimator has no origin until a ground \
                 station sets one (SET_GPS_GLOBAL_ORIGIN)"
                    .to_owned(),
            )
        } else if self.vehicle.origin.is_none() && self.requests.has(GPS_GLOBAL_ORIGIN_DATA::ID) {
            Some("where its local positions count from (GPS_GLOBAL_ORIGIN)".to_owned())
        } else if self.vehicle.facing.is_none() {
            Some("its attitude (ATTITUDE)".to_owned())
        } else if self.vehicle.label.is_none() {
            Some(self.labels.source.to_string())
        } else {
            None
        }
    }

    /// What is missing before the flight can begin, for people.
    pub fn missing(&self, now: Duration) -> Option<String> {
        let Some(status) = self.status(now) else {
            return Some(format!("a heartbeat of system {}", self.system));
        };
        if let Some(message) = self.requests.missing() {
            return Some(format!(
                "its word that it sends {message}: it answers no command if it obeys another station than system 255 \
                 (SYSID_MYGCS), or if its link is signed, as `fly` signs nothing"
            ));
        }
        if let Some(unheard) = self.unheard(now) {
            return Some(unheard);
        }
        match status.fault() {
            Some(Failure::TakenOver(mode)) if self.by_hand.is_some() => Some(format!(
                "mode GUIDED, it is in {mode}: until then a label is taken wherever it rests"
            )),
            Some(Failure::TakenOver(mode)) => Some(format!("mode GUIDED, it is in {mode}")),
            Some(Failure::Restarted) => Some("its autopilot to have started".to_owned()),
            Some(Failure::Disarmed) => Some("its operator to arm it".to_owned()),
            Some(other) => Some(format!("a vehicle that is well: {other}")),
            None if self.vehicle.is_outside => Some("a vehicle inside its geofence".to_owned()),
            None => None,
        }
    }
}
