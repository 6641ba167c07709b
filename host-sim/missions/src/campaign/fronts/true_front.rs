//! A front of the ensemble as it really is: a curve that may move, and the place on it where missions begin.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4, TAU};

use nalgebra::{Point2, Vector2};
use planner_core::{Heading, Label, Line, Pose, Sample, Site};
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use crate::world::boundary::Curve;
use crate::world::circle::Circle;
use crate::world::coast::coast;
use crate::world::polyline::Polyline;
use crate::world::sine::Sine;

/// As far from the origin the length along a front is known, metres.
const FAR: f64 = 600.0;

/// The robot begins so far beside the front, metres.
const BESIDE: f64 = 2.0;

/// The given points lie so far ahead of the place on the front and behind it, and so far to its sides, metres.
const GIVEN: [f64; 2] = [4.0, 3.0];

/// A front, and a place on it with the front's direction there. Time counts in *steps*: the time of a motion of 2 m.
#[derive(Debug)]
pub struct TrueFront {
    curve: Box<dyn Curve>,
    /// The place on the front about which a mission begins.
    pub place: Point2<f64>,
    /// The direction of the front there, radians.
    pub angle: f64,
    /// Metres a step.
    drift: Vector2<f64>,
    /// The points of the curve, each with its distance from the first along the curve.
    along: Vec<(Point2<f64>, f64)>,
    is_closed: bool,
}

impl TrueFront {
    /// A still front.
    fn new(curve: Box<dyn Curve>, place: Point2<f64>, angle: f64, is_closed: bool) -> Self {
        let way = curve.ways([Point2::new(-FAR, -FAR), Point2::new(FAR, FAR)]).concat();
        let mut length = 0.0;
        let along = way.iter().enumerate().map(|(n, at)| {
            length += if n > 0 { (at - way[n - 1]).norm() } else { 0.0 };
            (*at, length)
        });
        let along = along.collect();
        Self { curve, place, angle, drift: Vector2::zeros(), along, is_closed }
    }

    /// A circle of this radius, metres, with a place drawn on it.
    pub fn circle(radius: f64, rng: &mut ChaCha8Rng) -> Self {
        let middle = Point2::origin();
        let (sin, cos) = libm::sincos(rng.random_range(0.0..TAU));
        let place = middle + Vector2::new(cos, sin) * radius;
        let angle = libm::atan2(cos, -sin);
        Self::new(Box::new(Circle { middle, radius }), place, angle, true)
    }

    /// A straight front, in a direction that is drawn.
    pub fn line(rng: &mut ChaCha8Rng) -> Self {
        let angle = rng.random_range(-1.2..1.2);
        let (sin, cos) = libm::sincos(angle);
        let at = |along: f64| Point2::new(cos, sin) * along;
        let count = FAR as i32;
        Self::through((-count..=count).map(|n| at(n.into())).collect(), angle)
    }

    /// A saw with corners of 90 degrees, so far apart, metres.
    pub fn corners(length: f64, rng: &mut ChaCha8Rng) -> Self {
        let begin = rng.random_range(4..16);
        let each = length * FRAC_1_SQRT_2 / 20.0;
        // Twenty places lead up, and twenty down.
        let at = |n: i32| {
            let part = (begin + n).rem_euclid(40);
            Point2::new(f64::from(n), f64::from(part.min(40 - part))) * each
        };
        let count = 20 * (FAR / length) as i32;
        Self::through((-count..=count).map(at).collect(), FRAC_PI_4)
    }

    /// A jagged shore: legs of 3 to 10 m, in directions within 70 degrees of one.
    pub fn jagged(rng: &mut ChaCha8Rng) -> Self {
        let mut at = Point2::new(-FAR, 0.0);
        let mut way = vec![at];
        while at.x < FAR {
            let (leg, angle) = (rng.random_range(3.0..10.0), rng.random_range(-1.2..1.2));
            // It stays about z = 0, and has places a metre apart.
            let angle = if angle * at.y > 0.0 && at.y.abs() > 20.0 { -angle } else { angle };
            let (sin, cos) = libm::sincos(angle);
            let places = libm::ceil(leg) as i32;
            let by = Vector2::new(cos, sin) * (leg / f64::from(places));
            way.extend((1..=places).map(|n| at + by * f64::from(n)));
            at = way[way.len() - 1];
        }
        let middle = way.len() / 2;
        let by = way[middle + 1] - way[middle];
        Self::through(way, libm::atan2(by.y, by.x))
    }

    /// Through places, from the one in the middle.
    fn through(way: Vec<Point2<f64>>, angle: f64) -> Self {
        let place = way[way.len() / 2];
        Self::new(Box::new(Polyline::through(way).expect("a way")), place, angle, false)
    }

    /// A sine of this height and length, metres, with its phase drawn.
    ///
    /// # Panics
    /// Never: the base line is one.
    pub fn sine(height: f64, length: f64, rng: &mut ChaCha8Rng) -> Self {
        let base = Line::from_slope(0.0, 0.0).expect("a line");
        let phase = rng.random_range(0.0..TAU);
        let place = Point2::new(0.0, height * libm::sin(phase));
        let angle = libm::atan(height * TAU / length * libm::cos(phase));
        Self::new(Box::new(Sine { base, height, length, phase }), place, angle, false)
    }

    /// A [coast] of this height and length, metres, drawn.
    ///
    /// # Panics
    /// Never: the points of a coast are in order.
    pub fn coast(shape: [f64; 2], rng: &mut ChaCha8Rng) -> Self {
        let way = coast(rng, shape, 500.0);
        let (place, next) = (way[way.len() / 2], way[way.len() / 2 + 1]);
        let angle = libm::atan2(next.y - place.y, next.x - place.x);
        Self::through(way, angle)
    }

