//! Walls whose motion is an input.

use super::Lift;
use super::motion::Motion;
use crate::boundary::Steers;
use crate::math::length;
use crate::scene::raw::{At, DriveWord, Place, RawWall, Scalar};
use crate::scene::types::WallDrive;

/// Where start and ramp may stand.
const OF_SPEED: &str = "start and ramp only beside input = \"speed\"";

/// Where end stops may stand.
const OF_STROKE: &str =
    "stroke, and stroke_back beside it, only with input, of a rigid wall with velocity";
const OF_SWING: &str =
    "swing, and swing_back beside it, only with input, of a rigid wall that only turns";

/// The SI value of what is given.
fn value<T: Scalar>(at: &Option<At<T>>) -> Option<f64> {
    at.as_ref().map(|at| at.value.si())
}

/// Keys that say more of an input.
const KEYS: [&str; 6] = [
    "start",
    "ramp",
    "stroke",
    "stroke_back",
    "swing",
    "swing_back",
];

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
        let (stops, others) = if turns {
            (["swing", "swing_back"], ["stroke", "stroke_back"])
        } else {
            (["stroke", "stroke_back"], ["swing", "swing_back"])
        };
        let [stop, back] = stops;
        let of_what = if turns {
            "only turns"
        } else {
            "has a velocity"
        };
        let mut is_right = self.refuse_keys(raw, &others, &format!("of a wall that {of_what}"));
        if !motion.rigid {
            is_right &= self.refuse_keys(raw, &stops, "of a belt, which stays where it is");
        }
        if steers == Steers::Way {
            is_right &= self.refuse_keys(raw, &["start", "ramp"], "beside input = \"position\"");
            is_right &= self.has_position(&input.place, raw, motion.rigid, stop);
        }
        if let Some(start) = raw.start.as_ref().filter(|at| at.value.0 < 0.0)
            && raw.given.contains(&stop)
            && !raw.given.contains(&back)
        {
            self.problems.report(
                &start.place,
                format!("a start of {} at an end stop", start.value.0),
                format!("0 to 1 beside {stop}: where it is drawn it can go forwards only"),
                "turn velocity or angular_velocity round and draw the wall at its other end, or delete start",
            );
            is_right = false;
        }
        if !raw.given.contains(&stop) {
            is_right &= self.refuse_keys(raw, &[back], &format!("without {stop}"));
        }
        if !is_right {
            return None;
        }
        let (forth, back) = match turns {
            true => (value(&raw.swing), value(&raw.swing_back)),
            false => (value(&raw.stroke), value(&raw.stroke_back)),
        };
        Some(Some(WallDrive {
            steers,
            turns,
            full,
            start: value(&raw.start).unwrap_or(0.0),
            ramp: value(&raw.ramp).unwrap_or(0.0),
            stops: match forth {
                Some(forth) => (back.map_or(0.0, |back| -back), forth),
                None => (f64::NEG_INFINITY, f64::INFINITY),
            },
        }))
    }

    /// Keys that say nothing here; whether there is none.
    fn refuse_keys(&mut self, raw: &RawWall, keys: &[&str], found: &str) -> bool {
        let mut is_right = true;
        for key in keys {
            let (place, allowed) = match *key {
                "start" => (raw.start.as_ref().map(|at| &at.place), OF_SPEED),
                "ramp" => (raw.ramp.as_ref().map(|at| &at.place), OF_SPEED),
                "stroke" => (raw.stroke.as_ref().map(|at| &at.place), OF_STROKE),
                "stroke_back" => (raw.stroke_back.as_ref().map(|at| &at.place), OF_STROKE),
                "swing" => (raw.swing.as_ref().map(|at| &at.place), OF_SWING),
                _ => (raw.swing_back.as_ref().map(|at| &at.place), OF_SWING),
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
