//! Curved boundaries against slow ways to the same answers.

use std::f64::consts::TAU;

use nalgebra::{Point2, Vector2};
use planner_core::{Label, Line, Reading, Site};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::world::World;
use crate::world::boundary::Curve;
use crate::world::circle::Circle;
use crate::world::grid::Grid;
use crate::world::moving::Moving;
use crate::world::polygon::Polygon;
use crate::world::polyline::Polyline;
use crate::world::raster::Raster;
use crate::world::sine::Sine;

/// A boundary, and whether a place is +1 by a formula of its own.
type Case = (Box<dyn Curve>, Box<dyn Fn(Point2<f64>) -> bool>);

fn at(x: f64, z: f64) -> Point2<f64> {
    Point2::new(x, z)
}

fn area() -> Polygon {
    Polygon(vec![at(0.0, 0.0), at(20.0, 0.0), at(20.0, 20.0), at(0.0, 20.0)])
}

/// 12 x 8 cells of 1.5 m x 2 m with islands and a saddle; -1 where a value is below 5.
fn grid() -> Grid {
    let mut rng = ChaCha8Rng::seed_from_u64(8);
    let values = (0..96).map(|_| rng.random_range(0.0..10.0)).collect();
    Grid { corner: at(1.0, 2.0), cell: [1.5, 2.0], columns: 12, values }
}

fn cases() -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    for (middle, radius) in [(at(10.0, 8.0), 5.0), (at(-30.0, 4.0), 41.0), (at(3.0, 18.0), 0.7)] {
        cases.push((
            Box::new(Circle { middle, radius }),
            Box::new(move |p| (p - middle).norm_squared() < radius * radius),
        ));
    }
    for (height, length, phase) in [(1.0, 10.0, 0.0), (2.0, 3.0, 1.3), (0.05, 40.0, -9.0)] {
        let base = Line::from_slope(0.0, 8.0).unwrap();
        cases.push((
            Box::new(Sine { base, height, length, phase }),
            Box::new(move |p| p.y - 8.0 > height * (TAU * p.x / length + phase).sin()),
        ));
    }
    // The same about a slope of 3/4 and about a vertical line whose +1 side is on the left.
    let base = Line::from_slope(0.75, 2.5).unwrap();
    cases.push((
        Box::new(Sine { base, height: 1.5, length: 6.0, phase: 0.4 }),
        Box::new(|p| {
            // Turned back about the origin, by which the base line is z = 2.
            let (x, z) = (0.8 * p.x + 0.6 * p.y, 0.8 * p.y - 0.6 * p.x);
            z - 2.0 > 1.5 * (TAU * x / 6.0 + 0.4).sin()
        }),
    ));
    let base = Line::from_coefficients(-2.0, 0.0, 16.0).unwrap();
    cases.push((
        Box::new(Sine { base, height: 1.0, length: 7.0, phase: 0.0 }),
        Box::new(|p| 8.0 - p.x > (TAU * p.y / 7.0).sin()),
    ));
    let points = [[3.0, 12.0], [5.0, 4.0], [5.5, 15.0], [14.0, 9.0], [16.0, 9.5]].map(Point2::from);
    cases.push((
        Box::new(Polyline::through(points.into()).unwrap()),
        Box::new(move |p| {
            let piece = points.windows(2).find(|piece| p.x < piece[1].x).unwrap_or(&points[3..]);
            let slope = (piece[1].y - piece[0].y) / (piece[1].x - piece[0].x);
            p.y > piece[0].y + slope * (p.x - piece[0].x)
        }),
    ));
    let grid = grid();
    cases.push((
        Box::new(Raster::new("r.asc".into(), &grid, 5.0)),
        Box::new(move |p| {
            // The nearest of all cells, by their middles.
            let cells = (0..96).map(|n| {
                let [column, row] = [n % 12, n / 12].map(|it| it as f64);
                let off = [p.x - 1.75 - 1.5 * column, p.y - 17.0 + 2.0 * row];
                let beyond = [off[0].abs() - 0.75, off[1].abs() - 1.0].map(|it| it.max(0.0));
                (beyond[0].hypot(beyond[1]), grid.values[n])
            });
            cells.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap().1 >= 5.0
        }),
    ));
    cases
}

fn places(count: usize, seed: u64) -> Vec<Point2<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut metres = || rng.random_range(-3.0..23.0);
    (0..count).map(|_| at(metres(), metres())).collect()
}

