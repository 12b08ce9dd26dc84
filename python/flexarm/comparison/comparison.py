"""The outcome of a comparison: numbers, table, figure, JSON."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arguments import takes
from flexarm.arm.consistency import missing
from flexarm.comparison.align import Alignment
from flexarm.comparison.files import SavedGap
from flexarm.comparison.gap import SignalGap
from flexarm.errors import InvalidParameter
from flexarm.json_values import plain
from flexarm.wording import labelled_scale, number

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(SavedGap):
    """Hold the gap between a model and a record.

    Attributes
    ----------
    arm, record : str
        Name of the model, description of the record.
    signals : dict of str to SignalGap
        The gap of every signal that could be compared; drives are marked.
    aligned : Alignment
        Clocks and frames as they were used.
    skipped : dict of str to str
        Signals that were not compared, and why.
    modes_hz : tuple of float
        Frequencies of the arm that set the bands [Hz].
    notes : tuple of str
        Notes, such as on aliasing and undetermined parameters.
    frames : dict of str to (list of float, list of float)
        Found poses of frames that the record calls unknown: xyz [m] and rpy [rad] in the base.
    """

    arm: str
    record: str
    signals: Mapping[str, SignalGap]
    aligned: Alignment
    skipped: Mapping[str, str]
    modes_hz: tuple[float, ...] = ()
    notes: tuple[str, ...] = ()
    frames: Mapping[str, tuple[list[float], list[float]]] = field(default_factory=dict)

    @property
    def evidence(self) -> dict[str, SignalGap]:
        """Return gaps of all signals but the drives."""
        return {name: gap for name, gap in self.signals.items() if not gap.is_drive}

    def to_json_dict(self) -> dict[str, Any]:
        """Return the object of `flexarm compare --json`."""
        return {
            "signals": {name: gap.to_json_dict() for name, gap in self.signals.items()},
            "drives": [name for name, gap in self.signals.items() if gap.is_drive],
            "alignment": [
                {
                    "parameter": str(unknown),
                    "value": float(value),
                    "std": plain(float(std)),
                    "prior": unknown.centre,
                    "prior_sigma": plain(unknown.sigma),
                    "unit": unknown.unit,
                }
                for unknown, value, std in zip(
                    self.aligned.parameters, self.aligned.values, self.aligned.std, strict=True
                )
            ],
            "frames": {name: {"xyz": xyz, "rpy": rpy} for name, (xyz, rpy) in self.frames.items()},
            "modes_hz": list(self.modes_hz),
            "skipped": dict(self.skipped),
            "notes": list(self.notes),
        }

    def summary(self) -> str:
        """Return tables of the gap, its bands and the alignment as text."""
        title = f"gap between {self.arm!r} and " + (repr(self.record) if self.record else "the record")
        lines = [title, "", *self._gap_table(), "", *self._band_table()]
        rows = list(zip(self.aligned.parameters, self.aligned.values, self.aligned.std, strict=True))
        if rows:
            against = "clocks against the drive's, frames against their stated poses, in the base's axes"
            lines += ["", f"aligned: {against}; +- 1 sigma from noise alone (as stated)"]
            lines += [
                f"  {u!s:<36}{_rounded_to(value, std):>12} +- {_sigma(std, 'any'):>8}  "
                f"({_sigma(u.sigma, 'unknown')}) {u.unit}"
                for u, value, std in rows
                if str(u) not in self.aligned.undetermined  # reported in a note
                # of a found frame the pose is reported, not the distance from a guess
                and (u.kind == "delay" or u.place not in self.frames)
            ]
        for name, pose in self.frames.items():
            found = [
                f"{', '.join(_sigma(std, 'any') for _, std in group)} {unit}"
                for unit in ("m", "rad")
                if (group := [(u, std) for u, _, std in rows if (u.place, u.unit) == (name, unit)])
            ]
            sigmas = f", +- {' and '.join(found)}" if found else ""
            lines.append(f"  {frame_words(name, pose)}{sigmas}")
        lines += [f"not compared: {name}: {why}" for name, why in self.skipped.items()]
        lines += [f"note: {note}" for note in self.notes]
        return "\n".join(lines)

    def _gap_table(self) -> list[str]:
        """Return lines of rms by direction, noise and greatest gap, each signal in a unit that reads well."""
        names = list(dict.fromkeys(key for gap in self.signals.values() for key in gap.rms if key != "total"))
        rows = [["rms", "unit", *names, "total", "noise", "max"]]
        for gap in self.signals.values():
            cells = [gap.rms.get(name) for name in [*names, "total"]] + [gap.noise_rms, gap.max["total"]]
            factor, unit = labelled_scale(cells[:-2], gap.unit)
            label = f"{gap.name} (drive)" if gap.is_drive else gap.name
            rows.append([label, unit, *("-" if c is None else number(factor * c) for c in cells)])
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        return [
            "  ".join(
                cell.ljust(width) if k < 2 else cell.rjust(max(width, 8))
                for k, (cell, width) in enumerate(zip(row, widths, strict=True))
            ).rstrip()
            for row in rows
        ]

    def _band_table(self) -> list[str]:
        """Return lines of the total rms by band."""
        lines = []
        for gap in self.evidence.values():
            factor, unit = labelled_scale([band.rms for band in gap.bands], gap.unit)
            parts = [f"{band.low:.3g}-{band.high:.3g} Hz: {number(factor * band.rms)}" for band in gap.bands]
            if parts:
                lines.append(f"{gap.name} [{unit}]  " + "   ".join(parts))
        return lines

    def tables(self) -> dict[str, pd.DataFrame]:
        """Return the gap of each signal that does not drive, by row."""
        return {name: gap.table() for name, gap in self.evidence.items()}

    @takes()
    def plot(self, ax: Axes | None = None, signal: str | None = None) -> Axes:
        """Plot the gap of a signal over time, by direction, with the noise (2 sigma) as a band.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw.
        signal : str, optional
            Name of the signal; default: the first that does not drive.
        """
        import matplotlib.pyplot as plt

        gap = self._gap(signal)
        axes = plt.subplots()[1] if ax is None else ax
        factor, unit = labelled_scale([gap.max["total"]], gap.unit)
        parts = [name for name, part in gap.parts.items() if part is not None]
        for name in parts:
            time, part = gap.line(name)
            axes.plot(time, factor * part, lw=0.8, label=name)
        if gap.noise_rms:
            sigma = factor * gap.noise_rms / np.sqrt(max(len(parts), 1))
            axes.axhspan(-2 * sigma, 2 * sigma, color="0.85", zorder=0, label="noise, 2 sigma")
        axes.set(xlabel="pose" if gap.poses else "time [s]", ylabel=f"{gap.name}: measured - model [{unit}]")
        gap.label_poses(axes.xaxis)
        axes.legend()
        return axes

    @takes()
    def plot_readings(self, ax: Axes | None = None, signal: str | None = None) -> Axes:
        """Plot what was measured and what the model predicts, by channel in the signal's own frame.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw.
        signal : str, optional
            Name of the signal; default: the first that does not drive.
        """
        import matplotlib.pyplot as plt

        gap = self._gap(signal)
        axes = plt.subplots()[1] if ax is None else ax
        for name, measured in gap.measured.items():
            (line,) = axes.plot(gap.time, measured, lw=1.6, alpha=0.45, label=f"{name} measured".strip())
            axes.plot(
                gap.time, gap.model[name], "--", lw=0.8, color=line.get_color(), label=f"{name} model".strip()
            )
        axes.set(xlabel="pose" if gap.poses else "time [s]", ylabel=f"{gap.name} [{gap.reading_unit}]")
        gap.label_poses(axes.xaxis)
        axes.legend(fontsize="small", ncols=max(len(gap.measured), 1))
        return axes

    def _gap(self, signal: str | None) -> SignalGap:
        """Return the gap of a signal, by default of the first that does not drive."""
        if signal is not None and signal not in self.signals:
            raise InvalidParameter(missing("compared signal", signal, self.signals), where="signal")
        return self.signals[signal] if signal is not None else next(iter(self.evidence.values()))

    def draw(self, figure: Figure, signal: str) -> None:
        """Draw what was measured beside the model's readings, and below it the gap."""
        above, below = figure.subplots(2, sharex=True)
        self.plot_readings(above, signal)
        self.plot(below, signal)
        above.set_xlabel("")


def frame_words(name: str, pose: tuple[list[float], list[float]]) -> str:
    """Return a found frame as text, as a record states one."""
    xyz, rpy = (
        ", ".join(f"{value:.{digits}f}" for value in part) for part, digits in zip(pose, (5, 6), strict=True)
    )
    return f"frame {name} found at xyz = [{xyz}] m, rpy = [{rpy}] rad in the base"


def _sigma(std: float, infinite: str) -> str:
    """Return 1 sigma as text, or a word where nothing is known."""
    return f"{std:.1e}" if np.isfinite(std) else infinite


def _rounded_to(value: float, std: float) -> str:
    """Return four digits, or as many as the deviation needs to copy a delay into a record; 0 of rounding."""
    if abs(value) < 1e-6 * std:
        return "0"
    if abs(value) < 1 or not 0 < std < 1e-3 * abs(value):
        return f"{value:.3e}"
    return f"{value:.{max(1 - math.floor(math.log10(std)), 0)}f}"
