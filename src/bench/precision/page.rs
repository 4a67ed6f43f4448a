//! docs/precision.md and its figures from a stored run.

use super::front::{Standing, standings};
use super::studies::{Reference, STUDIES, Study};
use super::{Measured, PrecisionRun};
use crate::scene::Quality;
use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::report::number;

/// First line of the page.
pub const MADE: &str =
    "<!-- Written by `sandgate bench precision` from a stored run; do not edit. -->";

/// Why the defaults are not the front of each study.
const WHY: &str = "\
\nThe defaults are the best choice for all studies at once, and for none by itself. A `solver_tolerance` of 1e-2 is \
cheaper and as good in Bagnold's flow, and not good enough in the channel. `courant` = 0.9 costs \
little accuracy and less time; scenes may ask for it (docs/decisions/008-courant.md says why it is not the default). Without density diffusion \
Bagnold's flow is as good, and what should be hydrostatic is not.\n";

/// The whole page; figures lie beside it as precision_NAME.svg.
#[must_use]
pub fn text(run: &PrecisionRun) -> String {
    let m = &run.machine;
    let load = m.load.map_or(String::new(), |(start, end)| {
        format!(", load {start:.1} at the start and {end:.1} at the end (1 is this measurement)")
    });
    let mut text = format!(
        "{MADE}\n# How accurate, how fast\n\nError against CPU time, one choice at a time: defaults over resolutions, and every other choice \
         at the resolution of the case. One thread, CPU time of all steps, on {} ({}){load}, version {}, sources {}{}, {}.\n\n\
         ```\nsandgate bench precision --page docs/precision.md      # all; Ctrl-C keeps what is done, the same command goes on\n\
         sandgate bench precision bagnold --csv precision.csv\n```\n\nA setting is *on the front* if no other of the same study has no \
         larger error at less than 95 % of its CPU time; else it is dominated. Timings were taken on a machine that others used \
         too: CPU times scatter by some percent.",
        m.processor,
        m.system,
        m.version,
        m.sources,
        m.commit
            .as_ref()
            .map_or(String::new(), |c| format!(", commit {c}")),
        m.date
    );
    text.push_str("\n\n");
    text.push_str(&summary(run));
    text.push_str(WHY);
    text.push_str(&qualities(run));
    for study in &STUDIES {
        let (all, uncertain) = standings(study, run);
        if !all.is_empty() {
            text.push_str(&section(study, &all, uncertain));
        }
    }
    text
}

/// The defaults of each study at its own resolution.
fn summary(run: &PrecisionRun) -> String {
    let mut text = "| study | defaults, error | CPU s | CPU s a simulated s | particle steps a CPU s | on the front |\n|---|---|---|---|---|---|\n"
        .to_owned();
    for study in &STUDIES {
        let (all, _) = standings(study, run);
        let defaults = all
            .iter()
            .find(|s| s.measured.setting == "defaults" && s.measured.resolution == 1.0);
        if let Some(s) = defaults {
            let m = &s.measured;
            text.push_str(&format!(
                "| {} | {} | {} | {} | {:.0} 000 | {} |\n",
                study.name,
                s.error.map_or("no result".to_owned(), percent),
                number(m.cpu),
                number(m.cpu / m.simulated),
                (m.particles * m.steps) as f64 / m.cpu / 1e3,
                place(s)
            ));
        }
    }
    text
}

/// What each quality comes to in each study.
fn qualities(run: &PrecisionRun) -> String {
    let mut text = "\n## What the quality knob picks\n\n`quality = \"draft\" | \"standard\" | \"fine\"` in `[numerics]`, or the parameter \
         `solver.quality` (0, 1, 2) of a component, is a resolution: steps, tolerances and all else stay what they are. \
         Where a gate's thickness, a circle or a period would not fit the spacing that it makes, the nearest that fits is taken.\n\n| quality | resolution |\n|---|---|\n"
        .to_owned();
    for quality in Quality::ALL {
        text.push_str(&format!(
            "| {} | x{} |\n",
            quality.name(),
            quality.resolution()
        ));
    }
    text.push_str("\nIt comes to, error and CPU time, at the resolution of each study:\n\n| study | draft | standard | fine |\n|---|---|---|---|\n");
    for study in &STUDIES {
        let (all, _) = standings(study, run);
        let cell = |quality: Quality| {
            let name = match quality {
                Quality::Standard => "defaults".to_owned(),
                _ => format!("quality = {}", quality.name()),
            };
            let found = all
                .iter()
                .find(|s| s.measured.setting == name && s.measured.resolution == 1.0);
            found.map_or("-".to_owned(), |s| {
                let error = s.error.map_or("no result".to_owned(), percent);
                format!("{error}, {} s", number(s.measured.cpu))
            })
        };
        if !all.is_empty() {
            let cells = Quality::ALL.map(cell).join(" | ");
            text.push_str(&format!("| {} | {cells} |\n", study.name));
        }
    }
    text
}

