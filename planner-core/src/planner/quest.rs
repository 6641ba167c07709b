//! A boundary that is sought from nothing: what is known, the route, and how near it is.
//!
//! ```text
//!              P > 0.9, or true labels that differ          found, and none with less than 0.01
//!   Search ------------------------------------> Close ------------------------------------> Follow
//!      ^                                            |                                           |
//!      +-- most likely none, or too many labels ----+------------- lost, most likely not there -+
//! ```
//!
//! - **Search**: the robot drives along a [`Route`], and a [field](crate::belief::field) takes in the labels.
//! - **Close**: a grid of lines begins in a square about the last crossing, with the labels that were read there.
//! - **Follow**: the planner knows the boundary, or was told about where it is.

use crate::belief::curve::nearest_pair;
use crate::belief::field::{BoundaryOdds, Field, FieldMemory, MOST_PATCHES, Seeking};
use crate::belief::sample::{Label, Sample};
use crate::geometry::approximate::{METRE, distance, sqrt};
use crate::geometry::hull::Extent;
use crate::geometry::lattice::Site;
use crate::geometry::workspace::Workspace;
use crate::planner::one_label::OneLabel;
use crate::planner::setup::SetupError;
use crate::search::route::{Hears, Route};

/// There is a boundary nearby where the field has this probability.
const NEAR: f32 = 0.9;

/// The square about a crossing reaches so many ways between labels to either side, and so many more for labels that tell little.
const REACHES: f32 = 2.5;

/// Labels within so many times the square count.
const LABELS: f32 = 2.0;

/// And where so much of the last labels, as a logarithm of odds, says that the boundary was crossed. A false label does not.
const CHANGED: f32 = 3.0;

/// With true labels on both sides, there is no boundary with this probability.
const NONE: f32 = 1e-3;

/// The robot gives a corner up after so many motions without coming nearer.
const VAIN: u8 = 72;

/// A corner is the same where it differs by this share of how near the robot came.
const SAME: f32 = 0.25;

/// The boundary is given up after labels that carry so many bits together.
const BITS: f32 = 40.0;

/// How near the boundary is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum QuestPhase {
    Search,
    /// It is given up after so many steps.
    Close(u16),
    Follow,
}

/// What the search for a boundary has to remember.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct QuestMemory {
    field: FieldMemory,
    route: Route,
    phase: QuestPhase,
    is_fresh: bool,
    is_stuck: bool,
    heard: Option<Site>,
    news: u8,
    approach: Approach,
    mapped: Mapped,
}

/// Where patches lie that are mapped.
type Mapped = heapless::Vec<Extent, { MOST_PATCHES as usize }, u8>;

/// How the robot comes to the corner that it goes to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Approach {
    corner: [f32; 2],
    /// How near it came, metres.
    least: f32,
    /// Motions since it came nearer.
    vain: u8,
}

impl Approach {
    const NONE: Self = Self { corner: [0.0; 2], least: f32::MAX, vain: 0 };

    /// Whether a corner is about the one that the robot goes to.
    fn is_to(&self, corner: [f32; 2]) -> bool {
        apart(self.corner, corner) <= SAME * self.least
    }
}

/// Metres between two places.
fn apart([x, z]: [f32; 2], [a, b]: [f32; 2]) -> f32 {
    sqrt((x - a) * (x - a) + (z - b) * (z - b))
}

/// The search for a boundary.
#[derive(Clone, Debug)]
pub(crate) struct Quest {
    field: Field,
    sought: BoundaryOdds,
    route: Route,
    pub(crate) phase: QuestPhase,
    /// Whether a label or a motion came since the route was made better.
    is_fresh: bool,
    /// Whether a plan found no way to any corner since.
    is_stuck: bool,
    /// Where a label was read last.
    heard: Option<Site>,
    /// Labels since the search began again.
    news: u8,
    approach: Approach,
    mapped: Mapped,
}

