//! The numbers of each step, as flat rows have them. `schemas/step.proto` says which, and what they are. To it are added
//! the numbers that only some missions have.

use anyhow::{Context as _, Result};
use prost::{Message as _, encode_length_delimiter};
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, FieldDescriptorProto, FileDescriptorSet, OneofDescriptorProto};
use serde_json::json;

use crate::report::flat::Row;
use crate::report::log::messages::{STEP, time};
use crate::report::page::scene::Scene;

/// The fields of a message, one for each number.
pub(super) struct Plot(FileDescriptorSet);

impl Plot {
    /// The fields for some rows.
    ///
    /// # Errors
    /// Never: the schema is one.
    pub(super) fn of(rows: &[Row]) -> Result<Self> {
        let mut schema = FileDescriptorSet::decode(STEP.1)?;
        let message = schema.file.last_mut().and_then(|file| file.message_type.last_mut());
        let message = message.context("a message in the schema")?;
        for key in rows.iter().take(1).flat_map(Row::added) {
            if rows.iter().any(|row| row.get(key).is_number()) {
                add(message, key);
            }
        }
        Ok(Self(schema))
    }

    /// The schema's name and descriptors.
    pub(super) fn schema(&self) -> (&'static str, Vec<u8>) {
        (STEP.0, self.0.encode_to_vec())
    }

    /// The message of a step.
    pub(super) fn message(&self, second: u32, row: &Row, scene: &Scene) -> Result<Vec<u8>> {
        let estimate = scene.estimate.as_ref();
        let mut bytes = Vec::new();
        let files = self.0.file.last();
        for field in files.iter().flat_map(|file| &file.message_type).flat_map(|it| &it.field) {
            let value = match field.name() {
                "slope_error_deg" => &json!(estimate.and_then(|line| line.off_deg)),
                "misclassified" => &json!(estimate.and_then(|line| line.misclassified)),
                key => row.get(key),
            };
            let (wire, encoded) = match field.r#type() {
                Type::Message => (2, Some(time(second).encode_length_delimited_to_vec())),
                Type::String => (2, value.as_str().map(text).transpose()?),
                Type::Double => (1, value.as_f64().map(|number| number.to_le_bytes().into())),
                _ => (0, value.as_i64().map(|number| varint(field, number)).transpose()?),
            };
            // What is not optional is left out where it is nothing.
            let is_nothing = |bytes: &Vec<u8>| bytes.iter().all(|byte| *byte == 0);
            if let Some(encoded) = encoded.filter(|it| field.proto3_optional() || !is_nothing(it)) {
                encode_length_delimiter(field.number() as usize * 8 + wire, &mut bytes)?;
                bytes.extend(encoded);
            }
        }
        Ok(bytes)
    }
}

/// Adds a number to a message, which may be absent.
fn add(message: &mut DescriptorProto, key: &str) {
    let last = message.field.iter().map(FieldDescriptorProto::number).max();
    // Protobuf marks an optional field by a choice of one.
    let choice = OneofDescriptorProto { name: Some(format!("_{key}")), options: None };
    message.field.push(FieldDescriptorProto {
        name: Some(key.to_owned()),
        number: last.map(|last| last + 1),
        label: Some(Label::Optional.into()),
        r#type: Some(Type::Double.into()),
        oneof_index: Some(message.oneof_decl.len() as i32),
        proto3_optional: Some(true),
        ..FieldDescriptorProto::default()
    });
    message.oneof_decl.push(choice);
}

fn text(text: &str) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    encode_length_delimiter(text.len(), &mut bytes)?;
    bytes.extend(text.as_bytes());
    Ok(bytes)
}

/// A whole number; one with a sign alternates between the signs.
fn varint(field: &FieldDescriptorProto, number: i64) -> Result<Vec<u8>> {
    let has_sign = field.r#type() == Type::Sint32;
    let mut bytes = Vec::new();
    let number = if has_sign { number << 1 ^ number >> 63 } else { number };
    encode_length_delimiter(number as usize, &mut bytes)?;
    Ok(bytes)
}
