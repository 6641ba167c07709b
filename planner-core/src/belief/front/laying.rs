//! Laying a grid anew around its mass.
//!
//! The columns and the cells span the mass but for a tail on either side. What lies beyond is kept in the edge cells.
//! The pivot goes to the *waist*, the place where offset and direction are uncorrelated. There the columns have their
//! mass at the same offsets, so that none is wasted.

use crate::belief::front::grid::Grid;
use crate::belief::front::lay::{Lay, Unit, angle, limited, metres, radians};
use crate::belief::front::moments::Moments;
use crate::belief::front::walk::{Density, pairs, take};
use crate::geometry::approximate::{distance, sqrt};
use crate::geometry::lattice::{Site, UNITS_PER_METRE, Vector};

/// The mass on either side that may lie beyond the cells.
const TAIL: f32 = 1e-3;

/// A correlation of offset and direction above this moves the pivot of a straight front: its square.
const CORRELATED: f32 = 0.35 * 0.35;

/// A pivot that follows a robot stays as near to the waist as this, in widths over turns.
const FOLLOWS: f32 = 1.0;

/// A pivot that would move by less than this stays, in heights of a cell over turns of a column.
const STAYS: f32 = 0.05;

/// Cells that are smaller or larger than wanted by less than this stay.
const SIZES: [f32; 2] = [0.65, 1.6];

/// A mean that is off the middle by less than this share of the range stays.
const OFF: f32 = 0.1;

/// Cells and turns are no smaller, metres and radians.
const LEAST: [f32; 2] = [2e-5, 1e-6];

/// An edge cell heavier than its neighbour by this holds a tail that wants out.
const HEAVY: f32 = 1.25;

/// So much is added where a tail wants out, as a share of the range: enough for cells to be of another size then.
const GROWTH: f32 = 0.3;

/// Places of the histogram of offsets about another pivot.
const PLACES: usize = 64;

/// A grid that spans more than this share of a turn goes all around.
const WIDE: f32 = 0.8;

/// From where to where the mass lies but for a tail on either side, in cells from the first one's edge.
fn range(masses: &[f32]) -> [f32; 2] {
    let (total, cells): (f32, _) = (masses.iter().sum(), masses.len() as f32);
    let tail = TAIL * total;
    let wants_out = |edge: Option<&f32>, next: Option<&f32>| {
        let [edge, next] = [edge, next].map(|it| it.copied().unwrap_or(0.0));
        edge > HEAVY * next && edge > 2.0 * tail
    };
    let more = GROWTH * cells;
    let low = if wants_out(masses.first(), masses.get(1)) {
        -more
    } else {
        place_of(masses.iter(), tail)
    };
    let high = if wants_out(masses.last(), masses.iter().rev().nth(1)) {
        -more
    } else {
        place_of(masses.iter().rev(), tail)
    };
    [low, cells - high]
}

/// Up to where so much mass lies, counted in cells.
fn place_of<'a>(masses: impl Iterator<Item = &'a f32>, mass: f32) -> f32 {
    let (mut before, mut cell) = (0.0, 0.0);
    for it in masses {
        let until = before + it;
        if until >= mass && until > before {
            return cell + (mass - before) / (until - before);
        }
        (before, cell) = (until, cell + 1.0);
    }
    cell
}

fn is_off(size: f32, wanted: f32) -> bool {
    size < SIZES[0] * wanted || size > SIZES[1] * wanted
}

fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

impl<const K: usize, const M: usize, const L: usize> Grid<K, M, L> {
    /// Lays the grid anew if its cells are of another size than its mass wants, or lie elsewhere. Makes room for offsets
    /// that will diffuse by a margin, metres. If the front bends, the pivot moves along it to where a robot is. It stays
    /// so near to the waist that few cells are wasted. While the front may have any direction, the pivot moves to the
    /// robot if the robot is much nearer to the front.
    ///
    /// `O(K M L)`: some 75,000 instructions for 16 x 16 x 3 if it is laid anew, and 10,000 if not.
    pub(crate) fn lay_around(&mut self, robot: Option<Site>, margin: f32) {
        let wanted = self.around(robot);
        if margin > 0.0 {
            let lay = wanted.unwrap_or(self.lay);
            let step = lay.step + 2.0 * margin / M as f32;
            self.lay_anew(Lay { low: lay.low - margin, step, ..lay });
        } else if let Some(lay) = wanted {
            self.lay_anew(lay);
        }
    }

