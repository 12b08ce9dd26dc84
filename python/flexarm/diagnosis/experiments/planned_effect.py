"""An effect at a place, as a plan tells it: its size, the smallest one that is seen, or why none is."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf, sqrt
from typing import TYPE_CHECKING

from flexarm.arm.joint_units import parameters_in
from flexarm.diagnosis.candidates.candidate import SPRINGS, value_of
from flexarm.diagnosis.choosing.acceptance import STRONG
from flexarm.diagnosis.experiments.plan_result import FAR, PlannedEffect

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.arm.effect import Effect
    from flexarm.diagnosis.candidates.candidate import Candidate
    from flexarm.diagnosis.experiments.separation import Shown

NOTHING = 1e-3
"""Expected ln Bayes factor below which an effect leaves no trace in the signals."""
TORQUES = ("coulomb_friction", "viscous_friction", "lugre_friction", "motor_friction", "cable_torque")
"""Laws that are a torque at a joint."""


def planned_effect(
    candidate: Candidate, shown: Shown, seen: float, arm: Arm, signals: Mapping[str, str]
) -> PlannedEffect:
    """An effect as it is shown, and the smallest one that is seen.

    Parameters
    ----------
    candidate : Candidate
        The effect.
    shown : Shown
        At which size it is shown.
    seen : float
        Expected ln Bayes factor over no effect at that size; eq. (2) of `separation`.
    arm : Arm
        The nominal model.
    signals : dict of str to str
        Units of signals, for effects that have that of their signal.
    """
    size = candidate.probes[shown.probe]
    own = signals.get(candidate.at, "")
    units = {name: own if unit == "SI" else unit for name, _, unit in parameters_in(size, arm)}
    name = _parameter(candidate, size)
    value, null = value_of(size, name), candidate.null.get(name, 0.0)
    times = sqrt(STRONG / seen) if seen > 0 else inf
    if candidate.name in SPRINGS:
        there = value_of(candidate.without, "stiffness") if candidate.without is not None else inf
        change = 1.0 / value - 1.0 / there
        least = 1.0 / (1.0 / there + times * change)
    else:
        there, least = null, null + times * (value - null)
    why = hidden(arm, *candidate.place, seen)
    return PlannedEffect(*candidate.place, name, units[name], value, there, least, seen, why)


def hidden(arm: Arm, name: str, at: str, seen: float) -> str:
    """Why an effect is not seen at any plausible size; empty where it is.

    A torque on a joint that cannot give way is taken by the drive.
    """
    if name in TORQUES and seen < NOTHING and arm.effect("joint_compliance", at) is None:
        return f"{at} is rigid in the model: its drive takes the torque, which no sensor shows"
    if not seen > 0:
        return "it moves nothing that is measured"
    return f"not seen at {FAR:g} times that size either" if FAR**2 * seen < STRONG else ""


def _parameter(candidate: Candidate, size: Effect) -> str:
    """The parameter that says how large an effect is: the one that differs most from none."""
    moved = {
        name: abs(value_of(size, name) - candidate.null.get(name, 0.0))
        for name in candidate.free
        if name not in ("phase", "frequency", "width", "damping", "time_constant", "multiple")
    }
    names = [name for name, move in moved.items() if move > 0]
    return names[0] if names else candidate.free[0]
