//! The vehicle of a mission, as scenario files, flags and traces describe it.

use std::f64::consts::PI;

use anyhow::Result;
use nalgebra::Point2;
use planner_core::aimed_for;
use planner_core::dynamics::{ActionGrid, Dynamics as _};
use planner_core::error::{GridError, SetupError};
use planner_core::link::message::MissionArea;
use planner_core::link::message::Settings;
use planner_core::{
    AnyVehicle, Area, Boat, Car, CarShape, Unicycle, UnicycleShape, VehicleShape, Workspace as _,
};
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

use crate::mission::algorithm::Algorithm;
use crate::mission::names::FanName;
use crate::mission::strict::{beyond, no_angle, wrong};

/// Actions that margin sampling and the random walk try one by one, at most.
const MOST_TRIED: u64 = 1_000_000;

/// What kind of vehicle moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Turns on the spot, then drives
    #[default]
    Unicycle,
    /// Does the same, but cannot turn on the spot
    Boat,
    /// Drives along arcs, with a turning circle
    Car,
}

/// `vehicle` of a scenario file and of a trace, and flags. Lengths in metres, angles in radians.
#[skip_serializing_none]
#[derive(Clone, Copy, Debug, Serialize, Deserialize, clap::Args)]
#[serde(deny_unknown_fields)]
pub struct VehicleTable {
    /// What moves [default: unicycle]
    #[arg(long = "vehicle", value_enum, default_value_t, hide_default_value = true)]
    #[serde(default)]
    pub(crate) kind: Kind,
    /// The longest motion, metres, below 3000 [default: 2]
    #[arg(long, value_name = "METRES")]
    reach: Option<f64>,
    /// From one length of motions to the next, metres [default: 0.1]
    #[arg(long = "speed-step", value_name = "METRES")]
    step: Option<f64>,
    /// The sharpest turn (unicycle, boat), radians [default: pi/2]
    #[arg(long, value_name = "RADIANS")]
    sharpest: Option<f64>,
    /// From one direction to the next, radians [default: the fan's]
    #[arg(long, value_name = "RADIANS")]
    turn_step: Option<f64>,
    /// Radius of the turning circle (car), metres
    #[arg(long, value_name = "METRES")]
    radius: Option<f64>,
    /// The shortest motion (car), metres [default: a step]
    #[arg(long, value_name = "METRES")]
    shortest: Option<f64>,
}

/// Where a vehicle's numbers come from. Messages name a number as it is called there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A scenario file.
    File,
    /// The command line.
    Flags,
}

impl Source {
    /// What a number is called there.
    pub fn name(self, key: &str) -> String {
        match (self, key) {
            (Self::File, "kind") => "vehicle".to_owned(),
            (Self::File, "tolerance") => key.to_owned(),
            (Self::File, _) => format!("vehicle.{key}"),
            (Self::Flags, "kind") => "--vehicle".to_owned(),
            (Self::Flags, "step") => "--speed-step".to_owned(),
            (Self::Flags, _) => format!("--{}", key.replace('_', "-")),
        }
    }
}

impl VehicleTable {
    /// The radius of a car's turning circle, metres.
    pub const fn radius(&self) -> Option<f64> {
        self.radius
    }

    /// The step of turning, if one was asked for; radians.
    pub(crate) const fn turn_step(&self) -> Option<f64> {
        self.turn_step
    }

    /// The longest motion, if one was asked for; metres.
    pub const fn reach(&self) -> Option<f64> {
        self.reach
    }

