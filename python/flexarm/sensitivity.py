"""Derivatives of runs and equilibria with respect to parameters of the model.

The core differentiates every step; it takes two models for each parameter, one with a little more of it and
one with a little less (`flexarm.arm.parameter`), and what moves them where the drive depends on it.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from flexarm import _core
from flexarm.arguments import takes
from flexarm.arm import Arm
from flexarm.arm.drive_effect import DriveEffect, lags_between
from flexarm.arm.joint import Gear, gear_input
from flexarm.arm.parameter import Parameter, neighbours, parameters, path_of
from flexarm.arm.sensor_effect import ClockEffect, FrameEffect, SignalEffect
from flexarm.arrays import Floats, frozen, read_only
from flexarm.assembly import following_joints, loops_of
from flexarm.errors import InvalidParameter
from flexarm.tables import Table

if TYPE_CHECKING:
    import xarray as xr

    from flexarm.netcdf import Contents, Variable

Motions = list[_core.PiecewisePolynomial]

_CLOSED = 1e-9
"""Joints of loops that are closed alike differ by less [rad, m]."""


@dataclass(frozen=True, eq=False, repr=False)
class Sensitivities:
    """Derivatives of a result's arrays by parameters of its model.

    Attributes
    ----------
    parameters : tuple of Parameter
        By what was differentiated.
    arrays : dict of str to ndarray
        Under the name of each array its derivatives: its shape and, as last axis, the parameter. Units are
        the array's over the parameter's.

    Examples
    --------
    >>> run.sensitivities["position"][:, 0, :, 1]  # of point 0 by parameter 1  # doctest: +SKIP
    >>> run.sensitivities.by("payloads.load.mass")["position"]  # m/kg  # doctest: +SKIP
    """

    parameters: tuple[Parameter, ...]
    arrays: Mapping[str, Floats]

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys of the parameters, in the order of the last axis."""
        return tuple(parameter.key for parameter in self.parameters)

    def __getitem__(self, name: str) -> Floats:
        """Return derivatives of the array of that name."""
        if name not in self.arrays:
            raise InvalidParameter(f"no derivatives of {name!r}; there are those of {', '.join(self.arrays)}")
        return self.arrays[name]

    @takes()
    def by(self, key: str) -> dict[str, Floats]:
        """Return derivatives of every array with respect to one parameter.

        Raises
        ------
        InvalidParameter
            If there are none by it.
        """
        if key not in self.keys:
            raise InvalidParameter(
                f"no derivative by {key!r} was computed; there are {', '.join(self.keys) or 'none'}"
            )
        k = self.keys.index(key)
        return {name: array[..., k] for name, array in self.arrays.items()}

    def add_to(self, contents: Contents) -> Contents:
        """Return the contents of the result's file with the derivatives: d_NAME beside NAME."""
        derivatives: dict[str, Variable] = {
            f"d_{name}": (
                (*contents.variables[name][0], "parameter"),
                array,
                {"long_name": f"derivative of {name}"},
            )
            for name, array in self.arrays.items()
        }
        units: Variable = (("parameter",), [p.unit for p in self.parameters], {})
        return replace(
            contents,
            variables={**contents.variables, **derivatives, "parameter_unit": units},
            labels={**contents.labels, "parameter": self.keys},
        )

    @classmethod
    def stored(cls, arm: Arm, data: xr.Dataset) -> Sensitivities | None:
        """Return the derivatives that `add_to` put into a file; None without any."""
        if "parameter" not in data.coords:
            return None
        arrays = {
            str(name)[2:]: frozen(data[name].values) for name in data.data_vars if str(name).startswith("d_")
        }
        return cls(parameters(arm, [str(key) for key in data["parameter"].values]), arrays)

    def __repr__(self) -> str:
        return f"<Sensitivities of {', '.join(self.arrays)} to {', '.join(self.keys) or 'nothing'}>"


def moves_arm(arm: Arm, parameter: Parameter) -> bool:
    """Return True if a parameter belongs to the mechanics, False if it changes sensors or drives only."""
    return not isinstance(entry_of(arm, parameter), SignalEffect | ClockEffect | FrameEffect | DriveEffect)


def entry_of(arm: Arm, parameter: Parameter) -> Table:
    """Return the link, payload, effect ... to which a parameter belongs."""
    path = path_of(arm, parameter.key)
    found: Table = getattr(arm, path.table)[path.index]
    return found


