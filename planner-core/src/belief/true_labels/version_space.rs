//! The version space: all lines that agree with every sample, and what can be read off it.

use crate::belief::cells::{CellView, Certainty, Constraint, Cut, CutError, DualCell};
use crate::belief::estimate::{Estimates, area, bisector, centre, maximum_margin, share_above};
use crate::belief::goal::{Criterion, Goal};
use crate::belief::sample::{Label, Reading, Sample, SampleBuffer};
use crate::belief::tolerance::Tolerance;
use crate::belief::true_labels::given::{GivenError, directions_left, first_inseparable_collinear};
use crate::belief::true_labels::room::{Spare, spare};
use crate::belief::{Belief, ObservationError};
use crate::geometry::arc::SlopeArc;
use crate::geometry::area::Area;
use crate::geometry::lattice::{Site, Vector};
use crate::geometry::line::Bound;
use crate::geometry::local_line::LocalLine;

/// All lines that agree with the samples (the field's name for the paper's "bounds"), with room for `N` of them.
///
/// The [`DualCell`] names the samples that still matter. When the buffer is full, a sample goes that does not bound the
/// lines left: see [`insert`](Self::insert). So a mission of thousands of labels runs in the memory of some 32 samples.
#[derive(Clone, Debug)]
pub struct VersionSpace<const N: usize> {
    samples: SampleBuffer<N>,
    /// How many of them were given at the start. It is a whole word, so that the cell begins at a word.
    given: usize,
    cell: DualCell<N>,
    /// How far off a position may be at most.
    tolerance: Tolerance,
    /// How far off the next position is expected to be, which is as far as the last; and the shift that follows from
    /// it.
    expected: Tolerance,
    shift: Vector,
}

impl<const N: usize> VersionSpace<N> {
    /// The version space of samples of both labels that are not collinear: the given samples of a mission (the paper's
    /// oracle points), or all of its samples. `O(n^2)` orientations.
    ///
    /// # Errors
    /// [`GivenError`].
    pub fn new(samples: &[Sample]) -> Result<Self, GivenError> {
        let mut buffer = SampleBuffer::new();
        for &sample in samples {
            buffer.push(sample).map_err(|_| GivenError::TooMany)?;
        }
        let first = samples.first().ok_or(GivenError::Collinear)?;
        let edges = || (0u8..).zip(samples).map(|(i, sample)| Constraint::new(i, sample.label));
        // Three samples that are not collinear make the first cell: the first of all, the first at another
        // site, and the first beside the line through these.
        let a = Constraint::new(0, first.label);
        let elsewhere = edges().zip(samples).find(|(_, sample)| sample.site != first.site);
        let triangle = elsewhere
            .and_then(|(b, _)| edges().find_map(|c| DualCell::triangle(&buffer, [a, b, c])));
        let Some(mut cell) = triangle else {
            let inseparable = first_inseparable_collinear(samples);
            return Err(inseparable.map_or(GivenError::Collinear, GivenError::NotSeparable));
        };
        for (i, edge) in edges().enumerate() {
            cell.cut(&buffer, edge).map_err(|_| GivenError::NotSeparable(i))?;
        }
        if samples.iter().all(|s| s.label == first.label) {
            return Err(GivenError::OneLabel);
        }
        let (tolerance, shift) = (Tolerance::NONE, Vector::default());
        let (expected, given) = (tolerance, samples.len());
        Ok(Self { samples: buffer, given, cell, tolerance, expected, shift })
    }

    /// The version space of samples whose positions may be off, each by a tolerance of its own. It keeps every line
    /// that agrees with some place within the tolerance of each sample.
    ///
    /// [`given`](Self::given) then returns the shifted samples. They can be given to a
    /// [`CellPosterior`](crate::belief::doubtful_labels::CellPosterior) as well.
    ///
    /// Every two samples of opposite labels exclude directions, however their positions err. The remaining directions
    /// determine by how much samples are [shifted](crate::Tolerance). The remaining lines then have fewer
    /// directions, so the shift is computed again, three times in all. `O(n^2)` for `n` samples, in double precision,
    /// the same on every machine.
    ///
    /// # Errors
    /// As [`new`](Self::new) of the shifted samples, and [`GivenError::TooVague`].
    pub fn of_uncertain(samples: &[(Sample, Tolerance)]) -> Result<Self, GivenError> {
        let mut slopes = directions_left(samples).ok_or(GivenError::TooVague)?;
        for _ in 1..3 {
            slopes = Self::shifted(samples, slopes)?.slope_arc();
        }
        Self::shifted(samples, slopes)
    }

