//! What is known of the line beforehand, as given samples: its slope lies between two, or its intercept does.
//!
//! A belief learns what it is given from samples. A bound of the intercept is a sample on the axis. A bound of the slope
//! is a sample at infinity, and the nearest to that are two as far off as the lattice goes. They stand aside by as much as
//! the area is wide, so that they exclude no line through the area that keeps the bound. Two more samples say that the
//! line meets the circle around the area: otherwise it could be anywhere.
//!
//! These samples assume +1 above the line, where `z` is larger. Negate their labels if it lies
//! below.

use core::f64::consts::FRAC_PI_2;

use crate::belief::sample::{Label, Sample};
use crate::geometry::lattice::{LIMIT, Site, UNITS_PER_METRE, Vector};
use crate::geometry::value::ValueError;
use crate::geometry::workspace::Workspace;

/// Samples that say: the line through an area runs in a direction between these two, degrees from the axis of `x`.
///
/// A direction of -10 to 50 degrees is a slope of tan(-10) to tan(50). Directions past 90 degrees are steeper than the
/// vertical, with +1 to their left. Directions outside the bounds remain up to `d / r`. There `d` is half of the area's
/// diagonal. `r` is how far the lattice goes: 8,192 m less the place of the area's middle, and less `d`. That is 0.1
/// degrees for a square of 20 m, and 3.5 degrees for 800 m x 500 m.
///
/// # Errors
/// [`ValueError`] unless the second direction is larger, by less than 180 degrees, and both are within 360 degrees of 0;
/// or if the area is too large for its place on the lattice.
pub fn slope_within_degrees(
    area: &impl Workspace,
    degrees: [f64; 2],
) -> Result<[Sample; 6], ValueError> {
    const DIRECTIONS: ValueError = ValueError(
        "bounds of a slope are two directions in degrees, -360 to 360, the second larger by less than 180",
    );
    const NO_ROOM: ValueError =
        ValueError("bounds of a slope so wide need an area farther from the end of the lattice");
    let [from, to] = degrees.map(f64::to_radians);
    let is_arc = from < to && to - from < 2.0 * FRAC_PI_2;
    let is_near = degrees.into_iter().all(|it| (-360.0..=360.0).contains(&it));
    if !(is_arc && is_near) {
        return Err(DIRECTIONS);
    }
    let bounds = area.bounds().whole();
    let middle = bounds.middle();
    let [x, z] = bounds.half_sides().map(f64::from);
    // Two units more, for rounding.
    let aside = libm::sqrt(x * x + z * z) + 2.0;
    let off = middle.x().abs().max(middle.z().abs());
    let reach = f64::from(LIMIT - off) - aside - 2.0;
    let half = 0.5 * (to - from);
    let beside = aside / libm::cos(half);
    // So a line through the area that keeps the bounds passes all samples on the right side.
    if reach < aside * libm::tan(half) || reach < beside {
        return Err(NO_ROOM);
    }
    // Ahead in a direction and to its left; the other one lies opposite.
    let pair = |direction: f64, [ahead, left]: [f64; 2], label: Label| {
        let (sin, cos) = libm::sincos(direction);
        let (x, z) = (ahead * cos - left * sin, ahead * sin + left * cos);
        let by = Vector::new(libm::round(x) as i32, libm::round(z) as i32).ok_or(NO_ROOM)?;
        let sample = |by, label| {
            let site = middle.step(by).map_err(|_| NO_ROOM)?;
            Ok::<_, ValueError>(Sample { site, label })
        };
        Ok::<_, ValueError>([sample(by, label)?, sample(by.reversed(), -label)?])
    };
    let [a, b] = pair(to, [reach, aside], Label::Positive)?;
    let [c, d] = pair(from, [reach, -aside], Label::Negative)?;
    let [e, f] = pair(from + half, [0.0, beside], Label::Positive)?;
    Ok([a, b, c, d, e, f])
}

