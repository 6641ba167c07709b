//! The last labels, in order, and where they change.

use crate::belief::sample::{Label, Sample};
use crate::geometry::lattice::Site;

/// Labels that are remembered one by one.
pub(crate) const REMEMBERED: usize = 48;

/// The last labels, the newest at the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Recent {
    sites: [Site; REMEMBERED],
    /// A bit for each label, the newest in the highest one: set for +1.
    signs: u64,
    pub(crate) count: u8,
}

impl Recent {
    pub(crate) const NONE: Self = Self { sites: [Site::ORIGIN; REMEMBERED], signs: 0, count: 0 };

    /// Remembers one more, in place of the oldest if there is no room.
    pub(crate) fn push(&mut self, site: Site, label: Label) {
        self.sites.rotate_left(1);
        if let Some(last) = self.sites.last_mut() {
            *last = site;
        }
        self.signs = self.signs >> 1 | u64::from(label == Label::Positive) << 63;
        self.count = self.count.saturating_add(1).min(REMEMBERED as u8);
    }

    /// The labels, the oldest first.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Sample> + Clone {
        let unused = REMEMBERED.saturating_sub(self.count.into());
        let bits = 64 - REMEMBERED as u32;
        let signs = self.signs;
        self.sites.iter().zip(0_u32..).skip(unused).map(move |(site, k)| {
            let is_above = signs.checked_shr(bits + k).unwrap_or(0) & 1 == 1;
            let label = if is_above { Label::Positive } else { Label::Negative };
            Sample { site: *site, label }
        })
    }

    /// The newest labels, so many.
    pub(crate) fn newest(self, count: usize) -> Self {
        Self { count: self.count.min(count.min(REMEMBERED) as u8), ..self }
    }

    /// The two labels between which the boundary was crossed last: of all ways to cut the row of labels into three parts
    /// of alternating labels, the one that the most labels agree with. And how many more agree with it than with no cut.
    /// `None` if no cut does better.
    pub(crate) fn crossed(&self) -> Option<([Site; 2], i32)> {
        let sign = |it: Sample| if it.label == Label::Positive { 1 } else { -1 };
        let total: i32 = self.iter().map(sign).sum();
        // Both labellings of the parts: the middle may be +1 or -1.
        let better = [1, -1].map(|middle| self.cut(total, middle)).into_iter().flatten();
        let best = better.reduce(|a, b| if b.0 > a.0 { b } else { a });
        let gain = best.map(|(score, at)| (at, (score - total.abs()) / 2));
        gain.filter(|(_, gain)| *gain > 0)
    }

    /// The last two labels in a row that differ.
    pub(crate) fn changed(&self) -> Option<[Site; 2]> {
        let pairs = self.iter().zip(self.iter().skip(1));
        pairs.filter(|(a, b)| a.label != b.label).last().map(|(a, b)| [a.site, b.site])
    }

    /// The best cut with the middle part of this sign: how many more labels agree than disagree, and the sites about the
    /// last change.
    fn cut(&self, total: i32, middle: i32) -> Option<(i32, [Site; 2])> {
        let (mut sum, mut least, mut begin) = (0, 0, 0);
        let mut best: Option<(i32, usize, usize)> = None;
        for (k, it) in (1..).zip(self.iter()) {
            sum += if it.label == Label::Positive { middle } else { -middle };
            // The middle disagreed with the outside by as much as it agrees now.
            let score = 2 * (sum - least) - middle * total;
            if best.is_none_or(|(most, ..)| score > most) {
                best = Some((score, begin, k));
            }
            if sum < least {
                (least, begin) = (sum, k);
            }
        }
        let (score, begin, end) = best?;
        let change: usize = if end < usize::from(self.count) { end } else { begin };
        let mut about = self.iter().skip(change.checked_sub(1)?).map(|it| it.site);
        Some((score, [about.next()?, about.next()?]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::Draws;

    fn row(labels: &[bool]) -> Recent {
        let mut recent = Recent::NONE;
        for (k, is_above) in (0..).zip(labels) {
            let label = if *is_above { Label::Positive } else { Label::Negative };
            recent.push(Site::new(k, 0).unwrap(), label);
        }
        recent
    }

    /// Every pair of cuts, one after the other.
    fn twin(labels: &[bool]) -> (i32, i32) {
        let agree = |from: usize, to: usize, is_above: bool| {
            labels[from..to].iter().map(|it| if *it == is_above { 1 } else { -1 }).sum::<i32>()
        };
        let n = labels.len();
        let mut best = 0;
        let none = agree(0, n, true).abs();
        for a in 0..=n {
            for b in a..=n {
                for middle in [false, true] {
                    let score = agree(0, a, !middle) + agree(a, b, middle) + agree(b, n, !middle);
                    best = best.max(score);
                }
            }
        }
        (best, none)
    }

    #[test]
    fn the_last_change_is_between_the_labels_that_agree_the_most() {
        let at = |recent: &Recent| recent.crossed().map(|it| it.0.map(Site::x));
        assert_eq!(at(&row(&[true; 5])), None);
        assert_eq!(at(&row(&[true, true, false])), Some([1, 2]));
        assert_eq!(at(&row(&[true, false, false, false, true, true, true])), Some([3, 4]));
        let noisy = [false, false, true, false, false, true, true, true];
        assert_eq!(at(&row(&noisy)), Some([4, 5]));
        let mut draws = Draws::new(5);
        for _ in 0..300 {
            let count = 1 + draws.below(20) as usize;
            let labels: heapless::Vec<bool, 20> = (0..count).map(|_| draws.below(2) == 0).collect();
            let recent = row(&labels);
            let (best, none) = twin(&labels);
            let total = labels.iter().map(|it| if *it { 1 } else { -1 }).sum();
            let found = [1, -1].map(|it| recent.cut(total, it)).into_iter().flatten();
            let found = found.map(|it| it.0).max().unwrap_or(none);
            assert_eq!(recent.crossed().is_some(), best > none, "{labels:?}");
            assert!(best == none || found == best, "{labels:?}: {found}, {best}");
        }
    }

    #[test]
    fn the_oldest_are_forgotten() {
        let mut recent = Recent::NONE;
        for k in 0..100 {
            let label = if k % 3 == 0 { Label::Positive } else { Label::Negative };
            recent.push(Site::new(k, 0).unwrap(), label);
        }
        assert_eq!(recent.iter().count(), REMEMBERED);
        for (k, it) in (100 - REMEMBERED as i32..).zip(recent.iter()) {
            assert_eq!((it.site.x(), it.label == Label::Positive), (k, k % 3 == 0));
        }
    }
}
