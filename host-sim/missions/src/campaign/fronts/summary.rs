//! What missions along fronts come to.

use serde::Serialize;

use crate::campaign::fronts::following::Flown;
use crate::campaign::fronts::who::Who;
use crate::campaign::spread::{rank, sorted};

/// What the missions of a planner come to.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Who follows.
    pub algorithm: Who,
    /// Missions a row.
    pub missions: u64,
    /// Seed of the ensemble.
    pub seed: u64,
    /// The longest motion, metres.
    pub reach: f64,
    /// The speed that a planner was told is that of the kind of front, times this.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub told_speed: Option<f64>,
    /// A row for each kind of front and each reliability of labels.
    pub rows: Vec<Row>,
}

/// What the missions along one kind of front come to. Distances are in metres, shares from 0 to 1. `None` is a figure of
/// a map without vertices, and the coverage of a planner that states no width.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// The kind of front.
    pub front: &'static str,
    /// Labels are true with this probability.
    pub p: f64,
    /// Distance of the vertices of all maps from the front: half are at most this.
    pub off_median: Option<f64>,
    /// The same: 95 % are at most this.
    pub off_p95: Option<f64>,
    /// The share of the vertices whose 90 % width holds the front.
    pub covers: Option<f64>,
    /// Metres driven a metre of front that was mapped, the median of missions.
    pub driven: Option<f64>,
    /// Metres of front that were mapped, the mean of missions.
    pub mapped: f64,
    /// Labels, the mean of missions.
    pub labels: f64,
    /// The share of missions in which the planner began again.
    pub began_again: f64,
    /// The share of missions that lost the front.
    pub lost: f64,
}

impl Row {
    /// Of these missions.
    pub fn of(front: &'static str, p: f64, flown: &[Flown]) -> Self {
        let vertices = || flown.iter().flat_map(|it| &it.vertices);
        let off = sorted(vertices().map(|it| it.off));
        let driven = sorted(flown.iter().map(|it| it.driven / it.followed.max(1.0)));
        let at = |of: &[f64], percent| of.get(rank(percent, of.len())).copied();
        let stated: Vec<_> = vertices().filter_map(|it| it.is_covered).collect();
        let covers = share(&stated, |it| *it);
        let mean = |of: fn(&Flown) -> f64| flown.iter().map(of).sum::<f64>() / flown.len() as f64;
        Self {
            front,
            p,
            off_median: at(&off, 50),
            off_p95: at(&off, 95),
            covers: (!stated.is_empty()).then_some(covers),
            driven: at(&driven, 50).filter(|_| !off.is_empty()),
            mapped: mean(|it| it.followed),
            labels: mean(|it| f64::from(it.labels)),
            began_again: share(flown, |it| it.restarts > 0),
            lost: share(flown, |it| it.is_lost),
        }
    }
}

fn share<T>(of: &[T], is: impl Fn(&T) -> bool) -> f64 {
    of.iter().filter(|it| is(it)).count() as f64 / of.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::campaign::fronts::following::Measured;

    fn mission(off: &[f64], half: Option<f64>, driven: f64, followed: f64) -> Flown {
        let vertex = |&off: &f64| Measured { off, is_covered: half.map(|half| off <= half) };
        let vertices = off.iter().map(vertex).collect();
        Flown { vertices, driven, followed, labels: 10, ..Flown::default() }
    }

    #[test]
    fn a_row_has_the_figures_of_its_missions() {
        let off: Vec<_> = (1..=19).map(f64::from).collect();
        let mut flown = [
            mission(&off, Some(10.0), 30.0, 20.0),
            mission(&[0.5], Some(0.1), 12.0, 10.0),
            mission(&[], None, 0.0, 0.0),
        ];
        (flown[1].restarts, flown[2].is_lost) = (2, true);
        let row = Row::of("a front", 0.9, &flown);
        // Of 20 numbers the 10th and the 19th.
        assert_eq!((row.off_median, row.off_p95), (Some(9.0), Some(18.0)));
        assert_eq!(row.covers, Some(0.5));
        assert_eq!((row.driven, row.mapped, row.labels), (Some(1.2), 10.0, 10.0));
        assert_eq!((row.began_again, row.lost), (1.0 / 3.0, 1.0 / 3.0));
        let none = Row::of("a front", 1.0, &flown[2..]);
        assert_eq!((none.off_median, none.covers, none.driven), (None, None, None));
    }
}
