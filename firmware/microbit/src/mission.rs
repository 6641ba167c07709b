//! Asks for a mission, flies it, and asks for the next.

use embassy_nrf::gpio::Input;
use planner_core::link::delivery::LinkError;
use planner_core::link::station::{Flown, Station, TrueLabels, Watch};
use planner_core::{AnyVehicle, Area, PinSensor};

use crate::serial::Serial;
use crate::stop;

/// Samples that a mission can hold: 64 labels beside four given ones.
const SAMPLES: usize = 68;

/// Flies missions of any vehicle in a rectangle. Polygons with keep-outs, and tables of hypotheses, would not fit into
/// 16 KB.
pub(crate) fn run(mut station: Station<Serial, PinSensor<Input<'static>>>) -> ! {
    loop {
        // The vehicle reports how it went: the board has no log.
        let _ = station.mission::<TrueLabels<SAMPLES>, AnyVehicle, Area>(&mut Drive);
    }
}

/// The drive, which is enabled during a mission.
struct Drive;

impl Watch for Drive {
    const READINGS: bool = true;

    fn begins(&mut self) {
        stop::begin();
    }

    fn over(&mut self, _: &Result<Flown, LinkError>) {
        stop::end();
    }
}
