"""What the sensors of the laboratory read of a robot's motion, with their own faults, before noise.

reading of an encoder = scale phi + offset + amplitude sin(phi + phase), rounded to a step           (1)
stamp of a tracker = t (1 + rate) + delay                                                            (2)
its reading = R(rotation) p + translation + velocity t + sway sin(2 pi f t)                          (3)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from lab_arms import LabArm
from robot import Robot, Vector
from robot_motion import Motion
from scipy.spatial.transform import Rotation
from serial_chain import Floats

ZERO: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Encoder:
    """Parameters of (1)."""

    scale: float = 1.0
    offset: float = 0.0
    amplitude: float = 0.0
    phase: float = 0.0
    step: float = 0.0

    def read(self, angle: Floats) -> Floats:
        """(1)."""
        read = self.scale * angle + self.offset + self.amplitude * np.sin(angle + self.phase)
        return np.round(read / self.step) * self.step if self.step else read


@dataclass(frozen=True)
class Tracker:
    """Parameters of (2) and (3), SI units; `sway` is in no vocabulary."""

    delay: float = 0.0
    rate: float = 0.0
    translation: Vector = ZERO
    rotation: Vector = ZERO
    velocity: Vector = ZERO
    sway: Vector = ZERO
    sway_hz: float = 0.0

    def stamps(self, t: Floats) -> Floats:
        """(2)."""
        return t * (1 + self.rate) + self.delay

    def read(self, p: Floats, t: Floats) -> Floats:
        """(3)."""
        turned = Rotation.from_rotvec(self.rotation).apply(p) + np.array(self.translation)
        swaying = np.outer(np.sin(2 * np.pi * self.sway_hz * t), self.sway)
        return turned + np.outer(t, self.velocity) + swaying


@dataclass(frozen=True)
class Sensors:
    """Encoders and offset of the torque [N m, motor side] by joint, moved reflectors by point."""

    tracker: Tracker = field(default_factory=Tracker)
    encoders: Mapping[str, Encoder] = field(default_factory=dict)
    torque_offsets: Mapping[str, float] = field(default_factory=dict)
    moved: Mapping[str, Vector] = field(default_factory=dict)

    def encoder(self, joint: str) -> Encoder:
        """A joint's encoder."""
        return self.encoders.get(joint, Encoder())

    def with_encoder(self, joint: str, **changes: float) -> Sensors:
        """The same with another encoder."""
        return replace(self, encoders={**self.encoders, joint: replace(self.encoder(joint), **changes)})

    def with_tracker(self, **changes: object) -> Sensors:
        """The same with another tracker."""
        return replace(self, tracker=replace(self.tracker, **changes))

    def with_moved(self, point: str, way: Vector) -> Sensors:
        """The same with a reflector moved further."""
        there = np.add(self.moved.get(point, ZERO), way)
        return replace(self, moved={**self.moved, point: tuple(float(x) for x in there)})


@dataclass(frozen=True)
class Truth:
    """What is so in the laboratory, and what the model holds beside tubes and soft joints.

    Attributes
    ----------
    rigid
        Joints that the model takes to be rigid.
    known
        Further effects that the model has, as tables.
    """

    arm: LabArm
    robot: Robot
    sensors: Sensors = field(default_factory=Sensors)
    rigid: tuple[str, ...] = ()
    known: tuple[dict, ...] = ()


AXES = {"x": 0, "y": 1, "z": 2}


def tracked(truth: Truth, run: Motion, rows: Floats, point: str) -> Floats:
    """What the tracker reads of a point at rows of the motion, without noise; one column an axis."""
    reflector = truth.arm.reflectors[point]
    offset = tuple(np.add(reflector.offset, truth.sensors.moved.get(point, ZERO)))
    p = run.place(reflector.link, reflector.fraction, offset)[rows]
    return truth.sensors.tracker.read(p, run.time[rows])[:, [AXES[axis] for axis in truth.arm.axes]]


def motor_torques(truth: Truth, run: Motion, rows: Floats) -> dict[str, Floats]:
    """Torques at the motors' shafts by joint, without noise."""
    return {
        joint.name: run.motor_torque[rows, j] / joint.ratio
        + truth.sensors.torque_offsets.get(joint.name, 0.0)
        for j, joint in enumerate(truth.arm.joints)
    }
