"""Clocks that jump: a delay that changes within a record.

    y = s p + sum a c - d H(t - T) dp/dt + e                                                           (1)

d is the step of the delay at the time T, H Heaviside's step, the rest as in
`validation.regression`. A step is said if it takes away `EXPLAINED` of the squares of e for one
of the channels of that clock; a missing effect acts before T as after it.

What a person should know of samples: pauses, drop-outs, and noise unlike the stated one.

A pause is an interval of more than `PAUSE` usual ones; drop-outs are said from `LOST` of the rows on. The
noise of angles, which are smooth from sample to sample, shows in their third differences,

    std(y_{i+3} - 3 y_{i+2} + 3 y_{i+1} - y_i) = sqrt(20) noise                                        (1)

and is said where it is `UNLIKE` times the stated one, or as many times less.

Records that say they begin at rest, and a drive that moves in their first sample.

The run would start with a jump of the rate and ring with it, which the arm did not: it was moving before.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexarm.validation.channel import Channel, channels
from flexarm.validation.initial_alignment import placing
from flexarm.validation.saturation import SLOW

if TYPE_CHECKING:
    from flexarm.comparison.simulated_record import SimulatedRecord
    from flexarm.record import Record, Signal


EXPLAINED = 0.8
SHORTEST = 3e-3
"""Steps of the delay that are said [s]."""
TIMES = 60
"""Instants T that are tried."""


def remarks_on_clocks(simulations: Mapping[str, SimulatedRecord]) -> list[str]:
    """Steps of the delay of every clock in every record."""
    found = []
    for name, simulated in simulations.items():
        if simulated.record.kind == "static":
            continue
        best: dict[str, tuple[float, float, float, str]] = {}
        for channel in channels(name, simulated, placing(simulated)):
            clock = channel.signal.clock
            if channel.signal.quantity in SLOW and len(channel.rows) > 30:
                best[clock] = max(best.get(clock, (0.0, 0.0, 0.0, "")), _step(channel))
        found += [
            f"{name}: the clock {clock} jumps by {1e3 * step:.3g} ms near t = {at:.4g} s, as {label} shows"
            for clock, (share, step, at, label) in best.items()
            if share > EXPLAINED and abs(step) > SHORTEST
        ]
    return found


def _step(channel: Channel) -> tuple[float, float, float, str]:
    """Share of the squares that a step of the delay explains, the step [s], its time, the channel."""
    rate = channel.columns[:, -1]  # of a place or angle the last column is -dp/dt
    A = np.column_stack([channel.predicted, channel.columns])
    A = A[:, np.any(A != 0, axis=0)]
    Q = np.linalg.qr(A)[0]
    e = channel.measured - Q @ (Q.T @ channel.measured)
    whole = float(e @ e) or 1.0
    best = (0.0, 0.0, 0.0, channel.label)
    for at in np.linspace(channel.time[0], channel.time[-1], TIMES + 2)[2:-2]:
        late = np.where(channel.time > at, rate, 0.0)
        late = late - Q @ (Q.T @ late)
        size = float(late @ late)
        if size > 0:
            step = float(late @ e) / size
            best = max(best, (step**2 * size / whole, step, float(at), channel.label))
    return best


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


SUDDEN = 0.05
"""Rate with which a drive begins, over its greatest one, above which it was moving before."""


def remarks_on_starts(simulations: Mapping[str, SimulatedRecord]) -> Iterator[str]:
    """A sentence for every record of which a drive says otherwise than the record."""
    for name, simulated in simulations.items():
        record = simulated.record
        if record.kind == "static" or record.initial == "moving":
            continue
        run = simulated.simulation
        for signal in (record.signals[drive] for drive in record.drive):
            if signal.quantity != "joint_angle":
                continue
            rate = np.abs(run.drive_rate[:, run.joints.index(signal.joint)])
            if len(rate) > 1 and rate[1] > SUDDEN * rate.max():
                share = f"{100 * rate[1] / rate.max():.0f} % of its greatest rate"
                yield (
                    f"{name}: {signal.name} moves in the first sample, at {share}, and the record says that "
                    'it begins at rest; if it does not, state initial = "moving"'
                )
