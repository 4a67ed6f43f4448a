//! Where what was recorded and what is computed again differ: the variable, and both values with their bits.

use crate::wire::convert::PARTICLE_FIELDS;
use crate::wire::foxglove::PointCloud;
use crate::wire::messages::StepStats;

/// Whether they are equal bit for bit.
pub(super) fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}

/// Whether a number that stands alone in a message is this one: the log does not have such a number if it is 0, of either
/// sign. Those of lists are all there, see [`same`].
pub(super) fn same_alone(logged: f64, own: f64) -> bool {
    logged.to_bits() == own.to_bits() || (logged == 0.0 && own == 0.0)
}

/// The first of two lists of numbers that differs, with its bits.
pub(super) fn differ(logged: &[f64], own: &[f64]) -> String {
    if logged.len() != own.len() {
        return format!("log has {} values, computed {}", logged.len(), own.len());
    }
    let first = logged
        .iter()
        .zip(own)
        .position(|(a, b)| a.to_bits() != b.to_bits());
    let k = first.unwrap_or(0);
    let (a, b) = (logged[k], own[k]);
    let place = if logged.len() > 1 {
        format!("value {k}: ")
    } else {
        String::new()
    };
    format!(
        "{place}log says {a:?} ({:016x}), computed {b:?} ({:016x})",
        a.to_bits(),
        b.to_bits()
    )
}

/// What is said of a call whose bits and numbers are not the same.
pub(super) fn disagree(bits: &[f64], values: &[f64]) -> String {
    format!("was changed in the log: its bits say {bits:?}, its values {values:?}")
}

/// The first figure of a step that differs.
pub(super) fn different_figure(logged: &StepStats, own: &StepStats) -> Option<(String, String)> {
    if logged == own {
        return None;
    }
    let figures = |s: &StepStats| {
        let l = s.ledger.clone().unwrap_or_default();
        [
            ("stats.time", s.time),
            ("stats.step", s.step as f64),
            ("stats.substeps", f64::from(s.substeps)),
            ("stats.smallest_step", s.smallest_step),
            ("stats.iterations", f64::from(s.iterations)),
            ("stats.particles", s.particles as f64),
            ("stats.step_size", s.step_size),
            ("stats.kinetic_energy", s.kinetic_energy),
            ("stats.max_speed", s.max_speed),
            ("stats.share_dilute", s.share_dilute),
            ("stats.share_asleep", s.share_asleep),
            ("stats.total_substeps", s.total_substeps as f64),
            ("stats.total_iterations", s.total_iterations as f64),
            ("mass.initial", l.initial),
            ("mass.inflow", l.inflow),
            ("mass.outflow", l.outflow),
            ("mass.present", l.present),
        ]
    };
    let pairs = figures(logged).into_iter().zip(figures(own));
    let mut different = pairs.filter(|((_, a), (_, b))| !same_alone(*a, *b));
    Some(different.next().map_or_else(
        || {
            (
                "stats".to_owned(),
                format!("log says {logged:?}, computed {own:?}"),
            )
        },
        |((name, a), (_, b))| (name.to_owned(), differ(&[a], &[b])),
    ))
}

/// The first particle that differs.
pub(super) fn different_particle(
    logged: &PointCloud,
    own: &PointCloud,
) -> Option<(String, String)> {
    if logged == own {
        return None;
    }
    let stride = 4 * PARTICLE_FIELDS.len();
    let what = if logged.data.len() == own.data.len() {
        let first = logged.data.iter().zip(&own.data).position(|(a, b)| a != b);
        first.map_or("other fields".to_owned(), |byte| {
            let field = PARTICLE_FIELDS[byte % stride / 4];
            format!("{field} of particle {} differs", byte / stride)
        })
    } else {
        let count = |cloud: &PointCloud| cloud.data.len() / stride;
        format!("log has {}, computed {}", count(logged), count(own))
    };
    Some(("particles".to_owned(), what))
}
