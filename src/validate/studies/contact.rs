//! `contact_dynamics`: planar columns against discs computed one by one.

mod discs;
mod figures;

use self::discs::{CHECKED, COLUMNS, Discs, HEIGHT, fall};
use super::choices;
use super::columns::front;
use crate::validate::csv;
use crate::validate::statistics::{interpolate, mean};
use crate::validate::{Metric, Recording, Report, Results, Rule, Study};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "contact_dynamics",
    title: "Collapse of planar columns against contact dynamics of discs",
    about: "Columns of discs of aspect ratio 0.49 and 6.26 by Staron and Hinch (contact dynamics, friction 0.5, restitution \
0.5; J. Fluid Mech. 545 (2005) 1-27), H0/d = 30 and 134, against the default scheme at dp = d with the material that Lagrée, \
Staron and Popinet (J. Fluid Mech. 686 (2011) 378-408) fitted to such discs: mu_s 0.32, mu_2 0.60, I0 0.40. Their I holds the \
bulk density, ours that of the grains, so that our I0 is 0.40/sqrt(phi_max). Lengths are over H0, times over sqrt(H0/g).\n\n\
Profile error: mean of abs(h - h_discs)/H0 over the places of the data at which either is above 0, both sides averaged, mean \
of three seeds. Front: outermost place with a depth of one grain, mean of both sides.",
    members: discs::members,
    analyse,
};

const FRONTS: &str = include_str!("../../../cases/reference/contact_dynamics_fronts.csv");
const PROFILES: &str = "column_collapse_dem_profiles.csv";
/// Times at which profiles are compared, over sqrt(H0/g); the discs rest from five on.
const TIMES: [f64; 4] = [1.0, 2.0, 3.0, 6.0];

/// Depths of the discs at one time: (x, h), both over H0.
type Profile = Vec<(f64, f64)>;

/// The discs' profile of a column at a time.
fn discs_at(rows: &[[f64; 4]], column: &Discs, time: f64) -> Profile {
    let mine = rows
        .iter()
        .filter(|[a, t, ..]| *a == column.aspect && *t == time);
    mine.map(|[.., x, h]| (*x, *h)).collect()
}

/// Mean of |h - h_discs| over places where either is above 0; depths at multiples of `place`, all over H0.
fn profile_error(depths: &[f64], place: f64, discs: &Profile) -> Option<f64> {
    let last = discs.last()?.0;
    let pairs = depths.iter().enumerate().map(|(k, &h)| {
        let x = k as f64 * place;
        let known = if x > last + 0.5 * place {
            0.0
        } else {
            interpolate(discs, x).unwrap_or(0.0)
        };
        (h, known)
    });
    let errors: Vec<f64> = pairs
        .filter(|(h, known)| *h > 0.0 || *known > 0.0)
        .map(|(h, known)| (h - known).abs())
        .collect();
    mean(&errors)
}

fn analyse(results: &Results) -> Result<Report, String> {
    let fronts = csv::columns(FRONTS, ["a", "t", "front", "centre"])?;
    let profiles = match results.data(PROFILES)? {
        Some(text) => csv::columns(&text, ["a", "t", "x", "h"])?,
        None => Vec::new(),
    };
    let mut report = Report::default();
    for column in &COLUMNS {
        report
            .metrics
            .extend(judge_profiles(results, column, &profiles));
        report
            .metrics
            .extend(judge_fronts(results, column, &fronts));
        report
            .figures
            .push(figures::profiles(results, column, &profiles)?);
    }
    let changes = TIMES.map(|time| {
        let what = format!("a = {}, t = {time} sqrt(H0/g)", CHECKED.aspect);
        (what, CHECKED.changes(results, time))
    });
    report.tables.push(choices::table(
        "Mean change of the profile by each choice of the scheme, over H0".to_owned(),
        &changes,
    ));
    report.figures.push(figures::fronts(results, &fronts)?);
    if profiles.is_empty() {
        report.notes.push(format!(
            "The discs' profiles are not part of this repository (cases/reference/SOURCE.md); give the folder of {PROFILES} \
             with `--data` to compare with them. Fronts and heights are compared in any case."
        ));
    }
    Ok(report)
}

