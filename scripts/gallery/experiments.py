"""The arm and the runs that the gallery measures, without noise.

The arm is the paper's (`flexarm.mockup.model`) with a third reflector at mid-span. Both motions start and end
at rest: a slow cosine through +-1.2 rad, and minimum-jerk moves through the points of `STOPS`,

    q(s) = q_0 + (q_1 - q_0) (10 s^3 - 15 s^4 + 6 s^5),     s = (t - t_0)/(t_1 - t_0)                (1)

slow and with reversals at first, faster later. The motor's angle is what is prescribed, as in the paper.
Source of (1): [Flash1985].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from flexarm import Arm, Drive, mockup
from flexarm.arm import Point, Sensor
from flexarm.record import Record
from flexarm.record.table import CarriedPayload

Floats = NDArray[np.float64]

JOINT, LINK, PAYLOAD = "hinge", "tube", "load"
ENCODER, TRACKER = "encoder", "tracker"
SWING = 1.2
"""Greatest angle from the vertical [rad]."""
LIGHT = 5.0
"""The second payload, weighed [kg]."""
STOPS = [
    *((0.0, -1.2), (6.0, 1.2), (8.0, 0.9), (9.5, 1.1), (14.5, -0.2)),
    *((16.0, 0.15), (17.4, -0.15), (18.7, 0.1), (20.0, 0.1)),
]
"""Times [s] and angles [rad] where the faster motion stops."""
NOISE = {"tip": 5e-5, "mid": 5e-5, "hub": 5e-5, "torque": 2.0}
"""1 sigma by which signals are weighed [m, N m]: the paper's tracker, a torque from the motor's current."""


@dataclass(frozen=True)
class Experiment:
    """A run of the bench.

    Attributes
    ----------
    name : str
        For people.
    angle : callable
        Motor angle over the ratio [rad] at times [s].
    duration, step, rate_hz : float
        Length of the run [s], longest time step [s], samples of all sensors but the encoder a second.
    payload : float or None
        Weighed mass that is carried [kg]; None: the model's, which is not weighed.
    """

    name: str
    angle: Callable[[Floats], Floats]
    duration: float
    step: float
    rate_hz: float
    payload: float | None = None

    def drive(self) -> Drive:
        """The motion, joined at the encoder's own instants."""
        time = np.arange(round(self.duration * ENCODER_HZ) + 1) / ENCODER_HZ
        return Drive.from_samples(time, {JOINT: self.angle(time)})

    def carried(self) -> dict[str, CarriedPayload]:
        """The record's table of payloads."""
        return {} if self.payload is None else {PAYLOAD: CarriedPayload(mass=self.payload)}

    def carrying(self, arm: Arm) -> Arm:
        """The arm with the payload of this run."""
        return Record(signals=(), payloads=self.carried()).applied_to(arm)

    def sensors(self) -> list[Sensor]:
        """Encoder, three reflectors and the motor's torque, without noise."""
        seen = [
            Sensor(
                name=name, quantity="position", point=name, frame=TRACKER, clock=TRACKER, rate_hz=self.rate_hz
            )
            for name in ("tip", "mid", "hub")
        ]
        torque = Sensor(
            name="torque", quantity="motor_torque", joint=JOINT, side="output", rate_hz=self.rate_hz
        )
        encoder = Sensor(name=ENCODER, quantity="joint_angle", joint=JOINT, rate_hz=ENCODER_HZ)
        return [encoder, *seen, torque]


ENCODER_HZ = 250.0


def slow(time: Floats) -> Floats:
    """Once from one side to the other and back, in 60 s."""
    return -SWING * np.cos(2 * np.pi * time / 60.0)


def faster(time: Floats) -> Floats:
    """Minimum-jerk moves from stop to stop, eq. (1)."""
    when, where = np.transpose(STOPS)
    i = np.clip(np.searchsorted(when, time, side="right") - 1, 0, len(when) - 2)
    s = (time - when[i]) / (when[i + 1] - when[i])
    return where[i] + (where[i + 1] - where[i]) * s**3 * (10 - 15 * s + 6 * s**2)  # eq. (1)


SLOW = Experiment("slow sine", slow, 60.0, 5e-3, 10.0)
SLOW_LIGHT = Experiment("slow sine, second payload", slow, 60.0, 5e-3, 10.0, LIGHT)
FAST = Experiment("faster motion", faster, 20.0, 2e-3, 50.0)
FAST_LIGHT = Experiment("faster motion, second payload", faster, 20.0, 2e-3, 50.0, LIGHT)
EXPERIMENTS = (SLOW, SLOW_LIGHT, FAST, FAST_LIGHT)

Setup = dict[Experiment, tuple[str, ...]]
"""Which sensors are looked at in which runs."""
POOR: Setup = {SLOW: ("tip",)}
MENU: dict[str, Setup] = {
    "hub reflector": {SLOW: ("tip", "hub")},
    "mid-span reflector": {SLOW: ("tip", "mid")},
    "motor torque": {SLOW: ("tip", "torque")},
    "second payload": {SLOW: ("tip",), SLOW_LIGHT: ("tip",)},
    "faster motion": {SLOW: ("tip",), FAST: ("tip",)},
}
"""What may be added to the poor set-up."""
RICH: Setup = {FAST: ("tip", "mid", "hub", "torque"), FAST_LIGHT: ("tip", "mid", "hub", "torque")}


@cache
def paper_arm() -> Arm:
    """The paper's arm with reflectors at hub, mid-span and tip."""
    arm = mockup.model()
    return arm.replace(points=(*arm.points, Point(name="mid", link=LINK, position=(0.0, 0.0, 1.5))))