/// Spacing of a setting [m]: a quality may change it.
fn spacing(study: &Study, m: &Measured) -> f64 {
    let quality = m.setting.strip_prefix("quality = ");
    let known = Quality::ALL.iter().find(|q| Some(q.name()) == quality);
    study.spacing(m.resolution) / known.map_or(1.0, |q| q.resolution())
}

fn percent(share: f64) -> String {
    format!("{} %", number(100.0 * share))
}

fn place(standing: &Standing) -> String {
    match (&standing.dominated_by, standing.error) {
        (_, None) => "not judged".to_owned(),
        (None, Some(_)) => "**yes**".to_owned(),
        (Some((name, resolution)), Some(_)) => format!("no: {name} at x{resolution}"),
    }
}

fn section(study: &Study, all: &[Standing], uncertain: Option<f64>) -> String {
    let mut text = format!("\n## {}\n\n{}.", study.name, capital(study.about));
    if let Some(uncertain) = uncertain {
        text.push_str(&format!(
            " The finest differs from the next by {}: that is how well the reference is known.",
            percent(uncertain)
        ));
    }
    if let Some((source, value)) = study.published {
        text.push_str(&format!(" Published: {} ({source}).", number(value)));
    }
    text.push_str(&format!(
        "\n\n![{0}: error against CPU time](precision_{0}.svg)\n\n| setting | dp [mm] | particles | steps | value | error | CPU s | on the front |\n|---|---|---|---|---|---|---|---|\n",
        study.name
    ));
    for s in all {
        let m = &s.measured;
        text.push_str(&format!(
            "| {} | {} | {} | {} | {} | {} | {} | {} |\n",
            m.setting,
            number(1e3 * spacing(study, m)),
            m.particles,
            m.steps,
            m.value.map_or("failed".to_owned(), number),
            s.error.map_or("-".to_owned(), percent),
            number(m.cpu),
            place(s)
        ));
    }
    let dominated: Vec<String> = all
        .iter()
        .filter(|s| s.dominated_by.is_some() && s.measured.setting != "defaults")
        .map(|s| s.measured.setting.clone())
        .collect();
    if !dominated.is_empty() {
        text.push_str(&format!("\nDominated: {}.\n", dominated.join(", ")));
    }
    text
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |c| {
        c.to_uppercase().collect::<String>() + letters.as_str()
    })
}

/// The figure of a study: logarithms of error and CPU time, the front as a line.
///
/// # Errors
/// What the drawing library says.
pub fn figure(study: &Study, run: &PrecisionRun) -> Result<String, String> {
    let (all, _) = standings(study, run);
    let log = |s: &Standing| {
        let error = s.error.filter(|e| *e > 0.0)?;
        Some((s.measured.cpu.log10(), error.log10()))
    };
    let pick = |wanted: &dyn Fn(&Standing) -> bool| -> Vec<(f64, f64)> {
        all.iter().filter(|s| wanted(s)).filter_map(log).collect()
    };
    let mut front = pick(&|s| s.on_front);
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut curves = vec![
        Curve::new("front", front, Look::Thin, 6),
        Curve::new(
            "defaults over resolution",
            pick(&|s| s.measured.setting == "defaults"),
            Look::Line,
            0,
        ),
        Curve::new(
            "defaults over resolution",
            pick(&|s| s.measured.setting == "defaults"),
            Look::Dots,
            0,
        ),
    ];
    let mut names: Vec<&str> = Vec::new();
    for s in &all {
        let key = s.measured.setting.split(" = ").next().unwrap_or_default();
        if key != "defaults" && !names.contains(&key) {
            names.push(key);
            let of = |o: &Standing| o.measured.setting.starts_with(&format!("{key} = "));
            curves.push(Curve::new(key, pick(&of), Look::Dots, names.len()));
        }
    }
    let y = match study.reference {
        Reference::Error => "log10 of the error",
        Reference::Finest => "log10 of the error against the finest",
    };
    Chart {
        x: "log10 of CPU time [s]".to_owned(),
        y: y.to_owned(),
        curves,
    }
    .svg()
}

/// All of it as CSV.
#[must_use]
pub fn csv(run: &PrecisionRun) -> String {
    let mut text =
        "study,setting,resolution,particles,steps,simulated_s,value,error,cpu_s,on_front\n"
            .to_owned();
    for study in &STUDIES {
        for s in standings(study, run).0 {
            let m = &s.measured;
            let cell = |v: Option<f64>| v.map_or(String::new(), |v| v.to_string());
            text.push_str(&format!(
                "{},{},{},{},{},{},{},{},{},{}\n",
                m.study,
                m.setting,
                m.resolution,
                m.particles,
                m.steps,
                m.simulated,
                cell(m.value),
                cell(s.error),
                m.cpu,
                s.on_front
            ));
        }
    }
    text
}
