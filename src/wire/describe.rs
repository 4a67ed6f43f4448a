//! Protobuf messages that carry their own description.
//!
//! [`messages!`] passes ordinary `prost` structs through and reads the *same tokens* to build their descriptors, so a
//! field's number and type stand in one place and no `protoc` is needed. [`schema`] puts a message and all it refers
//! to into the `FileDescriptorSet` that MCAP viewers decode with.
//!
//! It does not read or write messages (`prost` does), and knows no particular message.

use prost::Message as _;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{
    DescriptorProto, EnumDescriptorProto, EnumValueDescriptorProto, FieldDescriptorProto,
    FileDescriptorProto, FileDescriptorSet,
};
use std::collections::BTreeMap;

/// A message whose description is known.
pub trait Described {
    /// Full name with package, as Zenoh encodings and MCAP schemas spell it: `sandgate.Gauge`.
    const FULL_NAME: &'static str;

    /// Adds the file of this message and of every message it refers to, keyed by file name, each once.
    fn add_files(files: &mut BTreeMap<String, FileDescriptorProto>);
}

/// An enumeration nested in a message.
pub trait DescribedEnum {
    /// Full name of the enumeration: `foxglove.Log.Level`.
    const FULL_NAME: &'static str;

    /// Its values in order of number.
    fn describe() -> EnumDescriptorProto;
}

/// The bytes of an MCAP schema record for `M`: a serialised `FileDescriptorSet`, one file a message, each behind
/// those that it depends on, so that readers can take them one after the other. The same bytes at every call.
#[must_use]
pub fn schema<M: Described>() -> Vec<u8> {
    let mut files = BTreeMap::new();
    M::add_files(&mut files);
    let mut file = Vec::with_capacity(files.len());
    let main = file_name(M::FULL_NAME);
    move_with_dependencies(&main, &mut files, &mut file);
    FileDescriptorSet { file }.encode_to_vec()
}

/// Moves the file of this name, and before it all that it needs, from one place to the other; what was moved already stays.
fn move_with_dependencies(
    name: &str,
    from: &mut BTreeMap<String, FileDescriptorProto>,
    to: &mut Vec<FileDescriptorProto>,
) {
    let Some(file) = from.remove(name) else {
        return;
    };
    for needed in &file.dependency {
        move_with_dependencies(needed, from, to);
    }
    to.push(file);
}

/// Name of the file that holds a message: `sandgate.Gauge` is in `sandgate/Gauge.proto`. Google's own keep the names
/// they have everywhere, or a reader that knows them already would see two definitions.
pub(super) fn file_name(full_name: &str) -> String {
    let path = full_name.replace('.', "/");
    match path.strip_prefix("google/protobuf/") {
        Some(name) => format!("google/protobuf/{}.proto", name.to_lowercase()),
        None => format!("{path}.proto"),
    }
}

