//! documentation/index.html of an FMU: what it simulates, a picture, its variables, how to use and how to connect it.

use std::fmt::Write;

use super::FmiVersion;
use super::description::{causality, identifier, start_value};
use super::picture::{COLOURS, LEGEND, picture};
use super::reference::Reference;
use super::xml::{escape, number};
use crate::component::{Component, Start, Variable};

const STYLE: &str = "body{font-family:sans-serif;max-width:70em;margin:2em auto;padding:0 1em;line-height:1.4}\
table{border-collapse:collapse}td,th{border:1px solid #bbb;padding:.2em .5em;text-align:left;vertical-align:top}\
th{background:#eee}code{white-space:nowrap}svg{max-width:100%;height:auto}";

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
<li>The scene is inside the library: no file is read at run time, and none is written but the log that
<code>log.path</code> asks for. <code>resources/scene.toml</code> is a copy to look
at; changing it changes nothing. Pack a new FMU with <code>sandgate fmu CASE --fmi 2|3 -o FILE</code>.</li>
</ul>
";

/// The same component without FMI; `BASE` is the base of its Zenoh keys.
const CONNECT: &str = "<h2>The same component over Zenoh, and MCAP logs</h2>
<p>This FMU, the program <code>sandgate</code> and its Zenoh service run the same component: the same scene, inputs and
steps give the same bits. Take <code>resources/scene.toml</code> out of this archive (an FMU is a zip file), then:</p>
<ul>
<li><b>Zenoh</b>: an FMU packed with <code>sandgate fmu CASE --zenoh</code> publishes while it is stepped, and takes set-points, if
its parameter <code>zenoh.config</code> is not empty (<code>{}</code> will do). By itself the component runs with
<code>sandgate serve scene.toml</code>, which prints the address it listens at. It publishes output
<code>KIND.NAME.WHAT</code> on <code>BASE/out/KIND/NAME.WHAT</code> after each step, takes inputs on
<code>BASE/in/VARIABLE</code> and answers requests (step, save, restore, ...) on <code>BASE/@rpc/VERB</code>. A state that
this FMU serialises can be restored there, and the other way round. Keys, messages and requests: docs/zenoh.md of
Sandgate.</li>
<li><b>MCAP</b>: set the parameter <code>log.path</code> to the name of a file before initialisation ends, and this FMU logs all
traffic there: calls, inputs, gauges, device poses and particles, for Foxglove, Rerun or any MCAP reader, and for
<code>sandgate log redrive --check</code>, which runs it again and compares every bit. What is in it: docs/logs.md of Sandgate.</li>
</ul>
";

/// The page.
pub(super) fn page(component: &Component, version: FmiVersion, reference: &Reference) -> String {
    let scene = component.scene();
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{name}</title>\n\
         <style>{STYLE}</style></head><body>\n<h1>{name}</h1>\n<p>{title}</p>\n\
         <p>Granular flow (SPH) by Sandgate {sandgate}, FMI {fmi}. Communication step {step} s, end at {until} s.</p>\n",
        name = escape(&scene.name),
        title = escape(&scene.title),
        sandgate = env!("CARGO_PKG_VERSION"),
        fmi = version.name(),
        step = number(scene.run.step),
        until = number(scene.run.until),
    );
    figure(&mut html, component);
    html.push_str(USE);
    let base = format!("sandgate/v1/{}", escape(&scene.name));
    html.push_str(&CONNECT.replace("BASE", &base));
    results(&mut html, component, reference);
    table(&mut html, component);
    html.push_str("<h2>Scene</h2>\n<pre>");
    for line in scene.source.lines() {
        html.push_str(&escape(line));
        html.push('\n');
    }
    html.push_str(
        "</pre>\n<h2>Licences</h2>\n<p>Sandgate: <a href=\"licenses/license.txt\">Apache-2.0 or MIT</a>. \
         Libraries inside the binary: <a href=\"licenses/third_party.txt\">their licences</a>.</p>\n</body></html>\n",
    );
    html
}

