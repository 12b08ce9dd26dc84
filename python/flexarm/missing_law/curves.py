"""Latent motions and laws as data: curves with their bands and a sentence each."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexarm.arm.joint_units import units_by_joint
from flexarm.arrays import Floats
from flexarm.law_curve import LawCurve
from flexarm.missing_law.latent import Latent
from flexarm.missing_law.law import Law, LawSearch
from flexarm.missing_law.policy import LawPolicy
from flexarm.missing_law.refit import FittedLaw
from flexarm.missing_law.shapes import CONSTANT, closest_shape
from flexarm.named_effects import NORMAL_90
from flexarm.wording import with_unit

OF_UNITS = {"torque": "N m", "angle": "rad", "rate": "rad/s", "motor_angle": "rad"}
"""Units of the states of a revolute joint."""
HAS = {"windup": "the windup of {}", "torque": "a torque lost at {}"}
"""How a sentence begins; of others with the quantity."""


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
        says=f"the {latent.quantity} at {latent.at} is a function of {basis.of} only",
    )


def _numbers(values: Floats) -> tuple[float, ...]:
    return tuple(float(each) for each in values)


def curve_of_law(latent: Latent, search: LawSearch, law: Law, policy: LawPolicy) -> LawCurve:
    """Return a law about the latent motion as data; its probability is 1."""
    assert latent.response is not None
    state, _, other = law.of.partition(" of ")
    joint = (other or latent.response.joint,)
    of_unit = OF_UNITS[state]  # the motor turns, whatever it moves
    curve = LawCurve(
        latent.at,
        latent.quantity,
        law.of,
        latent.unit,
        of_unit if law.of == "motor_angle" else units_by_joint(latent.response.arm, joint, of_unit),
        x=(),
        value=(),
        low90=(),
        high90=(),
        kind=law.kind,
        instant_s=None,
        probability=1.0,
        says="",
        cloud_x=_numbers(search.states.values[law.of]),
        cloud_value=_numbers(search.motion()),
    )
    changing = "each record" if law.only < 0 else "one record"
    return _with_branches(
        curve, law.knots, law.mean, law.root, law.instant, stiffness_of(latent), policy, changing
    )


def curve_of_fit(curve: LawCurve, fitted: FittedLaw, stiffness: float, policy: LawPolicy) -> LawCurve:
    """Return a curve, of the same quantity, with the values that were fitted through the simulation.

    `stiffness` is that of the joint [N m/rad].
    """
    law = fitted.law
    instant = next(((each.value, each.low90, each.high90) for each in fitted.instant), ())
    return _with_branches(curve, np.array(law.x), law.values, fitted.root, instant, stiffness, policy)


def _with_branches(
    curve: LawCurve,
    x: Floats,
    mean: Floats,
    root: Floats,
    instant: tuple[float, ...],
    stiffness: float,
    policy: LawPolicy,
    changing: str = "each record",
) -> LawCurve:
    """Return a curve with the values of its branches, one after the other, and its sentence.

    `root` is one of their covariance, `instant` when they change and its 90 % interval [s], and
    `changing` the records in which they do.
    """
    k, spread = len(x), np.linalg.norm(root, axis=1)
    branches = [slice(i, i + k) for i in range(0, len(mean), k)]
    shown = branches[-1:] if curve.kind == "change" else branches
    first = shown[0]
    covariance = root[first] @ root[first].T
    shape = closest_shape(x, mean[first], covariance, policy, curve.unit, curve.of, curve.of_unit)
    says = _sentence(curve, shape)
    if curve.kind == "law with memory":
        says += ", with another branch where the angle falls"
    if instant:
        says += f", from {instant[0]:.2f} s of {changing} on ({instant[1]:.2f} to {instant[2]:.2f} s at 90 %)"
        says += _softening(x, mean, root, stiffness) if curve.of == "torque" and stiffness else ""
    xs = x if len(shown) == 1 else np.concatenate([x, x[::-1]])
    value, band = (
        np.concatenate([each[rows][:: 1 - 2 * i] for i, rows in enumerate(shown)])
        for each in (mean, NORMAL_90 * spread)
    )
    return replace(
        curve,
        x=_numbers(xs),
        value=_numbers(value),
        low90=_numbers(value - band),
        high90=_numbers(value + band),
        instant_s=instant[0] if instant else None,
        instant90=instant[1:],
        says=f"{says}; it spans {_span(value, curve.unit)}",
    )


def _span(value: Floats, unit: str) -> str:
    """Return the span of a curve, with its middle where that is more."""
    low, high = float(np.min(value)), float(np.max(value))
    middle = (low + high) / 2
    about = f" about {with_unit(middle, unit, 3)}" if abs(middle) > high - low else ""
    return with_unit(high - low, unit, 3) + about


def _sentence(curve: LawCurve, shape: str) -> str:
    has = HAS.get(curve.quantity, f"the {curve.quantity} at {{}}").format(curve.at)
    if shape == CONSTANT:
        return f"{has} {shape}"
    return f"{has} as a function of {curve.of.replace('_', ' ')} {shape}"


def as_torque(law: LawCurve, stiffness: float) -> LawCurve:
    """Return the torque that the joint loses in place of a windup, f = -k w."""

    def times(values: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(-stiffness * each for each in values)

    says = law.says.split("; it spans")[0]
    windup, torque = (HAS[each].format(law.at) for each in ("windup", "torque"))
    unit = "N" if law.unit == "m" else "N m"
    says = says.replace(windup, torque)
    return replace(
        law,
        quantity="torque",
        unit=unit,
        value=times(law.value),
        low90=times(law.high90),
        high90=times(law.low90),
        cloud_value=times(law.cloud_value),
        says=f"{says.split(': ')[0]}; it spans {_span(-stiffness * np.asarray(law.value), unit)}",
    )


def _softening(x: Floats, mean: Floats, root: Floats, stiffness: float) -> str:
    """Return how much softer the joint is after an instant, by windups of the torque before and after."""
    line = np.linalg.pinv(np.column_stack([np.ones(len(x)), x]))[1]
    weights = np.concatenate([-line, line])
    slope, std = float(weights @ mean), float(np.linalg.norm(weights @ root))
    part = 1 - 1 / (1 - stiffness * slope)  # 1/k' = 1/k - slope
    error = stiffness * std / (1 - stiffness * slope) ** 2
    word = "softer" if part > 0 else "stiffer"
    return f": there it is {100 * abs(part):.0f} ± {max(100 * error, 1):.0f} % {word}"


def stiffness_of(latent: Latent) -> float:
    """Return the torque over the deflection of a joint along its run [N m/rad]; 0 of others."""
    assert latent.response is not None
    if latent.slow:
        return 0.0
    response = latent.response
    name = next(iter(response.bases))
    run = response.problem.simulations.run(name, response.arm).simulation
    k = [each.name for each in run.arm.moving_joints].index(latent.at)
    deflection = run.drive_angle[:, k] - run.joint_angle[:, k]
    square = float(deflection @ deflection)
    return float(run.joint_torque[:, k] @ deflection) / square if square > 0 else 0.0
