//! What is where: particles and the cell grid over points. Knows nothing of how it is advanced.

mod cells;

pub use cells::CellGrid;
