//! The compiled-in world: the paper's noiseless example, with a perfect sensor and an ideal drive
//! in place of peripherals.
//!
//! The data are those of `host-sim/scenarios/paper-noiseless.toml`. Nothing here knows the chip:
//! `tests/tests/firmware.rs` takes in this very file and runs the same mission on the host.

use core::cell::Cell;
use core::convert::Infallible;

use nalgebra::Point2;
use planner_core::agent::Agent;
use planner_core::area::Area;
use planner_core::cfc::Cfc;
use planner_core::config::{Config, Crossing, Following};
use planner_core::direction::Heading;
use planner_core::dynamics::Pose;
use planner_core::hal::{Drive, LabelSensor};
use planner_core::lattice::{Site, UNITS_PER_METRE};
use planner_core::line::Line;
use planner_core::planner::Motion;
use planner_core::problem::Varrho;
use planner_core::sample::{Label, Reading, Sample};
use planner_core::unicycle::Unicycle;
use planner_core::version_space::{NoVersionSpace, VersionSpace};

/// Steps at most.
pub(crate) const STEPS: u32 = 10;

/// Samples that the planner can hold, the oracle's included.
const CAPACITY: usize = 32;

/// The line to be found.
const SLOPE: f64 = 0.41;
const INTERCEPT_M: f64 = 3.5;

const AREA: [Site; 2] = [metres(0, 0), metres(20, 20)];

const ORACLE: [Sample; 4] = [
    Sample { site: metres(2, 1), label: Label::Negative },
    Sample { site: metres(2, 8), label: Label::Positive },
    Sample { site: metres(18, 16), label: Label::Positive },
    Sample { site: metres(18, 5), label: Label::Negative },
];

/// At the first oracle point, along the x axis.
const START: Pose = Pose { site: ORACLE[0].site, heading: Heading(0) };

/// The site at whole metres. For constants: one off the lattice does not compile.
const fn metres(x: i32, z: i32) -> Site {
    match Site::new(x * UNITS_PER_METRE, z * UNITS_PER_METRE) {
        Ok(site) => site,
        Err(_) => panic!("off the lattice"),
    }
}

/// Why the compiled-in data make no mission.
#[derive(Debug)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub(crate) enum NoMission {
    /// The area has no inside.
    Area,
    /// The true line is none.
    Truth,
    /// The oracle's samples leave nothing to find.
    Oracle(NoVersionSpace),
}

/// A true line and a vehicle beside it. A reference to it is both the sensor and the drive.
pub(crate) struct World {
    truth: Line,
    pose: Cell<Pose>,
}

impl World {
    /// The vehicle at its start.
    pub(crate) fn new() -> Result<Self, NoMission> {
        let truth = Line::from_slope(SLOPE, INTERCEPT_M).ok_or(NoMission::Truth)?;
        Ok(Self { truth, pose: Cell::new(START) })
    }

    /// Algorithm 1 with the paper's unicycle, wired to this world.
    pub(crate) fn agent(&self) -> Result<Agent<Cfc<Unicycle, CAPACITY>, &Self, &Self>, NoMission> {
        let [min, max] = AREA;
        let config = Config {
            area: Area::new(min, max).ok_or(NoMission::Area)?,
            varrho: Varrho::PAPER,
            crossing: Crossing::default(),
            following: Following::default(),
        };
        let space = VersionSpace::new(&ORACLE).map_err(NoMission::Oracle)?;
        let planner = Cfc::new(config, Unicycle::paper(), space);
        Ok(Agent::new(planner, self, self, self.pose.get()))
    }
}

/// A perfect sensor.
impl LabelSensor for &World {
    type Error = Infallible;

    fn read(&mut self) -> Result<Reading, Infallible> {
        let distance = self.truth.distance(Point2::from(self.pose.get().site));
        Ok(if distance > 0.0 {
            Label::Positive.into()
        } else if distance < 0.0 {
            Label::Negative.into()
        } else {
            Reading::Boundary
        })
    }
}

/// An ideal vehicle: it reaches the target of every motion.
impl Drive for &World {
    type Error = Infallible;

    fn drive(&mut self, motion: &Motion) -> Result<Pose, Infallible> {
        self.pose.set(motion.target);
        Ok(motion.target)
    }
}
