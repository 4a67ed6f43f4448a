//! Where the equations of incompressible mu(I) flow are well-posed (Barker et al., J. Fluid Mech. 779 (2015) 794,
//! doi 10.1017/jfm.2015.412, eq. 3.9).
//!
//! With nu = I mu'(I)/mu(I): C = 4 nu^2 - 4 nu + mu^2 (1 - nu/2)^2. C <= 0 is well-posed; where C > 0, short waves
//! grow the faster the shorter they are, and results depend on the resolution. mu(I) is ill-posed at both ends, where it is flat.

use super::{Friction, MuI};

/// C [1]: above 0 where the law is ill-posed. I > 0.
#[must_use]
pub fn ill_posedness(law: &impl Friction, inertial_number: f64) -> f64 {
    let mu = law.friction(inertial_number);
    if mu <= 0.0 {
        return 0.0;
    }
    let nu = inertial_number * law.slope(inertial_number) / mu;
    let s = mu * (1.0 - 0.5 * nu);
    4.0 * nu * nu - 4.0 * nu + s * s
}

/// The two neutral inertial numbers (C = 0) of mu(I) without growth, well-posed in between; `None` if C > 0 everywhere.
#[must_use]
pub fn neutral_inertial_numbers(law: &MuI) -> Option<(f64, f64)> {
    let c = |i: f64| ill_posedness(law, i);
    // Search outwards from the well-posed middle: the smallest C on a grid of 1 % steps over I0 10^-6 to I0 10^3.
    let at = |k: i32| law.inertial_number_scale * (0.01 * f64::from(k)).exp();
    let lowest = (-1382..=691).min_by(|&j, &k| c(at(j)).total_cmp(&c(at(k))))?;
    let middle = at(lowest);
    if c(middle) >= 0.0 {
        return None;
    }
    let low = bisect(&c, at(-1382), middle)?;
    let high = bisect(&c, at(691), middle)?;
    Some((low, high))
}

/// The root between `outside` with C > 0 and `inside` with C < 0.
fn bisect(c: &impl Fn(f64) -> f64, mut outside: f64, mut inside: f64) -> Option<f64> {
    if c(outside) <= 0.0 {
        return None;
    }
    for _ in 0..200 {
        let middle = 0.5 * (outside + inside);
        if c(middle) > 0.0 {
            outside = middle;
        } else {
            inside = middle;
        }
    }
    Some(inside)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neutral_numbers_are_the_published_ones() {
        let of = |mu_s, mu_2, inertial_number_scale| MuI {
            mu_s,
            mu_2,
            inertial_number_scale,
            mu_inf: 0.0,
        };
        // Barker & Gray's set, and the others by an independent program (design notes, numerics): three digits each.
        for (law, low, high) in [
            (of(0.342, 0.557, 0.069), 0.003_972, 0.2802),
            (of(0.32, 0.60, 0.40), 0.0136, 1.81),
            (MuI::glass_beads(), 0.0194, 0.852),
            (MuI::sand_08(), 0.139, 1.38),
            (MuI::sand_04(), 0.432, 1.82),
        ] {
            let found = neutral_inertial_numbers(&law).unwrap();
            assert!((found.0 / low - 1.0).abs() < 5e-3, "{found:?}");
            assert!((found.1 / high - 1.0).abs() < 5e-3, "{found:?}");
            assert!(ill_posedness(&law, 0.9 * found.0) > 0.0);
            assert!(ill_posedness(&law, 1.1 * found.0) < 0.0);
            assert!(ill_posedness(&law, 0.9 * found.1) < 0.0);
            assert!(ill_posedness(&law, 1.1 * found.1) > 0.0);
        }
    }

    #[test]
    fn growth_widens_the_well_posed_range() {
        // Barker & Gray: up to I = 17 for their set with mu_inf = 0.05.
        let law = MuI {
            mu_s: 0.342,
            mu_2: 0.557,
            inertial_number_scale: 0.069,
            mu_inf: 0.05,
        };
        assert!(ill_posedness(&law, 16.9) < 0.0 && ill_posedness(&law, 17.1) > 0.0);
    }
}
