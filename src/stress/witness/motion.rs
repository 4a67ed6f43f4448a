//! How fast particles are, where they are against walls, and how long the steps.

use crate::component::Component;
use crate::solver::Scheme;

use super::Witness;
use crate::stress::checks::Check;
use crate::stress::ride::Done;
use crate::stress::walls;

impl Witness<'_> {
    pub(super) fn check_speed(&mut self, component: &Component, time: f64) {
        let allowed = 3.0 * self.balance.speed(time);
        let fastest = component.statistics().max_speed;
        self.figures.speed_share = self.figures.speed_share.max(fastest / allowed);
        if fastest > allowed {
            self.fail(
                Check::Speed,
                time,
                format!("a particle at {fastest:.3} m/s, allowed {allowed:.3} m/s"),
            );
        }
    }

    pub(super) fn check_leak(&mut self, component: &Component, time: f64) {
        let spacing = self.scene.numerics.spacing;
        let view = component.particles();
        let axes = self.scene.dimension.axes();
        let points = component.wall_points();
        let points: Vec<([f64; 3], f64)> =
            points.into_iter().zip(component.wall_shares()).collect();
        let (share, place) = walls::deepest(&view, &points, spacing, axes);
        self.figures.deepest = self.figures.deepest.max(share);
        if share > walls::MOST_WALL {
            self.fail(
                Check::Leak,
                time,
                format!(
                    "a particle at {place:?} m, whose neighbourhood is wall by {share:.2}, allowed {}",
                    walls::MOST_WALL
                ),
            );
        }
        if let Some((place, depth)) = walls::outside(&view, &self.drive.inside, spacing) {
            self.fail(
                Check::Leak,
                time,
                format!("a particle at {place:?} m, {depth:.2} dp outside the container"),
            );
        }
    }

    pub(super) fn check_step_size(&mut self, done: &Done, time: f64) {
        let n = &self.scene.numerics;
        if n.scheme != Scheme::Implicit || self.slept {
            return;
        }
        let h = n.smoothing_ratio * n.spacing;
        let acoustic = n.longest_step();
        let motion = 0.2 * h / (6.0 * self.balance.speed(time)).max(f64::MIN_POSITIVE);
        let least = acoustic.min(motion).min(done.asked) / 3.0;
        let share = done.report.smallest_step / acoustic.min(done.asked);
        self.figures.least_step = if self.figures.least_step == 0.0 {
            share
        } else {
            self.figures.least_step.min(share)
        };
        if done.report.smallest_step < least {
            self.fail(
                Check::StepSize,
                time,
                format!(
                    "an internal step of {:e} s (bound by {}), allowed {least:e} s",
                    done.report.smallest_step,
                    done.report.bound_by.name()
                ),
            );
        }
    }
}
