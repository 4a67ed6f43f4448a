//! Inflows and outflows.

use super::Lift;
use super::faces::{Face, example_of_span};
use super::geometry::Region;
use crate::math::{cross, dot, length, normalized, sub};
use crate::scene::raw::{Entry, Place, RawInflow, RawOutflow};
use crate::scene::types::{Inflow, NamedMaterial, Outflow, OutflowPlace, Point};

/// How far above its bound a number may be by rounding, over the bound [1].
const ROUNDING: f64 = 1e-9;

impl Lift<'_> {
    /// One for each `[inflows.NAME]` that is right.
    pub(super) fn inflows(&mut self, materials: &[Option<NamedMaterial>]) -> Vec<Inflow> {
        let raw = self.raw;
        let entries = Self::readable(raw.inflows.as_ref());
        let lift = |(entry, inflow)| self.inflow(entry, inflow, materials);
        entries.into_iter().filter_map(lift).collect()
    }

    fn inflow(
        &mut self,
        entry: &Entry<RawInflow>,
        raw: &RawInflow,
        materials: &[Option<NamedMaterial>],
    ) -> Option<Inflow> {
        let material = raw.material.as_ref().and_then(|name| {
            let known = self.raw.materials.as_ref();
            self.index_of(&name.value.0, &name.place, "materials", known)
        });
        let from = raw.from.as_ref().and_then(|p| self.point(p));
        let to = raw.to.as_ref().and_then(|p| self.point(p));
        let velocity = raw.velocity.as_ref().and_then(|v| self.vector(v));
        let example = example_of_span(from, to, velocity);
        let span = self.span(raw.span.as_ref(), &raw.given, &entry.place, &example);
        let (from, to, span) = (from?, to?, span?);
        if !self.check_face(&entry.place, from, to, span) {
            return None;
        }
        let flux = self.check_inflow_direction(raw, from, to, span, velocity?)?;
        if let (Some(way), Some(spacing)) = (normalized(&velocity?), self.spacing) {
            let face = Face::new([from, to, span], way, spacing);
            self.check_inflow_against_walls(&entry.place, &face);
            self.check_rows_inside(&entry.place, &face);
        }
        let density = Self::rest_density(materials, material?)?;
        let width = if self.axisymmetric() {
            std::f64::consts::PI * (from[0] + to[0])
        } else {
            self.domain.as_ref()?.width
        };
        let inflow = Inflow {
            name: entry.name.clone(),
            material: material?,
            from,
            to,
            span,
            velocity: velocity?,
            rate: self.inflow_rate(raw, density * width * flux)?,
            max_rate: density * width * flux,
        };
        Some(inflow)
    }

    /// Rows appear inside the domain.
    fn check_rows_inside(&mut self, place: &Place, face: &Face) {
        let Some(domain) = &self.domain else {
            return;
        };
        let outside = |x: &Point, k: usize| {
            !domain.periodic[k] && !(domain.lower[k]..=domain.upper[k]).contains(&x[k])
        };
        let axes = self.axes();
        let row = face.row();
        let lost = row.flat_map(|x| (0..axes).map(move |k| (x, k)));
        if let Some((x, k)) = lost.into_iter().find(|(x, k)| outside(x, *k)) {
            let name = Self::axis_name(k);
            self.problems.report(
                place,
                format!("a row of particles at {name} = {:.6} m", x[k]),
                format!("rows, half a spacing before the face, at {name} from {} to {} m, the domain", domain.lower[k], domain.upper[k]),
                "move the face and its span into the domain, turn the velocity, or enlarge domain.lower and domain.upper",
            );
        }
    }

    /// Material leaves the face on its left; gives face times normal velocity [m^2/s] or [m^3/s].
    fn check_inflow_direction(
        &mut self,
        raw: &RawInflow,
        from: Point,
        to: Point,
        span: Point,
        velocity: Point,
    ) -> Option<f64> {
        let edge = sub(&to, &from);
        let area = if self.planar() {
            [-edge[1], edge[0], 0.0]
        } else {
            cross(&edge, &span)
        };
        let flux = dot(&area, &velocity);
        if flux > 1e-6 * length(&area) * length(&velocity) {
            return Some(flux);
        }
        let out = format!("write for example {}", self.example_of_velocity(area));
        let (found, remedy) = if flux < -1e-6 * length(&area) * length(&velocity) {
            let turn = "reverse the velocity, or swap from and to".to_owned();
            ("a velocity that points into the face", turn)
        } else if length(&velocity) > 0.0 {
            ("a velocity along the face", out)
        } else {
            ("a velocity of 0", out)
        };
        self.problems.report(
            &raw.velocity.as_ref()?.place,
            found,
            "a velocity to the left of the way from `from` to `to` (in space: along (to - from) x span)",
            remedy,
        );
        None
    }

    /// A velocity straight out of a face, whose normal this is.
    fn example_of_velocity(&self, normal: Point) -> String {
        let unit = normalized(&normal).unwrap_or([1.0, 0.0, 0.0]);
        // Half a metre a second, to millimetres, and without the sign of a zero.
        let values = unit.map(|c| (0.5e3 * c).round() / 1e3 + 0.0);
        let values: Vec<String> = values[..self.axes()].iter().map(f64::to_string).collect();
        format!("velocity = [{}]", values.join(", "))
    }

    fn inflow_rate(&mut self, raw: &RawInflow, most: f64) -> Option<f64> {
        let rate = raw.rate.as_ref()?;
        let taken = up_to(most, rate.value.0);
        if taken.is_none() {
            self.problems.report(
                &rate.place,
                format!("{} kg/s", rate.value.0),
                format!("at most {most} kg/s: density at rest x face x velocity"),
                "lower the rate, widen the face or raise the velocity",
            );
        }
        taken
    }

    pub(super) fn outflows(&mut self) -> Vec<Outflow> {
        let raw = self.raw;
        let entries = Self::readable(raw.outflows.as_ref());
        let lift = |(entry, outflow)| self.outflow(entry, outflow);
        entries.into_iter().filter_map(lift).collect()
    }

    fn outflow(&mut self, entry: &Entry<RawOutflow>, raw: &RawOutflow) -> Option<Outflow> {
        if let Some(outside) = raw.outside.as_ref().filter(|at| at.value.0) {
            return self.outside(&outside.place, entry, raw);
        }
        if raw.outside.is_none() && raw.given.contains(&"outside") {
            return None;
        }
        for key in ["lower", "upper"] {
            if !raw.given.contains(&key) {
                self.problems.report(
                    &entry.place,
                    format!("an outflow without {key}"),
                    "lower and upper, the corners of a box, or outside = true",
                    if self.planar() {
                        "add for example lower = [0, -0.1] and upper = [1, 0]"
                    } else {
                        "add for example lower = [0, 0, -0.1] and upper = [1, 1, 0]"
                    },
                );
            }
        }
        let (lower, upper) = self.corners(raw.lower.as_ref(), raw.upper.as_ref())?;
        self.check_inside(&raw.lower.as_ref()?.place, lower);
        self.check_inside(&raw.upper.as_ref()?.place, upper);
        let region = Region::block(self.planar(), lower, upper);
        let eps = self.eps();
        if let Some((other, _)) = self.drains.iter().find(|(_, r)| r.overlaps(&region, eps)) {
            let found = format!("overlaps {}", other.key);
            self.problems.report(
                &entry.place,
                found,
                "outflows that touch at most, so that each particle is counted once",
                "move or shrink one of them",
            );
        }
        self.drains.push((entry.place.clone(), region));
        Some(Outflow {
            name: entry.name.clone(),
            place: OutflowPlace::Box { lower, upper },
        })
    }

    /// The outflow of all that leaves the domain: the only one, and no box.
    fn outside(
        &mut self,
        place: &Place,
        entry: &Entry<RawOutflow>,
        raw: &RawOutflow,
    ) -> Option<Outflow> {
        for corner in [&raw.lower, &raw.upper].into_iter().flatten() {
            self.problems.report(
                &corner.place,
                "a corner of an outflow with outside = true",
                "lower and upper, or outside = true",
                "delete it, or make two outflows of it",
            );
        }
        let others = Self::readable(self.raw.outflows.as_ref()).into_iter();
        let mut before = others.take_while(|(other, _)| other.name != entry.name);
        if before.any(|(_, other)| other.outside.as_ref().is_some_and(|at| at.value.0)) {
            self.problems.report(
                place,
                "a second outflow with outside = true",
                "one at most, so that each particle is counted once",
                "delete one of them",
            );
        }
        Some(Outflow {
            name: entry.name.clone(),
            place: OutflowPlace::Outside,
        })
    }
}

/// `value`, if it is at most `most`; above by rounding counts as `most`, which people write as a product of their own.
pub(super) fn up_to(most: f64, value: f64) -> Option<f64> {
    (value <= most * (1.0 + ROUNDING)).then(|| value.min(most))
}
