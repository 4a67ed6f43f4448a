//! Walls whose motion is an input.

use super::Lift;
use super::motion::Motion;
use crate::boundary::Steers;
use crate::math::length;
use crate::scene::raw::{DriveWord, Place, RawWall};
use crate::scene::types::WallDrive;

/// Where start and ramp may stand.
const OF_SPEED: &str = "start and ramp only beside input = \"speed\"";

/// Keys that say more of an input.
const KEYS: [&str; 4] = ["start", "ramp", "stroke", "swing"];

impl Lift<'_> {
    /// How a wall that moves like this is steered; `Some(None)` if it is not.
    pub(super) fn drive(&mut self, raw: &RawWall, motion: &Motion) -> Option<Option<WallDrive>> {
        let Some(input) = &raw.input else {
            if !raw.given.contains(&"input") {
                self.refuse_keys(raw, &KEYS, "without input");
            }
            return Some(None);
        };
        let (speed, rate) = (
            length(&motion.velocity),
            motion.rotation.map(|r| r.rate.abs()),
        );
        let full = if speed > 0.0 {
            speed
        } else {
            rate.unwrap_or(0.0)
        };
        if full == 0.0 {
            self.problems.report(
                &input.place,
                "input of a wall without velocity or angular_velocity",
                "one of them, not 0: the fastest that the wall goes",
                if self.planar() {
                    "add for example velocity = [\"1 m/s\", 0], or delete input"
                } else {
                    "add for example velocity = [\"1 m/s\", 0, 0], or delete input"
                },
            );
            return None;
        }
        let turns = speed == 0.0;
        let steers = match input.value {
            DriveWord::Speed => Steers::Rate,
            DriveWord::Position => Steers::Way,
        };
        let (stop, other) = if turns {
            ("swing", "stroke")
        } else {
            ("stroke", "swing")
        };
        let of_what = if turns {
            "only turns"
        } else {
            "has a velocity"
        };
        let mut is_right = self.refuse_keys(raw, &[other], &format!("of a wall that {of_what}"));
        if !motion.rigid {
            is_right &= self.refuse_keys(raw, &[stop], "of a belt, which stays where it is");
        }
        if steers == Steers::Way {
            is_right &= self.refuse_keys(raw, &["start", "ramp"], "beside input = \"position\"");
            is_right &= self.has_position(&input.place, raw, motion.rigid, stop);
        }
        is_right.then(|| {
            let ratio = |at: Option<f64>, left_out: f64| at.unwrap_or(left_out);
            let travel = match turns {
                true => raw.swing.as_ref().map(|at| at.value.0),
                false => raw.stroke.as_ref().map(|at| at.value.0),
            };
            Some(WallDrive {
                steers,
                turns,
                full,
                start: ratio(raw.start.as_ref().map(|at| at.value.0), 0.0),
                ramp: ratio(raw.ramp.as_ref().map(|at| at.value.0), 0.0),
                travel: ratio(travel, f64::INFINITY),
            })
        })
    }

    /// Keys that say nothing here; whether there is none.
    fn refuse_keys(&mut self, raw: &RawWall, keys: &[&str], found: &str) -> bool {
        let mut is_right = true;
        for key in keys {
            let (place, allowed) = match *key {
                "start" => (raw.start.as_ref().map(|at| &at.place), OF_SPEED),
                "ramp" => (raw.ramp.as_ref().map(|at| &at.place), OF_SPEED),
                "stroke" => (
                    raw.stroke.as_ref().map(|at| &at.place),
                    "stroke only beside input, of a rigid wall with velocity",
                ),
                _ => (
                    raw.swing.as_ref().map(|at| &at.place),
                    "swing only beside input, of a rigid wall that only turns",
                ),
            };
            if let Some(place) = place {
                let found = format!("{key} {found}");
                self.problems
                    .report(place, found, allowed, format!("delete {key}"));
                is_right = false;
            }
        }
        is_right
    }

    /// Whether a wall has a position that can be asked for.
    fn has_position(
        &mut self,
        input: &Place,
        raw: &RawWall,
        rigid: bool,
        stop: &'static str,
    ) -> bool {
        let example = if stop == "swing" {
            "swing = \"60 deg\""
        } else {
            "stroke = \"0.2 m\""
        };
        let (found, allowed, remedy) = if !rigid {
            (
                "input = \"position\" of a belt, which stays where it is",
                "input = \"speed\" of belts; \"position\" of rigid walls".to_owned(),
                "set motion = \"rigid\", or input = \"speed\"".to_owned(),
            )
        } else if !raw.given.contains(&stop) {
            (
                "input = \"position\" without an end stop",
                format!("{stop}, how far the wall goes from where it is drawn"),
                format!("add for example {example}"),
            )
        } else {
            return true;
        };
        self.problems.report(input, found, allowed, remedy);
        false
    }
}
