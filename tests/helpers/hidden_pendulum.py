r"""Records of a rigid arm on a hinge with a cause of its own, integrated apart from flexarm.

.. math:: I \ddot\theta = T + m g \ell \sin\theta - f, \qquad
          T = T_s(t, \varphi + w - \theta) + c (\dot\varphi - \dot\theta)                              (1)
.. math:: \dot z = (1 - z\,\mathrm{sgn}\,\dot\theta)\,\dot\theta/\delta                                (2)

theta is the angle of the link from upright, phi that of the motor over the ratio. T_s, w and f hide what no
nominal model has: functions of time, of the state, and of the memory z. The classical Runge-Kutta method
integrates (1) and (2) in steps of 1 ms; a mode of 3.6 Hz errs by 1e-8 of its size.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import sin

import numpy as np
from arms import arm, compliance, hinge, point, rigid
from numpy.typing import NDArray
from planted import swing

import flexarm
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.verification import SplitRecords
from flexarm.missing_law.policy import LawPolicy
from flexarm.missing_law.prediction import LawCheck
from flexarm.missing_law.search import MissingLaws, missing_laws
from flexarm.record import Clock, Frame, Record, Signal

Floats = NDArray[np.float64]

LINK, LOAD, LENGTH, LINK_INERTIA = 35.0, 14.1, 3.0, 26.0
STIFFNESS, DAMPING, RATIO = 1.2e5, 240.0, 30.0
INERTIA = LINK_INERTIA + LINK * LENGTH**2 / 4 + LOAD * LENGTH**2
WEIGHT = 9.81 * LENGTH * (LINK / 2 + LOAD)
"""m g l [N m]."""
NOISE, STEP, END = 4e-5, 1e-3, 20.0
CLOCK, MASS = 1e-3, 0.01
"""1 sigma of the tracker's clock [s] and of the load's mass [-]."""


@dataclass(frozen=True)
class Cause:
    """What a record hides: T_s, w and f of (1).

    Attributes
    ----------
    spring : callable
        T_s [N m] of time and deflection.
    windup : callable
        w [rad] of time, angle, rate and the angle of the motor over the ratio.
    lost : callable
        f [N m] of time, angle, rate and z.
    width : float
        delta of (2) [rad].
    """

    spring: Callable[[float, float], float] = lambda t, d: STIFFNESS * d
    windup: Callable[[float, float, float, float], float] = lambda t, angle, rate, motor: 0.0
    lost: Callable[[float, float, float, float], float] = lambda t, angle, rate, z: 0.0
    width: float = 5e-3


def nominal() -> flexarm.Arm:
    """A rigid link of 3 m on a hinge with a spring, upright at 0."""
    return arm(
        name="pendulum",
        gravity=[0, 0, -9.81],
        joints=[hinge("hinge", "rod", gear_ratio=RATIO)],
        links=[rigid("rod", LINK, [0, 0, LENGTH / 2], [LINK_INERTIA] * 2 + [0.1])],
        payloads=[{"name": "load", "link": "rod", "position": [0, 0, LENGTH], "mass": LOAD}],
        points=[point("tip", "rod", [0, 0, LENGTH])],
        effects=[compliance("hinge", STIFFNESS, DAMPING)],
        uncertainty={"payloads.load.mass": MASS},
    )


@dataclass(frozen=True, eq=False)
class Study:
    """Two records with a cause, a third one that is held out, and the nominal model about the first two."""

    records: dict[str, Record]
    other: Record
    estimator: Estimator
    delay: float
    load: float

    @classmethod
    def of(cls, cause: Cause, seed: int, noise_alone: bool = False) -> Study:
        """Draw clock and load from what is stated of them, unless only the noise is drawn."""
        rng = np.random.default_rng(seed)
        delay, more = np.array([CLOCK, MASS]) * rng.standard_normal(2) * (not noise_alone)
        about = {"delay": float(delay), "load": float(LOAD * (1 + more))}
        records = {
            "slow": record(cause, rng, 0.8, 9.0, **about),
            "fast": record(cause, rng, 0.6, 5.5, **about),
        }
        other = record(cause, rng, 0.7, 7.0, **about)
        problem = Problem(nominal(), records, step=4e-3, jobs=1)
        return cls(records, other, Estimator.nominal(problem, nuisance_model(problem)), **about)

    def check(self) -> LawCheck:
        """Return what laws are checked with."""
        records = SplitRecords(self.records, {"other": self.other}, 2e-3, -0.05, 1)
        return LawCheck(records, nominal(), nominal(), "tip")

    def laws(self, policy: LawPolicy | None = None) -> MissingLaws:
        """Infer what is missing."""
        return missing_laws(self.estimator, [self.estimator.fit(())], self.check(), policy)


def motion(cause: Cause, phi: Callable[[Floats], Floats], end: float, load: float = LOAD) -> Floats:
    """Integrate (1), (2) from equilibrium; return theta every millisecond."""
    n = round(end / STEP)
    grid = np.arange(2 * n + 1) * STEP / 2
    angle = phi(grid)
    rate_of_motor = np.gradient(angle, grid, edge_order=2).tolist()
    motor = angle.tolist()
    inertia = INERTIA + (load - LOAD) * LENGTH**2
    weight = WEIGHT + 9.81 * LENGTH * (load - LOAD)

    def slopes(j: int, x: tuple[float, float, float]) -> tuple[float, float, float]:
        t, (theta, rate, z) = j * STEP / 2, x
        d = motor[j] + cause.windup(t, theta, rate, motor[j]) - theta
        torque = cause.spring(t, d) + DAMPING * (rate_of_motor[j] - rate)
        torque += weight * sin(theta) - cause.lost(t, theta, rate, z)
        return rate, torque / inertia, (rate - z * abs(rate)) / cause.width  # eqs. (1), (2)

    def ahead(x: tuple[float, ...], k: tuple[float, ...], h: float) -> tuple[float, float, float]:
        return (x[0] + h * k[0], x[1] + h * k[1], x[2] + h * k[2])

    x = (_rest(slopes, motor[0]), 0.0, 0.0)
    found = [x[0]]
    for j in range(0, 2 * n, 2):
        a = slopes(j, x)
        b = slopes(j + 1, ahead(x, a, STEP / 2))
        c = slopes(j + 1, ahead(x, b, STEP / 2))
        d = slopes(j + 2, ahead(x, c, STEP))
        mean = tuple((p + 2 * q + 2 * r + s) / 6 for p, q, r, s in zip(a, b, c, d, strict=True))
        x = ahead(x, mean, STEP)
        found.append(x[0])
    return np.array(found)


def _rest(slopes: Callable, theta: float) -> float:
    """Return the angle of equilibrium, by Newton's method on a difference quotient."""
    for _ in range(20):
        here, there = (slopes(0, (theta + e, 0.0, 0.0))[1] for e in (0.0, 1e-7))
        theta -= here * 1e-7 / (there - here)
    return theta


