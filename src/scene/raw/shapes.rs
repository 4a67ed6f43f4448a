//! Shapes that bodies and walls are made of.

use super::*;

table! {
    /// An axis-aligned box.
    RawBox {
        /// Lower corner.
        required lower: Coordinates<Length>;
        /// Upper corner.
        required upper: Coordinates<Length>;
    }
}

table! {
    /// An upright round column.
    RawColumn {
        /// Centre of its base.
        required base: Coordinates<Length>;
        /// Radius of the column.
        required radius: Length, in Range::above(0.0);
        /// Height along z.
        required height: Length, in Range::above(0.0);
        /// Only the quarter where x and y are beyond the base's centre, to stand in the corner of two free-slip planes.
        optional quarter: Flag, default false;
    }
}

table! {
    /// A circle.
    RawCircle {
        /// Its centre.
        required centre: Coordinates<Length>;
        /// Its radius.
        required radius: Length, in Range::above(0.0);
    }
}

table! {
    /// A plane.
    RawPlane {
        /// A point of the plane.
        required point: Coordinates<Length>;
        /// Normal towards the material, of any length.
        required normal: Coordinates<Ratio>;
    }
}
