r"""Latent motions: unknown functions of time at each place, with a Gaussian process prior.

.. math:: r(c) \approx r + J c + J_x x + e, \quad c \sim N(0, s^2 K(\ell))                              (1)

J is the linear response to coefficients c of splines in time, or to one a pose (`windup`), x are nuisance
parameters and the found effects' own, with their priors. K is the Matern covariance of the places of the
splines, a block a record, and 1 for poses. Size s, length l and noise maximise the marginal likelihood
(`gaussian`). The residual about the mean of c is simulated again, J stays:

.. math:: r \leftarrow r(c) - J c                                                                       (2)

An offset of a sensor is a function of time for each of its channels; there J is exact. A slow motion is one
for each of its directions (`slow`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import block_diag
from scipy.sparse import csr_matrix, diags, lil_matrix

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.diagnosis.candidate import with_members
from flexarm.diagnosis.fit import FIT_ERRORS, Fit, Projection
from flexarm.diagnosis.problem import Problem
from flexarm.drive.doubts import slides
from flexarm.missing_law.basis import Basis, TimeBasis
from flexarm.missing_law.gaussian import ColumnSpace, GaussianData, GaussianModel
from flexarm.missing_law.policy import LawPolicy
from flexarm.missing_law.slow import SlowMotion, slow_places
from flexarm.missing_law.windup import Response, WindupResponse, driven_joints

_Roots = dict[float, tuple[Floats, tuple[Floats, Floats]]]


@dataclass(frozen=True, eq=False)
class Latent:
    """A latent motion at a place."""

    at: str
    quantity: str
    unit: str
    """Place, and what is missing there."""
    data: GaussianData
    """Residual without the motion, and nuisance parameters."""
    model: GaussianModel
    """Eq. (1) with the motion."""
    length: float
    """l of (1) [s]; 0 of poses."""
    mean: Floats
    root: Floats
    """Of c: posterior mean and a root of the covariance."""
    bases: Sequence[Basis]
    """Of the coefficients, one after the other."""
    response: Response | None = None
    """Linear response; None of a sensor, and of a slow motion in several directions."""
    slow: bool = False
    """True if no mode filters it (`slow`)."""
    law: Mapping[str, str] | None = None
    """Keys of the `tabulated_law` that a slow motion is as a function of a state; None if there is none."""

    @property
    def gain(self) -> float:
        """Log evidence of the motion over none."""
        none = GaussianModel.of(self.data, np.zeros((len(self.data.y), 1)))
        return self.model.log_evidence - none.log_evidence


def noise_scale(problem: Problem, fit: Fit) -> Floats:
    """Return the total noise, with input noise and discretisation error, over that of the sensors, (n,)."""
    found = np.ones(len(problem))
    for rows, where in problem.channels():
        found[where] = np.sqrt(1.0 + rows.explained_square(fit.non_smooth))
    return found


def nuisance_projection(problem: Problem, fit: Fit) -> Projection:
    """Return what eliminates nuisance parameters and, with a flat prior, the found effects' parameters."""
    scale = noise_scale(problem, fit)[:, None]
    jacobian = np.column_stack([fit.jacobian, fit.projection.jacobian]) / scale
    return Projection(jacobian, np.concatenate([np.full(len(fit.z), np.inf), fit.projection.sigma]))


def latent_motions(problem: Problem, fit: Fit, policy: LawPolicy) -> Iterator[Latent]:
    """Yield the latent motion of each place: driven joints, slow motions, sensors.

    Sensors whose offset cannot be as likely as the likeliest joint are left out.
    """
    arm, best = with_members(fit.nuisance.arm, fit.members), -np.inf
    for found in _windups(_likely_joints(problem, fit, arm, policy), problem, fit, arm, policy):
        best = max(best, found.model.log_evidence if found.gain > policy.evidence else -np.inf)
        yield found
    for directions in slow_places(problem, arm, policy):
        yield _slow(directions, problem, fit, policy)
    motions = (rows for rows in problem.rows if problem.records[rows.record].kind == "motion")
    for signal in dict.fromkeys(rows.signal for rows in motions):  # free in each pose, an offset is noise
        if offset_evidence_bound(signal, problem, fit) > best - problem.policy.reach:
            yield _offset(signal, problem, fit, policy)


def _likely_joints(problem: Problem, fit: Fit, arm: Arm, policy: LawPolicy) -> list[str]:
    """Return the driven joints; of many those with the greatest evidence of a coarse latent motion."""
    names = {joint for name in problem.records for joint in driven_joints(problem, arm, name)}
    joints = [each.name for each in arm.moving_joints if each.name in names]
    if len(joints) <= policy.most_joints:
        return joints
    coarse = replace(policy, spacing=policy.pass_spacing, linearisations=0)
    evidence = {each.at: each.model.log_evidence for each in _windups(joints, problem, fit, arm, coarse)}
    return sorted(evidence, key=lambda joint: -evidence[joint])[: policy.most_joints]


def _windups(
    joints: Sequence[str], problem: Problem, fit: Fit, arm: Arm, policy: LawPolicy
) -> Iterator[Latent]:
    """Yield the latent windup of each joint that can be simulated."""
    for joint in joints:
        found = None
        with suppress(*FIT_ERRORS):
            found = _windup(joint, problem, fit, arm, policy)
        if found is not None:
            yield found


