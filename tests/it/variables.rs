//! The table of variables: sound for every scene, and its generated page is not stale.

use sandgate::component::{Causality, Start, ValueKind, VariableTable, variables_markdown};
use sandgate::scene::{self, Scene};
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Scenes of a folder, by name of file.
fn scenes(folder: &str) -> Vec<Scene> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(root().join(folder))
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "toml"));
    files.sort();
    files
        .iter()
        .map(|f| scene::load(f).unwrap_or_else(|why| panic!("{why}")))
        .collect()
}

#[test]
fn every_table_is_sound() {
    let scenes = scenes("cases");
    assert!(scenes.len() >= 6);
    for scene in &scenes {
        let table = VariableTable::of(scene);
        for (i, row) in table.rows().iter().enumerate() {
            let name = &row.name;
            assert_eq!(row.reference as usize, i);
            assert_eq!(
                table.by_name(name).unwrap().reference,
                row.reference,
                "{name} is there twice"
            );
            assert_eq!(table.by_reference(row.reference), Some(row));
            let is_structured = |c: char| c.is_ascii_alphanumeric() || "._[]".contains(c);
            assert!(
                name.chars().all(is_structured),
                "{name} is not a structured name"
            );
            assert!(!row.description.is_empty() && !row.is_empty(), "{name}");
            assert_eq!(
                row.kind == ValueKind::Real,
                !row.unit.is_empty(),
                "unit of {name}"
            );
            let is_set = matches!(row.causality, Causality::Input | Causality::Parameter);
            assert_eq!(
                is_set,
                matches!(row.start, Start::Exact(_) | Start::Empty),
                "start of {name}"
            );
            assert_eq!(row.kind == ValueKind::Text, row.start == Start::Empty);
            if let Start::Exact(values) = &row.start {
                let (least, most) = row.range.expect("whatever is set has a range");
                assert_eq!(values.len(), row.len());
                assert!(
                    values.iter().all(|v| (least..=most).contains(v)),
                    "start of {name}"
                );
            }
            if let Some((array, k)) = row.element_of {
                let array = table.by_reference(array).unwrap();
                assert!(
                    k < array.len() && *name == format!("{}[{}]", array.name, k + 1),
                    "{name}"
                );
                assert_eq!(
                    (array.unit, array.kind, array.range),
                    (row.unit, row.kind, row.range)
                );
            }
        }
    }
}

#[test]
fn devices_and_gauges_bring_their_variables() {
    let scene = scene::load(&root().join("tests/scenes/devices.toml")).unwrap();
    let table = VariableTable::of(&scene);
    let names: Vec<&str> = table.rows().iter().map(|v| v.name.as_str()).collect();
    let expected = "time solver.threads saturate_inputs solver.resolution_scale solver.quality \
        material.beads.static_friction_angle material.beads.dynamic_friction_angle \
        material.beads.inertial_number_scale material.beads.grain_diameter material.beads.cohesion \
        body.heap.lower_x body.heap.upper_x body.heap.lower_y body.heap.upper_y gauge.depth.foot_x gauge.depth.foot_y \
        gauge.surface.from_x gauge.surface.from_y gauge.surface.to_x gauge.surface.to_y gauge.past_gate.from_x \
        gauge.past_gate.from_y gauge.past_gate.to_x gauge.past_gate.to_y gauge.probe.at_x gauge.probe.at_y \
        gauge.front.origin_x gauge.front.origin_y gate.sluice.opening gate.sluice.actual_opening gate.sluice.blocked \
        inflow.feed.rate inflow.feed.actual_rate inflow.feed.mass inflow.feed.blocked outflow.end.mass \
        outflow.end.rate gauge.depth.depth gauge.depth.validity gauge.surface.depth gauge.surface.depth[1] \
        gauge.surface.depth[2] gauge.surface.depth[3] gauge.surface.depth[4] gauge.surface.depth[5] \
        gauge.surface.validity gauge.past_gate.discharge gauge.past_gate.mass gauge.past_gate.validity \
        gauge.gate_force.force_x gauge.gate_force.force_y gauge.gate_force.validity gauge.bed_force.force_x \
        gauge.bed_force.force_y gauge.bed_force.validity gauge.probe.pressure gauge.probe.validity \
        gauge.front.front gauge.front.front_quantile gauge.front.validity mass.initial mass.inflow mass.outflow \
        mass.present mass.error solver.steps solver.iterations solver.step_size solver.particles energy.kinetic \
        validity.share_dilute validity.share_ill_posed validity.creep_rate validity.share_fast \
        validity.share_squeezed log.path log.required zenoh.config";
    assert_eq!(names, expected.split_whitespace().collect::<Vec<_>>());
    let depth = table.by_name("gauge.depth.depth").unwrap();
    assert_eq!(
        (depth.unit, depth.display_unit),
        ("m", Some(("mm", 1000.0)))
    );
}

/// SANDGATE_REGENERATE=1 writes the page anew.
#[test]
fn page_of_variables_is_not_stale() {
    let path = root().join("docs/variables.md");
    let text = variables_markdown(&scenes("cases"), &scenes("tests/scenes"));
    if std::env::var_os("SANDGATE_REGENERATE").is_some() {
        std::fs::create_dir_all(root().join("docs")).unwrap();
        std::fs::write(&path, &text).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        found == text,
        "docs/variables.md is stale; run: SANDGATE_REGENERATE=1 cargo test --release variables"
    );
}