    /// The version space of samples, each shifted by what it takes when the lines' slopes are these.
    fn shifted(samples: &[(Sample, Tolerance)], slopes: SlopeArc) -> Result<Self, GivenError> {
        let mut shifted: heapless::Vec<Sample, N> = heapless::Vec::new();
        for &(Sample { site, label }, tolerance) in samples {
            let shift = tolerance.shift(slopes).ok_or(GivenError::TooVague)?;
            let shift = if label == Label::Positive { shift } else { shift.reversed() };
            let site = site.step(shift).map_err(|_| GivenError::TooVague)?;
            shifted.push(Sample { site, label }).map_err(|_| GivenError::TooMany)?;
        }
        Self::new(&shifted)
    }

    /// The same, for further samples whose positions may be off by so much, metres or a [`Tolerance`]. The positions of
    /// the given samples count as exact.
    ///
    /// # Errors
    /// [`GivenError::TooVague`], and [`GivenError::Tolerance`] unless the tolerance is from 0 to 1,024 m.
    pub fn with_tolerance(self, tolerance: impl TryInto<Tolerance>) -> Result<Self, GivenError> {
        let tolerance = tolerance.try_into().map_err(|_| GivenError::Tolerance)?;
        let shift = self.shift_by(tolerance).ok_or(GivenError::TooVague)?;
        Ok(Self { tolerance, expected: tolerance, shift, ..self })
    }

    /// How far off a position may be at most.
    pub const fn tolerance(&self) -> Tolerance {
        self.tolerance
    }

    /// How far off the next position is expected to be: as far as the last, or by the tolerance before the first.
    pub const fn expected(&self) -> Tolerance {
        self.expected
    }

    /// Expects the next position to be off by so much, when samples were taken in as they are.
    pub(crate) fn expect(&mut self, expected: Tolerance) -> Result<(), ObservationError> {
        let shift = if expected <= self.tolerance { self.shift_by(expected) } else { None };
        self.shift = shift.ok_or(ObservationError::Tolerance(expected))?;
        self.expected = expected;
        Ok(())
    }

    /// By how much a sample is shifted whose position may be off by so much.
    fn shift_within(&self, tolerance: Tolerance) -> Result<Vector, ObservationError> {
        if tolerance == self.expected {
            return Ok(self.shift);
        }
        // A smaller one shifts by less, and there is a shift for the largest.
        let shift = if tolerance <= self.tolerance { self.shift_by(tolerance) } else { None };
        shift.ok_or(ObservationError::Tolerance(tolerance))
    }

    /// The samples that are kept, in the order in which they came: all of them, until the buffer is full.
    pub fn samples(&self) -> &[Sample] {
        &self.samples
    }

    pub(crate) fn into_samples(self) -> SampleBuffer<N> {
        self.samples
    }

    /// The samples that were given at the start.
    pub fn given(&self) -> &[Sample] {
        self.samples.get(..self.given).unwrap_or(&[])
    }

    /// The cell of the lines left.
    pub fn cell(&self) -> &DualCell<N> {
        &self.cell
    }

