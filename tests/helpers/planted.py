"""Records that show what a model predicts plus a gap of known structure, beside its simulation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from arms import arm, beam, compliance, crane, drive, hinge, point, smooth_step
from numpy.typing import NDArray

import flexarm
from flexarm.comparison.aligned_record import AlignedRecord, simulate_record
from flexarm.measurement import predict
from flexarm.record import Record, Signal

Floats = NDArray[np.float64]

NOISE = {"position": 4e-5, "motor_torque": 0.5}
END, RATIO = 36.0, 30.0


@dataclass(frozen=True, eq=False)
class Run:
    """A model's run and the instants of its sensors."""

    simulation: flexarm.Simulation
    record: Record

    def showing(self, gaps: dict[str, Callable[[Floats], Floats]], seed: int | None = 0) -> AlignedRecord:
        """The record with gaps, functions of time that give (n, channels), and noise unless seed is None."""
        rng = np.random.default_rng(seed)
        signals = []
        for signal in self.record.signals.values():
            values = signal.values
            if signal.name in gaps:
                values = values + gaps[signal.name](signal.time).reshape(values.shape)
            if signal.name not in self.record.drive and seed is not None:
                values = values + signal.noise_std * rng.standard_normal(values.shape)
            signals.append(signal.replace(values=values))
        shown = self.record.replace(signals=signals)
        return simulate_record(self.simulation.arm, shown, align=False, simulation=self.simulation)

    def state(self, name: str, t: Floats, joint: int = 0) -> Floats:
        """An array of the simulation at times."""
        return np.interp(t, self.simulation.time, getattr(self.simulation, name)[:, joint])


def one_joint() -> flexarm.Arm:
    """A tube of 3 m on a hinge with a spring, upright at 0; its first mode is near 2.4 Hz."""
    return crane(
        name="one joint",
        joints=[hinge("hinge", "rod", gear_ratio=RATIO)],
        effects=[compliance("hinge", 1.2e5, 240.0)],
    )


def two_joints() -> flexarm.Arm:
    """A waist about z under an elbow about y, rigid in all but its beams."""
    tube = {"shape": "tube", "outer_diameter": 0.08, "thickness": 4e-3}
    return arm(
        name="two joints",
        gravity=[0, 0, -9.81],
        joints=[
            hinge("shoulder", "upper", gear_ratio=RATIO),
            hinge("elbow", "fore", "upper", at="end", gear_ratio=RATIO),
        ],
        links=[
            beam("upper", [0, 0, 1.5], tube, elements=2, damping_ratio=0.02),
            beam("fore", [0, 0, 1.2], tube, elements=2, damping_ratio=0.02),
        ],
        payloads=[{"name": "load", "link": "fore", "position": [0, 0, 1.2], "mass": 8.0}],
        points=[point("tip", "fore", [0, 0, 1.2]), point("middle", "upper", [0, 0, 1.5])],
    )


def swing(amplitude: float, period: float, delay: float = 2.0) -> Callable[[Floats], Floats]:
    """A sine that starts softly after `delay` [s] of rest; a second one makes no two swings alike."""

    def angle(t: Floats) -> Floats:
        x = np.maximum(t - delay, 0.0)
        waves = np.sin(2 * np.pi * x / period) + 0.4 * np.sin(2 * np.pi * x * 1.618 / period)
        return amplitude * waves * smooth_step(x / 3)

    return angle


@cache
def run_of(which: str, rate: float = 10.0, seed: int = 1) -> Run:
    """A run of "one joint" or "two joints", seen with some drop-outs at `rate` [Hz], torque at 50 Hz."""
    model = {"one joint": one_joint, "two joints": two_joints}[which]()
    moves = {"hinge": swing(0.8, 9.0), "shoulder": swing(0.5, 11.0), "elbow": swing(0.7, 7.0, 1.0)}
    joints = [joint.name for joint in model.moving_joints]
    driven = drive({name: moves[name] for name in joints}, END)
    simulation = flexarm.simulate(model, driven, step=4e-3)
    rng = np.random.default_rng(seed)
    seen = np.arange(0.13, END, 1 / rate)
    seen = seen[rng.random(len(seen)) > 0.02]
    fast = np.arange(0, END, 0.02)
    signals = [
        Signal(
            name=f"{name} encoder",
            quantity="joint_angle",
            joint=name,
            side="motor",
            time=fast,
            values=moves[name](fast),
            noise_std=0.0,
        )
        for name in joints
    ]
    for name in joints:
        signals.append(
            _predicted(simulation, f"{name} torque", "motor_torque", fast, joint=name, side="output")
        )
    for each in model.points:
        axes = ("x", "z")
        signals.append(_predicted(simulation, each.name, "position", seen, point=each.name, axes=axes))
    drives = tuple(f"{name} encoder" for name in joints)
    return Run(simulation, Record(signals=signals, drive=drives))


def _predicted(
    simulation: flexarm.Simulation, name: str, quantity: str, time: Floats, **place: object
) -> Signal:
    channels = 2 if quantity == "position" else 1
    empty = Signal(
        name=name,
        quantity=quantity,
        time=time,
        values=np.zeros((len(time), channels)),
        noise_std=NOISE[quantity],
        **place,
    )
    return empty.replace(values=predict(simulation, empty))
