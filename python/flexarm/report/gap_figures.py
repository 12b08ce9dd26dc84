"""The gap before and after a model is changed, along a record, by band of frequencies, and step by step."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arguments import NAMES, TEXT, takes
from flexarm.arm import Arm
from flexarm.arm.consistency import missing
from flexarm.arrays import Floats
from flexarm.comparison.comparison import Comparison
from flexarm.comparison.pooled_gap import pooled, pooled_gap
from flexarm.errors import InvalidParameter
from flexarm.fit_statistics import PooledGap
from flexarm.output import stems
from flexarm.report.files import LEFT, legend_below, log_if_wide, margin_for, sheet, write_beside
from flexarm.wording import labelled_scale, number

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from flexarm.comparison.gap import SignalGap
    from flexarm.diagnosis.result import Diagnosis


BEFORE, AFTER, NOISE = "#D55E00", "#0072B2", "#d9d9d9"
LOOKS: dict[str, dict[str, Any]] = {
    "nominal model": {"color": BEFORE, "marker": "o"},
    "updated model": {"color": AFTER, "marker": "s"},
}
"""Okabe and Ito's colours, told apart by everyone; markers differ too."""


class BeforeAfter:
    """The gap of a nominal and of an updated model."""

    arm: Arm
    updated: Arm
    before: Mapping[str, Comparison]
    after: Mapping[str, Comparison]
    """By record, held-out ones too: the gap of either, aligned."""
    training: tuple[str, ...]
    held_out: tuple[str, ...]
    main_signal: str
    """The signal of the report's `gap`."""

    @property
    def unit(self) -> str:
        """Unit of the main signal's gap; empty if nothing could be compared."""
        return self.unit_of(self.main_signal)

    def unit_of(self, signal: str) -> str:
        """Return the unit of the gap of a signal; empty if it could not be compared."""
        found = (comparison.signals.get(signal) for comparison in self.before.values())
        return next((gap.unit for gap in found if gap is not None), "")

    @property
    def has_gap(self) -> bool:
        """Return True if there is a gap to be shown: not where the data could not be compared at all."""
        return bool(self.unit)

    @takes(records=NAMES)
    def gap(self, records: Iterable[str], signal: str | None = None) -> PooledGap:
        """Return totals of a signal (default: the main one) before and after, pooled over records."""
        return pooled_gap(self.before, self.after, records, self.main_signal if signal is None else signal)

    @takes(record=TEXT)
    def plot(self, ax: Axes | None = None, record: str | None = None) -> Axes:
        """Return the main signal's gap before and after along a record, and the noise (2 sigma) as a band.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw.
        record : str, optional
            Which one; default: the first held-out one, or the first of training.

        Raises
        ------
        InvalidParameter
            If there is no such record, or nothing in it was compared.
        """
        import matplotlib.pyplot as plt

        names = (*self.held_out, *self.training, *self.before)
        there = [name for name in names if name in self.before and sides(self, name)]
        if not there or record not in (None, *there):
            known = [name for name in self.before if name in there]
            raise InvalidParameter(missing("compared record", str(record), known), where="record")
        name = there[0] if record is None else record
        gaps = sides(self, name)
        before = gaps["nominal model"]
        direction = worst(before)
        axes = plt.subplots()[1] if ax is None else ax
        factor, unit = labelled_scale([before.max[direction]], before.unit)
        draw(axes, gaps, direction, factor)
        axes.set(xlabel=along(before), ylabel=f"{label(before, direction)} [{unit}]")
        axes.set_title(f"{name}: measured − model")
        axes.legend()
        return axes


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
    """Return the label of the axis that a gap is drawn along."""
    if gap.poses:
        return "pose"
    return f"time after {zero:.0f} s [s]" if (zero := zero_of(gap.time)) else "time [s]"


def zero_of(time: Floats) -> float:
    """Return where an axis of time begins: 0, or the whole second before stamps beyond 1000 s."""
    first = float(np.floor(time[0])) if len(time) else 0.0
    return first if abs(first) > 1e3 else 0.0


