r"""Latent motions and forces that are slow against the first mode, as functions of time.

The quasi-static response to a slow p(t) is that to a constant p at each instant, times p(t):

.. math:: \partial r/\partial c_j = \frac{\partial r}{\partial p} B_j(t)                                (1)

with r the residual, B_j the splines of p. Places are the model's own: rotations of the base about its origin
and of a joint across its axis, and curvatures of a beam, are differences of models that are turned or bent
by a little. A force at a payload is a small mass there in a gravity that is turned there by a little,

.. math:: \partial r/\partial F = \partial^2 r/\partial m\,\partial g                                  (2)

so that inertia and weight of the mass cancel. No mode filters these motions: they may fit better than the
joint that moves, and leave no joint out (`search`).
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import groupby, islice

import numpy as np
from scipy.spatial.transform import Rotation

from flexarm.arm import Arm
from flexarm.arm.attachment import Payload
from flexarm.arm.joint import Joint, Origin
from flexarm.arm.kinematics import carrying_joint
from flexarm.arm.link import Beam
from flexarm.arm.rotation import across
from flexarm.arm.vocabulary import BASE
from flexarm.arm.weight import weight_statement
from flexarm.arrays import Floats
from flexarm.budget import allows
from flexarm.diagnosis.fit import FIT_ERRORS
from flexarm.diagnosis.problem import Problem
from flexarm.effects.link_bow import LinkBow
from flexarm.effects.tabulated_law import directions_across
from flexarm.missing_law.basis import basis_of
from flexarm.missing_law.policy import LawPolicy
from flexarm.missing_law.windup import Response

AXES = "xyz"


@dataclass(frozen=True, eq=False)
class SlowMotion:
    """A slow motion or force at a place, in one direction."""

    at: str
    quantity: str
    direction: str
    unit: str
    """Place, what is missing there, and its direction."""
    size: float
    """A large one [unit]: a radian, or the weight of the arm."""
    models: Sequence[tuple[float, Arm]]
    """Models, whose residuals by these factors add up to a derivative."""
    arm: Arm
    """The model."""

    @property
    def law(self) -> Mapping[str, str] | None:
        """Return the keys of the `tabulated_law` that it is; None if it is none."""
        key = {"about": "windup", "towards": "curvature", "along": "force"}
        how, _, axis = self.direction.partition(" ")
        if self.quantity == "rotation" and self.at != BASE:
            return None
        return {"quantity": key[how], "direction": axis}

    def slopes(self, problem: Problem, policy: LawPolicy) -> Floats:
        """Return the derivative of the residual, shape (n,)."""
        coarse = problem.with_step(policy.response_step)
        return np.asarray(sum(factor * coarse.residual(arm) for factor, arm in self.models))

    def response(self, problem: Problem, policy: LawPolicy) -> Response:
        """Return (1), for splines of each record."""
        slopes, bases, blocks = self.slopes(problem, policy), {}, []
        for name in problem.records:
            if rows := list(problem.rows_of(name)):
                bases[name] = basis_of(problem, name, policy)
                blocks.append(np.zeros((len(problem), len(bases[name]))))
                for each in rows:
                    splines = bases[name].at(each.time)
                    blocks[-1][each.where] = slopes[each.where, None] * splines  # eq. (1)
        return Response(
            problem, self.arm, carrying_joint(self.arm, self.at).name, bases, np.column_stack(blocks)
        )


def slow_motions(arm: Arm, policy: LawPolicy) -> Iterator[SlowMotion]:
    """Yield the motions of the base, then those across joints, of beams and at payloads."""
    e, unit = policy.perturbation, np.eye(3)
    for axis in unit:
        sides = [_on_turned_base(arm, turn * axis) for turn in (e, -e)]
        yield _rotation(arm, BASE, axis, sides, e)
    for joint in arm.moving_joints:
        for axis in map(_upward, np.array(across(joint.axis))):
            sides = [_turned_across(arm, joint, turn * axis) for turn in (e, -e)]
            yield _rotation(arm, joint.name, axis, sides, e)
    for link in (each for each in arm.links if isinstance(each, Beam)):
        for letter, direction in islice(directions_across(link.end).items(), 2):
            axis, stated = np.array(direction), arm.effect(LinkBow.name, link.name)
            bow = stated if isinstance(stated, LinkBow) else LinkBow(at=link.name)
            tips = [np.array(bow.tip_offset) + turn * link.length / 2 * axis for turn in (e, -e)]
            sides = [arm.with_effect(bow.replace(tip_offset=tuple(tip.tolist()))) for tip in tips]
            models, towards = _difference(sides, e / link.length), f"towards {letter}"
            yield SlowMotion(link.name, "curvature", towards, "1/m", 1 / link.length, models, arm)
    mass, g = weight_statement(arm).whole.mass, 9.81
    for load in arm.payloads:
        with_mass = _loaded(arm, load, e ** (2 / 3) * mass)
        for axis in unit:
            models = []
            for sign, each in ((1, with_mass), (-1, arm)):
                turned = [np.array(arm.gravity) + s * e ** (1 / 3) * g * axis for s in (1, -1)]
                sides = [each.replace(gravity=tuple(there.tolist())) for there in turned]
                models += _difference(sides, sign * e * mass * g)  # eq. (2)
            yield SlowMotion(load.name, "force", f"along {_letter(axis)}", "N", mass * g, models, arm)


def _shown(motion: SlowMotion, problem: Problem, policy: LawPolicy) -> float:
    """Return by how much a large one moves the residual; zero if it would open a rigid loop."""
    try:
        return float(np.linalg.norm(motion.size * motion.slopes(problem, policy)))
    except FIT_ERRORS:
        return 0.0


def _rotation(arm: Arm, at: str, axis: Floats, sides: Sequence[Arm], turn: float) -> SlowMotion:
    return SlowMotion(at, "rotation", f"about {_letter(axis)}", "rad", 1.0, _difference(sides, turn), arm)


def _difference(sides: Sequence[Arm], step: float) -> list[tuple[float, Arm]]:
    """Return a central difference of models above and below."""
    return [(sign / (2 * step), arm) for sign, arm in zip((1, -1), sides, strict=True)]


def slow_places(problem: Problem, arm: Arm, policy: LawPolicy) -> Iterator[list[SlowMotion]]:
    """Yield the directions of each place that signals show, as long as there is time.

    Signals show it if the large one moves the residual by the noise and, of the greatest rotation of the
    base, by `policy.least_mode`.
    """
    least = 1.0
    for (at, _), group in groupby(slow_motions(arm, policy), lambda each: (each.at, each.quantity)):
        if not allows(f"the slow motions of {at} were sought"):
            return
        directions = list(group)
        problem.with_step(policy.response_step).prepare(m for each in directions for _, m in each.models)
        shown = [_shown(each, problem, policy) for each in directions]
        if at == BASE:
            least = max(policy.least_mode * max(shown), least)
        if found := [each for each, size in zip(directions, shown, strict=True) if size > least]:
            yield found


def _turned(origin: Origin, turn: Rotation, about: Floats) -> Origin:
    """Return a frame after a rotation about a place, in the axes of its parent."""
    with warnings.catch_warnings():  # a pitch of a right angle leaves roll and yaw open
        warnings.simplefilter("ignore", UserWarning)
        rpy = (turn * Rotation.from_euler(AXES, origin.rpy)).as_euler(AXES)
    xyz = about + turn.apply(np.array(origin.xyz) - about)
    return origin.replace(xyz=tuple(xyz.tolist()), rpy=tuple(rpy.tolist()))


def _on_turned_base(arm: Arm, turn: Floats) -> Arm:
    """Return the arm with all that stands on the base turned about its origin; gravity stays."""
    turned = partial(_turned, turn=Rotation.from_rotvec(turn), about=np.zeros(3))
    joints = [j.replace(origin=turned(j.origin)) if j.parent == BASE else j for j in arm.joints]
    closures = []
    for closure in arm.closures:
        ends = {"a_origin": closure.a, "b_origin": closure.b}
        on_base = {key: turned(getattr(closure, key)) for key, place in ends.items() if place == BASE}
        closures.append(closure.replace(**on_base))
    return arm.replace(joints=tuple(joints), closures=tuple(closures))


def _turned_across(arm: Arm, joint: Joint, turn: Floats) -> Arm:
    """Return the arm with a joint, and all that it carries, turned about its origin, in its own axes."""
    in_parent = Rotation.from_rotvec(Rotation.from_euler(AXES, joint.origin.rpy).apply(turn))
    there = joint.replace(origin=_turned(joint.origin, in_parent, np.array(joint.origin.xyz)))
    return arm.replace(joints=tuple(there if each is joint else each for each in arm.joints))


def _loaded(arm: Arm, load: Payload, mass: float) -> Arm:
    """Return the arm with one more mass at a payload."""
    name = "_".join(["more", *(each.name for each in arm.payloads)])
    more = Payload(name=name, link=load.link, position=load.position, mass=mass)
    return arm.replace(payloads=(*arm.payloads, more))


def _upward(axis: Floats) -> Floats:
    """Return a direction or its opposite, so that it points along the axis it is nearest to."""
    return np.asarray(axis * np.sign(axis[np.argmax(np.abs(axis))]))


def _letter(axis: Floats) -> str:
    """Return the name of the axis that a direction is nearest to."""
    return AXES[int(np.argmax(np.abs(axis)))]