    #[inline(never)] // what it needs is not on the stack while cells are laid
    fn around(&self, robot: Option<Site>) -> Option<Lay> {
        let (lay, moments) = (self.lay, Moments::of(self));
        if moments.total <= 0.0 {
            return None;
        }
        let by = match robot {
            _ if lay.is_whole::<K>() => robot.and_then(|it| self.nearer(&moments, it)),
            Some(robot) if lay.bend > 0.0 => {
                let [ahead, _] = Unit::of(moments.heading(self)).seen(metres(robot - lay.pivot));
                let waist = self.waist_ahead(&moments);
                let [turns, offsets] = moments.variance;
                let narrow = offsets - moments.covariance * moments.covariance / turns;
                let narrow = if narrow > 0.0 { narrow } else { 0.0 };
                let most = FOLLOWS * sqrt(narrow / turns) * lay.step / lay.turn;
                self.towards(&moments, limited(ahead - waist, most))
            }
            _ if moments.correlation_squared() > CORRELATED => self.towards(&moments, 0.0),
            _ => None,
        };
        self.wanted(&moments, by)
    }

    /// From the pivot to a robot, if the offsets about the robot span much less. Then it is nearer to the front.
    fn nearer(&self, moments: &Moments<K, M, L>, robot: Site) -> Option<Vector> {
        let by = robot - self.lay.pivot;
        let [low, high] = self.range_about(moments, by);
        let [from, until] = range(&moments.rows);
        (high - low < SIZES[0] * (until - from) * self.lay.step).then_some(by)
    }

    /// How far ahead of the pivot the waist lies, metres.
    fn waist_ahead(&self, moments: &Moments<K, M, L>) -> f32 {
        -moments.covariance * self.lay.step / (moments.variance[0] * self.lay.turn)
    }

    /// Where the cells should lie; `None` if they lie well enough.
    fn wanted(&self, moments: &Moments<K, M, L>, moved: Option<Vector>) -> Option<Lay> {
        let (lay, was_whole) = (self.lay, self.lay.is_whole::<K>());
        // Columns that go all around begin opposite to the mean direction.
        let mut columns = moments.columns;
        let mut from = lay.heading.turned(angle(lay.angle_at::<K>(0.0)));
        if was_whole {
            let mean = radians(moments.heading(self).since(from)) / lay.turn;
            let first = (mean + 1.5 * K as f32) as usize % K;
            let after = moments.columns.iter().skip(first);
            let turned = after.chain(moments.columns.iter().take(first));
            for (column, mass) in columns.iter_mut().zip(turned) {
                *column = *mass;
            }
            from = from.turned(angle(radians(angle(first as f32 * lay.turn))));
        }
        let [first, last] = match moved {
            Some(by) if L > 1 && !was_whole => self.turns_about(moments, by),
            _ => range(&columns),
        };
        let turn = larger((last - first) * lay.turn / K as f32, LEAST[1]);
        let is_whole = turn * K as f32 > WIDE * core::f32::consts::TAU;
        let (turn, heading) = if is_whole {
            (core::f32::consts::TAU / K as f32, lay.heading)
        } else {
            (turn, from.turned(angle(0.5 * (first + last) * lay.turn)))
        };
        let off = 0.5 * (first + last) - 0.5 * K as f32;
        let turns = is_whole != was_whole
            || !is_whole && (is_off(lay.turn, turn) || off.abs() > OFF * K as f32);
        let (pivot, [low, high]) = match moved {
            Some(by) => (lay.pivot.step(by).unwrap_or(lay.pivot), self.range_about(moments, by)),
            None => (lay.pivot, range(&moments.rows).map(|it| lay.low + it * lay.step)),
        };
        let step = larger((high - low) / M as f32, LEAST[0]);
        let low = 0.5 * (low + high) - 0.5 * step * M as f32;
        let off = low + 0.5 * step * M as f32 - lay.low - 0.5 * lay.step * M as f32;
        let shifts = is_off(lay.step, step) || off.abs() > OFF * step * M as f32;
        (turns || moved.is_some() || shifts).then_some(Lay {
            pivot,
            heading,
            turn,
            low,
            step,
            ..lay
        })
    }

