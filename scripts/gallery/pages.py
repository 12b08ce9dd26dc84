"""The page of an effect."""

from __future__ import annotations

from flexarm.arm.effect import Effect
from gallery.confusion import Study
from gallery.described import described
from gallery.experiments import FAST, NOISE
from gallery.gaps import at_tip
from gallery.measures import Size, directions, follows, size_of, sizes, slow_share
from gallery.signatures import Signature, place
from gallery.text import metres, percent, rounded, setting, table
from gallery.verdicts import confused, separated

NONE = 2e-3
"""Part of the noise below which a size is none."""


def page(name: str, study: Study) -> str:
    """The whole page of an effect."""
    signature = study.signatures[name]
    own = [described(name), looks(signature), expected(signature)]
    return "\n\n".join([*own, confused(name, study), separated(name, study)]) + "\n"


def values_of(effect: Effect, parameter: str | None = None) -> str:
    """Values of an effect with units; of one that is shown alone, its own."""
    told = [
        f"`{name}` = {setting(value)} {unit}".removesuffix(" -")
        for name, value, unit in effect.parameters()
        if parameter is None or name == parameter
    ]
    return ", ".join(told)


def looks(signature: Signature) -> str:
    """Size, directions and what the gap of the picture follows."""
    name, size = signature.name, size_of(signature.shown.gaps[FAST])
    why = "one sigma above where it starts" if signature.parameter else "typical"
    values = values_of(signature.shown.effect, signature.parameter)
    with_values = f", {values} ({why})" if values else ""
    title = f"## What it looks like\n![Gap with {name}]({name}.png)\n\n"
    what = (
        "The paper's arm in the faster motion of the [gallery](README.md), measured minus predicted, with "
        f"`{name}` at `{place(name)}`{with_values}"
    )
    if not at_tip(signature.shown.gaps[FAST]):
        return (
            f"{title}{what}: the tip shows nothing, the motor's torque {rounded(size.torque or 0)} N m rms."
        )
    where = ", ".join(f"{part} {percent(r)}" for part, r in directions(signature).items())
    curves = ", ".join(f"{state} {percent(r)}" for state, r in follows(signature).items())
    return (
        f"{title}{what}: the tip is {metres(size.rms or 0)} rms and at most {metres(size.max or 0)} off. "
        f"Of the squared gap: {where}. Without the ringing of the first mode (bold) "
        f"{percent(slow_share(signature))} of it remains, of which a curve over one state of the joint "
        f"explains: {curves}."
    )


def expected(signature: Signature) -> str:
    """The tip's gap through the range of every parameter."""
    if not (found := sizes(signature)):
        return "## Sizes to expect\nIt has one size, that of the picture."
    start = {key: value for key, value, _ in signature.start.parameters()}
    priors = signature.start.priors(signature.model)
    rows = []
    for key, ends in found.items():
        prior = priors[key]
        for end, value in (("low", prior.low), ("start", start[key]), ("high", prior.high)):
            unit = "" if prior.unit == "-" else f" {prior.unit}"
            rows.append([f"`{key}`" if end == "low" else "", f"{setting(value)}{unit}", *_told(ends[end])])
    text = table(["parameter", "value", "tip, rms", "greatest", "motor torque, rms"], rows)
    others = "the model's own" if signature.model.effect(signature.name, place(signature.name)) else "typical"
    missing = "\n\n–: not possible beside the other values." if "– |" in text else ""
    return f"## Sizes to expect\nGaps in the same motion, other parameters {others}:\n\n{text}{missing}"


def _told(size: Size) -> list[str]:
    """Cells of a size; what is far below the noise is told as none."""
    if size.rms is None or size.max is None or size.torque is None:
        return ["–", "–", "–"]
    tip = [metres(value) if value > NONE * NOISE["tip"] else "0" for value in (size.rms, size.max)]
    return [*tip, f"{rounded(size.torque)} N m" if size.torque > NONE * NOISE["torque"] else "0"]
