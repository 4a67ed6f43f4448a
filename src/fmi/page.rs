//! documentation/index.html of an FMU: what it simulates, its variables, how to use it.

use std::fmt::Write;

use super::description::causality;
use super::xml::{escape, number};
use crate::component::{Component, Start, Variable};

const STYLE: &str = "body{font-family:sans-serif;max-width:70em;margin:2em auto;padding:0 1em;line-height:1.4}\
table{border-collapse:collapse}td,th{border:1px solid #bbb;padding:.2em .5em;text-align:left;vertical-align:top}\
th{background:#eee}code{white-space:nowrap}";

const USE: &str = "<h2>How to use it</h2>
<ul>
<li>Co-simulation: set inputs at communication points, then <code>doStep</code>. A step ends at t + h exactly, however
many internal steps stability asks for; h may change from step to step.</li>
<li>Inputs are held over a step. Outputs are sampled once, at the end of a step (and at the end of initialisation), so
reading them costs next to nothing and an input never changes an output at the same instant.</li>
<li>States can be saved and set at any time, also after an error and in another process; going on gives the same bits
as a run without the break. Results do not depend on the number of threads.</li>
<li>A refused call answers Error with a message in category <code>logStatusError</code> that says what was found and what
is allowed; the instance goes on as before. After a failed step only reading, setting a state, reset and free are
allowed.</li>
<li>Discharges, forces and masses of planar scenes are for the scene's out-of-plane width, those of axisymmetric scenes for whole rings. Look at the validity beside
each gauge before you use its reading: 0 valid, 1 empty, 2 outside, 3 blocked.</li>
<li>The scene is inside the library: no file is read at run time. <code>resources/scene.toml</code> is a copy to look
at; changing it changes nothing. Pack a new FMU with <code>sandgate fmu CASE --fmi 2|3 -o FILE</code>.</li>
</ul>
";

/// The page.
pub(super) fn page(component: &Component) -> String {
    let scene = component.scene();
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{name}</title>\n\
         <style>{STYLE}</style></head><body>\n<h1>{name}</h1>\n<p>{title}</p>\n\
         <p>Granular flow (SPH) by Sandgate {version}. Communication step {step} s, end at {until} s.</p>\n{USE}\
         <h2>Variables</h2>\n<table>\n<tr><th>Reference</th><th>Name</th><th>Causality</th><th>Unit</th>\
         <th>Start</th><th>Allowed</th><th>What it is</th></tr>\n",
        name = escape(&scene.name),
        title = escape(&scene.title),
        version = env!("CARGO_PKG_VERSION"),
        step = number(scene.run.step),
        until = number(scene.run.until),
    );
    for row in component.variables().rows() {
        // Writing to a String cannot fail.
        let _ = writeln!(
            html,
            "<tr><td>{}</td><td><code>{}</code>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            row.reference,
            escape(&row.name),
            extents(row),
            causality(row.causality),
            escape(row.unit),
            start(row),
            row.range
                .map(|(low, high)| format!("{} to {}", number(low), number(high)))
                .unwrap_or_default(),
            escape(&row.description),
        );
    }
    html.push_str("</table>\n<h2>Scene</h2>\n<pre>");
    for line in scene.source.lines() {
        html.push_str(&escape(line));
        html.push('\n');
    }
    html.push_str("</pre>\n</body></html>\n");
    html
}

fn extents(row: &Variable) -> String {
    if row.shape.is_empty() {
        return String::new();
    }
    let extents: Vec<_> = row.shape.iter().map(usize::to_string).collect();
    format!(" ({} values)", extents.join(" × "))
}

fn start(row: &Variable) -> String {
    match &row.start {
        Start::Exact(values) => {
            let values: Vec<_> = values.iter().map(|v| number(*v)).collect();
            values.join(" ")
        }
        Start::Calculated => "calculated".to_owned(),
    }
}
