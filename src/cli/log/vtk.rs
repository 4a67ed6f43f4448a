//! Particles, walls and gates of a log as VTK: one `.vtp` a snapshot (XML with raw little-endian numbers behind it) and
//! `.pvd` files that give their times to ParaView. Snapshots of steps that were taken back are left out.

use std::collections::HashMap;
use std::io::{BufWriter, Write};
use std::path::Path;

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion};

use super::Window;
use super::export::{cannot_write, create};
use crate::cli::CliError;
use crate::record::{Body, Ending, Entry, LogReader, Standing};
use crate::wire::foxglove::{PointCloud, Pose, SceneEntity, SceneUpdate};

/// Writes what is in `window` to the new folder `folder`, all or nothing; gives a line for people and how the log ends.
///
/// # Errors
/// [`CliError::Read`], [`CliError::File`].
pub(super) fn write(
    log: &Path,
    folder: &Path,
    window: &Window,
) -> Result<(String, Ending), CliError> {
    std::fs::create_dir(folder).map_err(|source| CliError::File {
        action: "make folder",
        path: folder.to_owned(),
        source,
        remedy: "choose a name that is free",
    })?;
    let written = fill(log, folder, window);
    if written.is_err() {
        // It is new, and what is in it ours.
        let _ = std::fs::remove_dir_all(folder);
    }
    written
}

/// Writes them to this empty folder.
fn fill(log: &Path, folder: &Path, window: &Window) -> Result<(String, Ending), CliError> {
    let mut scene = SceneUpdate::default();
    let mut frames: HashMap<String, Isometry3<f64>> = HashMap::new();
    let (mut particles, mut walls) = (Vec::new(), Vec::new());
    let (standing, mut snapshots) = (Standing::of(log)?, 0..);
    let mut reader = LogReader::open(log)?;
    for entry in reader.by_ref() {
        let Entry::Message { log_time, body, .. } = entry? else {
            continue;
        };
        match body {
            Body::Scene(update) => scene = update,
            Body::Frame(frame) => {
                frames.insert(frame.child_frame_id.clone(), posed(Some(&frame.pose())));
            }
            Body::Particles(cloud) => {
                let stands = snapshots.next().is_some_and(|k| standing.snapshot(k));
                if !(stands && window.has(log_time)) {
                    continue;
                }
                let (time, number) = (time_of(&cloud, log_time), particles.len());
                let name = format!("particles-{number:06}.vtp");
                save(&folder.join(&name), &particle_data(&cloud))?;
                particles.push((time, name));
                let moves = scene
                    .entities
                    .iter()
                    .any(|e| frames.contains_key(&e.frame_id));
                if moves || walls.is_empty() {
                    let name = format!("walls-{number:06}.vtp");
                    save(&folder.join(&name), &solid_data(&scene, &frames))?;
                    walls.push((time, name));
                }
            }
            _ => {}
        }
    }
    for (name, list) in [("particles.pvd", &particles), ("walls.pvd", &walls)] {
        let path = folder.join(name);
        let mut file = create(&path)?;
        file.write_all(collection(list).as_bytes())
            .map_err(|e| cannot_write(&path, e))?;
    }
    let mut line = format!(
        "{}: {} snapshots; open particles.pvd and walls.pvd",
        folder.display(),
        particles.len()
    );
    if snapshots.start == 0 {
        line += &format!(
            "\nnote: the log holds no particles. `sandgate log redrive {} --log NEW.mcap --particles-every '20 ms'` makes one that does.",
            log.display()
        );
    }
    Ok((line, reader.ending().cloned().unwrap_or_default()))
}

/// Simulated time of a snapshot [s]: its own stamp, since a message's log time is 0 before 0.
fn time_of(cloud: &PointCloud, log_time: u64) -> f64 {
    let own = cloud.timestamp.as_ref();
    let own = own.map(|t| i128::from(t.seconds) * 1_000_000_000 + i128::from(t.nanos));
    own.unwrap_or(i128::from(log_time)) as f64 / 1e9
}

/// Points, cells over them, and values of either.
#[derive(Default)]
struct PolyData {
    points: Vec<f32>,
    verts: Cells,
    lines: Cells,
    polys: Cells,
    point_data: Vec<(String, usize, Vec<f32>)>,
    /// One number a cell, in the order verts, lines, polys.
    kind: Vec<f32>,
}

/// Corners of each cell, one cell after the other, and where each ends.
#[derive(Default)]
struct Cells {
    corners: Vec<i64>,
    ends: Vec<i64>,
}

impl Cells {
    fn add(&mut self, corners: impl Iterator<Item = i64>) {
        self.corners.extend(corners);
        self.ends.push(self.corners.len() as i64);
    }
}

fn particle_data(cloud: &PointCloud) -> PolyData {
    let count = cloud.points().len();
    let column = |name: &str| cloud.column(name);
    let vector = |names: [&str; 3]| -> Vec<f32> {
        let [x, y, z] = names.map(column);
        (0..count).flat_map(|i| [x[i], y[i], z[i]]).collect()
    };
    let mut data = PolyData {
        points: vector(["x", "y", "z"]),
        ..PolyData::default()
    };
    for i in 0..count {
        data.verts.add(std::iter::once(i as i64));
    }
    data.point_data
        .push(("velocity".to_owned(), 3, vector(["vx", "vy", "vz"])));
    for name in ["pressure", "inertial_number", "phase", "asleep"] {
        data.point_data.push((name.to_owned(), 1, column(name)));
    }
    data
}

