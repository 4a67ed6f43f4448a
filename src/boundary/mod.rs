//! Rank 3: walls as rows of dummy particles that have a velocity but no unknowns of their own.
//!
//! A wall point counts twice in every pair sum and takes the volume, pressure and stress of the particle that sees it
//! (docs/theory.md, "Walls"): no distance to the wall is needed.

mod bends;
mod courses;
mod drive;
mod element;
mod ends;
mod flats;
mod joints;
mod mover;
mod piston;
mod plate;
mod points;
mod tips;
mod wall_points;

pub use bends::to_centres;
pub use drive::{Belt, Course, Drive, Steers};
pub use element::{Element, box_elements, plane_elements, polyline_elements};
pub use ends::{End, free_ends};
pub use flats::{Face, box_points, plane_points};
pub use joints::Joint;
pub use mover::{Mover, RigidMotion};
pub use piston::Piston;
pub use plate::{Meets, Plate};
pub use points::{ROWS, joined_points, polyline_points};
pub use tips::tip_points;
pub use wall_points::{GroupSpec, WallPoints};
