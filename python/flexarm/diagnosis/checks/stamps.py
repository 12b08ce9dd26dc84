"""What a person should know of samples: pauses, drop-outs, and noise unlike the stated one.

A pause is an interval of more than `PAUSE` usual ones; drop-outs are said from `LOST` of the rows on. The
noise of angles, which are smooth from sample to sample, shows in their third differences,

    std(y_{i+3} - 3 y_{i+2} + 3 y_{i+1} - y_i) = sqrt(20) noise                                        (1)

and is said where it is `UNLIKE` times the stated one, or as many times less.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from flexarm.record import Record, Signal

PAUSE, LOST, UNLIKE = 20.0, 0.1, 3.0
SMOOTH_RATE = 50.0
"""Rate from which on (1) holds [Hz]."""


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
    if LOST < lost < 1:  # that a signal holds nothing is why it is not compared, which is said
        found.append(f"{signal.name} holds no value in {lost:.0%} of its {len(signal)} rows")
    if len(signal.time) > 2:
        steps = np.diff(signal.time)
        worst = int(np.argmax(steps))
        if steps[worst] > PAUSE * np.median(steps):
            found.append(
                f"{signal.name} pauses for {steps[worst]:.3g} s after t = {signal.time[worst]:.6g} s; "
                f"its samples are usually {np.median(steps):.3g} s apart"
            )
    if signal.quantity == "joint_angle" and signal.noise_std and signal.rate_hz >= SMOOTH_RATE:
        found += _noise(signal, signal.noise_std)
    return found


def _noise(signal: Signal, stated: float) -> list[str]:
    """Noise by (1), robustly, if it is unlike the stated one."""
    third = np.diff(signal.values[:, 0], 3)
    third = np.abs(third[np.isfinite(third)])
    noise = 1.48 * float(np.median(third)) / np.sqrt(20) if len(third) else 0.0  # eq. (1)
    if noise == 0 or stated / UNLIKE < noise < stated * UNLIKE:
        return []
    return [f"the noise of {signal.name} is about {noise:.2g} {signal.unit}, stated is {stated:.2g}"]
