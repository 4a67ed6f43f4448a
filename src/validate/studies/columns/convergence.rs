//! What half and a quarter of the spacing change of a run-out.

use crate::validate::statistics::mean;
use crate::validate::template::point;
use crate::validate::{Effort, Member, Metric, Results, Rule};

use super::{COLUMNS, Column, R0, SERIES, STOPPING, seeds};

/// Fronts of the finer runs, taken at the coarse spacing's depth.
const DEEP_FRONTS: [&str; 2] = ["deep_front_left", "deep_front_right"];

impl Column {
    /// A finer run, whose fronts are also kept at the depth that they are taken at in the coarse one [m].
    fn fine(
        &self,
        kind: &str,
        (seed, spacing): (u32, f64),
        until: f64,
        depth: f64,
    ) -> Result<Member, String> {
        let mut template = self.template(seed, spacing, until)?;
        for (gauge, side) in DEEP_FRONTS.into_iter().zip([-1.0, 1.0]) {
            let key = |key: &str| format!("gauges.{gauge}.{key}");
            template = template
                .with(&key("kind"), "front")
                .with(&key("origin"), point(0.0, 0.0))
                .with(&key("direction"), point(side, 0.0))
                .with(&key("least_depth"), depth);
        }
        let deep = DEEP_FRONTS.map(|gauge| format!("gauge.{gauge}.front"));
        let series = [&SERIES[..], &[&deep[0], &deep[1]]].concat();
        let name = self.name(kind, seed);
        Ok(Member::new(
            name,
            template.text()?,
            &series,
            self.pictures(seed),
        ))
    }
}

/// The column a = 0.90 at finer spacings.
pub(super) fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let middle = COLUMNS[2];
    let mut members = Vec::new();
    let until = 2.0 * STOPPING * middle.fall();
    let [coarse, half, quarter] = effort
        .pick([1.0, 0.5, 0.25], [2.5, 1.5, 1.2])
        .map(|share| share * middle.spacing);
    for seed in 1..=effort.pick(3, 1) {
        members.push(middle.fine("fine_", (seed, half), until, coarse)?);
    }
    members.push(middle.fine("finest_", (1, quarter), until, coarse)?);
    Ok(members)
}

/// Changes of the run-out of a = 0.90 with the spacing.
pub(super) fn judge(results: &Results) -> [Metric; 4] {
    let column = &COLUMNS[2];
    let own = |kind: &str| mean(&seeds(results, column, kind).run_outs);
    let deep = |kind: &str| mean(&deep_run_outs(results, column, kind));
    let change =
        |coarse: Option<f64>, fine: Option<f64>| coarse.zip(fine).map(|(c, f)| (f / c - 1.0).abs());
    let metric = |spacings: &str, depths: &str, value, rule, why| {
        let name = format!("a = 0.90: change of run-out from {spacings}, {depths}");
        Metric::new(name, value, rule, why)
    };
    let (asked, further) = ("dp to dp/2", "dp/2 to dp/4");
    let (by_own, by_deep) = (
        "each front at a depth of its own spacing",
        "both fronts at a depth of dp",
    );
    let one_seed = "asked of dp to dp/2; one seed at dp/4";
    [
        metric(
            asked,
            by_own,
            change(own(""), own("fine_")),
            Rule::AtMost(0.03),
            "resolution is no part of the result; three seeds at dp/2. Part of it is that a front of half the depth lies further out",
        ),
        metric(
            asked,
            by_deep,
            change(own(""), deep("fine_")),
            Rule::AtMost(0.03),
            "the same quantity of both runs",
        ),
        metric(
            further,
            by_own,
            change(own("fine_"), own("finest_")),
            Rule::Report(None),
            one_seed,
        ),
        metric(
            further,
            by_deep,
            change(deep("fine_"), deep("finest_")),
            Rule::Report(None),
            one_seed,
        ),
    ]
}

/// Run-outs of the finer runs of a kind by the fronts of the coarse depth.
fn deep_run_outs(results: &Results, column: &Column, kind: &str) -> Vec<f64> {
    let prefix = column.name(kind, 0);
    let prefix = prefix.trim_end_matches('0');
    let found = results.starting(prefix).map(|(_, recording)| {
        let ends = DEEP_FRONTS.map(|gauge| recording.last(&format!("gauge.{gauge}.front")));
        let [left, right] = ends;
        Some((0.5 * (left? + right?) - R0) / R0)
    });
    found.flatten().collect()
}
