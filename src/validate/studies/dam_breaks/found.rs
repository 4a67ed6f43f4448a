//! Surfaces of the runs, and how far they are from the exact ones.

use super::{CHANGED, DEPTH, FEET, GRAVITY, PLATEAU, SURFACE, WET, bed, reservoir, unit, until};
use crate::validate::statistics::{mean, rms};
use crate::validate::studies::choices::change;
use crate::validate::{Metric, Recording, Results, Rule};

/// Places and depths [m].
type Surface = Vec<(f64, f64)>;

/// Place and depth at a time [s], from the first foot on.
fn surface(recording: &Recording, first_foot: f64, time: f64) -> Option<Surface> {
    let depths = recording.values_at(SURFACE, time)?;
    let rows = depths.iter().enumerate();
    Some(
        rows.map(|(k, h)| (first_foot + FEET * k as f64, *h))
            .collect(),
    )
}

/// Depth at one of its places [m].
fn depth_at(surface: &[(f64, f64)], x: f64) -> Option<f64> {
    let place = surface.iter().find(|p| (p.0 - x).abs() < 0.5 * FEET)?;
    Some(place.1)
}

/// Outermost place with at least this depth [m].
fn reach(surface: &[(f64, f64)], depth: f64) -> Option<f64> {
    let k = surface.iter().rposition(|p| p.1 >= depth)?;
    let (a, b) = (surface[k], *surface.get(k + 1)?);
    Some(a.0 + (a.1 - depth) / (a.1 - b.1) * (b.0 - a.0))
}

/// Where a bore of this plateau would be that holds as much water beyond `from` as there is [m]: a jump is where it conserves mass,
/// whatever its shape. Drops that it throws ahead, which a place of given depth would catch, count with their water.
fn jump(surface: &[(f64, f64)], from: f64, plateau: f64) -> Option<f64> {
    let beyond: Vec<_> = surface.iter().filter(|p| p.0 >= from).collect();
    let steps = beyond.windows(2);
    let water: f64 = steps
        .map(|p| (0.5 * (p[0].1 + p[1].1) - WET) * (p[1].0 - p[0].0))
        .sum();
    Some(beyond.first()?.0 + water / (plateau - WET))
}

/// Depth of the dry bed's solution [m].
pub(super) fn ritter(x: f64, t: f64) -> f64 {
    let c = (GRAVITY * DEPTH).sqrt();
    if x < -c * t {
        DEPTH
    } else if x > 2.0 * c * t {
        0.0
    } else {
        (2.0 * c - x / t).powi(2) / (9.0 * GRAVITY)
    }
}

/// Depth of the wet bed's solution [m].
pub(super) fn stoker(x: f64, t: f64) -> f64 {
    let (plateau, speed, bore) = PLATEAU;
    if x > bore * t {
        WET
    } else if x > (speed - (GRAVITY * plateau).sqrt()) * t {
        plateau
    } else {
        ritter(x, t)
    }
}

/// Surfaces over one bed at one time: of the run that is judged, and of those that tell what it depends on.
pub(super) struct Found {
    time: f64,
    pub(super) judged: Option<Surface>,
    /// Before and after a change of spacing, of start and of sound speed.
    changed: [[Option<Surface>; 2]; 3],
}

impl Found {
    pub(super) fn new(results: &Results, wet: bool, rows: u32, time: f64) -> Self {
        let effort = results.effort;
        let of = |rows: u32, name: &str| {
            let recording = results.finished(&format!("{}_{name}", bed(wet)))?;
            let (_, first_foot) = reservoir(until(effort, rows));
            surface(recording, first_foot, time)
        };
        let at = |rows: u32| of(rows, &rows.to_string());
        let [coarse, fine, finest] = super::rows(effort);
        // To the next finer one that goes on so long.
        let finer = if rows != coarse && until(effort, finest) * unit() > 0.999 * time {
            [fine, finest]
        } else {
            [coarse, fine]
        };
        let [seed, sound_speed] = CHANGED.map(|choice| [at(coarse), of(coarse, choice.name())]);
        Self {
            time,
            judged: at(rows),
            changed: [finer.map(at), seed, sound_speed],
        }
    }

    /// A number of the surface, and the shares by which what it depends on changes it.
    fn number(&self, of: impl Fn(&Surface) -> Option<f64>) -> (Option<f64>, [Option<f64>; 3]) {
        let of = |surface: &Option<Surface>| surface.as_ref().and_then(&of);
        let changes = self.changed.each_ref();
        let changes = changes.map(|[before, after]| change(of(before), of(after)));
        (of(&self.judged), changes)
    }

