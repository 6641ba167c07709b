//! A fast, approximate distribution over lines, used to predict what the next labels would say.
//!
//! `K` directions represent all lines. Lines of one direction differ only in their offset, and a column stores their
//! distribution over the offset almost exactly. The share of the lines that have a place on their +1 side is the mass
//! below that place, summed over the columns. The share after one more label, which is not taken yet, is a sum over the
//! same columns ([`After`]). So looking two labels ahead copies nothing.
//!
//! The columns are rebuilt from the samples and from a table of hypotheses, in directions in which the table's lines
//! lie. So they follow the distribution however narrow it becomes, and errors do not accumulate. The table is exact and
//! slow; the columns are for predictions.
//!
//! The errors of the share were measured over missions of up to 30 labels, true with a probability from 0.6 to 0.9999.
//! The places are those where the share is from 0.1 to 0.9 (`LONG=1 cargo test -p tests columns::`):
//!
//! | directions | mean error | worst error seen |
//! | --- | --- | --- |
//! | 16 | 0.007 | 0.08 |
//! | 24 | 0.005 | 0.06 |
//! | 32 | 0.004 | 0.04 |
//!
//! The columns use the area prior, uniform over lines, whatever the table's prior is.

use crate::belief::doubtful_labels::CellPosterior;
use crate::belief::list::List;
use crate::belief::predictions::column::{
    Column, CountDensity, Density, LogStep, SumDensity, Threshold, exp,
};
use crate::belief::predictions::directions::{Direction, directions};
use crate::belief::predictions::spread::{Covariance, LineSums, Stretch, Whole};
use crate::belief::reliability::Reliability;
use crate::belief::sample::{Label, Sample};
use crate::belief::trust::Trust;
use crate::geometry::approximate::precise_heading_of;
use crate::geometry::lattice::{Site, Vector};

/// A column's mass is limited to this many times the mean (truncated importance sampling). One direction in some
/// thousand meets a thin hypothesis by chance and would otherwise represent much more than that.
const MOST: f32 = 3.0;

/// The lines of `K` directions. `136 K` bytes and 12: 2.2 kB for 16 directions.
#[derive(Clone, Debug)]
pub(super) struct Columns<const K: usize> {
    view: NearSites,
    /// Those of each direction.
    lines: [Column; K],
}

impl<const K: usize> Columns<K> {
    /// No line: memory to [`lay`](Self::lay) columns in.
    pub(super) const NONE: Self = {
        assert!(K >= 1, "there is at least one direction");
        Self { view: NearSites { from: Site::ORIGIN, shift: 0 }, lines: [Column::NONE; K] }
    };

    /// Computes the columns from the given samples of a table and the labels that it has taken in since. `believed`
    /// contains the reliability of each label. The directions are those of the table's lines.
    ///
    /// `O(H + K S)`: some 150,000 instructions for 30 labels and 16 directions. Where nobody knows the reliability, every
    /// label that is not certain counts alike.
    pub(super) fn lay<const N: usize, const H: usize, const E: usize, R: Trust>(
        &mut self,
        table: &CellPosterior<N, H, E, R>,
        believed: &[Reliability],
    ) {
        let support = table.start().support().map(|sample| (sample, Reliability::CERTAIN));
        let labels = table.labels().iter().copied().zip(believed.iter().copied());
        let samples = || labels.clone().chain(support.clone());
        let latest = labels.clone().next_back().or_else(|| samples().next());
        let from = latest.map_or(Site::ORIGIN, |(latest, _)| latest.site);
        self.view = NearSites::of(from, samples().map(|(sample, _)| sample.site));
        // Each of its samples at most: there is room.
        let mut thresholds: List<Threshold, N> = List::filled(Threshold::NONE);
        let prior = table.noise().reliability.unknown();
        for (Sample { site, label }, reliability) in samples() {
            let place = self.view.vector(site);
            let _ = thresholds.push(if prior.is_some() && reliability != Reliability::CERTAIN {
                Threshold::counting(place, label)
            } else {
                Threshold::new(place, LogStep::of(label, reliability))
            });
        }
        let directions: [Direction; K] = directions(table);
        let mut peaks = [None; K];
        if let Some(prior) = prior {
            let doubtful = || labels.clone().filter(|(_, it)| *it != Reliability::CERTAIN);
            let first = doubtful().filter(|(it, _)| it.label == Label::Positive).count() as i32;
            let mut logs: List<i32, N> = List::filled(0);
            prior.likelihoods(doubtful().count() as u8, |log| {
                let _ = logs.push((log.0 >> 16) as i32); // there are more samples than labels
            });
            let density = CountDensity { logs: &logs, first, peak: 0 };
            lay_each(&mut self.lines, &directions, &mut thresholds, &mut peaks, density);
        } else {
            lay_each(&mut self.lines, &directions, &mut thresholds, &mut peaks, SumDensity);
        }
        cut(&mut self.lines);
    }

