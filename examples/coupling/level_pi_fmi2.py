"""PI level controller for FMI 2.0, built into an FMU by pythonfmu.

    pythonfmu build -f level_pi_fmi2.py --handle-state

All that changes over time is a registered variable: that is what pythonfmu saves and restores.
"""

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class LevelController2(Fmi2Slave):
    """opening = gain * (level - wanted) + integral, within 0 and 1; the integral waits while the opening is at its end."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.level = 0.0
        self.wanted = 0.036
        self.gain = 100.0
        self.integral_time = 4.0
        self.integral = 0.42
        self.opening = 0.0
        self.register_variable(Real("level", causality=Fmi2Causality.input))
        for name in ("wanted", "gain", "integral_time"):
            self.register_variable(
                Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable)
            )
        self.register_variable(Real("integral", causality=Fmi2Causality.local))
        self.register_variable(Real("opening", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        error = self.level - self.wanted
        opening = self.gain * error + self.integral
        if 0.0 < opening < 1.0:
            self.integral += self.gain * error * step_size / self.integral_time
        self.opening = min(max(opening, 0.0), 1.0)
        return True
