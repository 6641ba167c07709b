//! The schema of a type, written down while values of it are read: names and order of fields and variants.

use std::collections::{BTreeMap, VecDeque};
use std::fmt::Write as _;

use planner_core::link::message::{CELL_BYTES, MOST_CORNERS, MOST_GIVEN};
use serde::de::value::Error;
use serde::de::{
    DeserializeOwned, DeserializeSeed, EnumAccess, IntoDeserializer as _, SeqAccess, VariantAccess,
    Visitor,
};
use serde::{Deserializer, forward_to_deserialize_any};

/// What a tuple is called in the schema, by the field that has it.
const TUPLES: [(&str, &[&str]); 5] = [
    ("Site", &["site", "min", "max", "about", "corners"]),
    ("Area", &["area"]),
    ("Line", &["bisector", "centre", "maximum_margin"]),
    ("Front", &["front"]),
    ("Doubt", &["noise"]),
];

/// Entries that a list may have.
const LISTS: [(&str, usize); 3] =
    [("given", MOST_GIVEN), ("corners", MOST_CORNERS), ("bytes", CELL_BYTES)];

/// A type of which no value has been read.
const UNKNOWN: &str = "?";

#[derive(Clone, Debug, PartialEq)]
enum Type {
    /// Another name of a type.
    Alias(String),
    /// Fields, with their types.
    Struct(Vec<[String; 2]>),
    /// Variants, with the type of what they have.
    Choice(Vec<[String; 2]>),
}

#[derive(Debug, Default)]
pub(crate) struct Schema {
    types: BTreeMap<String, Type>,
    /// The type of the value that was read last.
    read: String,
}

impl Schema {
    /// Of what was read twice, that of which more is known.
    fn define(&mut self, name: &str, new: Type) {
        name.clone_into(&mut self.read);
        let Some(old) = self.types.get_mut(name) else {
            self.types.insert(name.to_owned(), new);
            return;
        };
        let (old, new) = match (old, new) {
            (Type::Struct(old), Type::Struct(new)) | (Type::Choice(old), Type::Choice(new)) => {
                (old, new)
            }
            (old, new) => return assert_eq!(*old, new, "two types are called {name}"),
        };
        assert_eq!(old.len(), new.len(), "two types are called {name}");
        for ([entry, was], [same, is]) in old.iter_mut().zip(new) {
            assert_eq!(*entry, same, "two types are called {name}");
            if was.contains(UNKNOWN) {
                *was = is;
            } else {
                assert!(is.contains(UNKNOWN) || *was == is, "{name}.{entry}: {was} or {is}");
            }
        }
    }

    /// What has not been read: variants, and what may be none.
    pub(crate) fn unread(&self) -> Vec<String> {
        let entries = self.types.iter().filter_map(|(name, it)| match it {
            Type::Alias(_) => None,
            Type::Struct(entries) | Type::Choice(entries) => Some((name, entries)),
        });
        let unread = entries.flat_map(|(name, entries)| {
            let unread = entries.iter().filter(|[_, of]| of.contains(UNKNOWN));
            unread.map(move |[entry, _]| format!("{name}.{entry}"))
        });
        unread.collect()
    }

    /// The types from some on, each before those that it has. Lines have the comments that a former text has of the same
    /// entries.
    pub(crate) fn text(&self, roots: &[&str], former: &str) -> String {
        let comments = comments(former);
        let mut text = String::new();
        let mut line = |of: &str, entry: &str, said: &str| {
            let comment = comments.get(&(of.to_owned(), entry.to_owned()));
            let comment = comment.map_or(String::new(), |it| format!("# {it}"));
            let _ = writeln!(text, "{}", format!("{said:<30} {comment}").trim_end());
        };
        let mut queue: VecDeque<_> = roots.iter().map(ToString::to_string).collect();
        let mut seen = queue.clone();
        while let Some(name) = queue.pop_front() {
            let mut parts: Vec<&str> = vec![];
            match &self.types[&name] {
                Type::Alias(of) => {
                    line(&name, "", &format!("{name} = {of}"));
                    parts.push(of);
                }
                Type::Struct(fields) => {
                    line(&name, "", &format!("{name} struct"));
                    for [field, of] in fields {
                        line(&name, field, &format!("  {field} {of}"));
                        parts.push(of);
                    }
                }
                Type::Choice(variants) => {
                    line(&name, "", &format!("{name} choice"));
                    for (index, [variant, of]) in variants.iter().enumerate() {
                        line(&name, variant, format!("  {index} {variant} {of}").trim_end());
                        parts.push(of);
                    }
                }
            }
            let words = parts.iter().flat_map(|it| it.split([' ', '[', ']']));
            for word in words.filter(|it| self.types.contains_key(*it)) {
                if !seen.iter().any(|it| it == word) {
                    seen.push_back(word.to_owned());
                    queue.push_back(word.to_owned());
                }
            }
        }
        text
    }
}

