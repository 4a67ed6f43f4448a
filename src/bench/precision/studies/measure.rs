//! How the value of a study comes from a run: errors against exact solutions, run-outs, a discharge.

use super::Study;
use crate::component::Component;
use crate::validate::bagnold::{Grains, Layer};

/// How the value comes from a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Measure {
    /// (front - half width)/half width of the right front gauge at the end.
    RunOut { gauge: &'static str, radius: f64 },
    /// Root mean square of velocity against Bagnold's profile over the surface's velocity, mean over the last half.
    Bagnold,
    /// Root mean square of pressure against rho g (H - y) over rho g H at the end.
    Hydrostatic,
    /// C of Q = C sqrt(g) D^1.5, mean over the second half.
    Silo,
    /// Root mean square of velocity against the exact profile over that of the profile, mean over the last half.
    Channel,
    /// Root mean square of depth against Ritter's over the reservoir's, where that is 10 to 80 % of it, at the end.
    DamBreak,
}

impl Study {
    /// A watcher that is shown every communication point and gives what it makes of the second half: a mean or a rate.
    pub(in crate::bench::precision) fn begin(
        &self,
        component: &Component,
    ) -> impl FnMut(&Component) -> f64 + use<> {
        let (measure, until) = (self.measure, component.scene().run.until);
        let (mut sum, mut count, mut last) = (0.0, 0.0, -1.0);
        let mut first = None;
        move |component: &Component| {
            let time = component.time();
            if time <= 0.5 * until {
                return f64::NAN;
            }
            let error = match measure {
                Measure::Bagnold => bagnold(component),
                Measure::Channel => channel(component),
                Measure::Silo => {
                    let gone = output(component, "gauge.discharge.mass");
                    let (t0, m0) = *first.get_or_insert((time, gone));
                    return (gone - m0) / (time - t0);
                }
                Measure::RunOut { .. } | Measure::Hydrostatic | Measure::DamBreak => {
                    return f64::NAN;
                }
            };
            if time > last {
                sum += error;
                count += 1.0;
                last = time;
            }
            sum / count
        }
    }

    /// The value at the end; `mean` is what the watcher gave.
    pub(in crate::bench::precision) fn value(&self, component: &Component, mean: f64) -> f64 {
        match self.measure {
            Measure::Bagnold | Measure::Channel => mean,
            Measure::Silo => {
                let bulk = component.scene().materials[0].material.rest_density();
                mean / (bulk * 9.81f64.sqrt() * OUTLET.powf(1.5))
            }
            Measure::Hydrostatic => hydrostatic(component),
            Measure::DamBreak => dam_break(component),
            Measure::RunOut { gauge, radius } => {
                let front = output(component, &format!("gauge.{gauge}.front"));
                (front - radius) / radius
            }
        }
    }
}

/// The exact layer of the incline's template.
fn layer() -> Layer {
    Layer {
        material: Grains::glass_beads(5e-3),
        slope: 25f64.to_radians(),
        depth: 0.1,
        gravity: 9.81,
    }
}

fn bagnold(component: &Component) -> f64 {
    let (layer, view) = (layer(), component.particles());
    let squares = view.position.iter().zip(&view.velocity).map(|(x, v)| {
        let miss = f64::from(v[0]) - layer.velocity(f64::from(x[1]));
        miss * miss
    });
    let mean = squares.sum::<f64>() / view.position.len() as f64;
    mean.sqrt() / layer.surface_velocity()
}

fn hydrostatic(component: &Component) -> f64 {
    let (view, top) = (component.particles(), 0.1);
    let weight = 1500.0 * 9.81;
    let squares = view.position.iter().zip(&view.pressure).map(|(x, p)| {
        let exact = weight * (top - f64::from(x[1])).max(0.0);
        (f64::from(*p) - exact).powi(2)
    });
    (squares.sum::<f64>() / view.position.len() as f64).sqrt() / (weight * top)
}

/// Outlet of the silo [m].
const OUTLET: f64 = 0.05;

/// A scalar output; no number if it is not there.
fn output(component: &Component, name: &str) -> f64 {
    let row = component.variables().by_name(name);
    let mut value = [f64::NAN];
    row.map(|row| component.get(&[row.reference], &mut value));
    value[0]
}

/// Exact velocity of the clay at a distance from the middle of its channel [m/s].
fn clay(y: f64) -> f64 {
    let (half, force, consistency, n, yield_stress) =
        (0.02f64, 2500.0f64, 4.472f64, 0.472f64, 30.0f64);
    let plug = yield_stress / force;
    let power = 1.0 + 1.0 / n;
    let fastest = n / (n + 1.0) * (force / consistency).powf(1.0 / n) * (half - plug).powf(power);
    let s: f64 = ((y.abs() - plug) / (half - plug)).max(0.0);
    fastest * (1.0 - s.powf(power))
}

fn channel(component: &Component) -> f64 {
    let view = component.particles();
    let (mut miss, mut size) = (0.0, 0.0);
    for (x, v) in view.position.iter().zip(&view.velocity) {
        let exact = clay(f64::from(x[1]) - 0.02);
        miss += (f64::from(v[0]) - exact).powi(2);
        size += exact * exact;
    }
    (miss / size).sqrt()
}

fn dam_break(component: &Component) -> f64 {
    let scene = component.scene();
    let (depth, time) = (0.3, component.time());
    let c = (9.81f64 * depth).sqrt();
    let Some(row) = component.variables().by_name("gauge.surface.depth") else {
        return f64::NAN;
    };
    let mut found = vec![f64::NAN; row.len()];
    if component.get(&[row.reference], &mut found).is_err() {
        return f64::NAN;
    }
    // The feet of the template's gauge: every 20 mm from -1.9 m on.
    let errors: Vec<f64> = found
        .iter()
        .enumerate()
        .filter_map(|(k, h)| {
            let x = scene.domain.lower[0] + 0.2 + 0.02 * k as f64;
            let exact = (2.0 * c - x / time).powi(2) / (9.0 * 9.81);
            let inside = x > -c * time && x < 2.0 * c * time;
            (inside && (0.1 * depth..0.8 * depth).contains(&exact)).then(|| (h - exact) / depth)
        })
        .collect();
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::precision::{STUDIES, Setting};
    use crate::scene;

    /// It starts in the box of the resting depth, so that heights miss those of the dilated layer by its dilation.
    #[test]
    fn the_exact_profile_misses_by_its_dilation_and_rest_by_all() {
        let text = STUDIES[0]
            .scene(&Setting {
                resolution: 1.0,
                change: None,
            })
            .unwrap();
        let error = |text: &str| {
            let scene = scene::parse("bagnold", text).unwrap();
            bagnold(&Component::new(&scene).unwrap())
        };
        let dilation = layer().dilated_depth() / 0.1 - 1.0;
        let start = error(&text);
        assert!(start < dilation, "{start} {dilation}");
        let rest = error(&text.replace("velocity_profile = \"bagnold\"\n", ""));
        assert!(rest > 0.5, "{rest}");
    }
}
