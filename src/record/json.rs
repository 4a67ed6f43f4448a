//! A message as JSON, read by the schema that the file itself carries: also messages of other programs and versions.
//!
//! Every field of the schema is there, with its default if the message leaves it out. NaN and infinities are texts, as
//! JSON has no such numbers; enumerations are the names of their values; bytes are hexadecimal, but the packed points of
//! a `foxglove.PointCloud` become rows of numbers.

use super::raw::Schema;
use crate::units::hex;
use crate::wire::json::number;
use prost::Message;
use prost::encoding::{DecodeContext, WireType, decode_key, decode_varint, skip_field};
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{DescriptorProto, EnumDescriptorProto, FieldDescriptorProto, FileDescriptorSet};
use serde_json::{Map, Value};
use std::collections::HashMap;

/// The messages and enumerations of a schema by full name.
pub struct JsonReader {
    messages: HashMap<String, DescriptorProto>,
    enums: HashMap<String, EnumDescriptorProto>,
    root: String,
}

/// Deeper messages are refused: nothing of ours is deeper than 6.
const DEEPEST: u32 = 32;

impl JsonReader {
    /// For one channel's schema.
    ///
    /// # Errors
    /// The schema is not protobuf, or is not one.
    pub fn new(schema: &Schema) -> Result<Self, String> {
        if schema.encoding != "protobuf" {
            return Err(format!(
                "found encoding {:?}, allowed protobuf",
                schema.encoding
            ));
        }
        let set = FileDescriptorSet::decode(schema.data.as_slice()).map_err(|e| e.to_string())?;
        let mut reader = Self {
            messages: HashMap::new(),
            enums: HashMap::new(),
            root: format!(".{}", schema.name),
        };
        for file in set.file {
            let package = file.package.clone().unwrap_or_default();
            let prefix = if package.is_empty() {
                String::new()
            } else {
                format!(".{package}")
            };
            for message in file.message_type {
                reader.add(&prefix, message);
            }
            for kind in file.enum_type {
                reader
                    .enums
                    .insert(format!("{prefix}.{}", kind.name()), kind);
            }
        }
        if reader.messages.contains_key(&reader.root) {
            Ok(reader)
        } else {
            Err(format!("the schema does not describe {}", schema.name))
        }
    }

    fn add(&mut self, prefix: &str, message: DescriptorProto) {
        let name = format!("{prefix}.{}", message.name());
        for kind in &message.enum_type {
            self.enums
                .insert(format!("{name}.{}", kind.name()), kind.clone());
        }
        for nested in message.nested_type.clone() {
            self.add(&name, nested);
        }
        self.messages.insert(name, message);
    }

    /// A message of that schema.
    ///
    /// # Errors
    /// The bytes are something else.
    pub fn read(&self, data: &[u8]) -> Result<Value, String> {
        let mut value = self.message(&self.root, data, 0)?;
        if self.root == ".foxglove.PointCloud" {
            rows_of_points(&mut value, data)?;
        }
        Ok(Value::Object(value))
    }

    fn message(
        &self,
        name: &str,
        mut data: &[u8],
        depth: u32,
    ) -> Result<Map<String, Value>, String> {
        let known = self.messages.get(name).filter(|_| depth < DEEPEST);
        let known = known.ok_or_else(|| format!("{name} is not described, or too deep"))?;
        let mut fields: Map<String, Value> = known
            .field
            .iter()
            .map(|field| (field.name().to_owned(), self.default(field)))
            .collect();
        while !data.is_empty() {
            let (number, wire) = decode_key(&mut data).map_err(|e| e.to_string())?;
            let Some(field) = known.field.iter().find(|f| f.number() == number as i32) else {
                skip_field(wire, number, &mut data, DecodeContext::default())
                    .map_err(|e| e.to_string())?;
                continue;
            };
            let repeated = field.label() == Label::Repeated;
            let packed = repeated && wire == WireType::LengthDelimited && is_number(field.r#type());
            let mut found = Vec::new();
            if packed {
                let mut list = bytes(&mut data)?;
                while !list.is_empty() {
                    found.push(self.value(field, &mut list, depth)?);
                }
            } else {
                found.push(self.value(field, &mut data, depth)?);
            }
            match fields.get_mut(field.name()) {
                Some(Value::Array(list)) if repeated => list.append(&mut found),
                Some(slot) => *slot = found.pop().unwrap_or_default(),
                None => {}
            }
        }
        Ok(fields)
    }

    fn default(&self, field: &FieldDescriptorProto) -> Value {
        if field.label() == Label::Repeated {
            return Value::Array(Vec::new());
        }
        match field.r#type() {
            Type::Message | Type::Group => Value::Null,
            Type::String | Type::Bytes => "".into(),
            Type::Bool => false.into(),
            Type::Double | Type::Float => 0.0.into(),
            Type::Enum => self.enumeration(field.type_name(), 0),
            _ => 0.into(),
        }
    }

