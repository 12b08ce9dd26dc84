"""Figures and words of missing laws: curve, band and cloud of the best place, beside the next one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.report.gap_curves import AFTER, BEFORE
from flexarm.report.sheets import legend_below, sheet
from flexarm.wording import probability, scale, with_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from flexarm.diagnosis.result import Diagnosis
    from flexarm.law_curve import LawCurve, LawGap


def laws(d: Diagnosis) -> Figure | None:
    """Return the curves of the two best laws side by side; None without a law."""
    shown = [law for law in d.laws if law.x][:2]
    if not shown:
        return None
    figure, axes = sheet(1, len(shown), 2.6, between=(0.7, 0.0))
    for ax, law in zip(axes[0], shown, strict=True):
        draw_law(ax, law)
    legend_below(figure, axes[0, 0])
    return figure


def draw_law(ax: Axes, law: LawCurve) -> None:
    """Draw a curve with its band, and the latent motion over its state."""
    factor, unit = scale(law.value, law.unit)
    value, low, high = (factor * np.array(each) for each in (law.value, law.low90, law.high90))
    if law.cloud_x:
        cloud = factor * np.array(law.cloud_value)
        ax.plot(law.cloud_x, cloud, ".", ms=2, color=BEFORE, label="latent motion")
    if law.of == "pose":  # in no order
        ax.errorbar(law.x, value, (value - low, high - value), fmt=".", color=AFTER, label="90 % interval")
    else:
        ax.fill_between(law.x, low, high, alpha=0.3, color=AFTER, lw=0, label="90 % band")
        ax.plot(law.x, value, color=AFTER, label="curve")
    ax.set_xlabel(f"{law.of.replace('_', ' ')} [{law.of_unit}]")
    ax.set_ylabel(f"{law.quantity} [{unit}]")
    ax.set_title(f"{law.at}: {law.kind}")


def law_rows(d: Diagnosis) -> list[dict[str, Any]]:
    """Return the words of each law: place, kind, probability, sentence, and the gap without and with it."""
    return [
        {
            "place": f"{law.quantity} of {law.at}",
            "kind": law.kind,
            "probability": probability(law.probability),
            "says": f"{law.says[:1].upper()}{law.says[1:]}.",
            "train": _shrinks(law.train, d.unit),
            "held_out": _shrinks(law.held_out, d.unit),
        }
        for law in d.laws
    ]


def _shrinks(gap: LawGap, unit: str) -> str:
    if gap.before_rms is None or gap.after_rms is None:
        return "–"
    noise = "" if gap.noise_rms is None else f" (noise {with_unit(gap.noise_rms, unit)})"
    return f"{with_unit(gap.before_rms, unit)} → {with_unit(gap.after_rms, unit)}{noise}"