    /// Takes a sample as it is.
    ///
    /// When the buffer is full, it keeps the given samples and those that bound the lines left. Of all others, that one
    /// goes which lies deepest in certain ground, be it the new one. The four samples of the paper's
    /// [`bisector`] go last. So all that is known stays exactly what it would be with all samples kept, and so does all
    /// that is read off it. Only the bisector may come to differ, if a later label is nearer to a sample that went than
    /// the bisector's second pair is long.
    ///
    /// One orientation an edge. With a full buffer also a root for each sample and edge, and `O(N^2)` distances.
    ///
    /// # Errors
    /// [`ObservationError`], with the version space as it was.
    pub fn insert(&mut self, sample: Sample) -> Result<Cut, ObservationError> {
        if self.samples.is_full() && !self.makes_room(sample)? {
            return Ok(Cut::Unchanged);
        }
        let index = self.samples.push(sample).map_err(|full| ObservationError::Full(full.0))?;
        self.cell.cut(&self.samples, Constraint::new(index, sample.label)).map_err(|error| {
            self.samples.pop();
            match error {
                CutError::Contradiction => ObservationError::Contradiction(sample),
                CutError::Full => ObservationError::Full(sample),
            }
        })
    }

    /// Removes the sample that matters least, and returns true. If that is the new one, it need not be stored.
    fn makes_room(&mut self, sample: Sample) -> Result<bool, ObservationError> {
        match spare(self.cell.lines(&self.samples), self.given, sample) {
            Spare::Stored(index) => {
                self.samples.remove(index);
                self.cell.forget(index);
                Ok(true)
            }
            Spare::New => Ok(false),
            Spare::Contradiction => Err(ObservationError::Contradiction(sample)),
            Spare::None => Err(ObservationError::Full(sample)),
        }
    }

    /// How many samples there would be room for if all of those went that neither were given nor bound the lines left.
    fn room(&self) -> usize {
        let edges = self.cell.edges().iter();
        N - self.given - edges.filter(|edge| edge.index() >= self.given).count()
    }

    /// Takes a reading, and returns the label that the site has from now on.
    ///
    /// A reading on the boundary says that the line passes here, so both labels are true of the closed half-planes. On
    /// uncertain ground the sample gets the label `either`, which the caller chooses. Where all lines agree the reading
    /// tells nothing and is skipped. It is true as long as one of the lines passes here.
    ///
    /// Under a [tolerance](Self::with_tolerance) the sample is taken in at a place where it is true for any position
    /// within the tolerance.
    ///
    /// # Errors
    /// As [`insert`](Self::insert), never for a true reading.
    pub fn take(
        &mut self,
        site: Site,
        reading: Reading,
        either: Label,
    ) -> Result<Label, ObservationError> {
        self.take_within(site, reading, either, self.tolerance)
    }

    /// As [`take`](Self::take), of a site that may be off by so much, at most by the [tolerance](Self::tolerance). The
    /// smaller the tolerance, the smaller the shift, and the more the sample tells.
    ///
    /// # Errors
    /// As `take`, and [`ObservationError::Tolerance`].
    pub fn take_within(
        &mut self,
        site: Site,
        reading: Reading,
        either: Label,
        tolerance: Tolerance,
    ) -> Result<Label, ObservationError> {
        let shift = self.shift_within(tolerance)?;
        let (label, told) = self.told(site, reading, either, shift);
        let cut = told.map(|sample| self.insert(sample)).transpose()?;
        (self.expected, self.shift) = (tolerance, shift);
        if cut == Some(Cut::Smaller) && tolerance != Tolerance::NONE {
            // Arcs only narrow: there is always one.
            self.shift = self.shift_by(tolerance).unwrap_or(shift);
        }
        Ok(label)
    }

    /// The label that a site has from now on, and the sample that says so, as it is taken in under a shift. `None` if
    /// the reading tells nothing.
    fn told(
        &self,
        site: Site,
        reading: Reading,
        either: Label,
        shift: Vector,
    ) -> (Label, Option<Sample>) {
        let label = match reading {
            Reading::Side(label) => label,
            Reading::Boundary => match self.certainty(site) {
                Certainty::Uncertain => either,
                Certainty::Certain(label) if self.bounds().any(|bound| bound.at(site) == 0) => {
                    return (label, None);
                }
                Certainty::Certain(label) => -label,
            },
        };
        let place = CellView { shift, ..self.lines() }.place(site, label);
        (label, place.map(|site| Sample { site, label }))
    }

    /// By how much a tolerance shifts the next sample.
    #[inline(never)] // from two places, and not for speed
    fn shift_by(&self, tolerance: Tolerance) -> Option<Vector> {
        tolerance.shift(self.slope_arc())
    }

