//! Any of the vehicles that turn and drive, chosen while the program runs: by a scenario, or over a wire.

use crate::geometry::heading::Heading;
use crate::geometry::lattice::{LatticeError, Vector};
use crate::motion::action::{Action, ActionGrid, Control, GridError};
use crate::motion::boat::Boat;
use crate::motion::car::{Car, CarShape};
use crate::motion::dynamics::{Dynamics, Pose, Ray, RayFan, RoomError, Side, TurningCircle};
use crate::motion::unicycle::{Unicycle, UnicycleShape};

/// A vehicle of one of three kinds. A program that knows its vehicle is smaller and faster with that type.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AnyVehicle {
    /// Turns on the spot, then drives.
    Unicycle(Unicycle),
    /// Turns a little and drives, a step at a time, and never on the spot.
    Boat(Boat),
    /// Drives along arcs of at most some curvature.
    Car(Car),
}

/// The parameters of a vehicle, from which the other end of a link can build it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename = "Vehicle"))]
pub enum VehicleShape {
    /// Of a [`Unicycle`].
    Unicycle(UnicycleShape),
    /// Of a [`Boat`], by its steps.
    Boat(UnicycleShape),
    /// Of a [`Car`].
    Car(CarShape),
}

/// Why a shape gives no usable vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum ShapeError {
    /// This program has no vehicle of this kind.
    Kind,
    /// Its numbers describe no vehicle.
    Grid(GridError),
    /// It cannot move in its area.
    Room(RoomError),
}

impl core::fmt::Display for ShapeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Kind => f.write_str("no vehicle of this kind"),
            Self::Grid(bad) => bad.fmt(f),
            Self::Room(none) => none.fmt(f),
        }
    }
}

impl core::error::Error for ShapeError {}

impl TryFrom<VehicleShape> for AnyVehicle {
    type Error = ShapeError;

    fn try_from(shape: VehicleShape) -> Result<Self, ShapeError> {
        match shape {
            VehicleShape::Unicycle(shape) => Unicycle::of(shape).map(Self::Unicycle),
            VehicleShape::Boat(steps) => Unicycle::of(steps).and_then(Boat::new).map(Self::Boat),
            VehicleShape::Car(shape) => Car::new(shape).map(Self::Car),
        }
        .map_err(ShapeError::Grid)
    }
}

/// For a program that has no other vehicle.
impl TryFrom<VehicleShape> for Unicycle {
    type Error = ShapeError;

    fn try_from(shape: VehicleShape) -> Result<Self, ShapeError> {
        match shape {
            VehicleShape::Unicycle(shape) => Self::of(shape).map_err(ShapeError::Grid),
            VehicleShape::Boat(_) | VehicleShape::Car(_) => Err(ShapeError::Kind),
        }
    }
}

impl From<AnyVehicle> for VehicleShape {
    fn from(vehicle: AnyVehicle) -> Self {
        match vehicle {
            AnyVehicle::Unicycle(it) => Self::Unicycle(it.shape()),
            AnyVehicle::Boat(it) => Self::Boat(it.steps().shape()),
            AnyVehicle::Car(it) => Self::Car(it.shape()),
        }
    }
}

/// Calls the same method on whichever vehicle it is.
macro_rules! of {
    ($vehicle:expr, $it:ident => $says:expr) => {
        match $vehicle {
            Self::Unicycle($it) => $says,
            Self::Boat($it) => $says,
            Self::Car($it) => $says,
        }
    };
}

impl Dynamics for AnyVehicle {
    fn grid(&self) -> ActionGrid {
        of!(self, it => it.grid())
    }

    fn fan(&self) -> RayFan {
        of!(self, it => it.fan())
    }

    fn heading(&self, pose: Pose, side: Side, n: u32) -> Heading {
        of!(self, it => it.heading(pose, side, n))
    }

    fn ray(&self, pose: Pose, side: Side, n: u32) -> Ray {
        of!(self, it => it.ray(pose, side, n))
    }

    fn rays_at(&self, speed: u16) -> Option<[u32; 2]> {
        of!(self, it => it.rays_at(speed))
    }

    fn arrive(&self, pose: Pose, ray: &Ray, speed: u16) -> Result<Pose, LatticeError> {
        of!(self, it => it.arrive(pose, ray, speed))
    }

    fn tangent_intersection(&self, from: Pose, to: Pose) -> Option<Vector> {
        of!(self, it => it.tangent_intersection(from, to))
    }

    fn turning_circles(&self, pose: Pose) -> Option<[TurningCircle; 2]> {
        of!(self, it => it.turning_circles(pose))
    }

    fn turn_in_place(&self, pose: Pose, side: Side) -> Option<(Action, Pose)> {
        of!(self, it => it.turn_in_place(pose, side))
    }

    fn ray_of(&self, pose: Pose, action: Action) -> Option<Ray> {
        of!(self, it => it.ray_of(pose, action))
    }

    fn control(&self, pose: Pose, action: Action) -> Control {
        of!(self, it => it.control(pose, action))
    }
}