    /// The vehicle. `has_fan` tells whether a fan was asked for, `grid` what is flown with unless the table says
    /// otherwise.
    ///
    /// # Errors
    /// Names the field, what was found and what was expected.
    pub fn vehicle(
        &self,
        source: Source,
        algorithm: Algorithm,
        has_fan: bool,
        grid: FanName,
    ) -> Result<AnyVehicle> {
        let name = |key| source.name(key);
        if has_fan && self.turn_step.is_some() {
            return wrong(&name("turn_step"), "a fan too", "one of them");
        }
        self.check_keys(source)?;
        self.check_ranges(source)?;
        let default = if grid == FanName::Fine { 1e-6 } else { 0.01 };
        let turn_step_urad = whole(&name("turn_step"), self.turn_step.unwrap_or(default), 1e6)?;
        let step = self.step.unwrap_or(0.1);
        let speed_step_mm = whole(&name("step"), step, 1e3)?;
        let reach_mm = whole(&name("reach"), self.reach.unwrap_or(2.0), 1e3)?;
        let reach = f64::from(reach_mm) / 1e3;
        let steps = u16::try_from(reach_mm / speed_step_mm).unwrap_or(u16::MAX);
        if reach_mm % speed_step_mm != 0 || steps == u16::MAX {
            let expected =
                format!("a whole part of the longest motion, {reach} m, 65534 parts at most");
            return wrong(&name("step"), step, expected);
        }
        let speeds = steps + 1;
        let sharpest = self.sharpest.unwrap_or(std::f64::consts::FRAC_PI_2);
        let unicycle = || Unicycle::new(turn_step_urad, sharpest, speeds, speed_step_mm);
        let made = match self.kind {
            Kind::Unicycle => unicycle().map(AnyVehicle::Unicycle),
            Kind::Boat => unicycle().and_then(Boat::new).map(AnyVehicle::Boat),
            Kind::Car => {
                let Some(radius) = self.radius else {
                    return wrong(&name("radius"), "none", "the radius of its turning circle");
                };
                let shortest_mm = whole(&name("shortest"), self.shortest.unwrap_or(step), 1e3)?;
                let radius_mm = whole(&name("radius"), radius, 1e3)?;
                let shape =
                    CarShape { radius_mm, shortest_mm, turn_step_urad, speeds, speed_step_mm };
                Car::new(shape).map(AnyVehicle::Car)
            }
        };
        let made = made.or_else(|bad| match (bad, self.radius) {
            (GridError::Turn, Some(_)) => {
                let turn_step = f64::from(turn_step_urad) / 1e6;
                wrong(&name("turn_step"), turn_step, "radians, up to 0.7854 for a car")
            }
            (GridError::Circle, Some(radius)) => {
                let shortest = self.shortest.unwrap_or(step);
                let found = format!("{radius} with motions from {shortest} to {reach} m");
                wrong(&name("radius"), found, "a turning circle that some motion goes round")
            }
            (GridError::Circle, None) => {
                let expected = "a sharper turn, so that some motion goes round the turning circle";
                wrong(&name("sharpest"), sharpest, expected)
            }
            _ => wrong(&name("kind"), "no such vehicle", bad),
        })?;
        check_suits(&name("kind"), &made, algorithm)?;
        Ok(made)
    }

    /// The table of a vehicle, unless it is the unicycle of a fan.
    pub fn of(vehicle: AnyVehicle) -> Option<Self> {
        let is_of_a_fan = [FanName::Paper, FanName::Fine].map(AnyVehicle::from).contains(&vehicle);
        (!is_of_a_fan).then(|| vehicle.into())
    }

    /// Whether each key means something for its kind.
    fn check_keys(&self, source: Source) -> Result<()> {
        let is_car = self.kind == Kind::Car;
        for (key, is_there, means) in [
            ("sharpest", self.sharpest.is_some(), !is_car),
            ("radius", self.radius.is_some(), is_car),
            ("shortest", self.shortest.is_some(), is_car),
        ] {
            if is_there && !means {
                let kind = format!("with a {:?}", self.kind).to_ascii_lowercase();
                let has_it = if is_car { "with a unicycle or a boat" } else { "with a car" };
                return wrong(&source.name(key), kind, has_it);
            }
        }
        Ok(())
    }

    /// Whether each number is one that some vehicle may have.
    fn check_ranges(&self, source: Source) -> Result<()> {
        let longest = f64::from(ActionGrid::LONGEST_MM) / 1e3;
        let longest_step = f64::from(ActionGrid::LONGEST_STEP_MM) / 1e3;
        for (key, value, least, below) in [
            ("reach", self.reach, 1e-3, longest),
            ("step", self.step, 1e-3, longest_step),
            ("radius", self.radius, 1e-3, 2048.0),
            ("shortest", self.shortest, 1e-3, longest),
        ] {
            if let Some(metres) = value.filter(|it| !(least..below).contains(it)) {
                return beyond(&source.name(key), metres);
            }
        }
        for (key, value, least) in
            [("sharpest", self.sharpest, 1e-3), ("turn_step", self.turn_step, 1e-6)]
        {
            if let Some(radians) = value.filter(|it| !(least..PI + 1e-6).contains(it)) {
                return no_angle(&source.name(key), radians);
            }
        }
        Ok(())
    }
}

