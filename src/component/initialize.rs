//! Initialisation: the way from Instantiated to Stepping, and back where it failed.

use super::lifecycle::{self, Call};
use super::{Component, Error, Mode};
use crate::units::shown;

/// Rounding of a start time over the acoustic step [1].
const MOST_ROUNDING: f64 = 1e-3;

/// Where a component stood when it was about to be initialised.
#[derive(Clone, Copy, Debug)]
pub struct Beginning {
    mode: Mode,
    time: f64,
    stop: Option<f64>,
}

impl Component {
    /// Instantiated -> Initialization. `stop`: no step may end later [s].
    ///
    /// # Errors
    /// [`Error::NotAllowedNow`], [`Error::BadArgument`] for times that are not finite, in the wrong order, or so far from 0 that doubles
    /// do not tell a thousandth of an acoustic step from the next.
    pub fn enter_initialization(&mut self, start: f64, stop: Option<f64>) -> Result<(), Error> {
        lifecycle::check(Call::EnterInitialization, self.life.mode)?;
        self.check_times("enter_initialization", start, stop)?;
        self.life.mode = Mode::Initialization;
        self.life.time = start;
        self.life.stop = stop;
        Ok(())
    }

    /// Whether a simulation may begin at `start` and end at `stop` [s], for adapters that are told before
    /// [`Component::enter_initialization`]; `call` stands in the message.
    ///
    /// # Errors
    /// [`Error::BadArgument`], as there.
    pub fn check_times(
        &self,
        call: &'static str,
        start: f64,
        stop: Option<f64>,
    ) -> Result<(), Error> {
        let refuse = |what: &str, found: f64, allowed: String| {
            Err(Error::BadArgument {
                call,
                what: what.to_owned(),
                found: format!("{} s", shown(found)),
                allowed,
                remedy: String::new(),
            })
        };
        if !start.is_finite() {
            return refuse("start time", start, "a finite time".to_owned());
        }
        self.check_fineness(call, "start time", start)?;
        if let Some(stop) = stop
            && !(stop.is_finite() && stop >= start)
        {
            return refuse(
                "stop time",
                stop,
                format!(
                    "a finite time from {} s, the start, on, or none (INFINITY in C)",
                    shown(start)
                ),
            );
        }
        Ok(())
    }

    /// Times are doubles, and must tell internal steps apart.
    pub(super) fn check_fineness(
        &self,
        call: &'static str,
        what: &str,
        time: f64,
    ) -> Result<(), Error> {
        let fine = MOST_ROUNDING * self.scene.numerics.acoustic_step();
        let latest = fine / f64::EPSILON;
        if time.abs() <= latest {
            return Ok(());
        }
        Err(Error::BadArgument {
            call,
            what: what.to_owned(),
            found: format!("{} s", shown(time)),
            allowed: format!(
                "at most {} s from 0, where doubles still tell times {fine:.1e} s apart, a thousandth of this scene's acoustic \
                 step",
                latest.floor()
            ),
            remedy: "count time from a later origin".to_owned(),
        })
    }

    /// Initialization -> Stepping. Outputs are those of the start.
    ///
    /// # Errors
    /// [`Error::NotAllowedNow`]; those of [`Component::settle`]: the mode stays, parameters may be corrected.
    pub fn exit_initialization(&mut self) -> Result<(), Error> {
        lifecycle::check(Call::ExitInitialization, self.life.mode)?;
        self.settle()?;
        self.life.mode = Mode::Stepping;
        Ok(())
    }

    /// `enter_initialization` and `exit_initialization` in one.
    ///
    /// # Errors
    /// As these; nothing is changed then.
    pub fn initialize(&mut self, start: f64, stop: Option<f64>) -> Result<(), Error> {
        let before = self.beginning();
        self.enter_initialization(start, stop)?;
        self.exit_initialization()
            .inspect_err(|_| self.go_back(before))
    }

    /// Where it stands now, for [`Component::take_back`].
    #[must_use]
    pub fn beginning(&self) -> Beginning {
        Beginning {
            mode: self.life.mode,
            time: self.life.time,
            stop: self.life.stop,
        }
    }

    /// Takes an initialisation back before the first step, because what an adapter ties to it failed. Parameters stay.
    ///
    /// # Errors
    /// [`Error::NotAllowedNow`] once a step was done.
    pub fn take_back(&mut self, to: Beginning) -> Result<(), Error> {
        lifecycle::check(Call::DoStep, self.life.mode)?;
        if self.life.communication_steps > 0 {
            return lifecycle::check(Call::ExitInitialization, self.life.mode);
        }
        self.go_back(to);
        Ok(())
    }

    fn go_back(&mut self, to: Beginning) {
        (self.life.mode, self.life.time, self.life.stop) = (to.mode, to.time, to.stop);
    }
}