/// About where a boundary is.
pub(crate) struct Lead {
    /// It was crossed between these two labels.
    pub(crate) between: [Site; 2],
    /// Whether they are too far apart to begin there: the robot drives from one to the other first.
    pub(crate) is_wide: bool,
    pub(crate) place: Site,
    /// It crosses the square that reaches so far to either side of the place, metres.
    pub(crate) within: f32,
    /// There is none with this probability.
    pub(crate) nowhere: f32,
}

impl Quest {
    pub(crate) const NONE: Self = Self {
        field: Field::NONE,
        sought: BoundaryOdds { discs: 0.0, half_planes: 0.0, heaviest: (None, 0.0) },
        route: Route::NONE,
        phase: QuestPhase::Search,
        is_fresh: true,
        is_stuck: false,
        heard: None,
        news: 0,
        approach: Approach::NONE,
        mapped: Mapped::new(),
    };

    /// Begins in an area with labels that are true with probability `p`. A straight boundary has no `patches`. The planner
    /// may be told about where it is.
    ///
    /// # Errors
    /// [`SetupError::Patch`].
    pub(crate) fn begin<G: Workspace>(
        &mut self,
        area: &G,
        (seeking, patches): (Seeking, bool),
        p: f32,
        is_near: bool,
    ) -> Result<(), SetupError> {
        let begun = self.field.begin(area, (seeking, patches), p);
        begun.map_err(|[least, most]| SetupError::Patch { least, most })?;
        (self.route, self.heard, self.news) = (Route::NONE, None, 0);
        self.approach = Approach::NONE;
        self.mapped.clear();
        (self.is_fresh, self.is_stuck) = (true, false);
        self.phase = if is_near { QuestPhase::Follow } else { QuestPhase::Search };
        self.sought = self.field.sought();
        Ok(())
    }

    /// What was said of the boundary.
    pub(crate) fn seeking(&self) -> Seeking {
        self.field.seeking()
    }

    /// Takes in points whose labels are known for sure. The two that differ and are the nearest to each other come last:
    /// the boundary is sought between them first.
    pub(crate) fn know(&mut self, points: &[Sample]) {
        let pair = nearest_pair(points);
        let is_last = |it: &&Sample| pair.is_some_and(|pair| pair.contains(&it.site));
        let others = points.iter().filter(|it| !is_last(it));
        for it in others.chain(points.iter().filter(is_last)) {
            self.field.know(it.site, it.label);
        }
        self.sought = self.field.sought();
    }

    /// Takes in a label. Along a front, and where a patch is mapped, it tells nothing of other patches.
    pub(crate) fn hear(&mut self, site: Site, label: Label) {
        if self.phase == QuestPhase::Follow {
            self.field.memory.recent.push(site, label);
        } else if !self.mapped.iter().any(|it| it.holds(site)) {
            self.field.observe(site, label);
        }
        self.heard = Some(site);
        self.news = self.news.saturating_add(1);
    }

    /// A motion has ended, and its labels are taken in. The route stays until a label comes: a robot that turns on the
    /// spot would turn to and fro.
    pub(crate) fn moved(&mut self, site: Site, has_label: bool) {
        if self.phase == QuestPhase::Search {
            self.sought = self.field.sought();
        }
        self.come(site);
        self.is_fresh |= has_label;
        self.is_stuck &= !has_label;
    }

    /// Keeps in mind how near the robot comes to the corner that it goes to.
    fn come(&mut self, site: Site) {
        let Some(corner) = self.route.next() else { return };
        let left = apart(self.field.layout.seen(site), corner);
        let Approach { least, vain, .. } = self.approach;
        self.approach = match () {
            () if left < least || !self.approach.is_to(corner) => {
                Approach { corner, least: left, vain: 0 }
            }
            () => Approach { vain: vain.saturating_add(1), ..self.approach },
        };
    }

    /// Whether the robot comes no nearer to the corner that it goes to.
    pub(crate) fn is_vain(&self) -> bool {
        let is_to_it = self.route.next().is_some_and(|corner| self.approach.is_to(corner));
        is_to_it && self.approach.vain >= VAIN
    }

