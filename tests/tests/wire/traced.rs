//! The schema of a type, written down while values of it are read: names and order of fields and variants.

use std::cell::RefCell;
use std::collections::{BTreeMap, VecDeque};
use std::fmt::{self, Write as _};

use planner_core::link::message::{CELL_BYTES, MOST_CORNERS, MOST_GIVEN};
use serde::de::{DeserializeSeed, EnumAccess, SeqAccess, VariantAccess, Visitor};
use serde::{Deserialize, Deserializer};

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
    /// The variant that was read last, and those of the choices that are being read.
    variant: usize,
    chosen: Vec<usize>,
    /// The types of the parts of what is being read.
    parts: Vec<Vec<String>>,
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

/// Reads a value, and writes its type down.
pub(crate) fn read<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    of: D,
    schema: &RefCell<Schema>,
) -> Result<T, D::Error> {
    T::deserialize(Traced { of, schema, field: "", names: &[] })
}

/// A reader, a visitor, a seed or what gives access to parts, which writes down what passes through it.
struct Traced<'a, T> {
    of: T,
    schema: &'a RefCell<Schema>,
    /// The field that is read.
    field: &'static str,
    /// The fields of the struct that is read, or the variants of the choice.
    names: &'static [&'static str],
}

impl<'a, T> Traced<'a, T> {
    fn with<U>(&self, of: U) -> Traced<'a, U> {
        Traced { of, schema: self.schema, field: self.field, names: self.names }
    }

    /// The same of what has no name of its own.
    fn nameless<U>(&self, of: U) -> Traced<'a, U> {
        Traced { of, schema: self.schema, field: "", names: &[] }
    }

    fn is(&self, name: &str) {
        name.clone_into(&mut self.schema.borrow_mut().read);
    }

    /// Reads what has parts, and returns their types.
    fn parts<R, E>(&self, read: impl FnOnce() -> Result<R, E>) -> Result<(R, Vec<String>), E> {
        self.schema.borrow_mut().parts.push(Vec::new());
        let value = read()?;
        Ok((value, self.schema.borrow_mut().parts.pop().unwrap_or_default()))
    }
}

macro_rules! plain {
    ($($read:ident $name:literal),*) => {
        $(fn $read<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
            self.is($name);
            self.of.$read(visitor)
        })*
    };
}

macro_rules! never {
    ($($read:ident),*) => {
        $(fn $read<V: Visitor<'de>>(self, _: V) -> Result<V::Value, D::Error> {
            unreachable!("{}: {}", self.field, stringify!($read))
        })*
    };
}

impl<'de, D: Deserializer<'de>> Deserializer<'de> for Traced<'_, D> {
    type Error = D::Error;

    // The one u64 is a `usize`, which has 32 bits on a chip.
    plain!(deserialize_bool "bool", deserialize_u8 "u8", deserialize_u16 "u16", deserialize_u32 "u32",
        deserialize_u64 "u32", deserialize_i32 "i32", deserialize_i64 "i64", deserialize_f32 "f32");
    never!(
        deserialize_any,
        deserialize_i8,
        deserialize_i16,
        deserialize_f64,
        deserialize_char,
        deserialize_str,
        deserialize_string,
        deserialize_bytes,
        deserialize_byte_buf,
        deserialize_unit,
        deserialize_map,
        deserialize_ignored_any
    );

    fn is_human_readable(&self) -> bool {
        self.of.is_human_readable()
    }

    fn deserialize_identifier<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        let visitor = self.with(visitor);
        self.of.deserialize_identifier(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        let (schema, visitor) = (self.schema, self.with(visitor));
        let value = self.of.deserialize_option(visitor)?;
        let mut schema = schema.borrow_mut();
        schema.read = format!("optional {}", schema.read);
        Ok(value)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        let inner = Traced { names: &[], ..self.with(visitor) };
        let told = self.with(());
        let (value, types) = told.parts(|| self.of.deserialize_seq(inner))?;
        let most = LISTS.iter().find(|(name, _)| *name == told.field).expect(told.field).1;
        let of = types.first().map_or(UNKNOWN, String::as_str);
        told.is(&format!("list {most} {of}"));
        Ok(value)
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        len: usize,
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        // Its own tuples have no name.
        let (told, inner) = (self.with(()), self.nameless(visitor));
        let (value, types) = told.parts(|| self.of.deserialize_tuple(len, inner))?;
        let of = format!("[{}]", types.join(" "));
        match TUPLES.iter().find(|(_, fields)| fields.contains(&told.field)) {
            Some((name, _)) => told.schema.borrow_mut().define(name, Type::Alias(of)),
            None => told.is(&of),
        }
        Ok(value)
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        len: usize,
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        self.deserialize_tuple(len, visitor)
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        _: V,
    ) -> Result<V::Value, D::Error> {
        unreachable!("{name}")
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let (schema, visitor) = (self.schema, self.with(visitor));
        let value = self.of.deserialize_newtype_struct(name, visitor)?;
        // A wrapper of the reader's own.
        if name != "ReadOnce" {
            let of = schema.borrow().read.clone();
            schema.borrow_mut().define(name, Type::Alias(of));
        }
        Ok(value)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        names: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let (told, inner) = (self.with(()), Traced { names, ..self.with(visitor) });
        let (value, types) = told.parts(|| self.of.deserialize_struct(name, names, inner))?;
        told.schema.borrow_mut().define(name, Type::Struct(entries(names, types)));
        Ok(value)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        names: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let (schema, inner) = (self.schema, Traced { names, ..self.with(visitor) });
        let value = self.of.deserialize_enum(name, names, inner)?;
        let mut schema = schema.borrow_mut();
        let (chosen, read) = (schema.chosen.pop(), schema.read.clone());
        let of = (0..).map(|at| if Some(at) == chosen { read.clone() } else { UNKNOWN.into() });
        schema.define(name, Type::Choice(entries(names, of)));
        Ok(value)
    }
}

