"""Motors at their torque limit that do not follow their commands."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from flexarm.control.actuator import actuator_of
from flexarm.control.dual import value_of
from flexarm.errors import Problem
from flexarm.simulation.simulation import Simulation


def limited_motors(run: Simulation) -> Iterable[Problem]:
    """Yield motors that end a run at their torque limit and away from their command.

    Away is a tenth of a radian or metre, or of the range of commands where that is less.
    """
    if run.joint_command is None:
        return
    for controller in run.arm.controllers:
        k = run.joints.index(controller.joint)
        command, torque = run.joint_command[:, k], np.abs(run.motor_torque[:, k])
        limit = value_of(actuator_of(run.arm, controller).greatest_torque)
        error = float(abs(command[-1] - run.drive_angle[-1, k]))
        if (
            np.isnan(error)
            or torque[-1] < 0.99 * limit
            or error < 0.1 * min(1.0, float(np.ptp(command)) or 1.0)
        ):
            continue
        slides = run.arm.joint(controller.joint).type == "prismatic"
        length, force = ("m", "N") if slides else ("rad", "N m")
        share = float(np.mean(torque >= 0.99 * limit))
        yield Problem(
            f"controllers.{controller.joint}",
            f"is at its torque limit of {limit:.4g} {force} for {share:.0%} of the run, and ends {error:.3g} "
            f"{length} from its command; is the limit that of the machine?",
        )
