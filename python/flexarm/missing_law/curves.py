"""Latent motions and laws as data: curves with their bands and a sentence each."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexarm.arrays import Floats
from flexarm.law_curve import LawCurve
from flexarm.missing_law.latent import Latent
from flexarm.missing_law.law import Law, LawSearch
from flexarm.missing_law.policy import LawPolicy
from flexarm.missing_law.refit import FittedLaw
from flexarm.missing_law.shapes import closest_shape
from flexarm.named_effects import NORMAL_90
from flexarm.wording import with_unit

OF_UNITS = {"torque": "N m", "angle": "rad", "rate": "rad/s", "motor_angle": "rad"}
"""Units of the states of a revolute joint."""
HAS = {"windup": "the windup of", "torque": "a torque lost at"}
"""How a sentence begins."""


def curve_in_time(latent: Latent, probability: float) -> LawCurve:
    """Return a latent motion of the first record, against time or the number of the pose."""
    basis = latent.bases[0]
    m = len(basis)
    at = basis.at(basis.places)
    value = at @ latent.mean[:m]
    band = NORMAL_90 * np.linalg.norm(at @ latent.root[:m], axis=1)
    return LawCurve(
        latent.at,
        latent.quantity,
        basis.of,
        latent.unit,
        basis.of_unit,
        x=_numbers(basis.places),
        value=_numbers(value),
        low90=_numbers(value - band),
        high90=_numbers(value + band),
        kind="time",
        instant_s=None,
        probability=probability,
        says=f"the {latent.quantity} of {latent.at} is a function of {basis.of} only",
    )


def _numbers(values: Floats) -> tuple[float, ...]:
    return tuple(float(each) for each in values)


def curve_of_law(latent: Latent, search: LawSearch, law: Law, policy: LawPolicy) -> LawCurve:
    """Return a law about the latent motion as data; its probability is 1."""
    x, unit, of_unit = law.knots, latent.unit, OF_UNITS[law.of]
    curves = [law.curve(k) for k in range(len(law.mean) // len(x))]
    shown = curves[-1:] if law.kind == "change" else curves
    xs = x if len(shown) == 1 else np.concatenate([x, x[::-1]])
    mean = np.concatenate([value[:: 1 - 2 * k] for k, (value, _) in enumerate(shown)])
    spread = np.concatenate([np.sqrt(np.diag(c))[:: 1 - 2 * k] for k, (_, c) in enumerate(shown)])
    value, covariance = shown[0]
    shape = closest_shape(x, value, covariance, policy.shape_error, unit, law.of, of_unit)
    says = _sentence("windup", latent.at, law.of, shape)
    if law.kind == "law with memory":
        says += ", with another branch where the angle falls"
    if law.kind == "change":
        at, low, high = law.instant
        says += f", from {at:.2f} s on (90 %: {low:.2f} to {high:.2f} s)"
        says += _softening(latent, law)
    return LawCurve(
        latent.at,
        latent.quantity,
        law.of,
        unit,
        of_unit,
        x=_numbers(xs),
        value=_numbers(mean),
        low90=_numbers(mean - NORMAL_90 * spread),
        high90=_numbers(mean + NORMAL_90 * spread),
        kind=law.kind,
        instant_s=law.instant[0] if law.instant else None,
        probability=1.0,
        says=f"{says}; it spans {with_unit(float(np.ptp(mean)), unit, 3)}",
        cloud_x=_numbers(search.states.values[law.of]),
        cloud_value=_numbers(search.motion()),
        instant90=law.instant[1:],
    )


def curve_of_fit(curve: LawCurve, fitted: FittedLaw, policy: LawPolicy) -> LawCurve:
    """Return a curve, of the same quantity, with the values that were fitted through the simulation."""
    law = fitted.law
    x, value = np.array(law.x), np.array(law.value)
    covariance = fitted.root @ fitted.root.T
    shape = closest_shape(x, value, covariance, policy.shape_error, curve.unit, law.of, curve.of_unit)
    band = NORMAL_90 * np.sqrt(np.diag(covariance))
    says = _sentence(law.quantity, law.at, law.of, shape)
    return replace(
        curve,
        value=law.value,
        low90=_numbers(value - band),
        high90=_numbers(value + band),
        says=f"{says}; it spans {with_unit(float(np.ptp(value)), curve.unit, 3)}",
    )


def _sentence(quantity: str, at: str, of: str, shape: str) -> str:
    return f"{HAS[quantity]} {at} as a function of {of.replace('_', ' ')} {shape}"


def as_torque(law: LawCurve, stiffness: float) -> LawCurve:
    """Return the torque that the joint loses in place of a windup, f = -k w."""

    def times(values: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(-stiffness * each for each in values)

    says = law.says.split("; it spans")[0].replace(HAS["windup"], HAS["torque"])
    return replace(
        law,
        quantity="torque",
        unit="N m",
        value=times(law.value),
        low90=times(law.high90),
        high90=times(law.low90),
        cloud_value=times(law.cloud_value),
        says=f"{says.split(': ')[0]}; it spans {with_unit(stiffness * float(np.ptp(law.value)), 'N m', 3)}",
    )


def _slope(law: Law) -> tuple[float, float]:
    """Return the slope of the second curve over the first one, and its deviation."""
    k = len(law.knots)
    line = np.linalg.pinv(np.column_stack([np.ones(k), law.knots]))[1]
    weights = np.concatenate([-line, line])
    return float(weights @ law.mean), float(np.linalg.norm(weights @ law.root))


def _softening(latent: Latent, law: Law) -> str:
    """Return how much softer the joint is after an instant, where the law is one of torque."""
    stiffness = stiffness_of(latent)
    if law.of != "torque" or not stiffness:
        return ""
    slope, std = _slope(law)
    part = 1 - 1 / (1 - stiffness * slope)  # 1/k' = 1/k - slope
    error = stiffness * std / (1 - stiffness * slope) ** 2
    word = "softer" if part > 0 else "stiffer"
    return f": there it is {100 * abs(part):.0f} ± {max(100 * error, 1):.0f} % {word}"


def stiffness_of(latent: Latent) -> float:
    """Return the torque over the deflection of a joint along its run [N m/rad]; 0 of a rigid one."""
    assert latent.response is not None
    response = latent.response
    name = next(iter(response.bases))
    run = response.problem.simulations.run(name, response.arm).simulation
    k = [each.name for each in run.arm.moving_joints].index(latent.at)
    deflection = run.drive_angle[:, k] - run.joint_angle[:, k]
    square = float(deflection @ deflection)
    return float(run.joint_torque[:, k] @ deflection) / square if square > 0 else 0.0
