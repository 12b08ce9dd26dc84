"""Records of a hinge with a windup that no effect of the vocabulary has, and their nominal problem."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache

import numpy as np
from arms import compliance, crane, hinge
from numpy.typing import NDArray
from planted import swing

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.problem import Problem
from flexarm.missing_law.windup import TimeBasis, added
from flexarm.record import Clock, Frame, Record

Floats = NDArray[np.float64]
Windup = Callable[[Floats, Mapping[str, Floats]], Floats]
"""Windup [rad] from time [s] and the states angle, rate and torque."""
STIFFNESS, NOISE, END = 1.2e5, 4e-5, 20.0
DAMPING = 3e3
"""So much that the fixed point converges at the first mode too [N m s/rad]."""
KNOTS = 400
ROUNDS = 12
STEP = 4e-3


def nominal() -> flexarm.Arm:
    """A tube of 3 m on a hinge with a spring, upright at 0; its first mode is near 2.4 Hz."""
    return crane(
        name="one joint",
        joints=[hinge("hinge", "rod", gear_ratio=30.0)],
        effects=[compliance("hinge", STIFFNESS, DAMPING)],
        uncertainty={"links.rod.material.youngs_modulus": 1e-4},
    )


ENCODER = {"quantity": "joint_angle", "joint": "hinge", "side": "motor", "rate_hz": 50, "noise_std": 1e-6}
TRACKER = {"quantity": "position", "point": "tip", "axes": ["x", "z"], "rate_hz": 10, "noise_std": NOISE}
SENSORS = [
    Sensor(name="hinge", clock="controller", **ENCODER),
    Sensor(name="tip", clock="tracker", frame="tracker", **TRACKER),
]


def record(windup: Windup, seed: int, amplitude: float, period: float, end: float = END) -> Record:
    """What sensors show of a swing with a windup, which a fixed point makes a function of its states.

    The windup is put into the drive, with splines twice as fine as those that are inferred.
    """
    t = np.arange(0, end + 0.005, 0.01)
    plain = flexarm.Drive.from_samples(t, {"hinge": swing(amplitude, period, 0.5)(t)})
    basis = TimeBasis(np.concatenate([[0.0] * 3, np.linspace(0, end, KNOTS + 1), [end] * 3]))
    run = flexarm.simulate(nominal(), plain, step=STEP)
    for _ in range(ROUNDS):
        states = {
            key: np.interp(basis.places, run.time, getattr(run, f"joint_{key}")[:, 0])
            for key in ("angle", "rate", "torque")
        }
        extra = basis.polynomial(basis.interpolating(windup(basis.places, states)))
        drive = flexarm.Drive({"hinge": added(plain.joints["hinge"], extra)}, {}, 0.0, end)
        run = flexarm.simulate(nominal(), drive, step=STEP)
    shown = flexarm.measure(
        run,
        SENSORS,
        np.random.default_rng(seed),
        drive=["hinge"],
        clocks={"controller": Clock(), "tracker": Clock(sigma=2e-5)},
        frames={"tracker": Frame(translation=2e-4, rotation=1e-5)},
    )
    encoder = shown.signals["hinge"]
    readings = plain.joints["hinge"](encoder.time)
    signals = {**shown.signals, "hinge": encoder.replace(values=readings[:, None])}
    return shown.replace(signals=signals, drive=("hinge",))


@cache
def problem_of(windup: Windup, seed: int = 0) -> tuple[Problem, Estimator]:
    """Two records of 20 s with a windup, and the nominal model about them."""
    records = {
        "slow": record(windup, 2 * seed, 0.8, 9.0),
        "fast": record(windup, 2 * seed + 1, 0.6, 5.5),
    }
    problem = Problem(nominal(), records, step=STEP, jobs=1)
    return problem, Estimator.nominal(problem, nuisance_model(problem))
