//! The extent of numbers, and of places.

use nalgebra::Point2;

/// The least and the greatest of some numbers. Of none it begins after its end.
pub fn span(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    values.into_iter().fold(none, |[least, most], it| [least.min(it), most.max(it)])
}

/// The corners of the rectangle around some places, the lesser first; `None` without a place.
pub fn around(places: impl IntoIterator<Item = Point2<f64>>) -> Option<[Point2<f64>; 2]> {
    let each = places.into_iter().map(|at| [at, at]);
    each.reduce(|[min, max], [low, high]| [min.inf(&low), max.sup(&high)])
}