def _windup(joint: str, problem: Problem, fit: Fit, arm: Arm, policy: LawPolicy) -> Latent | None:
    """Return the latent windup of a joint, relinearised; None if the time for it ends."""
    response = WindupResponse.of(problem, arm, joint, policy)
    if response is None:
        return None
    scale, projection = noise_scale(problem, fit), nuisance_projection(problem, fit)
    jacobian = response.jacobian / scale[:, None]
    residual = fit.residual / scale
    data = GaussianData(-residual, projection, policy)
    bases, space = list(response.bases.values()), ColumnSpace.of(data, jacobian)
    roots = _roots(space, bases, policy)
    for round_ in range(policy.linearisations + 1):
        model, mean, deviation, length = _most_likely(space, roots)
        if round_ < policy.linearisations:
            moved = response.moved(mean) / scale
            y = jacobian @ mean - residual - moved  # eq. (2)
            space = space.about(GaussianData(y, projection, policy))
    unit = "m" if slides(arm, joint) else "rad"
    return Latent(joint, "windup", unit, space.data, model, length, mean, deviation, bases, response)


def _roots(space: ColumnSpace, bases: Sequence[Basis], policy: LawPolicy) -> _Roots:
    """Return L of (1) with its spectrum, by length."""
    # poses have no correlation length
    lengths = policy.lengths if any(isinstance(each, TimeBasis) for each in bases) else (0.0,)
    roots = {each: block_diag(*(basis.root(each) for basis in bases)) for each in lengths}
    return {length: (root, space.spectrum(root)) for length, root in roots.items()}


def _most_likely(space: ColumnSpace, roots: _Roots) -> tuple[GaussianModel, Floats, Floats, float]:
    """Return (1) with the most likely length, mean and root of the covariance of c, and that length."""
    length = max(roots, key=lambda each: space.log_evidence(*roots[each]))
    root, spectrum = roots[length]
    model = space.model(root, spectrum)
    root = root * model.size
    mean, deviation = model.posterior()
    return model, root @ mean, root @ (np.sqrt(model.noise) * deviation), length


def _slow(directions: Sequence[SlowMotion], problem: Problem, fit: Fit, policy: LawPolicy) -> Latent:
    """Return the slow motion of a place in its likeliest direction, or in all of them that explain a part.

    Of several directions, coarser splines decide.
    """
    if len(directions) == 1:
        return _along(directions, problem, fit, policy)
    coarse = replace(policy, spacing=max(policy.spacing, policy.pass_spacing))
    tried = [_along([each], problem, fit, coarse) for each in directions]
    order = sorted(range(len(tried)), key=lambda k: -tried[k].model.log_evidence)
    single, some = tried[order[0]], [directions[k] for k in order if tried[k].gain > policy.evidence]
    if len(some) > 1:
        both = _along(some, problem, fit, coarse)
        if both.model.log_evidence > single.model.log_evidence:
            return _along(some, problem, fit, replace(policy, lengths=(both.length,)))
    return _along([directions[order[0]]], problem, fit, policy)


def _along(directions: Sequence[SlowMotion], problem: Problem, fit: Fit, policy: LawPolicy) -> Latent:
    """Return the slow motion of a place in one direction or several."""
    first, *others = directions
    quantity = " and ".join([f"{first.quantity} {first.direction}", *(each.direction[-1] for each in others)])
    responses = [each.response(problem, policy) for each in directions]
    bases = [basis for each in responses for basis in each.bases.values()]
    jacobian = np.column_stack([each.jacobian for each in responses])
    found = _linear(first.at, quantity, first.unit, problem, fit, bases, jacobian, policy)
    if others:
        return replace(found, slow=True)
    return replace(found, response=responses[0], slow=True, law=first.law)


def _linear(
    at: str,
    quantity: str,
    unit: str,
    problem: Problem,
    fit: Fit,
    bases: Sequence[Basis],
    jacobian: Floats | csr_matrix,
    policy: LawPolicy,
) -> Latent:
    """Return the latent motion of a place whose response is linear; jacobian has shape (n, m)."""
    scale = noise_scale(problem, fit)
    data = GaussianData(-fit.residual / scale, nuisance_projection(problem, fit), policy)
    space = ColumnSpace.of(data, diags(1 / scale) @ jacobian)
    model, mean, deviation, length = _most_likely(space, _roots(space, bases, policy))
    return Latent(at, quantity, unit, data, model, length, mean, deviation, bases)


def offset_evidence_bound(signal: str, problem: Problem, fit: Fit) -> float:
    """Return an upper bound of the log evidence of a sensor's offset: all its rows explained at no cost."""
    scale, of = noise_scale(problem, fit), nuisance_projection(problem, fit)
    others = np.ones(len(scale), dtype=bool)
    for each, where in problem.channels():
        others[where] = each.signal != signal
    rest = Projection(of.jacobian[others], of.sigma).project((fit.residual / scale)[others])
    square = float(rest @ rest)
    v = max(square / len(scale), 1.0)
    return -0.5 * (len(scale) * float(np.log(v)) + square / v)


def _offset(signal: str, problem: Problem, fit: Fit, policy: LawPolicy) -> Latent:
    """Return the offset of a sensor, a function of time for each channel and record."""
    rows = [
        each
        for each in problem.rows
        if each.signal == signal and problem.records[each.record].kind == "motion"
    ]
    bases = [TimeBasis.over(float(each.time[0]), float(each.time[-1]) + 1e-6, policy) for each in rows]
    blocks = np.cumsum([0, *map(len, bases)])
    jacobian = lil_matrix((len(problem), int(blocks[-1])))
    for each, basis, first in zip(rows, bases, blocks, strict=False):
        jacobian[each.where, first : first + len(basis)] = -basis.at(each.time) / each.sigma
    unit = {"position": "m", "orientation": "-"}.get(
        problem.records[rows[0].record].signals[signal].quantity, ""
    )
    return _linear(signal, "offset", unit, problem, fit, bases, jacobian.tocsr(), policy)
