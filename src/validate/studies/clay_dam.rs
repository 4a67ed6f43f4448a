//! `clay_dam`: the dam break of clay of [B] 3.1, each resolution against the next finer one; the scheme of [B] beside it.

use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::report::number;
use crate::validate::statistics::{mean, rms};
use crate::validate::template::Template;
use crate::validate::{
    Effort, Figure, Member, Metric, Recording, Report, Results, Rule, Study, Table,
};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "clay_dam",
    title: "Dam break of clay: convergence, and the scheme of Monge-Gapper et al.",
    about: "`cases/phases/clay_dam_break.toml`: 0.26 m by 0.13 m of clay (1540 kg/m^3, tau_0 = 30 Pa, K = 4.472 Pa s^n, n = 0.472) is let go \
at once over a floor without slip (Monge-Gapper et al. 2024, section 3.1, by the sound speed 16 m/s instead of 40). The profiles that \
they compare with are published as figures only, so that each resolution is held against the next finer one, at their times 0.5, 0.625 \
and 1 s: root of the mean square of the difference of depths over the initial 0.13 m, every 10 mm from the wall to 0.81 m. Where \
errors halve with the spacing, the finest one's own is as large as its difference from the one before.\n\n\
`paper_b` is their scheme with their smoothing length, at the coarsest spacing, over a floor without slip.",
    members,
    analyse,
};

const TEMPLATE: &str = include_str!("../../../cases/phases/clay_dam_break.toml");
const HEIGHT: f64 = 0.13;
const TIMES: [f64; 3] = [0.5, 0.625, 1.0];
const SURFACE: &str = "gauge.surface.depth";
const FRONT: &str = "gauge.front.front";
/// Places of the profile: the first and their distance [m].
const FEET: (f64, f64) = (0.01, 0.01);
/// Places whose mean leaves the surface's roughness out: 70 mm.
const WIDE: usize = 7;
const PAPER_B: &str = "paper_b";
/// Of the resolutions' curves, and of the other scheme's.
const COLOURS: [usize; 5] = [0, 1, 2, 3, 5];

/// Particles over the height, each twice those before.
fn rows(effort: Effort) -> [u32; 4] {
    effort.pick([22, 43, 87, 173], [8, 10, 12, 14])
}

fn member(name: String, template: Template, rows: u32) -> Result<Member, String> {
    let text = template
        .with("numerics.spacing", HEIGHT / f64::from(rows))
        .text()?;
    Ok(Member::new(name, text, &[SURFACE, FRONT], Vec::new()))
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let own = Template::new(TEMPLATE)?;
    let paper_b = own
        .clone()
        .with("numerics.scheme", "paper_b")
        .with("numerics.smoothing_ratio", 2.0)
        .with("numerics.courant", 0.25)
        .with("numerics.jitter", 0.0);
    let coarsest = rows(effort)[0];
    let mut members = vec![member(PAPER_B.to_owned(), paper_b, coarsest)?];
    for rows in rows(effort) {
        members.push(member(format!("rows_{rows}"), own.clone(), rows)?);
    }
    Ok(members)
}

/// Root of the mean square of the difference of two profiles at a time, each place the mean of so many beside each other, over the
/// initial height.
fn apart(one: &Recording, other: &Recording, time: f64, places: usize) -> Option<f64> {
    let means = |of: &Recording| -> Option<Vec<f64>> {
        let windows = of.values_at(SURFACE, time)?.windows(places);
        Some(windows.map(|w| mean(w).unwrap_or(f64::NAN)).collect())
    };
    let (a, b) = (means(one)?, means(other)?);
    let errors: Vec<f64> = a.iter().zip(&b).map(|(a, b)| (a - b) / HEIGHT).collect();
    rms(&errors)
}

fn curve(recording: &Recording, time: f64, name: String, colour: usize) -> Option<Curve> {
    let depths = recording.values_at(SURFACE, time)?.iter().enumerate();
    let points = depths.map(|(k, h)| (FEET.0 + FEET.1 * k as f64, *h));
    Some(Curve::new(name, points.collect(), Look::Line, colour))
}

