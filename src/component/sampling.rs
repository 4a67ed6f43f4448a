//! Gauges of a scene, made for one dimension: what the engine samples once per communication step.
//!
//! Field gauges read particles through `gauge`; discharge gauges count crossings at every internal step; force
//! gauges read the impulses that devices gathered. Order of readings: the scene's.

use super::engine::Devices;
use crate::gauge::{
    self, Crossing, DepthLine, Edge, Field, Front, MassBox, PRESSED_IN, PressureProbe, Profile,
    Reading, VelocityProbe,
};
use crate::gauge::{Validity, View};
use crate::scene::{ForceTarget, Gauge, GaugeKind, Point, PressureQuantity, Scene};
use crate::state::Grains;

/// All gauges of a scene in D dimensions.
#[derive(Clone, Debug)]
pub(crate) struct Sampler<const D: usize> {
    gauges: Vec<Kind<D>>,
    /// What each gauge sees.
    sights: Vec<Sight>,
}

/// What a gauge sees of the particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Sight {
    /// The one material, if not all.
    pub(crate) material: Option<u8>,
    /// Which pressure.
    pub(crate) quantity: PressureQuantity,
    /// Velocities, too.
    pub(crate) moving: bool,
}

#[derive(Clone, Debug)]
enum Kind<const D: usize> {
    Field(Field<D>),
    Discharge {
        section: Crossing<D>,
        /// Mass that had crossed when the communication step began [kg].
        before: f64,
    },
    Force {
        on: ForceTarget,
        /// Which of the moments that are read.
        moment: Option<usize>,
    },
    /// Where a material ends.
    Interface {
        line: DepthLine<D>,
        material: u8,
    },
}

impl<const D: usize> Sampler<D> {
    /// Gauges of `scene`, whose dimension is D.
    pub(crate) fn new(scene: &Scene) -> Self {
        let period = std::array::from_fn(|a| {
            let domain = &scene.domain;
            domain.periodic[a].then_some(domain.upper[a] - domain.lower[a])
        });
        let mut moments = 0..;
        let gauges = scene.gauges.iter();
        let gauges = gauges.map(|g| kind(g, &period, &mut moments)).collect();
        let sight = |g: &Gauge| Sight {
            material: g.material.map(|m| m as u8),
            quantity: match g.kind {
                GaugeKind::Pressure { quantity, .. } => quantity,
                _ => PressureQuantity::Total,
            },
            moving: matches!(g.kind, GaugeKind::Velocity { .. }),
        };
        Self {
            gauges,
            sights: scene.gauges.iter().map(sight).collect(),
        }
    }

    /// Sections that end on the face of a wall reach into it ([`Crossing::reach_into`]); `is_behind` knows walls that stand.
    pub(crate) fn into_walls(
        mut self,
        spacing: f64,
        is_behind: impl Fn(&[f64; D]) -> bool,
    ) -> Self {
        for gauge in &mut self.gauges {
            if let Kind::Discharge { section, .. } = gauge {
                section.reach_into(PRESSED_IN * spacing, &is_behind);
            }
        }
        self
    }

    /// A communication step begins.
    pub(crate) fn begin_step(&mut self) {
        for gauge in &mut self.gauges {
            if let Kind::Discharge { section, before } = gauge {
                *before = section.mass();
            }
        }
    }

    /// Whether any gauge wants [`Sampler::count`] to be called.
    pub(crate) fn counts(&self) -> bool {
        self.gauges
            .iter()
            .any(|g| matches!(g, Kind::Discharge { .. }))
    }

    /// Counts the particles that crossed sections in one internal step; `before` holds their positions then [m].
    pub(crate) fn count(&mut self, before: &[[f64; D]], grains: &Grains<D>) {
        for (gauge, sight) in self.gauges.iter_mut().zip(&self.sights) {
            if let Kind::Discharge { section, .. } = gauge {
                // What an outflow took is counted there.
                for (i, from) in before
                    .iter()
                    .enumerate()
                    .filter(|(i, _)| !grains.drained[*i])
                {
                    if sight.material.is_none_or(|m| m == grains.phase[i]) {
                        section.add(from, &grains.position[i], grains.mass[i]);
                    }
                }
            }
        }
    }

    /// What some gauge sees of particles, each once; forces and discharges are kept by the step itself.
    pub(crate) fn seen(&self) -> Vec<Sight> {
        let looks = |g: &Kind<D>| matches!(g, Kind::Field(_) | Kind::Interface { .. });
        let gauges = self.gauges.iter().zip(&self.sights);
        let mut seen: Vec<Sight> = gauges.filter(|(g, _)| looks(g)).map(|(_, s)| *s).collect();
        seen.sort_unstable();
        seen.dedup();
        seen
    }

    /// Materials whose interfaces some gauge reads, each once.
    pub(crate) fn edges(&self) -> Vec<u8> {
        let material = |g: &Kind<D>| match g {
            Kind::Interface { material, .. } => Some(*material),
            _ => None,
        };
        let mut edges: Vec<u8> = self.gauges.iter().filter_map(material).collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }

    /// Mass that crossed each discharge gauge since the start [kg]: part of the saved state.
    pub(crate) fn crossed(&self) -> Vec<f64> {
        let mass = |g: &Kind<D>| match g {
            Kind::Discharge { section, .. } => Some(section.mass()),
            _ => None,
        };
        self.gauges.iter().filter_map(mass).collect()
    }