    fn value(
        &self,
        field: &FieldDescriptorProto,
        data: &mut &[u8],
        depth: u32,
    ) -> Result<Value, String> {
        Ok(match field.r#type() {
            Type::Double => number(f64::from_le_bytes(take(data)?)),
            Type::Float => number(f64::from(f32::from_le_bytes(take(data)?))),
            Type::Fixed64 => u64::from_le_bytes(take(data)?).into(),
            Type::Sfixed64 => i64::from_le_bytes(take(data)?).into(),
            Type::Fixed32 => u32::from_le_bytes(take(data)?).into(),
            Type::Sfixed32 => i32::from_le_bytes(take(data)?).into(),
            Type::Uint64 | Type::Uint32 => varint(data)?.into(),
            Type::Int64 | Type::Int32 => varint(data)?.cast_signed().into(),
            Type::Sint64 | Type::Sint32 => {
                let folded = varint(data)?;
                ((folded >> 1).cast_signed() ^ -((folded & 1).cast_signed())).into()
            }
            Type::Bool => (varint(data)? != 0).into(),
            Type::Enum => self.enumeration(field.type_name(), varint(data)?.cast_signed()),
            Type::String => String::from_utf8_lossy(bytes(data)?).into(),
            Type::Bytes => hex(bytes(data)?).into(),
            Type::Message => {
                Value::Object(self.message(field.type_name(), bytes(data)?, depth + 1)?)
            }
            Type::Group => return Err("groups are not read".to_owned()),
        })
    }

    /// Name of a value; a number that has none stays a number.
    fn enumeration(&self, name: &str, number: i64) -> Value {
        let kind = self.enums.get(name);
        let mut values = kind.iter().flat_map(|kind| &kind.value);
        values
            .find(|value| i64::from(value.number()) == number)
            .map_or(number.into(), |value| value.name().into())
    }
}

fn is_number(kind: Type) -> bool {
    !matches!(
        kind,
        Type::String | Type::Bytes | Type::Message | Type::Group
    )
}

fn varint(data: &mut &[u8]) -> Result<u64, String> {
    decode_varint(data).map_err(|e| e.to_string())
}

fn take<const N: usize>(data: &mut &[u8]) -> Result<[u8; N], String> {
    let (head, rest) = data.split_first_chunk::<N>().ok_or_else(short)?;
    *data = rest;
    Ok(*head)
}

fn bytes<'d>(data: &mut &'d [u8]) -> Result<&'d [u8], String> {
    let length = usize::try_from(varint(data)?).map_err(|_| short())?;
    let (head, rest) = data.split_at_checked(length).ok_or_else(short)?;
    *data = rest;
    Ok(head)
}

fn short() -> String {
    "the message ends within a field".to_owned()
}

/// `data` of a cloud as `points`: a row of numbers each, in the order of `fields`.
fn rows_of_points(value: &mut Map<String, Value>, data: &[u8]) -> Result<(), String> {
    let cloud = crate::wire::foxglove::PointCloud::decode(data).map_err(|e| e.to_string())?;
    let points = cloud.points().map(|point| {
        let fields = cloud.fields.iter();
        fields
            .map(|field| field.of_point(point).map_or(Value::Null, number))
            .collect()
    });
    value.insert("points".to_owned(), Value::Array(points.collect()));
    value.remove("data");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::messages::{Applied, AppliedInput, Gauge};
    use crate::wire::{Described, schema};
    use serde_json::json;

    fn read<M: Message + Described>(message: &M) -> Value {
        let schema = Schema {
            name: M::FULL_NAME.to_owned(),
            encoding: "protobuf".to_owned(),
            data: schema::<M>(),
        };
        let reader = JsonReader::new(&schema).unwrap();
        reader.read(&message.encode_to_vec()).unwrap()
    }

    #[test]
    fn messages_become_json_by_their_own_schema() {
        let gauge = Gauge {
            timestamp: Some(prost_types::Timestamp {
                seconds: 1,
                nanos: -5,
            }),
            time: 1.25,
            step: u64::MAX,
            name: "gauge.level.depth".to_owned(),
            values: vec![0.1, f64::NAN, f64::NEG_INFINITY],
            validity: 3,
            ..Gauge::default()
        };
        assert_eq!(
            read(&gauge),
            json!({
                "timestamp": {"seconds": 1, "nanos": -5}, "time": 1.25, "step": u64::MAX, "sequence": 0,
                "name": "gauge.level.depth", "unit": "", "values": [0.1, "NaN", "-Infinity"], "validity": "BLOCKED",
            })
        );
        let applied = Applied {
            inputs: vec![AppliedInput {
                bits: vec![0.5f64.to_bits()],
                ..AppliedInput::default()
            }],
            ..Applied::default()
        };
        let value = read(&applied);
        assert_eq!(value["event"], "STEP");
        assert_eq!(value["inputs"][0]["bits"], json!([0.5f64.to_bits()]));
        assert_eq!(value["timestamp"], Value::Null);
    }

    #[test]
    fn bytes_that_are_no_message_are_refused() {
        let schema = Schema {
            name: "sandgate.Gauge".to_owned(),
            encoding: "protobuf".to_owned(),
            data: schema::<Gauge>(),
        };
        let reader = JsonReader::new(&schema).unwrap();
        for bad in [&[0x0a, 0xff, 0xff, 0x03][..], &[0x11, 0, 0], &[0xff]] {
            assert!(reader.read(bad).is_err(), "{bad:?}");
        }
    }
}
