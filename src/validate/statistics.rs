//! Means, spreads and fits of a few numbers.

/// Mean; `None` of nothing.
#[must_use]
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Standard deviation of a sample (n - 1) over its mean, the spread of seeds; `None` of fewer than two.
#[must_use]
pub fn spread(values: &[f64]) -> Option<f64> {
    let mean = mean(values)?;
    if values.len() < 2 {
        return None;
    }
    let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
    Some((square / (values.len() - 1) as f64).sqrt() / mean)
}

/// Root mean square; `None` of nothing.
#[must_use]
pub fn rms(values: &[f64]) -> Option<f64> {
    let squares: Vec<f64> = values.iter().map(|v| v * v).collect();
    mean(&squares).map(f64::sqrt)
}

/// Exponent n and factor c of y = c x^n by least squares of logarithms; `None` of fewer than two points.
#[must_use]
pub fn power_law(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let (x, y): (Vec<f64>, Vec<f64>) = logs.iter().copied().unzip();
    let (mx, my) = (mean(&x)?, mean(&y)?);
    let square: f64 = x.iter().map(|x| (x - mx).powi(2)).sum();
    let cross: f64 = logs.iter().map(|(x, y)| (x - mx) * (y - my)).sum();
    let exponent = cross / square;
    (logs.len() >= 2 && exponent.is_finite()).then(|| (exponent, (my - exponent * mx).exp()))
}

/// Value at `x` on straight lines between points of ascending x, held beyond the ends; `None` of nothing.
#[must_use]
pub fn interpolate(points: &[(f64, f64)], x: f64) -> Option<f64> {
    let next = points.partition_point(|p| p.0 < x);
    if next == 0 || next == points.len() {
        return points
            .get(next.min(points.len().checked_sub(1)?))
            .map(|p| p.1);
    }
    let ((x0, y0), (x1, y1)) = (points[next - 1], points[next]);
    Some(y0 + (y1 - y0) * (x - x0) / (x1 - x0))
}

/// First x at which a curve reaches a level from below, on straight lines between points.
#[must_use]
pub fn first_reaching(points: &[(f64, f64)], level: f64) -> Option<f64> {
    if points.first()?.1 >= level {
        return Some(points[0].0);
    }
    points
        .windows(2)
        .find(|w| w[0].1 < level && w[1].1 >= level)
        .map(|w| {
            let ((x0, y0), (x1, y1)) = (w[0], w[1]);
            x0 + (x1 - x0) * (level - y0) / (y1 - y0)
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_known_numbers() {
        assert_eq!(mean(&[1.0, 2.0, 6.0]), Some(3.0));
        assert_eq!(mean(&[]), None);
        // Deviations -1, 0, 1 of a mean of 10: standard deviation 1.
        assert_eq!(spread(&[9.0, 10.0, 11.0]), Some(0.1));
        assert_eq!(spread(&[9.0]), None);
        assert_eq!(rms(&[3.0, -4.0, 3.0, 4.0]), Some(12.5_f64.sqrt()));
    }

    #[test]
    fn a_power_law_is_found_again() {
        let points = [1.0_f64, 2.0, 3.0, 5.0].map(|x| (x, 1.4 * x.powf(1.5)));
        let (n, c) = power_law(&points).unwrap();
        assert!(
            (n - 1.5).abs() < 1e-12 && (c - 1.4).abs() < 1e-12,
            "{n} {c}"
        );
        assert_eq!(power_law(&points[..1]), None);
    }

    #[test]
    fn straight_lines_between_points() {
        let points = [(0.0, 1.0), (1.0, 3.0), (3.0, 2.0)];
        assert_eq!(interpolate(&points, 0.5), Some(2.0));
        assert_eq!(interpolate(&points, 2.0), Some(2.5));
        assert_eq!(interpolate(&points, -1.0), Some(1.0));
        assert_eq!(interpolate(&points, 9.0), Some(2.0));
        assert_eq!(interpolate(&[], 0.0), None);
        assert_eq!(first_reaching(&points, 2.0), Some(0.5));
        assert_eq!(first_reaching(&points, 1.0), Some(0.0));
        assert_eq!(first_reaching(&points, 3.5), None);
    }
}
