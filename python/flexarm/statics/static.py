"""The equilibrium of an arm under gravity and forces, its drives held."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from flexarm import _core
from flexarm.arguments import NAMES, VECTORS, takes
from flexarm.arm import Arm
from flexarm.arrays import Floats, frozen
from flexarm.assembly import assemble
from flexarm.statics.batch import StaticsBatch, positions
from flexarm.statics.part_shape import PartShape
from flexarm.statics.statics import Statics


@takes(forces=VECTORS, at_link=NAMES)
def static(
    arm: Arm,
    joints: Mapping[str, float] | None = None,
    forces: Mapping[str, ArrayLike] | None = None,
    *,
    at_link: Collection[str] = (),
    sensitivities: Iterable[str] = (),
) -> Statics:
    """Return the equilibrium under gravity and point forces, the joints' drives held.

    Parameters
    ----------
    arm : Arm
        The model, with its effects.
    joints : dict of str to float, optional
        Drive angles, output side [rad, m for a prismatic joint]; default 0. Joints of loops that are not
        here follow, see `flexarm.assembly.loops`.
    forces : dict of str to (3,), optional
        Forces at points, base axes [N].
    at_link : collection of str
        Joints whose angle in `joints` is the link's, as an encoder behind the reducer gives it. What their
        motor's own angle must then be is not computed: `drive_angle` is the link's.
    sensitivities : iterable of str
        Keys of parameters by which the arrays are differentiated, as in `simulate`.

    Raises
    ------
    InvalidParameter
        If a joint or point does not exist.
    NotConverged
        If there is no stable equilibrium; the message says at what part of the load the arm buckles.

    Examples
    --------
    >>> flexarm.static(arm, joints={"hinge": 0.5}).displacement  # doctest: +SKIP
    """
    held = StaticsBatch(arm, at_link, forces or (), sensitivities, driven=tuple(joints or ()))
    found = held.at(joints or {}, forces)
    names = [link.name for link in arm.links if link.type == "superelement"]
    state = found.equilibrium.state
    shapes = (held.system.part_shape(state, i) for i in range(len(names)))
    return Statics(
        arm=arm,
        displacement=frozen(
            found.arrays["position"] - _rigid(arm, held.system, found.values, tuple(joints or ()))
        ),
        drive_angle=frozen(found.values),
        **{name: frozen(array) for name, array in found.arrays.items()},
        solver={
            "backend": _core.build_info().solver,
            "iterations": found.equilibrium.iterations,
            "load_steps": found.equilibrium.load_steps,
            "residual_N": found.equilibrium.residual,
            **(_loops_told(arm, held.system, state) if arm.closures else {}),
        },
        parts={
            name: PartShape(frozen(frame.R), frozen(frame.x), frozen(freedoms))
            for name, (frame, freedoms) in zip(names, shapes, strict=True)
        },
        force=frozen([np.asarray(forces.get(each.name, np.zeros(3)), dtype=float) for each in arm.points])
        if forces
        else None,
        at_link=tuple(at_link),
        sensitivities=found.sensitivities,
        closure_force=frozen([_core.closure_force(held.system, state, i) for i in range(len(arm.closures))])
        if arm.closures
        else None,
        driven=tuple(joints or ()),
    )


def _loops_told(arm: Arm, system: _core.System, state: _core.State) -> dict[str, Any]:
    """Return what the conditions of the loops do not tell: how many repeat others, and whose forces."""
    rounding = 1e-9  # of unit multipliers, N and N m
    forces = [f"{what} {axis}" for what in ("force", "moment") for axis in "xyz"]
    open_forces = [
        f"{closure.name} {force}"
        for i, closure in enumerate(arm.closures)
        for force, change in zip(forces, _core.closure_indeterminacy(system, state, i), strict=True)
        if change > rounding
    ]
    return {"redundant_conditions": system.redundant, "indeterminate_forces": ", ".join(open_forces)}


def _rigid(arm: Arm, system: _core.System, values: list[float], driven: Collection[str]) -> Floats:
    """Return the points of the rigid arm without effects: what effects move counts as displacement."""
    if not arm.effects:
        return positions(system, system.rigid_state(values), len(arm.points))
    plain = assemble(arm, driven=driven, nominal=True)
    return positions(plain, plain.rigid_state(values), len(arm.points))
