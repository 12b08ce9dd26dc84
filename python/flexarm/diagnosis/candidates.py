"""Every effect at every place it can sit, with what is free in it and how it is probed.

A candidate is probed by finite steps: the model with the effect at a plausible size, one probe for each
direction in which its parameters can move the prediction,

    f(model with probe_i) - f(model without) = d_i                                                    (1)

and how much of it is there follows from least squares, measured - f ~ sum alpha_i d_i. Most laws are linear
in their amplitudes, springs in their flexibility, waves in amplitude and phase (two probes a quarter of a
turn apart); `Candidate.sized` turns the alphas into parameters that start a fit of the true, nonlinear law.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import atan2, exp, hypot, isinf, log, pi
from typing import Any

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.effect import Effect, effect_class
from flexarm.arm.link import Beam
from flexarm.arm.prior import QUANTILE, Prior
from flexarm.arm.vocabulary import KNOWN_EFFECTS
from flexarm.comparison.unknowns import drive_clock
from flexarm.diagnosis.companions import driven_joints
from flexarm.diagnosis.observed import Observed, weighed
from flexarm.effects.joint_compliance import TYPICAL_STIFFNESS, JointCompliance
from flexarm.errors import InvalidParameter

FAULTS = ("saturation", "sign_error", "unit_error", "dead_channel", "outliers")
"""Of sensors; `check` finds them before."""
LEFT_OUT = (*FAULTS, "lugre_friction", "encoder_quantisation")
"""`lugre_friction` is no name of the shared vocabulary; steps of an encoder are noise."""
ON_SPRING = ("joint_stiffening", "joint_hysteresis", "backlash")
"""Laws of the reducer's deflection, which need a joint_compliance."""
REDUCER = ("transmission_error", "gear_ratio")
"""Errors of a reducer; at a joint that nothing turns they are constant angles, and no errors."""
IN_MOTION = (
    "joint_hysteresis",
    "coulomb_friction",
    "viscous_friction",
    "payload_inertia",
    "link_damping",
    "frame_drift",
)
"""Laws of motion and time, which are zero in poses that are each an equilibrium of their own."""
WAVES = ("transmission_error", "encoder_eccentricity", "external_vibration")
SPRINGS = ("joint_compliance", "base_compliance")
POSITIVE = ("torque", "gap", "coefficient", "coulomb", "viscous", "cubic_stiffness", "damping_ratio")
"""Parameters that cannot be negative."""
MULTIPLES = (1.0, 2.0, 3.0, 4.0)
"""Periods a motor turn that are probed; cycloidal and strain-wave reducers have small whole numbers."""
GROWTH = (60.0, 600.0)
"""Time constants of a growing bow that are probed [s]."""
WIDTHS = (1.0, 4.0)
"""Widths of a hysteresis loop that are probed, times its typical one."""
OF_READING, OF_NOISE = 0.1, 10.0
"""Below which 95 % of offsets are: part of the greatest reading, but at least this often the noise."""
SOFTER = (1.0, 30.0, 300.0)
"""How much softer than typical a spring is probed: once it moves a mode by itself, it is no small step."""


