//! Run-outs at half and at a quarter of the spacing.

use crate::validate::statistics::{mean, spread};
use crate::validate::template::point;
use crate::validate::{Effort, Member, Metric, Results, Rule};

use super::{COLUMNS, Column, R0, SERIES, seeds};

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

/// Seeds at half the spacing, in full and in quick studies.
pub(super) const FINE_SEEDS: [u32; 2] = [5, 1];
/// Half the spacing over the spacing, in full and in quick studies.
pub(super) const HALF: [f64; 2] = [0.5, 1.5];

/// A quarter of the spacing over the spacing, in full and in quick studies.
pub(super) const QUARTER: [f64; 2] = [0.25, 1.2];

/// All columns at half the spacing, and one seed of each at a quarter.
pub(super) fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let mut members = Vec::new();
    let [dp, half, quarter] =
        [[1.0, 2.5], HALF, QUARTER].map(|[full, quick]| effort.pick(full, quick));
    for column in &COLUMNS {
        let until = column.twice_stopping();
        let depth = dp * column.spacing;
        let run = |kind: &str, seed: u32, share: f64| {
            column.fine(kind, (seed, share * column.spacing), until, depth)
        };
        for seed in 1..=effort.pick(FINE_SEEDS[0], FINE_SEEDS[1]) {
            members.push(run("fine_", seed, half)?);
        }
        members.push(run("finest_", 1, quarter)?);
    }
    Ok(members)
}

/// Run-outs at half the spacing, and what finer spacings change.
pub(super) fn judge(results: &Results, column: &Column) -> Vec<Metric> {
    let a = column.aspect;
    let own = |kind: &str| mean(&seeds(results, column, kind).run_outs);
    let deep = |kind: &str| mean(&deep_run_outs(results, column, kind));
    let change =
        |coarse: Option<f64>, fine: Option<f64>| coarse.zip(fine).map(|(c, f)| (f / c - 1.0).abs());
    let (low, high) = column.planar_band();
    let mut metrics = vec![
        Metric::new(
            format!("a = {a:.2}, half the spacing: run-out"),
            own("fine_"),
            Rule::Between(low, high),
            "planar law, Lube 2005 and Lajeunesse 2005; the band is the spread of its printed prefactors",
        ),
        Metric::new(
            format!("a = {a:.2}, half the spacing: spread of run-outs"),
            spread(&seeds(results, column, "fine_").run_outs),
            Rule::AtMost(0.03),
            "what the arbitrary start may change: less than a third of the experiments' scatter of 10 %",
        ),
    ];
    let mut changes = |spacings: &str, [coarse, fine]: [[Option<f64>; 2]; 2], rules: [Rule; 2]| {
        let depths = [
            (
                "each front at a depth of its own spacing",
                "resolution is no part of the result; part of it is that a front of half the depth lies further out; one seed at a quarter",
            ),
            (
                "both fronts at a depth of [A]'s spacing",
                "without that part",
            ),
        ];
        for (k, (depth, why)) in depths.into_iter().enumerate() {
            let name = format!("a = {a:.2}: change of run-out from {spacings}, {depth}");
            metrics.push(Metric::new(name, change(coarse[k], fine[k]), rules[k], why));
        }
    };
    let (asked, told) = (Rule::AtMost(0.03), Rule::Report(None));
    let fine = [own("fine_"), deep("fine_")];
    let finest = [own("finest_"), deep("finest_")];
    changes(
        "half the spacing to a quarter",
        [fine, finest],
        [asked, told],
    );
    changes(
        "[A]'s spacing to half of it",
        [[own(""); 2], fine],
        [told; 2],
    );
    metrics
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