/// The picture and what its colours mean.
fn figure(html: &mut String, component: &Component) {
    html.push_str("<figure>\n");
    html.push_str(&picture(component));
    html.push_str("<figcaption>The scene before its first step; rest the pointer on a part to see what it is.");
    let materials = component.scene().materials.iter().enumerate();
    let materials =
        materials.map(|(k, m)| (format!("material {}", m.name), COLOURS[k % COLOURS.len()]));
    let devices = LEGEND
        .iter()
        .map(|(what, colour)| ((*what).to_owned(), *colour));
    for (what, colour) in materials.chain(devices) {
        // Writing to a String cannot fail.
        let _ = write!(
            html,
            " <span style=\"white-space:nowrap\"><span style=\"color:{colour}\">&#9632;</span> {}</span>",
            escape(&what)
        );
    }
    html.push_str("</figcaption>\n</figure>\n");
}

/// Where the reference results are and how to compare with them.
fn results(html: &mut String, component: &Component, reference: &Reference) {
    let id = identifier(component.scene());
    let folder = super::reference::FOLDER;
    // Writing to a String cannot fail.
    let _ = writeln!(
        html,
        "<h2>Reference results</h2>\n<p><code>{folder}/{id}_out.csv</code> has every output at each communication point \
         up to t = {} s, with the inputs of <code>{id}_in.csv</code> set at the points and held over the steps. Sandgate \
         computed them when it packed this FMU; on x86-64 an importer gets the same bits.</p>",
        number(reference.until)
    );
}

fn table(html: &mut String, component: &Component) {
    html.push_str(
        "<h2>Variables</h2>\n<table>\n<tr><th>Reference</th><th>Name</th><th>Causality</th><th>Unit</th>\
         <th>Start</th><th>Allowed</th><th>What it is</th></tr>\n",
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
                .map(|(low, high)| format!("{} to {}", value(row, low), value(row, high)))
                .unwrap_or_default(),
            escape(&row.description),
        );
    }
    html.push_str("</table>\n");
}

fn extents(row: &Variable) -> String {
    if row.shape.is_empty() {
        return String::new();
    }
    let extents: Vec<_> = row.shape.iter().map(usize::to_string).collect();
    format!(" ({} values)", extents.join(" × "))
}

/// As the importer sees it: 1, true and 0.5.
fn value(row: &Variable, number: f64) -> String {
    start_value(row.kind, number)
}

fn start(row: &Variable) -> String {
    match &row.start {
        Start::Exact(values) => {
            let values: Vec<_> = values.iter().map(|v| value(row, *v)).collect();
            values.join(" ")
        }
        Start::Empty => "\"\"".to_owned(),
        Start::Calculated => "calculated".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;

    #[test]
    fn the_page_has_a_picture_all_variables_and_the_keys_of_the_bus() {
        let text = include_str!("../../tests/scenes/devices.toml");
        let scene = scene::parse("devices.toml", text).expect("it is a scene");
        let component = Component::new(&scene).expect("it builds");
        let reference = Reference {
            inputs: String::new(),
            outputs: String::new(),
            until: 0.25,
            cut_short: None,
        };
        let page = page(&component, FmiVersion::V3, &reference);
        assert!(page.contains("<svg") && page.contains("t = 0.25 s"));
        for row in component.variables().rows() {
            assert!(page.contains(&format!("<code>{}</code>", row.name)));
        }
        #[cfg(feature = "record")]
        {
            use crate::wire::keys;
            let base = keys::base(keys::ROOT, &scene.name).expect("it is a name");
            for key in [
                keys::output(&base, "KIND.NAME.WHAT"),
                keys::input(&base, "VARIABLE"),
            ] {
                assert!(page.contains(&key), "{key}");
            }
        }
    }
}
