//! What a page shows of a log. Two readings: the first for the scales of colours and what stands once, the second packs
//! the snapshots, so that only one cloud is in memory at a time.

use super::ReportError;
use super::pack::{Cloud, PACKED, Scale};
use super::shots::Shot;
use crate::component::MassLedger;
use crate::record::{Body, Ending, Entry, LogReader, Standing, Survey, Table};
use crate::scene::{self, Scene};
use crate::wire::foxglove::{Pose, SceneEntity, SceneUpdate};
use crate::wire::messages::StepStats;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// Points of a curve in a page; longer logs show every n-th.
const MOST_ROWS: usize = 4000;
/// Lines for people in a page.
const MOST_LINES: usize = 500;

type Frames = BTreeMap<String, [f64; 7]>;

/// What a page shows of a log.
pub(super) struct Gathered {
    survey: Survey,
    table: Table,
    standing: Standing,
    /// Figures that stand.
    stats: Vec<StepStats>,
    shots: Vec<Shot>,
    /// Lines of figures in the log, those taken back among them: the account of mass holds on each.
    lines_checked: usize,
    mass_error: f64,
    lines: Vec<Value>,
    lines_left_out: usize,
    drawn: SceneUpdate,
    scene: Option<Scene>,
    scale: Scale,
    pub(super) snapshots: Vec<Value>,
}

impl Gathered {
    pub(super) fn read(log: &Path, most_bytes: usize) -> Result<Self, ReportError> {
        let mut gathered = Self {
            survey: Survey::of(log)?,
            table: Table::read(log, (f64::NEG_INFINITY, f64::INFINITY))?,
            standing: Standing::of(log)?,
            stats: Vec::new(),
            shots: Vec::new(),
            lines_checked: 0,
            mass_error: 0.0,
            lines: Vec::new(),
            lines_left_out: 0,
            drawn: SceneUpdate::default(),
            scene: None,
            scale: Scale::default(),
            snapshots: Vec::new(),
        };
        gathered.first_reading(log)?;
        // Base64 makes four bytes of three.
        let shots = gathered.shots.iter();
        let bytes: usize = shots.map(|shot| PACKED * shot.particles * 4 / 3).sum();
        let every = bytes.div_ceil(most_bytes.max(1)).max(1);
        gathered.second_reading(log, every)?;
        Ok(gathered)
    }

    /// Everything but the particles themselves.
    fn first_reading(&mut self, log: &Path) -> Result<(), ReportError> {
        let mut clouds = 0;
        for entry in LogReader::open(log)? {
            match entry? {
                Entry::Attachment { name, data, .. } if name == "scene.toml" => {
                    // Table::read refused what cannot be read.
                    self.scene = scene::parse("scene.toml", &String::from_utf8_lossy(&data)).ok();
                }
                Entry::Message { body, .. } => match body {
                    Body::Stats(stats) => self.add_stats(stats),
                    Body::Scene(update) => self.drawn = update,
                    Body::Log(_) if self.lines.len() >= MOST_LINES => self.lines_left_out += 1,
                    Body::Log(line) => {
                        let time = line.timestamp.unwrap_or_default();
                        let time = time.seconds as f64 + f64::from(time.nanos) * 1e-9;
                        let level = format!("{:?}", line.level());
                        self.lines.push(json!({
                            "time": time, "level": level, "name": line.name, "message": line.message,
                        }));
                    }
                    Body::Particles(cloud) => {
                        if self.standing.snapshot(clouds) {
                            self.shots.push(Shot::of(clouds, &cloud));
                        }
                        clouds += 1;
                    }
                    _ => {}
                },
                _ => {}
            }
        }
        for shot in &self.shots {
            self.scale.extend(&shot.scale);
        }
        self.include_solids();
        Ok(())
    }

    fn add_stats(&mut self, stats: StepStats) {
        let stands = self.standing.row(self.lines_checked);
        self.lines_checked += 1;
        let error = ledger(&stats).error();
        if self.mass_error == 0.0 && error != 0.0 {
            // NaN, which is an error as well, would become null.
            self.mass_error = if error.is_nan() { f64::MAX } else { error };
        }
        if stands {
            self.stats.push(stats);
        }
    }

