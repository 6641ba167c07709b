//! What a robot knows of a front that only compares each label with the one before: where they differ it has crossed
//! the front.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Point2, Vector2};
use planner_core::error::ObservationError;
use planner_core::{
    Area, Belief, Criterion, Estimates, Goal, Label, LocalLine, Reading, Sample, Site, Tolerance,
};

/// The labels read last, and where the front was crossed.
#[derive(Clone, Debug)]
pub struct Crossings {
    /// The direction of the front about the start by the given points, radians: its +1 side is to the left.
    pub angle: f64,
    last: Option<(Site, Label)>,
    /// The middle between the two labels read last, if they differ.
    pub crossing: Option<Point2<f64>>,
}

impl Crossings {
    /// Of the given points only the middles of both labels count.
    pub fn given(given: &[Sample]) -> Self {
        let middle = |label| {
            let sites = given.iter().filter(|it| it.label == label).map(|it| it.site);
            let sites: Vec<_> = sites.map(|site| Point2::<f64>::from(site).coords).collect();
            sites.iter().sum::<Vector2<f64>>() / sites.len().max(1) as f64
        };
        let across = middle(Label::Positive) - middle(Label::Negative);
        let angle = libm::atan2(across.y, across.x) - FRAC_PI_2;
        Self { angle, last: None, crossing: None }
    }

    /// The label read last.
    pub fn label(&self) -> Option<Label> {
        self.last.map(|it| it.1)
    }

    /// The direction of the front about the start that is nearer to a heading, radians, and whether the front's +1 side
    /// is then to the left.
    pub fn ahead(&self, heading: f64) -> (f64, bool) {
        let agrees = libm::cos(heading - self.angle) > 0.0;
        (if agrees { self.angle } else { self.angle + PI }, agrees)
    }
}

impl Belief for Crossings {
    fn is_full(&self) -> bool {
        false
    }

    fn observe_on_the_way(&mut self, _: Site, _: Reading) -> Result<bool, ObservationError> {
        Ok(false)
    }

    fn tolerance(&self) -> Tolerance {
        Tolerance::NONE
    }

    fn observe_within(
        &mut self,
        site: Site,
        reading: Reading,
        _: Tolerance,
    ) -> Result<(), ObservationError> {
        self.crossing = None;
        if let Reading::Side(label) = reading {
            if let Some((before, _)) = self.last.filter(|it| it.1 != label) {
                let [from, to] = [before, site].map(Point2::<f64>::from);
                self.crossing = Some(from + (to - from) * 0.5);
            }
            self.last = Some((site, label));
        }
        Ok(())
    }

    fn estimates(&self) -> Estimates {
        Estimates { bisector: None, centre: None, maximum_margin: None }
    }

    fn centre(&self) -> Option<LocalLine> {
        None
    }

    fn information(&self) -> f64 {
        0.0
    }

    fn meets<C: Criterion>(&self, _: Goal<C>, _: Area) -> bool {
        false
    }

    fn chance(&self, _: Site) -> f64 {
        0.5
    }
}
