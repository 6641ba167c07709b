//! Shapes and words of SVG at places of a sheet.

use nalgebra::{Point2, Vector2};
use svg::node::element::path::Data;
use svg::node::element::{Circle, Rectangle, Text};

/// A place on a sheet, pixels from its upper left corner.
pub(crate) type Spot = Point2<f64>;

/// Size of the numbers of steps.
pub(crate) const NUMBER: f64 = 11.0;

/// Which side of a text stands at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// The greatest width of a text, in the widest of the usual fonts without serifs.
pub(crate) fn width(words: &str, size: f64) -> f64 {
    let wide = |c: char| match c {
        'i' | 'l' | 'j' | '.' | ',' | ':' | ';' | '\'' | '|' | '(' | ')' | 'I' => 0.36,
        ' ' | 't' | 'f' | 'r' | '-' => 0.42,
        'm' | 'w' | 'M' | 'W' | '%' | '@' => 0.96,
        'A'..='Z' => 0.7,
        _ => 0.6,
    };
    words.chars().map(wide).sum::<f64>() * size
}

pub(crate) fn text(words: &str, at: Spot, size: f64, anchor: Anchor) -> Text {
    let text =
        Text::new(words).set("x", rounded(at.x)).set("y", rounded(at.y)).set("font-size", size);
    match anchor {
        Anchor::Start => text,
        Anchor::Middle => text.set("text-anchor", "middle"),
        Anchor::End => text.set("text-anchor", "end"),
    }
}

/// Hundredths of a pixel are enough, and keep files small.
pub(crate) fn rounded(value: f64) -> f64 {
    (value * 100.0).round() / 100.0 + 0.0
}

/// A path with one more way.
pub(crate) fn continued(data: Data, corners: &[Spot]) -> Data {
    let at = |spot: &Spot| (rounded(spot.x), rounded(spot.y));
    let mut spots = corners.iter().map(at);
    let Some(first) = spots.next() else { return data };
    spots.fold(data.move_to(first), Data::line_to)
}

pub(crate) fn outline(corners: &[Spot]) -> Data {
    continued(Data::new(), corners)
}

pub(crate) fn circle(at: Spot, radius: f64) -> Circle {
    Circle::new().set("cx", rounded(at.x)).set("cy", rounded(at.y)).set("r", radius)
}

pub(crate) fn square(at: Spot, half: f64) -> Rectangle {
    rectangle(at - Vector2::repeat(half), at + Vector2::repeat(half))
}

/// The way round a rectangle from one of its corners, by the opposite one, and back.
pub(crate) fn border(from: Spot, to: Spot) -> Vec<Spot> {
    vec![from, Spot::new(to.x, from.y), to, Spot::new(from.x, to.y), from]
}

pub(crate) fn rectangle(from: Spot, to: Spot) -> Rectangle {
    Rectangle::new()
        .set("x", rounded(from.x))
        .set("y", rounded(from.y))
        .set("width", rounded(to.x - from.x))
        .set("height", rounded(to.y - from.y))
}