    /// The picture has room for the corners of walls that are bounded, and a bit more.
    fn include_solids(&mut self) {
        let solids = self
            .drawn
            .entities
            .iter()
            .filter(|e| kind_of(e) != "outflow");
        let corners: Vec<[f64; 3]> = solids
            .flat_map(|entity| &entity.lines)
            .flat_map(|line| line.points.iter().map(|p| [p.x, p.y, p.z]))
            .collect();
        let domain = self
            .scene
            .as_ref()
            .map(|s| (s.domain.lower, s.domain.upper));
        let scale = &mut self.scale;
        for axis in 0..3 {
            for corner in &corners {
                let mut x = corner[axis];
                if let Some((lower, upper)) = domain
                    && lower[axis] < upper[axis]
                {
                    x = x.clamp(lower[axis], upper[axis]);
                }
                scale.lower[axis] = scale.lower[axis].min(x as f32);
                scale.upper[axis] = scale.upper[axis].max(x as f32);
            }
            if scale.lower[axis] > scale.upper[axis] {
                (scale.lower[axis], scale.upper[axis]) = (0.0, 1.0);
            }
        }
    }

    /// Packs every so many of the snapshots that stand, and the last.
    fn second_reading(&mut self, log: &Path, every: usize) -> Result<(), ReportError> {
        let mut frames = Frames::new();
        let last = self.snapshots_in_log().saturating_sub(1);
        let shots = self.shots.iter().enumerate();
        let mut shown = shots
            .filter(|(k, _)| k.is_multiple_of(every) || *k == last)
            .map(|(_, shot)| shot.number)
            .peekable();
        let mut number = 0;
        for entry in LogReader::open(log)? {
            match entry? {
                Entry::Message {
                    body: Body::Frame(frame),
                    ..
                } => {
                    frames.insert(frame.child_frame_id.clone(), posed(Some(&frame.pose())));
                }
                Entry::Message {
                    body: Body::Particles(cloud),
                    log_time,
                    ..
                } => {
                    if shown.next_if_eq(&number).is_some() {
                        let cloud = Cloud::of(&cloud);
                        self.snapshots.push(json!({
                            "time": log_time as f64 * 1e-9, "count": cloud.len(),
                            "frames": frames, "data": self.scale.pack(&cloud),
                        }));
                    }
                    number += 1;
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Snapshots of the log that were not taken back.
    pub(super) fn snapshots_in_log(&self) -> usize {
        self.shots.len()
    }

    pub(super) fn ending(&self) -> &Ending {
        &self.survey.ending
    }

    /// Every so many rows are shown.
    fn stride(&self) -> usize {
        self.table.time.len().div_ceil(MOST_ROWS).max(1)
    }

    /// The rows that are shown: every n-th and the last.
    fn shown<'a, T>(&self, values: &'a [T]) -> impl Iterator<Item = &'a T> {
        let (stride, last) = (self.stride(), values.len().saturating_sub(1));
        let chosen = move |k: &usize| k.is_multiple_of(stride) || *k == last;
        values
            .iter()
            .enumerate()
            .filter(move |(k, _)| chosen(k))
            .map(|(_, value)| value)
    }

    pub(super) fn rows(&self) -> usize {
        self.shown(&self.table.time).count()
    }

    /// All that the page's scripts read.
    pub(super) fn json(&self) -> Value {
        let scene = self.scene.as_ref();
        let survey = &self.survey;
        let wall = survey.published().map(|(a, b)| (b - a) as f64 * 1e-9);
        let run = survey.metadata("run").cloned().unwrap_or_default();
        let deterministic = run.get("deterministic").is_some_and(|d| d == "true");
        let mut bound_by: BTreeMap<&str, u64> = BTreeMap::new();
        let all = self.stats.iter();
        for stats in all.filter(|s| !s.bound_by.is_empty()) {
            *bound_by.entry(&stats.bound_by).or_default() += 1;
        }
        json!({
            "file": survey.path.file_name().unwrap_or_default().to_string_lossy(),
            "ending": survey.ending.to_string(),
            "run": run,
            "end": survey.metadata("end"),
            "recovered": survey.metadata("recovered").is_some(),
            "wall_seconds": wall.filter(|_| !deterministic),
            "time": self.shown(&self.table.time).collect::<Vec<_>>(),
            "step": self.shown(&self.table.step).collect::<Vec<_>>(),
            "columns": self.columns(),
            "stats": self.stats_columns(),
            "bound_by": bound_by,
            "mass_error": self.mass_error,
            "lines_checked": self.lines_checked,
            "lines": self.lines,
            "lines_left_out": self.lines_left_out,
            "channels": survey.channels.iter().filter(|(_, c)| c.messages > 0).map(|(topic, c)| {
                json!({"topic": topic, "messages": c.messages, "schema": c.schema})
            }).collect::<Vec<_>>(),
            "planar": scene.is_none_or(|s| s.dimension.axes() == 2),
            "spacing": self.spacing(),
            "materials": scene.map_or_else(Vec::new, |s| {
                s.materials.iter().map(|m| m.name.clone()).collect()
            }),
            "solids": self.drawn.entities.iter().map(solid).collect::<Vec<_>>(),
            "snapshots": self.snapshots,
            "scale": {
                "lower": self.scale.lower, "upper": self.scale.upper, "speed": self.scale.speed,
                "pressure": self.scale.pressure, "inertial": self.scale.inertial,
            },
            "view_note": self.view_note(),
        })
    }

    /// Particle spacing [m]: what the log's end or beginning says was in use, else the scene's; 0 if none says.
    fn spacing(&self) -> f64 {
        let told = |record: &str| self.survey.metadata(record)?.get("spacing")?.parse().ok();
        let of_scene = || self.scene.as_ref().map(|s| s.numerics.spacing);
        let spacing = told("end").or_else(|| told("run")).or_else(of_scene);
        spacing.unwrap_or(0.0)
    }

    fn view_note(&self) -> String {
        let (shown, all) = (self.snapshots.len(), self.snapshots_in_log());
        let mut note = match (shown, all) {
            (_, 0) => "The log holds no particle snapshots (log.particles_every).".to_owned(),
            (a, b) if a == b => format!("{a} snapshots."),
            (a, b) => format!("{a} of the log's {b} snapshots, to keep this page small."),
        };
        if all > 0 {
            note.push_str(
                " Colours end where 99 % of the particles of the liveliest snapshot are.",
            );
        }
        if self.stride() > 1 {
            note.push_str(&format!(
                " Curves show every {}th communication point.",
                self.stride()
            ));
        }
        note
    }

    fn columns(&self) -> Vec<Value> {
        let columns = self.table.columns.iter();
        columns
            .map(|column| {
                json!({
                    "name": column.name, "unit": column.unit, "input": column.is_input,
                    "flag": column.is_flag, "values": self.shown(&column.values).collect::<Vec<_>>(),
                })
            })
            .collect()
    }

    fn stats_columns(&self) -> Value {
        let mut columns = Map::new();
        let mut add = |name: &str, of: &dyn Fn(&StepStats) -> f64| {
            let values: Vec<f64> = self.shown(&self.stats).map(of).collect();
            columns.insert(name.to_owned(), values.into());
        };
        add("substeps", &|s| f64::from(s.substeps));
        add("iterations", &|s| f64::from(s.iterations));
        add("step_size", &|s| s.step_size);
        // The first line is the start, before any step.
        add("smallest_step", &|s| {
            if s.substeps == 0 {
                f64::NAN
            } else {
                s.smallest_step
            }
        });
        add("particles", &|s| s.particles as f64);
        add("kinetic_energy", &|s| s.kinetic_energy);
        add("max_speed", &|s| s.max_speed);
        add("share_dilute", &|s| s.share_dilute);
        add("share_asleep", &|s| s.share_asleep);
        add("total_substeps", &|s| s.total_substeps as f64);
        add("initial", &|s| ledger(s).initial);
        add("inflow", &|s| ledger(s).inflow);
        add("outflow", &|s| ledger(s).outflow);
        add("present", &|s| ledger(s).present);
        Value::Object(columns)
    }
}

fn ledger(stats: &StepStats) -> MassLedger {
    let account = stats.ledger.clone().unwrap_or_default();
    MassLedger {
        initial: account.initial,
        inflow: account.inflow,
        outflow: account.outflow,
        present: account.present,
    }
}

fn kind_of(entity: &SceneEntity) -> &str {
    entity.id.split('.').next().unwrap_or_default()
}

/// A thing drawn, as the player reads it.
fn solid(entity: &SceneEntity) -> Value {
    let lines = entity.lines.iter().map(|line| {
        let points = line.points.iter().map(|p| [p.x, p.y, p.z]);
        points.collect::<Vec<_>>()
    });
    let boxes = entity.cubes.iter().map(|cube| {
        let size = cube.size.clone().unwrap_or_default();
        json!({"pose": posed(cube.pose.as_ref()), "size": [size.x, size.y, size.z]})
    });
    let label = entity.texts.first().map(|text| {
        let [x, y, z, ..] = posed(text.pose.as_ref());
        [x, y, z]
    });
    json!({
        "id": entity.id, "kind": kind_of(entity), "frame": entity.frame_id,
        "lines": lines.collect::<Vec<_>>(), "boxes": boxes.collect::<Vec<_>>(), "label": label,
    })
}

/// Position, then orientation as x y z w.
fn posed(pose: Option<&Pose>) -> [f64; 7] {
    let p = pose.and_then(|p| p.position.clone()).unwrap_or_default();
    let q = pose.and_then(|p| p.orientation.clone());
    let [x, y, z, w] = q.map_or([0.0, 0.0, 0.0, 1.0], |q| [q.x, q.y, q.z, q.w]);
    [p.x, p.y, p.z, x, y, z, w]
}
