r"""The experiment on the virtual mock-up.

    φ_c(t) = φ_v + A sin(2π t/P),   0 ≤ t ≤ D,   held before and after                               (1)

sampled every 2 ms, A = 1.2 rad about the vertical φ_v, D = 133 s. The period P is not published; D/2 is
assumed, and that the arm stands upright. After D the run goes on for a few seconds, to see the stop.
The tracker's clock is late and its frame is off by amounts that its stated sigmas allow and the record does
not tell.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np
from numpy.typing import ArrayLike

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.drive import Drive
from flexarm.errors import InvalidParameter
from flexarm.measurement.clocks import ClockError
from flexarm.measurement.frames import Registration
from flexarm.measurement.measure import measure
from flexarm.mockup.arms import mock_up
from flexarm.record import Clock, Frame, Record
from flexarm.simulation import Progress, Simulation, simulate


@dataclass(frozen=True)
class Experiment:
    """The motion that the arm is asked for, eq. (1)."""

    amplitude: float = 1.2
    """A [rad]."""
    period: float = 66.5
    duration: float = 133.0
    """P and D [s]."""
    rest: float = 5.0
    """Time after the command's end that is still recorded [s]."""
    sample_time: float = 2e-3
    """Of the command [s]."""
    hanging: bool = False
    """About the hanging vertical instead of the upright one."""

    def __post_init__(self) -> None:
        for name in ("amplitude", "period", "duration", "sample_time"):
            if not getattr(self, name) > 0:
                raise InvalidParameter(f"must be positive, got {getattr(self, name)}", where=name)
        if not self.rest >= 0:
            raise InvalidParameter(f"must not be negative, got {self.rest} s", where="rest")

    @property
    def end(self) -> float:
        """End of the record [s]."""
        return self.duration + self.rest

    @property
    def vertical(self) -> float:
        """φ_v [rad]."""
        return pi if self.hanging else 0.0

    def angle(self, time: ArrayLike) -> Floats:
        """Return φ_c of (1) [rad]."""
        t = np.clip(np.asarray(time, dtype=float), 0.0, self.duration)
        found: Floats = self.vertical + self.amplitude * np.sin(2 * pi * t / self.period)  # eq. (1)
        return found

    def command(self) -> Drive:
        """Return (1) as the controller gets it, sample by sample."""
        return self._drive("command", self.end)

    def pure_sine(self) -> Drive:
        """Return (1) as an angle of the motor: it starts and stops with a jump of its rate."""
        return self._drive("motor", self.duration)

    def _drive(self, side: str, end: float) -> Drive:
        time = self.sample_time * np.arange(round(end / self.sample_time) + 1)
        drive = Drive.from_samples(time, {"hinge": self.angle(time)}, side=side)
        return Drive(drive.joints, end=self.end)


def virtual_measurement(
    experiment: Experiment | None = None,
    arm: Arm | None = None,
    *,
    seed: int = 2008,
    step: float = 1e-3,
    progress: Progress = None,
) -> tuple[Record, Simulation]:
    """Run the virtual mock-up and measure it; by default the paper's experiment on the arm that ships with
    flexarm.

    The record holds an encoder, which drives, and the tracker's two reflectors; the simulation is the motion
    itself, which no sensor knows. `seed` is of all noise, and of the errors of the tracker's clock and frame;
    `step` the longest time step [s]; `progress` as in `flexarm.simulate`.
    """
    frame_sigma = (1e-4, 3e-5)  # 1 sigma of the tracker's registration: translation [m], rotation [rad]
    clock_sigma = 5e-4  # 1 sigma of the tracker's clock against the controller's [s]
    asked, bench = experiment or Experiment(), arm or mock_up()
    truth = simulate(bench, asked.command(), step=step, end=asked.end, progress=progress)
    rng = np.random.default_rng(seed)
    translation, rotation = frame_sigma
    record = measure(
        truth,
        bench.sensors,
        rng,
        drive=("encoder",),
        clocks={"controller": Clock(), "tracker": Clock(sigma=clock_sigma)},
        frames={"tracker": Frame(translation=translation, rotation=rotation)},
        clock_errors={"tracker": ClockError(delay=clock_sigma * rng.standard_normal())},
        registrations={
            "tracker": Registration(translation * rng.standard_normal(3), rotation * rng.standard_normal(3))
        },
        description="virtual measurement on the simulated mock-up",
    )
    return record, truth
