//! Two robots that start back to back on one front, and one map that is joined from theirs.
//!
//! The robots know nothing of each other: each has its own tracker and its own errors of the sensor. The fronts and the
//! motions are those of `campaign --fronts`.

use host_sim::campaign::fronts::flight::{sea, tracker, vehicle};
use host_sim::campaign::fronts::following::{Course, REACH, follow};
use host_sim::campaign::fronts::kinds::Told;
use host_sim::campaign::fronts::true_front::{TrueFront, site};
use host_sim::mission::front::VertexRecord;
use host_sim::mission::join::{Joined, Pieces};
use planner_core::{Heading, Noise, Pose, Track};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::cases;

const SEED: u64 = 45;

/// The map of one robot, and after how many motions it had gone all round.
struct Flight {
    map: Pieces,
    closed: Option<usize>,
}

/// Follows a front from its place, in its direction or the other one.
fn fly(
    front: &TrueFront,
    radius: f64,
    p: f64,
    (is_along, motions): (bool, u32),
    rng: &mut ChaCha8Rng,
) -> Flight {
    let told = Told { radius, speed: 0.0 };
    let tracker = tracker(front, told, Noise::new(p).expect("a probability")).expect("a front");
    let planner = Track::new(sea().expect("an area"), vehicle(REACH).expect("a vehicle"), tracker);
    let turned = if is_along { 0.0 } else { std::f64::consts::PI };
    let heading = Heading::from_radians(front.angle + turned).expect("an angle");
    let start = Pose { site: site(front.beside(0.0, 2.0)), heading };
    // One motion more, as each is shown before it is observed.
    let course = Course { motions: motions + 1, steps: 1.0, p };
    let (mut found, mut closed, mut motion) = (Vec::new(), None, 0);
    follow(front, planner.expect("room"), (course, start), rng, |planner, _, _| {
        if motion > 0 {
            found.push(planner.found().map(VertexRecord::from));
        }
        if closed.is_none() && planner.is_closed() {
            closed = Some(motion);
        }
        motion += 1;
    });
    let (mut map, mut is_known) = (Pieces::new(), false);
    for (number, vertex) in (1..).zip(found) {
        if let Some(vertex) = vertex {
            match map.last_mut() {
                Some(piece) if is_known => piece.push((number, vertex)),
                _ => map.push(vec![(number, vertex)]),
            }
        }
        is_known = vertex.is_some();
    }
    Flight { map, closed }
}

