//! What the cross-crate tests share.
//!
//! - Adversarial sites, and slow twins: the version space's here, others in [`twins`].
//! - Missions as a chip may be asked to fly them ([`missions`]), and such in which everything is drawn at random
//!   ([`anything`]).
//! - Missions that follow a front ([`fronts`]), and missions in lakes from maps ([`lakes`]).
//! - A chip in the test's own thread ([`chip`]), and a wire that spoils frames ([`wire`]).
//! - Ensembles of missions and their figures ([`ensemble`]), and vehicles ([`vehicles`]).
//! - The command line in the test's own process ([`command`]).
//! - What tests build and need besides ([`build`]).
//! - Beliefs to ask ([`known`]), and areas with keep-outs ([`terrain`]).

use std::env;
use std::sync::LazyLock;

use planner_core::lattice::LIMIT;
use planner_core::{Label, Sample, Site, Vector};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

pub mod anything;
pub mod build;
pub mod chip;
pub mod command;
pub mod ensemble;
pub mod fronts;
pub mod known;
pub mod lakes;
pub mod missions;
pub mod terrain;
pub mod twins;
pub mod vehicles;
pub mod wire;

/// One in how many cases of a long run is run, if this is one: thousands of random missions, searches for hard ones, all
/// cores. `LONG=1` in the environment asks for all, `LONG=10` for one in ten.
fn long() -> Option<u64> {
    static LONG: LazyLock<Option<u64>> = LazyLock::new(|| {
        let long = env::var("LONG").ok()?;
        let share = long.parse().ok().filter(|it| *it > 0);
        Some(
            share
                .unwrap_or_else(|| panic!("LONG={long}: it is 1 for all cases, 10 for one in ten")),
        )
    });
    *LONG
}

/// Whether this is a long run.
pub fn is_long() -> bool {
    long().is_some()
}

/// The number of cases: few by default, more in a long run.
pub fn cases(few: u64, many: u64) -> u64 {
    long().map_or(few, |share| few.max(many / share))
}

/// The seed of a test's random numbers: its own, or another with `SEED=N` in the environment. A failure under `SEED=N`
/// becomes a case of its own, with the seed that this returns.
///
/// # Panics
/// When `SEED` is no whole number.
pub fn seed(own: u64) -> u64 {
    let told: u64 = env::var("SEED").map_or(0, |it| it.parse().expect("SEED is a whole number"));
    // Any two differ in about half of their bits, so seeds do not meet those of other tests.
    own ^ told.wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

/// Whether files that hold what is expected, or what was measured, are to be written anew (`UPDATE_EXPECT`).
pub fn is_updating() -> bool {
    env::var_os("UPDATE_EXPECT").is_some()
}

/// A site whose coordinates are clamped into the lattice.
///
/// # Panics
/// Never.
pub fn clamped(x: i64, z: i64) -> Site {
    let most = i64::from(LIMIT) - 1;
    let inside = |v: i64| v.clamp(-most, most) as i32;
    Site::new(inside(x), inside(z)).expect("clamped")
}

/// A site to trip over: near the origin, anywhere, at the lattice's corners, on a coarse grid, or
/// all but on the line through two of the sites so far.
pub fn adversarial(rng: &mut ChaCha8Rng, so_far: &[Site]) -> Site {
    let far = i64::from(LIMIT);
    let small = |rng: &mut ChaCha8Rng, n: i64| rng.random_range(-n..=n);
    match (rng.random_range(0..6), so_far) {
        (0, _) => clamped(small(rng, 3), small(rng, 3)),
        (1, _) => clamped(small(rng, far), small(rng, far)),
        (2, _) => {
            let corner = |rng: &mut ChaCha8Rng| far * (2 * rng.random_range(0..2i64) - 1);
            clamped(corner(rng) + small(rng, 2), corner(rng) + small(rng, 2))
        }
        (3, [.., last]) => *last,
        (4 | 5, [.., a, b]) => {
            let (d, t) = (*b - *a, rng.random_range(-8..=16i64));
            let on = |start: i32, run: i32| i64::from(start) + i64::from(run) * t / 8;
            let off = rng.random_range(0..=1);
            clamped(on(a.x(), d.x()) + small(rng, off), on(a.z(), d.z()) + small(rng, off))
        }
        _ => clamped(65_536 * small(rng, 20), 65_536 * small(rng, 20)),
    }
}

/// A label's sign.
pub fn sign(label: Label) -> i128 {
    i128::from(label.sign())
}

/// A line as integers `(A, B, C)`, and the twin's exact arithmetic on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TwinLine {
    /// Coefficients.
    pub abc: [i128; 3],
}

impl TwinLine {
    /// The line through two samples, oriented so that it agrees with the half-planes of both when
    /// moved a little: `a_i x a_j` with `a = y (x, z, 1)`.
    pub fn through(s: &Sample, t: &Sample) -> Self {
        let a = |s: &Sample| {
            let y = sign(s.label);
            [y * i128::from(s.site.x()), y * i128::from(s.site.z()), y]
        };
        let ([a, b, c], [d, e, f]) = (a(s), a(t));
        Self { abc: [b * f - c * e, c * d - a * f, a * e - b * d] }
    }

    /// The line with its sides swapped.
    #[must_use]
    pub fn reversed(self) -> Self {
        Self { abc: self.abc.map(|v| -v) }
    }

    /// Positive on the +1 side of it.
    pub fn at(&self, q: Site) -> i128 {
        let [a, b, c] = self.abc;
        a * i128::from(q.x()) + b * i128::from(q.z()) + c
    }

    /// The direction, +1 side to the left.
    pub fn direction(&self) -> [i128; 2] {
        [self.abc[1], -self.abc[0]]
    }
}

/// The slow twin of the version space's vertices: every line through two samples, either way round,
/// that agrees with every sample. Parallel copies are left in.
pub fn twin(samples: &[Sample]) -> Vec<TwinLine> {
    let mut lines = Vec::new();
    for (i, s) in samples.iter().enumerate() {
        for t in &samples[..i] {
            let line = TwinLine::through(s, t);
            if s.site == t.site {
                continue;
            }
            for line in [line, line.reversed()] {
                if samples.iter().all(|r| sign(r.label) * line.at(r.site) >= 0) {
                    lines.push(line);
                }
            }
        }
    }
    lines
}

/// The cross product of two directions.
pub fn cross(a: [i128; 2], b: [i128; 2]) -> i128 {
    a[0] * b[1] - a[1] * b[0]
}

/// A vector in the twin's integers.
pub fn wide(v: Vector) -> [i128; 2] {
    [i128::from(v.x()), i128::from(v.z())]
}
