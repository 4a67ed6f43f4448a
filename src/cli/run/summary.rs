//! The final figures of a run: `summary.json` for programs, a table for people. Both read the same values.

use serde_json::{Map, Value, json};

use super::folder::MADE_BY;
use super::notes::notes;
use super::session::Session;
use crate::cli::CliError;
use crate::component::{Causality, ValueKind, ValueReference};
use crate::solver::StepBound;
use crate::units::hex;
use crate::wire::json::number;

/// Name of a step bound in files and tables.
pub(in crate::cli) fn bound_name(bound: StepBound) -> &'static str {
    bound.name()
}

/// The text of `summary.json`. SI units; a value that is no finite number is written as text.
///
/// # Errors
/// [`CliError::Component`] if values cannot be read.
pub(super) fn json(
    session: &Session,
    status: &str,
    error: Option<&str>,
) -> Result<String, CliError> {
    let component = &session.component;
    let scene = component.scene();
    let (ledger, figures) = (component.ledger(), component.statistics());
    let parts = parts(session);
    let total = |key: &str| number(parts.iter().filter_map(|part| part[key].as_f64()).sum());
    // Of a state that an FMU or a client saved: what it had set.
    let parameters: Map<String, Value> = component
        .changed_parameters()
        .map(|(name, value)| (name.to_owned(), number(value)))
        .collect();
    let summary = json!({
        "made_by": MADE_BY,
        "version": env!("CARGO_PKG_VERSION"),
        "status": status,
        "error": error,
        "case": session.case,
        "scene": scene.name,
        "title": scene.title,
        "scene_sha256": hex(&scene.fingerprint()),
        "quality": scene.quality.name(),
        "spacing": number(scene.numerics.spacing),
        "parameters": parameters,
        "time": number(component.time()),
        "until": number(session.plan.until),
        "communication_step": number(session.plan.step),
        "communication_steps": figures.communication_steps,
        "steps": figures.steps,
        "iterations": figures.iterations,
        "particles": figures.particles,
        "kinetic_energy": number(figures.kinetic_energy),
        "max_speed": number(figures.max_speed),
        "share_dilute": number(figures.share_dilute),
        "share_ill_posed": number(figures.share_ill_posed),
        "creep_rate": number(figures.creep_rate),
        "share_fast": number(figures.share_fast),
        "share_squeezed": number(figures.share_squeezed),
        "mass": {
            "initial": number(ledger.initial),
            "inflow": number(ledger.inflow),
            "outflow": number(ledger.outflow),
            "present": number(ledger.present),
            "error": number(ledger.error()),
        },
        "state_sha256": component.state_hash(),
        "threads": session.threads(),
        "wall_s": total("wall_s"),
        "cpu_s": total("cpu_s"),
        "parts": parts,
        "variables": variables(session)?,
    });
    Ok(format!("{summary:#}\n"))
}

/// One entry a part of the run; the earlier ones come from the summary they left.
fn parts(session: &Session) -> Vec<Value> {
    let part = &session.part;
    let earlier = session.folder.earlier.as_ref();
    let mut parts: Vec<Value> = earlier
        .and_then(|summary| summary["parts"].as_array().cloned())
        .unwrap_or_default();
    let (to, wall) = (session.component.time(), part.watch.wall());
    parts.push(json!({
        "from": number(part.from),
        "to": number(to),
        "threads": session.threads(),
        "wall_s": number(wall),
        "cpu_s": number(part.watch.cpu()),
        "realtime_factor": number((to - part.from) / wall.max(1e-9)),
        "smallest_step": number(part.smallest_step),
        "bound_by": part.bound_by,
        "log": session.log.name,
        "log_failure": session.log.failure,
    }));
    parts
}

/// Every input and output: unit, final value, and extremes with their times where it is a scalar.
fn variables(session: &Session) -> Result<Map<String, Value>, CliError> {
    let component = &session.component;
    let mut all = Map::new();
    let rows = component.variables().rows().iter();
    for row in rows.filter(|v| matches!(v.causality, Causality::Input | Causality::Output)) {
        let mut values = vec![0.0; row.len()];
        component.get(&[row.reference], &mut values)?;
        let mut entry = json!({ "unit": row.unit });
        if row.shape.is_empty() {
            entry["final"] = number(values[0]);
        } else {
            entry["final"] = values.iter().map(|&v| number(v)).collect();
        }
        if let Some(extremes) = extremes(session, row.reference) {
            let ((low, low_at), (high, high_at)) = extremes;
            entry["min"] = number(low);
            entry["min_at"] = number(low_at);
            entry["max"] = number(high);
            entry["max_at"] = number(high_at);
        }
        all.insert(row.name.clone(), entry);
    }
    Ok(all)
}

