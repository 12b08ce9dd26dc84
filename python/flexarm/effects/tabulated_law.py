r"""A law that a table gives: a motion or force of a joint, a link, a payload or the base, of a joint's state.

.. math:: T = T_s(d + w(y)), \qquad d = \psi - \theta                                                   (1)
.. math:: T \leftarrow T - f(y)                                                                       (2)

A `windup` w [rad] is added to the deflection d of the reducer's spring T_s, eq. (1), and so turns the link
forward: a table w = -c T makes a spring of stiffness k one of 1/(1/k + c). A `torque` f [N m] is lost by T as
friction is, eq. (2). The table is a function of y: of the `angle` \theta [rad] of the link, of its `rate`
[rad/s], of the `motor_angle` \varphi over the gear ratio [rad], or, a windup alone, of the `torque` T_s
[N m].

Between knots the table is a monotone cubic [Fritsch1984]_, beyond them it holds its first and last value. A
windup of the torque is solved within the spring; of the motor's angle it is a part of the teeth's map, as
`transmission_error` is. Without `joint_compliance` a windup moves the drive: of the motor's angle exactly,
else on a spring of 1e9 N m/rad. The spring's damper acts on \psi' - \theta'.

At other places the state is that of the moving joint that carries the link or the payload, and of the base
that of the model's first moving joint:

.. math:: \kappa = f(y), \qquad F = f(y) \, e, \qquad R = \exp(f(y) \, e)                            (3)

A `curvature` \kappa [1/m] is uniform and needs no stress, as a `link_bow` of the tip's offset \kappa L^2/2
has it; the tip bends towards the part of x, y or z of the link's frame that lies across the beam. A `force` F
[N] acts at the centre of a payload along x, y or z of the base. A `windup` of the base [rad] turns all that
stands on it by R about x, y or z of the base through its origin, on a spring of 1e9 N m/rad; it is no
function of the rate, whose jumps would throw the arm. Nothing acts back on the joint. The link's damper
resists the whole rate of its strain; modes hold the values.

A table may change at an instant t_c [s], or have a second branch where the angle falls:

.. math:: f(y, t) = (1 - s) f_0(y) + s f_1(y), \qquad s = \min(\max((t - t_c)/\tau + 1/2, 0), 1)          (4)
.. math:: f(\theta) = \tfrac12 (f_+ + f_-) + \tfrac12 z (f_+ - f_-), \qquad
          \dot z = (1 - z \operatorname{sgn} \dot\theta)\,\dot\theta/\delta                             (5)

t is the time of the run, so that each run has the instant t_c on its own clock; statics, modes and poses
take t = 0. The duration \tau [s] regularises the change: the response is then a continuous function of t_c,
and a free vibration of a period much longer than \tau does not see it. z is the sense of motion by Dahl's
law of the width \delta [rad], as of `coulomb_friction`; a run starts with z = 0. Mean and half the difference
of the branches are monotone cubics.

References
----------
.. [Fritsch1984] F. N. Fritsch, J. Butland, "A method for constructing local monotone piecewise cubic
   interpolants", SIAM Journal on Scientific and Statistical Computing 5(2), 1984.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from math import hypot, isinf
from typing import TYPE_CHECKING, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field, model_validator

from flexarm.arm.closure import PINNED
from flexarm.arm.effect import Effect
from flexarm.arm.friction_effect import STICK_WIDTH
from flexarm.arm.kinematics import carrying_joint
from flexarm.arm.link import Beam
from flexarm.arm.prior import Prior
from flexarm.arm.rotation import Vector, part_across, scaled
from flexarm.arm.vocabulary import BASE, places
from flexarm.effects.joint_compliance import JointCompliance
from flexarm.tables import Inconsistent, Number, Numbers, value_in
from flexarm.tables.field import Path

if TYPE_CHECKING:
    from flexarm import _core
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine

NEARLY_RIGID = 1e9
"""Stiffness of a joint without compliance that winds up by a table [N m/rad]: 1 microradian per kN m."""
OF_UNIT = {"angle": "rad", "rate": "rad/s", "torque": "N m", "motor_angle": "rad"}
"""Unit of x by what it is a table of."""
UNIT = {"windup": "rad", "torque": "N m", "curvature": "1/m", "force": "N"}
"""Unit of the values by quantity."""
SIZE = {"windup": 1e-3, "torque": 100.0, "curvature": 1e-3, "force": 100.0}
"""Deviation of the values before data, in these units."""
KINDS = {"windup": ("joint", "base"), "torque": ("joint",), "curvature": ("link",), "force": ("payload",)}
"""Kinds of places by quantity."""
MOTION = ("angle", "rate", "motor_angle")
AXES: dict[str, Vector] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
LEAST_ACROSS = 0.4
"""Least sine between a beam and the direction of its curvature."""

CHANGE_DURATION = 0.02
"""tau of (3) where none is stated [s]: a multiple of the usual time steps."""
BRANCHES = ("value", "value_after", "value_falling")
"""Fields that hold values at the knots."""


def _quoted(names: Iterable[str]) -> str:
    return " or ".join(map(repr, names))


def states_of_table(quantity: str, at: str) -> tuple[str, ...]:
    """Return what a quantity at a place may be a function of."""
    if quantity == "windup":
        return ("angle", "motor_angle") if at == BASE else (*MOTION, "torque")
    return MOTION


def directions_across(end: Vector) -> dict[str, Vector]:
    """Return unit vectors across a beam that ends at `end`, each by the name of the axis it is a part of."""
    across = {name: part_across(axis, end) for name, axis in AXES.items()}
    return {
        name: scaled(1 / hypot(*each), each) for name, each in across.items() if hypot(*each) > LEAST_ACROSS
    }


class TabulatedLaw(Effect):
    """A table of a joint's windup or lost torque, or of what else its state moves.

    `quantity` "windup" is w of (1) or the turn of the base of (3), "torque" f of (2), "curvature" and "force"
    those of (3); `x` and `value` are the table of y, `direction` is e. `value_after` is f_1 of (4), `instant`
    t_c and `duration` tau; `value_falling` is f_- of (5) and `width` delta.
    """

    name = "tabulated_law"
    competes = False
    at_closures = PINNED
    quantity: Literal["windup", "torque", "curvature", "force"] = Field(
        description='"windup", "torque", "curvature" or "force"'
    )
    of: Literal["angle", "rate", "torque", "motor_angle"] = Field(
        description='"angle", "rate", "torque" or "motor_angle"'
    )
    x: Numbers = value_in("SI", "knots, rising", numbered=True)
    value: Numbers = value_in("SI", "values at the knots", numbered=True)
    direction: Literal["x", "y", "z"] | None = Field(
        None, description='"x", "y" or "z"; left out at a joint, which has one direction'
    )
    value_after: Numbers = value_in("SI", "values from the instant on", (), numbered=True)
    instant: Number | None = value_in("s", "when values change", None)
    duration: Number = value_in("s", "time over which they change", CHANGE_DURATION, gt=0)
    value_falling: Numbers = value_in("SI", "values where the angle falls", (), numbered=True)
    width: Number = value_in("rad", "turn over which the branch changes", STICK_WIDTH, gt=0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if problems := list(self._problems()):
            raise Inconsistent(*problems)
        return self

    def _problems(self) -> Iterable[tuple[Path, str]]:
        if self.of not in self.states:
            what = f"must be {_quoted(self.states)} of a {self.quantity} at {self.at!r}, got {self.of!r}"
            yield ("of",), what
        if self.of_joint and self.direction is not None:
            what = f"must be left out at a joint, which has one direction, got {self.direction!r}"
            yield ("direction",), what
        if not self.of_joint and self.direction is None:
            yield ("direction",), f"is missing: a {self.quantity} at {self.at!r} has one, {_quoted(AXES)}"
        if len(self.x) < 2:
            yield ("x",), f"must be two knots or more, got {len(self.x)}"
        for name in dict.fromkeys(("value", *self.branches)):
            if (count := len(getattr(self, name))) != len(self.x):
                yield (name,), f"must have as many numbers as x, {len(self.x)}, got {count}"
        for before, knot in pairwise(self.x):
            if not knot > before:
                yield ("x",), f"must rise from knot to knot, got {knot:g} after {before:g}"
                break
        yield from self._problems_of_branches()

    def _problems_of_branches(self) -> Iterable[tuple[Path, str]]:
        if bool(self.value_after) != (self.instant is not None):
            missing = "instant" if self.value_after else "value_after"
            yield (missing,), "is missing: a law that changes has value_after and an instant"
        if self.value_after and self.of_joint and (self.quantity, self.of) == ("windup", "motor_angle"):
            yield ("value_after",), "must be left out of a windup of the motor's angle, which cannot change"
        if self.value_falling and (self.quantity, self.of) != ("torque", "angle"):
            yield ("value_falling",), "must be left out: a torque of the angle alone may have two branches"
        if self.value_falling and self.value_after:
            yield ("value_falling",), "must be left out of a law that changes at an instant"

    @property
    def of_joint(self) -> bool:
        """Return True if it acts in a joint."""
        return self.quantity == "torque" or (self.quantity == "windup" and self.at != BASE)

    @property
    def states(self) -> tuple[str, ...]:
        """Return what its table may be a function of."""
        return states_of_table(self.quantity, self.at)

    @property
    def behind(self) -> bool:
        """Return True if the core counts by what it leaves the link behind."""
        return self.of_joint and self.quantity == "windup"

    @property
    def branches(self) -> tuple[str, ...]:
        """Return the names of the fields that hold values at the knots."""
        return tuple(name for name in BRANCHES if getattr(self, name))

    @property
    def values(self) -> NDArray[np.float64]:
        """Return the values of all branches, one after the other, shape (b k,)."""
        return np.concatenate([getattr(self, name) for name in self.branches])

    def with_values(self, values: ArrayLike) -> Self:
        """Return the law with other values of all branches, shape (b k,)."""
        parts = np.split(np.asarray(values, float), len(self.branches))
        return self.replace(
            **dict(zip(self.branches, map(tuple, (each.tolist() for each in parts)), strict=True))
        )

    def __call__(self, y: ArrayLike, branch: str = "value") -> NDArray[np.float64]:
        """Return the table of a branch at y [rad, rad/s or N m], shape of y."""
        sign = -1.0 if self.behind else 1.0
        return sign * np.asarray(self.table(branch)(np.asarray(y, float)))

    def table(self, branch: str = "value") -> _core.MonotoneCubic:
        """Return a table as the core takes it: it counts by what a windup leaves the link behind, -w."""
        from flexarm import _core

        values = getattr(self, branch)
        return _core.MonotoneCubic(self.x, [-each for each in values] if self.behind else values)

    def _changing(self) -> _core.ChangingTable:
        """Return the table and that after the instant, eq. (4)."""
        from flexarm import _core

        if self.instant is None:
            return _core.ChangingTable(self.table())
        return _core.ChangingTable(self.table(), self.table("value_after"), self.instant, self.duration)

    def patch(self, machine: Machine) -> None:
        """Add the table to what it moves: teeth, spring or output bearing, eqs. (1), (2), or by (3)."""
        if not self.of_joint:
            return self._patch_beside(machine)
        train = machine.drive_trains[self.at]
        if self.quantity == "torque":
            train.bearing += self._torques()
        elif self.of == "motor_angle":
            train.teeth().windup = self.table()
        else:
            train.windup = (self.of, self._changing())  # eq. (1)
            if isinf(train.stiffness):
                train.stiffness = NEARLY_RIGID

    def _patch_beside(self, machine: Machine) -> None:
        """Give a curvature, a force or a turn to a place that the joint carries, eq. (3)."""
        from flexarm import _core

        axis = AXES[self.direction or "x"]
        joint = carrying_joint(machine.arm, self.at).name
        table = _core.StateTable(
            joint=joint, of=_core.Of[self.of], table=self._changing(), direction=np.array(axis)
        )
        if self.quantity == "curvature":
            machine.links[self.at].curvature = table
        elif self.quantity == "force":
            machine.payloads[self.at].force = table
        else:
            machine.base.turn(axis, table)

    def _torques(self) -> list[_core.TabulatedTorque | _core.TabulatedFriction]:
        """Return what loses the torque of (2), of two branches that of (5)."""
        from flexarm import _core

        of = _core.Of[self.of]
        if not self.value_falling:
            return [_core.TabulatedTorque(of, self._changing())]
        rising, falling = np.array(self.value), np.array(self.value_falling)
        mean, half = (
            _core.MonotoneCubic(self.x, (each / 2).tolist()) for each in (rising + falling, rising - falling)
        )
        dragging = _core.TabulatedFriction(half, self.width)
        return [_core.TabulatedTorque(of, _core.ChangingTable(mean)), dragging]  # eq. (5)

    def problems(self, arm: Arm) -> Iterable[tuple[str, str]]:
        """Refuse places that the quantity has not, and windups that a joint could not bear."""
        known = {kind: self.at in (places(arm, kind) or ()) for kind in ("joint", "base", "link", "payload")}
        known["joint"] |= self.at in [closure.name for closure in arm.closures]
        if not any(known[kind] for kind in KINDS[self.quantity]):
            there = [each for each, kinds in KINDS.items() if any(known[kind] for kind in kinds)]
            yield "quantity", f"must be {_quoted(there)} at {self.at!r}, got {self.quantity!r}"
        elif self.of_joint:
            yield from self._problems_of_joint(arm)
        else:
            yield from self._problems_beside(arm)

    def _problems_beside(self, arm: Arm) -> Iterable[tuple[str, str]]:
        if carrying_joint(arm, self.at) is None:
            yield "of", "needs a joint that moves, whose state the table is a function of; the model has none"
        if self.quantity != "curvature":
            return
        link = arm.link(self.at)
        if not isinstance(link, Beam):
            yield "at", f"{self.at!r} is a {link.type} link; only a beam has a curvature"
        elif self.direction not in (allowed := directions_across(link.end)):
            what = f"must be {_quoted(allowed)}, across the beam {self.at!r}, got {self.direction!r}"
            yield "direction", what

    def _problems_of_joint(self, arm: Arm) -> Iterable[tuple[str, str]]:
        if self.quantity == "windup" and self.at in [closure.name for closure in arm.closures]:
            yield "quantity", f'must be "torque" at a closure, which has no spring, got "{self.quantity}"'
        if self.quantity != "windup" or self.of not in ("motor_angle", "torque"):
            return
        low, high = np.transpose([self.table(branch).slopes() for branch in self.branches])
        low, high = float(low.min()), float(high.max())
        if self.of == "motor_angle" and max(-low, high) >= 1:
            yield (
                "value",
                f"must change by less than 1 rad per rad of the motor's angle, else the output turns back; "
                f"the table reaches {max(-low, high):.3g}",
            )
        spring = arm.effect(JointCompliance.name, self.at)
        k = NEARLY_RIGID if spring is None or spring.inert else spring.value_of("stiffness")
        if self.of == "torque" and -low * k >= 1:
            yield (
                "value",
                f"must not rise with the torque by 1/stiffness = {1 / k:.3g} rad/(N m) or more, which would "
                f"leave the spring none; the table rises by {-low:.3g}",
            )

    def parameters(self) -> list[tuple[str, float, str]]:
        """Values at the knots and the instant as (name, value, unit); knots stay where they are."""
        return [found for found in super().parameters() if found[0].split(".")[0] in (*BRANCHES, "instant")]

    def unit(self, name: str) -> str:
        """Return the unit of x or of the values about a revolute joint."""
        own = {"x": OF_UNIT[self.of], **dict.fromkeys(BRANCHES, UNIT[self.quantity])}
        return own.get(name, super().unit(name))

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Return sizes of what no law of the vocabulary explains: wide, and about zero."""
        size = SIZE[self.quantity]
        source = "engineering judgement: as large as compliance and friction of a joint, bows and loads"
        prior = Prior(-size, size, 0.0, "linear", UNIT[self.quantity], source)
        found = {name: prior for name, _, _ in self.parameters() if name != "instant"}
        if self.instant is not None:
            within = "engineering judgement: within seconds of where it is stated"
            found["instant"] = Prior(self.instant - 1, self.instant + 1, self.instant, "linear", "s", within)
        return found

    @classmethod
    def typical(cls, at: str, arm: Arm) -> Self:
        """Return a windup that grows most where the torque changes sign: teeth that are not pressed home."""
        return cls(
            at=at,
            quantity="windup",
            of="torque",
            x=(-400.0, -40.0, 40.0, 400.0),
            value=(4e-4, 2e-4, -2e-4, -4e-4),
        )
