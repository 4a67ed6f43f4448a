//! Errors of what was measured, the Pareto front, and who is dominated.

use super::studies::{Reference, Study};
use super::{Measured, PrecisionRun};

/// How much cheaper, at no larger error, another setting must be to dominate: timings scatter by so much.
const CHEAPER: f64 = 0.95;

/// A setting with its error.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    /// What was measured.
    pub measured: Measured,
    /// Its error [1]; `None` where the run failed.
    pub error: Option<f64>,
    /// Whether no other is both cheaper and no worse.
    pub on_front: bool,
    /// Name and resolution of the cheapest setting that is cheaper and no worse.
    pub dominated_by: Option<(String, f64)>,
}

/// Settings of a study in the order in which they were tried, and the error of the reference where it is our own.
#[must_use]
pub fn standings(study: &Study, run: &PrecisionRun) -> (Vec<Standing>, Option<f64>) {
    let own: Vec<&Measured> = run
        .measured
        .iter()
        .filter(|m| m.study == study.name)
        .collect();
    let at = |resolution: f64| {
        own.iter()
            .find(|m| m.setting == "defaults" && m.resolution == resolution)
            .and_then(|m| m.value)
    };
    let count = study.resolutions.len();
    let finest = study.resolutions.last().copied().and_then(at);
    let next = count.checked_sub(2).and_then(|i| at(study.resolutions[i]));
    let reference = match study.reference {
        Reference::Error => Some(0.0),
        Reference::Finest => finest,
    };
    let uncertain = match study.reference {
        Reference::Error => None,
        Reference::Finest => finest
            .zip(next)
            .map(|(fine, next)| ((fine - next) / fine).abs()),
    };
    let error = |m: &Measured| -> Option<f64> {
        let (value, reference) = (m.value?, reference?);
        Some(match study.reference {
            Reference::Error => value,
            Reference::Finest => ((value - reference) / reference).abs(),
        })
    };
    // The reference itself has no error against itself: it is not judged.
    let judged = |m: &Measured| {
        let is_reference = study.reference == Reference::Finest
            && m.setting == "defaults"
            && Some(m.resolution) == study.resolutions.last().copied();
        (!is_reference).then(|| error(m)).flatten()
    };
    let standing = |m: &&Measured| {
        let mine = judged(m);
        let better = |other: &&&Measured| {
            judged(other)
                .zip(mine)
                .is_some_and(|(theirs, mine)| theirs <= mine && other.cpu < CHEAPER * m.cpu)
        };
        let best = own
            .iter()
            .filter(better)
            .min_by(|a, b| a.cpu.total_cmp(&b.cpu));
        Standing {
            measured: (*m).clone(),
            error: mine,
            on_front: mine.is_some() && best.is_none(),
            dominated_by: best.map(|b| (b.setting.clone(), b.resolution)),
        }
    };
    (own.iter().map(standing).collect(), uncertain)
}

#[cfg(test)]
mod tests {
    use super::super::{Machine, by_name};
    use super::*;

    fn measured(study: &str, setting: &str, resolution: f64, value: f64, cpu: f64) -> Measured {
        Measured {
            study: study.to_owned(),
            resolution,
            setting: setting.to_owned(),
            key: String::new(),
            value: value.is_finite().then_some(value),
            cpu,
            particles: 1,
            steps: 1,
            simulated: 1.0,
        }
    }

    #[test]
    fn the_front_is_what_nothing_cheaper_beats() {
        let run = PrecisionRun {
            machine: Machine::here(),
            measured: vec![
                measured("bagnold", "defaults", 1.0, 0.02, 1.0),
                measured("bagnold", "a", 1.0, 0.01, 2.0),
                measured("bagnold", "b", 1.0, 0.03, 3.0),
                measured("bagnold", "c", 1.0, f64::NAN, 0.1),
                measured("bagnold", "d", 1.0, 0.02, 1.02),
            ],
        };
        let (all, uncertain) = standings(by_name("bagnold").unwrap(), &run);
        let front: Vec<bool> = all.iter().map(|s| s.on_front).collect();
        assert_eq!(front, [true, true, false, false, true]);
        assert_eq!(all[2].dominated_by, Some(("defaults".to_owned(), 1.0)));
        assert_eq!((all[3].error, uncertain), (None, None));
    }

    #[test]
    fn an_own_reference_is_not_judged_and_has_its_error() {
        let mut run = PrecisionRun {
            machine: Machine::here(),
            measured: Vec::new(),
        };
        for (resolution, value) in [(0.5, 0.8), (1.4, 0.95), (2.0, 1.0)] {
            run.measured.push(measured(
                "column", "defaults", resolution, value, resolution,
            ));
        }
        let (all, uncertain) = standings(by_name("column").unwrap(), &run);
        assert!((uncertain.unwrap() - 0.05).abs() < 1e-12);
        assert!((all[0].error.unwrap() - 0.2).abs() < 1e-12);
        assert_eq!((all[2].error, all[2].on_front), (None, false));
    }
}