@dataclass(frozen=True)
class Candidate:
    """An effect at a place, and how it may be there.

    Attributes
    ----------
    effect : Effect
        With what is not free at its value, and the rest at typical ones.
    free : tuple of str
        Parameters that are fitted.
    probes : tuple of Effect
        Of (1).
    without : Effect or None
        The nominal effect, if the model has it.
    null : dict of str to float
        Values at which the model is what it is without.
    needs : Effect or None
        What the model must have besides, and has not.
    priors : dict of str to Prior
        Those that the records state better than the effect does, which does not know them.
    """

    effect: Effect
    free: tuple[str, ...]
    probes: tuple[Effect, ...]
    null: Mapping[str, float]
    without: Effect | None = None
    needs: Effect | None = None
    priors: Mapping[str, Prior] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Of the effect."""
        return self.effect.name

    @property
    def at(self) -> str:
        """Its place."""
        return self.effect.at

    @property
    def place(self) -> tuple[str, str]:
        """Name and place: candidates of one place are variants of one effect."""
        return self.name, self.at

    def priors_in(self, arm: Arm) -> dict[str, Prior]:
        """Of all parameters in a model."""
        return {**self.effect.priors(arm), **self.priors}

    def base(self, arm: Arm) -> Arm:
        """The model that a probe differs from: with what the effect needs."""
        return arm if self.needs is None else arm.with_effect(self.needs)

    def sized(self, alphas: Sequence[float]) -> Effect:
        """The effect of the size that least squares give to its probes."""
        if self.name in SPRINGS:
            return self._spring(float(alphas[0]))
        if self.name in WAVES:
            sine, cosine = (float(a) for a in alphas)
            size = value_of(self.probes[0], "amplitude")
            return self._at(
                {"amplitude": max(hypot(sine, cosine), 1e-3) * size, "phase": atan2(cosine, sine)}
            )
        if self.name == "cable_torque":
            first, second = (float(a) for a in alphas)
            k = (first + second) * value_of(self.probes[0], "stiffness")
            size = value_of(self.probes[1], "stiffness") * value_of(self.probes[1], "rest_angle")
            return self._at({"stiffness": k, "rest_angle": second * size / k if k else 0.0})
        return self._linear(alphas)

    def _linear(self, alphas: Sequence[float]) -> Effect:
        values: dict[str, float] = {}
        for name in self.free:
            null = self.null[name]
            moves = [value_of(probe, name) - null for probe in self.probes]
            if not any(moves) or (self.name == "joint_hysteresis" and name == "width"):
                continue
            values[name] = null + sum(a * m for a, m in zip(alphas, moves, strict=True))
            if name in POSITIVE:
                values[name] = max(values[name], 0.02 * max(abs(m) for m in moves))
            elif null > 0:
                values[name] = max(values[name], 0.3 * null)
        return self._at(values)

    def _spring(self, alpha: float) -> Effect:
        soft = 1.0 / value_of(self.probes[0], "stiffness")
        there = value_of(self.without, "stiffness") if self.without is not None else float("inf")
        nominal = 0.0 if isinf(there) else 1.0 / there
        flexibility = max(nominal + alpha * (soft - nominal), 0.02 * soft)
        stiffness = 1.0 / flexibility
        return self._at({"stiffness": stiffness, "damping": 2e-3 * stiffness})

    def _at(self, values: Mapping[str, float]) -> Effect:
        return self.effect.with_parameters({k: v for k, v in values.items() if k in self.free})


def candidates(
    observed: Observed, arm: Arm, rhythm: Sequence[float] = (), softer: Sequence[float] = (1.0,)
) -> list[Candidate]:
    """All that can act on these records in a model, variants of one effect one after the other.

    Parameters
    ----------
    observed : Observed
        The records.
    arm : Arm
        The model.
    rhythm : sequence of float
        Frequencies at which the gap swings [Hz]: an external vibration may have them.
    softer : sequence of float
        How much softer than typical springs are probed, such as `SOFTER`.
    """
    found: list[Candidate] = []
    poses = all(record.kind == "static" for record in observed.records.values())
    for name in KNOWN_EFFECTS:
        if name in LEFT_OUT or (poses and name in IN_MOTION):
            continue
        for at in _places(name, observed, arm):
            stated = _offsets(at, observed) if name == "sensor_offset" else {}
            found += _at_place(name, at, arm, rhythm, softer, stated)
    return [_of_poses(candidate) for candidate in found] if poses else found


def _of_poses(candidate: Candidate) -> Candidate:
    """Without what poses cannot show: the damping of a spring."""
    return replace(candidate, free=tuple(key for key in candidate.free if key != "damping"))


def _at_place(
    name: str,
    at: str,
    arm: Arm,
    rhythm: Sequence[float],
    softer: Sequence[float],
    stated: Mapping[str, Prior],
) -> Iterator[Candidate]:
    """Variants of an effect at a place; none where the model refuses it."""
    without = arm.effect(name, at)
    needs: Effect | None = None
    if name == "external_vibration":
        base = arm.effect("base_compliance", at)
        if base is None or isinf(value_of(base, "stiffness")):
            needs = typical_of("base_compliance", at, arm)
    if name in ON_SPRING:
        spring = arm.effect("joint_compliance", at)
        if spring is None or isinf(value_of(spring, "stiffness")):
            needs = JointCompliance(at=at, stiffness=TYPICAL_STIFFNESS, damping=2e-3 * TYPICAL_STIFFNESS)
    there = arm if needs is None else arm.with_effect(needs)
    typical = without if without is not None and name not in SPRINGS else typical_of(name, at, there)
    for fixed in _variants(name, typical, rhythm, softer if without is None else ()):
        effect = typical.with_parameters(fixed)
        held = {*fixed} - {"width", "frequency", "stiffness"}
        priors = {**effect.priors(there), **stated}
        free = tuple(key for key in priors if key not in held and _has(effect, key))
        null = nulls(effect, without, arm)
        probes = tuple(_probes(name, effect, without, free, null, priors))
        try:
            for probe in probes:
                there.with_effect(probe)
        except InvalidParameter:
            continue
        if probes:
            yield Candidate(effect, free, probes, null, without, needs, stated)


def _variants(
    name: str, effect: Effect, rhythm: Sequence[float], softer: Sequence[float]
) -> Iterator[dict[str, float]]:
    """What is not fitted but tried, or where a fit starts."""
    if name in SPRINGS and softer:
        yield from ({"stiffness": TYPICAL_STIFFNESS / times} for times in softer)
    elif name == "transmission_error":
        yield from ({"multiple": m} for m in MULTIPLES)
    elif name == "external_vibration":
        yield from ({"frequency": f} for f in rhythm)
    elif name == "joint_hysteresis":
        width = value_of(effect, "width")
        yield from ({"width": times * width} for times in WIDTHS)
    elif name == "link_bow":
        yield {"time_constant": 0.0}
        yield from ({"time_constant": t} for t in GROWTH)
    else:
        yield {}


def _probes(
    name: str,
    effect: Effect,
    without: Effect | None,
    free: tuple[str, ...],
    null: Mapping[str, float],
    priors: Mapping[str, Prior],
) -> Iterator[Effect]:
    """One for each direction; see the head of this file."""
    if name in SPRINGS:
        stiffness = value_of(without, "stiffness") if without is not None else float("inf")
        there = value_of(effect, "stiffness") if isinf(stiffness) else stiffness / 1.2
        damping = 2e-3 * there if isinf(stiffness) or without is None else value_of(without, "damping")
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
        for key in free:
            rest = {other: null[other] for other in free if other != key}
            yield effect.with_parameters({**rest, key: _probe_value(priors[key], null[key])})


def _offsets(signal: str, observed: Observed) -> dict[str, Prior]:
    """What the zero of a sensor may be off: its range is at least what it read."""
    rows = [row for row in observed.rows if row.signal == signal]
    readings = [np.abs(observed.records[row.record].signals[signal].values[:, row.channel]) for row in rows]
    most = max(float(np.nanmax(each)) for each in readings)
    high = max(OF_READING * most, OF_NOISE * max(row.sigma for row in rows))
    source = f"{100 * OF_READING:g} % of the greatest reading in the records"
    return {"offset": Prior(-high, high, 0.0, "linear", "SI", source)}


def _probe_value(prior: Prior, null: float) -> float:
    """A plausible value that is not the nominal one: typical, or one sigma above."""
    if prior.typical != null:
        return prior.typical
    if prior.scale == "log":
        return exp(log(null) + (log(prior.high) - log(prior.typical)) / QUANTILE)
    return null + (prior.high - prior.typical) / QUANTILE


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


def _places(name: str, observed: Observed, arm: Arm) -> list[str]:
    """Where an effect can act and be seen."""
    place = KNOWN_EFFECTS[name]
    records = observed.records.values()
    evidence = dict.fromkeys((row.record, row.signal) for row in observed.rows)
    signals = [observed.records[record].signals[signal] for record, signal in evidence]
    if place == "joint":
        joints = [joint.name for joint in arm.joints if joint.moves]
        if name == "motor_friction":
            torque = {s.joint for s in signals if s.quantity == "motor_torque"}
            return [joint for joint in joints if joint in torque]
        turned = driven_joints(arm, records)
        return [joint for joint in joints if name not in REDUCER or joint in turned]
    if place == "payload":
        key = "payload_mass" if name == "payload_mass" else ""
        return [
            load.name
            for load in arm.payloads
            if not key or not all(weighed(r, f"effects.{key}.{load.name}.mass") for r in records)
        ]
    if place == "link":
        return [link.name for link in arm.links if isinstance(link, Beam)]
    if place == "base":
        return ["base"]
    if place == "point":
        return list(dict.fromkeys(s.point for s in signals if s.point is not None))
    if place == "frame":
        seen = [s.frame for s in signals if s.quantity in ("position", "orientation")]
        return [frame for frame in dict.fromkeys(seen) if frame != "base"]
    if place == "signal or clock":
        return _late(name, observed)
    if name == "sensor_offset":
        return list(dict.fromkeys(s.name for s in signals if s.quantity not in ("position", "orientation")))
    drives = {d: r.signals[d] for r in records for d in r.drive}
    return [d for d, s in drives.items() if s.quantity == "joint_angle"]


def _late(name: str, observed: Observed) -> list[str]:
    """Clocks but the drives', and signals of a clock that has several."""
    clocks: dict[str, set[str]] = {}
    for row in observed.rows:
        record = observed.records[row.record]
        if record.kind == "motion":
            clocks.setdefault(record.signals[row.signal].clock, set()).add(row.signal)
    own = {drive_clock(record) for record in observed.records.values()}
    found = [clock for clock in clocks if clock not in own]
    for clock, names in clocks.items():
        if clock in own or len(names) > 1:
            found += [signal for signal in sorted(names) if signal not in found]
    return found


def value_of(effect: Effect | None, key: str) -> float:
    """A parameter, as `Effect.parameters` spells it."""
    field, _, axis = key.partition(".")
    found = getattr(effect, field)
    return float(found["xyz".index(axis)] if axis else found)


def _has(effect: Effect, key: str) -> bool:
    """Whether a parameter is a number of the effect."""
    field, _, axis = key.partition(".")
    found = getattr(effect, field, None)
    return found is not None and (not axis or len(found) > "xyz".index(axis))


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
