//! Gates: plates that slide before a gap.

use super::Lift;
use super::faces::{example_of_span, plate_places};
use super::geometry::Region;
use crate::boundary::ROWS;
use crate::math::{cross, length, normalized, sub};
use crate::scene::raw::{At, Entry, Place, RawGate};
use crate::scene::types::{Gate, Point};
use crate::units::shown_bound;

impl Lift<'_> {
    pub(super) fn gates(&mut self) -> Vec<Gate> {
        let raw = self.raw;
        let entries = Self::readable(raw.gates.as_ref());
        let lift = |(entry, gate)| self.gate(entry, gate);
        entries.into_iter().filter_map(lift).collect()
    }

    fn gate(&mut self, entry: &Entry<RawGate>, raw: &RawGate) -> Option<Gate> {
        let from = raw.from.as_ref().and_then(|p| self.point(p));
        let to = raw.to.as_ref().and_then(|p| self.point(p));
        let example = example_of_span(from, to, None);
        let span = self.span(raw.span.as_ref(), &raw.given, &entry.place, &example);
        let thickness = self.thickness(raw);
        let slip = self.slip(
            &entry.place,
            raw.slip.as_ref(),
            raw.wall_friction.as_ref(),
            &raw.given,
        );
        let (from, to, span, spacing) = (from?, to?, span?, self.spacing?);
        self.check_face(&entry.place, from, to, span);
        self.heights.extend([self.height(from), self.height(to)]);
        let gate = Gate {
            name: entry.name.clone(),
            from,
            to,
            span,
            thickness: thickness.unwrap_or(ROWS as f64 * spacing),
            max_speed: raw.max_speed.as_ref()?.value.0,
            start: raw.start.as_ref()?.value.0,
            slip: slip?,
        };
        if !self.planar() {
            let places = plate_places(&gate, spacing);
            self.space_plates.push((entry.place.clone(), places));
        } else if let Some(plate) = plate(&gate) {
            self.plates.push((entry.place.clone(), plate));
        }
        Some(gate)
    }

    /// At least four spacings, so that no particle sees through the plate, and no more than the domain can hold.
    fn thickness(&mut self, raw: &RawGate) -> Option<f64> {
        let at: &At<_> = raw.thickness.as_ref()?;
        let least = ROWS as f64 * self.spacing?;
        if at.value.0 < least * (1.0 - 1e-9) {
            self.problems.report(
                &at.place,
                format!("{} m", at.value.0),
                format!(
                    "at least {} m, four times numerics.spacing{}",
                    shown_bound(least),
                    self.of_quality()
                ),
                "thicken the gate, leave thickness out, or refine numerics.spacing",
            );
        }
        if let Some(domain) = &self.domain {
            let sides = (0..3).map(|k| domain.upper[k] - domain.lower[k]);
            let most = sides.fold(0.0, f64::max);
            if at.value.0 > most.max(least) {
                self.problems.report(
                    &at.place,
                    format!("{} m", at.value.0),
                    format!("at most {most} m, the longest side of the domain"),
                    "give the thickness of the plate, or leave it out",
                );
                return None;
            }
        }
        Some(at.value.0)
    }

    /// A face at least two spacings wide, and in space with two edges that are not parallel.
    pub(super) fn check_face(
        &mut self,
        place: &Place,
        from: Point,
        to: Point,
        span: Point,
    ) -> bool {
        let least = 2.0 * self.spacing.unwrap_or(0.0);
        let edge = sub(&to, &from);
        let across = cross(&edge, &span);
        let thin = if self.planar() {
            length(&edge)
        } else {
            let longest = length(&edge).max(length(&span));
            (length(&across) / longest).min(length(&edge))
        };
        // But for rounding: 0.0875 - 0.0375 is a little less than 0.05.
        let good = thin >= least * (1.0 - 1e-9) && thin > 0.0;
        if !good {
            self.problems.report(
                place,
                format!(
                    "a face {} m wide",
                    shown_bound(if thin.is_nan() { 0.0 } else { thin })
                ),
                format!(
                    "at least {} m, two spacings{}; in space span is not parallel to from - to",
                    shown_bound(least),
                    self.of_quality()
                ),
                "move from and to apart, or refine numerics.spacing",
            );
        }
        good
    }
}

/// The plate where it covers its gap at the start; `None` if it is open.
fn plate(gate: &Gate) -> Option<Region> {
    if gate.start >= 1.0 {
        return None;
    }
    let edge = sub(&gate.to, &gate.from);
    let [x, y, _] = normalized(&edge)?;
    // To the right of the way from `from` to `to`.
    let deep = [y * gate.thickness, -x * gate.thickness];
    let a = [
        gate.from[0] + gate.start * edge[0],
        gate.from[1] + gate.start * edge[1],
    ];
    let b = [gate.to[0], gate.to[1]];
    Some(Region::Polygon(vec![
        a,
        [a[0] + deep[0], a[1] + deep[1]],
        [b[0] + deep[0], b[1] + deep[1]],
        b,
    ]))
}