/// The file of one message; its dependencies are the files of its fields' messages.
pub(super) fn file(
    full_name: &str,
    fields: Vec<FieldDescriptorProto>,
    enums: Vec<EnumDescriptorProto>,
) -> FileDescriptorProto {
    let (package, name) = full_name.rsplit_once('.').unwrap_or(("", full_name));
    let mut dependency: Vec<String> = fields
        .iter()
        .filter(|f| f.r#type == Some(Type::Message as i32))
        .filter_map(|f| f.type_name.as_deref())
        .map(|t| file_name(t.trim_start_matches('.')))
        .collect();
    dependency.sort();
    dependency.dedup();
    FileDescriptorProto {
        name: Some(file_name(full_name)),
        package: Some(package.to_owned()),
        dependency,
        message_type: vec![DescriptorProto {
            name: Some(name.to_owned()),
            field: fields,
            enum_type: enums,
            ..Default::default()
        }],
        syntax: Some("proto3".to_owned()),
        ..Default::default()
    }
}

/// One field; `type_name` is the full name of its message or enumeration, empty for scalars.
pub(super) fn field(
    name: &str,
    number: &str,
    label: Label,
    kind: Type,
    type_name: &str,
) -> FieldDescriptorProto {
    FieldDescriptorProto {
        name: Some(name.trim_start_matches("r#").to_owned()),
        number: number.parse().ok(),
        label: Some(label as i32),
        r#type: Some(kind as i32),
        type_name: (!type_name.is_empty()).then(|| format!(".{type_name}")),
        ..Default::default()
    }
}

/// Name and values of an enumeration; a value `LineStrip` is called `LINE_STRIP`.
pub(super) fn enumeration(full_name: &str, values: &[(&str, i32)]) -> EnumDescriptorProto {
    EnumDescriptorProto {
        name: full_name.rsplit('.').next().map(str::to_owned),
        value: values
            .iter()
            .map(|&(name, number)| EnumValueDescriptorProto {
                name: Some(upper_snake(name)),
                number: Some(number),
                options: None,
            })
            .collect(),
        ..Default::default()
    }
}

fn upper_snake(camel: &str) -> String {
    let mut snake = String::new();
    for (i, c) in camel.chars().enumerate() {
        if i > 0 && c.is_uppercase() {
            snake.push('_');
        }
        snake.push(c.to_ascii_uppercase());
    }
    snake
}

impl Described for prost_types::Timestamp {
    const FULL_NAME: &'static str = "google.protobuf.Timestamp";

    fn add_files(files: &mut BTreeMap<String, FileDescriptorProto>) {
        add_time_file(Self::FULL_NAME, files);
    }
}

impl Described for prost_types::Duration {
    const FULL_NAME: &'static str = "google.protobuf.Duration";

    fn add_files(files: &mut BTreeMap<String, FileDescriptorProto>) {
        add_time_file(Self::FULL_NAME, files);
    }
}

/// Google's two time messages have the same fields.
fn add_time_file(full_name: &str, files: &mut BTreeMap<String, FileDescriptorProto>) {
    let fields = vec![
        field("seconds", "1", Label::Optional, Type::Int64, ""),
        field("nanos", "2", Label::Optional, Type::Int32, ""),
    ];
    files.insert(file_name(full_name), file(full_name, fields, Vec::new()));
}

/// Reaches through `Option<M>` and `Vec<M>` to the message `M`, for the macro.
pub trait Field {
    /// The message within.
    type Message: Described;
}

impl<M: Described> Field for Option<M> {
    type Message = M;
}

impl<M: Described> Field for Vec<M> {
    type Message = M;
}

/// One field's descriptor from the tokens of its `#[prost(...)]`.
macro_rules! described_field {
    ($name:ident, $rust:ty; message, optional, tag = $n:literal) => {
        described_field!(@message $name, $rust, $n, Optional)
    };
    ($name:ident, $rust:ty; message, repeated, tag = $n:literal) => {
        described_field!(@message $name, $rust, $n, Repeated)
    };
    (@message $name:ident, $rust:ty, $n:literal, $label:ident) => {
        $crate::wire::describe::field(
            stringify!($name), $n,
            prost_types::field_descriptor_proto::Label::$label,
            prost_types::field_descriptor_proto::Type::Message,
            <<$rust as $crate::wire::describe::Field>::Message as $crate::wire::describe::Described>::FULL_NAME,
        )
    };
    ($name:ident, $rust:ty; enumeration($enum:ident), tag = $n:literal) => {
        $crate::wire::describe::field(
            stringify!($name), $n,
            prost_types::field_descriptor_proto::Label::Optional,
            prost_types::field_descriptor_proto::Type::Enum,
            <$enum as $crate::wire::describe::DescribedEnum>::FULL_NAME,
        )
    };
    ($name:ident, $rust:ty; bytes = "vec", tag = $n:literal) => {
        described_field!(@scalar $name, $n, Optional, bytes)
    };
    ($name:ident, $rust:ty; $kind:ident, repeated, tag = $n:literal) => {
        described_field!(@scalar $name, $n, Repeated, $kind)
    };
    ($name:ident, $rust:ty; $kind:ident, tag = $n:literal) => {
        described_field!(@scalar $name, $n, Optional, $kind)
    };
    (@scalar $name:ident, $n:literal, $label:ident, $kind:ident) => {
        $crate::wire::describe::field(
            stringify!($name), $n,
            prost_types::field_descriptor_proto::Label::$label,
            described_field!(@type $kind), "",
        )
    };
    (@type double) => { prost_types::field_descriptor_proto::Type::Double };
    (@type fixed64) => { prost_types::field_descriptor_proto::Type::Fixed64 };
    (@type fixed32) => { prost_types::field_descriptor_proto::Type::Fixed32 };
    (@type uint64) => { prost_types::field_descriptor_proto::Type::Uint64 };
    (@type uint32) => { prost_types::field_descriptor_proto::Type::Uint32 };
    (@type bool) => { prost_types::field_descriptor_proto::Type::Bool };
    (@type string) => { prost_types::field_descriptor_proto::Type::String };
    (@type bytes) => { prost_types::field_descriptor_proto::Type::Bytes };
}

/// Adds the files of a field's message, if it is one.
macro_rules! add_field_files {
    ($files:ident, $rust:ty; message, $($rest:tt)*) => {
        <<$rust as $crate::wire::describe::Field>::Message as $crate::wire::describe::Described>::add_files($files);
    };
    ($files:ident, $rust:ty; $($rest:tt)*) => {};
}

/// Messages of one package: ordinary `prost` structs and their nested enumerations, each with its full name.
macro_rules! messages {
    ($(
        $(#[doc = $doc:literal])*
        $full_name:literal: pub struct $message:ident {
            $(
                $(#[doc = $field_doc:literal])*
                #[prost($($prost:tt)*)]
                pub $field:ident: $rust:ty,
            )*
        }
        $(with {$(
            $(#[doc = $enum_doc:literal])*
            $enum_name:literal: pub enum $enum:ident {
                $(
                    $(#[doc = $value_doc:literal])*
                    $value:ident = $number:literal,
                )*
            }
        )*})?
    )*) => {$(
        $(#[doc = $doc])*
        #[derive(Clone, PartialEq, prost::Message)]
        pub struct $message {
            $(
                $(#[doc = $field_doc])*
                #[prost($($prost)*)]
                pub $field: $rust,
            )*
        }

        impl $crate::wire::describe::Described for $message {
            const FULL_NAME: &'static str = $full_name;

            fn add_files(
                files: &mut std::collections::BTreeMap<String, prost_types::FileDescriptorProto>,
            ) {
                let name = $crate::wire::describe::file_name($full_name);
                if files.contains_key(&name) {
                    return;
                }
                let fields = vec![$(described_field!($field, $rust; $($prost)*)),*];
                let enums =
                    vec![$($(<$enum as $crate::wire::describe::DescribedEnum>::describe()),*)?];
                files.insert(name, $crate::wire::describe::file($full_name, fields, enums));
                $(add_field_files!(files, $rust; $($prost)*);)*
            }
        }

        $($(
            $(#[doc = $enum_doc])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, prost::Enumeration)]
            #[repr(i32)]
            pub enum $enum {
                $(
                    $(#[doc = $value_doc])*
                    $value = $number,
                )*
            }

            impl $crate::wire::describe::DescribedEnum for $enum {
                const FULL_NAME: &'static str = $enum_name;

                fn describe() -> prost_types::EnumDescriptorProto {
                    $crate::wire::describe::enumeration(
                        $enum_name,
                        &[$((stringify!($value), $number)),*],
                    )
                }
            }
        )*)?
    )*};
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::foxglove::{PointCloud, SceneUpdate};
    use crate::wire::messages::{Applied, Gauge};

    fn decode<M: Described>() -> FileDescriptorSet {
        FileDescriptorSet::decode(schema::<M>().as_slice()).unwrap()
    }

    #[test]
    fn a_schema_describes_each_field_as_it_is_written() {
        let set = decode::<Gauge>();
        let file = set
            .file
            .iter()
            .find(|f| f.name() == "sandgate/Gauge.proto")
            .unwrap();
        assert_eq!(file.package(), "sandgate");
        assert_eq!(file.dependency, ["google/protobuf/timestamp.proto"]);
        let gauge = &file.message_type[0];
        let found: Vec<_> = gauge
            .field
            .iter()
            .map(|f| (f.name(), f.number(), f.r#type(), f.label()))
            .collect();
        assert_eq!(found[0], ("timestamp", 1, Type::Message, Label::Optional));
        assert_eq!(found[2], ("step", 3, Type::Uint64, Label::Optional));
        assert_eq!(found[6], ("values", 7, Type::Double, Label::Repeated));
        assert_eq!(found[7], ("validity", 8, Type::Enum, Label::Optional));
        assert_eq!(gauge.field[7].type_name(), ".sandgate.Gauge.Validity");
        let values: Vec<_> = gauge.enum_type[0].value.iter().map(|v| v.name()).collect();
        assert_eq!(values, ["VALID", "EMPTY", "OUTSIDE", "BLOCKED"]);
    }

    #[test]
    fn a_schema_holds_every_file_once_behind_those_it_needs() {
        for set in [
            decode::<SceneUpdate>(),
            decode::<Applied>(),
            decode::<PointCloud>(),
        ] {
            let names: Vec<_> = set.file.iter().map(|f| f.name()).collect();
            let mut once = names.clone();
            once.dedup();
            assert_eq!(names, once);
            for file in &set.file {
                let before = names.iter().take_while(|name| **name != file.name());
                let before: Vec<_> = before.collect();
                for needed in &file.dependency {
                    let stands = before.contains(&&needed.as_str());
                    assert!(stands, "{needed} is not before {}", file.name());
                }
                for field in &file.message_type[0].field {
                    assert!(field.number() > 0, "{}", field.name());
                }
            }
        }
    }

    #[test]
    fn value_names_are_in_upper_case_with_underscores() {
        assert_eq!(upper_snake("LineStrip"), "LINE_STRIP");
        assert_eq!(upper_snake("Uint8"), "UINT8");
    }
}