/// Lines and boxes where they are now.
fn solid_data(scene: &SceneUpdate, frames: &HashMap<String, Isometry3<f64>>) -> PolyData {
    let mut data = PolyData::default();
    let (mut of_lines, mut of_polys) = (Vec::new(), Vec::new());
    for entity in &scene.entities {
        let frame = frames.get(&entity.frame_id).copied().unwrap_or_default();
        let kind = kind_of(entity);
        for line in &entity.lines {
            let first = data.points.len() as i64 / 3;
            for p in &line.points {
                push(&mut data.points, &(frame * Point3::new(p.x, p.y, p.z)));
            }
            let after = first + line.points.len() as i64;
            data.lines.add(first..after);
            of_lines.push(kind);
        }
        for cube in &entity.cubes {
            let own = frame * posed(cube.pose.as_ref());
            let half = cube.size.clone().unwrap_or_default();
            let first = data.points.len() as i64 / 3;
            for corner in 0..8 {
                let side = |bit: i32, size: f64| {
                    if corner & bit == 0 {
                        -0.5 * size
                    } else {
                        0.5 * size
                    }
                };
                let p = Point3::new(side(1, half.x), side(2, half.y), side(4, half.z));
                push(&mut data.points, &(own * p));
            }
            for face in [
                [0, 2, 3, 1],
                [4, 5, 7, 6],
                [0, 1, 5, 4],
                [2, 6, 7, 3],
                [0, 4, 6, 2],
                [1, 3, 7, 5],
            ] {
                data.polys.add(face.into_iter().map(|k| first + k));
                of_polys.push(kind);
            }
        }
    }
    data.kind = of_lines;
    data.kind.append(&mut of_polys);
    data
}

fn push(points: &mut Vec<f32>, point: &Point3<f64>) {
    points.extend(point.iter().map(|&c| c as f32));
}

/// 0 wall, 1 gate, 2 inflow, 3 outflow, 4 gauge.
fn kind_of(entity: &SceneEntity) -> f32 {
    match entity.id.split('.').next() {
        Some("wall") => 0.0,
        Some("gate") => 1.0,
        Some("inflow") => 2.0,
        Some("outflow") => 3.0,
        _ => 4.0,
    }
}

fn posed(pose: Option<&Pose>) -> Isometry3<f64> {
    let position = pose.and_then(|p| p.position.clone()).unwrap_or_default();
    let turn = pose.and_then(|p| p.orientation.clone());
    let turn = turn.map_or(Quaternion::identity(), |q| {
        Quaternion::new(q.w, q.x, q.y, q.z)
    });
    Isometry3::from_parts(
        Translation3::new(position.x, position.y, position.z),
        UnitQuaternion::new_normalize(turn),
    )
}

/// The blocks behind the XML: each with its length before it.
#[derive(Default)]
struct Appended {
    bytes: Vec<u8>,
}

impl Appended {
    fn array<const N: usize>(
        &mut self,
        kind: &str,
        name: &str,
        components: usize,
        values: impl ExactSizeIterator<Item = [u8; N]>,
    ) -> String {
        let offset = self.bytes.len();
        self.bytes
            .extend((values.len() as u64 * N as u64).to_le_bytes());
        values.for_each(|value| self.bytes.extend(value));
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
             format=\"appended\" offset=\"{offset}\"/>\n"
        )
    }

    fn floats(&mut self, name: &str, components: usize, values: &[f32]) -> String {
        let values = values.iter().map(|v| v.to_le_bytes());
        self.array("Float32", name, components, values)
    }

    fn cells(&mut self, tag: &str, cells: &Cells) -> String {
        let corners = cells.corners.iter().map(|v| v.to_le_bytes());
        let connectivity = self.array("Int64", "connectivity", 1, corners);
        let ends = cells.ends.iter().map(|v| v.to_le_bytes());
        let offsets = self.array("Int64", "offsets", 1, ends);
        format!("<{tag}>\n{connectivity}{offsets}</{tag}>\n")
    }
}

fn save(path: &Path, data: &PolyData) -> Result<(), CliError> {
    let mut appended = Appended::default();
    let points = appended.floats("Points", 3, &data.points);
    let of_points: String = data
        .point_data
        .iter()
        .map(|(name, components, values)| appended.floats(name, *components, values))
        .collect();
    let of_cells = if data.kind.is_empty() {
        String::new()
    } else {
        appended.floats("kind", 1, &data.kind)
    };
    let cells: String = [
        ("Verts", &data.verts),
        ("Lines", &data.lines),
        ("Polys", &data.polys),
    ]
    .map(|(tag, cells)| appended.cells(tag, cells))
    .concat();
    let head = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<PolyData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" \
         NumberOfLines=\"{}\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n<Points>\n{points}</Points>\n\
         <PointData>\n{of_points}</PointData>\n<CellData>\n{of_cells}</CellData>\n{cells}</Piece>\n</PolyData>\n\
         <AppendedData encoding=\"raw\">\n_",
        data.points.len() / 3,
        data.verts.ends.len(),
        data.lines.ends.len(),
        data.polys.ends.len(),
    );
    let mut file = BufWriter::new(create(path)?);
    file.write_all(head.as_bytes())
        .and_then(|()| file.write_all(&appended.bytes))
        .and_then(|()| file.write_all(b"\n</AppendedData>\n</VTKFile>\n"))
        .and_then(|()| file.flush())
        .map_err(|e| cannot_write(path, e))
}

fn collection(files: &[(f64, String)]) -> String {
    let list: String = files
        .iter()
        .map(|(time, name)| {
            format!("<DataSet timestep=\"{time}\" group=\"\" part=\"0\" file=\"{name}\"/>\n")
        })
        .collect();
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n{list}</Collection>\n</VTKFile>\n"
    )
}
