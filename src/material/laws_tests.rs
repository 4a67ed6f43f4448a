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
    a_cell_flows_at_the_mean_of_its_rates(law);
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

/// Against halving and sums of 1,000 points of the law's inverse.
fn a_cell_flows_at_the_mean_of_its_rates(law: &impl Friction) {
    const POINTS: u32 = 1000;
    let mean = |k: f64, m: f64, half: f64| {
        let rates = (0..POINTS).map(|n| {
            let place = (2.0 * f64::from(n) + 1.0) / f64::from(POINTS) - 1.0;
            law.resolvent(k, m + half * place)
        });
        rates.sum::<f64>() / f64::from(POINTS)
    };
    let still = law.friction(0.0);
    for half in [0.003, 0.05, 0.2] {
        for (a, k) in [
            (0.1, 0.0),
            (1.0, 0.0),
            (1.0, 0.3),
            (100.0, 0.0),
            (100.0, 20.0),
        ] {
            assert_eq!(law.cell_resolvent((a, k), still - 1.001 * half, half), 0.0);
            // However it is pushed: its end may be at the law's largest friction.
            for y in [10.0, 1e6] {
                let i = law.cell_resolvent((a, k), y, half);
                let least = law.resolvent(a + k, y);
                let most = law.resolvent(a + k, y + 2.0 * half);
                assert!(
                    (1.0 - 1e-6) * least <= i && i <= (1.0 + 1e-6) * most,
                    "half {half} a {a} k {k} y {y}: {i}"
                );
            }
            for over in [-0.5, 0.0, 0.5, 1.5] {
                let y = still.max(half) + over * half;
                let (mut low, mut high) = (still - half, y);
                for _ in 0..50 {
                    let m = 0.5 * (low + high);
                    // Infinite where a law has no such friction.
                    let fits = m + a * mean(k, m, half) < y;
                    *(if fits { &mut low } else { &mut high }) = m;
                }
                let wanted = (y - low) / a;
                let i = law.cell_resolvent((a, k), y, half);
                assert!(
                    (i - wanted).abs() <= 3e-3 * wanted + 1e-12,
                    "half {half} a {a} k {k} y {y}: {i} for {wanted}"
                );
            }
        }
    }
}
