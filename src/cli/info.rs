//! `sandgate info CASE`: what a case holds, what bounds its steps, what a run will cost, what it leaves out.
//!
//! Costs are measured: the first communication steps are really computed, for a few seconds at most.

mod cost;
mod scene;

use std::path::PathBuf;

use super::clock::{cores, peak_memory};
use super::{CliError, component_of, load_scene, say, threads};
use crate::component::{Causality, Component, Start};

/// What may be typed after `sandgate info`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The scene file, for example cases/silo_gate.toml
    case: PathBuf,
    /// Threads to measure with; 0 means all cores
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = threads::parser())]
    threads: u16,
}

/// Prints the report.
///
/// # Errors
/// [`CliError::Scene`], [`CliError::Build`], [`CliError::Component`] if its first steps fail.
pub(super) fn run(args: &Args) -> Result<(), CliError> {
    let scene = load_scene(&args.case)?;
    let mut component = component_of(&scene, &args.case)?;
    component.set_threads(usize::from(args.threads));
    component.initialize(0.0, None)?;
    let mut report = scene::describe(&scene, &component);
    let saved = component.save()?.len();
    report.push_str(&variables(&component));
    say(&report)?;
    let threads = match args.threads {
        0 => cores(),
        n => usize::from(n),
    };
    let measured = cost::measure(&mut component)?;
    let mut lines = cost::report(&scene, &measured, threads);
    let memory = peak_memory().map_or_else(
        || "not told by this system".to_owned(),
        |bytes| format!("{:.1} MB at most so far", mega(bytes)),
    );
    lines.push_str(&format!(
        "memory     {memory}; a saved state takes {:.2} MB",
        mega(saved as u64)
    ));
    say(&lines)
}

/// Megabytes.
fn mega(bytes: u64) -> f64 {
    bytes as f64 / 1e6
}

/// The variables table: what FMI, C, Zenoh and logs show.
fn variables(component: &Component) -> String {
    let rows = component.variables().rows();
    let width = rows.iter().map(|v| v.name.len()).max().unwrap_or(4);
    let mut text = format!(
        "variables\n  {:>4}  {:width$}  {:9}  {:6}  {:>10}  meaning\n",
        "ref", "name", "role", "unit", "start"
    );
    for v in rows.iter().filter(|v| v.element_of.is_none()) {
        let role = match v.causality {
            Causality::Independent => "time",
            Causality::Parameter => "parameter",
            Causality::Input => "input",
            Causality::Output => "output",
        };
        let start = match &v.start {
            Start::Exact(values) if values.len() == 1 => format!("{}", values[0]),
            Start::Exact(values) => format!("{} values", values.len()),
            Start::Empty => "\"\"".to_owned(),
            Start::Calculated => String::new(),
        };
        let shape: String = v.shape.iter().map(|n| format!(" [{n} values]")).collect();
        text.push_str(&format!(
            "  {:>4}  {:width$}  {role:9}  {:6}  {start:>10}  {}{shape}\n",
            v.reference, v.name, v.unit, v.description
        ));
    }
    text
}