    /// From the pivot to a place so far ahead of the waist, no further than layers of curvature remain true.
    fn towards(&self, moments: &Moments<K, M, L>, from_waist: f32) -> Option<Vector> {
        let lay = self.lay;
        let most = if lay.bend > 0.0 { 0.5 / lay.bend } else { 2_048.0 };
        let ahead = limited(self.waist_ahead(moments) + from_waist, most);
        let along = Unit::of(moments.heading(self));
        let left = lay.low + lay.step * (moments.mean[1] + 0.5 * M as f32);
        let left = (left + lay.bulge(moments.bend, ahead)).clamp(-2_048.0, 2_048.0);
        let units = UNITS_PER_METRE as f32;
        let x = (along.x * ahead - along.z * left) * units;
        let z = (along.z * ahead + along.x * left) * units;
        let least = STAYS * units * lay.step / lay.turn;
        Vector::new(x as i32, z as i32).filter(|it| distance(*it) > least)
    }

    /// The range of directions about another pivot, in columns: each layer has turned by its own angle.
    #[inline(never)]
    fn turns_about(&self, moments: &Moments<K, M, L>, by: Vector) -> [f32; 2] {
        let lay = self.lay;
        let [ahead, _] = Unit::of(moments.heading(self)).seen(metres(by));
        let most = bent(lay.bend, ahead).abs() / lay.turn;
        let place = (2.0 * most + K as f32) / PLACES as f32;
        let mut places = [0.0; PLACES];
        let per_place = 1.0 / place;
        for (columns, bend) in moments.layers.iter().zip(lay.bends::<L>()) {
            let mut at = (bent(bend, ahead) / lay.turn + most) * per_place;
            for mass in columns {
                spread(&mut places, [at, at + per_place], *mass);
                at += per_place;
            }
        }
        range(&places).map(|it| it * place - most)
    }

    /// The range of offsets about another pivot.
    #[inline(never)]
    fn range_about(&self, moments: &Moments<K, M, L>, by: Vector) -> [f32; 2] {
        let (lay, by) = (self.lay, metres(by));
        let mut lows = moments.layers;
        let (mut least, mut most) = (f32::MAX, f32::MIN);
        for (layer, bend) in lows.iter_mut().zip(lay.bends::<L>()) {
            for (low, along) in layer.iter_mut().zip(&self.along) {
                let [ahead, left] = along.seen(by);
                let has_mass = *low > 0.0;
                *low = lay.low + lay.bulge(bend, ahead) - left;
                if has_mass {
                    least = if *low < least { *low } else { least };
                    most = larger(most, *low);
                }
            }
        }
        let place = (most - least + lay.step * M as f32) / PLACES as f32;
        let (per_place, stride) = (1.0 / place, lay.step / place);
        let mut places = [0.0; PLACES];
        for (layer, lows) in self.mass.iter().zip(&lows) {
            for (column, low) in layer.iter().zip(lows) {
                // A cell counts where its middle is: places are about as wide.
                let at = (low + 0.5 * lay.step - least) * per_place;
                count(&mut places, column, [at, stride]);
            }
        }
        range(&places).map(|it| least + it * place)
    }