def record(
    cause: Cause,
    rng: np.random.Generator,
    amplitude: float = 0.8,
    period: float = 9.0,
    *,
    delay: float = 0.0,
    load: float = LOAD,
    end: float = END,
) -> Record:
    """What an encoder of the motor and a tracker of the tip show, stamped late by a delay."""
    phi = swing(amplitude, period, 0.5)
    theta = motion(cause, phi, end, load)
    readings, stamps = np.arange(0, end + 0.01, 0.02), np.arange(0.0, end - 0.05, 0.1)
    seen = np.interp(stamps, np.arange(len(theta)) * STEP, theta)
    tip = LENGTH * np.column_stack([np.sin(seen), np.cos(seen)])
    encoder = phi(readings)[:, None] + 1e-6 * rng.standard_normal((len(readings), 1))
    sensors = [
        Signal(
            name="hinge",
            quantity="joint_angle",
            joint="hinge",
            side="motor",
            time=readings,
            values=encoder,
            noise_std=1e-6,
            clock="controller",
            unit="rad",
        ),
        Signal(
            name="tip",
            quantity="position",
            point="tip",
            axes=("x", "z"),
            time=stamps + delay,
            values=tip + NOISE * rng.standard_normal(tip.shape),
            noise_std=NOISE,
            clock="tracker",
            frame="tracker",
            unit="m",
        ),
    ]
    return Record(
        signals=sensors,
        drive=("hinge",),
        clocks={"controller": Clock(), "tracker": Clock(sigma=CLOCK)},
        frames={"tracker": Frame(translation=2e-4, rotation=1e-5)},
    )
