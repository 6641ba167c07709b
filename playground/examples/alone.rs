//! The planner alone as a WebAssembly module: look-ahead for a rover in a rectangle, where labels may be wrong.
//!
//! The caller owns the memory, and `begin` writes a planner there. Places are x and z in metres. Poses have a heading in
//! radians too. `cargo build -p playground --example alone --profile page --target wasm32-unknown-unknown`

#![cfg(target_family = "wasm")]

use std::mem::{MaybeUninit, size_of};

use planner_core::{
    Area, Goal, Heading, Label, Lookahead, Noise, NoisyBelief, Plan, Planner as _, Pose, Sample,
    SlopeWithin, Unicycle, sequences_of,
};

type Rover = Lookahead<Unicycle, NoisyBelief<68, { sequences_of(64) }>, Area, SlopeWithin>;

fn label(sign: f64) -> Label {
    if sign > 0.0 { Label::Positive } else { Label::Negative }
}

/// Bytes of a planner.
#[unsafe(no_mangle)]
pub extern "C" fn bytes() -> usize {
    size_of::<Rover>()
}

fn begun([width, height, degrees, p]: &[f64; 4], given: &[[f64; 3]; 4]) -> Option<Rover> {
    let mut samples = [Sample::at([0.0, 0.0], Label::Negative).ok()?; 4];
    for (sample, [x, z, sign]) in samples.iter_mut().zip(given) {
        *sample = Sample::at([*x, *z], label(*sign)).ok()?;
    }
    let belief = NoisyBelief::new(&samples, Noise::new(*p).ok()?).ok()?;
    let area = Area::metres([0.0, 0.0], [*width, *height]).ok()?;
    let goal = Goal::slope_within_degrees(*degrees).ok()?;
    Some(Lookahead::new(area, Unicycle::default(), belief).ok()?.until(goal))
}

/// Begins a planner in memory of the caller.
#[unsafe(no_mangle)]
pub extern "C" fn begin(
    at: &mut MaybeUninit<Rover>,
    field: &[f64; 4],
    given: &[[f64; 3]; 4],
) -> bool {
    let planner = begun(field, given);
    let is_begun = planner.is_some();
    if let Some(planner) = planner {
        at.write(planner);
    }
    is_begun
}

fn pose([x, z, heading]: &[f64; 3]) -> Option<Pose> {
    Pose::at([*x, *z], Heading::from_radians(*heading).ok()?).ok()
}

/// Where the next motion leads from a pose. Returns whether there is one.
#[unsafe(no_mangle)]
pub extern "C" fn plan(planner: &mut Rover, at: &[f64; 3], target: &mut [f64; 3]) -> bool {
    let Some(Plan::Move(it)) = pose(at).map(|it| planner.plan(it)) else { return false };
    let [x, z]: [f64; 2] = planner_core::nalgebra::Point2::<f64>::from(it.target.site).into();
    *target = [x, z, it.target.heading.radians()];
    true
}

/// Takes the label at a pose.
#[unsafe(no_mangle)]
pub extern "C" fn observe(planner: &mut Rover, at: &[f64; 3], sign: f64) -> bool {
    pose(at).is_some_and(|it| planner.observe(it, Some(label(sign).into())).is_ok())
}

/// The line as it is known: `A x + B z + C = 0`.
#[unsafe(no_mangle)]
pub extern "C" fn estimate(planner: &Rover, line: &mut [f64; 3]) -> bool {
    let Some(it) = planner.estimate() else { return false };
    *line = it.coefficients();
    true
}