#[test]
fn labels_are_those_of_the_formulas() {
    for (curve, is_positive) in cases() {
        for place in places(3_000, 1) {
            let label = if is_positive(place) { Label::Positive } else { Label::Negative };
            assert_eq!(curve.side(place), Reading::Side(label), "{curve:?} at {place}");
        }
    }
}

/// On rays in all directions the label does not change before the distance, and on one of them soon after it.
#[test]
fn the_label_changes_at_the_distance_and_not_before() {
    const STEP: f64 = 0.02;
    for (curve, is_positive) in cases() {
        for place in places(6, 2) {
            let distance = curve.distance(place);
            let begins = is_positive(place);
            let most = distance + 0.1;
            let changed = (0..1_000).filter_map(|ray| {
                let (sin, cos) = (f64::from(ray) / 1_000.0 * TAU).sin_cos();
                let steps = (1..).map(|n| STEP * f64::from(n)).take_while(|it| *it < most);
                let mut steps = steps
                    .filter(|far| is_positive(place + Vector2::new(cos, sin) * *far) != begins);
                steps.next()
            });
            let least = changed.fold(f64::INFINITY, f64::min);
            assert!(least >= distance - 1e-9, "{curve:?} at {place}: {least} before {distance}");
            assert!(least < distance + 0.06, "{curve:?} at {place}: {least} after {distance}");
        }
    }
}

/// What is drawn lies on the boundary, is all of it, and lies in the area.
#[test]
fn what_is_drawn_is_the_boundary() {
    for (curve, is_positive) in cases() {
        let name = format!("{curve:?}");
        let world = World::divided_by_curve(curve, &area());
        let ways = world.ways(&area());
        let pieces: Vec<_> = ways.iter().flat_map(|way| way.windows(2)).collect();
        assert!(!pieces.is_empty(), "{name}");
        for piece in &pieces {
            for share in [0.0, 0.3, 0.9] {
                let place = piece[0] + (piece[1] - piece[0]) * share;
                let site = Site::try_from(place).unwrap();
                let off = world.distance(site);
                assert!(off.abs() < 0.015, "{name}: {place} is {off} off");
                assert!([place.x, place.y].iter().all(|it| (-1e-9..=20.0 + 1e-9).contains(it)));
            }
        }
        // Between two places of different labels something is drawn.
        for pair in places(4_000, 3).chunks(2) {
            let from = pair[0].map(|it| it.clamp(0.0, 20.0));
            let to = from + (pair[1] - pair[0]) * 0.05;
            let is_within = [to.x, to.y].iter().all(|it| (0.0..=20.0).contains(it));
            if is_within && is_positive(from) != is_positive(to) {
                let crosses = |piece: &&&[Point2<f64>]| {
                    let side =
                        |a: Point2<f64>, b: Point2<f64>, p: Point2<f64>| (b - a).perp(&(p - a));
                    side(from, to, piece[0]) * side(from, to, piece[1]) <= 0.0
                        && side(piece[0], piece[1], from) * side(piece[0], piece[1], to) <= 1e-3
                };
                assert!(pieces.iter().any(|piece| crosses(&piece)), "{name}: {from} to {to}");
            }
        }
    }
}

