//! Unit benchmarks of a whole component: a step, saving, restoring, reading, publishing, and a log of it.

use std::path::Path;

use prost::Message;

use super::{Unit, unit};
use crate::bench::Error;
use crate::component::{Causality, Component, ValueReference};
use crate::record::{RecordOptions, Recorder};
use crate::wire::convert::point_cloud;

/// What is timed how often.
#[derive(Clone, Copy)]
pub(super) struct Size {
    /// 2 or 3.
    pub(super) dimension: usize,
    /// Particles asked for.
    pub(super) count: usize,
    pub(super) rounds: usize,
}

/// A step, gauges, saving, restoring, logging and publishing of a whole component; the log is in `folder` meanwhile.
///
/// # Errors
/// [`Error::Scene`].
pub(super) fn measure(size: Size, folder: &Path, units: &mut Vec<Unit>) -> Result<(), Error> {
    time_all(size, folder, units).map_err(|why| Error::Scene {
        scene: format!("{} particles in {} dimensions", size.count, size.dimension),
        why,
    })
}

fn time_all(size: Size, folder: &Path, units: &mut Vec<Unit>) -> Result<(), String> {
    let mut trial = Trial::new(size, units)?;
    trial.step()?;
    trial.state_and_outputs()?;
    trial.log(folder)
}

/// A component whose calls are timed one after the other.
struct Trial<'a> {
    component: Component,
    /// A tenth of the acoustic bound, so that a communication step is one internal step [s].
    step: f64,
    size: Size,
    particles: usize,
    units: &'a mut Vec<Unit>,
}

impl<'a> Trial<'a> {
    fn new(size: Size, units: &'a mut Vec<Unit>) -> Result<Self, String> {
        let scene = crate::scene::parse("unit", &scene(size)).map_err(|e| e.to_string())?;
        let mut component = Component::new(&scene).map_err(|e| e.to_string())?;
        component.initialize(0.0, None).map_err(|e| e.to_string())?;
        Ok(Self {
            particles: component.statistics().particles as usize,
            component,
            step: 0.1 * scene.numerics.acoustic_step(),
            size,
            units,
        })
    }

    fn time(&mut self, name: &str, mut work: impl FnMut(&mut Component)) {
        let Size {
            dimension, rounds, ..
        } = self.size;
        let work = || work(&mut self.component);
        let unit = unit(name, dimension, self.particles, rounds.min(7), work);
        self.units.push(unit);
    }

    fn step(&mut self) -> Result<(), String> {
        let (step, mut failed) = (self.step, None);
        self.time("do_step of one internal step", |component| {
            let time = component.time();
            failed = component.do_step(time, step).err().or(failed.take());
        });
        failed.map_or(Ok(()), |error| Err(error.to_string()))
    }

    fn state_and_outputs(&mut self) -> Result<(), String> {
        let rows = self.component.variables().rows().iter();
        let outputs = rows.filter(|row| row.causality == Causality::Output);
        let outputs: Vec<(ValueReference, usize)> =
            outputs.map(|r| (r.reference, r.len())).collect();
        let references: Vec<ValueReference> = outputs.iter().map(|o| o.0).collect();
        let mut values = vec![0.0; outputs.iter().map(|o| o.1).sum()];
        // Gauges are sampled within `do_step`; reading outputs copies what they found, also that of a restored state.
        let saved = self.component.save().map_err(|e| e.to_string())?;
        self.time("save", |component| {
            std::hint::black_box(component.save().map_or(0, |bytes| bytes.len()));
        });
        let mut restored = 0;
        self.time("restore", |component| {
            restored += usize::from(component.restore(&saved).is_ok());
        });
        self.time("restore and read of all outputs", |component| {
            restored += usize::from(component.restore(&saved).is_ok());
            restored += usize::from(component.get(&references, &mut values).is_ok());
        });
        self.time("read of all outputs", |component| {
            restored += usize::from(component.get(&references, &mut values).is_ok());
        });
        self.time(
            "publish: a picture of all particles as bytes",
            |component| {
                std::hint::black_box(point_cloud(component).encode_to_vec().len());
            },
        );
        std::hint::black_box(restored);
        Ok(())
    }

    fn log(&mut self, folder: &Path) -> Result<(), String> {
        let Size {
            dimension, count, ..
        } = self.size;
        let path = folder.join(format!("unit-{dimension}-{count}.mcap"));
        let mut options = RecordOptions::of(&self.component);
        options.particles_every = 0.0;
        let (step, time) = (self.step, self.component.time());
        let report = self.component.do_step(time, step);
        let report = report.map_err(|e| e.to_string())?;
        let recorder = Recorder::create(&path, &self.component, options);
        let mut recorder = recorder.map_err(|e| e.to_string())?;
        let (time, mut written) = (self.component.time(), 0);
        self.time("log of one communication step", |component| {
            let logged = recorder.record_step(component, &report, time - step, step, "bench");
            written += usize::from(logged.is_ok());
        });
        if self.particles <= 100_000 {
            self.time("log of all particles", |component| {
                written += usize::from(recorder.particles(component).is_ok());
            });
        }
        std::hint::black_box(written);
        recorder.discard().map_err(|e| e.to_string())
    }
}

/// A level fill with gauges of each kind.
fn scene(
    Size {
        dimension, count, ..
    }: Size,
) -> String {
    let (side, height) = (1.0, 0.5);
    let spacing = if dimension == 2 {
        (side * height / count as f64).sqrt()
    } else {
        (side * side * height / count as f64).cbrt()
    };
    let margin = 8.0 * spacing;
    let (low, high) = (-margin, side + margin);
    let mut text = "name = \"unit\"\n".to_owned();
    let walls: &[(&str, usize, f64, f64)] = &[
        ("floor", dimension - 1, 0.0, 1.0),
        ("west", 0, 0.0, 1.0),
        ("east", 0, side, -1.0),
        ("south", 1, 0.0, 1.0),
        ("north", 1, side, -1.0),
    ];
    let wide = |v: f64| vec![v; dimension];
    let mut top = wide(side);
    top[dimension - 1] = height;
    text += &format!(
        "dimension = {dimension}\n[domain]\nlower = {:?}\nupper = {:?}\n[numerics]\nspacing = {spacing:?}\n\
         [materials.sand]\nlaw = \"mu_i\"\npreset = \"sand_04\"\n\
         [bodies.fill]\nmaterial = \"sand\"\nbox = {{ lower = {:?}, upper = {top:?} }}\n",
        wide(low),
        wide(high),
        wide(0.0),
    );
    for (name, axis, at, towards) in &walls[..2 * dimension - 1] {
        let (mut point, mut normal) = (wide(0.0), wide(0.0));
        (point[*axis], normal[*axis]) = (*at, *towards);
        text += &format!(
            "[walls.{name}]\nplane = {{ point = {point:?}, normal = {normal:?} }}\nslip = \"friction\"\nwall_friction = 0.3\n"
        );
    }
    let (mut foot, mut probe) = (wide(0.5), wide(0.5));
    (foot[dimension - 1], probe[dimension - 1]) = (0.0, 0.1);
    text + &format!(
        "[gauges.depth]\nkind = \"depth\"\nfoot = {foot:?}\n[gauges.push]\nkind = \"force\"\non = \"wall.floor\"\n\
         [gauges.probe]\nkind = \"pressure\"\nat = {probe:?}\n[run]\nstep = 0.01\nuntil = 1.0\n"
    )
}
