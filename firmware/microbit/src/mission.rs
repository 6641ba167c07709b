//! Asks for a mission, flies it, and asks for the next.

use embassy_nrf::gpio::Input;
use planner_core::link::delivery::LinkError;
use planner_core::link::message::{Algorithm, DeclinedError, Setup};
use planner_core::link::station::{PlannerSetup, Prepared, Station};
use planner_core::{Accuracy, AnyVehicle, Area, PinSensor, Planner};

use crate::serial::Serial;
use crate::stop;

/// Samples that a mission can hold: 64 labels beside four given ones.
const SAMPLES: usize = 68;

/// What it plans with: any vehicle in a rectangle. Polygons with keep-outs, and tables of hypotheses, would not fit
/// into 16 KB.
type Known = PlannerSetup<AnyVehicle, Area>;

/// The parts of the board that a mission uses.
pub(crate) struct Board {
    pub(crate) station: Station<Serial, PinSensor<Input<'static>>>,
}

impl Board {
    pub(crate) fn run(&mut self) -> ! {
        loop {
            let setup = self.station.await_setup();
            // The vehicle reports how it went: the board has no log.
            let _ = match self.station.terms(&setup) {
                Ok(terms) => self.fly_with(&setup, terms),
                Err(none) => self.station.give_up(none).map(drop),
            };
        }
    }

    fn fly_with(&mut self, setup: &Setup, terms: Known) -> Result<(), LinkError> {
        match setup.algorithm {
            Algorithm::Cfc => self.fly(setup, &mut setup.cfc::<_, _, SAMPLES>(terms)),
            Algorithm::Lookahead { evaluations, goal, noise: None } => {
                self.fly(setup, &mut setup.lookahead::<_, _, Accuracy, SAMPLES>(terms, evaluations, goal))
            }
            _ => self.station.decline(DeclinedError::Algorithm).map(drop),
        }
    }

    /// Flies a mission. The drive is enabled meanwhile.
    fn fly<L: Planner>(
        &mut self,
        setup: &Setup,
        planner: &mut Result<Prepared<L>, DeclinedError>,
    ) -> Result<(), LinkError> {
        if planner.is_ok() {
            stop::begin();
        }
        let flown = self.station.fly(setup, planner, |_| {});
        stop::end();
        flown.map(drop)
    }
}
