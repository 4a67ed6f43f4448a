//! `silted_depths`: the silted dams of [B] 3.2, four depths of silt and a grid study of one of them.

mod figures;

use crate::validate::statistics::{first_reaching, rms};
use crate::validate::template::{Template, point, points, rectangle};
use crate::validate::{Effort, Member, Metric, Recording, Report, Results, Rule, Snapshot, Study};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "silted_depths",
    title: "Silted dams: four depths of silt, and resolution",
    about: "The dams of Vosoughi et al. (2020) as Monge-Gapper et al. (2024), section 3.2, have them: a tank of 6 m, at 1.52 m a dam with \
0.30 m of silt and water behind it and 50 mm of water before it, lifted at 6 m/s; 10, 50, 66 and 80 % of the 0.30 m are silt (1990 kg/m^3, \
30 degrees, saturated). Default scheme, one set of numerical parameters, sound speed 10 sqrt(g H) = 17.2 m/s, `cases/phases/silted_dam_66.toml` \
with other fills, 6 s; 66 % also at other spacings to 2 s.\n\n\
The measured hydrographs are published as figures only. What can be judged: that runs reach their end; that pressure is smooth \
(root of the mean square of a particle's pressure less the mean of those within two spacings, over rho_w g H, particles \
that have the mean number of neighbours or more); that the water over 10 % of silt comes as late as Stoker's bore over no silt at all; \
and how far results change with the spacing.",
    members,
    analyse,
};

const TEMPLATE: &str = include_str!("../../../cases/phases/silted_dam_66.toml");
const DEPTH: f64 = 0.3;
const GRAVITY: f64 = 9.81;
/// Where the dam stands, and the end of the tank [m].
const DAM: f64 = 1.52;
const TANK: f64 = 6.0;
/// x/L = 0.5, 1.0, 1.7, by name in the scene.
const PLACES: [(&str, f64); 3] = [("0_5", 0.76), ("1_0", 1.54), ("1_7", 2.584)];
const LEFT: &str = "gauge.silt_over_sill.mass";
/// Of silt, in percent of the depth.
const SHARES: [u32; 4] = [10, 50, 66, 80];
/// That of the grid study.
const GRID: u32 = 66;
/// Bore of 0.30 m over 0.05 m of clear water: its speed [m/s], and the depth half way up [m] (Stoker 1957).
const BORE: (f64, f64) = (1.641, 0.0963);

/// A run: silt [%], spacing [mm], end [s].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Dam {
    share: u32,
    spacing: f64,
    until: f64,
}

impl Dam {
    fn name(&self) -> String {
        format!("silt_{}_{}mm", self.share, self.spacing)
    }

    fn member(&self) -> Result<Member, String> {
        let dp = 1e-3 * self.spacing;
        let rows = |x: f64| (x / dp).round() * dp;
        let (dam, silt, full) = (
            rows(DAM),
            rows(1e-2 * f64::from(self.share) * DEPTH),
            rows(DEPTH),
        );
        // A plate of four rows, and what stands before it a row further off.
        let (plate, before) = (4.0 * dp, dam + 5.0 * dp);
        let end = before + rows(TANK - before);
        let mut template = Template::new(TEMPLATE)?
            .with("numerics.spacing", dp)
            .with("bodies.silt.box", rectangle([0.0, 0.0], [dam, silt]))
            .with("bodies.reservoir.box", rectangle([0.0, silt], [dam, full]))
            .with(
                "bodies.downstream.box",
                rectangle([before, 0.0], [end, rows(0.05)]),
            )
            .with(
                "walls.tank.polyline",
                points(&[[0.0, 1.5], [0.0, 0.0], [end, 0.0], [end, 1.5]]),
            )
            .with("gates.dam.from", point(dam, 0.0))
            .with("gates.dam.to", point(dam, 0.32))
            .with("gates.dam.thickness", plate)
            .with("gauges.silt_over_sill.upper", point(dam, 0.6))
            .with("run.until", self.until);
        for section in ["water_out", "silt_out"] {
            template = template
                .with(&format!("gauges.{section}.from"), point(dam, 0.0))
                .with(&format!("gauges.{section}.to"), point(dam, 0.6));
        }
        template = with_profiles(template);
        let series = series();
        let series: Vec<&str> = series.iter().map(String::as_str).collect();
        let snapshots = [0.5, 1.0, 2.0, 4.0, 6.0];
        let snapshots = snapshots.into_iter().filter(|t| *t <= self.until);
        Ok(Member::new(
            self.name(),
            template.text()?,
            &series,
            snapshots.collect(),
        ))
    }
}

