//! A mission as the C program gives it, checked before any memory is written.

use core::ffi::CStr;

use planner_core::error::GridError;
use planner_core::{Angle, Goal, Noise, SlopeWithin, Tolerance, Unicycle};

use crate::area::{Area, Chart, Ground, Outlines};
use crate::status::Status;
use crate::types::Point;
use crate::verdict::Refusal;

/// What is fixed beforehand.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Mission<'a> {
    /// The area's lower left corner, metres.
    pub min_x: f64,
    /// The same.
    pub min_z: f64,
    /// The area's upper right corner, metres.
    pub max_x: f64,
    /// The same.
    pub max_z: f64,
    /// How far a position may be off, metres; 0 if it is exact.
    pub tolerance: f64,
    /// How often a label is right: 1 if always, else above 1/2. A library that is built without noise finds lines with
    /// 1 alone.
    pub p: f64,
    /// Stop when the slopes of all lines left, or with p below 1 of 90 % of them, differ by no more, radians; 0 to
    /// go on.
    pub slopes: f64,
    /// The sharpest turn to either side, radians.
    pub sharpest: f64,
    /// From one turn to the next, millionths of a radian.
    pub turn_step_urad: u32,
    /// From one distance to the next, millimetres.
    pub step_mm: u32,
    /// How many such steps the longest motion has.
    pub steps: u16,
    /// With p below 1: the probability that `slopes` holds when the planner stops, at most 0.9999; 0 for 0.9. With p of
    /// 1 it must be 0.
    pub level: f64,
    /// A polygon and keep-outs; null for the rectangle with nothing in it. It is read while a call runs, and not after.
    /// A library that is built without polygons takes null alone.
    pub area: Option<&'a Area>,
    /// A lake of any shape; null for all of the area. Then the mission's rectangle is all zeros: it is the one around all
    /// cells. `area` may have keep-outs. A library that is built without charts takes null alone.
    pub chart: Option<&'a Chart>,
}

/// The level of a promise, unless the mission says another, and the highest; millionths.
const USUAL_LEVEL: u32 = 900_000;
const HIGHEST_LEVEL: f64 = 0.9999;

impl Mission<'_> {
    /// # Safety
    /// As for [`Chart::read`](crate::area::Chart).
    pub(crate) unsafe fn ground(&self) -> Result<Ground, Refusal> {
        #[cfg(not(feature = "charts"))]
        if self.chart.is_some() {
            return Err(Refusal::of(Status::Chart, c"chart"));
        }
        #[cfg(feature = "charts")]
        if let Some(chart) = self.chart {
            // A rectangle besides would be another area.
            if self.sides().into_iter().any(|side| side != 0.0) {
                return Err(Refusal::of(Status::Chart, c"chart"));
            }
            // SAFETY: the caller promises it.
            let chart = unsafe { chart.read() }?;
            return Ok(Ground::new(self.outlines(Ok(chart.bounds()))?, Some(chart)));
        }
        let outlines = self.outlines(self.rectangle())?;
        #[cfg(feature = "charts")]
        return Ok(Ground::new(outlines, None));
        #[cfg(not(feature = "charts"))]
        Ok(outlines)
    }

    /// The area by its corners, with a rectangle for one that has none.
    fn outlines(
        &self,
        rectangle: Result<planner_core::Area, Refusal>,
    ) -> Result<Outlines, Refusal> {
        match self.area {
            None => Ok(Outlines::from(rectangle?)),
            #[cfg(feature = "polygons")]
            Some(area) if area.corner_count == 0 => {
                area.with_keep_outs(planner_core::Hull::of(rectangle?))
            }
            #[cfg(feature = "polygons")]
            Some(area) if self.sides().into_iter().all(|side| side == 0.0) => {
                area.with_keep_outs(area.polygon()?)
            }
            Some(_) => Err(Refusal::of(Status::Area, c"area")),
        }
    }

    #[cfg(feature = "polygons")]
    const fn sides(&self) -> [f64; 4] {
        [self.min_x, self.min_z, self.max_x, self.max_z]
    }

    fn rectangle(&self) -> Result<planner_core::Area, Refusal> {
        let corner = |(x, x_name), (z, z_name)| {
            let beyond = |name| move |status| Refusal::of(status, name);
            Point { x, z: 0.0 }.read().map_err(beyond(x_name))?;
            Point { x, z }.read().map_err(beyond(z_name))
        };
        let min = corner((self.min_x, c"min_x"), (self.min_z, c"min_z"))?;
        let max = corner((self.max_x, c"max_x"), (self.max_z, c"max_z"))?;
        let what = if min.x() < max.x() { c"max_z" } else { c"max_x" };
        planner_core::Area::new(min, max).map_err(|_| Refusal::of(Status::Mission, what))
    }

    pub(crate) fn unicycle(&self) -> Result<Unicycle, Refusal> {
        let refused = |what: &'static CStr| Refusal::of(Status::Mission, what);
        // Without a step it would turn on the spot alone.
        let speeds = self.steps.checked_add(1).filter(|it| *it > 1).ok_or(refused(c"steps"))?;
        let made = Unicycle::new(self.turn_step_urad, self.sharpest, speeds, self.step_mm);
        made.map_err(|bad| {
            // With a turn and a step that are possible for certain: what is still refused is something else.
            let is_turn = Unicycle::new(self.turn_step_urad, 1.0, 2, 1).is_err();
            let is_step = Unicycle::new(1_000_000, 1.0, 2, self.step_mm).is_err();
            refused(match bad {
                GridError::Turn if is_turn => c"turn_step_urad",
                GridError::Turn => c"sharpest",
                _ if is_step => c"step_mm",
                _ => c"steps",
            })
        })
    }

    pub(crate) fn goal(&self) -> Result<Option<Goal<SlopeWithin>>, Refusal> {
        let level = self.level()?;
        if self.slopes == 0.0 {
            return Ok(None);
        }
        let goal = Angle::from_radians(self.slopes).and_then(Goal::slope_within);
        let goal = goal.map_err(|_| Refusal::of(Status::Mission, c"slopes"))?;
        Ok(Some(Goal { level, ..goal }))
    }

    /// In millionths. Promises about true labels have none.
    fn level(&self) -> Result<u32, Refusal> {
        if self.level == 0.0 {
            return Ok(USUAL_LEVEL);
        }
        let is_possible = self.p < 1.0 && self.level > 0.0 && self.level <= HIGHEST_LEVEL;
        let millionths = (self.level * 1e6 + 0.5) as u32;
        is_possible.then_some(millionths).ok_or(Refusal::of(Status::Mission, c"level"))
    }

    /// How often labels are right, and how far positions may be off.
    pub(crate) fn noise(&self) -> Result<Noise, Refusal> {
        let refused = |what| move |_| Refusal::of(Status::Mission, what);
        let noise = Noise::new(self.p).map_err(refused(c"p"))?;
        let tolerance = Tolerance::new(self.tolerance).map_err(refused(c"tolerance"))?;
        Ok(Noise { tolerance, ..noise })
    }

    /// Whether labels are always right.
    pub(crate) fn is_true(&self) -> bool {
        self.p >= 1.0
    }
}
