"""The finite steps by which an effect is probed: its variants, their sizes, and the values of none of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import exp, inf, isinf, log, pi
from typing import Any

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.effect import Effect, effect_class
from flexarm.arm.joint_units import priors_in
from flexarm.arm.prior import QUANTILE, Prior
from flexarm.diagnosis.candidate import SHAPES, SPRINGS, WAVES, value_of
from flexarm.diagnosis.problem import Problem
from flexarm.effects.joint_compliance import TYPICAL_DAMPING, TYPICAL_STIFFNESS
from flexarm.effects.link_bow import LinkBow

MULTIPLES = (1.0, 2.0, 3.0, 4.0)
"""Periods a motor turn that are probed; cycloidal and strain-wave reducers have small whole numbers."""
GROWTH = (10.0, 100.0)
"""Time constants of a growing bow that are probed [s]; one of hours grows straight in a record."""
WIDTHS = (1.0, 4.0)
"""Widths of a hysteresis loop that are probed, times its typical one."""
OF_READING, OF_NOISE = 0.1, 10.0
"""Below which 95 % of offsets are: part of the greatest reading, but at least this often the noise."""
SOFTER = (1.0, 30.0, 300.0)
"""How much softer than typical a spring is probed: once it moves a mode by itself, it is no small step."""
OF_STATED = 5.0
"""Within which 95 % of springs are as stated."""
STEP = 1.2
"""How much softer than stated a spring is probed at least, and `SOFTER` times that."""


def variants(
    name: str,
    effect: Effect,
    without: Effect | None,
    arm: Arm,
    rhythm: Sequence[float],
    softer: Sequence[float],
) -> Iterator[dict[str, float]]:
    """What is not fitted but tried, or where a fit starts."""
    if name in SPRINGS:
        stated = value_of(without, "stiffness") if without is not None else inf
        stiffness = TYPICAL_STIFFNESS if isinf(stated) else stated / STEP
        yield from ({"stiffness": stiffness / times} for times in softer)
    elif name == "transmission_error":
        yield from ({"multiple": m} for m in MULTIPLES)
    elif name == "external_vibration":
        yield from ({"frequency": f} for f in rhythm)
    elif name == "joint_hysteresis":
        width = value_of(effect, "width")
        yield from ({"width": times * width} for times in WIDTHS)
    elif isinstance(effect, LinkBow):
        straight = {
            key: value_of(effect, key) for key in effect.along(arm)
        }  # what stretches a link is no bow
        yield from ({"time_constant": t, **straight} for t in (0.0, *GROWTH))
    else:
        yield {}


def probes(
    name: str,
    effect: Effect,
    without: Effect | None,
    free: tuple[str, ...],
    null: Mapping[str, float],
    priors: Mapping[str, Prior],
) -> Iterator[Effect]:
    """One for each direction, eq. (1) of `candidate`."""
    if name in SPRINGS:
        stated = value_of(without, "stiffness") if without is not None else inf
        there = value_of(effect, "stiffness")
        rigid = isinf(stated)
        damping = TYPICAL_DAMPING * there if rigid else value_of(without, "damping") * STEP * there / stated
        yield effect.with_parameters({"stiffness": there, "damping": damping})
    elif name in WAVES:
        for phase in (0.0, pi / 2):
            yield effect.with_parameters({"phase": phase, "amplitude": priors["amplitude"].typical})
    elif name == "cable_torque":
        k = priors["stiffness"].typical
        yield effect.with_parameters({"stiffness": k, "rest_angle": 0.0})
        yield effect.with_parameters({"stiffness": k, "rest_angle": 0.5})
    elif name == "joint_hysteresis":
        yield effect.with_parameters({"torque": priors["torque"].typical})
    elif name == "motor_friction":
        for key in ("coulomb", "viscous"):
            other = {"coulomb": "viscous", "viscous": "coulomb"}[key]
            yield effect.with_parameters({key: priors[key].typical, other: 0.0})
    else:
        sized = [key for key in free if key not in SHAPES]
        for key in sized:
            rest = {other: null[other] for other in sized if other != key}
            yield effect.with_parameters({**rest, key: _probe_value(priors[key], null[key])})


def _probe_value(prior: Prior, null: float) -> float:
    """A plausible value that is not the nominal one: typical, or one sigma above."""
    if prior.typical != null:
        return prior.typical
    if prior.scale == "log":
        return exp(log(null) + (log(prior.high) - log(prior.typical)) / QUANTILE)
    return null + (prior.high - prior.typical) / QUANTILE


def offset_priors(signal: str, problem: Problem) -> dict[str, Prior]:
    """What the zero of a sensor may be off: its range is at least what it read."""
    rows = [row for row in problem.rows if row.signal == signal]
    readings = [np.abs(problem.records[row.record].signals[signal].values[:, row.channel]) for row in rows]
    most = max(float(np.nanmax(each)) for each in readings)
    high = max(OF_READING * most, OF_NOISE * max(row.sigma for row in rows))
    source = f"{100 * OF_READING:g} % of the greatest reading in the records"
    unit = problem.records[rows[0].record].signals[signal].unit
    return {"offset": Prior(-high, high, 0.0, "linear", unit, source)}


def spring_priors(spring: Effect | None, arm: Arm) -> dict[str, Prior]:
    """What a stiffness may be that the model states, if it does: near that, whatever others have."""
    if spring is None or isinf(k := value_of(spring, "stiffness")):
        return {}
    source = f"engineering judgement: data sheets and earlier fits hold to a factor of {OF_STATED:g}"
    usual = priors_in(spring, arm)["stiffness"]
    return {"stiffness": replace(usual, low=k / OF_STATED, high=k * OF_STATED, typical=k, source=source)}


def command_priors() -> dict[str, Prior]:
    """How late a command acts: its stamp is early. The mirror image of the stamps of a sensor."""
    source = "engineering judgement: a command acts where it arrives, 1 to 50 ms after it was given"
    return {"delay": Prior(-0.05, 0.02, 0.0, "linear", "s", source)}


def typical_of(name: str, at: str, arm: Arm) -> Effect:
    """An effect at typical values; some of those follow from others, hence twice."""
    kind = effect_class(name)
    required: dict[str, Any] = {
        key: 1.0 for key, field in kind.model_fields.items() if field.is_required() and key != "at"
    }
    effect = kind.model_construct(at=at, **required)
    values: dict[str, Any] = {}
    for _ in range(2):  # only at the end do the values fit together
        values = {}
        for key, prior in effect.priors(arm).items():
            field, _, axis = key.partition(".")
            values[field] = [*values.get(field, ()), prior.typical] if axis else prior.typical
        effect = kind.model_construct(at=at, **values)
    return kind.model_validate({"at": at, **values})


def nulls(effect: Effect, without: Effect | None, arm: Arm) -> dict[str, float]:
    """Value of every parameter at which the model is what it is without the effect."""
    names = [name for name, _, _ in effect.parameters()]
    if without is not None:
        return {name: value_of(without, name) for name in names}
    if effect.name == "payload_mass":
        return {"mass": arm.payload(effect.at).mass or 0.0}
    if effect.name == "payload_inertia":
        nominal = arm.payload(effect.at).inertia
        return dict.fromkeys(names, sum(nominal[:3]) / 3)
    if effect.name == "link_damping":
        return {"damping_ratio": getattr(arm.link(effect.at), "damping_ratio", None) or 0.0}
    return {name: 1.0 if name == "scale" else 0.0 for name in names}
