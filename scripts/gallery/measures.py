"""Numbers that describe a gap of the tip: how large, in which direction, and what it follows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexarm import Arm, InvalidParameter, NotConverged
from flexarm.arm.effect import Effect
from flexarm.residual_analysis.motion_states import correlation_ratio, intervals
from gallery.experiments import FAST
from gallery.gaps import Gap, bench, by_direction, slow_part, states
from gallery.signatures import Signature, acting


@dataclass(frozen=True)
class Size:
    """Gap of the tip [m] and rms of the motor torque's [N m] in the faster motion; None: not possible."""

    rms: float | None = None
    max: float | None = None
    torque: float | None = None


def size_of(gap: Gap) -> Size:
    """Of the tip's three coordinates together, and of the torque."""
    length = np.linalg.norm(gap["tip"], axis=1)
    rms, torque = (float(np.sqrt(np.mean(values**2))) for values in (length, gap["torque"]))
    return Size(rms, float(length.max()), torque)


def size_with(effect: Effect, parameter: str, value: float, model: Arm) -> Size:
    """The gap with another value of a parameter."""
    try:
        changed = acting(effect.with_parameters({parameter: value}), model)
        return size_of(bench(FAST, model).gap(model.with_effect(changed)))
    except (InvalidParameter, NotConverged):
        return Size()


def sizes(signature: Signature) -> dict[str, dict[str, Size]]:
    """By parameter: the gap at the low end, the start and the high end of its prior."""
    start, model = signature.start, signature.model
    there = {name: value for name, value, _ in start.parameters()}
    found = {}
    for name, prior in start.priors(model).items():
        values = {"low": prior.low, "start": there[name], "high": prior.high}
        found[name] = {key: size_with(start, name, value, model) for key, value in values.items()}
    return found


def directions(signature: Signature) -> dict[str, float]:
    """Shares of the tip's squared gap by direction."""
    parts = by_direction(bench(FAST, signature.model), signature.shown.gaps[FAST])
    squares = {name: float(np.sum(part**2)) for name, part in parts.items()}
    return {name: square / max(sum(squares.values()), 1e-300) for name, square in squares.items()}


def slow_share(signature: Signature) -> float:
    """Share of the tip's squared gap that remains without the ringing of the first mode."""
    gap = signature.shown.gaps[FAST]["tip"]
    slow = slow_part(bench(FAST, signature.model), gap)
    return float(np.mean(np.sum(slow**2, axis=1)) / max(np.mean(np.sum(gap**2, axis=1)), 1e-300))


def follows(signature: Signature) -> dict[str, float]:
    """Share of what remains then, squared, that a curve over each state of the joint explains."""
    run = bench(FAST, signature.model)
    parts = np.stack(list(by_direction(run, signature.shown.gaps[FAST]).values()), axis=1)
    slow = slow_part(run, parts)
    groups = {name: intervals(slow_part(run, state)) for name, state in states(run).items()}
    return {name: correlation_ratio(each, slow) for name, each in groups.items()}
