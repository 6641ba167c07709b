//! The mean of the lines that separate samples, in fixed point with 256 fractional bits: however much cancels,
//! enough is left. It shares no code with the planner's cells and integrals.

use std::ops::{Add, Mul, Sub};

use num_bigint::BigInt;
use planner_core::{Label, LocalLine, Sample, Site};

use crate::{TwinLine, cross, sign, twin};

const BITS: u32 = 256;

/// A number in fixed point.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Fixed(BigInt);

impl Fixed {
    /// An integer.
    pub fn int(value: impl Into<BigInt>) -> Self {
        Self(value.into() << BITS)
    }

    /// A number in single precision, exactly.
    pub fn single(value: f32) -> Self {
        // A multiple of 2^-149.
        let scaled = f64::from(value) * 2_f64.powi(149);
        let (mantissa, exponent) =
            (scaled.abs().to_bits(), (scaled.abs().to_bits() >> 52) as i32 - 1075);
        if scaled == 0.0 {
            return Self::int(0);
        }
        let mantissa = BigInt::from(mantissa & ((1 << 52) - 1) | 1 << 52) << (BITS - 149);
        let size = if exponent < 0 { mantissa >> -exponent } else { mantissa << exponent };
        Self(if scaled < 0.0 { -size } else { size })
    }

    /// The nearest number in double precision, or one beside it.
    ///
    /// # Panics
    /// Never.
    pub fn value(&self) -> f64 {
        let bits = self.0.bits().saturating_sub(60);
        let top = i64::try_from(&self.0 >> bits).expect("60 bits");
        top as f64 * 2_f64.powi(bits as i32 - BITS as i32)
    }

    fn per(&self, other: &Self) -> Self {
        Self((&self.0 << BITS) / &other.0)
    }

    fn half(&self) -> Self {
        Self(&self.0 >> 1)
    }

    fn sqrt(&self) -> Self {
        Self((&self.0 << BITS).sqrt())
    }

    /// The arc tangent of a number that is not negative.
    fn atan(&self) -> Self {
        const HALVINGS: u32 = 8;
        let one = Self::int(1);
        let mut tan = self.clone();
        for _ in 0..HALVINGS {
            tan = tan.per(&(&one + &(&one + &(&tan * &tan)).sqrt()));
        }
        let (square, mut power, mut sum) = (&tan * &tan, tan.clone(), Self::int(0));
        for k in 0..20 {
            let term = power.per(&Self::int(2 * k + 1));
            sum = if k % 2 == 0 { &sum + &term } else { &sum - &term };
            power = &power * &square;
        }
        Self(sum.0 << HALVINGS)
    }
}

impl<'a> Add<&'a Fixed> for &Fixed {
    type Output = Fixed;

    fn add(self, other: &'a Fixed) -> Fixed {
        Fixed(&self.0 + &other.0)
    }
}

impl<'a> Sub<&'a Fixed> for &Fixed {
    type Output = Fixed;

    fn sub(self, other: &'a Fixed) -> Fixed {
        Fixed(&self.0 - &other.0)
    }
}

impl<'a> Mul<&'a Fixed> for &Fixed {
    type Output = Fixed;

    fn mul(self, other: &'a Fixed) -> Fixed {
        Fixed((&self.0 * &other.0) >> BITS)
    }
}

type Pair = [Fixed; 2];

fn dot([a, b]: &Pair, [c, d]: &Pair) -> Fixed {
    &(a * c) + &(b * d)
}

fn unit(v: [i128; 2]) -> Pair {
    let v = v.map(Fixed::int);
    let length = dot(&v, &v).sqrt();
    v.map(|it| it.per(&length))
}

fn from(about: Site, to: Site) -> Pair {
    [to.x() - about.x(), to.z() - about.z()].map(Fixed::int)
}

/// A line: its unit normal, which points to its +1 side, and how far it passes a site along that.
#[derive(Clone, Debug)]
pub struct ExactLine {
    normal: Pair,
    offset: Fixed,
    about: Site,
}

impl ExactLine {
    /// The line as it is read out.
    pub fn of(line: LocalLine) -> Self {
        let [x, z] = unit([line.along().x().into(), line.along().z().into()]);
        let slope = Fixed::single(line.slope());
        let length = (&Fixed::int(1) + &(&slope * &slope)).sqrt();
        let zero = Fixed::int(0);
        let normal = [&(&zero - &z) - &(&slope * &x), &x - &(&slope * &z)];
        Self {
            normal: normal.map(|it| it.per(&length)),
            offset: (&Fixed::single(line.intercept()) * &Fixed::int(65_536)).per(&length),
            about: line.about(),
        }
    }