def noise_of(gap: SignalGap) -> float | None:
    """Noise of one direction: directions share the total evenly."""
    return None if gap.noise_rms is None else gap.noise_rms / float(np.sqrt(max(1, len(directions(gap)))))


def draw(ax: Axes, gaps: Mapping[str, SignalGap], direction: str, factor: float) -> None:
    """Draw the gaps by model, as `sides` gives them, in one direction along the record.

    `factor` leads from the gap's unit to the drawn one. Poses are dots, motions lines, with markers if they
    have few samples.
    """
    many = 400  # samples beyond which lines have no markers
    noise = noise_of(list(gaps.values())[-1])
    if noise:
        ax.axhspan(-2 * factor * noise, 2 * factor * noise, color=NOISE, lw=0, zorder=0, label="noise, 2σ")
    for name, gap in gaps.items():
        part, count = gap.parts.get(direction), len(gap.time)
        if part is None:
            continue
        look: dict[str, Any] = {"ms": 2.2, "mew": 0, "label": name, **LOOKS[name]}
        if not gap.bands:
            ax.plot(gap.time, factor * part, ls="none", rasterized=count > many, **look)
            continue
        if count > many:
            look["marker"] = "none"
        time, line = gap.line(direction)
        ax.plot(time - zero_of(gap.time), factor * line, lw=0.7, rasterized=count > 5 * many, **look)


TRAINING, HELD_OUT = "#CC79A7", "#009E73"


def gap_along(d: BeforeAfter, record: str) -> Figure:
    """Before and after along a record, a row each direction; on the right what is left, enlarged."""
    gaps = sides(d, record)
    first, (model, last) = _first(gaps), list(gaps.items())[-1]
    names = directions(first)
    widths = (1.5, 1) if len(gaps) > 1 else (1,)
    figure, axes = sheet(len(names), len(widths), 1.3, between=(LEFT, 0.12), sharex=True, width_ratios=widths)
    for row, name in zip(axes, names, strict=True):
        factor, unit = labelled_scale([first.max[name]], first.unit)
        draw(row[0], gaps, name, factor)
        row[0].set_ylabel(f"{'gap' if name == 'total' else name} [{unit}]")
        if len(gaps) == 1:
            continue
        largest = max(last.max[name] or 0.0, 2 * (noise_of(last) or 0.0))
        factor, unit = labelled_scale([largest], last.unit)
        draw(row[1], {model: last}, name, factor)
        end = 1.15 * factor * largest or 1.0  # nothing is left where nothing moves and no noise is stated
        row[1].set(ylabel=f"[{unit}]", ylim=(-end, end))
    titles = (f"{record}: measured − model", "what is left, enlarged")
    for ax, title in zip(axes[0], titles, strict=False):
        ax.set_title(title)
    for ax in axes[-1]:
        ax.set_xlabel(along(first))
        first.label_poses(ax.xaxis)
    legend_below(figure, axes[0, 0])
    return figure


def gaps_along(d: BeforeAfter, section: str) -> Iterator[tuple[str, str, str, Figure]]:
    """Yield name, section, caption and figure of the gap along each record, held-out ones first."""
    shown = [name for name in (*d.held_out, *d.training) if sides(d, name)]
    for record, stem in zip(shown, stems(shown), strict=True):
        role = "held out, never used to fit" if record in d.held_out else "training"
        caption = f"Record {record} ({role}): gap of {d.main_signal} before and after, and the noise."
        yield f"gap-{stem}", section, caption, gap_along(d, record)


def _first(gaps: Mapping[str, SignalGap]) -> SignalGap:
    return next(iter(gaps.values()))


