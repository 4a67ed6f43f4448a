//! What sleeps, rests or falls freely, and whether gates do as they are told.

use crate::boundary::Steers;
use crate::component::{Component, Totals};
use crate::scene::InputTarget;

use super::Witness;
use crate::stress::balance::Before;
use crate::stress::checks::Check;
use crate::stress::walls;

impl Witness<'_> {
    /// A sleeping scene wakes when it is told something, and only then.
    pub(super) fn check_sleep(
        &mut self,
        component: &Component,
        now: &Before,
        wanted: &[(InputTarget, f64)],
        time: f64,
    ) {
        if !self.slept {
            return;
        }
        let told = wanted.iter().any(|(input, value)| match input {
            InputTarget::GateOpening(i) => (self.before.openings[*i] - value).abs() > 1e-6,
            InputTarget::InflowRate(_) => *value > 0.0,
            InputTarget::WallDrive(n) => self.is_told_to_move(*n, *value),
        });
        let worked = component.steps() > self.steps;
        if told && !worked {
            self.fail(
                Check::Sleep,
                time,
                format!("told {wanted:?}, it slept on: no internal step was done"),
            );
        }
        if !told && (worked || now.totals.moment != self.before.totals.moment) {
            self.fail(
                Check::Sleep,
                time,
                "nothing was told and it did not sleep on".to_owned(),
            );
        }
    }

    /// Whether a steered wall is told to move from where it stands.
    fn is_told_to_move(&self, drive: usize, told: f64) -> bool {
        let scene = self.scene;
        let walls = scene.walls.iter().zip(&self.before.wall_times);
        let mut steered = walls.filter_map(|(w, time)| Some((w.drive.as_ref()?, time)));
        steered
            .nth(drive)
            .is_some_and(|(drive, time)| match drive.steers {
                Steers::Rate => told != 0.0,
                Steers::Way => (time * drive.full - told).abs() > 1e-6 * drive.full,
            })
    }

    pub(super) fn check_gates(
        &mut self,
        now: &Before,
        wanted: &[(InputTarget, f64)],
        h: f64,
        time: f64,
    ) {
        for (input, value) in wanted {
            let InputTarget::GateOpening(i) = input else {
                continue;
            };
            let gate = &self.scene.gates[*i];
            let length = walls::length(&gate.from, &gate.to);
            let (from, to) = (self.before.openings[*i], now.openings[*i]);
            let moved = (to - from) * length;
            let most = gate.max_speed * h * (1.0 + 1e-9) + 1e-12 * length;
            // A plate that closes may wait for grains, and says so; one that opens has nothing in its way.
            let speed = gate.max_speed.min(self.scene.numerics.plate_speed());
            let way = (value - from) * length;
            let least = way.abs().min(speed * h);
            let waits = way < 0.0 && now.blocked[*i];
            let arrives = waits || moved * way.signum() >= least * (1.0 - 1e-6) - 1e-9 * length;
            if !(0.0..=1.0).contains(&to) || moved.abs() > most || !arrives {
                self.fail(
                    Check::Gate,
                    time,
                    format!(
                        "gate {} told {value} went from {from} to {to} in {h} s, allowed at most {most} m{}",
                        gate.name,
                        if arrives { String::new() } else { format!(" and at least {least} m, as it is not blocked") }
                    ),
                );
            }
        }
    }

    pub(super) fn check_rest(&mut self, totals: &Totals, mass: f64, time: f64) {
        if !self.drive.rest || mass <= 0.0 {
            return;
        }
        let centre = totals.moment.map(|m| m / mass);
        let Some(half) = self.half else {
            // Half of the communication steps, or of the internal ones where those run out first.
            let late = self.figures.communication_steps + 1 >= self.drive.count as u64 / 2
                || self.figures.internal_steps >= self.drive.most_steps / 2;
            self.half = late.then_some(centre);
            return;
        };
        let moved = walls::length(&half, &centre) / self.scene.numerics.spacing;
        let energy = totals.kinetic_energy / self.balance.scale(mass);
        self.figures.creep = self.figures.creep.max(moved);
        if moved > 0.01 || energy > 1e-5 {
            self.fail(
                Check::Rest,
                time,
                format!(
                    "the centre of mass moved by {moved:.2e} dp, allowed 0.01; kinetic energy is {energy:.2e} of M g H, allowed 1e-5"
                ),
            );
        }
    }

    /// A block that nothing touches falls at g, as one.
    pub(super) fn check_fall(&mut self, totals: &Totals, mass: f64, time: f64) {
        let g = &self.scene.domain.gravity;
        let start = self.balance.start_velocity();
        let mean = totals.momentum.map(|p| p / mass);
        let miss: f64 = (0..3)
            .map(|k| (mean[k] - start[k] - g[k] * time).powi(2))
            .sum();
        let own = 2.0 * totals.kinetic_energy / mass - mean.iter().map(|v| v * v).sum::<f64>();
        let size = walls::length(g, &[0.0; 3]);
        let miss = miss.sqrt() / (size * time + walls::length(&start, &[0.0; 3]));
        // It starts with the pressure of its height, which has nothing to rest on: p = rho g H gives off p/(rho c0).
        let given = size * self.balance.height() / self.scene.numerics.sound_speed;
        let spread = own.max(0.0).sqrt() / given;
        if miss > 1e-9 || spread > 1.0 {
            self.fail(
                Check::Rest,
                time,
                format!("a block that falls misses g t by {miss:.2e} of it, allowed 1e-9; its grains differ by {spread:.2e} of what its pressure gives, allowed 1"),
            );
        }
    }
}
