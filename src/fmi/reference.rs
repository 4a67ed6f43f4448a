//! `extra/org.fmi-standard.fmi-ls-ref`: what an importer should get, after FMI-LS-REF 1.0.0-alpha.1 of the Modelica
//! Association: a manifest, the inputs and the outputs of the default experiment's first part.
//!
//! Inputs are the scene's schedules, set at each communication point and held over the step. How far the results go is
//! counted in work, not in time, so that the same scene gives the same bytes on every machine.

use super::xml::{Attributes, Xml, number};
use crate::component::{Causality, Component, Error, Variable, next_point};
use crate::scene::Scene;

/// Folder of the layered standard in an archive.
pub(super) const FOLDER: &str = "extra/org.fmi-standard.fmi-ls-ref";

/// How far the reference results of an FMU go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// As many communication steps as cost about two seconds of CPU time, one at least.
    Short,
    /// To this time [s]: the first communication point there or later, at most the scene's end. 0: initial values only.
    Until(f64),
}

/// Work of [`Extent::Short`]: particles times sweeps over their pairs. An internal step counts for
/// [`SWEEPS`] sweeps, an iteration of its viscous solve for one.
const WORK: f64 = 5.0e6;
/// Sweeps of an internal step beside its viscous solve.
const SWEEPS: f64 = 6.0;

/// Inputs and outputs of the reference run.
pub(super) struct Reference {
    /// `time` and all inputs, one row a communication point: what is set there.
    pub(super) inputs: String,
    /// `time` and all scalar outputs, one row a communication point.
    pub(super) outputs: String,
    /// Time of the last row [s].
    pub(super) until: f64,
    /// Why a step failed that nobody had asked for: the results end before it.
    pub(super) cut_short: Option<String>,
}

/// Runs a scene along its schedules.
///
/// # Errors
/// Those of the component.
pub(super) fn reference(scene: &Scene, extent: Extent) -> Result<Reference, Error> {
    let mut component = Component::new(scene)?;
    component.set_threads(0);
    component.initialize(0.0, None)?;
    let mut inputs = Table::of(&component, Causality::Input);
    let mut outputs = Table::of(&component, Causality::Output);
    let until = match extent {
        Extent::Short => scene.run.until,
        Extent::Until(until) => until.min(scene.run.until),
    };
    let (mut work, mut cut_short) = (0.0, None);
    loop {
        let time = component.time();
        let (references, values) = component.scheduled(time);
        component.set(&references, &values)?;
        inputs.sample(&component)?;
        outputs.sample(&component)?;
        if time >= until || (extent == Extent::Short && work >= WORK) {
            break;
        }
        let Some(next) = next_point(time, scene.run.step, scene.run.until) else {
            break;
        };
        let report = match component.do_step(time, next - time) {
            Err(why) if extent == Extent::Short => {
                cut_short = Some(why.to_string());
                break;
            }
            done => done?,
        };
        let sweeps = SWEEPS * report.substeps as f64 + report.iterations as f64;
        work += sweeps * component.statistics().particles as f64;
    }
    Ok(Reference {
        inputs: inputs.text,
        outputs: outputs.text,
        until: component.time(),
        cut_short,
    })
}

/// Comma-separated values as importers read them: names in quotes, numbers that read back to the same bits.
struct Table {
    references: Vec<u32>,
    text: String,
}

impl Table {
    /// Scalars of a causality; arrays are there by their elements, so that both versions of the standard read the same.
    fn of(component: &Component, causality: Causality) -> Self {
        let wanted = |row: &&Variable| row.causality == causality && row.shape.is_empty();
        let rows = component.variables().rows().iter().filter(wanted);
        let (references, names): (Vec<_>, Vec<_>) = rows
            .map(|row| (row.reference, format!(",\"{}\"", row.name)))
            .unzip();
        Self {
            references,
            text: format!("\"time\"{}\n", names.concat()),
        }
    }

    fn sample(&mut self, component: &Component) -> Result<(), Error> {
        let mut values = vec![0.0; self.references.len()];
        component.get(&self.references, &mut values)?;
        self.text.push_str(&number(component.time()));
        for value in values {
            self.text.push(',');
            self.text.push_str(&number(value));
        }
        self.text.push('\n');
        Ok(())
    }
}

