//! Run times, schedules and log settings.

use super::Lift;
use super::devices::up_to;
use super::full_names::full_names;
use crate::boundary::Steers;
use crate::scene::raw::{At, InterpolationWord, List, RawSchedule, SeriesPoint, SyncWord, Text};
use crate::scene::types::{
    Inflow, InputTarget, Interpolation, LogSettings, Run, Schedule, Wall, WallDrive,
};
use crate::solver::Numerics;
use crate::units::{Quantity, quote, shown_bound};

/// Most internal steps until the end: a thousand particles take weeks for them.
const MOST_INTERNAL_STEPS: f64 = 1e9;

/// What an input of a steered wall is measured in.
fn drive_quantity(drive: &WallDrive) -> Quantity {
    match (drive.steers, drive.turns) {
        (Steers::Rate, false) => Quantity::Velocity,
        (Steers::Rate, true) => Quantity::AngularVelocity,
        (Steers::Way, false) => Quantity::Length,
        (Steers::Way, true) => Quantity::Angle,
    }
}

impl Lift<'_> {
    pub(super) fn run(&mut self) -> Option<Run> {
        let raw = &self.raw.run.as_ref()?.value;
        let (step, until) = (raw.step.as_ref()?, raw.until.as_ref()?);
        if until.value.0 < step.value.0 {
            self.problems.report(
                &until.place,
                format!("{} s", until.value.0),
                format!("at least run.step, {} s", step.value.0),
                "raise until or shorten step",
            );
            return None;
        }
        let steps = until.value.0 / step.value.0;
        if steps > Run::MOST_STEPS {
            self.problems.report(
                &step.place,
                format!(
                    "{} s, which makes {steps:.3e} steps until {} s",
                    step.value.0, until.value.0
                ),
                format!("at most {:.0e} communication steps", Run::MOST_STEPS),
                "use a longer step or an earlier end",
            );
            return None;
        }
        Some(Run {
            step: step.value.0,
            until: until.value.0,
        })
    }

    /// Reports sound speeds that make a run endless, as slips of units do.
    pub(super) fn check_internal_steps(&mut self, numerics: Option<&Numerics>, run: Option<Run>) {
        let (Some(numerics), Some(run), Some(table)) = (numerics, run, &self.raw.numerics) else {
            return;
        };
        let step = numerics.acoustic_step();
        let steps = run.until / step;
        if steps <= MOST_INTERNAL_STEPS {
            return;
        }
        let speed = numerics.sound_speed;
        let (sound, grains) = (&table.value.sound_speed, &table.value.grain_compressibility);
        let (place, of) = match (sound, grains) {
            (Some(given), _) => (given.place.clone(), "a sound speed"),
            (None, Some(given)) => (given.place.clone(), "grains with a sound speed"),
            (None, None) => (
                table.place.child("expected_speed"),
                "gravity, height and expected speed with a sound speed",
            ),
        };
        self.problems.report(
            &place,
            format!(
                "{of} of {speed:.3e} m/s, which makes internal steps of {step:.1e} s, {steps:.1e} of them until {} s",
                run.until
            ),
            format!("at most {MOST_INTERNAL_STEPS:.0e} internal steps"),
            "check units; ten times sqrt(g H) or the fastest speed is usual for the sound speed; else a coarser spacing or an \
             earlier end",
        );
    }

    pub(super) fn log(&mut self, run: Option<Run>) -> Option<LogSettings> {
        let step = run.map_or(0.0, |r| r.step);
        let log = self.raw.log.as_ref()?;
        let every = log.value.particles_every.as_ref()?;
        let left_out = !log.value.given.contains(&"particles_every");
        let mut particles_every = every.value.0;
        if left_out {
            // As often as is usual, but no more often than there is something new.
            particles_every = particles_every.max(step);
        } else if particles_every > 0.0 && particles_every < step * (1.0 - 1e-9) {
            self.problems.report(
                &every.place,
                format!("{particles_every} s"),
                format!("0 (none), or at least run.step, {step} s"),
                "snapshots are taken at communication steps: lengthen particles_every or shorten run.step",
            );
            return None;
        }
        Some(LogSettings {
            particles_every,
            required: log.value.required.as_ref()?.value.0,
            deterministic: log.value.deterministic.as_ref()?.value.0,
            rotate_every: log.value.rotate_every.as_ref()?.value.0,
            // `as` saturates.
            rotate_bytes: (log.value.rotate_megabytes.as_ref()?.value.0 * 1e6) as u64,
            sync_every_flush: log.value.sync.as_ref()?.value == SyncWord::Flush,
        })
    }

    pub(super) fn schedules(&mut self, walls: &[Wall], inflows: &[Inflow]) -> Vec<Schedule> {
        let raw = self.raw;
        let entries = raw.schedule.as_ref().map(|s| &s.value.0);
        let mut lifted: Vec<Schedule> = Vec::new();
        for at in entries.into_iter().flatten() {
            let Some(schedule) = self.schedule(&at.value, (walls, inflows)) else {
                continue;
            };
            if lifted.iter().any(|s| s.input == schedule.input)
                && let Some(input) = &at.value.input
            {
                self.problems.report(
                    &input.place,
                    format!("a second schedule for {}", quote(&input.value.0)),
                    "one schedule for each input",
                    "join their points into one",
                );
            }
            lifted.push(schedule);
        }
        lifted
    }

    fn schedule(
        &mut self,
        raw: &RawSchedule,
        (walls, inflows): (&[Wall], &[Inflow]),
    ) -> Option<Schedule> {
        let input = raw.input.as_ref().and_then(|i| self.input(i, walls));
        let points = raw.points.as_ref()?;
        self.check_times_ascend(points);
        let (target, name) = input?;
        let (quantity, range) = match target {
            InputTarget::GateOpening(_) => (Quantity::Ratio, Some((0.0, 1.0))),
            InputTarget::InflowRate(_) => {
                let inflow = inflows.iter().find(|i| i.name == name);
                (Quantity::MassRate, inflow.map(|i| (0.0, i.max_rate)))
            }
            InputTarget::WallDrive(_) => {
                let wall = walls.iter().find(|w| w.name == name);
                let drive = wall.and_then(|w| w.drive.as_ref())?;
                (drive_quantity(drive), Some(drive.range()))
            }
        };
        let mut values = Vec::new();
        for at in &points.value.0 {
            values.push((at.value.time, self.series_value(at, quantity, range)?));
        }
        Some(Schedule {
            input: target,
            points: values,
            interpolation: match raw.interpolation.as_ref()?.value {
                InterpolationWord::Linear => Interpolation::Linear,
                InterpolationWord::Hold => Interpolation::Hold,
            },
        })
    }

    /// A value of the input's quantity and range.
    fn series_value(
        &mut self,
        at: &At<SeriesPoint>,
        quantity: Quantity,
        range: Option<(f64, f64)>,
    ) -> Option<f64> {
        let remedy = format!("write for example [0.5, {:?}]", quantity.example());
        let value = match at.value.value.resolve(quantity) {
            Ok(value) => value,
            Err(found) => {
                self.problems
                    .report(&at.place, found, quantity.allowed(), remedy);
                return None;
            }
        };
        let (least, most) = range.unwrap_or((0.0, f64::INFINITY));
        if let Some(value) = up_to(most, value).and_then(|value| Some(-up_to(-least, -value)?)) {
            return Some(value);
        }
        let unit = match quantity {
            Quantity::Ratio => String::new(),
            other => format!(" {}", other.si()),
        };
        self.problems.report(
            &at.place,
            format!("a value of {value}{unit}"),
            format!(
                "{} to {}{unit}, the range of this input",
                shown_bound(least),
                shown_bound(most)
            ),
            "choose a value in this range",
        );
        None
    }

    /// At least one point, from time 0 on, each later than the one before.
    fn check_times_ascend(&mut self, points: &At<List<SeriesPoint>>) {
        let Some(first) = points.value.0.first() else {
            self.problems.report(
                &points.place,
                "no points",
                "at least one point [time, value]",
                "add for example [0, 1]",
            );
            return;
        };
        if first.value.time < 0.0 {
            self.problems.report(
                &first.place,
                format!("a time of {} s", first.value.time),
                "times of 0 s or later",
                "let the series begin at 0",
            );
        }
        for pair in points.value.0.windows(2) {
            let (before, after) = (pair[0].value.time, pair[1].value.time);
            if after <= before {
                self.problems.report(
                    &pair[1].place,
                    format!("{after} s after {before} s"),
                    "times that ascend",
                    "sort the points by time; for a jump use two times close together or interpolation = \"hold\"",
                );
                return;
            }
        }
    }

    /// `gate.NAME.opening`, `inflow.NAME.rate`, or the input of a steered wall.
    fn input<'t>(&mut self, at: &'t At<Text>, walls: &[Wall]) -> Option<(InputTarget, &'t str)> {
        let raw = self.raw;
        let parts: Vec<&str> = at.value.0.split('.').collect();
        let steered = walls.iter();
        let steered = steered.filter_map(|w| Some((w.name.as_str(), w.drive.as_ref()?)));
        match parts[..] {
            ["gate", name, "opening"] => {
                let index = self.index_of(name, &at.place, "gates", raw.gates.as_ref())?;
                Some((InputTarget::GateOpening(index), name))
            }
            ["inflow", name, "rate"] => {
                let index = self.index_of(name, &at.place, "inflows", raw.inflows.as_ref())?;
                Some((InputTarget::InflowRate(index), name))
            }
            ["wall", name, what]
                if let Some(index) = steered
                    .clone()
                    .position(|(wall, drive)| wall == name && drive.input() == what) =>
            {
                Some((InputTarget::WallDrive(index), name))
            }
            _ => {
                let mut known = full_names("gate", raw.gates.as_ref(), ".opening");
                known.extend(full_names("inflow", raw.inflows.as_ref(), ".rate"));
                known.extend(steered.map(|(wall, drive)| format!("wall.{wall}.{}", drive.input())));
                let allowed = "\"gate.NAME.opening\", \"inflow.NAME.rate\" or \"wall.NAME.speed\" (position, angle) of a steered wall";
                let ways = (allowed, "gate.main.opening");
                self.report_full_name(&at.place, &at.value.0, ways, &known);
                None
            }
        }
    }
}
