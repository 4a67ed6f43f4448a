//! How far apart densities may be: masses are multiples of one power of two, so that the account of material is exact, and the
//! lightest must still be many of them.

use super::Lift;
use super::numerics::LARGEST_RADIUS;
use crate::scene::types::NamedMaterial;

/// Largest density over the smallest one: of 26 bits of the heaviest particle's mass 14 are left to the lightest.
const MOST_APART: f64 = 4096.0;

impl Lift<'_> {
    /// How far apart densities may be [1]. Rings near the axis are as much lighter as they are smaller than those at the rim; of
    /// four times the density they may be [`LARGEST_RADIUS`] away from it, as masses have two bits more beside heavier ones.
    fn most_apart(&self) -> f64 {
        let rim = self.domain.as_ref().map(|d| d.upper[0]);
        match (self.spacing, rim) {
            (Some(spacing), Some(rim)) if self.axisymmetric() => {
                MOST_APART.min(4.0 * LARGEST_RADIUS * spacing / rim)
            }
            _ => MOST_APART,
        }
    }

    /// Reports materials too light beside another one.
    pub(super) fn check_densities(&mut self, materials: &[Option<NamedMaterial>]) {
        let density = |named: &NamedMaterial| named.material.rest_density();
        let known = || materials.iter().flatten();
        let heaviest = known().max_by(|a, b| density(a).total_cmp(&density(b)));
        let lightest = known().min_by(|a, b| density(a).total_cmp(&density(b)));
        let (Some(light), Some(heavy)) = (lightest, heaviest) else {
            return;
        };
        let most = self.most_apart();
        let least = density(heavy) / most;
        if density(light) >= least {
            return;
        }
        let entries = self.raw.materials.iter().flat_map(|m| &m.value.0);
        let place = entries.filter(|e| e.name == light.name).map(|e| &e.place);
        for place in place {
            self.problems.report(
                place,
                format!("{} at {} kg/m^3", light.name, density(light)),
                format!(
                    "at least {least:.4} kg/m^3 beside {} at {} kg/m^3: densities are at most {most:.0} times each other here, so \
                     that the account of mass is exact",
                    heavy.name,
                    density(heavy)
                ),
                "make it heavier; what is so light beside the rest may be left out",
            );
        }
    }
}
