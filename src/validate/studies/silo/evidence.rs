//! Whose the exponent is: Beverloo's offset of grains, and what the scheme's choices change.

use super::{GRAIN, GRAVITY, HALF_OPENINGS, SERIES, coefficient, name, opening, scene, speed};
use crate::validate::report::Table;
use crate::validate::statistics::{mean, power_law};
use crate::validate::studies::choices::{self, Choice, change};
use crate::validate::{Effort, Member, Metric, Results, Rule};

/// What the page says of it.
pub(super) const NOTE: &str = "Openings here are 9 to 28 grains wide, and mu(I) has a length, the grain: Q/(sqrt(g) D^1.5) may depend on D/d. \
Beverloo, Leniger and van de Velde (Chem. Eng. Sci. 15 (1961) 260) put it as D - k d for D; the rows with k fit that law to the five \
openings. The table of changes shows what the scheme's choices do to C and to the exponent: where they are small against the distance \
from D^1.5, and the law with k fits, the exponent of D alone is the model's.";

fn check(half: f64, choice: Choice) -> String {
    format!("check_{}_{}", name(half), choice.name())
}

pub(super) fn members(effort: Effort) -> impl Iterator<Item = Result<Member, String>> {
    let all = HALF_OPENINGS
        .into_iter()
        .flat_map(|half| Choice::ALL.map(|choice| (half, choice)));
    all.map(move |(half, choice)| {
        let d = opening(half);
        let across = effort.pick(20.0, 8.0);
        let changed = choice.change(scene(d, choice.refinement() * across)?, speed(d));
        Ok(Member::new(
            check(half, choice),
            changed.text()?,
            &SERIES,
            Vec::new(),
        ))
    })
}

fn found(results: &Results, name: &str, half: f64) -> Option<f64> {
    coefficient(results.finished(name)?, half)
}

/// Relative change of C by each choice, at an opening.
pub(super) fn changes(results: &Results, half: f64) -> [Option<f64>; 4] {
    let base = found(results, &name(half), half);
    Choice::ALL.map(|choice| change(base, found(results, &check(half, choice), half)))
}

/// Relative change of the exponent of D by each choice, changed at all openings.
pub(super) fn changes_of_exponent(results: &Results) -> [Option<f64>; 4] {
    let of = |name: &dyn Fn(f64) -> String| {
        exponent(HALF_OPENINGS.map(|half| found(results, &name(half), half)))
    };
    let base = of(&name);
    Choice::ALL.map(|choice| change(base, of(&|half| check(half, choice))))
}

/// Exponent of D of these C, one for each opening; `None` if one is missing.
fn exponent(coefficients: [Option<f64>; HALF_OPENINGS.len()]) -> Option<f64> {
    let each = HALF_OPENINGS.into_iter().zip(coefficients);
    let rates = each.map(|(half, c)| Some((opening(half), area_rate(c?, half))));
    Some(power_law(&rates.collect::<Option<Vec<_>>>()?)?.0)
}

/// Area that leaves per time, C sqrt(g) D^1.5 [m^2/s].
pub(super) fn area_rate(c: f64, half: f64) -> f64 {
    c * GRAVITY.sqrt() * opening(half).powf(1.5)
}

/// What each choice changes of C at every opening, and of the exponent.
pub(super) fn table(results: &Results) -> Table {
    let each = HALF_OPENINGS.into_iter().map(|half| {
        let what = format!("C, D = {:.1} mm", 1e3 * opening(half));
        (what, changes(results, half))
    });
    let exponent = ("exponent of D".to_owned(), changes_of_exponent(results));
    let rows: Vec<_> = each.chain([exponent]).collect();
    choices::table(
        "Share by which each choice of the scheme changes what is compared".to_owned(),
        &rows,
    )
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
    fn a_known_exponent_is_found() {
        let c = HALF_OPENINGS.map(|half| Some(1.4 * opening(half).powf(0.1)));
        let found = exponent(c).unwrap();
        assert!((found - 1.6).abs() < 1e-9, "{found}");
        let mut c = c;
        c[2] = None;
        assert_eq!(exponent(c), None);
    }

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
