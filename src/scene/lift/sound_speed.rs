//! The artificial sound speed, given or not: materials must bear their weight with it.

use super::{Filled, Lift};
use crate::scene::raw::{Place, RawMaterial, RawNumerics};
use crate::scene::types::NamedMaterial;

impl Lift<'_> {
    /// sqrt(g H) of the material, or of the domain where there is none yet; c0/10 if that is less, or there is no gravity [m/s].
    pub(super) fn fall_speed(&self, sound_speed: f64) -> f64 {
        let (wave, most) = (self.wave_speed(), 0.1 * sound_speed);
        if wave > 0.0 { wave.min(most) } else { most }
    }

    /// sqrt(g H) [m/s].
    fn wave_speed(&self) -> f64 {
        let domain = self.domain.as_ref();
        let extent = domain.map_or(0.0, |d| (self.height(d.upper) - self.height(d.lower)).abs());
        let height = self.material_height().unwrap_or(extent);
        (self.gravity_size() * height).sqrt()
    }

    /// c0 as given, or from the grains' compressibility, or 10 max(sqrt(g H), expected speed).
    pub(super) fn sound_speed(
        &mut self,
        raw: &RawNumerics,
        table: &Place,
        materials: &[Option<NamedMaterial>],
    ) -> Option<f64> {
        if raw.given.contains(&"grain_compressibility") {
            let at = raw.grain_compressibility.as_ref()?;
            return self.speed_of_grains(raw, at.value.0, &at.place, materials);
        }
        let expected = raw.expected_speed.as_ref()?.value.0;
        if let Some(given) = &raw.sound_speed {
            let height = self.material_height().unwrap_or(0.0);
            let is_enough = self.check_stiff(
                &given.place,
                given.value.0,
                (expected, height),
                "raise sound_speed, or leave it out",
            );
            return is_enough.then_some(given.value.0);
        }
        self.domain.as_ref()?;
        let speed = 10.0 * self.wave_speed().max(expected);
        if speed > 0.0 && speed.is_finite() {
            return Some(speed);
        }
        self.problems.report(
            &table.child("expected_speed"),
            "no gravity and no expected speed",
            "a speed above 0 m/s, from which the sound speed follows",
            "add expected_speed, for example \"1 m/s\"",
        );
        None
    }

    /// Whether a sound speed is no less than the expected speed, and bears the weight of so high a material [m].
    fn check_stiff(
        &mut self,
        place: &Place,
        speed: f64,
        (expected, height): (f64, f64),
        remedy: &str,
    ) -> bool {
        let wave = (self.gravity_size() * height).sqrt();
        if speed < expected {
            self.problems.report(
                place,
                format!("a sound speed of {speed} m/s"),
                format!("at least expected_speed, {expected} m/s; ten times that is usual"),
                remedy,
            );
        } else if speed < wave {
            self.problems.report(
                place,
                format!(
                    "a sound speed of {speed} m/s, by which weight alone would more than double the density"
                ),
                format!("at least sqrt(g H), {wave:.3} m/s here; ten times that is usual"),
                remedy,
            );
        }
        speed >= expected && speed >= wave
    }

    /// Steps follow the scene's sound speed; and what lies on a material must not crush it.
    pub(super) fn check_own_sound_speeds(&mut self, fastest: f64) {
        let entries = self.raw.materials.as_ref().map(|m| &m.value.0);
        for (material, entry) in entries.into_iter().flatten().enumerate() {
            let own = match &entry.value {
                Some(RawMaterial::MuI(raw)) => &raw.sound_speed,
                Some(RawMaterial::BarkerGray(raw)) => &raw.sound_speed,
                Some(RawMaterial::ConstantFriction(raw)) => &raw.sound_speed,
                Some(RawMaterial::Fluid(raw)) => &raw.sound_speed,
                None => continue,
            };
            let Some(own) = own else {
                continue;
            };
            if own.value.0 > fastest {
                self.problems.report(
                    &own.place,
                    format!("{} m/s", own.value.0),
                    format!("at most the scene's sound speed, {fastest} m/s"),
                    "raise numerics.sound_speed, which bounds the step",
                );
                continue;
            }
            let height = self.height_on(material).unwrap_or(0.0);
            let remedy = "raise it, or leave it out";
            self.check_stiff(&own.place, own.value.0, (0.0, height), remedy);
        }
    }

    /// c0 = 1/sqrt(K_t rho_s0 phi_max), which must be one for all materials.
    fn speed_of_grains(
        &mut self,
        raw: &RawNumerics,
        compressibility: f64,
        place: &Place,
        materials: &[Option<NamedMaterial>],
    ) -> Option<f64> {
        if let Some(other) = &raw.sound_speed {
            self.problems.report(
                place,
                format!("grain_compressibility beside {}", other.place.key),
                "one of grain_compressibility and sound_speed: each follows from the other",
                "delete one of them",
            );
            return None;
        }
        let mut densities = materials
            .iter()
            .flatten()
            .map(|m| m.material.rest_density());
        let rho = densities.next()?;
        if densities.any(|other| (other - rho).abs() > 1e-9 * rho) {
            self.problems.report(
                place,
                "materials of different densities at rest",
                "grain_compressibility only where all materials weigh the same: there is one sound speed",
                "give sound_speed instead",
            );
            return None;
        }
        let speed = 1.0 / (compressibility * rho).sqrt();
        let expected = raw.expected_speed.as_ref()?.value.0;
        let height = self.material_height().unwrap_or(0.0);
        let remedy = "lower grain_compressibility, or leave it out";
        let is_enough = self.check_stiff(place, speed, (expected, height), remedy);
        is_enough.then_some(speed)
    }

    /// Height of the highest material over the lowest wall or material; `None` without bodies.
    pub(super) fn material_height(&self) -> Option<f64> {
        let ends = self.filled.iter().map(|body| self.ends(body));
        let (low, high) = ends.reduce(|(a, b), (c, d)| (a.min(c), b.max(d)))?;
        let floor = self.heights.iter().copied().fold(low, f64::min);
        Some(high - floor)
    }

    /// Height of the highest material over the lowest body of this one [m].
    fn height_on(&self, material: usize) -> Option<f64> {
        let top = self.filled.iter().map(|body| self.ends(body).1);
        let own = self.filled.iter().filter(|f| f.material == Some(material));
        let low = own.map(|body| self.ends(body).0).reduce(f64::min)?;
        Some(top.reduce(f64::max)? - low)
    }

    /// Heights of a body's lower and upper end [m].
    fn ends(&self, body: &Filled) -> (f64, f64) {
        let (lower, upper) = body.region.bounds();
        let (a, b) = (self.height(lower), self.height(upper));
        (a.min(b), a.max(b))
    }
}