    /// The mass of the lines in each column that have a site on their +1 side. All lines together have mass 1.
    pub(super) fn heights(&self, site: Site) -> [f32; K] {
        let place = self.view.vector(site);
        self.lines.each_ref().map(|column| column.mass_above(place))
    }

    /// The share of the lines that have a site on their +1 side, as
    /// [`PosteriorView::share_above`](crate::belief::doubtful_labels::PosteriorView::share_above). Some 850 instructions for 16
    /// directions, however many labels there are.
    pub(super) fn share_above(&self, site: Site) -> f32 {
        let place = self.view.vector(site);
        self.lines.iter().map(|column| column.mass_above(place)).sum()
    }

    /// How far the lines lie apart over a stretch.
    pub(super) fn spread(&self, over: &Stretch) -> ColumnSpread<'_, K> {
        let direction = precise_heading_of(over.along).unit();
        let middle = self.view.vector(over.middle);
        let turns = self.lines.each_ref().map(|column| column.turn_from(direction));
        let (mut sums, mut squares) = (LineSums::default(), [0.0; 3]);
        for (column, &turn) in self.lines.iter().zip(&turns) {
            let [mass, offset, square] = column.moments_above(None, middle);
            sums.add(mass, [0.0, turn]);
            sums.offset += offset;
            squares[0] += square;
            squares[1] += offset * turn;
            squares[2] += mass * turn * turn;
        }
        // A quarter of a unit of the view is a unit of offsets.
        let length = 0.25 * over.length * (1_u32 << self.view.shift) as f32;
        ColumnSpread {
            columns: self,
            middle,
            turns,
            sums,
            whole: Whole::new(sums, squares, length),
        }
    }

    /// The columns after a label is read at the site whose [`heights`](Self::heights) these are. Labels there are true
    /// with probability `p`. A label that is almost impossible changes nothing, as single precision has no digits left
    /// for it.
    pub(super) fn after(&self, heights: [f32; K], label: Label, p: f32) -> After<'_, K> {
        let above: f32 = heights.iter().sum();
        let (plus, minus) = match label {
            Label::Positive => (p, 1.0 - p),
            Label::Negative => (1.0 - p, p),
        };
        let chance = plus * above + minus * (1.0 - above);
        let (plus, minus) =
            if chance > 1e-5 { (plus / chance, minus / chance) } else { (1.0, 1.0) };
        After { columns: self, heights, plus, minus }
    }
}

/// Columns as they will be after one more label.
#[derive(Clone, Copy, Debug)]
pub(super) struct After<'a, const K: usize> {
    columns: &'a Columns<K>,
    /// The [`heights`](Columns::heights) of the label's site.
    heights: [f32; K],
    /// The weight of the lines that have the label's site on their +1 side.
    plus: f32,
    /// The weight of the others.
    minus: f32,
}

/// How far the lines of columns lie apart over a stretch.
#[derive(Clone, Copy, Debug)]
pub(super) struct ColumnSpread<'a, const K: usize> {
    columns: &'a Columns<K>,
    middle: Vector,
    /// That of each column against the stretch.
    turns: [f32; K],
    /// All lines.
    sums: LineSums,
    pub(crate) whole: Whole,
}

impl<const K: usize> ColumnSpread<'_, K> {
    /// See [`Spread::after`](crate::belief::predictions::Spread::after), of a label that is true with probability `p`.
    pub(super) fn after(&self, site: Site, p: f32) -> Covariance {
        let place = self.columns.view.vector(site);
        let mut sums = LineSums::default();
        for (column, &turn) in self.columns.lines.iter().zip(&self.turns) {
            let [mass, offset, _] = column.moments_above(Some(place), self.middle);
            sums.add(mass, [0.0, turn]);
            sums.offset += offset;
        }
        self.whole.after([sums, self.sums.without(sums)], p, 1.0)
    }
}

