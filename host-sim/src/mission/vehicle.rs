//! The vehicle of a mission, as scenario files describe it.

use anyhow::Result;
use planner_core::motion::action::BadGrid;
use planner_core::motion::boat::Boat;
use planner_core::motion::car::{Car, Shape};
use planner_core::motion::dynamics::Dynamics as _;
use planner_core::motion::unicycle::{Grid, Unicycle};
use serde::Deserialize;

use crate::mission::algorithm::Algorithm;
use crate::mission::strict::wrong;

/// Actions that margin sampling and the random walk try one by one, at most.
const MOST_TRIED: u64 = 1_000_000;

/// What moves, if it is not the paper's unicycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Vehicle {
    /// Turns on the spot, then drives.
    Unicycle(Unicycle),
    /// Turns a little and drives, a step at a time, and never on the spot.
    Boat(Boat),
    /// Drives along arcs of at most some curvature.
    Car(Car),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Unicycle,
    Boat,
    Car,
}

/// `vehicle` of a scenario file. Lengths in metres, angles in radians.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct VehicleTable {
    kind: Kind,
    reach: Option<f64>,
    step: Option<f64>,
    sharpest: Option<f64>,
    turn_step: Option<f64>,
    radius: Option<f64>,
    shortest: Option<f64>,
}

impl VehicleTable {
    /// The vehicle; `None` if it is the one of the fan's grid. `fan` is what the file says, `grid` what is flown with
    /// unless it says otherwise.
    ///
    /// # Errors
    /// Names the field, what was found and what was expected.
    pub(crate) fn vehicle(
        &self,
        algorithm: Algorithm,
        has_fan: bool,
        grid: Grid,
    ) -> Result<Option<Vehicle>> {
        if has_fan && self.turn_step.is_some() {
            return wrong("vehicle.turn_step", "a fan too", "one of them");
        }
        self.check_keys()?;
        let default = if grid == Grid::Fine { 1e-6 } else { 0.01 };
        let turn_step_urad = whole("vehicle.turn_step", self.turn_step.unwrap_or(default), 1e6)?;
        let step = self.step.unwrap_or(0.1);
        let speed_step_mm = whole("vehicle.step", step, 1e3)?;
        let reach_mm = whole("vehicle.reach", self.reach.unwrap_or(2.0), 1e3)?;
        let steps = u16::try_from(reach_mm / speed_step_mm).unwrap_or(u16::MAX);
        if reach_mm % speed_step_mm != 0 || steps == u16::MAX {
            let found = format!("{} with steps of {step}", f64::from(reach_mm) / 1e3);
            return wrong("vehicle.reach", found, "1 to 65534 steps");
        }
        let speeds = steps + 1;
        let sharpest = self.sharpest.unwrap_or(std::f64::consts::FRAC_PI_2);
        let unicycle = || Unicycle::new(turn_step_urad, sharpest, speeds, speed_step_mm);
        let made = match self.kind {
            Kind::Unicycle => unicycle().map(Vehicle::Unicycle),
            Kind::Boat => unicycle().and_then(Boat::new).map(Vehicle::Boat),
            Kind::Car => {
                let Some(radius) = self.radius else {
                    return wrong("vehicle.radius", "none", "the radius of its turning circle");
                };
                let shortest_mm = whole("vehicle.shortest", self.shortest.unwrap_or(step), 1e3)?;
                let radius_mm = whole("vehicle.radius", radius, 1e3)?;
                Car::new(Shape { radius_mm, shortest_mm, turn_step_urad, speeds, speed_step_mm })
                    .map(Vehicle::Car)
            }
        };
        let vehicle = made.or_else(|bad: BadGrid| wrong("vehicle", "no such vehicle", bad))?;
        vehicle.suits(algorithm)?;
        let is_of_grid = vehicle == Vehicle::Unicycle(Unicycle::from(grid));
        Ok((!is_of_grid).then_some(vehicle))
    }

    /// Whether each key means something for its kind.
    fn check_keys(&self) -> Result<()> {
        let is_car = self.kind == Kind::Car;
        for (key, is_there, means) in [
            ("sharpest", self.sharpest.is_some(), !is_car),
            ("radius", self.radius.is_some(), is_car),
            ("shortest", self.shortest.is_some(), is_car),
        ] {
            if is_there && !means {
                let kind = format!("{:?}", self.kind).to_lowercase();
                return wrong(&format!("vehicle.{key}"), format!("a {kind}"), "a kind that has it");
            }
        }
        Ok(())
    }
}

impl Vehicle {
    fn suits(&self, algorithm: Algorithm) -> Result<()> {
        let tries = matches!(algorithm, Algorithm::Margin | Algorithm::Random);
        match self {
            Self::Boat(_) | Self::Car(_) if tries => {
                let found = format!("one that cannot turn on the spot, with {}", algorithm.name());
                wrong("vehicle", found, "cfc, scc or lookahead, which see to it that it can go on")
            }
            Self::Unicycle(it)
                if algorithm == Algorithm::Margin && it.grid().actions() > MOST_TRIED =>
            {
                let found = format!("{} actions with margin", it.grid().actions());
                wrong("vehicle", found, format!("at most {MOST_TRIED}, as it tries every action"))
            }
            _ => Ok(()),
        }
    }
}

/// A length or an angle in its thousandths or millionths.
fn whole(field: &str, value: f64, per_unit: f64) -> Result<u32> {
    let parts = (value * per_unit).round();
    let is_whole = (value * per_unit - parts).abs() < 1e-6 * parts.max(1.0);
    if !is_whole || !(1.0..1e9).contains(&parts) {
        let (unit, part) =
            if per_unit > 1e4 { ("radians", "a microradian") } else { ("metres", "a millimetre") };
        return wrong(field, value, format!("{unit}, a multiple of {part}"));
    }
    Ok(parts as u32)
}
