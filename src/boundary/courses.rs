//! Courses of wall points along one direction of a wall: where others' faces cross it, one course ends and the next begins, as bricks
//! do at a corner.
//!
//! Rows of two walls lie on top of each other behind a corner only if both count from it. Rows that count from elsewhere (the domain's
//! corner, a box's far side) leave slits or double rows there, and what rests on one wall is borne by the other.

use super::ROWS;

/// Faces nearer to each other than this count as one [spacings].
const NARROWEST: f64 = 0.5;

/// How far off the lattice a face may lie that counts as on it [spacings].
const ON_LATTICE: f64 = 1e-6;

/// Middles and lengths of points along a direction, from `from` to `to` at least, `from` < `to`. Between faces they are evenly as long as fits,
/// about `spacing`; before the first face and behind the last one `spacing` long, from it. Without faces they are those of the lattice
/// through 0, from `from` on.
pub(super) fn of_plane(faces: &[f64], (from, to): (f64, f64), spacing: f64) -> Vec<(f64, f64)> {
    // One beyond, as a plane outside of the domain, meets no point.
    let within = |x: &f64| (from..=to).contains(x);
    let faces: Vec<f64> = faces.iter().copied().filter(within).collect();
    // Where all faces are on the lattice it is theirs.
    let faces = if faces.iter().any(|x| is_off(x / spacing)) {
        apart(faces, spacing)
    } else {
        Vec::new()
    };
    let (Some(first), Some(last)) = (faces.first(), faces.last()) else {
        let numbers = (from / spacing).floor() as i64 - 2..(to / spacing).ceil() as i64 + 2;
        return numbers
            .map(|n| ((n as f64 + 0.5) * spacing, spacing))
            .collect();
    };
    let beyond = |length: f64| 0..(length / spacing).ceil().max(0.0) as usize + 2;
    let mut courses: Vec<(f64, f64)> = beyond(first - from)
        .rev()
        .map(|n| (first - (n as f64 + 0.5) * spacing, spacing))
        .collect();
    for pair in faces.windows(2) {
        courses.extend(even(pair[0], pair[1], spacing));
    }
    courses.extend(beyond(to - last).map(|n| (last + (n as f64 + 0.5) * spacing, spacing)));
    courses
}

/// The same of a box from `lower` to `upper`, where `faces` of other walls meet it. Where they are no multiple of `spacing`
/// apart, the rows that material beside a face sees still are, if there is room for them.
pub(super) fn of_box(faces: &[f64], (lower, upper): (f64, f64), spacing: f64) -> Vec<(f64, f64)> {
    let off = |x: f64| is_off((x - lower) / spacing);
    let inner = |x: &f64| *x > lower + NARROWEST * spacing && *x < upper - NARROWEST * spacing;
    let faces: Vec<f64> = faces.iter().copied().filter(inner).collect();
    if !off(upper) && !faces.iter().any(|x| off(*x)) {
        return even(lower, upper, spacing).collect();
    }
    let faces = apart([vec![lower, upper], faces].concat(), spacing);
    let depth = ROWS as f64 * spacing;
    let mut courses = Vec::new();
    for pair in faces.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let mut cuts = vec![from, to];
        if to - from > 2.0 * depth {
            cuts.splice(1..1, [from + depth, to - depth]);
        }
        courses.extend(cuts.windows(2).flat_map(|c| even(c[0], c[1], spacing)));
    }
    courses
}

/// Whether a place lies beside the lattice, in spacings from it.
fn is_off(place: f64) -> bool {
    (place - place.round()).abs() > ON_LATTICE
}

/// Sorted, without those that are too near to the one before.
fn apart(mut faces: Vec<f64>, spacing: f64) -> Vec<f64> {
    faces.sort_by(f64::total_cmp);
    faces.dedup_by(|next, last| *next - *last < NARROWEST * spacing);
    faces
}

/// Points from one face to the next.
fn even(from: f64, to: f64, spacing: f64) -> impl Iterator<Item = (f64, f64)> {
    let count = ((to - from) / spacing).round().max(1.0) as usize;
    let (length, cells) = (to - from, count as f64);
    let step = length / cells;
    let is_whole = (step / spacing - 1.0).abs() < ON_LATTICE;
    let step = if is_whole { spacing } else { step };
    (0..count).map(move |n| (from + (n as f64 + 0.5) * length / cells, step))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(courses: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let round = |x: f64| (x * 1e6).round() / 1e6;
        courses
            .iter()
            .map(|(x, l)| (round(*x), round(*l)))
            .collect()
    }

    #[test]
    fn courses_count_from_the_faces_that_cross() {
        // Walls at 0.25 and 1.3, 10.5 spacings apart: eleven or ten between them, whole ones outside.
        let courses = shown(&of_plane(&[1.3, 0.25], (0.0, 1.5), 0.1));
        let middle: Vec<_> = courses
            .iter()
            .filter(|(x, _)| *x > 0.25 && *x < 1.3)
            .collect();
        let sum: f64 = middle.iter().map(|(_, l)| l).sum();
        assert!((sum - 1.05).abs() < 1e-5, "{courses:?}");
        assert!(
            courses.contains(&(0.2, 0.1)) && courses.contains(&(1.35, 0.1)),
            "{courses:?}"
        );
        assert!(courses[0].0 < 0.0 && courses[courses.len() - 1].0 > 1.5);
        assert!(courses.windows(2).all(|w| w[0].0 < w[1].0));
        // On the lattice they change nothing; two faces at one place are one.
        assert_eq!(
            of_plane(&[0.3, 0.9], (0.0, 1.5), 0.1),
            of_plane(&[], (0.0, 1.5), 0.1)
        );
        assert_eq!(
            of_plane(&[0.25, 0.25], (0.0, 1.0), 0.1),
            of_plane(&[0.25], (0.0, 1.0), 0.1)
        );
    }

    #[test]
    fn faces_that_are_far_away_make_no_points() {
        let near = of_plane(&[0.25], (0.0, 1.0), 0.1);
        assert_eq!(of_plane(&[1e12, 0.25, -1e12], (0.0, 1.0), 0.1), near);
        assert!(near.len() < 20);
    }

    #[test]
    fn boxes_have_whole_rows_before_their_faces() {
        let of = |faces: &[f64], upper: f64| shown(&of_box(faces, (0.0, upper), 0.1));
        assert_eq!(
            of(&[], 0.4),
            [(0.05, 0.1), (0.15, 0.1), (0.25, 0.1), (0.35, 0.1)]
        );
        let thick = of(&[], 1.05);
        assert!(
            thick.contains(&(0.35, 0.1)) && thick.contains(&(0.7, 0.1)),
            "{thick:?}"
        );
        let sum: f64 = thick.iter().map(|(_, l)| l).sum();
        assert!((sum - 1.05).abs() < 1e-5);
        // A floor that crosses it; one at its foot is its own face.
        let sunk = of(&[0.25, 0.01], 1.05);
        assert!(
            sunk.contains(&(0.041_667, 0.083_333)) && sunk.contains(&(0.3, 0.1)),
            "{sunk:?}"
        );
    }
}
