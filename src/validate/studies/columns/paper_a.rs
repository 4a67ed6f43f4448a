//! `columns_paper_a`: the six columns by [A]'s own scheme with the parameters it prints.

use super::{COLUMNS, Column, GRAVITY, PICTURES, R0, SERIES, STOPPING, figures, front, run_out};
use crate::validate::template::{Template, point, points};
use crate::validate::{Effort, Member, Metric, Report, Results, Rule, Study};

/// The study.
pub(in crate::validate::studies) const STUDY: Study = Study {
    name: "columns_paper_a",
    title: "Collapse of sand columns by the scheme of Minatti and Paris as printed",
    about: "The six columns of Table 3 of Minatti and Paris [A] (Appl. Math. Modelling 39 (2015) 363-376) by `scheme = \
\"paper_a\"`: their pair operators, ghost particles, explicit Verlet steps and regularised viscosity, with K_t, tau_0, m_0, dp \
and h/dp as their table prints them (its K_t lacks a square: Mach 0.2 to 0.4, and row 6 is ten times lower than its \
neighbours). It is the reference that the default is measured against, not something to use. Nothing here is judged: the page \
reports what the scheme gives when it is built to the letter, good or bad.\n\n\
[A] compares planar runs with Lube's law for round columns and finds agreement up to a = 3 (its Figs. 10 to 13; it prints no \
run-outs). Both laws stand below. Fronts are those at 12 sqrt(H0/g); the start is a square lattice at rest, so that there is \
one run each.",
    members,
    analyse,
};

/// The cases, in the order of [`COLUMNS`].
const CASES: [&str; 6] = [
    include_str!("../../../../cases/paper_a/column_1.toml"),
    include_str!("../../../../cases/paper_a/column_2.toml"),
    include_str!("../../../../cases/paper_a/column_3.toml"),
    include_str!("../../../../cases/paper_a/column_4.toml"),
    include_str!("../../../../cases/paper_a/column_5.toml"),
    include_str!("../../../../cases/paper_a/column_6.toml"),
];

/// Explicit steps are some hundred times shorter than the acoustic bound that the time left is estimated from.
const RELATIVE_COST: f64 = 100.0;

fn name(column: &Column) -> String {
    format!("a{:.2}", column.aspect)
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let member = |(column, text): (&Column, &str)| {
        // As printed but for the room: twice that of the largest planar run-out, since it goes further than sand.
        let reach = R0 * (2.0 + 2.5 * column.planar_band().1);
        let mut template = Template::new(text)?
            .with("domain.lower", point(-reach, -0.03))
            .with("domain.upper", point(reach, 1.5 * column.height + 0.03))
            .with(
                "walls.floor.polyline",
                points(&[[-reach, 0.0], [reach, 0.0]]),
            )
            .with("run.step", column.fall() / 20.0)
            .with("run.until", effort.pick(12.0, 1.0) * column.fall());
        if effort == Effort::Quick {
            template = template.with("numerics.spacing", 4.0 * column.spacing);
        }
        let end = effort.pick(12.0, 1.0);
        let pictures = PICTURES
            .iter()
            .filter(|t| **t <= end)
            .map(|t| t * column.fall());
        let text = template.text()?;
        let mut member = Member::new(name(column), text, &SERIES, pictures.collect());
        member.relative_cost = RELATIVE_COST;
        Ok(member)
    };
    COLUMNS.iter().zip(CASES).map(member).collect()
}

fn analyse(results: &Results) -> Result<Report, String> {
    let mut report = Report::default();
    for column in &COLUMNS {
        report.metrics.extend(report_column(results, column));
        report
            .figures
            .extend(figures::pictures(results, column, &name(column)));
    }
    let laws = COLUMNS.iter().map(|c| {
        let law = c.axisymmetric();
        (c, name(c), (law, law))
    });
    let fronts = figures::fronts(results, &laws.collect::<Vec<_>>())?;
    report.figures.insert(0, fronts);
    Ok(report)
}

fn report_column(results: &Results, column: &Column) -> Vec<Metric> {
    let a = column.aspect;
    let recording = results.finished(&name(column));
    let late = recording.and_then(|r| run_out(r, *r.time.last()?));
    let early = recording.and_then(|r| run_out(r, STOPPING * column.fall()));
    let creep = recording.and_then(|r| {
        let front = front(r);
        let (t, x) = *front.last()?;
        // The last tenth of the run.
        let (t0, x0) = *front.iter().find(|p| p.0 >= 0.9 * t)?;
        Some((x - x0) / (t - t0) / (GRAVITY * column.height).sqrt())
    });
    let height = recording.and_then(|r| Some(r.last("gauge.depth_centre.depth")? / R0));
    let (low, high) = column.planar_band();
    vec![
        Metric::new(
            format!("a = {a:.2}: run-out"),
            late,
            Rule::Report(Some(column.axisymmetric())),
            "Lube et al. 2004, round columns: what [A] compares with",
        ),
        Metric::new(
            format!("a = {a:.2}: run-out, planar law"),
            late,
            Rule::Report(Some(0.5 * (low + high))),
            format!("middle of the planar band, {low:.2} to {high:.2}"),
        ),
        Metric::new(
            format!("a = {a:.2}: run-out at 3 sqrt(H0/g)"),
            early,
            Rule::Report(None),
            "when experiments have stopped",
        ),
        Metric::new(
            format!("a = {a:.2}: speed of the front at the end over sqrt(g H0)"),
            creep,
            Rule::Report(Some(0.0)),
            "at rest; [A] states about a thousandth of the collapse's speed",
        ),
        Metric::new(
            format!("a = {a:.2}: height over r0"),
            height,
            Rule::Report(None),
            "at the end",
        ),
    ]
}