impl<const K: usize> After<'_, K> {
    /// The share of the lines that will have another site on their +1 side. In each direction, the lines with both
    /// sites on their +1 side are those with the lower site there.
    pub(super) fn share_above(&self, site: Site) -> f32 {
        let place = self.columns.view.vector(site);
        let (mut above, mut above_both) = (0.0, 0.0);
        for (column, &first) in self.columns.lines.iter().zip(&self.heights) {
            let second = column.mass_above(place);
            above += second;
            above_both += if first < second { first } else { second };
        }
        self.plus * above_both + self.minus * (above - above_both)
    }
}

/// Computes a column for each direction and makes the columns comparable. Each represents an equal part of the density
/// from which its direction was drawn. So its true mass is divided by that density.
#[inline(never)] // and with slices, or loops are unrolled for their number
fn lay_each<const N: usize>(
    columns: &mut [Column],
    directions: &[Direction],
    thresholds: &mut List<Threshold, N>,
    peaks: &mut [Option<i32>],
    density: impl Density,
) {
    for ((column, direction), peak) in columns.iter_mut().zip(directions).zip(&mut *peaks) {
        *peak = column.lay(direction.heading.unit(), thresholds, density);
    }
    let highest = peaks.iter().flatten().max().copied().unwrap_or(0);
    for ((column, direction), peak) in columns.iter_mut().zip(directions).zip(peaks) {
        if let Some(peak) = peak {
            column.scale(exp(*peak - highest) / direction.density);
        }
    }
}

/// Makes the mass of all columns 1, and none of them too heavy.
#[inline(never)] // as above
fn cut(columns: &mut [Column]) {
    let sum: f32 = columns.iter().map(Column::mass).sum();
    let most = MOST / columns.len() as f32 * sum;
    let cut = |mass: f32| if mass < most { mass } else { most };
    let total: f32 = columns.iter().map(|column| cut(column.mass())).sum();
    for column in columns {
        let mass = column.mass();
        if mass > 0.0 {
            column.scale(cut(mass) / mass / total); // a product could be too small for a number
        }
    }
}

/// Sites relative to the latest sample, which is near the line. The units are as fine as fit, so that products keep all
/// digits.
#[derive(Clone, Copy, Debug)]
struct NearSites {
    from: Site,
    /// Bits by which a lattice unit is longer.
    shift: u32,
}

impl NearSites {
    /// From a site, so that some samples fit.
    fn of(from: Site, samples: impl Iterator<Item = Site>) -> Self {
        let size = |v: Vector| v.x.unsigned_abs() | v.z.unsigned_abs();
        let sizes = samples.fold(0, |sizes, site| sizes | size(site - from));
        // A bit for the sign, and one for places that are farther off.
        Self { from, shift: sizes.leading_zeros().saturating_sub(2) }
    }

    /// A place that is more than twice as far off as any sample, in a coordinate, is taken to be no farther.
    fn vector(self, site: Site) -> Vector {
        let most = i32::MAX >> self.shift;
        let fit = |units: i32| units.max(-most).min(most) << self.shift;
        let v = site - self.from;
        Vector { x: fit(v.x), z: fit(v.z) }
    }
}

#[cfg(test)]
mod tests {
    use heapless::Vec;

    use super::*;
    use crate::belief::noise::Noise;
    use crate::belief::weight::Prior;

    fn at(x: i32, z: i32) -> Site {
        Site::new(x << 16, z << 16).unwrap()
    }

    fn sample(x: i32, z: i32, label: Label) -> Sample {
        Sample { site: at(x, z), label }
    }

    /// What four points and some labels leave.
    fn columns(labels: &[(Sample, f64)]) -> Columns<16> {
        use Label::{Negative, Positive};
        let given = [(0, 0, Negative), (0, 4, Positive), (9, 5, Positive), (10, 0, Negative)]
            .map(|(x, z, label)| sample(x, z, label));
        let mut table = CellPosterior::<12, 40>::new(&given, Prior::Area, Noise::NONE).unwrap();
        let mut columns = Columns::NONE;
        let believed: Vec<Reliability, 12> =
            labels.iter().map(|(_, p)| Reliability::new(*p).unwrap()).collect();
        for ((sample, _), reliability) in labels.iter().zip(&believed) {
            table.take(*sample, *reliability).unwrap();
        }
        columns.lay(&table, &believed);
        columns
    }

    const LABELS: [(Sample, f64); 3] = [
        (Sample { site: Site::ORIGIN, label: Label::Negative }, 0.5),
        (Sample { site: Site::ORIGIN, label: Label::Negative }, 0.9),
        (Sample { site: Site::ORIGIN, label: Label::Negative }, 1.0),
    ];