/// Samples that say: the line crosses `x = 0` between these two places, metres. They lie on that axis, a lattice unit
/// outside.
///
/// # Errors
/// [`ValueError`] unless the second is larger, and both lie within 8,192 m.
pub fn intercept_within(metres: [f64; 2]) -> Result<[Sample; 2], ValueError> {
    const PLACES: ValueError = ValueError(
        "bounds of an intercept are two places in metres, -8191 to 8191, the second larger",
    );
    let [from, to] = metres;
    let is_near = metres.into_iter().all(|it| (-8191.0..=8191.0).contains(&it));
    if !(is_near && from < to) {
        return Err(PLACES);
    }
    let units = f64::from(UNITS_PER_METRE);
    let place = |z: f64| Site::new(0, z as i32).map_err(|_| PLACES);
    let below = place(libm::floor(from * units) - 1.0)?;
    let above = place(libm::ceil(to * units) + 1.0)?;
    Ok([
        Sample { site: below, label: Label::Negative },
        Sample { site: above, label: Label::Positive },
    ])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draws::Draws;
    use crate::geometry::area::Area;

    /// The label of a site by the line through a place in a direction, in double precision.
    fn label(site: Site, through: [f64; 2], direction: f64) -> Label {
        let (sin, cos) = direction.sin_cos();
        let by = [f64::from(site.x()) - through[0], f64::from(site.z()) - through[1]];
        if by[1] * cos - by[0] * sin > 0.0 { Label::Positive } else { Label::Negative }
    }

    #[test]
    fn slopes_within_pass_and_slopes_far_outside_do_not() {
        let mut draws = Draws::new(7);
        for case in 0..400 {
            let [x, z] = [(); 2].map(|()| 4_000.0 * (draws.unit() - 0.5));
            let [width, height] = [(); 2].map(|()| 1.0 + 1_000.0 * draws.unit());
            let area = Area::metres([x, z], [x + width, z + height]).unwrap();
            let from = 360.0 * (draws.unit() - 0.5);
            let to = from + 150.0 * draws.unit() + 0.01;
            let samples = slope_within_degrees(&area, [from, to]).unwrap();
            for _ in 0..50 {
                let units = f64::from(UNITS_PER_METRE);
                let through =
                    [(x + width * draws.unit()) * units, (z + height * draws.unit()) * units];
                let agrees = |degrees: f64| {
                    let direction = degrees.to_radians();
                    samples.iter().all(|s| label(s.site, through, direction) == s.label)
                };
                let inside = from + (to - from) * draws.unit();
                assert!(agrees(inside), "case {case}: {inside} of {from} to {to}");
                // As the page says, a little wider.
                let half = 0.5 * width.hypot(height);
                let off = (x + 0.5 * width).abs().max((z + 0.5 * height).abs());
                let slack = (half / (8_191.0 - off - half)).to_degrees() + 0.01;
                for outside in [from - slack, to + slack] {
                    assert!(!agrees(outside), "case {case}: {outside} of {from} to {to}");
                }
            }
        }
    }

    #[test]
    fn intercepts_within_pass_and_others_do_not() {
        let mut draws = Draws::new(8);
        for _ in 0..400 {
            let from = 16_000.0 * (draws.unit() - 0.5);
            let to = from + 100.0 * draws.unit() + 1e-3;
            let Ok(samples) = intercept_within([from, to]) else { continue };
            let direction = 3.0 * (draws.unit() - 0.5);
            let units = f64::from(UNITS_PER_METRE);
            for (share, is_inside) in
                [(0.0, true), (0.4, true), (1.0, true), (-1.0, false), (2.0, false)]
            {
                let through = [0.0, (from + share * (to - from)) * units];
                let agrees = samples.iter().all(|s| label(s.site, through, direction) == s.label);
                assert_eq!(agrees, is_inside, "{from} to {to}, {share}");
            }
        }
    }

    #[test]
    fn what_is_no_bound_is_refused() {
        let area = Area::metres([0.0, 0.0], [20.0, 20.0]).unwrap();
        for bad in [[10.0, 10.0], [10.0, 5.0], [0.0, 180.0], [f64::NAN, 5.0], [-400.0, -390.0]] {
            assert!(slope_within_degrees(&area, bad).is_err(), "{bad:?}");
        }
        let edge = Area::metres([7_000.0, 0.0], [8_191.0, 900.0]).unwrap();
        assert!(slope_within_degrees(&edge, [0.0, 60.0]).is_err());
        for bad in [[1.0, 1.0], [2.0, 1.0], [0.0, 9_000.0], [f64::NAN, 5.0]] {
            assert!(intercept_within(bad).is_err(), "{bad:?}");
        }
    }
}
