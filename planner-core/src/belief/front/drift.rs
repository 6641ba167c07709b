//! What becomes of a belief as time passes and a robot goes on.
//!
//! A front that moves diffuses. Ahead of a robot, a front that bends may bend otherwise. The cells are laid anew once a
//! motion, after the label at its end. If more than a unit of time has passed, room is made before as well.

use crate::belief::front::lay::{limited, metres};
use crate::belief::front::tracker::Tracker;
use crate::geometry::approximate::sqrt;
use crate::geometry::lattice::Site;

/// This share of the mass is spread over all cells with each label, unless the front is straight and still.
const EVEN: f32 = 1e-5;

/// In a unit of time half of this share of a layer's mass passes to each neighbouring layer. The first share is for a
/// robot that goes along the front, the second for one that [stays](Tracker::staying).
const BENDS: [f32; 2] = [0.18, 0.025];

/// A layer stands for all curvatures near its own. On its way, a curve strays from it by this share of what the tightest
/// bend turns.
const STRAYS: f32 = 0.1;

/// The deviation of what a front moves across itself in a unit of time, as a share of its speed: for the same two.
///
/// A front moves in any direction, so across itself by some half of that. The share is 0.71 where it always moves so
/// fast, and 0.41 where all speeds up to it are as likely. It goes on in its direction. So it has moved more where a robot
/// returns to a place.
const ACROSS: [f32; 2] = [0.5, 1.2];

/// A front that moves by so many metres may turn by a radian.
const LEVER: f32 = 30.0;

/// Room for diffusion, in its deviations.
const ROOM: f32 = 3.0;

/// Offsets have no room to diffuse where this share of the mass is in the cells at their ends.
const FULL: f32 = 0.05;

impl<const K: usize, const M: usize, const L: usize> Tracker<K, M, L> {
    /// Records that a robot has come to a site, and how much time has passed. By then the front may have moved, and
    /// ahead of the robot it may bend otherwise. A straight front that does not move stays as it is known.
    ///
    /// Call it once a motion. Then [observe](crate::Belief::observe) the label at its end, or [`settle`](Self::settle) if
    /// there is none. The unit of time is the one of the front's [`speed`](crate::Front::speed), and one motion should take
    /// about one. Of more than 16 units, 16 count. Some 25,000 instructions for 16 x 16 x 3, and 45,000 where the front moves
    /// by more than a cell.
    pub fn moved(&mut self, to: Site, elapsed: f32) {
        let (bend, pace) = (self.grid.lay.bend, self.front.pace());
        let passes = elapsed > 0.0;
        if !passes || !self.forgets() {
            return;
        }
        let elapsed = if elapsed < 16.0 { elapsed } else { 16.0 };
        let deviation = self.drifts(ACROSS) * pace * sqrt(elapsed);
        if elapsed > 1.0 {
            self.make_room(to, deviation);
        }
        let lay = self.grid.lay;
        let [x, z] = metres(to - lay.pivot);
        let way = if bend > 0.0 { limited(sqrt(x * x + z * z), 0.5 / bend) } else { 0.0 };
        let strays = STRAYS * bend * way;
        let aside = 0.5 * strays * way;
        let per_lever = deviation / LEVER;
        self.grid.blur_offsets((aside * aside + deviation * deviation) / (lay.step * lay.step));
        self.grid.mix_columns((strays * strays + per_lever * per_lever) / (lay.turn * lay.turn));
        if bend > 0.0 {
            let share = 0.5 * self.drifts(BENDS) * elapsed;
            self.grid.mix_layers(if share < 0.25 { share } else { 0.25 });
        }
    }

    /// Of two constants the one for what the robot does.
    fn drifts(&self, [along, stays]: [f32; 2]) -> f32 {
        if self.stays { stays } else { along }
    }

    /// Whether the front may move or bend.
    fn forgets(&self) -> bool {
        self.grid.lay.bend > 0.0 || self.front.pace() > 0.0
    }

    /// The share of the mass that is spread over all cells with a label.
    pub(super) fn spreads(&self) -> f32 {
        if self.forgets() { EVEN } else { 0.0 }
    }

    /// Lays the cells anew where a robot is. A label does so by itself: call it after a motion without one. Some 75,000
    /// instructions for 16 x 16 x 3.
    pub fn settle(&mut self, site: Site) {
        self.make_room(site, self.front.pace());
        self.heard = site;
    }

    /// Lays the cells anew, with room for offsets that will diffuse by a deviation, metres. Tails that end within the cells
    /// have room for a small one.
    fn make_room(&mut self, robot: Site, deviation: f32) {
        let is_full = || self.grid.at_edges() > FULL * (1.0 - self.share_nowhere());
        let wants = deviation > 0.0 && (deviation > 0.5 * self.grid.lay.step || is_full());
        let margin = if wants { ROOM * deviation } else { 0.0 };
        self.grid.lay_around(Some(robot), margin);
    }
}