/// Adds gauges of the surface and of the bed of silt.
fn with_profiles(mut template: Template) -> Template {
    for (name, material) in [("surface", None), ("bed", Some("silt"))] {
        let key = |key: &str| format!("gauges.{name}.{key}");
        template = template
            .with(&key("kind"), "profile")
            .with(&key("from"), point(0.02, 0.0))
            .with(&key("to"), point(4.02, 0.0))
            .with(&key("count"), 201_i64);
        if let Some(material) = material {
            template = template.with(&key("material"), material);
        }
    }
    template
}

/// Outputs that are kept.
fn series() -> Vec<String> {
    let depths = PLACES
        .iter()
        .flat_map(|(place, _)| ["level", "silt"].map(|what| format!("gauge.{what}_{place}.depth")));
    let others = [LEFT, "gauge.surface.depth", "gauge.bed.depth"].map(str::to_owned);
    depths.chain(others).collect()
}

/// Spacings at which all depths are run to the end, coarse and as asked; and those of the grid study beside them [mm].
fn spacings(effort: Effort) -> ([f64; 2], [f64; 2]) {
    effort.pick(([6.0, 3.0], [4.0, 2.0]), ([30.0, 25.0], [28.0, 22.0]))
}

fn dams(effort: Effort) -> Vec<Dam> {
    let ([coarse, asked], between) = spacings(effort);
    let until = effort.pick(6.0, 0.2);
    let dam = |share, spacing, until| Dam {
        share,
        spacing,
        until,
    };
    let all = |spacing: f64| SHARES.map(|share| dam(share, spacing, until));
    let grid = |spacing: f64| dam(GRID, spacing, until.min(2.0));
    let mut dams = all(coarse).to_vec();
    dams.push(grid(between[0]));
    dams.extend(all(asked));
    dams.push(grid(between[1]));
    dams
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    dams(effort).iter().map(Dam::member).collect()
}

/// Root of the mean square of p less the mean of those within two spacings, over rho_w g H.
fn roughness(snapshot: &Snapshot, spacing: f64) -> Option<f64> {
    let reach = 2.0 * spacing;
    let cell = |x: &[f32; 3]| [0, 1].map(|k| (f64::from(x[k]) / reach).floor() as i64);
    let mut cells: std::collections::HashMap<[i64; 2], Vec<usize>> = Default::default();
    for (i, x) in snapshot.position.iter().enumerate() {
        cells.entry(cell(x)).or_default().push(i);
    }
    let near = |i: usize| {
        let x = &snapshot.position[i];
        let [a, b] = cell(x);
        let around = (-1..=1).flat_map(move |p| (-1..=1).map(move |q| [a + p, b + q]));
        let found = around.filter_map(|key| cells.get(&key)).flatten();
        let close = found.filter(|&&j| {
            let y = &snapshot.position[j];
            let d2: f64 = (0..2).map(|k| f64::from(x[k] - y[k]).powi(2)).sum();
            d2 <= reach * reach
        });
        let pressures = close.map(|&j| f64::from(snapshot.pressure[j]));
        pressures.fold((0.0, 0usize), |(sum, n), p| (sum + p, n + 1))
    };
    let sums: Vec<(f64, usize)> = (0..snapshot.position.len()).map(near).collect();
    let mean = sums.iter().map(|s| s.1).sum::<usize>() as f64 / sums.len().max(1) as f64;
    let deep = sums.iter().enumerate().filter(|(_, s)| s.1 as f64 >= mean);
    let errors: Vec<f64> = deep
        .map(|(i, (sum, n))| {
            (f64::from(snapshot.pressure[i]) - sum / *n as f64) / (1000.0 * GRAVITY * DEPTH)
        })
        .collect();
    rms(&errors)
}

