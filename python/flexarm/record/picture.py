"""Picture of a record: a panel a signal, one below the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.consistency import missing
from flexarm.errors import InvalidParameter
from flexarm.quantities import channel_names

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from flexarm.record.record import Record
    from flexarm.record.signal import Signal


def figure_of(record: Record, names: Sequence[str] | None) -> Figure:
    """Return the figure that `Record.plot` describes."""
    import matplotlib.pyplot as plt

    drawable = [name for name, signal in record.signals.items() if len(signal)]
    names = drawable if names is None else list(dict.fromkeys(names))
    for name in names:
        if name not in drawable:
            raise InvalidParameter(missing("signal with values", name, drawable), where="signals")
    if not names:
        raise InvalidParameter("has no values to draw", where="signals")
    size = (8.0, 1.2 + 1.4 * len(names))
    figure, panels = plt.subplots(
        len(names), 1, sharex=True, squeeze=False, figsize=size, layout="constrained"
    )
    for axes, name in zip(panels[:, 0], names, strict=True):
        _draw(axes, record, record.signals[name])
    panels[-1, 0].set_xlabel(_along(record))
    if record.kind == "static":
        panels[-1, 0].set_xticks(*_few(record.poses))
    return figure


def _along(record: Record) -> str:
    """Return the label of the axis that all panels share."""
    if record.kind == "static":
        return "pose"
    if record.kind == "frequency_response":
        return "frequency [Hz]"
    return f"time of the clock {record.reference_clock} [s]"


def _few(poses: Sequence[str]) -> tuple[list[int], list[str]]:
    """Return numbers and names of at most ten poses."""
    numbers = list(range(0, len(poses), -(-len(poses) // 10)))
    return numbers, [poses[number] for number in numbers]


def _draw(axes: Axes, record: Record, signal: Signal) -> None:
    labels = channel_names(signal.quantity, signal.axes)
    if signal.frequency is not None:
        for column, label in zip(np.abs(signal.response).T, labels, strict=True):
            axes.loglog(signal.frequency, column, ".-", ms=3, lw=0.8, label=label)
        axes.set_ylabel(f"|{signal.name} / {signal.input}|\n[{signal.unit}]")
    else:
        if signal.pose is not None:
            number = {pose: k for k, pose in enumerate(record.poses)}
            x, look = np.array([number[pose] for pose in signal.pose]), "."
        else:
            x, look = record.instants(signal), "-"
        for column, label in zip(signal.values.T, labels, strict=True):
            axes.plot(x, column, look, lw=0.8, ms=3, label=label)
        axes.set_ylabel(f"{signal.name}\n[{signal.unit}]")
    if any(labels):
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    if signal.name in record.drive:
        axes.set_title("drive", loc="left", fontsize="small")