/// The comments of a schema, by type and entry.
fn comments(text: &str) -> BTreeMap<(String, String), String> {
    let mut comments = BTreeMap::new();
    let mut of = String::new();
    for line in text.lines() {
        let (said, comment) = line.split_once('#').unwrap_or((line, ""));
        let mut words = said.split_whitespace().filter(|it| it.parse::<usize>().is_err());
        let Some(first) = words.next() else { continue };
        let is_entry = line.starts_with(' ');
        if !is_entry {
            first.clone_into(&mut of);
        }
        let entry = if is_entry { first } else { "" };
        if !comment.is_empty() {
            comments.insert((of.clone(), entry.to_owned()), comment.trim().to_owned());
        }
    }
    comments
}

/// Reads a value that is all of some bytes, and writes its type down. It reads them by itself, so postcard is checked too.
pub(crate) fn read<T: DeserializeOwned>(bytes: &[u8], schema: &mut Schema) {
    let mut reader = Reader { rest: bytes, schema, field: "" };
    let value = T::deserialize(&mut reader);
    assert!(value.is_ok() && reader.rest.is_empty(), "{:?}, left: {:?}", value.err(), reader.rest);
}

struct Reader<'a> {
    rest: &'a [u8],
    schema: &'a mut Schema,
    /// The field that is read.
    field: &'static str,
}

impl Reader<'_> {
    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let (first, rest) = self.rest.split_first_chunk().expect("more bytes");
        self.rest = rest;
        *first
    }

    fn varint(&mut self) -> u64 {
        let mut value = 0;
        for shift in (0..).step_by(7) {
            let [byte] = self.bytes();
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                break;
            }
        }
        value
    }

    /// A number whose sign is its last bit.
    fn signed(&mut self) -> i64 {
        let value = self.varint();
        (value >> 1) as i64 ^ -((value & 1) as i64)
    }

    fn is(&mut self, name: &str) {
        name.clone_into(&mut self.schema.read);
    }

    /// Reads what has so many parts, and returns their types. They have names, or all that of a list.
    fn parts<'de, V: Visitor<'de>>(
        &mut self,
        (left, names, field): (usize, &'static [&'static str], &'static str),
        visitor: V,
    ) -> Result<(V::Value, Vec<String>), Error> {
        let mut parts = Parts { reader: self, left, names, field, types: Vec::new() };
        let value = visitor.visit_seq(&mut parts)?;
        Ok((value, parts.types))
    }
}

macro_rules! plain {
    ($($read:ident $visit:ident $name:literal $reader:ident => $value:expr,)*) => {
        $(fn $read<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
            let $reader = self;
            $reader.is($name);
            visitor.$visit($value)
        })*
    };
}

