//! Tables of what is there at the start.

use super::*;

table! {
    /// Material that is there at the start. Exactly one of box, polygon, circle and column says where.
    RawBody {
        /// Name of its material.
        required material: Text;
        /// An axis-aligned box.
        optional r#box: RawBox;
        /// Planar: corners of a simple polygon, in order.
        optional polygon: List<Coordinates<Length>>;
        /// Planar: a disc.
        optional circle: RawCircle;
        /// Space: an upright round column.
        optional column: RawColumn;
        /// Fills the shape only below this height: a reservoir filled to a level.
        optional level: Length;
        /// Velocity at the start.
        optional velocity: Coordinates<Speed>;
        /// Rate of turning about `centre` at the start, added to velocity: anticlockwise in the plane, in space right-handed about `axis`; not in axisymmetric scenes.
        optional angular_velocity: AngularSpeed;
        /// Centre of that rotation.
        optional centre: Coordinates<Length>;
        /// In space: axis of that rotation, of any length.
        optional axis: Coordinates<Ratio>;
        /// A layer on a slope that starts in steady flow; only for a box whose lower side lies on the bed.
        optional velocity_profile: ProfileWord;
    }
}

choice! {
    /// Velocity over the height of a layer.
    ProfileWord {
        /// Bagnold's profile of steady flow, added to velocity, with its density and shear rate
        "bagnold" => Bagnold,
    }
}
