"""The gap of a signal along a record, before and after: the curve that shrinks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arm.consistency import missing
from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter
from flexarm.wording import scale

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from flexarm.comparison.before_after import BeforeAfter
    from flexarm.comparison.gap import SignalGap


BEFORE, AFTER, NOISE = "#D55E00", "#0072B2", "#d9d9d9"
LOOKS: dict[str, dict[str, Any]] = {
    "nominal model": {"color": BEFORE, "marker": "o"},
    "updated model": {"color": AFTER, "marker": "s"},
}
"""Okabe and Ito's colours, told apart by everyone; markers differ too."""


def plot(diagnosis: BeforeAfter, ax: Axes | None, record: str | None) -> Axes:
    """Return what `Diagnosis.plot` draws: the direction with the largest gap."""
    import matplotlib.pyplot as plt

    name = _record(diagnosis, record)
    gaps = sides(diagnosis, name)
    before = gaps["nominal model"]
    direction = worst(before)
    axes = plt.subplots()[1] if ax is None else ax
    factor, unit = scale([before.max[direction]], before.unit)
    draw(axes, gaps, direction, factor)
    axes.set(
        xlabel=along(before), ylabel=f"{label(before, direction)} [{unit}]", title=f"{name}: measured − model"
    )
    axes.legend()
    return axes


def _record(diagnosis: BeforeAfter, wanted: str | None) -> str:
    there = [name for name in diagnosis.before if sides(diagnosis, name)]
    if wanted is None and there:
        first = [n for n in (*diagnosis.held_out, *diagnosis.training) if n in there]
        return (first or there)[0]
    if wanted not in there:
        raise InvalidParameter(missing("compared record", str(wanted), there), where="record")
    return wanted


def sides(diagnosis: BeforeAfter, record: str) -> dict[str, SignalGap]:
    """Return the main signal's gap on a record, by model: nominal, and updated if it is another one."""
    pairs = [("nominal model", diagnosis.before)]
    if diagnosis.updated != diagnosis.arm:
        pairs.append(("updated model", diagnosis.after))
    found = {
        name: comparisons[record].signals.get(diagnosis.main_signal)
        for name, comparisons in pairs
        if record in comparisons
    }
    return {name: gap for name, gap in found.items() if gap is not None and gap.rms["total"] is not None}


def worst(gap: SignalGap) -> str:
    """Return the direction with the largest gap."""
    return max(directions(gap), key=lambda name: gap.rms[name] or 0.0)


def directions(gap: SignalGap) -> list[str]:
    """Return the measured directions of a gap; "total" of a scalar."""
    return [name for name, part in gap.parts.items() if part is not None]


def label(gap: SignalGap, direction: str) -> str:
    """Signal and direction."""
    return gap.name if direction == "total" else f"{gap.name}, {direction}"


def along(gap: SignalGap) -> str:
    """Return the axis that a gap is drawn along; records of poses have no bands of frequency."""
    if not gap.bands:
        return "pose"
    return f"time after {zero:.0f} s [s]" if (zero := zero_of(gap.time)) else "time [s]"


def zero_of(time: Floats) -> float:
    """Return where an axis of time begins: 0, or the whole second before stamps beyond 1000 s."""
    first = float(np.floor(time[0])) if len(time) else 0.0
    return first if abs(first) > 1e3 else 0.0


def noise_of(gap: SignalGap) -> float | None:
    """Noise of one direction: directions share the total evenly."""
    return None if gap.noise_rms is None else gap.noise_rms / float(np.sqrt(max(1, len(directions(gap)))))


def draw(
    ax: Axes,
    gaps: Mapping[str, SignalGap],
    direction: str,
    factor: float,
    over: Mapping[str, Floats] | None = None,
) -> None:
    """Draw the gaps by model, as `sides` gives them, in one direction along the record.

    `factor` leads from the gap's unit to the drawn one. With `over` they are dots over that, else a line over
    time.
    """
    noise = noise_of(list(gaps.values())[-1])
    if noise:
        ax.axhspan(-2 * factor * noise, 2 * factor * noise, color=NOISE, lw=0, zorder=0, label="noise, 2σ")
    for name, gap in gaps.items():
        part = gap.parts.get(direction)
        if part is not None:
            where = gap.time - (zero_of(gap.time) if gap.bands else 0.0) if over is None else over[name]
            _line(ax, where, factor * part, over is not None or not gap.bands, name)


def _line(ax: Axes, where: Floats, values: Floats, dotted: bool, name: str) -> None:
    """Dots where order means nothing; a line else, with markers while they can be told apart."""
    many = 400  # samples beyond which lines stand without markers
    look: dict[str, Any] = {"label": name, **LOOKS[name]}
    if dotted:
        ax.plot(where, values, ls="none", ms=2.2, mew=0, rasterized=len(where) > many, **look)
        return
    if len(where) > many:
        look["marker"] = "none"
    ax.plot(where, values, lw=0.7, ms=2.2, mew=0, rasterized=len(where) > 5 * many, **look)
