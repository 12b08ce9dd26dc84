"""What a person should know of stamps: pauses, and drop-outs beyond what is usual.

A pause is an interval of more than `PAUSE` usual ones; drop-outs are said from `LOST` of the rows on.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from flexarm.record import Record, Signal

PAUSE, LOST = 20.0, 0.1


def remarks_on_stamps(records: Mapping[str, Record]) -> list[str]:
    """Pauses and drop-outs of all signals."""
    return [
        f"{name}: {remark}"
        for name, record in records.items()
        for signal in record.signals.values()
        for remark in _remarks(signal)
    ]


def _remarks(signal: Signal) -> list[str]:
    found = []
    lost = 1.0 - float(np.mean(signal.valid)) if len(signal) else 1.0
    if lost > LOST:
        found.append(f"{signal.name} holds no value in {lost:.0%} of its {len(signal)} rows")
    if len(signal.time) > 2:
        steps = np.diff(signal.time)
        worst = int(np.argmax(steps))
        if steps[worst] > PAUSE * np.median(steps):
            found.append(
                f"{signal.name} pauses for {steps[worst]:.3g} s after t = {signal.time[worst]:.6g} s; "
                f"its samples are usually {np.median(steps):.3g} s apart"
            )
    return found