    /// Takes over what [`Sampler::crossed`] gave; false (and nothing changed) if their number is another.
    pub(crate) fn set_crossed(&mut self, mass: &[f64]) -> bool {
        if mass.len() != self.crossed().len() {
            return false;
        }
        let sections = self.gauges.iter_mut().filter_map(|g| match g {
            Kind::Discharge { section, before } => Some((section, before)),
            _ => None,
        });
        for ((section, before), mass) in sections.zip(mass) {
            section.set_mass(*mass);
            *before = *mass;
        }
        true
    }

    /// Readings of all gauges; `view` shows what a sight is of, `edge` the interface of a material. `step` is the length of the last
    /// communication step [s], 0 before the first.
    pub(crate) fn sample<'v>(
        &self,
        view: impl Fn(Sight) -> View<'v, D>,
        edge: impl Fn(u8) -> Edge<'v, D>,
        is_outside: impl Fn(&[f64; D]) -> bool,
        (devices, step): (&Devices, f64),
    ) -> Vec<Reading> {
        let read = |(gauge, sight): (&Kind<D>, &Sight)| match gauge {
            Kind::Field(field) => gauge::sample(field, &view(*sight)),
            Kind::Discharge { section, .. } if is_outside(&section.centre()) => {
                Reading::none(2, Validity::Outside)
            }
            Kind::Discharge { section, before } => discharge(section, *before, step),
            Kind::Force { on, moment } => force::<D>((*on, *moment), devices, step),
            Kind::Interface { line, material } => {
                gauge::interface_stress(line, &view(*sight), &edge(*material))
            }
        };
        self.gauges.iter().zip(&self.sights).map(read).collect()
    }

    /// As [`Sampler::sample`] of particles that have not moved since `still` was sampled.
    pub(crate) fn sample_still(
        &self,
        still: &[Reading],
        devices: &Devices,
        step: f64,
    ) -> Vec<Reading> {
        let read = |(gauge, before): (&Kind<D>, &Reading)| match gauge {
            Kind::Field(_) | Kind::Interface { .. } => before.clone(),
            _ if before.validity == Validity::Outside => before.clone(),
            Kind::Discharge { section, before } => discharge(section, *before, step),
            Kind::Force { on, moment } => force::<D>((*on, *moment), devices, step),
        };
        self.gauges.iter().zip(still).map(read).collect()
    }
}

/// Rate over the last step and mass since the start.
fn discharge<const D: usize>(section: &Crossing<D>, before: f64, step: f64) -> Reading {
    let mass = section.mass();
    Reading::valid(vec![over_step(mass - before, step), mass])
}

/// Mean force over the last step, and its moment: about z in the plane, else about each axis.
fn force<const D: usize>(
    (on, moment): (ForceTarget, Option<usize>),
    devices: &Devices,
    step: f64,
) -> Reading {
    let impulse = match on {
        ForceTarget::Wall(i) => devices.wall_impulse[i],
        ForceTarget::Gate(i) => devices.gates[i].impulse,
    };
    let turning = moment.map_or(&[][..], |n| {
        &devices.moment[n][..if D == 2 { 1 } else { D }]
    });
    let all = impulse[..D].iter().chain(turning);
    Reading::valid(all.map(|i| over_step(*i, step)).collect())
}

fn over_step(value: f64, step: f64) -> f64 {
    if step > 0.0 { value / step } else { 0.0 }
}

/// The gauge of one row of the scene.
fn kind<const D: usize>(
    gauge: &Gauge,
    period: &[Option<f64>; D],
    moments: &mut std::ops::RangeFrom<usize>,
) -> Kind<D> {
    match &gauge.kind {
        GaugeKind::Depth { foot, up, length } => Kind::Field(Field::Depth(DepthLine {
            foot: flat(foot),
            up: flat(up),
            length: *length,
        })),
        GaugeKind::Profile {
            from,
            to,
            count,
            up,
            length,
        } => Kind::Field(Field::Profile(Profile {
            from: flat(from),
            to: flat(to),
            count: *count,
            up: flat(up),
            length: *length,
        })),
        GaugeKind::Discharge { from, to, span } => Kind::Discharge {
            section: Crossing::new(flat(from), flat(to), flat(span), *period),
            before: 0.0,
        },
        GaugeKind::Force { on, about } => Kind::Force {
            on: *on,
            moment: about.and_then(|_| moments.next()),
        },
        GaugeKind::Pressure { at, .. } => {
            Kind::Field(Field::Pressure(PressureProbe { at: flat(at) }))
        }
        GaugeKind::Velocity { at } => Kind::Field(Field::Velocity(VelocityProbe { at: flat(at) })),
        GaugeKind::InterfaceStress { foot, up, length } => Kind::Interface {
            line: DepthLine {
                foot: flat(foot),
                up: flat(up),
                length: *length,
            },
            // The scene reader asks for one.
            material: gauge.material.map_or(0, |m| m as u8),
        },
        GaugeKind::Mass { lower, upper } => Kind::Field(Field::Mass(MassBox {
            lower: flat(lower),
            upper: flat(upper),
        })),
        GaugeKind::Front {
            origin,
            direction,
            up,
            least_depth,
        } => Kind::Field(Field::Front(Front {
            origin: flat(origin),
            direction: flat(direction),
            up: flat(up),
            least_depth: *least_depth,
        })),
    }
}

/// The first D components.
fn flat<const D: usize>(point: &Point) -> [f64; D] {
    std::array::from_fn(|a| point[a])
}