/// Smallest and largest sample of a scalar with their times [s].
pub(super) fn extremes(
    session: &Session,
    variable: ValueReference,
) -> Option<((f64, f64), (f64, f64))> {
    let figures = session.series.column(variable)?.figures?;
    Some((figures.low, figures.high))
}

/// The table printed at the end of a run.
pub(super) fn table(session: &Session, status: &str) -> String {
    let component = &session.component;
    let (ledger, figures) = (component.ledger(), component.statistics());
    let (wall, cpu) = (session.part.watch.wall(), session.part.watch.cpu());
    let simulated = component.time() - session.part.from;
    let mut lines = vec![
        String::new(),
        format!(
            "{} {status} at t = {} s",
            component.scene().name,
            component.time()
        ),
        format!(
            "  steps   {} communication, {} internal, {} iterations",
            figures.communication_steps, figures.steps, figures.iterations
        ),
        format!(
            "  time    wall {wall:.2} s, CPU {cpu:.2} s on {} threads, {}",
            session.threads(),
            pace(simulated, wall)
        ),
        format!(
            "  mass    initial {} + in {} - out {} = present {} kg, error {}",
            short(ledger.initial),
            short(ledger.inflow),
            short(ledger.outflow),
            short(ledger.present),
            ledger.error()
        ),
        format!("  state   {}", component.state_hash()),
    ];
    lines.push(String::new());
    lines.extend(variable_rows(session));
    lines.push(String::new());
    for note in notes(session) {
        lines.extend([note, String::new()]);
    }
    lines.push(format!("results in {}", session.folder.path().display()));
    lines.join("\n")
}

/// Scalars of gauges and devices: final value and extremes.
fn variable_rows(session: &Session) -> Vec<String> {
    let columns = session.series.columns.iter();
    let shown: Vec<_> = columns.filter(|c| c.is_of_device()).collect();
    let width = shown.iter().map(|c| c.name.len()).max().unwrap_or(0).max(8);
    let mut rows = vec![format!(
        "  {:width$}  {:>12} {:>12} {:>12}  unit",
        "variable", "final", "smallest", "largest"
    )];
    for column in shown {
        let Some(figures) = column.figures else {
            continue;
        };
        let unit = match column.kind {
            ValueKind::Real => column.unit,
            ValueKind::Integer | ValueKind::Boolean | ValueKind::Text => "",
        };
        rows.push(format!(
            "  {:width$}  {:>12} {:>12} {:>12}  {unit}",
            column.name,
            short(figures.last),
            short(figures.low.0),
            short(figures.high.0)
        ));
    }
    rows
}

/// How fast `simulated` seconds went by in `wall` seconds, for people. A slow run says its pace, too: three decimals of it
/// would be 0.
pub(super) fn pace(simulated: f64, wall: f64) -> String {
    let factor = simulated / wall.max(1e-9);
    if factor <= 0.0 || factor >= 0.1 {
        format!("{factor:.3} x real time")
    } else {
        format!("{factor:.1e} x real time")
    }
}

/// Six significant digits, for people; files hold all digits.
pub(in crate::cli) fn short(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e6).contains(&size) {
        return format!("{value:.4e}");
    }
    let digits = 5_i32.saturating_sub(size.log10().floor() as i32).max(0);
    let text = format!("{value:.*}", usize::try_from(digits).unwrap_or(0));
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::pace;

    #[test]
    fn slow_runs_say_their_pace_with_digits_that_tell_something() {
        for (simulated, wall, said) in [
            (3.0, 2.0, "1.500 x real time"),
            (0.1, 1.0, "0.100 x real time"),
            (0.6, 5000.0, "1.2e-4 x real time"),
            (0.0, 5.0, "0.000 x real time"),
        ] {
            assert_eq!(pace(simulated, wall), said);
        }
    }
}