    /// Its unit normal.
    pub fn normal(&self) -> [f64; 2] {
        [self.normal[0].value(), self.normal[1].value()]
    }

    /// How far a site lies to its +1 side, lattice units.
    pub fn distance(&self, site: Site) -> Fixed {
        &dot(&self.normal, &from(self.about, site)) - &self.offset
    }

    /// The sine of the turn to another.
    pub fn turn_to(&self, other: &Self) -> f64 {
        let ([a, b], [c, d]) = (&self.normal, &other.normal);
        (&(a * d) - &(b * c)).value()
    }
}

/// The lines that separate samples.
#[derive(Clone, Debug)]
pub struct Separating {
    /// The vertices of their set by direction, the first of those with the same.
    pub vertices: Vec<TwinLine>,
    /// Their measure d(angle) d(offset), radians times lattice units.
    pub measure: Fixed,
    /// Their mean, as unit normals with their offsets.
    pub mean: ExactLine,
    /// The length of the mean of the unit normals.
    pub concord: Fixed,
}

impl Separating {
    /// Those of some samples; `None` if there are none, or all are parallel. `O(n^3)`.
    pub fn of(samples: &[Sample]) -> Option<Self> {
        let mut vertices = twin(samples);
        vertices.sort_by(|a, b| 0.cmp(&cross(a.direction(), b.direction())));
        vertices.dedup_by(|a, b| cross(a.direction(), b.direction()) == 0);
        let about = samples.first()?.site;
        let directions: Vec<Pair> = vertices.iter().map(|it| unit(it.direction())).collect();
        let zero = Fixed::int(0);
        let mut measure = zero.clone();
        let (mut normal, mut offset) = ([zero.clone(), zero.clone()], zero.clone());
        for ends in directions.windows(2) {
            let [u, v] = [&ends[0], &ends[1]];
            let between = [&zero - &(&u[1] + &v[1]), &u[0] + &v[0]];
            // The sample that bounds these lines, and what it adds by its sign.
            for label in [Label::Positive, Label::Negative] {
                let of = samples.iter().filter(|s| s.label == label);
                let height = |site: Site| dot(&between, &from(about, site));
                let lowest = of.min_by(|a, b| {
                    let order = height(a.site).cmp(&height(b.site));
                    if label == Label::Positive { order } else { order.reverse() }
                });
                let p = from(about, lowest?.site);
                // The integrals of `n . p`, of `n (n . p)` and of half the square of `n . p`.
                let area = dot(&p, &[&v[0] - &u[0], &v[1] - &u[1]]);
                let sin = &(&u[0] * &v[1]) - &(&u[1] * &v[0]);
                let half_turn = sin.per(&(&Fixed::int(1) + &dot(u, v))).atan();
                let sin2 = (&(&v[0] * &v[1]) - &(&u[0] * &u[1])).half();
                let mixed = (&(&v[0] * &v[0]) - &(&u[0] * &u[0])).half();
                let moved = [
                    dot(&[&half_turn - &sin2, mixed.clone()], &p),
                    dot(&[mixed, &half_turn + &sin2], &p),
                ];
                let square = dot(&p, &moved).half();
                let by = Fixed::int(sign(label));
                measure = &measure + &(&by * &area);
                normal = [0, 1].map(|i| &normal[i] + &(&by * &moved[i]));
                offset = &offset + &(&by * &square);
            }
        }
        if measure <= zero {
            return None;
        }
        let length = dot(&normal, &normal).sqrt();
        let mean = ExactLine {
            normal: normal.map(|it| it.per(&length)),
            offset: offset.per(&length),
            about,
        };
        let concord = length.per(&measure);
        Some(Self { vertices, measure, mean, concord })
    }

    /// The angle between the first of these lines and the last, radians.
    pub fn width(&self) -> f64 {
        let [first, last] = [self.vertices.first(), self.vertices.last()]
            .map(|it| it.map_or([0, 0], TwinLine::direction));
        let dot = first[0] * last[0] + first[1] * last[1];
        (cross(first, last) as f64).atan2(dot as f64)
    }

    /// How far from a site the farthest of the vertices and their mean is, lattice units.
    pub fn farthest(&self, site: Site) -> f64 {
        let length = |it: &TwinLine| (it.abc[0] as f64).hypot(it.abc[1] as f64);
        let distances = self.vertices.iter().map(|it| it.at(site).abs() as f64 / length(it));
        distances.fold(self.mean.distance(site).value().abs(), f64::max)
    }
}