    /// The same, but it moves by so many metres a step, in a direction that is drawn.
    #[must_use]
    pub fn moving(self, metres: f64, rng: &mut ChaCha8Rng) -> Self {
        let (sin, cos) = libm::sincos(rng.random_range(0.0..TAU));
        Self { drift: Vector2::new(cos, sin) * metres, ..self }
    }

    /// A place as it lies to the front as that was at the start.
    fn at_start(&self, at: Point2<f64>, steps: f64) -> Point2<f64> {
        at - self.drift * steps
    }

    /// The label of a place after so many steps. On the front it is -1.
    fn label(&self, at: Point2<f64>, steps: f64) -> Label {
        let is_above = self.curve.side(self.at_start(at, steps)) == Label::Positive.into();
        if is_above { Label::Positive } else { Label::Negative }
    }

    /// The label that a sensor reads there. It is true with probability `p`.
    pub fn sensed(&self, at: Point2<f64>, steps: f64, p: f64, rng: &mut ChaCha8Rng) -> Label {
        let label = self.label(at, steps);
        if rng.random_bool(p) { label } else { -label }
    }

    /// The distance of a place from the front after so many steps, metres.
    pub fn distance(&self, at: Point2<f64>, steps: f64) -> f64 {
        self.curve.distance(self.at_start(at, steps))
    }

    /// How far along the front a place lies, metres.
    pub fn along(&self, at: Point2<f64>, steps: f64) -> f64 {
        let at = self.at_start(at, steps);
        let off = |it: &&(Point2<f64>, f64)| (it.0 - at).norm_squared();
        self.along.iter().min_by(|a, b| off(a).total_cmp(&off(b))).map_or(0.0, |it| it.1)
    }

    /// From one place along the front to another, metres, the shorter way round.
    pub fn way_between(&self, from: f64, to: f64) -> f64 {
        let (way, whole) = (to - from, self.along.last().map_or(0.0, |it| it.1));
        if self.is_closed { way - (way / whole).round() * whole } else { way }
    }

    /// A place beside the one on the front, metres.
    pub fn beside(&self, ahead: f64, left: f64) -> Point2<f64> {
        let (sin, cos) = libm::sincos(self.angle);
        self.place + Vector2::new(cos * ahead - sin * left, sin * ahead + cos * left)
    }

    /// Four points about the place with their labels.
    pub fn given(&self) -> Vec<Sample> {
        let [far, off] = GIVEN;
        let places = [(-far, -off), (-far, off), (far, off), (far, -off)];
        let sample = |(ahead, left)| {
            let at = self.beside(ahead, left);
            Sample { site: site(at), label: self.label(at, 0.0) }
        };
        places.map(sample).to_vec()
    }

    /// Two metres beside the front, with a heading that is drawn.
    ///
    /// # Panics
    /// Never: the drawn angle is finite.
    pub fn start(&self, rng: &mut ChaCha8Rng) -> Pose {
        let heading = Heading::from_radians(rng.random_range(0.0..TAU)).expect("an angle");
        Pose { site: site(self.beside(0.0, BESIDE)), heading }
    }
}

/// The site of a place on the lattice.
///
/// # Panics
/// When the place is more than 8 km off.
pub fn site(at: Point2<f64>) -> Site {
    Site::try_from(at).expect("on the lattice")
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng as _;

    use super::*;

    #[test]
    fn a_moving_front_takes_places_and_labels_with_it() {
        let mut rng = ChaCha8Rng::seed_from_u64(6);
        let front = TrueFront::circle(100.0, &mut rng).moving(0.5, &mut rng);
        let way = front.drift * 40.0;
        assert!((way.norm() - 20.0).abs() < 1e-9);
        let (off, left) = (front.beside(0.0, 3.0), front.along(front.place, 0.0));
        for (at, steps) in [(off, 0.0), (off + way, 40.0)] {
            assert!((front.distance(at, steps) - 3.0).abs() < 1e-6, "{steps}");
            // The inside of the circle is to the left.
            assert_eq!(front.sensed(at, steps, 1.0, &mut rng), Label::Positive, "{steps}");
            assert_eq!(front.sensed(at, steps, 0.0, &mut rng), Label::Negative, "{steps}");
            assert!(front.way_between(left, front.along(at, steps)).abs() < 3.0, "{steps}");
        }
        // After the whole way the place itself lies elsewhere beside the front.
        assert!((front.distance(off, 40.0) - front.distance(off - way, 0.0)).abs() < 1e-9);
        assert!((front.distance(off, 40.0) - 3.0).abs() > 1.0);
    }

    #[test]
    fn a_way_round_a_closed_front_is_the_shorter_one() {
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        let circle = TrueFront::circle(20.0, &mut rng);
        assert!((circle.way_between(5.0, 120.0) + 10.6).abs() < 0.1, "the circle is 125.6 m long");
        let coast = TrueFront::coast([6.0, 25.0], &mut rng);
        assert!((coast.way_between(5.0, 120.0) - 115.0).abs() < 1e-9);
    }

    #[test]
    fn given_points_lie_on_both_sides() {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        for front in [TrueFront::circle(20.0, &mut rng), TrueFront::coast([6.0, 25.0], &mut rng)] {
            let labels: Vec<_> = front.given().iter().map(|it| it.label.sign()).collect();
            assert_eq!(labels, [-1, 1, 1, -1], "{front:?}");
            let pose = front.start(&mut rng);
            assert!((front.distance(pose.site.into(), 0.0) - 2.0).abs() < 0.3);
        }
    }
}
