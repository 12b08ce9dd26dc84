"""A batch of statics: one arm, its drives held, assembled once and solved at several poses.

The assembled system depends on the model, on the loaded points and on the joints that are held behind their
reducers, not on angles and forces. So all poses of one arm share it, and the perturbed models of which
derivatives with respect to parameters are made.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.joint import Gear, gear_input
from flexarm.arm.parameter import Parameter, neighbours, parameters
from flexarm.arrays import Floats
from flexarm.assembly import assemble, following_joints, joint_values, point_loads
from flexarm.sensitivity import Sensitivities, collected, entry_of, varied
from flexarm.statics.backlash_derivative import require_backlash_derivative

SEEN = ("position", "rotation", "link_angle", "joint_torque", "section_forces", "base_wrench")
"""Arrays of an equilibrium."""


@dataclass(frozen=True, eq=False)
class StaticSolution:
    """One equilibrium of a `StaticsBatch`."""

    values: list[float]
    """Angle of every joint's drive [rad, m]."""
    equilibrium: _core.Equilibrium
    arrays: dict[str, Floats]
    """What is seen of it: `position`, `rotation`, `joint_torque`, `link_angle`, `section_forces` and
    `base_wrench`, as in `Statics`."""
    sensitivities: Sensitivities | None
    """Derivatives of the arrays, and of `drive_angle`, where they were asked for."""


@dataclass(frozen=True)
class DriveVariation:
    """A change of the drive angles by a parameter, such as the offset of an encoder.

    Angles of all joints [rad, m] in the order of the model are those with a little more of it, by `up`, and a
    little less, by negative `down`.
    """

    above: Sequence[float]
    up: float
    below: Sequence[float]
    down: float


