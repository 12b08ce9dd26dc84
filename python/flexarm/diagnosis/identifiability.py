"""Identifiability of fitted values: refined values, unidentifiable ones, estimates at bounds.

**Refined values.** Nominal values move by

    moved = value - nominal,    pull = moved/sigma                                                   (1)

with the model's stated sigma. A value is determined by the data if they leave less than `KEPT` of its sigma.

**Practically unidentifiable values** move along with others. They go back to their nominal values, all
together, unless the gap on the training grows by it: of five lengths of which only the sum shows, each is
unidentifiable.

**Estimates at bounds.** A fit lets a parameter go far beyond what is plausible (`diagnosis.parameters`). An
estimate that rests at the end of that range is no size: the limit of the law fits best. Only a payload may
vanish.

**Implausible sizes**, beyond `FAR` sigmas of a prior, are believed where they explain nearly all
(`diagnosis.acceptance`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from flexarm.arm.parameter import with_value
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.parameters import TransformedParameter
from flexarm.diagnosis.result import Refinement, stated_sigma
from flexarm.wording import listed, place_words, with_unit

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.comparison.comparison import Comparison
    from flexarm.named_effects import Refined


GROWTH = 0.01
"""Growth of the rms gap of a signal, over the larger of gap and noise, that counts as none."""


def restore_unidentifiable(
    arm: Arm,
    updated: Arm,
    refined: tuple[Refined, ...],
    gaps: Callable[[Arm], Mapping[str, Comparison]],
) -> tuple[Arm, tuple[Refined, ...]]:
    """Return the repaired model and its refined values, with those that the data leave open as they were.

    Parameters
    ----------
    arm, updated : Arm
        The nominal and the repaired model.
    refined : tuple of Refined
        What moved.
    gaps : callable
        The gap of a model by record of the training.
    """
    open_ones = [
        each for each in refined if not Refinement(each, stated_sigma(arm, each.parameter)).determined
    ]
    if updated is arm or not open_ones:
        return updated, refined
    back = updated
    for each in open_ones:
        back = with_value(back, each.parameter, each.nominal)
    if _grows(gaps(updated), gaps(back)):
        return updated, refined
    return back, tuple(replace(each, value=each.nominal) if each in open_ones else each for each in refined)


def _grows(before: Mapping[str, Comparison], after: Mapping[str, Comparison]) -> bool:
    """Return True if any signal of any record is missed by more."""
    for name, comparison in before.items():
        for signal, gap in comparison.evidence.items():
            other = after[name].evidence.get(signal)
            old, new = gap.rms["total"], None if other is None else other.rms["total"]
            if old is not None and (new is None or new - old > GROWTH * max(old, gap.noise_rms or 0.0)):
                return True
    return False


NEAR = 0.98
"""Part of its bound at which a parameter rests there."""
FAR = 4.0
"""Sigmas of a logarithmic prior beyond which a size is one of some ten thousand."""


def sizes(fit: Fit) -> Iterator[tuple[int, TransformedParameter, float]]:
    """Return number, coordinate and z of what sizes each effect, unless it is an angle or a load that is
    none.
    """
    for k, (parameter, z) in enumerate(zip(fit.parameters, fit.z, strict=True)):
        member = fit.members[parameter.candidate]
        is_size = member.is_size(parameter.name) and parameter.prior.scale != "uniform"
        if is_size and not (z < 0 and member.effect.may_vanish):
            yield k, parameter, float(z)


def has_implausible_size(fit: Fit) -> bool:
    """Return True if the size of an effect is beyond `FAR` sigmas of a logarithmic prior."""
    return any(each.prior.scale == "log" and abs(z) > FAR for _, each, z in sizes(fit))


def estimates_at_bounds(fit: Fit) -> list[str]:
    """Words on each effect of which the size is where fits end."""
    found = []
    for k, parameter, z in sizes(fit):
        if abs(z) > NEAR * parameter.bound:
            effect, at, name = fit.key(k)
            prior = parameter.prior
            value, low, high = (
                with_unit(each, prior.unit) for each in (parameter.value(z), prior.low, prior.high)
            )
            found.append(
                f"{name} of {place_words(effect, at)} rests where fits end, at {value} (95 % of machines "
                f"have {low} to {high})"
            )
    return found


def bound_sentence(fit: Fit) -> str:
    """Return the same as a sentence of what remains; empty where no effect is at an end."""
    found = estimates_at_bounds(fit)
    return f"What fits best has a value that no machine has: {listed(found)}." if found else ""
