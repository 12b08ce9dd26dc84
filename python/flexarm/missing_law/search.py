"""Missing laws of an unexplained diagnosis: where a motion is missing, of what it is a function, its gap."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Floats
from flexarm.budget import allows
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.problem import Problem
from flexarm.law_curve import LawCurve, LawKind
from flexarm.missing_law.latent import Latent, latent_motions
from flexarm.missing_law.law import Law, LawSearch
from flexarm.missing_law.policy import LawPolicy
from flexarm.missing_law.prediction import gaps_with_law
from flexarm.missing_law.shapes import closest_shape
from flexarm.missing_law.states import joint_states
from flexarm.wording import with_unit

if TYPE_CHECKING:
    from flexarm.record import Record

OF_UNITS = {"torque": "N m", "angle": "rad", "rate": "rad/s", "motor_angle": "rad", "time": "s"}
"""Units of the states of a revolute joint."""
NORMAL90 = 1.645
"""Deviations of a normal distribution in half of its 90 % interval."""


def missing_laws(
    problem: Problem,
    fits: Sequence[Fit],
    held_out: Mapping[str, Record],
    signal: str,
    policy: LawPolicy | None = None,
) -> tuple[LawCurve, ...]:
    """Return the laws that explain what a fitted model leaves, the most probable first.

    The first model that a function of a state completes is taken, or the last one.

    Parameters
    ----------
    problem : Problem
        Records of motions along drives; of others nothing is inferred.
    fits : sequence of Fit
        Models that leave a gap, the simplest first.
    held_out : dict of str to Record
        What the law is checked with.
    signal : str
        Whose gap is told.
    policy : LawPolicy, optional
        Settings.

    Returns
    -------
    tuple of LawCurve
        Empty if no latent motion is more likely than none by `policy.evidence`.
    """
    found: tuple[LawCurve, ...] = ()
    for fit in fits:
        found = _about(problem, fit, held_out, signal, policy or LawPolicy())
        if any(each.kind not in ("time", "none") for each in found):
            break
    return found


def _about(
    problem: Problem, fit: Fit, held_out: Mapping[str, Record], signal: str, policy: LawPolicy
) -> tuple[LawCurve, ...]:
    """Return the laws about one model."""
    if not _applies(problem, fit):
        return ()
    found = []
    for latent in latent_motions(problem, fit, policy):
        found.append(latent)
        if not allows("all places of a missing law were tried"):
            break
    known = [each for each in found if each.gain > policy.evidence]
    if not known:
        return ()
    best = max(each.model.log_evidence for each in known)
    near = [each for each in known if each.model.log_evidence > best - problem.policy.reach]
    near.sort(key=lambda each: -each.model.log_evidence)
    weight = np.array([np.exp(each.model.log_evidence - best) for each in near])
    weight = np.minimum(weight / weight.sum(), problem.policy.most_certain)
    laws: list[LawCurve] = []
    for latent, probability in zip(near, weight.tolist(), strict=True):
        laws += _of_place(latent, probability, problem, fit, held_out, signal, policy)
    return tuple(laws[: policy.most_laws])


def _applies(problem: Problem, fit: Fit) -> bool:
    """Return True if all records are motions along angles of motors."""
    from flexarm.comparison.free_vibration import rings_freely

    records = problem.records.values()
    if any(record.kind != "motion" or rings_freely(record) for record in records):
        return False
    arm = fit.nuisance.arm
    drives = (problem.simulations.drive(name, arm) for name in problem.records)
    return all(joint.side == "motor" for drive in drives for joint in drive.joints.values())


def _of_place(
    latent: Latent,
    probability: float,
    problem: Problem,
    fit: Fit,
    held_out: Mapping[str, Record],
    signal: str,
    policy: LawPolicy,
) -> list[LawCurve]:
    """Return the laws of a place: the best state's, and a torque that acts as its windup does."""
    in_time = _in_time(latent, probability)
    if latent.response is None:
        return [in_time]
    search = LawSearch(latent, joint_states(latent), problem, fit, policy)
    best = search.best()[0]
    in_blocks = latent.model.predictive(search.blocks)
    share = search.share(best)
    if share < policy.least_share or best.predictive < in_blocks - policy.evidence:
        slow = latent.length >= max(policy.lengths)
        kind: LawKind = "time" if slow and in_blocks > best.predictive else "none"
        what = "drifts with time" if kind == "time" else f"follows no state: {best.of} explains {share:.0%}"
        return [replace(in_time, kind=kind, says=f"the windup of {latent.at} {what}")]
    told = _curve(latent, search, best, probability, policy)
    train, held = gaps_with_law(latent, best, problem, held_out, signal)
    told = replace(told, train=train, held_out=held)
    stiffness = _stiffness(latent)
    if best.of == "torque" or not stiffness:
        return [told]
    told = replace(told, probability=told.probability / 2)
    return [_as_torque(told, stiffness), told]