    /// The lines left, to be read off.
    pub fn lines(&self) -> CellView<'_> {
        CellView { shift: self.shift, ..self.cell.lines(&self.samples) }
    }

    /// The vertices of the version space, in cyclic order.
    pub fn bounds(&self) -> impl Iterator<Item = Bound> + Clone + '_ {
        self.lines().bounds()
    }

    /// Whether all these lines give a position the same label, and which.
    pub fn certainty(&self, q: Site) -> Certainty {
        self.lines().certainty(q)
    }

    /// The directions of the lines left: the paper's `E_rho,t`.
    pub fn slope_arc(&self) -> SlopeArc {
        self.lines().slope_arc()
    }

    /// The range of the intercepts of the lines left, metres: the paper's `I_c,t`. `None` when a vertical line is among
    /// them, so that the range is unbounded.
    pub fn intercepts(&self) -> Option<[f64; 2]> {
        self.lines().intercepts()
    }

    /// The samples that still matter: the others follow from these.
    pub fn support(&self) -> impl Iterator<Item = Sample> + Clone + '_ {
        self.lines().support()
    }

    /// The first sample's label: where Algorithm 1 starts.
    pub fn first_label(&self) -> Label {
        self.samples.first().map_or(Label::Negative, |s| s.label)
    }
}

impl<const N: usize> Belief for VersionSpace<N> {
    /// Whether the given samples and those that bound the lines left take up all the room.
    fn is_full(&self) -> bool {
        self.room() == 0
    }

    fn tolerance(&self) -> Tolerance {
        self.tolerance
    }

    /// As [`take_within`](Self::take_within), with +1 for a site on the boundary.
    fn observe_within(
        &mut self,
        site: Site,
        reading: Reading,
        tolerance: Tolerance,
    ) -> Result<(), ObservationError> {
        self.take_within(site, reading, Label::Positive, tolerance).map(|_| ())
    }

    /// Only a label that cuts is kept.
    fn observe_on_the_way(
        &mut self,
        site: Site,
        reading: Reading,
    ) -> Result<bool, ObservationError> {
        let shift = self.shift_within(self.tolerance)?;
        let (_, told) = self.told(site, reading, Label::Positive, shift);
        let Some(sample) = told else { return Ok(false) };
        let certainty = self.certainty(sample.site);
        if certainty == Certainty::Certain(sample.label) {
            return Ok(false);
        }
        if certainty == Certainty::Uncertain && self.room() < 2 {
            // The last room is for the label at the motion's end.
            return Ok(false);
        }
        self.insert(sample)?;
        if self.tolerance != Tolerance::NONE {
            self.shift = self.shift_by(self.expected).unwrap_or(self.shift);
        }
        Ok(true)
    }

    fn estimates(&self) -> Estimates {
        Estimates {
            bisector: bisector(self.samples()),
            centre: self.centre(),
            maximum_margin: maximum_margin(self.lines()),
        }
    }

    fn centre(&self) -> Option<LocalLine> {
        centre(self.lines())
    }

    /// Each bit halves the measure of the lines that are left.
    fn information(&self) -> f64 {
        // Given samples that made a version space make it again.
        let start = Self::new(self.given()).map_or(f32::NAN, |start| area(start.lines()));
        let bits = libm::log2(f64::from(start) / f64::from(area(self.lines())));
        // Areas are rounded.
        if bits < 0.0 { 0.0 } else { bits }
    }

    /// Whether all lines that are left meet the goal. The goal's level has no effect, as labels are true.
    fn meets<C: Criterion>(&self, goal: Goal<C>, area: Area) -> bool {
        goal.accuracy.is_met(&self.bounds(), area)
    }

    fn chance(&self, site: Site) -> f64 {
        share_above(self.lines(), site).into()
    }

    /// The share of the lines that the label would leave.
    fn chance_of(&self, site: Site, label: Label) -> f32 {
        let lines = self.lines();
        let above = lines.place(site, label).map_or(1.0, |place| share_above(lines, place));
        if label == Label::Positive { above } else { 1.0 - above }
    }
}
