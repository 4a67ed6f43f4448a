//! Whose the exponent is: Beverloo's offset of grains, and what the scheme's choices change.

use super::{GRAIN, GRAVITY, HALF_OPENINGS, SERIES, coefficient, opening, scene, speed};
use crate::validate::report::MODEL;
use crate::validate::statistics::mean;
use crate::validate::studies::choices::{Choice, change};
use crate::validate::{Effort, Member, Metric, Results, Rule};

/// The opening at which the scheme's choices are changed, over twice the unit.
pub(super) const HALF: f64 = HALF_OPENINGS[1];
/// What the page says of it.
pub(super) const NOTE: &str = "Openings here are 9 to 28 grains wide, and mu(I) has a length, the grain: Q/(sqrt(g) D^1.5) may depend on D/d. \
Beverloo, Leniger and van de Velde (Chem. Eng. Sci. 15 (1961) 260) put it as D - k d for D; the rows with k fit that law to the five \
openings. The rows of changes show what the scheme's choices do to C at one of them: where they are small against its \
distance from D^1.5, and the law with k fits, the exponent of D alone is the model's.";

fn check(choice: Choice) -> String {
    format!("check_{}", choice.name())
}

pub(super) fn members(effort: Effort) -> impl Iterator<Item = Result<Member, String>> {
    Choice::ALL.into_iter().map(move |choice| {
        let d = opening(HALF);
        let across = effort.pick(20.0, 8.0);
        let changed = choice.change(scene(d, choice.refinement() * across)?, speed(d));
        Ok(Member::new(
            check(choice),
            changed.text()?,
            &SERIES,
            Vec::new(),
        ))
    })
}

/// Relative change of C by each choice.
pub(super) fn changes(results: &Results) -> [Option<f64>; 4] {
    let found = |name: &str| coefficient(results.finished(name)?, HALF);
    let base = found(&super::name(HALF));
    Choice::ALL.map(|choice| change(base, found(&check(choice))))
}

/// These as comparisons.
pub(super) fn checks(changes: [Option<f64>; 4]) -> impl Iterator<Item = Metric> {
    let pairs = Choice::ALL.into_iter().zip(changes);
    pairs.map(|(choice, change)| {
        Metric::new(
            format!(
                "D = {:.1} mm: change of C, {}",
                1e3 * opening(HALF),
                choice.what()
            ),
            change.map(f64::abs),
            Rule::AtMost(MODEL),
            "a residual is the model's where all of these together change less than 3 %",
        )
    })
}

/// Q^(2/3) = (C sqrt(g))^(2/3) (D - k d) by least squares: C, k and the largest relative residual of Q.
pub(super) fn offset(rates: &[(f64, f64)]) -> Vec<Metric> {
    let fit = (rates.len() == HALF_OPENINGS.len())
        .then(|| fit(rates))
        .flatten();
    vec![
        Metric::new(
            "C of Q = C sqrt(g) (D - k d)^1.5 over the five openings",
            fit.map(|f| f.0),
            Rule::Near(1.45, 0.12),
            "as above; Beverloo's law has an offset of grains",
        ),
        Metric::new(
            "its k",
            fit.map(|f| f.1),
            Rule::Report(Some(1.4)),
            "Beverloo: 1 to 2 for grains in space, 1.4 typical",
        ),
        Metric::new(
            "its largest relative residual",
            fit.map(|f| f.2),
            Rule::AtMost(0.01),
            "two parameters, five openings",
        ),
    ]
}

fn fit(rates: &[(f64, f64)]) -> Option<(f64, f64, f64)> {
    let points: Vec<(f64, f64)> = rates.iter().map(|(d, q)| (*d, q.powf(2.0 / 3.0))).collect();
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
    let (mx, my) = (mean(&x)?, mean(&y)?);
    let square: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
    let slope = points.iter().map(|(x, y)| (x - mx) * (y - my)).sum::<f64>() / square;
    let start = mx - my / slope;
    let law = |d: f64| (slope * (d - start)).powf(1.5);
    let residual = rates.iter().map(|(d, q)| (q / law(*d) - 1.0).abs());
    Some((
        slope.powf(1.5) / GRAVITY.sqrt(),
        start / GRAIN,
        residual.fold(0.0, f64::max),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_offset_is_found() {
        let rates = HALF_OPENINGS.map(|half| {
            let d = opening(half);
            (d, 1.4 * GRAVITY.sqrt() * (d - 0.8 * GRAIN).powf(1.5))
        });
        let (c, k, residual) = fit(&rates).unwrap();
        assert!(
            (c - 1.4).abs() < 1e-9 && (k - 0.8).abs() < 1e-9 && residual < 1e-9,
            "{c} {k} {residual}"
        );
    }
}