    /// What labels tell, read so many metres apart.
    fn hears(&self, apart: f32) -> Hears {
        Hears { odds: self.field.odds(), apart }
    }

    /// Where the boundary is close enough for the grid: of labels that are surely true, between the last two that
    /// differ; otherwise where the labels changed last, if there most likely is a boundary. Labels come so many metres apart.
    pub(crate) fn lead(&self, is_certain: bool, apart: f32) -> Option<Lead> {
        // Where nothing was found, a change that was there before does not count again.
        let recent = self.field.memory.recent.newest(usize::from(self.news) + 1);
        let ([a, b], nowhere) = if is_certain {
            (recent.changed()?, NONE)
        } else {
            let nowhere = 1.0 - self.sought.probability();
            if nowhere >= 1.0 - NEAR {
                return None;
            }
            let (between, gain) = recent.crossed()?;
            if self.field.odds() * (gain as f32) < CHANGED {
                return None;
            }
            (between, nowhere)
        };
        let gap = 0.5 * METRE * distance(b - a);
        let square = apart * (REACHES + REACHES / self.hears(apart).label());
        let (between, is_wide, place) = ([a, b], gap > square, Site::between(a, b));
        Some(Lead { between, is_wide, place, within: square, nowhere })
    }

    /// The labels that were read near a lead, the oldest first.
    pub(crate) fn labels_near(&self, lead: &Lead) -> impl Iterator<Item = Sample> {
        let (place, within) = (lead.place, LABELS * lead.within / METRE);
        self.field.memory.recent.iter().filter(move |it| {
            let way = it.site - place;
            (way.x as f32).abs() <= within && (way.z as f32).abs() <= within
        })
    }

    /// The grid takes over, for labels that carry so many bits each.
    pub(crate) fn close_in(&mut self, bits: f32) {
        let bits = if bits > 1e-3 { bits } else { 1e-3 };
        self.phase = QuestPhase::Close((BITS / bits) as u16);
    }

    /// The grid has found nothing: the search goes on.
    pub(crate) fn search_on(&mut self) {
        (self.phase, self.news) = (QuestPhase::Search, 0);
        self.sought = self.field.sought();
    }

    /// The boundary is not where it was: the search begins again, and forgets all but the last labels.
    pub(crate) fn lose<G: Workspace>(&mut self, area: &G) {
        self.field.forget(area, &self.mapped);
        self.search_on();
        self.is_fresh = true;
        self.is_stuck = false;
    }

    /// A boundary is found: the last labels within so many lattice units of a place tell nothing of others, if several are
    /// sought.
    pub(crate) fn follow(&mut self, place: Site, within: f32) {
        self.phase = QuestPhase::Follow;
        if self.field.seeking().most_patches() == 1 {
            return;
        }
        let recent = self.field.memory.recent;
        for it in recent.iter().filter(|it| distance(it.site - place) <= within) {
            self.field.take_back(it.site, it.label);
        }
    }

    /// A patch is mapped, in this extent. Whether another is sought: the search goes on beside it.
    pub(crate) fn map(&mut self, extent: Extent) -> bool {
        let most = usize::from(self.field.seeking().most_patches());
        if self.mapped.len() + 1 >= most || self.mapped.push(extent).is_err() {
            return false;
        }
        self.field.leave_out(extent);
        self.search_on();
        (self.is_fresh, self.is_stuck) = (true, false);
        true
    }

    /// Whether a patch was mapped, and another is sought.
    pub(crate) fn has_mapped(&self) -> bool {
        !self.mapped.is_empty()
    }

    /// The label that all of the area has, if it most likely has one.
    pub(crate) fn one_label(&self) -> Option<OneLabel> {
        OneLabel::of_field(&self.field, self.field.left(self.sought))
    }

    /// There is no way to any corner, until a label comes.
    pub(crate) fn get_stuck(&mut self) {
        self.is_stuck = true;
    }

