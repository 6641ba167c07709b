//! Missions that follow a front, as a chip may be asked to fly them.

use host_sim::mission::definition::Mission;
use host_sim::mission::scenario::{self, Overrides};

/// Missions of four kinds by turns: along a coast, round a circle with labels that may be wrong, from nothing, and along a
/// front that moves with a robot that errs. `seed` draws coasts, noise and errors.
///
/// # Panics
/// Never: these are scenarios.
pub fn following(seed: u64, number: u64, steps: u32) -> Mission {
    let seed = 1_000 * seed + number;
    let four = |points: [(i32, i32, i32); 4]| {
        let point = |(x, z, label)| format!("{{ x = {x}, z = {z}, label = {label} }}");
        format!("[{}]", points.map(point).join(", "))
    };
    let beside = four([(4, 18, -1), (4, 42, 1), (12, 42, 1), (12, 18, -1)]);
    let text = match number % 4 {
        0 => format!(
            "area = {{ x = [0, 160], z = [0, 60] }}\nstart = {{ x = 8, z = 30, heading = 0 }}\n\
             front = {{ radius = 20 }}\ntruth = {{ coast = {{ height = 6, length = 25, seed = {seed} }} }}\n\
             oracle = {beside}\n"
        ),
        1 => {
            let radius = 20 + 5 * (number / 4 % 8) as i32;
            let (near, far) = (100 - radius - 12, 100 - radius + 12);
            let given = four([(90, near, -1), (90, far, 1), (110, far, 1), (110, near, -1)]);
            format!(
                "area = {{ x = [0, 200], z = [0, 200] }}\n\
                 start = {{ x = 98, z = {near}, heading = 0 }}\nfront = {{ radius = {radius} }}\n\
                 truth = {{ circle = [100, 100, {radius}] }}\noracle = {given}\nnoise = {{ p = 0.9 }}\n\
                 stop = {{ closed = true }}\n"
            )
        }
        2 => {
            let (phase, slope) = (number % 7, 0.1 * (number % 9) as f64 - 0.4);
            format!(
                "area = {{ x = [0, 60], z = [0, 60] }}\nstart = {{ x = 5, z = 5, heading = 0.7 }}\n\
                 front = {{ radius = 20 }}\n\
                 truth = {{ sine = [3, 45, {phase}], slope = {slope}, intercept = 30 }}\noracle = []\n"
            )
        }
        _ => format!(
            "area = {{ x = [0, 160], z = [0, 80] }}\nstart = {{ x = 8, z = 30, heading = 0 }}\n\
             front = {{ radius = 60, speed = 0.06 }}\n\
             truth = {{ slope = 0.05, intercept = 29.5, drift = [0.05, 0.1] }}\noracle = {beside}\n\
             noise = {{ p = 0.85 }}\ntolerance = 0.3\n\
             errors = {{ motion = 0.03, turn = 0.01, position = 0.1, heading = 0.01 }}\n"
        ),
    };
    let head = format!("algorithm = \"track\"\nseed = {seed}\nsteps = {steps}\n");
    scenario::parse("", &(head + &text), Overrides::default()).expect("a scenario")
}
