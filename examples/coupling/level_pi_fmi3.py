"""PI level controller for FMI 3.0, built into an FMU by pythonfmu3.

    pythonfmu3 build -f level_pi_fmi3.py --handle-state

All that changes over time is a registered variable: that is what pythonfmu3 saves and restores.
"""

from pythonfmu3 import Fmi3Causality, Fmi3Slave, Fmi3Variability, Float64


class LevelController3(Fmi3Slave):
    """opening = gain * (level - wanted) + integral, within 0 and 1; the integral waits while the opening is at its end."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.time = 0.0
        self.level = 0.0
        self.wanted = 0.036
        self.gain = 100.0
        self.integral_time = 4.0
        self.integral = 0.42
        self.opening = 0.0
        self.register_variable(
            Float64("time", causality=Fmi3Causality.independent, variability=Fmi3Variability.continuous)
        )
        self.register_variable(Float64("level", causality=Fmi3Causality.input, start=0.0))
        for name in ("wanted", "gain", "integral_time"):
            self.register_variable(
                Float64(name, causality=Fmi3Causality.parameter, variability=Fmi3Variability.tunable)
            )
        self.register_variable(Float64("integral", causality=Fmi3Causality.local))
        self.register_variable(Float64("opening", causality=Fmi3Causality.output))

    def do_step(self, current_time, step_size):
        error = self.level - self.wanted
        opening = self.gain * error + self.integral
        if 0.0 < opening < 1.0:
            self.integral += self.gain * error * step_size / self.integral_time
        self.opening = min(max(opening, 0.0), 1.0)
        return True
