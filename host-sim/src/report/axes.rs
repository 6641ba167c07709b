//! Axes: from numbers to pixels, with ticks.

use nalgebra::{Point2, Vector2};

use crate::report::placing::Frame;
use crate::report::shapes::{Anchor, Spot, border, width};
use crate::report::sheet::Sheet;
use crate::report::style::BORDER;

/// The scale of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scale {
    Linear,
    /// By powers of ten.
    Logarithmic,
}

/// An axis from its least number to its largest, over some pixels, which may run backwards.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis {
    pub(crate) scale: Scale,
    pub(crate) figures: [f64; 2],
    pub(crate) pixels: [f64; 2],
}

/// Two axes and what is between them.
pub(crate) struct Axes {
    pub(crate) x: Axis,
    pub(crate) z: Axis,
}

impl Axis {
    /// The pixel of a number.
    pub(crate) fn at(&self, figure: f64) -> f64 {
        let along = |figure: f64| match self.scale {
            Scale::Linear => figure,
            Scale::Logarithmic => libm::log10(figure.max(self.figures[0])),
        };
        let [from, to] = self.figures.map(along);
        let [start, end] = self.pixels;
        start + (along(figure) - from) / (to - from) * (end - start)
    }

    /// Numbers to mark, with their texts.
    pub(crate) fn ticks(&self) -> Vec<(f64, String)> {
        let [from, to] = self.figures;
        match self.scale {
            Scale::Linear => {
                let step = round_step((to - from) / 6.0);
                let decimals = (-libm::floor(libm::log10(step) + 1e-9)).max(0.0) as usize;
                let first = libm::ceil(from / step - 1e-9);
                let last = libm::floor(to / step + 1e-9);
                let count = (last - first).max(0.0) as u32;
                let figure = |k| (first + f64::from(k)) * step + 0.0;
                (0..=count).map(|k| (figure(k), format!("{:.decimals$}", figure(k)))).collect()
            }
            Scale::Logarithmic => {
                let [first, last] =
                    [libm::ceil(libm::log10(from) - 1e-9), libm::floor(libm::log10(to) + 1e-9)];
                let power = |k: u32| libm::pow(10.0, first + f64::from(k));
                let count = (last - first).max(0.0) as u32;
                let every = count / 8 + 1;
                let name = |it: f64| if it < 1e-4 { format!("{it:.0e}") } else { it.to_string() };
                let powers = (0..=count).filter(|k| k % every == 0).map(power);
                powers.map(|it| (it, name(it))).collect()
            }
        }
    }
}

/// The round figure next to a step: 1, 2 or 5 and zeros.
fn round_step(step: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(step)));
    let choices = [1.0, 2.0, 5.0, 10.0].map(|it| it * power);
    choices.into_iter().find(|it| *it >= step * (1.0 - 1e-9)).unwrap_or(step)
}

impl Axes {
    pub(crate) fn at(&self, point: Point2<f64>) -> Spot {
        Spot::new(self.x.at(point.x), self.z.at(point.y))
    }

    /// The rectangle between the axes.
    pub(crate) fn frame(&self) -> Frame {
        let ([left, right], [bottom, top]) = (self.x.pixels, self.z.pixels);
        Frame::between(Spot::new(left, top), Spot::new(right, bottom))
    }

    /// Draws ticks, names and a frame.
    pub(crate) fn draw(&self, sheet: &mut Sheet, names: [&str; 2]) {
        const SIZE: f64 = 12.0;
        const TICK: f64 = 5.0;
        let ([left, right], [bottom, top]) = (self.x.pixels, self.z.pixels);
        let corner = |x, z| Spot::new(x, z);
        let mut ways = vec![border(corner(left, bottom), corner(right, top))];
        for (figure, name) in self.x.ticks() {
            let foot = corner(self.x.at(figure), bottom);
            ways.push(vec![foot, foot + Vector2::new(0.0, TICK)]);
            sheet.words(&name, foot + Vector2::new(0.0, TICK + 13.0), SIZE, Anchor::Middle);
        }
        for (figure, name) in self.z.ticks() {
            let foot = corner(left, self.z.at(figure));
            ways.push(vec![foot, foot - Vector2::new(TICK, 0.0)]);
            sheet.words(&name, foot + Vector2::new(-TICK - 3.0, 4.0), SIZE, Anchor::End);
        }
        sheet.ways(BORDER, ways.iter().map(Vec::as_slice));
        let [x, z] = names;
        sheet.words(x, corner(f64::midpoint(left, right), bottom + 36.0), 13.0, Anchor::Middle);
        let widest = self.z.ticks().iter().map(|(_, name)| width(name, SIZE)).fold(0.0, f64::max);
        sheet.upright(z, corner(left - widest - 14.0, f64::midpoint(bottom, top)), 13.0);
    }
}
