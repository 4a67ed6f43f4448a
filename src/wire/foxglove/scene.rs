//! Things drawn in a scene: entities and what they are made of.

use super::{Color, Point3, Pose, Vector3};

messages! {
    /// Changes of the things drawn.
    "foxglove.SceneUpdate": pub struct SceneUpdate {
        /// Things to take away.
        #[prost(message, repeated, tag = "1")]
        pub deletions: Vec<SceneEntityDeletion>,
        /// Things to add or replace.
        #[prost(message, repeated, tag = "2")]
        pub entities: Vec<SceneEntity>,
    }

    /// Things to take away.
    "foxglove.SceneEntityDeletion": pub struct SceneEntityDeletion {
        /// Simulated time.
        #[prost(message, optional, tag = "1")]
        pub timestamp: Option<prost_types::Timestamp>,
        /// Which.
        #[prost(enumeration(SceneEntityDeletionType), tag = "2")]
        pub r#type: i32,
        /// Identifier.
        #[prost(string, tag = "3")]
        pub id: String,
    } with {
        /// What is taken away.
        "foxglove.SceneEntityDeletion.Type": pub enum SceneEntityDeletionType {
            /// The entity with this identifier.
            MatchingId = 0,
            /// All entities.
            All = 1,
        }
    }

    /// A thing drawn: everything of it moves with its frame.
    "foxglove.SceneEntity": pub struct SceneEntity {
        /// Simulated time.
        #[prost(message, optional, tag = "1")]
        pub timestamp: Option<prost_types::Timestamp>,
        /// Its frame.
        #[prost(string, tag = "2")]
        pub frame_id: String,
        /// Identifier: a later entity with the same one replaces it.
        #[prost(string, tag = "3")]
        pub id: String,
        /// How long it stays; absent or zero: for good.
        #[prost(message, optional, tag = "4")]
        pub lifetime: Option<prost_types::Duration>,
        /// Whether it moves with its frame after it was drawn.
        #[prost(bool, tag = "5")]
        pub frame_locked: bool,
        /// What is known about it.
        #[prost(message, repeated, tag = "6")]
        pub metadata: Vec<KeyValuePair>,
        /// Arrows.
        #[prost(message, repeated, tag = "7")]
        pub arrows: Vec<ArrowPrimitive>,
        /// Boxes.
        #[prost(message, repeated, tag = "8")]
        pub cubes: Vec<CubePrimitive>,
        /// Balls.
        #[prost(message, repeated, tag = "9")]
        pub spheres: Vec<SpherePrimitive>,
        /// Cylinders.
        #[prost(message, repeated, tag = "10")]
        pub cylinders: Vec<CylinderPrimitive>,
        /// Lines.
        #[prost(message, repeated, tag = "11")]
        pub lines: Vec<LinePrimitive>,
        /// Triangles.
        #[prost(message, repeated, tag = "12")]
        pub triangles: Vec<TriangleListPrimitive>,
        /// Texts.
        #[prost(message, repeated, tag = "13")]
        pub texts: Vec<TextPrimitive>,
        /// Models.
        #[prost(message, repeated, tag = "14")]
        pub models: Vec<ModelPrimitive>,
    }

    /// A name and a text.
    "foxglove.KeyValuePair": pub struct KeyValuePair {
        /// Name.
        #[prost(string, tag = "1")]
        pub key: String,
        /// Text.
        #[prost(string, tag = "2")]
        pub value: String,
    }

    /// An arrow along x.
    "foxglove.ArrowPrimitive": pub struct ArrowPrimitive {
        /// Where its tail is.
        #[prost(message, optional, tag = "1")]
        pub pose: Option<Pose>,
        /// Length of the shaft [m].
        #[prost(double, tag = "2")]
        pub shaft_length: f64,
        /// Diameter of the shaft [m].
        #[prost(double, tag = "3")]
        pub shaft_diameter: f64,
        /// Length of the head [m].
        #[prost(double, tag = "4")]
        pub head_length: f64,
        /// Diameter of the head [m].
        #[prost(double, tag = "5")]
        pub head_diameter: f64,
        /// Colour.
        #[prost(message, optional, tag = "6")]
        pub color: Option<Color>,
    }

    /// A box.
    "foxglove.CubePrimitive": pub struct CubePrimitive {
        /// Where its centre is.
        #[prost(message, optional, tag = "1")]
        pub pose: Option<Pose>,
        /// Edges [m].
        #[prost(message, optional, tag = "2")]
        pub size: Option<Vector3>,
        /// Colour.
        #[prost(message, optional, tag = "3")]
        pub color: Option<Color>,
    }

    /// A ball.
    "foxglove.SpherePrimitive": pub struct SpherePrimitive {
        /// Where its centre is.
        #[prost(message, optional, tag = "1")]
        pub pose: Option<Pose>,
        /// Diameters [m].
        #[prost(message, optional, tag = "2")]
        pub size: Option<Vector3>,
        /// Colour.
        #[prost(message, optional, tag = "3")]
        pub color: Option<Color>,
    }

    /// A cylinder along z.
    "foxglove.CylinderPrimitive": pub struct CylinderPrimitive {
        /// Where its centre is.
        #[prost(message, optional, tag = "1")]
        pub pose: Option<Pose>,
        /// Diameters and height [m].
        #[prost(message, optional, tag = "2")]
        pub size: Option<Vector3>,
        /// Scale of the lower face.
        #[prost(double, tag = "3")]
        pub bottom_scale: f64,
        /// Scale of the upper face.
        #[prost(double, tag = "4")]
        pub top_scale: f64,
        /// Colour.
        #[prost(message, optional, tag = "5")]
        pub color: Option<Color>,
    }

    /// A line through points.
    "foxglove.LinePrimitive": pub struct LinePrimitive {
        /// How the points are joined.
        #[prost(enumeration(LineType), tag = "1")]
        pub r#type: i32,
        /// Where its origin is.
        #[prost(message, optional, tag = "2")]
        pub pose: Option<Pose>,
        /// Thickness [m], or in pixels if `scale_invariant`.
        #[prost(double, tag = "3")]
        pub thickness: f64,
        /// Whether the thickness is in pixels.
        #[prost(bool, tag = "4")]
        pub scale_invariant: bool,
        /// Points [m].
        #[prost(message, repeated, tag = "5")]
        pub points: Vec<Point3>,
        /// Colour of all.
        #[prost(message, optional, tag = "6")]
        pub color: Option<Color>,
        /// Colour of each point.
        #[prost(message, repeated, tag = "7")]
        pub colors: Vec<Color>,
        /// Order of the points, if not as they stand.
        #[prost(fixed32, repeated, tag = "8")]
        pub indices: Vec<u32>,
    } with {
        /// How points are joined.
        "foxglove.LinePrimitive.Type": pub enum LineType {
            /// 0-1, 1-2, ...
            LineStrip = 0,
            /// As LineStrip, and the last to the first.
            LineLoop = 1,
            /// 0-1, 2-3, ...
            LineList = 2,
        }
    }

    /// Triangles.
    "foxglove.TriangleListPrimitive": pub struct TriangleListPrimitive {
        /// Where their origin is.
        #[prost(message, optional, tag = "1")]
        pub pose: Option<Pose>,
        /// Corners, three a triangle [m].
        #[prost(message, repeated, tag = "2")]
        pub points: Vec<Point3>,
        /// Colour of all.
        #[prost(message, optional, tag = "3")]
        pub color: Option<Color>,
        /// Colour of each corner.
        #[prost(message, repeated, tag = "4")]
        pub colors: Vec<Color>,
        /// Order of the corners, if not as they stand.
        #[prost(fixed32, repeated, tag = "5")]
        pub indices: Vec<u32>,
    }

    /// A text.
    "foxglove.TextPrimitive": pub struct TextPrimitive {
        /// Where its centre is.
        #[prost(message, optional, tag = "1")]
        pub pose: Option<Pose>,
        /// Whether it turns to the viewer.
        #[prost(bool, tag = "2")]
        pub billboard: bool,
        /// Height [m], or in pixels if `scale_invariant`.
        #[prost(double, tag = "3")]
        pub font_size: f64,
        /// Whether the height is in pixels.
        #[prost(bool, tag = "4")]
        pub scale_invariant: bool,
        /// Colour.
        #[prost(message, optional, tag = "5")]
        pub color: Option<Color>,
        /// The text.
        #[prost(string, tag = "6")]
        pub text: String,
    }

    /// A model from a file.
    "foxglove.ModelPrimitive": pub struct ModelPrimitive {
        /// Where its origin is.
        #[prost(message, optional, tag = "1")]
        pub pose: Option<Pose>,
        /// Scale.
        #[prost(message, optional, tag = "2")]
        pub scale: Option<Vector3>,
        /// Colour, if it replaces the model's.
        #[prost(message, optional, tag = "3")]
        pub color: Option<Color>,
        /// Whether it does.
        #[prost(bool, tag = "4")]
        pub override_color: bool,
        /// Where the model is.
        #[prost(string, tag = "5")]
        pub url: String,
        /// Its type.
        #[prost(string, tag = "6")]
        pub media_type: String,
        /// The model itself.
        #[prost(bytes = "vec", tag = "7")]
        pub data: Vec<u8>,
    }
}
