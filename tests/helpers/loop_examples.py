"""The examples with closed loops in motion: what each hides, and virtual records of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from arms import smooth_step

import flexarm
from flexarm.effects import CableTorque, CoulombFriction

EXAMPLES = Path(__file__).parents[2] / "examples"


@dataclass(frozen=True)
class Example:
    """An example, a motion of it and what one machine of its kind hides."""

    model: str
    """Its file in `examples`."""
    motion: Mapping[str, Callable[[np.ndarray], np.ndarray]]
    """Of the joints that are driven, of time over the length of the motion, from 0 to 1."""
    hidden: Callable[[flexarm.Arm], flexarm.Effect]
    """The effect that the machine has, and the model has not or otherwise."""
    free: Mapping[str, float] = field(default_factory=dict)
    """Joints that are let go at rest, and where."""
    seconds: float = 6.0
    step: float = 4e-3
    """Time step of the diagnosis [s]."""

    @property
    def arm(self) -> flexarm.Arm:
        """The model as the file has it."""
        return flexarm.Arm.from_toml(EXAMPLES / self.model)

    @property
    def machine(self) -> flexarm.Arm:
        """The model with what is hidden."""
        return self.arm.with_effect(self.hidden(self.arm))

    def record(self, arm: flexarm.Arm, seed: int, pace: float = 1.0, step: float = 1e-3) -> flexarm.Record:
        """Return what the sensors see of an arm; motions at another pace are of the same length."""
        time = np.linspace(0, self.seconds, 601)
        path = {name: motion(pace * time / self.seconds) for name, motion in self.motion.items()}
        drive = flexarm.Drive.from_samples(time, path)
        free = flexarm.Drive.from_samples(time, dict.fromkeys(self.free, 0 * time), side="torque")
        rest = {name: values[0] for name, values in path.items()} | dict(self.free)
        told = flexarm.Drive({**drive.joints, **free.joints}, rest, 0.0, self.seconds)
        run = flexarm.simulate(arm, told, step=step)
        drives = [s.name for s in arm.sensors if s.quantity == "joint_angle"]
        return flexarm.measure(run, arm.sensors, np.random.default_rng(seed), drive=drives, joints={})

    def diagnosed(self) -> flexarm.Diagnosis:
        """Diagnose the model from one motion of the machine, with a quicker one held out."""
        slow, quick = self.record(self.machine, 5), self.record(self.machine, 6, pace=1.5)
        return flexarm.diagnose(self.arm, {"slow": slow}, hold_out=quick, laws=False, step=self.step)


def to_and_fro(start: float, way: float, turns: float = 1.0) -> Callable[[np.ndarray], np.ndarray]:
    """Return a motion from `start` by a `way` and back, `turns` times."""
    return lambda s: start + way * np.sin(np.pi * turns * smooth_step(s)) ** 2


def aired(place: str, part: float) -> Callable[[flexarm.Arm], flexarm.Effect]:
    """Return the oil column of a place with a part of the bulk modulus that the model states."""

    def found(arm: flexarm.Arm) -> flexarm.Effect:
        oil = arm.effect("oil_column", place)
        assert oil is not None
        return oil.with_parameters({"bulk_modulus": part * oil.value_of("bulk_modulus")})

    return found


EXAMPLES_IN_MOTION = {
    "telescopic crane": Example(
        "telescopic_crane.toml",
        {
            "piston": to_and_fro(0.3, 0.15),
            "extension": to_and_fro(0.8, 0.3),
            "hoist": to_and_fro(2.0, -0.3),
        },
        aired("piston", 0.5),
        free={"swing": -0.1},
        seconds=3.0,
        step=8e-3,
    ),
    "excavator": Example(
        "excavator/excavator.toml",
        {"boom_piston": to_and_fro(0.45, 0.2), "stick_piston": to_and_fro(0.9, -0.3, 2.0)},
        lambda arm: CoulombFriction(at="stick_pin", torque=3000.0),
        seconds=4.0,
    ),
    "parallelogram": Example(
        "parallelogram.toml",
        {"shoulder": to_and_fro(-0.3, 0.9, 2.0)},
        lambda arm: CableTorque(at="shoulder", stiffness=42.0, rest_angle=2.5),
    ),
}