/// Shares of lines against a count of places; no line of a fine grid is better than the fit.
#[test]
fn shares_are_those_of_a_count_and_no_line_is_better() {
    const SIDE: u32 = 250;
    let corners = vec![at(0.0, 0.0), at(20.0, 3.0), at(17.0, 20.0), at(4.0, 18.0)];
    for area in [area(), Polygon(corners)] {
        for (curve, is_positive) in cases() {
            let name = format!("{curve:?}");
            let place = |n: u32| {
                let metres = |n: u32| 20.0 * (f64::from(n) + 0.5) / f64::from(SIDE);
                at(metres(n % SIDE), metres(n / SIDE))
            };
            let within: Vec<_> = (0..SIDE * SIDE).map(place).filter(|it| area.holds(*it)).collect();
            let labelled: Vec<_> = within.into_iter().map(|it| (it, is_positive(it))).collect();
            let count = |line: &Line, every: usize| {
                let some = labelled.iter().step_by(every);
                let all = some.len() as f64;
                some.filter(|(place, label)| (line.distance(*place) > 0.0) != *label).count() as f64
                    / all
            };
            let world = World::divided_by_curve(curve, &area);
            let mut rng = ChaCha8Rng::seed_from_u64(4);
            let mut drawn = |reach: f64| {
                let (sin, cos) = rng.random_range(0.0..TAU).sin_cos();
                let through =
                    at(10.0, 10.0) + Vector2::new(cos, sin) * rng.random_range(-reach..reach);
                Line::through(through, Vector2::new(cos, sin)).unwrap()
            };
            for line in (0..10).map(|_| drawn(12.0)) {
                let share = world.misclassified(area.clone(), &line).unwrap();
                let counted = count(&line, 1);
                assert!((share - counted).abs() < 4e-3, "{name}: {line}: {share} for {counted}");
            }
            let fit = world.fit().unwrap();
            let counted = count(&fit.line, 1);
            assert!((fit.misclassified - counted).abs() < 4e-3, "{name}: {fit:?} for {counted}");
            let shares = (0..6_000).map(|_| drawn(10.0)).filter(|line| area.chord(line).is_some());
            let best = shares.map(|line| world.misclassified(area.clone(), &line).unwrap());
            let best = best.fold(1.0, f64::min);
            assert!(fit.misclassified <= best + 1e-9, "{name}: {fit:?}, but {best}");
        }
    }
}

/// Shares that are known: what a line through the middle of a circle misclassifies, and the fit of whole waves.
#[test]
fn shares_are_exact_where_they_are_known() {
    let circle = Box::new(Circle { middle: at(10.0, 10.0), radius: 5.0 });
    let world = World::divided_by_curve(circle, &area());
    for line in [[0.0, 1.0, -10.0], [1.0, 0.0, -10.0], [-0.6, 0.8, -2.0]] {
        let line = Line::from_coefficients(line[0], line[1], line[2]).unwrap();
        let share = world.misclassified(area(), &line).unwrap();
        assert!((share - 0.5).abs() < 1e-4, "{line}: {share}");
    }
    let line = Line::from_slope(0.0, -1.0).unwrap();
    let share = world.misclassified(area(), &line).unwrap();
    let outside = 1.0 - 25.0 * std::f64::consts::PI / 400.0;
    assert!((share - outside).abs() < 1e-4, "{share} for {outside}");
    // An arch of a wave is 2 / pi of its rectangle. Four waves are alike on either side of the middle.
    let base = Line::from_slope(0.0, 9.0).unwrap();
    let sine = Sine { base, height: 1.0, length: 5.0, phase: 0.0 };
    let world = World::divided_by_curve(Box::new(sine), &area());
    let share = world.misclassified(area(), &base).unwrap();
    assert!((share - 2.0 / std::f64::consts::PI / 20.0).abs() < 1e-4, "{share}");
    let fit = world.fit().unwrap();
    assert!(fit.misclassified <= share && fit.line.angle_deg().abs() < 5.0, "{fit:?}");
    // A sine without height is its line, and its fit says so.
    let base = Line::from_slope(0.41, 3.5).unwrap();
    let flat = Sine { base, height: 0.0, length: 5.0, phase: 0.0 };
    let fit = World::divided_by_curve(Box::new(flat), &area()).fit().unwrap();
    assert!(fit.misclassified < 1e-5 && fit.line.angle_to_deg(&base) < 0.01, "{fit:?}");
}

/// A moving line has the label and the distance of the line that it is after so many motions.
#[test]
fn a_line_that_moves_divides_by_where_it_is() {
    let start = Line::from_slope(0.41, 3.5).unwrap();
    let moving = Moving { start, offset: 0.1, turn: 2.0, about: at(10.0, 10.0) };
    let mut world = World::divided_by_moving(moving);
    for motions in 0..30 {
        let line = moving.after(motions);
        for place in places(50, 5) {
            let site = Site::try_from(place).unwrap();
            let off = line.distance(site.into());
            assert_eq!(world.distance(site).to_bits(), off.to_bits());
            assert_eq!(world.reading(site), world.after(motions as usize).reading(site));
            assert_eq!(world.reading(site).sign(), if off > 0.0 { 1 } else { -1 });
        }
        let fit = world.fit().unwrap();
        assert!(fit.misclassified == 0.0 && fit.line.angle_to_deg(&line) < 1e-9);
        world.advance();
    }
    assert!(world.line().is_none() && world.is_known());
}