    pub(crate) fn is_stuck(&self) -> bool {
        self.is_stuck
    }

    /// Whether the route may be made better: once after each motion, unless it was told.
    pub(crate) fn is_fresh(&self) -> bool {
        self.is_fresh && !self.route.is_told()
    }

    /// Makes the route better. Labels come so many metres apart.
    pub(crate) fn improve<G: Workspace>(&mut self, area: &G, from: Site, apart: f32) {
        self.is_fresh = false;
        let (from, hears) = (self.field.layout.seen(from), self.hears(apart));
        let heart = self.sought.heaviest.0.map(|it| self.field.layout.heart(area, it));
        self.route.improve((&self.field, self.sought), (from, heart), hears);
    }

    /// The corner of the route to go to, or the place nearest to it, towards the middle, where the robot can be.
    pub(crate) fn next<G: Workspace>(&mut self, area: &G) -> Option<Site> {
        const EIGHTHS: [f32; 7] = [1.0, 0.875, 0.75, 0.625, 0.5, 0.375, 0.25];
        while let Some([x, z]) = self.route.next() {
            let places = EIGHTHS.iter().filter_map(|it| self.field.layout.site([it * x, it * z]));
            let place = places.into_iter().find(|it| area.contains(*it));
            if place.is_some() {
                return place;
            }
            self.route.pass();
        }
        None
    }

    /// Drives from a place to the nearer end of a lead and on to the other.
    pub(crate) fn narrow(&mut self, lead: &Lead, from: Site) {
        if !self.route.is_told() {
            let [a, b] = lead.between;
            let is_first = distance(a - from) < distance(b - from);
            self.survey(&if is_first { [a, b] } else { [b, a] });
        }
    }

    /// Drives along a route that is told, up to 16 corners of it, before it plans its own.
    pub(crate) fn survey(&mut self, corners: &[Site]) {
        let layout = self.field.layout;
        self.route = Route::told(corners.iter().map(|it| layout.seen(*it)));
    }

    /// Leaves out the corner to go to: there is no way now.
    pub(crate) fn pass(&mut self) {
        self.route.pass();
    }

    /// The robot has come as near to the corner as it can. Ground that lies beyond is not sought.
    pub(crate) fn arrive<G: Workspace>(&mut self, area: &G, from: Site) {
        self.come(from);
        if let Some(corner) = self.route.next() {
            self.field.memory.shut((&self.field.layout, area), corner, self.approach.least);
        }
        self.approach = Approach::NONE;
        self.route.pass();
    }

    /// How far the last label lies from a site, lattice units.
    pub(crate) fn unheard(&self, site: Site) -> f32 {
        self.heard.map_or(f32::MAX, |heard| distance(site - heard))
    }

    pub(crate) fn memory(&self) -> QuestMemory {
        let Self { ref field, ref route, phase, is_fresh, is_stuck, heard, news, approach, .. } =
            *self;
        let (field, route) = (field.memory.clone(), route.clone());
        let mut mapped = Mapped::new();
        for it in &self.mapped {
            let _ = mapped.push(*it); // there is room
        }
        QuestMemory { field, route, phase, is_fresh, is_stuck, heard, news, approach, mapped }
    }

    /// Goes on from there. Whether a search of the same area can have stored it.
    pub(crate) fn recall(&mut self, memory: &QuestMemory) -> bool {
        let QuestMemory { field, route, phase, is_fresh, is_stuck, heard, news, approach, mapped } =
            memory.clone();
        let is_few = mapped.len() < usize::from(self.field.seeking().most_patches());
        let is_valid = route.is_valid(self.field.layout.half);
        (self.field.memory, self.route, self.phase) = (field, route, phase);
        (self.is_fresh, self.is_stuck) = (is_fresh, is_stuck);
        (self.heard, self.news, self.approach) = (heard, news, approach);
        self.mapped = mapped;
        self.sought = self.field.sought();
        is_valid && is_few
    }
}
