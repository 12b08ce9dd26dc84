"""Effects of a size that nothing has, above all where it rests where fits end and the data ask for more.

A fit lets a parameter go far beyond what machines have (`fitting.coordinate`), so that a mass that was
written down wrong is found. What is still at the end of that is no size: the limit of the law, a rigid link
or none at all, fits best, and it stands in for something that no name covers. Only a load may be none at all:
a gripper that let go of it carries nothing, which is told as a thirtieth of the mass that was written down.

A size beyond `FAR` sigmas that is not at an end is believed where it explains nearly all, as the true one
does. The larger part of a gap that others may leave is for nominal values that are a little off
(`choosing.acceptance`).
"""

from __future__ import annotations

from collections.abc import Iterator

from flexarm.diagnosis.fitting.coordinate import Coordinate
from flexarm.diagnosis.fitting.fit import Fit
from flexarm.diagnosis.wording import listed, place_words, with_unit

NEAR = 0.98
"""Part of its bound at which a parameter rests there."""
FAR = 4.0
"""Sigmas of a logarithmic prior beyond which a size is one of some ten thousand."""
MAY_VANISH = ("payload_mass",)
"""Effects of which the lower end is something that machines have."""


def sizes(fit: Fit) -> Iterator[tuple[int, Coordinate, float]]:
    """Number, coordinate and z of what sizes each effect, unless it is an angle or a load that is none."""
    for k, (coordinate, z) in enumerate(zip(fit.coordinates, fit.z, strict=True)):
        effect, _, name = fit.key(k)
        is_size = name == fit.members[coordinate.candidate].free[0] and coordinate.prior.scale != "uniform"
        if is_size and not (z < 0 and effect in MAY_VANISH):
            yield k, coordinate, float(z)


def far_out(fit: Fit) -> bool:
    """Whether the size of an effect is beyond `FAR` sigmas of a logarithmic prior."""
    return any(each.prior.scale == "log" and abs(z) > FAR for _, each, z in sizes(fit))


def at_ends(fit: Fit) -> list[str]:
    """Words on each effect of which the size is where fits end."""
    found = []
    for k, coordinate, z in sizes(fit):
        if abs(z) > NEAR * coordinate.bound:
            *place, name = fit.key(k)
            prior = coordinate.prior
            value, low, high = (
                with_unit(each, prior.unit) for each in (coordinate.value(z), prior.low, prior.high)
            )
            found.append(
                f"{name} of {place_words(*place)} rests where fits end, at {value} (95 % of machines have "
                f"{low} to {high})"
            )
    return found


def ends_sentence(fit: Fit) -> str:
    """The same as a sentence of what remains; empty where no effect is at an end."""
    found = at_ends(fit)
    return f"What fits best has a value that no machine has: {listed(found)}." if found else ""
