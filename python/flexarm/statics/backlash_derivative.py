"""Derivatives with respect to backlash at zero: which exist, and which are refused.

The gap b of a reducer can only open, so that the derivative at b = 0 is one-sided. Where the joint carries a
torque its teeth stay on the flank that they lie on, and the link's angle moves by -b/2 or b/2. Without one

    an arm that hangs     comes to rest in the middle of the opening gap, with the angle it had    (exact)
    an arm that stands    falls on a flank as soon as there is a gap; on which, nothing decides    (refused)

and in the middle of a gap a joint hardly resists, so that frequencies jump                        (refused).
What an arm does is seen from its equilibrium with the gap a little open.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.parameter import Parameter
from flexarm.errors import InvalidParameter


def require_backlash_derivative(
    arm: Arm,
    wanted: Sequence[Parameter],
    beside: Sequence[_core.Varied],
    system: _core.System,
    equilibrium: _core.Equilibrium,
    moving: _core.StateDerivative,
    at_rest: Callable[[_core.System], _core.Equilibrium],
    *,
    stiff: bool = False,
) -> None:
    """Refuse backlash at zero whose derivative does not exist.

    `beside` has models with a wanted parameter a little up and down, `moving` the derivative of the
    equilibrium, one column for each. `at_rest` gives the equilibrium of another system under the same drives
    and loads. If `stiff`, the stiffness of the joint must stay, too.

    Raise InvalidParameter if there is no derivative at a gap of zero.
    """
    alike = 0.05  # of the width of the gap: angles that differ by less are one. A flank is half a width away
    names = [joint.name for joint in arm.joints]
    for k, (parameter, pair) in enumerate(zip(wanted, beside, strict=True)):
        if not (parameter.one_sided and parameter.key.startswith("effects.backlash.")):
            continue
        joint = names.index(parameter.key.split(".")[2])

        def angle(of: _core.System, state: _core.State, joint: int = joint) -> float:
            return float(np.asarray(_core.joint_angles(of, state))[joint])

        closed = angle(system, equilibrium.state)
        opened = angle(pair.plus, at_rest(pair.plus).state) - closed
        told = angle(pair.plus, _core.moved(system, equilibrium.state, moving, k, pair.up)) - closed
        if abs(opened - told) > alike * pair.up:
            raise _refused(parameter.key, "the arm falls on one of its flanks once it opens")
        if stiff and abs(opened) <= alike * pair.up:
            raise _refused(parameter.key, "the joint hardly resists in the middle of it")


def _refused(key: str, why: str) -> InvalidParameter:
    return InvalidParameter(
        f"{key} has no derivative at a gap of zero: its joint carries no torque here, and {why}; "
        "give the gap a width, such as 1e-6",
        where="sensitivities",
    )