impl From<AnyVehicle> for VehicleTable {
    fn from(vehicle: AnyVehicle) -> Self {
        let grid = vehicle.grid();
        let metres = |mm: u32| f64::from(mm) / 1e3;
        let (turn_step_urad, kind) = match vehicle.into() {
            VehicleShape::Unicycle(it) => (it.turn_step_urad, Kind::Unicycle),
            VehicleShape::Boat(it) => (it.turn_step_urad, Kind::Boat),
            VehicleShape::Car(it) => (it.turn_step_urad, Kind::Car),
        };
        let (sharpest, car) = match vehicle.into() {
            VehicleShape::Unicycle(UnicycleShape { sharpest, .. })
            | VehicleShape::Boat(UnicycleShape { sharpest, .. }) => {
                // Half a turn is to the left.
                (Some(sharpest.radians().abs()), None)
            }
            VehicleShape::Car(shape) => (None, Some(shape)),
        };
        Self {
            kind,
            reach: Some(metres(grid.reach_mm(grid.speeds() - 1))),
            step: Some(metres(grid.speed_step_mm())),
            sharpest,
            turn_step: Some(f64::from(turn_step_urad) / 1e6),
            radius: car.map(|shape| metres(shape.radius_mm)),
            shortest: car.map(|shape| metres(shape.shortest_mm)),
        }
    }
}

/// Refuses a vehicle that the algorithm cannot drive. Chords, margin sampling, the random walk and the lawnmower drive no
/// boat and no car, and margin sampling tries no more than [`MOST_TRIED`] actions.
fn check_suits(name: &str, vehicle: &AnyVehicle, algorithm: Algorithm) -> Result<()> {
    use Algorithm::{Chords, Lawnmower, Margin, Random};
    let tries = matches!(algorithm, Chords | Lawnmower | Margin | Random);
    match vehicle {
        AnyVehicle::Boat(_) | AnyVehicle::Car(_) if tries => {
            let found = format!("one that cannot turn on the spot, with {}", algorithm.name());
            wrong(name, found, "cfc, scc or lookahead, which see to it that it can go on")
        }
        AnyVehicle::Unicycle(it) if algorithm == Margin && it.grid().actions() > MOST_TRIED => {
            let found = format!("{} actions with margin", it.grid().actions());
            wrong(name, found, format!("at most {MOST_TRIED}, as it tries every action"))
        }
        _ => Ok(()),
    }
}

/// Whether a vehicle can move in its area, less the tolerance.
///
/// # Errors
/// Names the tolerance, or the vehicle, the area, and how much it needs.
pub fn check_room(
    source: Source,
    vehicle: &AnyVehicle,
    config: &Settings<MissionArea>,
) -> Result<()> {
    let tolerance = config.tolerance.metres();
    aimed_for(config.area, vehicle, config.tolerance).map(drop).or_else(|error| {
        if let SetupError::Room(none) = error {
            let key = if matches!(vehicle, AnyVehicle::Car(_)) { "radius" } else { "sharpest" };
            let across = f64::from(none.across_mm) / 1e3;
            let found = format!("a turning circle {across:.1} m across");
            let area = of_area(config.area.bounds(), tolerance);
            return wrong(&source.name(key), found, format!("one that fits into {area}"));
        }
        let found = format!("{tolerance} m");
        // Reading a scenario file has refused such a tolerance by its parts.
        wrong(&source.name("tolerance"), found, "less than half the breadth of the area")
    })
}

fn of_area(area: Area, margin: f64) -> String {
    let [min, max] = [area.min(), area.max()].map(Point2::<f64>::from);
    let less = if margin > 0.0 { format!(", less {margin} m all around") } else { String::new() };
    format!("an area of {} m x {} m{less}", max.x - min.x, max.y - min.y)
}

/// A length in whole millimetres, or an angle in whole microradians.
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
