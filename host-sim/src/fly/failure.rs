//! Why a flight ends before its mission does.

use std::fmt;
use std::time::Duration;

/// What went wrong.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// The vehicle is none that is known here.
    NotOurs(String),
    /// It was not ready within this time, and what was missing.
    NotReady(Duration, String),
    /// It does not send what is needed.
    Declined(&'static str, String),
    /// It stands where the scenario does not allow it to be.
    Misplaced(String),
    /// Another mode than guided: someone has taken over.
    TakenOver(String),
    /// Its autopilot was started anew.
    Restarted,
    /// It was disarmed.
    Disarmed,
    /// Its own failsafe has acted.
    Failsafe(String),
    /// It has left its geofence.
    Fence,
    /// Its geofence holds it back.
    HeldBack,
    /// It sent no heartbeat for this long.
    Silent(Duration),
    /// It sent no position for this long.
    Lost(Duration),
    /// Its position moved by this many metres, which its speed does not explain.
    Slid(f64),
    /// It did not reach its target within this time, and how far off it was.
    Late(Duration, String),
    /// No label arrived within this time, and its source.
    NoLabel(Duration, String),
    /// Its position is beyond the lattice.
    LatticeError,
    /// A label contradicts what is known.
    Refused(String),
    /// A signal to this program.
    Interrupted(i32),
    /// The link broke.
    Broken(String),
}

impl Failure {
    /// Whether nothing more may be sent, as someone else drives it now, or can be.
    pub const fn is_out_of_our_hands(&self) -> bool {
        matches!(self, Self::TakenOver(_) | Self::Restarted | Self::Broken(_))
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let s = |time: &Duration| time.as_secs_f64();
        match self {
            Self::NotOurs(found) => write!(
                f,
                "found {found}, expected ArduPilot on a rover (MAV_TYPE_GROUND_ROVER), a boat \
                 (MAV_TYPE_SURFACE_BOAT) or a submarine (MAV_TYPE_SUBMARINE)"
            ),
            Self::NotReady(time, missing) => {
                write!(f, "not ready within {} s (--wait): expected {missing}", s(time))
            }
            Self::Declined(message, how) => {
                write!(f, "the vehicle does not send {message}: {how}")
            }
            Self::Misplaced(why) => write!(f, "the vehicle stands where it may not be: {why}"),
            Self::TakenOver(mode) => {
                write!(f, "the mode is {mode}, no longer GUIDED: its failsafe or its operator")
            }
            Self::Restarted => f.write_str("the autopilot was started anew"),
            Self::Disarmed => f.write_str("the vehicle was disarmed"),
            Self::Failsafe(state) => write!(f, "the vehicle's failsafe has acted: {state}"),
            Self::Fence => f.write_str("the vehicle has left its geofence"),
            Self::HeldBack => f.write_str(
                "the vehicle's fence holds it back (breach_mitigation): the place it was sent to is too near \
                 the fence or beyond it",
            ),
            Self::Silent(time) => write!(f, "no heartbeat for {} s", s(time)),
            Self::Lost(time) => write!(f, "no position for {} s", s(time)),
            Self::Slid(metres) => write!(
                f,
                "its position slid by {metres:.1} m that its speed does not explain: its estimator or its origin \
                 was corrected, and what it sensed before lies elsewhere"
            ),
            Self::Late(time, off) => write!(f, "not there within {} s (--motion-time): {off}", s(time)),
            Self::NoLabel(time, source) => {
                write!(f, "no label within {} s (--label-time): {source}", s(time))
            }
            Self::LatticeError => f.write_str("the position is beyond 8192 m, or no number"),
            Self::Refused(why) => f.write_str(why),
            Self::Interrupted(signal) => write!(f, "interrupted by signal {signal}"),
            Self::Broken(why) => write!(f, "the link broke: {why}"),
        }
    }
}