def by_band(d: BeforeAfter, records: Sequence[str]) -> Figure | None:
    """Return the gap in each band of frequencies before and after, and the noise; None without bands."""
    shown = {name: gaps for name in records if (gaps := sides(d, name)) and _first(gaps).bands}
    if not shown:
        return None
    figure, axes = sheet(1, len(shown), 1.5, between=(0.1, 0.0), sharey=True)
    factor, unit = labelled_scale([_first(gaps).rms["total"] for gaps in shown.values()], d.unit)
    for ax, (name, gaps) in zip(axes[0], shown.items(), strict=True):
        labels = [f"{band.low:.2g}–{band.high:.2g}" for band in _first(gaps).bands]
        shifts = (-0.2, 0.2) if len(gaps) > 1 else (0.0,)
        for (model, gap), shift in zip(gaps.items(), shifts, strict=True):
            heights = [factor * band.rms for band in gap.bands[: len(labels)]]
            ax.bar(np.arange(len(heights)) + shift, heights, 0.38, color=LOOKS[model]["color"], label=model)
        noise = list(gaps.values())[-1].noise_rms
        if noise:
            ax.axhline(factor * noise, color="black", lw=0.8, ls="--", label="noise, all bands")
        ax.set(xticks=np.arange(len(labels)), xticklabels=labels, xlabel="band [Hz]", title=name)
    _share_heights(axes[0, 0], [gap for gaps in shown.values() for gap in gaps.values()], factor)
    axes[0, 0].set_ylabel(f"rms of {d.main_signal} [{unit}]")
    legend_below(figure, axes[0, 0])
    return figure


def _share_heights(ax: Axes, gaps: Sequence[SignalGap], factor: float) -> None:
    """One axis for all records, which holds the highest bar and the noise, and little below the noise."""
    noise = max((gap.noise_rms or 0.0 for gap in gaps), default=0.0)
    floor = 0.1 * noise
    heights = [factor * max(band.rms, floor) for gap in gaps for band in gap.bands]
    top = max(*heights, factor * noise)
    log_if_wide(ax, "y", heights)
    if ax.get_yscale() == "log":
        ax.set_ylim(factor * floor if floor else None, 1.6 * top)
    else:
        ax.set_ylim(0.0, 1.05 * top)


def waterfall(d: Diagnosis) -> Figure | None:
    """Return the gap from the nominal model to the repaired one, effect by effect; None if nothing was
    added.
    """
    groups = [("training", d.training, TRAINING), ("held out", d.held_out, HELD_OUT)]
    rows = [(name, heights, colour) for name, of, colour in groups if (heights := _stages(d, of))]
    if len(d.stages) < 2 or not rows:
        return None
    labels = ["+ " * (i > 0) + stage.label.replace("_", " ") for i, stage in enumerate(d.stages)]
    figure, axes = sheet(1, 1, 0.42 * len(d.stages) + 0.1, left=margin_for(labels))
    ax = axes[0, 0]
    largest = max(max(heights) for _, heights, _ in rows)
    factor, unit = labelled_scale([largest], d.unit)
    for i, (name, heights, colour) in enumerate(rows):
        place = np.arange(len(heights)) + 0.38 * (i - (len(rows) - 1) / 2)
        values = [factor * height for height in heights]
        bars = ax.barh(place, values, 0.36, color=colour, label=name)
        write_beside(ax, bars, [number(value) for value in values])
    noise = d.gap([*d.training, *d.held_out]).noise_rms
    if noise:
        ax.axvline(factor * noise, color="black", lw=0.8, ls="--", label="noise")
    smallest = min([min(heights) for _, heights, _ in rows] + ([noise] if noise else []))
    ax.set(yticks=np.arange(len(labels)), yticklabels=labels)
    log_if_wide(ax, "x", [factor * smallest, factor * largest])
    lowest = 0.6 * factor * smallest if ax.get_xscale() == "log" else 0.0
    ax.set_xlim(lowest, factor * largest * (2.2 if lowest else 1.15))
    ax.set_xlabel(f"rms gap of {d.main_signal} [{unit}]")
    ax.invert_yaxis()
    ax.grid(visible=False, axis="y")
    legend_below(figure, ax)
    return figure


def _stages(d: Diagnosis, records: Sequence[str]) -> list[float]:
    """Return the gap of each stage pooled over records; empty if one is not known."""
    known = [name for name in records if sides(d, name) and all(name in stage.rms for stage in d.stages)]
    gaps = [_first(sides(d, name)) for name in known]
    heights = [pooled([stage.rms[name] for name in known], gaps) for stage in d.stages]
    return [height for height in heights if height] if all(heights) else []