@dataclass(frozen=True)
class Redrive:
    """Drive of an arm, given other effects on sensors of a record, on how joints follow, and other gears."""

    places: Collection[str]
    """Signals that drive and their clocks."""
    motions: Callable[[Arm], Motions]
    """Motions of an arm's joints."""
    joints: Collection[str] = ()
    """Joints whose drives may follow late, or move them through gears."""

    def changes_with(self, arm: Arm, parameter: Parameter) -> bool:
        """Return True if a parameter changes the motions."""
        entry = entry_of(arm, parameter)
        if isinstance(entry, Gear):
            return any(gear_input(arm, joint) != joint for joint in self.joints)
        if isinstance(entry, DriveEffect):
            return any(entry in lags_between(arm, joint) for joint in self.joints)
        return isinstance(entry, SignalEffect | ClockEffect | FrameEffect) and entry.at in self.places


def varied(
    arm: Arm,
    wanted: Sequence[Parameter],
    assembled: Callable[[Arm], _core.System],
    redrive: Redrive | None = None,
    *,
    driven: Collection[str] = (),
) -> tuple[list[_core.Varied], list[int]]:
    """Return the perturbed models of which the core takes derivatives, and their places among the parameters.

    There is one for each parameter that moves the arm or, with `redrive` of a run along a record, its drives.
    `driven` are the joints that are told where to be.

    Raise InvalidParameter if a loop does not close with a parameter a little changed, or another joint than
    `driven` is held in it where the parameter puts it.
    """
    found, places = [], []
    nominal = assembled(arm) if arm.closures and wanted else None
    for k, parameter in enumerate(wanted):
        moves = moves_arm(arm, parameter)
        drives = redrive is not None and redrive.changes_with(arm, parameter)
        if not moves and not drives:
            continue
        (above, up), (below, down) = neighbours(arm, parameter)
        try:
            plus, minus = (assembled(above), assembled(below)) if moves else [assembled(arm)] * 2
            if nominal is not None:
                _require_standing_joints(arm, driven, plus, minus)
                plus.count_closures_as(nominal)
                minus.count_closures_as(nominal)
        except InvalidParameter as error:
            raise InvalidParameter(f"has no derivative here: {error}", where=parameter.key) from error
        motions: list[Motions] = []
        if redrive is not None and drives:
            motions = [redrive.motions(above), redrive.motions(below)]
        found.append(_core.Varied(plus, minus, up, down, *motions))
        places.append(k)
    return found, places


def closes(arm: Arm, parameter: Parameter) -> bool:
    """Return False if a parameter a little changed opens a loop, as a place across a flat one does."""
    if not arm.closures:
        return True
    try:
        for other, _ in neighbours(arm, parameter):
            loops_of(other)
    except InvalidParameter:
        return False
    return True


def _require_standing_joints(
    arm: Arm, driven: Collection[str], plus: _core.System, minus: _core.System
) -> None:
    """Refuse a parameter that moves a joint of a loop which is held where the loop was closed first."""
    follow = {*following_joints(arm, (), driven), *driven, *(gear_input(arm, name) for name in driven)}
    for k, joint in enumerate(arm.joints):
        stands = joint.name in loops_of(arm).assembled and joint.name not in follow
        if stands and abs(plus.assembled[k] - minus.assembled[k]) > _CLOSED:
            raise InvalidParameter(
                f"it moves {joint.name!r}, which is held where its loop was closed first; drive that joint, "
                "or say in [assembly] where it stands"
            )


def collected(
    wanted: tuple[Parameter, ...], places: Sequence[int], arrays: Mapping[str, Floats]
) -> Sensitivities:
    """Return derivatives with respect to all wanted parameters, zero for those that move nothing.

    The arrays have the places of those that do as last axis; they are used as they are where all have theirs.
    """
    if list(places) == list(range(len(wanted))):
        return Sensitivities(wanted, {name: read_only(array) for name, array in arrays.items()})
    whole = {}
    for name, derivatives in arrays.items():
        array = np.zeros((*derivatives.shape[:-1], len(wanted)))
        array[..., places] = derivatives
        whole[name] = read_only(array)
    return Sensitivities(wanted, whole)
