//! What gauges see: particles, wall particles and the box they are in. Borrowed for one sampling.

use super::Solid;
use crate::kernel::WendlandC2;
use crate::math::Geometry;
use crate::state::CellGrid;

/// Spacings behind a face up to which a place counts as on it: scenes give feet and faces to a few digits.
const SLACK: f64 = 1e-3;

/// Particles and walls at one time. All slices have one entry a particle.
#[derive(Clone, Copy, Debug)]
pub struct View<'a, const D: usize> {
    /// Positions [m].
    pub position: &'a [[f64; D]],
    /// Masses [kg], for the whole width of a planar scene, of whole rings in an axisymmetric one.
    pub mass: &'a [f64],
    /// Bulk densities [kg/m^3].
    pub density: &'a [f64],
    /// Pressures [Pa].
    pub pressure: &'a [f64],
    /// Velocities [m/s]; empty where no gauge reads them.
    pub velocity: &'a [[f64; D]],
    /// The grid over `position`.
    pub cells: &'a CellGrid<D>,
    /// The grid over wall and gate particles, one each spacing^D of solid; may be empty.
    pub solid: &'a CellGrid<D>,
    /// The same walls and gates by their surfaces.
    pub solids: &'a [Solid<D>],
    /// Particle spacing dp [m].
    pub spacing: f64,
    /// The kernel of the simulation.
    pub kernel: WendlandC2<D>,
    /// What coordinates stand for.
    pub geometry: Geometry,
    /// Lower corner of the domain [m].
    pub lower: [f64; D],
    /// Upper corner of the domain [m].
    pub upper: [f64; D],
    /// Which axes are periodic.
    pub periodic: [bool; D],
}

impl<const D: usize> View<'_, D> {
    /// Whether a place is outside the domain (never along periodic axes).
    #[must_use]
    pub fn is_outside(&self, at: &[f64; D]) -> bool {
        is_outside(at, (&self.lower, &self.upper), &self.periodic)
    }

    /// Volume of particle `i` [m^D]: of rings the area of their section.
    #[must_use]
    pub fn volume(&self, i: usize) -> f64 {
        let least = Geometry::LEAST_RADIUS * self.spacing;
        let across = self.geometry.length_across(&self.position[i], least);
        self.mass[i] / (self.density[i] * across)
    }

    /// Calls `visit` with index, place [m] and distance [m] of all points of a grid within the kernel's support of a
    /// place, then of the images of rings across the axis.
    fn for_each_near(
        &self,
        cells: &CellGrid<D>,
        at: &[f64; D],
        mut visit: impl FnMut(usize, [f64; D], f64),
    ) {
        let support = self.kernel.support();
        cells.for_each_within(at, support, &mut visit);
        if self.has_images(at, support) {
            cells.for_each_within(&mirror(*at), support, |j, x, r| visit(j, mirror(x), r));
        }
    }

    /// Whether rings may have images across the axis within `radius` [m] of a place.
    pub(super) fn has_images(&self, at: &[f64; D], radius: f64) -> bool {
        self.geometry.is_axisymmetric() && at[0] < radius
    }

    /// Calls `visit` with index, place [m] and distance [m] of every particle within the kernel's support of a place, a
    /// ring's image across the axis included.
    pub fn for_each_particle(&self, at: &[f64; D], visit: impl FnMut(usize, [f64; D], f64)) {
        self.for_each_near(self.cells, at, visit);
    }

    /// Whether a place is behind the surface of a wall or gate.
    #[must_use]
    pub fn is_inside(&self, at: &[f64; D]) -> bool {
        let mut at = *at;
        for a in (0..D).filter(|&a| self.periodic[a]) {
            at[a] =
                self.lower[a] + (at[a] - self.lower[a]).rem_euclid(self.upper[a] - self.lower[a]);
        }
        let slack = SLACK * self.spacing;
        self.solids.iter().any(|solid| solid.holds(&at, slack))
    }

    /// Whether a place is amid the particles of a wall or gate, most of a spacing behind its face.
    ///
    /// Walls are lattices of points, their faces half a spacing before the first row. In a corner of three walls
    /// the sum over solid reaches 7/8 on the face itself, hence 0.9.
    #[must_use]
    pub fn is_covered(&self, at: &[f64; D]) -> bool {
        let (sum, nearest) = self.solid_around(at);
        sum > 0.9 || nearest < 0.45 * self.spacing
    }

    /// Sum of V W over the particles of walls and gates around a place, and the distance of the nearest [m].
    pub(super) fn solid_around(&self, at: &[f64; D]) -> (f64, f64) {
        let volume = self.spacing.powi(D as i32);
        let (mut sum, mut nearest) = (0.0, f64::INFINITY);
        self.for_each_near(self.solid, at, |_, _, r| {
            sum += volume * self.kernel.w(r);
            nearest = f64::min(nearest, r);
        });
        (sum, nearest)
    }
}

/// The place across the axis of rings.
pub(super) fn mirror<const D: usize>(mut x: [f64; D]) -> [f64; D] {
    x[0] = -x[0];
    x
}

/// Whether a place is outside the domain from `lower` to `upper` (never along periodic axes).
#[must_use]
pub fn is_outside<const D: usize>(
    at: &[f64; D],
    (lower, upper): (&[f64; D], &[f64; D]),
    periodic: &[bool; D],
) -> bool {
    (0..D).any(|a| {
        // Places on the rim belong to the domain, rounding included.
        let slack = 1e-9 * (upper[a] - lower[a]);
        !periodic[a] && !(lower[a] - slack..=upper[a] + slack).contains(&at[a])
    })
}

#[cfg(test)]
pub(super) mod bed {
    //! Level beds of known height for the gauges' closed-form tests.

    use super::*;