/// Runs that came to their ends.
struct Runs<'a> {
    rows: [u32; 4],
    default: [Option<&'a Recording>; 4],
    paper_b: Option<&'a Recording>,
}

impl<'a> Runs<'a> {
    fn of(results: &'a Results) -> Self {
        let rows = rows(results.effort);
        Self {
            rows,
            default: rows.map(|rows| results.finished(&format!("rows_{rows}"))),
            paper_b: results.finished(PAPER_B),
        }
    }

    /// All with their names, the other scheme last.
    fn named(&self) -> impl Iterator<Item = (String, Option<&'a Recording>)> {
        let default = self.rows.iter().zip(self.default);
        let default = default.map(|(rows, found)| (format!("default, H/{rows}"), found));
        let theirs = (format!("paper_b, H/{}", self.rows[0]), self.paper_b);
        default.chain([theirs])
    }

    /// Differences between each resolution and the next finer one at a time, each place the mean of so many.
    fn differences(&self, time: f64, places: usize) -> [Option<f64>; 3] {
        let pair = |k: usize| apart(self.default[k]?, self.default[k + 1]?, time, places);
        [0, 1, 2].map(pair)
    }

    /// Whether results still change with the spacing at a time.
    fn convergence(&self, time: f64) -> Vec<Metric> {
        let steps = self.differences(time, 1);
        let smooth = self.differences(time, WIDE);
        let pairs = || self.rows.windows(2);
        let mut metrics = Vec::new();
        for (pair, step) in pairs().zip(steps) {
            let rule = if pair[1] == self.rows[3] {
                Rule::AtMost(0.01)
            } else {
                Rule::Report(None)
            };
            metrics.push(Metric::new(
                format!("{time} s: H/{} against H/{}, rms over H", pair[0], pair[1]),
                step,
                rule,
                "converged: the finest one's own error is of this order",
            ));
        }
        for (pair, step) in pairs().zip(smooth) {
            metrics.push(Metric::new(
                format!(
                    "{time} s: H/{} against H/{}, means over 70 mm",
                    pair[0], pair[1]
                ),
                step,
                Rule::Report(None),
                "without the surface's roughness",
            ));
        }
        let order = || Some((steps[0]? / steps[2]?).log2() / 2.0);
        metrics.push(Metric::new(
            format!("{time} s: order of these differences"),
            order(),
            Rule::AtLeast(0.5),
            "they fall with the spacing",
        ));
        metrics
    }

    fn fronts(&self) -> Table {
        let row = |(name, found): (String, Option<&Recording>)| {
            let found = found?;
            let front = |time| found.at(FRONT, time).map_or("-".to_owned(), number);
            let mut row = vec![name];
            row.extend(TIMES.map(front));
            row.extend([number(found.cpu), found.steps.to_string()]);
            Some(row)
        };
        Table {
            title: "Fronts (depth of one spacing) [m], and cost".to_owned(),
            head: ["run", "0.5 s", "0.625 s", "1 s", "CPU time [s]", "steps"]
                .map(str::to_owned)
                .to_vec(),
            rows: self.named().filter_map(row).collect(),
        }
    }

    fn profiles(&self, time: f64) -> Result<Figure, String> {
        let runs = self.named().zip(COLOURS);
        let curves = runs.filter_map(|((name, found), colour)| curve(found?, time, name, colour));
        Ok(Figure {
            name: format!("at_{}", (1000.0 * time).round()),
            caption: format!("Depth {time} s after the release (as [B], figures 3 to 7)"),
            svg: Chart {
                x: "x [m]".to_owned(),
                y: "depth [m]".to_owned(),
                curves: curves.collect(),
            }
            .svg()?,
        })
    }
}

fn analyse(results: &Results) -> Result<Report, String> {
    let runs = Runs::of(results);
    let mut report = Report::default();
    for time in TIMES {
        report.metrics.extend(runs.convergence(time));
    }
    report.tables.push(runs.fronts());
    for time in TIMES {
        report.figures.push(runs.profiles(time)?);
    }
    Ok(report)
}