fn recordings<'a>(results: &'a Results, column: &'a Discs) -> Vec<&'a Recording> {
    results.starting(column.name).map(|(_, r)| r).collect()
}

fn judge_profiles(results: &Results, column: &Discs, rows: &[[f64; 4]]) -> Vec<Metric> {
    let error = |time: f64| {
        let known = discs_at(rows, column, time);
        let runs = recordings(results, column).into_iter();
        let errors =
            runs.filter_map(|r| profile_error(&column.profile(r, time)?, column.place, &known));
        mean(&errors.collect::<Vec<_>>())
    };
    let judge = |time: f64| {
        let metric = Metric::new(
            format!(
                "a = {}: profile at t = {time} sqrt(H0/g), mean error over H0",
                column.aspect
            ),
            error(time),
            Rule::AtMost(0.03),
            "Staron and Hinch, read from a figure; 0.03 is one grain of the low column and twice the scatter of their surface",
        );
        if column.name == CHECKED.name {
            metric.changed_by(column.changes(results, time))
        } else {
            metric
        }
    };
    TIMES.into_iter().map(judge).collect()
}

fn judge_fronts(results: &Results, column: &Discs, rows: &[[f64; 4]]) -> Vec<Metric> {
    let found = |time: f64| {
        let at = |r: &Recording| interpolate(&front(r), time * fall()).map(|x| x / HEIGHT);
        mean(
            &recordings(results, column)
                .into_iter()
                .filter_map(at)
                .collect::<Vec<_>>(),
        )
    };
    let centre = |time: f64| {
        let at = |r: &Recording| {
            r.at("gauge.depth_centre.depth", time * fall())
                .map(|h| h / HEIGHT)
        };
        mean(
            &recordings(results, column)
                .into_iter()
                .filter_map(at)
                .collect::<Vec<_>>(),
        )
    };
    let mine = rows
        .iter()
        .filter(|row| row[0] == column.aspect && row[1] > 0.0);
    let mut metrics = Vec::new();
    for [_, time, known, height] in mine {
        let at = format!("a = {}, t = {time} sqrt(H0/g)", column.aspect);
        let (rule, why) = if *time == 6.0 {
            (
                Rule::NearShare(*known, 0.12),
                "Staron and Hinch, at rest; mu(I) is known to arrest some 10 % short, as the front is dilute",
            )
        } else {
            (Rule::Report(Some(*known)), "Staron and Hinch, on the way")
        };
        metrics.push(Metric::new(
            format!("{at}: front over H0"),
            found(*time),
            rule,
            why,
        ));
        if *time == 6.0 {
            metrics.push(Metric::new(
                format!("{at}: height of the centre over H0"),
                centre(*time),
                Rule::Report(Some(*height)),
                "Staron and Hinch",
            ));
        }
    }
    metrics
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn profile_errors_of_known_profiles() {
        let discs = vec![(0.0, 1.0), (0.2, 0.5), (0.4, 0.0)];
        assert_eq!(profile_error(&[1.0, 0.5, 0.0, 0.0], 0.2, &discs), Some(0.0));
        // 0.3 too high at the first three places, and one place further out.
        let error = profile_error(&[1.3, 0.8, 0.3, 0.3, 0.0], 0.2, &discs).unwrap();
        assert!((error - 0.3).abs() < 1e-12, "{error}");
        // Shorter than the discs: what is missing counts.
        assert_eq!(profile_error(&[1.0, 0.0, 0.0], 0.2, &discs), Some(0.25));
        assert_eq!(profile_error(&[1.0], 0.2, &Vec::new()), None);
    }

    #[test]
    fn the_data_are_read_by_column_and_time() {
        let rows = csv::columns(FRONTS, ["a", "t", "front", "centre"]).unwrap();
        assert_eq!(rows.len(), 14);
        let all = [
            [0.49, 1.0, 0.2, 0.9],
            [0.49, 2.0, 0.2, 0.8],
            [6.26, 1.0, 0.2, 0.7],
        ];
        assert_eq!(discs_at(&all, &COLUMNS[0], 2.0), vec![(0.2, 0.8)]);
    }
}
