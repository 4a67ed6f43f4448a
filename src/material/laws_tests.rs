//! What every friction law must satisfy; each law's file calls [`check`] with its materials.

use super::Friction;

/// Inertial numbers over all that occurs.
fn range() -> impl Iterator<Item = f64> {
    (0..200).map(|k| 10f64.powf(-8.0 + 11.0 * f64::from(k) / 199.0))
}

/// Monotone friction, slope = derivative, resolvent = inverse.
pub(super) fn check(law: &impl Friction) {
    grows(law);
    slope_is_the_derivative(law);
    resolvent_is_the_inverse(law);
    nothing_flows_under_yield(law);
}

fn grows(law: &impl Friction) {
    let mut last = law.friction(0.0);
    for i in range() {
        let mu = law.friction(i);
        assert!(mu.is_finite() && mu >= last, "{i}: {last} to {mu}");
        assert!(law.slope(i) >= 0.0, "{i}");
        last = mu;
    }
}

fn slope_is_the_derivative(law: &impl Friction) {
    for i in range() {
        let h = 1e-5 * i;
        let difference = (law.friction(i + h) - law.friction(i - h)) / (2.0 * h);
        // Rounding of mu over h, and the third derivative.
        let tolerance = 1e-6 * difference.abs() + 4e-16 * law.friction(i) / h;
        // A joint of two branches may lie inside the difference.
        let joint = (law.slope(i + h) - law.slope(i - h)).abs();
        assert!(
            (law.slope(i) - difference).abs() <= tolerance + joint,
            "{i}: {} for {difference}",
            law.slope(i)
        );
    }
}

fn resolvent_is_the_inverse(law: &impl Friction) {
    for m in 0..40 {
        let a = 10f64.powf(-6.0 + 18.0 * f64::from(m) / 39.0);
        let mut last = 0.0;
        for k in 0..120 {
            let y = 10f64.powf(-2.0 + 4.0 * f64::from(k) / 119.0);
            let i = law.resolvent(a, y);
            assert!(i.is_finite() && i >= last, "a {a} y {y}: {last} to {i}");
            last = i;
            // A law that vanishes at rest may reach y below the smallest number there is: then I is 0.
            let representable = i > 1e-290 || law.friction(1e-290) < y;
            if y > law.friction(0.0) && representable {
                let back = law.friction(i) + a * i;
                assert!((back / y - 1.0).abs() < 1e-12, "a {a} y {y}: {back}");
            }
        }
    }
}

fn nothing_flows_under_yield(law: &impl Friction) {
    let yields = law.friction(0.0);
    for share in [0.0, 0.5, 1.0] {
        assert_eq!(law.resolvent(1.0, share * yields), 0.0);
    }
}
