// The same as a program: in Python with the simulator, in Rust with the planner for a robot of one's own.

function python(state) {
  const quoted = (text) => text.replaceAll('\\', '\\\\').replaceAll('"""', '\\"""');
  const all = { ...files(state), 'scenario.toml': `\n${toml(state)}` };
  const written = Object.entries(all).map(([name, text]) => `Path("${name}").write_text("""${quoted(text)}""")\n`);
  return `# pip install ./python, in a copy of the repository
from pathlib import Path

import boundary_planner as b

${written.join('')}flight = b.Mission("scenario.toml").run()
print(flight.end["reason"], flight.end)
Path("scenario.html").write_text(flight.html())   # a page to step through
`;
}

/** A number as Rust has it. */
function float(number) {
  return Number.isInteger(number) ? `${number}.0` : String(number);
}

function pair([x, z]) {
  return `[${float(x)}, ${float(z)}]`;
}

/** Whether a place is on the +1 side, in Rust. */
function rustSide(state) {
  const { kind, points } = state;
  if (isHidden(state)) {
    return '    // Read your sensor here. This stands for it: another coast.\n    at.y > 40.0 + 6.0 * (at.x / 15.0).sin()';
  }
  if (kind === 'circle') {
    const [[x, z], rim] = points;
    return `    // Read your sensor here. This stands for it: a disc.
    (at.x - ${float(x)}).hypot(at.y - ${float(z)}) < ${float(tidy(Math.hypot(rim[0] - x, rim[1] - z)))}`;
  }
  if (kind === 'shape') {
    return `    // Read your sensor here. This stands for it: a polygon.
    let corners = [${points.map(pair).join(', ')}];
    let sides = corners.iter().zip(corners.iter().cycle().skip(1));
    let crossed = sides.filter(|([px, pz], [qx, qz])| {
        (*pz <= at.y) != (*qz <= at.y) && px + (at.y - pz) / (qz - pz) * (qx - px) < at.x
    });
    crossed.count() % 2 == 1`;
  }
  const sorted = fromLeft(points);
  return `    // Read your sensor here. This stands for it: above a way from left to right.
    let points: [[f64; 2]; ${sorted.length}] = [${sorted.map(pair).join(', ')}];
    let piece = points.windows(2).find(|it| at.x < it[1][0]).unwrap_or(&points[points.len() - 2..]);
    let ([px, pz], [qx, qz]) = (piece[0], piece[1]);
    (qx - px) * (at.y - pz) > (qz - pz) * (at.x - px)`;
}

function rust(state) {
  const follows = state.planner === 'track';
  const isSure = state.p === '1';
  const longest = reach(state);
  const step = Math.round((longest * 1000) / LENGTHS);
  const { left, bottom, width, height } = ground(state);
  const vehicle = {
    unicycle: `Unicycle::new(10_000, 1.57, 21, ${step})?`,
    boat: `Boat::new(Unicycle::new(10_000, 0.8, 21, ${step})?)?`,
    car: `Car::new(CarShape {
        radius_mm: ${Math.round(longest * 500)},
        shortest_mm: ${step},
        turn_step_urad: 10_000,
        speeds: 21,
        speed_step_mm: ${step},
    })?`,
  }[state.vehicle];
  const types = { unicycle: ['Unicycle'], boat: ['Boat', 'Unicycle'], car: ['Car', 'CarShape'] }[state.vehicle];
  const likely = state.kind === 'circle' || state.kind === 'shape' ? 'Spill' : 'Coast';
  const front = state.moves ? `Front::BENDING.moving(${float(speed(state))})?` : 'Front::BENDING';
  const isScc = state.planner === 'cfc' || state.planner === 'scc';
  const given = known({ ...state, told: true });
  const name = isScc && isSure ? 'Cfc' : 'Lookahead';
  const belief = isSure
    ? `VersionSpace::<68>::new(&given)?`
    : `NoisyBelief::<68, { sequences_of(64) }>::new(&given, Noise::new(${float(Number(state.p))})?)?`;
  const samples = given.length > 0 ? given : [[...state.start, -1], ...places(ground(state), [[0.1, 0.9], [0.9, 0.9], [0.9, 0.05]]).map((at, k) => [...at, k < 2 ? 1 : -1])];
  const planner = follows
    ? `    // How often a label is true. Nothing is known beforehand: the robot seeks the front.
    let noise = Noise::new(${isSure ? '0.99' : float(Number(state.p))})?;
    let planner = Track::new(area, vehicle, ${front}, noise)?
        .seeking(Seeking::patches(${float(tidy((width + height) / 32))})?.likely(Likely::${likely}))?
        .until_closed();`
    : `    let given = [
${samples.map(([x, z, label]) => `        Sample::at([${float(x)}, ${float(z)}], Label::${label > 0 ? 'Positive' : 'Negative'})?,`).join('\n')}
    ];
    let belief = ${belief};
    let planner = ${name}::new(area, vehicle, belief)?${name === 'Lookahead' ? `.until(Goal::slope_within_degrees(${isSure ? '0.5' : '5.0'})?)` : ''};`;
  const used = [
    'Agent', 'Area', 'Event', 'Heading', 'Label', 'Motion', 'Pose', 'Reading', ...types,
    ...(follows ? ['Front', 'Likely', 'Noise', 'Planner as _', 'Seeking', 'Track'] : ['Sample', name, ...(name === 'Lookahead' ? ['Goal'] : []), ...(isSure ? ['VersionSpace'] : ['Noise', 'NoisyBelief', 'sequences_of'])]),
    'Vehicle',
  ];
  const last = follows
    ? `    for place in agent.planner.belief().places() {
        println!("{:?} within {:.2} m", Point2::<f64>::from(place.waist.site), place.waist.half_width(0.9));
    }`
    : `    println!("{:?}", agent.estimate());`;
  return `//! In a copy of the repository: save this as planner-core/examples/mine.rs, and
//! \`cargo run -p planner-core --example mine\`.

use std::{cell::Cell, convert::Infallible, error::Error};

use planner_core::nalgebra::Point2;
use planner_core::robot::{DriveFn, SensorFn};
use planner_core::{${[...new Set(used)].sort().join(', ')}};

/// Whether the sensor reads +1 at a place; metres.
fn reads_positive(at: Point2<f64>) -> bool {
${rustSide(state)}
}

fn main() -> Result<(), Box<dyn Error>> {
    let start = Pose::at(${pair(state.start)}, Heading::default())?;
    let robot = Cell::new(start); // stands for your robot
    let drive = DriveFn(|motion: &Motion| {
        robot.set(motion.target); // command your motors here
        Ok::<_, Infallible>(robot.get()) // where the motion ended
    });
    let sensor = SensorFn(|| {
        let is_positive = reads_positive(robot.get().site.into());
        let label = if is_positive { Label::Positive } else { Label::Negative };
        Ok::<Reading, Infallible>(label.into())
    });
    let area = Area::metres(${pair([left, bottom].map(tidy))}, ${pair([left + width, bottom + height].map(tidy))})?;
    let vehicle = ${vehicle};
${planner}
    let mut agent = Agent::new(planner, Vehicle { drive, sensor }, start);
    for _ in 0..${follows ? 600 : 60} {
        match agent.step()? {
            Event::Step(step) => println!("{:?}", step.reading),
            Event::Stopped(reason) => {
                println!("{reason:?}");
                break;
            }
        }
    }
${last}
    Ok(())
}
`;
}
