"""Effects whose size rests where fits end: thirty times a stiffness, say, and the data ask for more.

A fit lets a parameter go far beyond what machines have (`fitting.coordinate`), so that a mass that was
written down wrong is found. What is still at the end of that is no size: the limit of the law, a rigid link
or none at all, fits best, and it stands in for something that no name covers. Only a load may be none at all:
a gripper that let go of it carries nothing, which is told as a thirtieth of the mass that was written down.
"""

from __future__ import annotations

from flexarm.diagnosis.fitting.fit import Fit
from flexarm.diagnosis.wording import listed, place_words, with_unit

NEAR = 0.98
"""Part of its bound at which a parameter rests there."""
MAY_VANISH = ("payload_mass",)
"""Effects of which the lower end is something that machines have."""


def at_ends(fit: Fit) -> list[str]:
    """Words on each effect of which the first parameter, its size, is where fits end."""
    found = []
    for k, (coordinate, z) in enumerate(zip(fit.coordinates, fit.z, strict=True)):
        *place, name = fit.key(k)
        first = fit.members[coordinate.candidate].free[0]
        far = abs(z) > NEAR * coordinate.bound and not (z < 0 and place[0] in MAY_VANISH)
        if name == first and coordinate.prior.scale != "uniform" and far:
            prior = coordinate.prior
            value, low, high = (
                with_unit(each, prior.unit) for each in (coordinate.value(float(z)), prior.low, prior.high)
            )
            found.append(
                f"{name} of {place_words(*place)} rests where fits end, at {value} (95 % of machines have "
                f"{low} to {high})"
            )
    return found


def ends_sentence(fit: Fit) -> str:
    """The same as a sentence of what remains; empty where no effect is at an end."""
    found = at_ends(fit)
    return f"What would explain the gap is no value that a machine has: {listed(found)}." if found else ""
