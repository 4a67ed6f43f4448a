//! Random choices of a seeded generator.

use crate::state::Random;

/// A generator with the choices that scenes are made of.
#[derive(Clone, Debug)]
pub(super) struct Dice(Random);

impl Dice {
    /// One for each kind of scene and seed: neighbouring seeds share nothing.
    pub(super) fn new(kind: &str, seed: u64) -> Self {
        let letters = kind.bytes().fold(seed, |mixed, byte| {
            mixed
                .wrapping_mul(0x9e37_79b9_7f4a_7c15)
                .wrapping_add(u64::from(byte))
        });
        let mut random = Random::new(letters);
        random.symmetric();
        Self(random)
    }

    /// Uniform in [0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        0.5 * (self.0.symmetric() + 1.0)
    }

    /// Uniform from one number to another, in four digits.
    pub(super) fn from(&mut self, least: f64, most: f64) -> f64 {
        short(least + (most - least) * self.unit())
    }

    /// Uniform in the logarithm, from one positive number to another, in four digits.
    pub(super) fn log(&mut self, least: f64, most: f64) -> f64 {
        short(least * (most / least).powf(self.unit()))
    }

    /// A whole number from `least` to `most`, both possible.
    pub(super) fn whole(&mut self, least: usize, most: usize) -> usize {
        least + ((most - least + 1) as f64 * self.unit()) as usize
    }

    /// True with this probability.
    pub(super) fn chance(&mut self, share: f64) -> bool {
        self.unit() < share
    }

    /// One of several; there must be one.
    pub(super) fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.whole(0, choices.len() - 1)]
    }
}

/// Rounded to four significant digits, so that files read well and are read back to the same bits.
pub(super) fn short(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_stay_in_range_and_depend_on_kind_and_seed() {
        let mut dice = Dice::new("column", 1);
        for _ in 0..1000 {
            assert!((2.0..=3.0).contains(&dice.from(2.0, 3.0)));
            assert!((0.9e-6..=1.1).contains(&dice.log(1e-6, 1.0)));
            assert!((3..=5).contains(&dice.whole(3, 5)));
        }
        let first = |kind, seed| Dice::new(kind, seed).unit().to_bits();
        assert_eq!(first("column", 7), first("column", 7));
        assert_ne!(first("column", 7), first("column", 8));
        assert_ne!(first("column", 7), first("silo", 7));
        assert_eq!(short(0.123_456), 0.1235);
        assert_eq!(short(12_345.678), 12_350.0);
    }
}