    /// Puts the mass into other cells: what lies beyond goes into the edge cells.
    ///
    /// Each column is shifted as its middle is. Then it is shared out among the new columns. Densities have slopes if the
    /// front bends. With even ones each laying blurs the masses. A straight line has no other blur, and needs it.
    #[inline(never)]
    pub(crate) fn lay_anew(&mut self, lay: Lay) {
        let old = self.lay;
        let by = metres(lay.pivot - old.pivot);
        let [ahead, _] = Unit::of(lay.heading).seen(by);
        let turned = radians(lay.heading.since(old.heading));
        let (per_cell, per_column) = (1.0 / old.step, 1.0 / old.turn);
        let goes_round = [old, lay].map(Lay::is_whole::<K>);
        let density = if old.bend > 0.0 { Density::SLOPED } else { Density::EVEN };
        let mut sums = [0.0; M];
        for (columns, bend) in self.mass.iter_mut().zip(old.bends::<L>()) {
            for (column, along) in columns.iter_mut().zip(&self.along) {
                let [ahead, left] = along.seen(by);
                let low = lay.low - old.low + left - old.bulge(bend, ahead);
                let places = [low, lay.step].map(|it| it * per_cell);
                take(&column.clone(), column, &mut sums, density, places);
            }
            // A curve's direction turns on the way to the pivot.
            let turned = turned - bent(bend, ahead) + lay.angle_at::<K>(0.0);
            let places = [turned * per_column + 0.5 * K as f32, lay.turn * per_column];
            let before = *columns;
            share(before.as_flattened(), columns.as_flattened_mut(), M, places, goes_round);
        }
        self.set(lay);
    }
}

/// Shares out columns of so many masses among others, by where the first of these begins and how wide each is, counted
/// in the old ones. Whether these went all around, and those do. Others have ends, which take what lies beyond.
#[inline(never)]
fn share(old: &[f32], new: &mut [f32], size: usize, [from, each]: [f32; 2], round: [bool; 2]) {
    let count = old.len() / size.max(1);
    let all = count as f32;
    // What goes all around is cut opposite to the middle.
    let middle = from + 0.5 * each * all;
    let [start, end] = match round {
        [false, _] => [0.0, all],
        [true, false] => [middle - 0.5 * all, middle + 0.5 * all],
        [true, true] => [from, from + each * all],
    };
    let (mut place, last) = (start, count.wrapping_sub(1));
    let mut next = from;
    for (number, column) in new.chunks_mut(size.max(1)).enumerate() {
        next += each;
        let until = if number == last || next > end { end } else { next };
        column.fill(0.0);
        while place < until {
            let cell = floor(place);
            let edge = cell.wrapping_add(1) as f32;
            let edge = if edge < until { edge } else { until };
            let wrapped = cell.rem_euclid(count as i32) as usize;
            let part = edge - place;
            if let Some(masses) = old.get(wrapped.wrapping_mul(size)..) {
                pairs(column, masses, |to, mass| *to += part * mass);
            }
            place = edge;
        }
    }
}

/// The greatest integer that is no greater.
fn floor(value: f32) -> i32 {
    let near = value as i32;
    if near as f32 > value { near.wrapping_sub(1) } else { near }
}

/// By how much a curve of some curvature turns on the way to a place ahead.
fn bent(bend: f32, ahead: f32) -> f32 {
    (bend * ahead).clamp(-1.0, 1.0)
}

/// Adds each mass to the place of a histogram where it is, from one place on.
fn count(places: &mut [f32; PLACES], masses: &[f32], [mut at, stride]: [f32; 2]) {
    let mut add = |mass: f32| {
        if let Some(sum) = places.get_mut(at as usize) {
            *sum += mass;
        }
        at += stride;
    };
    let (fours, rest) = masses.as_chunks::<4>();
    for four in fours {
        for mass in four {
            add(*mass);
        }
    }
    for mass in rest {
        add(*mass);
    }
}

/// Spreads a mass over the places of a histogram, from one place to another.
fn spread(places: &mut [f32; PLACES], [from, until]: [f32; 2], mass: f32) {
    let each = mass / (until - from);
    let mut at = from;
    for _ in 0..PLACES {
        let place = if at > 0.0 { at as usize } else { 0 }.min(PLACES - 1);
        let next = place as f32 + 1.0;
        let end = if next < until && place + 1 < PLACES { next } else { until };
        if let Some(sum) = places.get_mut(place) {
            *sum += each * (end - at);
        }
        at = end;
        if at >= until {
            return;
        }
    }
}