    /// A level bed on a wall four rows deep, axis 1 upwards, periodic along the others.
    pub(in crate::gauge) struct Bed<const D: usize> {
        pub(in crate::gauge) spacing: f64,
        ratio: f64,
        rows: usize,
        columns: usize,
        position: Vec<[f64; D]>,
        solid: Vec<[f64; D]>,
        solids: Vec<Solid<D>>,
        periodic: bool,
    }

    impl<const D: usize> Bed<D> {
        /// `rows` rows at h/dp `ratio`, moved at random by up to `jitter` dp along each axis.
        pub(in crate::gauge) fn new(ratio: f64, rows: usize, jitter: f64) -> Self {
            let columns = if D == 2 { 40 } else { 14 };
            let spacing = 0.01;
            let mut noise = 0.0_f64;
            let position = lattice(columns, 0, rows as i32, spacing, &mut |x| {
                noise = (noise + 0.618_033_988_749_895 + 0.1 * x).fract();
                x + jitter * spacing * (2.0 * noise - 1.0)
            });
            let solid = lattice(columns, -4, 0, spacing, &mut |x| x);
            let floor = Solid::Behind {
                point: [0.0; D],
                normal: std::array::from_fn(|k| f64::from(u8::from(k == 1))),
            };
            Self {
                solids: vec![floor],
                spacing,
                ratio,
                rows,
                columns,
                position,
                solid,
                periodic: true,
            }
        }

        /// A bed with a wall at x = 0, ten rows higher.
        pub(in crate::gauge) fn with_side_wall(ratio: f64, rows: usize) -> Self {
            let mut bed = Self::new(ratio, rows, 0.0);
            bed.periodic = false;
            let wall: Vec<[f64; D]> = lattice(4, -4, rows as i32 + 10, bed.spacing, &mut |x| x);
            bed.solid.extend(wall.into_iter().map(|mut x| {
                x[0] -= 4.0 * bed.spacing;
                x
            }));
            bed.solids.push(Solid::Behind {
                point: [0.0; D],
                normal: std::array::from_fn(|k| f64::from(u8::from(k == 0))),
            });
            bed
        }

        /// With a lid that touches it, four rows deep.
        pub(in crate::gauge) fn with_lid(mut self) -> Self {
            let (rows, height) = (self.rows as i32, self.height());
            let lid: Vec<[f64; D]> =
                lattice(self.columns, rows, rows + 4, self.spacing, &mut |x| x);
            self.solid.extend(lid);
            self.solids.push(Solid::Behind {
                point: [height; D],
                normal: std::array::from_fn(|k| -f64::from(u8::from(k == 1))),
            });
            self
        }

        /// Only the particles that satisfy `predicate`.
        pub(in crate::gauge) fn keep(mut self, predicate: impl Fn(&[f64; D]) -> bool) -> Self {
            self.position.retain(predicate);
            self
        }

        pub(in crate::gauge) fn height(&self) -> f64 {
            self.rows as f64 * self.spacing
        }

        pub(in crate::gauge) fn length(&self) -> f64 {
            self.columns as f64 * self.spacing
        }

        /// Pressure of the bed at rest at height `y` [Pa].
        pub(in crate::gauge) fn pressure_at(&self, y: f64) -> f64 {
            1500.0 * 9.81 * (self.height() - y)
        }

        /// Shows the bed to a gauge.
        pub(in crate::gauge) fn look<T>(&self, gauge: impl Fn(&View<D>) -> T) -> T {
            let kernel = WendlandC2::new(self.ratio * self.spacing);
            let length = self.length();
            let periodic: [bool; D] = std::array::from_fn(|a| a != 1 && self.periodic);
            let periods = periodic.map(|p| p.then_some((0.0, length)));
            let geometry = if D == 2 {
                Geometry::Planar { width: 0.3 }
            } else {
                Geometry::Space
            };
            let count = self.position.len();
            let pressure: Vec<f64> = self
                .position
                .iter()
                .map(|x| self.pressure_at(x[1]))
                .collect();
            // (3 + 2 y, x, 0).
            let flow = |x: &[f64; D]| {
                std::array::from_fn(|a| match a {
                    0 => 3.0 + 2.0 * x[1],
                    1 => x[0],
                    _ => 0.0,
                })
            };
            let velocity: Vec<[f64; D]> = self.position.iter().map(flow).collect();
            let upper = std::array::from_fn(|a| if a == 1 { 1.0 } else { length });
            let lower = std::array::from_fn(|a| if a == 1 { -0.05 } else { 0.0 });
            gauge(&View {
                position: &self.position,
                mass: &vec![1500.0 * geometry.width() * self.spacing.powi(D as i32); count],
                density: &vec![1500.0; count],
                pressure: &pressure,
                velocity: &velocity,
                cells: &CellGrid::build(&self.position, kernel.support(), &periods),
                solid: &CellGrid::build(&self.solid, kernel.support(), &periods),
                solids: &self.solids,
                spacing: self.spacing,
                kernel,
                geometry,
                lower,
                upper,
                periodic,
            })
        }
    }

    /// Cell centres of `columns` columns along all axes but 1, rows `from` to `to` along axis 1.
    fn lattice<const D: usize>(
        columns: usize,
        from: i32,
        to: i32,
        spacing: f64,
        place: &mut dyn FnMut(f64) -> f64,
    ) -> Vec<[f64; D]> {
        let depth = if D == 2 { 1 } else { columns };
        let mut points = Vec::new();
        for z in 0..depth {
            for y in from..to {
                for x in 0..columns {
                    let cell = [x as f64, f64::from(y), z as f64];
                    points.push(std::array::from_fn(|a| place((cell[a] + 0.5) * spacing)));
                }
            }
        }
        points
    }
}