fn judge(dam: &Dam, found: Option<&Recording>, metrics: &mut Vec<Metric>) {
    let what = format!("{} % silt, {} mm", dam.share, dam.spacing);
    metrics.push(
        Metric::new(
            format!("{what}: runs to its end"),
            found.and_then(|f| f.time.last().copied()),
            Rule::AtLeast(dam.until - 1e-6),
            "one set of numerical parameters for all",
        )
        .unit("s"),
    );
    let roughest = found.and_then(|f| {
        let each = f.snapshots.iter();
        let each = each.filter_map(|s| roughness(s, 1e-3 * dam.spacing));
        each.max_by(f64::total_cmp)
    });
    metrics.push(Metric::new(
        format!("{what}: roughness of pressure, the largest at 0.5, 1, 2, 4 and 6 s"),
        roughest,
        Rule::AtMost(0.03),
        "smooth: no checkerboard; a thirtieth of the water's own pressure",
    ));
    if dam.share == SHARES[0] {
        let arrival = found.and_then(|f| first_reaching(&f.curve("gauge.level_1_7.depth"), BORE.1));
        metrics.push(
            Metric::new(
                format!("{what}: the front comes to x/L = 1.7"),
                arrival,
                Rule::NearShare((PLACES[2].1 - DAM) / BORE.0, 0.1),
                "Stoker's bore, clear water, dam gone at once; as late as that or a little later",
            )
            .unit("s"),
        );
    }
    if let Some(found) = found.filter(|f| f.time.last() >= Some(&(dam.until - 1e-6))) {
        let start = found
            .series
            .get(LEFT)
            .and_then(|s| s.first()?.first().copied());
        let end = found.last(LEFT);
        metrics.push(Metric::new(
            format!("{what}: silt that stays behind the sill"),
            end.zip(start).map(|(end, start)| end / start),
            Rule::Report(None),
            "share of what was there",
        ));
    }
}

/// Root of the mean square of the difference of two hydrographs up to a time [m].
fn apart(one: &Recording, other: &Recording, gauge: &str, until: f64) -> Option<f64> {
    let (a, b) = (one.curve(gauge), other.curve(gauge));
    let pairs = a.iter().zip(&b).filter(|(a, _)| a.0 <= until + 1e-9);
    let errors: Vec<f64> = pairs.map(|(a, b)| a.1 - b.1).collect();
    rms(&errors)
}

fn analyse(results: &Results) -> Result<Report, String> {
    let mut report = Report::default();
    let dams = dams(results.effort);
    for dam in &dams {
        judge(dam, results.finished(&dam.name()), &mut report.metrics);
    }
    let mut grid: Vec<&Dam> = dams.iter().filter(|dam| dam.share == GRID).collect();
    grid.sort_by(|a, b| b.spacing.total_cmp(&a.spacing));
    for pair in grid.windows(2) {
        let found = [0, 1].map(|k| results.finished(&pair[k].name()));
        let until = pair[0].until.min(pair[1].until);
        for (what, name) in [("level", "levels"), ("silt", "beds")] {
            let largest = || {
                let each = PLACES.iter().map(|(place, _)| {
                    apart(
                        found[0]?,
                        found[1]?,
                        &format!("gauge.{what}_{place}.depth"),
                        until,
                    )
                });
                let each: Option<Vec<f64>> = each.collect();
                Some(each?.into_iter().fold(0.0, f64::max) / DEPTH)
            };
            report.metrics.push(Metric::new(
                format!(
                    "{GRID} % silt, {} mm against {} mm: hydrographs of {name}, the largest rms over H",
                    pair[0].spacing, pair[1].spacing
                ),
                largest(),
                Rule::Report(None),
                "what the spacing still changes, to 2 s",
            ));
        }
    }
    figures::draw(results, &dams, &mut report)?;
    report.notes.push(
        "Runs of 3 and 2 mm take hours: `sandgate validate silted_depths` goes on where it was stopped. The measured hydrographs and \
profiles are in figures only, so that nothing here is held against the experiment."
            .to_owned(),
    );
    Ok(report)
}
