//! The schema of a type, written down while values of it are read: names and order of fields and variants.

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, VecDeque};
use std::fmt::{self, Write as _};

use planner_core::link::message::{MOST_CORNERS, MOST_GIVEN};
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
const LISTS: [(&str, usize); 2] = [("given", MOST_GIVEN), ("corners", MOST_CORNERS)];

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
    /// The variant that was read last.
    variant: usize,
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
    T::deserialize(Traced { of, schema, field: "" })
}

/// A reader, a visitor or a seed that writes down what passes through it.
struct Traced<'a, T> {
    of: T,
    schema: &'a RefCell<Schema>,
    /// The field that is read.
    field: &'static str,
}

impl<'a, T> Traced<'a, T> {
    fn with<U>(&self, of: U) -> Traced<'a, U> {
        Traced { of, schema: self.schema, field: self.field }
    }

    fn is(&self, name: &str) {
        name.clone_into(&mut self.schema.borrow_mut().read);
    }
}

/// A visitor of parts: fields by their names, or those of a tuple or a list.
struct Parts<'a, V> {
    of: Traced<'a, V>,
    names: &'static [&'static str],
    types: &'a RefCell<Vec<String>>,
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

impl<'de, D: Deserializer<'de>> Traced<'_, D> {
    fn parts<V: Visitor<'de>>(
        self,
        names: &'static [&'static str],
        visitor: V,
        read: impl FnOnce(D, Parts<'_, V>) -> Result<V::Value, D::Error>,
    ) -> Result<(V::Value, Vec<String>), D::Error> {
        let types = RefCell::default();
        let parts = Parts { of: self.with(visitor), names, types: &types };
        let value = read(self.of, parts)?;
        Ok((value, types.into_inner()))
    }
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
        let (schema, field) = (self.schema, self.field);
        let (value, types) = self.parts(&[], visitor, |of, parts| of.deserialize_seq(parts))?;
        let most = LISTS.iter().find(|(name, _)| *name == field).expect(field).1;
        let of = types.first().map_or(UNKNOWN, String::as_str);
        schema.borrow_mut().read = format!("list {most} {of}");
        Ok(value)
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        len: usize,
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let (schema, field) = (self.schema, self.field);
        // Its own tuples have no name.
        let inner = Traced { field: "", ..self };
        let (value, types) =
            inner.parts(&[], visitor, |of, parts| of.deserialize_tuple(len, parts))?;
        let of = format!("[{}]", types.join(" "));
        match TUPLES.iter().find(|(_, fields)| fields.contains(&field)) {
            Some((name, _)) => schema.borrow_mut().define(name, Type::Alias(of)),
            None => schema.borrow_mut().read = of,
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
        if name != "Known" {
            let of = schema.borrow().read.clone();
            schema.borrow_mut().define(name, Type::Alias(of));
        }
        Ok(value)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let schema = self.schema;
        let (value, types) =
            self.parts(fields, visitor, |of, parts| of.deserialize_struct(name, fields, parts))?;
        schema.borrow_mut().define(name, Type::Struct(entries(fields, types)));
        Ok(value)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, D::Error> {
        let (schema, chosen) = (self.schema, Cell::new(0));
        let visitor = Choosing { of: self.with(visitor), variants, chosen: &chosen };
        let value = self.of.deserialize_enum(name, variants, visitor)?;
        let read = schema.borrow().read.clone();
        let of = (0..).map(|at| if at == chosen.get() { read.clone() } else { UNKNOWN.into() });
        schema.borrow_mut().define(name, Type::Choice(entries(variants, of)));
        Ok(value)
    }
}

fn entries(names: &[&str], types: impl IntoIterator<Item = String>) -> Vec<[String; 2]> {
    names.iter().zip(types).map(|(name, of)| [(*name).to_owned(), of]).collect()
}

/// Of an option, a newtype and an index.
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
}

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Traced<'_, S> {
    type Value = S::Value;

    fn deserialize<D: Deserializer<'de>>(self, reader: D) -> Result<S::Value, D::Error> {
        let reader = self.with(reader);
        self.of.deserialize(reader)
    }
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Parts<'_, V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.of.of.expecting(f)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, parts: A) -> Result<V::Value, A::Error> {
        let of = self.of.with(parts);
        self.of.of.visit_seq(Parts { of, names: self.names, types: self.types })
    }
}

impl<'de, A: SeqAccess<'de>> SeqAccess<'de> for Parts<'_, A> {
    type Error = A::Error;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, A::Error> {
        let at = self.types.borrow().len();
        // Parts of a list go by the name of the list.
        let field = self.names.get(at).copied().unwrap_or(self.of.field);
        let seed = Traced { of: seed, schema: self.of.schema, field };
        let value = self.of.of.next_element_seed(seed)?;
        if value.is_some() {
            self.types.borrow_mut().push(self.of.schema.borrow().read.clone());
        }
        Ok(value)
    }

    fn size_hint(&self) -> Option<usize> {
        self.of.of.size_hint()
    }
}

/// A visitor of a variant, or what gives access to it.
struct Choosing<'a, T> {
    of: Traced<'a, T>,
    variants: &'static [&'static str],
    chosen: &'a Cell<usize>,
}

impl<'de, V: Visitor<'de>> Visitor<'de> for Choosing<'_, V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.of.of.expecting(f)
    }

    fn visit_enum<A: EnumAccess<'de>>(self, access: A) -> Result<V::Value, A::Error> {
        let of = self.of.with(access);
        self.of.of.visit_enum(Choosing { of, variants: self.variants, chosen: self.chosen })
    }
}

impl<'de, 'a, A: EnumAccess<'de>> EnumAccess<'de> for Choosing<'a, A> {
    type Error = A::Error;
    type Variant = Choosing<'a, A::Variant>;

    fn variant_seed<S: DeserializeSeed<'de>>(
        self,
        seed: S,
    ) -> Result<(S::Value, Self::Variant), A::Error> {
        let Self { of: Traced { of, schema, field }, variants, chosen } = self;
        let (value, of) = of.variant_seed(Traced { of: seed, schema, field })?;
        chosen.set(schema.borrow().variant);
        schema.borrow_mut().read = String::new();
        Ok((value, Choosing { of: Traced { of, schema, field }, variants, chosen }))
    }
}

impl<'de, A: VariantAccess<'de>> VariantAccess<'de> for Choosing<'_, A> {
    type Error = A::Error;

    fn unit_variant(self) -> Result<(), A::Error> {
        self.of.of.unit_variant()
    }

    fn newtype_variant_seed<S: DeserializeSeed<'de>>(self, seed: S) -> Result<S::Value, A::Error> {
        let seed = Traced { of: seed, schema: self.of.schema, field: "" };
        self.of.of.newtype_variant_seed(seed)
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, _: V) -> Result<V::Value, A::Error> {
        unreachable!("{:?}", self.variants)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, A::Error> {
        let types = RefCell::default();
        let schema = self.of.schema;
        let parts = Parts { of: self.of.with(visitor), names: fields, types: &types };
        let value = self.of.of.struct_variant(fields, parts)?;
        // What a variant has goes by the variant's name.
        let name = self.variants[self.chosen.get()];
        schema.borrow_mut().define(name, Type::Struct(entries(fields, types.into_inner())));
        Ok(value)
    }
}
