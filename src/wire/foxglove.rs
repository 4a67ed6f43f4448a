//! Messages that viewers know: package `foxglove`, with the names, numbers and types of Foxglove's published
//! schemas (compared field by field with Foxglove's own package by tests/python/test_record.py).
//!
//! Positions are in frame `world`, SI units; planar scenes have z = 0. Here are lines of text, points, frames and what
//! all are made of; `scene` has the things drawn.

mod scene;

pub use scene::*;

messages! {
    /// A line for people.
    "foxglove.Log": pub struct Log {
        /// Simulated time.
        #[prost(message, optional, tag = "1")]
        pub timestamp: Option<prost_types::Timestamp>,
        /// How serious.
        #[prost(enumeration(LogLevel), tag = "2")]
        pub level: i32,
        /// The line.
        #[prost(string, tag = "3")]
        pub message: String,
        /// Which part of the program speaks.
        #[prost(string, tag = "4")]
        pub name: String,
        /// Source file, empty.
        #[prost(string, tag = "5")]
        pub file: String,
        /// Source line, 0.
        #[prost(fixed32, tag = "6")]
        pub line: u32,
    } with {
        /// How serious a line is.
        "foxglove.Log.Level": pub enum LogLevel {
            /// Not said.
            Unknown = 0,
            /// For developers.
            Debug = 1,
            /// For the record.
            Info = 2,
            /// Something to look at.
            Warning = 3,
            /// Something failed.
            Error = 4,
            /// The program ends.
            Fatal = 5,
        }
    }

    /// Particles, packed.
    "foxglove.PointCloud": pub struct PointCloud {
        /// Simulated time.
        #[prost(message, optional, tag = "1")]
        pub timestamp: Option<prost_types::Timestamp>,
        /// Frame of the positions.
        #[prost(string, tag = "2")]
        pub frame_id: String,
        /// Where the cloud's origin is in that frame.
        #[prost(message, optional, tag = "3")]
        pub pose: Option<Pose>,
        /// Bytes from point to point.
        #[prost(fixed32, tag = "4")]
        pub point_stride: u32,
        /// What the bytes of a point mean.
        #[prost(message, repeated, tag = "5")]
        pub fields: Vec<PackedElementField>,
        /// The points, little-endian.
        #[prost(bytes = "vec", tag = "6")]
        pub data: Vec<u8>,
    }

    /// One field of a packed point.
    "foxglove.PackedElementField": pub struct PackedElementField {
        /// Name.
        #[prost(string, tag = "1")]
        pub name: String,
        /// Offset from the start of the point in bytes.
        #[prost(fixed32, tag = "2")]
        pub offset: u32,
        /// Type of number.
        #[prost(enumeration(NumericType), tag = "3")]
        pub r#type: i32,
    } with {
        /// Type of a packed number.
        "foxglove.PackedElementField.NumericType": pub enum NumericType {
            /// Not said.
            Unknown = 0,
            /// u8
            Uint8 = 1,
            /// i8
            Int8 = 2,
            /// u16
            Uint16 = 3,
            /// i16
            Int16 = 4,
            /// u32
            Uint32 = 5,
            /// i32
            Int32 = 6,
            /// f32
            Float32 = 7,
            /// f64
            Float64 = 8,
        }
    }

    /// Position and orientation.
    "foxglove.Pose": pub struct Pose {
        /// Position [m].
        #[prost(message, optional, tag = "1")]
        pub position: Option<Vector3>,
        /// Orientation.
        #[prost(message, optional, tag = "2")]
        pub orientation: Option<Quaternion>,
    }

    /// A vector.
    "foxglove.Vector3": pub struct Vector3 {
        /// x
        #[prost(double, tag = "1")]
        pub x: f64,
        /// y
        #[prost(double, tag = "2")]
        pub y: f64,
        /// z
        #[prost(double, tag = "3")]
        pub z: f64,
    }

    /// A point [m].
    "foxglove.Point3": pub struct Point3 {
        /// x
        #[prost(double, tag = "1")]
        pub x: f64,
        /// y
        #[prost(double, tag = "2")]
        pub y: f64,
        /// z
        #[prost(double, tag = "3")]
        pub z: f64,
    }

    /// A rotation.
    "foxglove.Quaternion": pub struct Quaternion {
        /// x
        #[prost(double, tag = "1")]
        pub x: f64,
        /// y
        #[prost(double, tag = "2")]
        pub y: f64,
        /// z
        #[prost(double, tag = "3")]
        pub z: f64,
        /// w
        #[prost(double, tag = "4")]
        pub w: f64,
    }

    /// A colour, 0 to 1.
    "foxglove.Color": pub struct Color {
        /// Red.
        #[prost(double, tag = "1")]
        pub r: f64,
        /// Green.
        #[prost(double, tag = "2")]
        pub g: f64,
        /// Blue.
        #[prost(double, tag = "3")]
        pub b: f64,
        /// Opacity.
        #[prost(double, tag = "4")]
        pub a: f64,
    }

    /// Where a frame is in its parent.
    "foxglove.FrameTransform": pub struct FrameTransform {
        /// Simulated time.
        #[prost(message, optional, tag = "1")]
        pub timestamp: Option<prost_types::Timestamp>,
        /// Parent.
        #[prost(string, tag = "2")]
        pub parent_frame_id: String,
        /// The frame.
        #[prost(string, tag = "3")]
        pub child_frame_id: String,
        /// Position of the frame's origin in the parent [m].
        #[prost(message, optional, tag = "4")]
        pub translation: Option<Vector3>,
        /// Orientation of the frame in the parent.
        #[prost(message, optional, tag = "5")]
        pub rotation: Option<Quaternion>,
    }
}