def _in_time(latent: Latent, probability: float) -> LawCurve:
    """Return a latent motion of the first record, against time."""
    time, value, deviation = _motion(latent)
    says = f"the {latent.quantity} of {latent.at} is a function of time only"
    band = NORMAL90 * deviation
    return LawCurve(
        latent.at,
        latent.quantity,
        "time",
        latent.unit,
        OF_UNITS["time"],
        x=_numbers(time),
        value=_numbers(value),
        low90=_numbers(value - band),
        high90=_numbers(value + band),
        kind="time",
        instant_s=None,
        probability=probability,
        says=says,
    )


def _motion(latent: Latent) -> tuple[Floats, Floats, Floats]:
    """Return time, mean and deviation of a latent motion in the first record."""
    basis = latent.bases[0]
    m = len(basis)
    root = latent.root[:m]
    spread = np.sqrt(np.sum((basis.at(basis.places) @ root) ** 2, axis=1))
    return basis.places, basis.at(basis.places) @ latent.mean[:m], spread


def _numbers(values: Floats) -> tuple[float, ...]:
    return tuple(float(each) for each in values)


def _curve(latent: Latent, search: LawSearch, law: Law, probability: float, policy: LawPolicy) -> LawCurve:
    """Return a law as data."""
    x, unit, of_unit = law.knots, latent.unit, OF_UNITS[law.of]
    curves = [law.curve(k) for k in range(len(law.mean) // len(x))]
    shown = curves[-1:] if law.kind == "change" else curves
    xs = x if len(shown) == 1 else np.concatenate([x, x[::-1]])
    mean = np.concatenate([value[:: 1 - 2 * k] for k, (value, _) in enumerate(shown)])
    spread = np.concatenate([np.sqrt(np.diag(c))[:: 1 - 2 * k] for k, (_, c) in enumerate(shown)])
    value, covariance = shown[0]
    shape = closest_shape(x, value, covariance, policy.shape_error, unit, law.of, of_unit)
    says = f"the windup of {latent.at} as a function of {law.of.replace('_', ' ')} {shape}"
    if law.kind == "law with memory":
        says += ", with another branch where the angle falls"
    if law.kind == "change":
        at, low, high = law.instant
        says += f", from {at:.2f} s on (90 %: {low:.2f} to {high:.2f} s)"
        says += _softening(latent, law)
    peak = with_unit(float(np.ptp(mean)), unit, 3)
    return LawCurve(
        latent.at,
        latent.quantity,
        law.of,
        unit,
        of_unit,
        x=_numbers(xs),
        value=_numbers(mean),
        low90=_numbers(mean - NORMAL90 * spread),
        high90=_numbers(mean + NORMAL90 * spread),
        kind=law.kind,
        instant_s=law.instant[0] if law.instant else None,
        probability=probability,
        says=f"{says}; it spans {peak}",
        cloud_x=_numbers(search.states.values[law.of]),
        cloud_value=_numbers(search.motion()),
        instant90=law.instant[1:],
    )


def _slope(latent: Latent, law: Law) -> tuple[float, float]:
    """Return the slope of the second curve over the first one, and its deviation."""
    k = len(law.knots)
    line = np.linalg.pinv(np.column_stack([np.ones(k), law.knots]))[1]
    weights = np.concatenate([-line, line])
    return float(weights @ law.mean), float(np.linalg.norm(weights @ law.root))


def _softening(latent: Latent, law: Law) -> str:
    """Return how much softer the joint is after an instant, where the law is one of torque."""
    stiffness = _stiffness(latent)
    if law.of != "torque" or not stiffness:
        return ""
    slope, std = _slope(latent, law)
    part = 1 - 1 / (1 - stiffness * slope)  # 1/k' = 1/k - slope
    error = stiffness * std / (1 - stiffness * slope) ** 2
    word = "softer" if part > 0 else "stiffer"
    return f": there it is {100 * abs(part):.0f} ± {max(100 * error, 1):.0f} % {word}"


def _stiffness(latent: Latent) -> float:
    """Return the torque over the deflection of a joint along its run [N m/rad]; 0 of a rigid one."""
    assert latent.response is not None
    response = latent.response
    name = next(iter(response.bases))
    run = response.problem.simulations.beside(name, response.arm).simulation
    k = [each.name for each in run.arm.moving_joints].index(latent.at)
    deflection = run.drive_angle[:, k] - run.joint_angle[:, k]
    square = float(deflection @ deflection)
    return float(run.joint_torque[:, k] @ deflection) / square if square > 0 else 0.0


def _as_torque(law: LawCurve, stiffness: float) -> LawCurve:
    """Return the torque that the joint loses in place of a windup, f = -k w."""

    def times(values: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(-stiffness * each for each in values)

    says = law.says.split("; it spans")[0].replace("the windup of", "a torque lost at")
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