/// fmi-ls-manifest.xml: the files an importer may care for and what they are.
pub(super) fn manifest(identifier: &str, reference: &Reference) -> String {
    let mut xml = Xml::document();
    let standard = [
        ("xmlns:fmi-ls", "http://fmi-standard.org/fmi-ls-manifest"),
        ("fmi-ls:fmi-ls-name", "org.fmi-standard.fmi-ls-ref"),
        ("fmi-ls:fmi-ls-version", "1.0.0-alpha.1"),
        (
            "fmi-ls:fmi-ls-description",
            "Layered Standard providing information on related files included in an FMU.",
        ),
    ];
    xml.begin("fmiReferences", &attributes(standard));
    for file in related(identifier, reference.until) {
        xml.leaf("Related", &file);
    }
    xml.finish()
}

fn attributes<const N: usize>(pairs: [(&'static str, &str); N]) -> Attributes {
    let pairs = pairs.into_iter();
    pairs.map(|(key, value)| (key, value.to_owned())).collect()
}

/// Inputs, results to that time [s], scene and page.
fn related(identifier: &str, until: f64) -> [Attributes; 4] {
    let file = |kind: &str, source: &str, role: &str, description: &str| {
        attributes([
            ("type", kind),
            ("source", source),
            ("role", role),
            ("description", description),
        ])
    };
    [
        file(
            "text/csv",
            &format!("{identifier}_in.csv"),
            "testcase",
            "Inputs to set at each communication point and to hold over the step",
        ),
        file(
            "text/csv",
            &format!("{identifier}_out.csv"),
            "result",
            &format!(
                "Outputs at each communication point of the default experiment up to t = {} s",
                number(until)
            ),
        ),
        file(
            "application/toml",
            "../../resources/scene.toml",
            "model",
            "The scene that this FMU simulates, as Sandgate reads it",
        ),
        file(
            "text/html",
            "../../documentation/index.html",
            "document",
            "Variables, picture of the scene, how to use it",
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;

    fn silo() -> Scene {
        let text = include_str!("../../tests/scenes/small_silo.toml");
        scene::parse("small_silo.toml", text).expect("it is a scene")
    }

    #[test]
    fn results_end_where_they_are_told_to() {
        let scene = silo();
        let run = |extent| reference(&scene, extent).expect("it runs");
        let start = run(Extent::Until(0.0));
        assert_eq!((start.until, start.outputs.lines().count()), (0.0, 2));
        let steps = run(Extent::Until(0.012));
        assert_eq!(steps.until, 3.0 * 0.005);
        assert_eq!(steps.inputs.lines().count(), 5);
        assert!(steps.outputs.starts_with(&start.outputs));
        let short = run(Extent::Short);
        assert!(short.until >= scene.run.step && short.until <= scene.run.until);
        assert_eq!(short.outputs, run(Extent::Short).outputs);
    }

    /// Nobody asked how far: an orchestrator may well hold up what falls here.
    #[test]
    fn results_end_before_a_step_that_fails() {
        let text = include_str!("../../tests/scenes/no_floor.toml");
        let scene = scene::parse("no_floor.toml", text).expect("it is a scene");
        let cut = reference(&scene, Extent::Short).expect("it is cut short");
        assert!(cut.until > 0.0 && cut.until < scene.run.until);
        assert!(cut.cut_short.is_some_and(|why| why.contains("particle")));
        assert!(reference(&scene, Extent::Until(scene.run.until)).is_err());
    }

    #[test]
    fn inputs_follow_the_schedule() {
        let scene = silo();
        let run = reference(&scene, Extent::Until(0.03)).expect("it runs");
        let rows: Vec<&str> = run.inputs.lines().collect();
        assert_eq!(rows[0], "\"time\",\"gate.main.opening\"");
        assert_eq!(rows[1], "0.0,0.0");
        // At 30 ms the ramp from 20 to 60 ms has done a quarter.
        let wanted = scene.schedules[0].value_at(0.03);
        assert!((wanted - 0.25).abs() < 1e-12);
        assert_eq!(rows[7], format!("0.03,{wanted:?}"));
    }
}