    #[test]
    fn all_lines_lie_between_the_given_points() {
        for labels in [&[][..], &LABELS] {
            let columns = columns(labels);
            for (x, z, share) in [(5, 9, 1.0), (0, 4, 1.0), (0, 0, 0.0), (5, -90, 0.0)] {
                assert!((columns.share_above(at(x, z)) - share).abs() < 1e-5, "({x}, {z})");
            }
            let shares = [1, 2, 3].map(|z| columns.share_above(at(5, z)));
            assert!(0.01 < shares[0] && shares[0] < shares[1] && shares[1] < shares[2]);
            let sum: f32 = columns.heights(at(5, 2)).iter().sum();
            assert!((sum - shares[1]).abs() < 1e-6);
        }
    }

    #[test]
    fn a_certain_label_leaves_no_line_beyond() {
        let above = sample(5, 2, Label::Positive);
        for (p, share) in [(1.0, 1.0), (0.0, 0.0)] {
            let columns = columns(&[(sample(4, 3, Label::Positive), 0.7), (above, p)]);
            assert!((columns.share_above(above.site) - share).abs() < 1e-5);
        }
    }

    #[test]
    fn directions_that_hardly_any_line_has_are_numbers() {
        let mut columns = columns(&LABELS);
        columns.lines.iter_mut().for_each(|column| column.scale(1e-12));
        columns.lines[0].scale(1e-24);
        cut(&mut columns.lines);
        let sum: f32 = columns.heights(at(5, 9)).iter().sum();
        assert!((sum - 1.0).abs() < 1e-5, "{sum}");
    }

    #[test]
    fn labels_of_one_place_that_cancel_out_say_nothing() {
        let label = |n| if n < 4 { Label::Negative } else { Label::Positive };
        let labels: [_; 8] = core::array::from_fn(|n| (sample(5, 2, label(n)), 1.0 - 1e-6));
        let [with, without] = [&labels[..], &[]].map(|it| columns(it).share_above(at(5, 3)));
        assert!((with - without).abs() < 0.02, "{with} for {without}");
    }

    #[test]
    fn a_strip_of_micrometres_is_followed() {
        // Two lattice units wide, 10 m long: directions within 6e-6 rad, which a rough heading would miss.
        let near = |x: i32, units: i32, label| {
            let site = Site::new(x << 16, (1 << 16) + 17_389 * x + units).unwrap();
            (Sample { site, label }, 1.0)
        };
        let labels = [(0, 0), (0, 2), (10, 0), (10, 2)].map(|(x, units)| {
            near(x, units, if units > 0 { Label::Positive } else { Label::Negative })
        });
        let columns = columns(&labels);
        // On either side of the middle there is as much; along the diagonals the lines cross.
        for (x, units, share) in [(5, 1, 0.5), (2, 1, 0.5), (5, 0, 0.0), (5, 2, 1.0)] {
            let got = columns.share_above(near(x, units, Label::Positive).0.site);
            assert!((got - share).abs() < 0.02, "({x}, {units}): {got}");
        }
    }

    #[test]
    fn what_comes_after_a_label_follows_from_bayes() {
        let columns = columns(&[(sample(4, 1, Label::Positive), 0.8)]);
        let site = at(6, 2);
        let (heights, share) = (columns.heights(site), columns.share_above(site));
        for (label, p) in [(Label::Positive, 0.9), (Label::Negative, 0.6), (Label::Negative, 1.0)] {
            let agrees = |above: f32| if label == Label::Positive { above } else { 1.0 - above };
            let chance = p * agrees(share) + (1.0 - p) * (1.0 - agrees(share));
            let exact = share * agrees(p) / chance;
            let got = columns.after(heights, label, p).share_above(site);
            assert!((got - exact).abs() < 1e-6, "{label:?} {p}: {got} for {exact}");
        }
        let nothing = columns.after(heights, Label::Positive, 0.5);
        let impossible = columns.after(columns.heights(at(0, 4)), Label::Negative, 1.0);
        for after in [nothing, impossible] {
            assert!((after.share_above(at(3, 2)) - columns.share_above(at(3, 2))).abs() < 1e-6);
        }
    }

    #[test]
    fn it_holds_as_little_as_it_says() {
        assert_eq!(size_of::<Columns<16>>(), 136 * 16 + 12);
    }
}
