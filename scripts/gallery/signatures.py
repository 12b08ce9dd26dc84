"""The signature of an effect: its gap in every experiment, by parameter.

An effect starts at its typical values, or at the model's own where the model has it. Where these leave a gap,
that is what is shown, and what a parameter adds to it when it is one sigma higher is its column. Where they
leave none (an offset whose typical value is zero, a payload that weighs what it should) columns are the gaps
of parameters one sigma higher, and the first with the greatest gap of the tip in the arm's plane (to
10 %) is shown.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import exp, log

import numpy as np

from flexarm import Arm, InvalidParameter
from flexarm.arm.effect import Effect, effect_class
from flexarm.arm.prior import QUANTILE, Prior
from flexarm.arm.sensor_effect import SignalEffect
from flexarm.arm.vocabulary import ANYWHERE, KNOWN_EFFECTS
from gallery.experiments import ENCODER, EXPERIMENTS, FAST, JOINT, LINK, NOISE, PAYLOAD, TRACKER, Experiment
from gallery.gaps import Gap, bench

NEEDED = {
    "external_vibration": "base_compliance",
    "joint_radial_clearance": "joint_radial_compliance",
}
"""Effects that the model without the effect must have, at the same place, so that it can act."""
AT = {
    "joint": JOINT,
    "payload": PAYLOAD,
    "link": LINK,
    "base": "base",
    ANYWHERE: JOINT,
    "point": "tip",
    "signal or clock": TRACKER,
    "frame": TRACKER,
}
IN_PLANE = [0, 2]
"""Columns of a position in which the arm moves."""
SEEN = 0.02
"""Greatest part of the noise at which a gap counts as none."""


@dataclass(frozen=True)
class Shown:
    """An effect with values, and the gaps that it leaves."""

    effect: Effect
    gaps: Mapping[Experiment, Gap]


@dataclass(frozen=True)
class Signature:
    """What an effect does to the bench.

    Attributes
    ----------
    name : str
        Of the effect.
    model : Arm
        The model without it.
    start : Effect
        The effect where its parameters start.
    shown : Shown
        What pictures and shares are of.
    parameter : str or None
        Which parameter of `shown` is one sigma above its start; None: none is.
    columns : dict of str to (dict of Experiment to Gap)
        Gaps of the effect as a whole ("") and of its parameters.
    """

    name: str
    model: Arm
    start: Effect
    shown: Shown
    parameter: str | None
    columns: Mapping[str, Mapping[Experiment, Gap]]


def names() -> list[str]:
    """Every effect of the vocabulary that can be simulated, in its order."""
    found = []
    for name in KNOWN_EFFECTS:
        try:
            effect_class(name)
        except InvalidParameter:
            continue
        found.append(name)
    return found


def place(name: str) -> str:
    """Where an effect acts on the bench: an encoder's at the encoder, other sensors' at the tip."""
    kind = effect_class(name)
    if kind.place == "signal":
        assert issubclass(kind, SignalEffect)
        return ENCODER if "joint_angle" in kind.quantities else "tip"
    return AT[kind.place]


def model_for(name: str, arm: Arm) -> Arm:
    """The model without the effect, and with what the effect needs."""
    return arm.with_effect(typical(NEEDED[name], arm)) if name in NEEDED else arm


def typical(name: str, arm: Arm) -> Effect:
    """An effect at its typical values."""
    return effect_class(name).typical(place(name), arm)


def start_of(name: str, model: Arm) -> Effect:
    """The model's own effect, else one at typical values."""
    return model.effect(name, place(name)) or typical(name, model)


def one_sigma(value: float, prior: Prior, sign: int = 1) -> float:
    """A value one sigma of its prior higher; a quarter of the range where nothing is known of it."""
    if prior.scale == "uniform":
        return value + sign * (prior.high - prior.low) / 4
    if prior.scale == "log":
        return exp(log(value) + sign * (log(prior.high) - log(prior.typical)) / QUANTILE)
    return value + sign * (prior.high - prior.typical) / QUANTILE


def moved(effect: Effect, arm: Arm, parameter: str) -> Effect:
    """The effect with one parameter one sigma higher, or lower where higher is not allowed."""
    prior = effect.priors(arm)[parameter]
    value = {name: value for name, value, _ in effect.parameters()}[parameter]
    try:
        return acting(effect.with_parameters({parameter: one_sigma(value, prior)}), arm)
    except InvalidParameter:
        return effect.with_parameters({parameter: one_sigma(value, prior, -1)})


def acting(effect: Effect, arm: Arm) -> Effect:
    """The effect, if an arm can have it with these values; else an error."""
    arm.with_effect(effect)
    return effect


def gaps_of(effect: Effect, model: Arm) -> dict[Experiment, Gap]:
    """The gaps of an effect in every experiment."""
    machine = model.with_effect(effect)
    return {run: bench(run, model).gap(machine) for run in EXPERIMENTS}


def loudness(gap: Gap) -> float:
    """Greatest gap of any signal over its noise."""
    return max(float(np.abs(values).max()) / NOISE[name] for name, values in gap.items())


def signature(name: str, arm: Arm) -> Signature:
    """Simulates an effect and its parameters in every experiment."""
    model = model_for(name, arm)
    start = start_of(name, model)
    whole = Shown(start, gaps_of(start, model))
    visible = loudness(whole.gaps[FAST]) > SEEN
    each = {key: moved(start, model, key) for key in start.priors(model)}
    found = {key: Shown(effect, gaps_of(effect, model)) for key, effect in each.items()}
    columns = {key: minus(shown.gaps, whole.gaps) for key, shown in found.items()}
    if visible:
        return Signature(name, model, start, whole, None, {"": whole.gaps, **columns})
    largest = {key: float(np.abs(shown.gaps[FAST]["tip"][:, IN_PLANE]).max()) for key, shown in found.items()}
    first = next(key for key in found if largest[key] >= 0.9 * max(largest.values()))
    return Signature(name, model, start, found[first], first, columns)


def minus(a: Mapping[Experiment, Gap], b: Mapping[Experiment, Gap]) -> dict[Experiment, Gap]:
    """Difference of gaps."""
    return {run: {name: a[run][name] - b[run][name] for name in a[run]} for run in a}