class StaticsBatch:
    """Equilibria of an arm with its drives held, and derivatives of the `differentiated` arrays.

    `at_link` are joints whose angle is the link's, `loaded` points that carry forces, `sensitivities` keys of
    parameters, `turned` joints whose drives parameters turn (the others are locked), and `driven` joints of
    loops that are held; the others of loops follow. Raise InvalidParameter if there is no derivative by a
    parameter.
    """

    def __init__(
        self,
        arm: Arm,
        at_link: Collection[str] = (),
        loaded: Iterable[str] = (),
        sensitivities: Iterable[str] = (),
        turned: Collection[str] = (),
        differentiated: Collection[str] = SEEN,
        driven: Collection[str] = (),
    ) -> None:
        self.parameters: tuple[Parameter, ...] = parameters(arm, sensitivities)
        self._ratios = [each for each in self.parameters if isinstance(entry_of(arm, each), Gear)]
        geared = [gear.input for gear in arm.gears] if self._ratios else []
        held = {gear_input(arm, name): _core.DriveKind.motor_angle for name in (*turned, *geared)}
        held |= {name: _core.DriveKind.link_angle for name in at_link}
        points = tuple(loaded)
        self.arm, self.differentiated = arm, tuple(differentiated)
        self.system = assemble(arm, held, points, driven)
        self._following = following_joints(arm, held, driven)
        self._beside, self._places = varied(
            arm,
            self.parameters,
            lambda other: assemble(other, held, points, driven),
            driven={*held, *driven},
        )

    def at(
        self,
        joints: Mapping[str, float],
        forces: Mapping[str, ArrayLike] | None = None,
        turning: Mapping[str, DriveVariation] | None = None,
    ) -> StaticSolution:
        """Return the equilibrium under gravity and point forces, the drives at given angles.

        Angles [rad, m for a prismatic joint] are 0 by default; forces [N] have base axes; `turning` holds, by
        key, those parameters that turn the drives.

        Raise InvalidParameter if a joint or point does not exist, NotConverged if there is no stable
        equilibrium.
        """
        values = joint_values(self.arm, joints)
        loads = _core.Loads(gravity=np.array(self.arm.gravity), points=point_loads(self.arm, forces or {}))
        equilibrium = _core.static_equilibrium(self.system, values, loads)
        arrays = _seen(self.arm, self.system, equilibrium.state, loads, SEEN)
        if self._following:
            values = [
                float(arrays["link_angle"][i]) if joint.name in self._following else values[i]
                for i, joint in enumerate(self.arm.joints)
            ]
        if not self.parameters:
            return StaticSolution(values, equilibrium, arrays, None)
        turned = {**self._turned_through_gears(joints), **(turning or {})}
        slopes = self._slopes(values, equilibrium, arrays, loads, turned)
        slopes["drive_angle"] = self._drive_slopes(turned)
        return StaticSolution(values, equilibrium, arrays, Sensitivities(self.parameters, slopes))

    def _slopes(
        self,
        values: list[float],
        equilibrium: _core.Equilibrium,
        arrays: Mapping[str, Floats],
        loads: _core.Loads,
        turning: Mapping[str, DriveVariation],
    ) -> dict[str, Floats]:
        """Return derivatives of the arrays along the derivative of the state."""
        state, keys = equilibrium.state, [parameter.key for parameter in self.parameters]
        models = dict(zip(self._places, self._beside, strict=True))
        turned = {keys.index(key): each for key, each in turning.items()}
        places = sorted({*models, *turned})
        beside = [self._varied(models.get(place), turned.get(place)) for place in places]
        moving = _core.static_derivative(self.system, equilibrium, beside)
        require_backlash_derivative(
            self.arm,
            [self.parameters[place] for place in places],
            beside,
            self.system,
            equilibrium,
            moving,
            lambda other: _core.static_equilibrium(other, values, loads),
        )
        found = {name: np.zeros((*arrays[name].shape, len(beside))) for name in self.differentiated}
        for k, pair in enumerate(beside):
            up, down = (
                _seen(
                    self.arm,
                    system,
                    _core.moved(self.system, state, moving, k, change),
                    loads,
                    self.differentiated,
                )
                for system, change in ((pair.plus, pair.up), (pair.minus, pair.down))
            )
            for name, array in up.items():
                found[name][..., k] = (array - down[name]) / (pair.up - pair.down)
        return dict(collected(self.parameters, places, found).arrays)

    def _turned_through_gears(self, joints: Mapping[str, float]) -> dict[str, DriveVariation]:
        """Return, by key, what ratios of gears make of the angles of drives that name their outputs."""
        found = {}
        for parameter in self._ratios:
            (above, up), (below, down) = neighbours(self.arm, parameter)
            sides = [joint_values(other, joints) for other in (above, below)]
            found[parameter.key] = DriveVariation(sides[0], up, sides[1], down)
        return found

    def _varied(self, models: _core.Varied | None, turning: DriveVariation | None) -> _core.Varied:
        """Return models with a parameter changed, or this one, with their drives at the angles it makes."""
        if turning is None:
            assert models is not None
            return models
        plus, minus = (self.system, self.system) if models is None else (models.plus, models.minus)
        sides = [
            [_core.PiecewisePolynomial.constant(value) for value in values]
            for values in (turning.above, turning.below)
        ]
        return _core.Varied(plus, minus, turning.up, turning.down, *sides)

    def _drive_slopes(self, turning: Mapping[str, DriveVariation]) -> Floats:
        """Return derivatives of the drives' angles, shape (joint, parameter)."""
        found = np.zeros((len(self.arm.joints), len(self.parameters)))
        for k, parameter in enumerate(self.parameters):
            if (each := turning.get(parameter.key)) is not None:
                found[:, k] = np.subtract(each.above, each.below) / (each.up - each.down)
        return found


def positions(system: _core.System, state: _core.State, count: int) -> Floats:
    """Return places of the first `count` points [m], shape (count, 3)."""
    return np.array([system.point_frame(state, i).x for i in range(count)]).reshape(count, 3)


def _seen(
    arm: Arm, system: _core.System, state: _core.State, loads: _core.Loads, names: Collection[str]
) -> dict[str, Floats]:
    """Return the observed arrays of a state, by their names."""
    count = len(arm.points)
    made: dict[str, Callable[[], Floats]] = {
        "position": lambda: positions(system, state, count),
        "rotation": lambda: np.array([system.point_frame(state, i).R for i in range(count)]).reshape(
            count, 3, 3
        ),
        "link_angle": lambda: np.array(_core.joint_angles(system, state)),
        "joint_torque": lambda: np.array(
            [_core.joint_torque(system, state, i) for i in range(len(arm.joints))]
        ),
        "section_forces": lambda: _ends(arm, system, state, loads),
        "base_wrench": lambda: np.array(_core.base_wrench(system, state)),
    }
    return {name: made[name]() for name in names}


def _ends(arm: Arm, system: _core.System, state: _core.State, loads: _core.Loads) -> Floats:
    """Return section forces at both ends, shape (link, 2, 6); NaN for links without sections."""
    found = np.full((len(arm.links), 2, 6), np.nan)
    for i, link in enumerate(arm.links):
        if link.type == "beam":
            forces = _core.section_forces(system, state, loads, i)
            found[i] = forces.start, forces.end
    return found
