//! Gauges.

use super::Lift;
use super::faces::example_of_span;
use super::full_names::full_names;
use crate::math::{dot, length, sub};
use crate::scene::raw::{
    At, Coordinates, Entry, Length, Place, Ratio, RawFront, RawGauge, RawProfile, SchemeWord,
};
use crate::scene::types::{ForceTarget, Gauge, GaugeKind, Point};

type Up<'a> = Option<&'a At<Coordinates<Ratio>>>;

impl Lift<'_> {
    pub(super) fn gauges(&mut self) -> Vec<Gauge> {
        let raw = self.raw;
        let entries = Self::readable(raw.gauges.as_ref());
        let lift = |(entry, gauge): (&Entry<RawGauge>, &RawGauge)| {
            Some(Gauge {
                name: entry.name.clone(),
                kind: self.gauge(entry, gauge)?,
                material: self.seen_material(gauge)?,
            })
        };
        entries.into_iter().filter_map(lift).collect()
    }

    fn gauge(&mut self, entry: &Entry<RawGauge>, raw: &RawGauge) -> Option<GaugeKind> {
        match raw {
            RawGauge::Depth(raw) => {
                let (foot, up, length) = self.line(&raw.foot, &raw.up, &raw.length)?;
                Some(GaugeKind::Depth { foot, up, length })
            }
            RawGauge::InterfaceStress(raw) => {
                let (foot, up, length) = self.line(&raw.foot, &raw.up, &raw.length)?;
                Some(GaugeKind::InterfaceStress { foot, up, length })
            }
            RawGauge::Profile(raw) => self.profile(&entry.place, raw),
            RawGauge::Discharge(raw) => {
                let from = raw.from.as_ref().and_then(|p| self.point(p));
                let to = raw.to.as_ref().and_then(|p| self.point(p));
                let example = example_of_span(from, to, None);
                let span = self.span(raw.span.as_ref(), &raw.given, &entry.place, &example);
                let (from, to, span) = (from?, to?, span?);
                self.check_face(&entry.place, from, to, span);
                Some(GaugeKind::Discharge { from, to, span })
            }
            RawGauge::Force(raw) => {
                let on = raw.on.as_ref()?;
                let on = self.force_target(&on.value.0, &on.place)?;
                let about = match &raw.about {
                    None => None,
                    Some(at) => Some(self.pivot(at)?),
                };
                Some(GaugeKind::Force { on, about })
            }
            RawGauge::Pressure(raw) => {
                let at = self.point(raw.at.as_ref()?)?;
                let quantity = self.quantity(raw)?;
                Some(GaugeKind::Pressure { at, quantity })
            }
            RawGauge::Velocity(raw) => {
                let at = self.point(raw.at.as_ref()?)?;
                Some(GaugeKind::Velocity { at })
            }
            RawGauge::Front(raw) => self.front(raw),
            RawGauge::Mass(raw) => {
                let (lower_at, upper_at) = (raw.lower.as_ref(), raw.upper.as_ref());
                let (lower, upper) = self.corners(lower_at, upper_at)?;
                self.check_box_meets_domain((&lower_at?.place, lower), (&upper_at?.place, upper))?;
                Some(GaugeKind::Mass { lower, upper })
            }
        }
    }

    /// The one material that a gauge sees, `Some(None)` for all; `None` where a problem was reported.
    #[allow(
        clippy::option_option,
        reason = "the outer option is: no problem was reported"
    )]
    fn seen_material(&mut self, gauge: &RawGauge) -> Option<Option<usize>> {
        let name = match gauge {
            RawGauge::Depth(raw) => &raw.material,
            RawGauge::InterfaceStress(raw) => &raw.material,
            RawGauge::Profile(raw) => &raw.material,
            RawGauge::Discharge(raw) => &raw.material,
            RawGauge::Pressure(raw) => &raw.material,
            RawGauge::Velocity(raw) => &raw.material,
            RawGauge::Front(raw) => &raw.material,
            RawGauge::Mass(raw) => &raw.material,
            RawGauge::Force(_) => &None,
        };
        let Some(name) = name else {
            return Some(None);
        };
        let raw = self.raw;
        self.index_of(
            &name.value.0,
            &name.place,
            "materials",
            raw.materials.as_ref(),
        )
        .map(Some)
    }

    /// Foot, unit vector and length of a line that is searched for material.
    fn line(
        &mut self,
        foot: &Option<At<Coordinates<Length>>>,
        up: &Option<At<Coordinates<Ratio>>>,
        length: &Option<At<Length>>,
    ) -> Option<(Point, Point, f64)> {
        let up = self.gauge_up(up.as_ref())?;
        let foot = self.point(foot.as_ref()?)?;
        let length = self.line_length(length.as_ref(), &[foot], up)?;
        Some((foot, up, length))
    }

    fn profile(&mut self, place: &Place, raw: &RawProfile) -> Option<GaugeKind> {
        let up = self.gauge_up(raw.up.as_ref())?;
        let from = raw.from.as_ref().and_then(|p| self.point(p));
        let to = raw.to.as_ref().and_then(|p| self.point(p));
        let (from, to) = (from?, to?);
        self.check_feet(place, from, to);
        let length = self.line_length(raw.length.as_ref(), &[from, to], up)?;
        Some(GaugeKind::Profile {
            from,
            to,
            count: usize::try_from(raw.count.as_ref()?.value.0).ok()?,
            up,
            length,
        })
    }

    /// A box may reach beyond the domain, but not lie beside it.
    fn check_box_meets_domain(
        &mut self,
        (lower_at, lower): (&Place, Point),
        (upper_at, upper): (&Place, Point),
    ) -> Option<()> {
        let domain = self.domain.clone()?;
        let eps = self.eps();
        for axis in 0..self.axes() {
            let name = Self::axis_name(axis);
            let (place, found, allowed) = if lower[axis] >= domain.upper[axis] - eps {
                let side = domain.upper[axis];
                (
                    lower_at,
                    lower[axis],
                    format!("below {side} m, where the domain ends"),
                )
            } else if upper[axis] <= domain.lower[axis] + eps {
                let side = domain.lower[axis];
                (
                    upper_at,
                    upper[axis],
                    format!("above {side} m, where the domain begins"),
                )
            } else {
                continue;
            };
            self.problems.report(
                place,
                format!("{name} = {found} m: the box lies wholly outside the domain"),
                format!("{name} {allowed}"),
                "move the box into the domain, or enlarge domain.lower and domain.upper",
            );
            return None;
        }
        Some(())
    }

    fn check_feet(&mut self, place: &Place, from: Point, to: Point) {
        if length(&sub(&to, &from)) <= self.eps() {
            self.problems.report(
                place,
                "from and to at the same point",
                "two points apart from each other",
                "move one of them, or use a depth gauge",
            );
        }
    }

    fn front(&mut self, raw: &RawFront) -> Option<GaugeKind> {
        let up = self.gauge_up(raw.up.as_ref())?;
        let origin = raw.origin.as_ref().and_then(|p| self.point(p));
        let direction_at = raw.direction.as_ref()?;
        let direction = self.direction(direction_at)?;
        if dot(&direction, &up).abs() > 0.999 {
            self.problems.report(
                &direction_at.place,
                "a direction parallel to up",
                "a direction along the bed",
                if self.planar() {
                    "write for example [1, 0]"
                } else {
                    "write for example [1, 0, 0]"
                },
            );
            return None;
        }
        let least_depth = self.least_depth(raw.least_depth.as_ref())?;
        Some(GaugeKind::Front {
            origin: origin?,
            direction,
            up,
            least_depth,
        })
    }

    /// As given, or one spacing.
    fn least_depth(&mut self, given: Option<&At<Length>>) -> Option<f64> {
        let spacing = self.spacing?;
        let Some(at) = given else {
            return Some(spacing);
        };
        let depth = at.value.0;
        if depth < (1.0 - 1e-9) * spacing {
            self.problems.report(
                &at.place,
                format!("{depth} m"),
                format!("{spacing} m, the spacing, or more"),
                "leave it out, or make numerics.spacing smaller: less than a row of particles cannot be seen",
            );
            return None;
        }
        Some(depth)
    }

    /// As given, or "up" of the scene.
    fn gauge_up(&mut self, up: Up<'_>) -> Option<Point> {
        match up {
            Some(up) => self.direction(up),
            None => Some(self.up()),
        }
    }

    /// As given, as far as the domain can be long, or from the farthest foot to the domain's edge.
    fn line_length(
        &mut self,
        given: Option<&At<Length>>,
        feet: &[Point],
        up: Point,
    ) -> Option<f64> {
        let domain = self.domain.as_ref()?;
        if let Some(given) = given {
            let diagonal = length(&sub(&domain.upper, &domain.lower));
            return Some(given.value.0.min(diagonal));
        }
        let reach = |foot: &Point| {
            let exits = (0..self.axes()).filter(|&a| up[a].abs() > 1e-9).map(|a| {
                let side = if up[a] > 0.0 {
                    domain.upper[a]
                } else {
                    domain.lower[a]
                };
                (side - foot[a]) / up[a]
            });
            exits.fold(f64::INFINITY, f64::min)
        };
        Some(feet.iter().map(reach).fold(0.0, f64::max))
    }

    /// Where a moment is taken about.
    fn pivot(&mut self, at: &At<Coordinates<Length>>) -> Option<Point> {
        let scheme = self.raw.numerics.as_ref();
        let scheme = scheme.and_then(|n| Some(n.value.scheme.as_ref()?.value));
        let refused = if self.axisymmetric() {
            Some((
                "in an axisymmetric scene",
                "force gauges without about: the moment of a ring about any point of its axis is 0",
            ))
        } else if scheme.is_some_and(|s| s != SchemeWord::Implicit) {
            Some((
                "with a reference scheme",
                "moments come with scheme = \"implicit\"",
            ))
        } else {
            None
        };
        if let Some((found, allowed)) = refused {
            self.problems.report(
                &at.place,
                format!("a point for a moment {found}"),
                allowed,
                "delete about",
            );
            return None;
        }
        // An axle may be outside of the domain.
        self.vector(at)
    }

    /// `wall.NAME` or `gate.NAME`.
    fn force_target(&mut self, text: &str, place: &Place) -> Option<ForceTarget> {
        let raw = self.raw;
        match text.split_once('.') {
            Some(("wall", name)) => self
                .index_of(name, place, "walls", raw.walls.as_ref())
                .map(ForceTarget::Wall),
            Some(("gate", name)) => self
                .index_of(name, place, "gates", raw.gates.as_ref())
                .map(ForceTarget::Gate),
            _ => {
                let mut known = full_names("wall", raw.walls.as_ref(), "");
                known.extend(full_names("gate", raw.gates.as_ref(), ""));
                let (allowed, example) = ("\"wall.NAME\" or \"gate.NAME\"", "wall.floor");
                self.report_full_name(place, text, (allowed, example), &known);
                None
            }
        }
    }
}
