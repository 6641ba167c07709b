//! The decision of look-ahead: the motion whose label, and the one after it, are worth the most together.

use crate::belief::cells::CellView;
use crate::belief::predictions::{Prediction, Predictor};
use crate::belief::sample::Label;
use crate::geometry::workspace::Workspace;
use crate::motion::action::Action;
use crate::motion::dynamics::{Dynamics, Pose, Side};
use crate::search::lookout::{Circles, ENOUGH, LookFor, Lookout, Prospect, few};

/// Circles on which the second step may end.
const SECOND_CIRCLES: Circles = Circles::Even(3);

/// Where no label is worth as much, turns in place are considered.
const POOR: f32 = 0.9;

/// What to do, and what the two labels after it are worth.
pub struct Decision {
    pub(crate) action: Action,
    pub(crate) target: Pose,
    pub(crate) worth: f32,
    pub(crate) wants_label: bool,
    /// Whether it is on the way to a place beyond the ends of one motion.
    pub(crate) is_far: bool,
}

impl Decision {
    /// The motion that is worth the most; `None` if no label is in reach.
    pub(crate) fn of<P: Predictor, D: Dynamics, G: Workspace>(
        (predictor, ground): (&P, CellView<'_>),
        lookout: &mut Lookout<'_, D, G>,
        pose: Pose,
    ) -> Option<Self> {
        let prospects = few(predictor, ground, lookout, pose);
        let mut best = None;
        for prospect in prospects.as_slice() {
            look_beyond(lookout, predictor, prospect, &mut best);
        }
        if prospects.as_slice().first().is_none_or(|first| first.worth < POOR) {
            for side in [Side::Left, Side::Right] {
                look_aside(lookout, predictor, ground, (pose, side), &mut best);
            }
        }
        best
    }

    /// Takes the place of the best so far, if this one is worth more.
    pub(crate) fn beat(self, best: &mut Option<Self>) {
        if is_better(self.worth, best.as_ref()) {
            *best = Some(self);
        }
    }
}

fn is_better(worth: f32, best: Option<&Decision>) -> bool {
    best.is_none_or(|it| worth > it.worth)
}

/// Considers a prospect, with the label after either label there.
fn look_beyond<P: Predictor, D: Dynamics, G: Workspace>(
    lookout: &mut Lookout<'_, D, G>,
    predictor: &P,
    &Prospect { action, target, share, worth }: &Prospect,
    best: &mut Option<Decision>,
) {
    let above = predictor.chance(target.site, share);
    // An upper bound at first. It is exact once both labels have been evaluated.
    let mut worth = worth + ENOUGH;
    for (label, chance) in [(Label::Positive, above), (Label::Negative, 1.0 - above)] {
        if !is_better(worth, best.as_ref()) {
            return;
        }
        let after = predictor.after(target.site, label);
        worth -= chance * (ENOUGH - second(lookout, &after, target, None));
    }
    Decision { action, target, worth, wants_label: true, is_far: false }.beat(best);
}

/// Considers a turn in place to a side. Nothing is learnt by it: what the next plan would refuse is worth nothing.
fn look_aside<P: Prediction, D: Dynamics, G: Workspace>(
    lookout: &mut Lookout<'_, D, G>,
    prediction: &P,
    ground: CellView<'_>,
    (pose, side): (Pose, Side),
    best: &mut Option<Decision>,
) {
    let Some((action, target)) = lookout.dynamics.turn_in_place(pose, side) else { return };
    let effort = lookout.dynamics.ray_of(pose, action).map_or(0, |ray| ray.turn_cost);
    let next = second(lookout, prediction, target, Some(ground));
    if next > 0.0 {
        let worth = next - lookout.cost(0, effort);
        Decision { action, target, worth, wants_label: false, is_far: false }.beat(best);
    }
}

/// The worth of the best label after one more motion; 0 if there is none. If `ground` is given, only ends count on
/// which these lines disagree.
fn second<D: Dynamics, P: Prediction, G: Workspace>(
    lookout: &mut Lookout<'_, D, G>,
    prediction: &P,
    pose: Pose,
    ground: Option<CellView<'_>>,
) -> f32 {
    let mut most = 0.0;
    lookout.look(
        prediction,
        pose,
        (SECOND_CIRCLES, lookout.usual),
        &mut LookFor::Worth(&mut most, ground),
    );
    most
}
