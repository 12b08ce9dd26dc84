r"""Points off their stated places, carried along with the sections of links.

Runs side by side record points at nodes only, and nodes mostly lie where points are stated. A point that an
effect or an uncertain value moves from there goes with the section, also in runs alone, which others are
compared with:

.. math:: x = x_0 + a (x_1 - x_0) + b (x_2 - x_0) + c (x_1 - x_0) \times (x_2 - x_0)                  (1)

x_0 is its stated place, x_1 and x_2 are points beside it, across the link. How the link bends between x_0 and
x is left out: with a curvature of 5e-3 1/m, a point that is 0.2 m beside the link and a millimetre along it
from x_0 is 1e-6 m off.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arm import Arm, Point
from flexarm.arm.names import link_of
from flexarm.arrays import Floats, read_only
from flexarm.assembly.machine import machine_of
from flexarm.effects.reflector_offset import ReflectorOffset

if TYPE_CHECKING:
    from flexarm.simulation import Simulation


class MovedPoints:
    """Points of a model off the `stated` ones, and the model `at_nodes` whose runs have them by (1)."""

    def __init__(self, arm: Arm, stated: Sequence[Point]) -> None:
        self.arm = self.at_nodes = arm
        self._factors: dict[int, Floats] = {}
        effects = tuple(effect for effect in arm.effects if not isinstance(effect, ReflectorOffset))
        if arm.points == tuple(stated) and effects == arm.effects:
            return
        bare = arm.replace(points=tuple(stated), effects=effects)
        here, there = machine_of(arm).points, machine_of(bare).points
        names = [point.name for point in stated]
        moved = [k for k, name in enumerate(names) if here[name].position != there[name].position]
        beside = [each for k in moved for each in _beside(bare, stated[k])]
        self.at_nodes = bare.replace(points=(*stated, *beside))
        place = [np.array(each.position) for each in machine_of(self.at_nodes).points.values()]
        for k, first in zip(moved, range(len(names), len(place), 2), strict=True):
            one, other = place[first] - place[k], place[first + 1] - place[k]
            axes = np.column_stack([one, other, np.cross(one, other)])
            self._factors[k] = np.linalg.solve(axes, np.array(here[names[k]].position) - place[k])

    def carried(self, run: Simulation) -> Simulation:
        """Return a run of the model at nodes as one of the model itself."""
        if self.at_nodes is self.arm:
            return run
        count = len(self.arm.points)
        kept = ("position", "velocity", "orientation", "angular_rate")
        arrays = {name: found[:, :count] for name in kept if (found := getattr(run, name)) is not None}
        x, v = arrays["position"].copy(), arrays["velocity"].copy()
        for place, (k, (a, b, c)) in enumerate(self._factors.items()):
            points = [k, count + 2 * place, count + 2 * place + 1]
            (x0, one, other), (v0, rate, rate_other) = (
                np.ascontiguousarray(each[:, points].T).swapaxes(0, 1)
                for each in (run.position, run.velocity)
            )
            one, other, rate, rate_other = one - x0, other - x0, rate - v0, rate_other - v0
            x[:, k] += (a * one + b * other + c * _cross(one, other)).T  # eq. (1)
            v[:, k] += (a * rate + b * rate_other + c * (_cross(rate, other) + _cross(one, rate_other))).T
        seen: dict[str, Any] = {name: read_only(each) for name, each in arrays.items()}
        return replace(run, arm=self.arm, **seen | {"position": read_only(x), "velocity": read_only(v)})


def _cross(one: Floats, other: Floats) -> Floats:
    """Return one x other of vectors of shape (3, n): faster than NumPy's."""
    (a, b, c), (d, e, f) = one, other
    return np.stack([b * f - c * e, c * d - a * f, a * e - b * d])


def _beside(arm: Arm, point: Point) -> list[Point]:
    """Return two points a metre beside a point, across its link."""
    along = np.array(getattr(arm.link(link_of(point.link)), "end", (0.0, 0.0, 1.0)))
    one = np.cross(along, np.eye(3)[np.abs(along).argmin()])
    other = np.cross(along, one)
    sides = (each / np.linalg.norm(each) for each in (one, other))
    return [
        point.replace(
            name=f"{point.name}_beside_{k}", position=tuple((np.array(point.position) + side).tolist())
        )
        for k, side in enumerate(sides)
    ]