    /// Root mean square of the difference from another depth between 0.1 H and 0.8 H of Ritter's, over H.
    fn off(&self, surface: &Surface, depth: impl Fn(f64) -> Option<f64>) -> Option<f64> {
        let inside = surface
            .iter()
            .filter(|p| (0.1 * DEPTH..0.8 * DEPTH).contains(&ritter(p.0, self.time)));
        let errors = inside.map(|p| Some((p.1 - depth(p.0)?) / DEPTH));
        rms(&errors.collect::<Option<Vec<_>>>()?)
    }

    /// A place that should go at a constant speed [m/s] since t = 0, and how late it is.
    fn place(
        &self,
        what: String,
        of: impl Fn(&Surface) -> Option<f64>,
        speed: f64,
        why: &str,
    ) -> [Metric; 2] {
        let (found, changes) = self.number(of);
        let exact = speed * self.time;
        let lag = found.map(|x| (exact - x) / speed / unit());
        [
            Metric::new(what.clone(), found, Rule::NearShare(exact, 0.03), why)
                .unit("m")
                .changed_by(changes),
            Metric::new(
                format!("{what}: its lag"),
                lag,
                Rule::Report(None),
                "in units of sqrt(H/g)",
            ),
        ]
    }

    pub(super) fn dry_metrics(&self, what: &str) -> Vec<Metric> {
        let c = (GRAVITY * DEPTH).sqrt();
        let judged = self.judged.as_ref();
        let error = judged.and_then(|s| self.off(s, |x| Some(ritter(x, self.time))));
        let changes = self.changed.each_ref().map(|[before, after]| {
            let after = after.as_ref()?;
            self.off(before.as_ref()?, |x| depth_at(after, x))
        });
        let profile = Metric::new(
            format!("dry, {what}: profile between 0.1 H and 0.8 H, rms over H"),
            error,
            Rule::AtMost(0.03),
            "Ritter (1892)",
        );
        let mut metrics = vec![profile.changed_by(changes)];
        for share in [0.1, 0.2] {
            metrics.extend(self.place(
                format!("dry, {what}: place of h = {share} H"),
                |s| reach(s, share * DEPTH),
                2.0 * c - 3.0 * (GRAVITY * share * DEPTH).sqrt(),
                "Ritter; asked at H/dp 200",
            ));
        }
        metrics
    }

    pub(super) fn wet_metrics(&self, what: &str) -> Vec<Metric> {
        let (plateau, speed, bore) = PLATEAU;
        let from = (speed - (GRAVITY * plateau).sqrt()) * self.time + 0.15;
        let to = bore * self.time - 0.2;
        let (level, changes) = self.number(|s| {
            let inside = s.iter().filter(|p| p.0 > from && p.0 < to).map(|p| p.1);
            mean(&inside.collect::<Vec<_>>())
        });
        let level = Metric::new(
            format!("wet, {what}: plateau"),
            level,
            Rule::NearShare(plateau, 0.03),
            "Stoker (1957); asked at H/dp 200",
        );
        let mut metrics = vec![level.unit("m").changed_by(changes)];
        metrics.extend(self.place(
            format!("wet, {what}: bore, by the water ahead of the plateau"),
            |s| jump(s, to, plateau),
            bore,
            "Stoker; asked at H/dp 200",
        ));
        let (half_way, _) = self.number(|s| reach(s, 0.5 * (plateau + WET)));
        metrics.push(
            Metric::new(
                format!("wet, {what}: outermost place where the depth is half way"),
                half_way,
                Rule::Report(Some(bore * self.time)),
                "drops that the bore throws ahead count as the bore",
            )
            .unit("m"),
        );
        metrics
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_is_where_its_water_ends() {
        let (plateau, ..) = PLATEAU;
        let depth = |x: f64| {
            // A ramp about 1.7 m, and a drop ahead that holds 4 mm of the bore's way.
            let ramp = plateau + (WET - plateau) * ((x - 1.6) / 0.2).clamp(0.0, 1.0);
            let drop = if (x - 2.0).abs() < 0.5 * FEET {
                0.2
            } else {
                0.0
            };
            ramp + drop * (plateau - WET)
        };
        let surface: Surface = (0..150)
            .map(|k| FEET * f64::from(k))
            .map(|x| (x, depth(x)))
            .collect();
        let found = jump(&surface, 1.2, plateau).unwrap();
        assert!((found - 1.704).abs() < 1e-9, "{found}");
        assert_eq!(jump(&surface, 9.0, plateau), None);
    }
}