/// What the missions of a row come to.
struct Row {
    /// Motions of the pair until its map is closed, and of one robot until its own is. Infinite if it never is.
    motions: Vec<[f64; 2]>,
    /// Distance from the front of each vertex, and its half-width.
    off: Vec<[f64; 2]>,
    /// Pieces of the joined map, and whether each of the two maps has one alone.
    pieces: Vec<(usize, bool)>,
    /// The longest way between two vertices of the first piece, metres.
    gaps: Vec<f64>,
    /// Metres of front that are mapped twice, as a share.
    twice: Vec<f64>,
    /// Metres along the map of the pair, and of one robot with as many motions as both.
    metres: Vec<[f64; 2]>,
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

/// Flies pairs along a kind of front. An open one is followed for `motions` by each.
fn row(
    name: &str,
    draw: fn(&mut ChaCha8Rng) -> TrueFront,
    (radius, p, motions): (f64, f64, u32),
    is_closed: bool,
) -> Row {
    let missions = cases(20, 100);
    let mission = |number| {
        let mut rng = ChaCha8Rng::seed_from_u64(SEED);
        rng.set_stream(number);
        let front = draw(&mut rng);
        let one =
            fly(&front, radius, p, (true, if is_closed { motions } else { 2 * motions }), &mut rng);
        let pair = [true, false].map(|is| fly(&front, radius, p, (is, motions), &mut rng).map);
        let met = Joined::closes_at(&pair);
        let joined = Joined::until(&pair, met.unwrap_or(usize::MAX));
        let are_whole = pair.iter().all(|it| it.len() == 1);
        (front, one, met, joined, are_whole)
    };
    let flown: Vec<_> = (0..missions).into_par_iter().map(mission).collect();
    let mut row = Row {
        motions: vec![],
        off: vec![],
        pieces: vec![],
        gaps: vec![],
        twice: vec![],
        metres: vec![],
    };
    for (front, one, met, joined, are_whole) in &flown {
        let motions = |it: Option<usize>| it.map_or(f64::INFINITY, |it| it as f64);
        row.motions.push([motions(*met), motions(one.closed)]);
        row.pieces.push((joined.pieces.len(), *are_whole));
        let whole: Vec<_> = joined.pieces.iter().flatten().collect();
        for it in &whole {
            row.off.push([front.distance(it.vertex.at(), 0.0), it.vertex.half_width]);
        }
        let Some(first) = joined.pieces.first() else { continue };
        let along: Vec<_> = first.iter().map(|it| front.along(it.vertex.at(), 0.0)).collect();
        let ways: Vec<_> = along.windows(2).map(|it| front.way_between(it[0], it[1])).collect();
        row.gaps.push(ways.iter().copied().fold(0.0, f64::max));
        let [all, net] = [ways.iter().map(|it| it.abs()).sum::<f64>(), ways.iter().sum::<f64>()];
        row.twice.push((all - net.abs()) / all);
        row.metres.push([joined.metres(), Joined::of(std::slice::from_ref(&one.map)).metres()]);
    }
    let pair = median(row.motions.iter().map(|it| it[0]).collect());
    let alone = median(row.motions.iter().map(|it| it[1]).collect());
    let share = |it: f64, of: usize| 100.0 * it / of as f64;
    let covers = row.off.iter().filter(|[off, half]| off <= half).count() as f64;
    let mut off: Vec<_> = row.off.iter().map(|it| it[0]).collect();
    off.sort_by(f64::total_cmp);
    println!(
        "{name}, p = {p}, {missions} missions, seed {SEED}: {pair} motions ({alone} alone), closed {} of {}, {:.3} / {:.3} m \
         off, covers {:.1} %, one piece {} (most {}), longest gap {:.2} m, twice {:.2} %, metres {:.1} ({:.1} alone)",
        row.motions.iter().filter(|it| it[0].is_finite()).count(),
        row.motions.iter().filter(|it| it[1].is_finite()).count(),
        off[off.len() / 2],
        off[off.len() * 95 / 100],
        share(covers, off.len()),
        row.pieces.iter().filter(|it| it.0 == 1).count(),
        row.pieces.iter().map(|it| it.0).max().unwrap_or(0),
        row.gaps.iter().copied().fold(0.0, f64::max),
        100.0 * row.twice.iter().copied().fold(0.0, f64::max),
        median(row.metres.iter().map(|it| it[0]).collect()),
        median(row.metres.iter().map(|it| it[1]).collect()),
    );
    row
}

impl Row {
    /// The joined map has no gap where those of the robots have none, goes along no place twice, and its half-widths hold.
    fn check(&self) {
        let covers = self.off.iter().filter(|[off, half]| off <= half).count();
        assert!(covers * 100 >= 95 * self.off.len(), "{covers} of {}", self.off.len());
        assert!(self.pieces.iter().all(|(pieces, are_whole)| *pieces == 1 || !are_whole));
        assert!(self.gaps.iter().all(|it| *it < 7.0 * REACH), "{:?}", self.gaps);
        assert!(self.twice.iter().all(|it| *it < 0.01), "{:?}", self.twice);
    }
}

#[test]
fn a_pair_maps_a_closed_front_in_half_the_time() {
    for p in [1.0, 0.9] {
        let small = |rng: &mut ChaCha8Rng| TrueFront::circle(20.0, rng);
        let large = |rng: &mut ChaCha8Rng| TrueFront::circle(60.0, rng);
        let small = row("circle of 20 m", small, (20.0, p, 100), true);
        let large = row("circle of 60 m", large, (60.0, p, 240), true);
        for (it, radius) in [(small, 20.0), (large, 60.0)] {
            it.check();
            let [pair, alone] =
                [0, 1].map(|k| median(it.motions.iter().map(|motions| motions[k]).collect()));
            assert!(pair < 0.56 * alone, "{pair} against {alone} motions");
            let late = it.motions.iter().filter(|it| it[0] > 0.75 * alone).count();
            // One map of a hundred has a hole where its robot lost the front; of few missions one may.
            let most = (it.motions.len() / 50).max(1);
            assert!(late <= most, "{late}: {:?}", it.motions);
            // All of the circle, once: a polyline is shorter than it, and one that goes to and fro is longer.
            let round = std::f64::consts::TAU * radius;
            let is_round = |it: &[f64; 2]| (0.95..1.1).contains(&(it[0] / round));
            let others = it.metres.iter().filter(|it| !is_round(it)).count();
            assert!(others * 50 <= it.metres.len(), "{others}: {:?}", it.metres);
        }
    }
}

#[test]
fn a_pair_maps_an_open_front_to_both_sides() {
    for p in [1.0, 0.9] {
        let coast = |rng: &mut ChaCha8Rng| TrueFront::coast([6.0, 25.0], rng);
        let it = row("coast", coast, (40.0, p, 100), false);
        it.check();
        assert!(it.motions.iter().all(|it| it[0].is_infinite()), "a coast is not closed");
        let [pair, alone] =
            [0, 1].map(|k| median(it.metres.iter().map(|metres| metres[k]).collect()));
        assert!(pair > 0.95 * alone, "{pair} against {alone} m");
    }
}