fn entries(names: &[&str], types: impl IntoIterator<Item = String>) -> Vec<[String; 2]> {
    names.iter().zip(types).map(|(name, of)| [(*name).to_owned(), of]).collect()
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Traced<'_, V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.of.expecting(f)
    }

    fn visit_none<E: serde::de::Error>(self) -> Result<V::Value, E> {
        self.is(UNKNOWN);
        self.of.visit_none()
    }

    fn visit_some<D: Deserializer<'de>>(self, reader: D) -> Result<V::Value, D::Error> {
        let reader = self.with(reader);
        self.of.visit_some(reader)
    }

    fn visit_newtype_struct<D: Deserializer<'de>>(self, reader: D) -> Result<V::Value, D::Error> {
        let reader = self.with(reader);
        self.of.visit_newtype_struct(reader)
    }

    fn visit_u32<E: serde::de::Error>(self, index: u32) -> Result<V::Value, E> {
        self.schema.borrow_mut().variant = index as usize;
        self.of.visit_u32(index)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, parts: A) -> Result<V::Value, A::Error> {
        let parts = self.with(parts);
        self.of.visit_seq(parts)
    }

    fn visit_enum<A: EnumAccess<'de>>(self, access: A) -> Result<V::Value, A::Error> {
        let access = self.with(access);
        self.of.visit_enum(access)
    }
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Traced<'_, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, reader: D) -> Result<S::Value, D::Error> {
        let reader = self.with(reader);
        self.of.deserialize(reader)
    }
}

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for Traced<'_, A> {
    type Error = A::Error;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, A::Error> {
        let at = self.schema.borrow().parts.last().map_or(0, Vec::len);
        // Parts of a list go by the name of the list.
        let field = self.names.get(at).copied().unwrap_or(self.field);
        let seed = Traced { field, ..self.nameless(seed) };
        let value = self.of.next_element_seed(seed)?;
        if value.is_some() {
            let mut schema = self.schema.borrow_mut();
            let read = schema.read.clone();
            schema.parts.last_mut().expect("what has parts").push(read);
        }
        Ok(value)
    }

    fn size_hint(&self) -> Option<usize> {
        self.of.size_hint()
    }
}

impl<'de, 'a, A: EnumAccess<'de>> EnumAccess<'de> for Traced<'a, A> {
    type Error = A::Error;
    type Variant = Traced<'a, A::Variant>;

    fn variant_seed<S: DeserializeSeed<'de>>(
        self,
        seed: S,
    ) -> Result<(S::Value, Self::Variant), A::Error> {
        let (told, seed) = (self.with(()), self.nameless(seed));
        let (value, of) = self.of.variant_seed(seed)?;
        let mut schema = told.schema.borrow_mut();
        let variant = schema.variant;
        schema.chosen.push(variant);
        schema.read = String::new();
        Ok((value, told.with(of)))
    }
}

impl<'de, A: VariantAccess<'de>> VariantAccess<'de> for Traced<'_, A> {
    type Error = A::Error;

    fn unit_variant(self) -> Result<(), A::Error> {
        self.of.unit_variant()
    }

    fn newtype_variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<S::Value, A::Error> {
        let seed = self.nameless(seed);
        self.of.newtype_variant_seed(seed)
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, _: V) -> Result<V::Value, A::Error> {
        unreachable!("{:?}", self.names)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        names: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        let (told, inner) = (self.with(()), Traced { names, ..self.with(visitor) });
        let (value, types) = told.parts(|| self.of.struct_variant(names, inner))?;
        // What a variant has goes by the variant's name.
        let mut schema = told.schema.borrow_mut();
        let name = told.names[*schema.chosen.last().expect("a variant")];
        schema.define(name, Type::Struct(entries(names, types)));
        Ok(value)
    }
}
