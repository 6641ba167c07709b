//! Values in scenario files, read strictly. By default, serde accepts an array in the place of a table, and reads only
//! the first elements of an array that is too long.

use std::fmt::{self, Display};
use std::marker::PhantomData;

use anyhow::bail;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use crate::mission::wording::{expected, in_radians};

/// Refuses a value by the name of its field.
///
/// # Errors
/// Always: what was found, and what was expected.
pub fn wrong<T>(field: &str, found: impl Display, expected: impl Display) -> anyhow::Result<T> {
    bail!("{field}: found {found}, expected {expected}")
}

/// Refuses a value of a key or a flag with the words that [`expected`] has for it.
///
/// # Errors
/// Always: what was found, and what was expected.
pub fn beyond<T>(field: &str, found: impl Display) -> anyhow::Result<T> {
    wrong(field, found, expected(field).unwrap_or("another"))
}

/// A value of a key or a flag, if it is one.
///
/// # Errors
/// As [`beyond`], if it is not.
pub fn checked<T: Display>(field: &str, value: T, is_one: bool) -> anyhow::Result<T> {
    if is_one { Ok(value) } else { beyond(field, value) }
}

/// As [`beyond`], of an angle in radians. It may have been meant in degrees.
///
/// # Errors
/// Always.
pub fn no_angle<T>(field: &str, radians: f64) -> anyhow::Result<T> {
    let hint = if radians > 1.0 { format!(" ({})", in_radians(radians)) } else { String::new() };
    wrong(field, radians, format!("{}{hint}", expected(field).unwrap_or("radians")))
}

/// A value that must be a table.
#[derive(Default)]
pub(crate) struct Table<T>(pub(crate) T);

/// An array of this many numbers.
pub(crate) struct Numbers<const N: usize>(pub(crate) [f64; N]);

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Table<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(TableVisitor(PhantomData)).map(Self)
    }
}

struct TableVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for TableVisitor<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a table")
    }

    fn visit_map<A: MapAccess<'de>>(self, fields: A) -> Result<T, A::Error> {
        T::deserialize(MapAccessDeserializer::new(fields))
    }
}

impl<'de, const N: usize> Deserialize<'de> for Numbers<N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(NumbersVisitor).map(Self)
    }
}

struct NumbersVisitor<const N: usize>;

impl<'de, const N: usize> Visitor<'de> for NumbersVisitor<N> {
    type Value = [f64; N];

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "an array of {N} numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<[f64; N], A::Error> {
        let mut numbers = [0.0; N];
        for (i, number) in numbers.iter_mut().enumerate() {
            *number = elements.next_element()?.ok_or_else(|| Error::invalid_length(i, &self))?;
        }
        let mut count = N;
        while elements.next_element::<IgnoredAny>()?.is_some() {
            count += 1;
        }
        if count > N { Err(Error::invalid_length(count, &self)) } else { Ok(numbers) }
    }
}