impl<'de> Deserializer<'de> for &mut Reader<'_> {
    type Error = Error;

    // The one u64 is a `usize`, which has 32 bits on a chip.
    plain!(
        deserialize_bool visit_bool "bool" it => it.bytes() == [1],
        deserialize_u8 visit_u8 "u8" it => u8::from_le_bytes(it.bytes()),
        deserialize_u16 visit_u16 "u16" it => it.varint() as u16,
        deserialize_u32 visit_u32 "u32" it => it.varint() as u32,
        deserialize_u64 visit_u64 "u32" it => it.varint(),
        deserialize_i32 visit_i32 "i32" it => it.signed() as i32,
        deserialize_i64 visit_i64 "i64" it => it.signed(),
        deserialize_f32 visit_f32 "f32" it => f32::from_le_bytes(it.bytes()),
    );
    forward_to_deserialize_any! {
        i8 i16 f64 char str string bytes byte_buf unit unit_struct map identifier ignored_any
    }

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Error> {
        unreachable!("{}", self.field)
    }

    fn is_human_readable(&self) -> bool {
        false
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        self.is(UNKNOWN);
        let value = match self.bytes() {
            [0] => visitor.visit_none()?,
            _ => visitor.visit_some(&mut *self)?,
        };
        self.schema.read = format!("optional {}", self.schema.read);
        Ok(value)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        let (field, len) = (self.field, self.varint() as usize);
        let (value, types) = self.parts((len, &[], field), visitor)?;
        let most = LISTS.iter().find(|(name, _)| *name == field).expect(field).1;
        self.is(&format!("list {most} {}", types.first().map_or(UNKNOWN, String::as_str)));
        Ok(value)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, len: usize, visitor: V) -> Result<V::Value, Error> {
        let field = self.field;
        // Its own tuples have no name.
        let (value, types) = self.parts((len, &[], ""), visitor)?;
        let of = format!("[{}]", types.join(" "));
        match TUPLES.iter().find(|(_, fields)| fields.contains(&field)) {
            Some((name, _)) => self.schema.define(name, Type::Alias(of)),
            None => self.is(&of),
        }
        Ok(value)
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        len: usize,
        visitor: V,
    ) -> Result<V::Value, Error> {
        self.deserialize_tuple(len, visitor)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Error> {
        let value = visitor.visit_newtype_struct(&mut *self)?;
        // A wrapper of the reader's own.
        if name != "ReadOnce" {
            let of = Type::Alias(self.schema.read.clone());
            self.schema.define(name, of);
        }
        Ok(value)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        names: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        let (value, types) = self.parts((names.len(), names, ""), visitor)?;
        self.schema.define(name, Type::Struct(entries(names, types)));
        Ok(value)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        names: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        let index = self.varint() as usize;
        self.is("");
        let value = visitor.visit_enum(Chosen { reader: &mut *self, index, name: names[index] })?;
        let read = self.schema.read.clone();
        let of = (0..).map(|at| if at == index { read.clone() } else { UNKNOWN.into() });
        self.schema.define(name, Type::Choice(entries(names, of)));
        Ok(value)
    }
}

fn entries(names: &[&str], types: impl IntoIterator<Item = String>) -> Vec<[String; 2]> {
    names.iter().zip(types).map(|(name, of)| [(*name).to_owned(), of]).collect()
}

/// What has parts, as it is read.
struct Parts<'r, 'a> {
    reader: &'r mut Reader<'a>,
    left: usize,
    names: &'static [&'static str],
    field: &'static str,
    types: Vec<String>,
}

impl<'de> SeqAccess<'de> for Parts<'_, '_> {
    type Error = Error;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, Error> {
        if self.left == 0 {
            return Ok(None);
        }
        self.left -= 1;
        // Parts of a list go by the name of the list.
        self.reader.field = self.names.get(self.types.len()).copied().unwrap_or(self.field);
        let value = seed.deserialize(&mut *self.reader)?;
        self.types.push(self.reader.schema.read.clone());
        Ok(Some(value))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.left)
    }
}

/// The variant of a choice, as it is read.
struct Chosen<'r, 'a> {
    reader: &'r mut Reader<'a>,
    index: usize,
    name: &'static str,
}

impl<'de> EnumAccess<'de> for Chosen<'_, '_> {
    type Error = Error;
    type Variant = Self;

    fn variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<(S::Value, Self), Error> {
        Ok((seed.deserialize((self.index as u32).into_deserializer())?, self))
    }
}

impl<'de> VariantAccess<'de> for Chosen<'_, '_> {
    type Error = Error;

    fn unit_variant(self) -> Result<(), Error> {
        Ok(())
    }

    fn newtype_variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<S::Value, Error> {
        self.reader.field = "";
        seed.deserialize(self.reader)
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, _: V) -> Result<V::Value, Error> {
        unreachable!("{}", self.name)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        names: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        let (value, types) = self.reader.parts((names.len(), names, ""), visitor)?;
        // What a variant has goes by the variant's name.
        self.reader.schema.define(self.name, Type::Struct(entries(names, types)));
        Ok(value)
    }
}
