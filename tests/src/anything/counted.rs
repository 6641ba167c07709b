//! An area that counts what it is asked, so that the work of a plan is measured without a clock.

use std::cell::Cell;

use planner_core::{Area, Chart, HalfPlane, Obstacle, Site, Vector, Workspace};

thread_local! {
    static ASKED: Cell<u64> = const { Cell::new(0) };
}

/// An area that counts the corners of keep-outs that it compares, and one for each question.
#[derive(Clone, Copy, Debug)]
pub struct Counted<G>(pub G);

/// How much all counted areas of this thread were asked since the last call.
pub fn asked() -> u64 {
    ASKED.replace(0)
}

fn count(asked: usize) {
    ASKED.set(ASKED.get() + asked as u64);
}

impl<G: Workspace> Counted<G> {
    fn corners(&self) -> usize {
        self.0.keep_outs().map(|it| it.corners.len()).sum()
    }
}

impl<G: Workspace> Workspace for Counted<G> {
    fn bounds(&self) -> Area {
        self.0.bounds()
    }

    fn share_of_bounds(&self) -> f32 {
        self.0.share_of_bounds()
    }

    fn way_home(&self, from: Site) -> Vector {
        self.0.way_home(from)
    }

    fn inset(&self, margin: u32) -> Option<Self> {
        self.0.inset(margin).map(Self)
    }

    fn whole(&self) -> Self {
        Self(self.0.whole())
    }

    fn sides(&self) -> impl Iterator<Item = HalfPlane> {
        self.0.sides()
    }

    fn keep_outs(&self) -> impl Iterator<Item = Obstacle<'_>> {
        self.0.keep_outs()
    }

    fn chart(&self) -> Option<Chart<'_>> {
        self.0.chart()
    }

    fn encloses(&self, q: Site) -> bool {
        count(1);
        self.0.encloses(q)
    }

    fn contains(&self, q: Site) -> bool {
        count(1 + self.corners());
        self.0.contains(q)
    }

    fn contains_disc(&self, centre: Site, radius: i32) -> bool {
        count(1 + self.corners());
        self.0.contains_disc(centre, radius)
    }

    fn lets_pass(&self, swept: &[Site]) -> bool {
        count(1 + swept.len() * self.corners());
        self.0.lets_pass(swept)
    }
}
