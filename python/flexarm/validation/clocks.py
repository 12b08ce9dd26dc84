"""Consistency of clocks: clocks that were set anew, signals that come late.

The delay of a clock in one record follows from the regression of `validation.channel`,

    d = v . e / v . v,     sigma = rms(e - d v) sqrt(n / m) / |v|                                      (1)

v is minus the rate of the prediction and e the gap, both without what the other regressors explain, m the
number of `independent_samples`. Two records contradict each other beyond `min_clock_step` and `min_sigmas`.
A signal is late, by steps (1) until they rest, if its gap without its mean falls to less than one
`unusual_ratio`, and the delay is beyond both and the stated sigma of its clock.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np

from flexarm.arrays import Floats
from flexarm.comparison.alignment_parameters import drive_clock
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.measurement.encoder import told
from flexarm.record import Signal
from flexarm.validation.channel import QUASI_STATIC, Channel
from flexarm.validation.initial_alignment import initial_alignment
from flexarm.validation.policy import POLICY
from flexarm.wording import with_unit


def remarks_on_shared_clocks(
    simulations: Mapping[str, SimulatedRecord], channels: Mapping[str, Sequence[Channel]]
) -> Iterator[str]:
    """Report clocks of one name whose delays in two records differ, by the channels of each."""
    if len(simulations) < 2:
        return
    found: dict[str, dict[str, tuple[float, float]]] = {}
    for name, simulated in simulations.items():
        if simulated.record.kind != "motion":
            continue
        placement, own = initial_alignment(simulated), drive_clock(simulated.record)
        seen: dict[str, list[tuple[float, float]]] = {}
        for channel in channels[name]:
            if channel.signal.clock != own and channel.signal.quantity in QUASI_STATIC:
                seen.setdefault(channel.signal.clock, []).append(
                    _delay(channel.measured, channel.predicted, channel.regressors)
                )
        for clock, delays in seen.items():
            delay, sigma = min(delays, key=lambda each: each[1])
            stated = placement.clocks[clock].delay
            found.setdefault(clock, {})[name] = stated + delay, sigma
    for clock, records in found.items():
        for (one, (a, std_a)), (other, (b, std_b)) in combinations(records.items(), 2):
            step, sigma = abs(a - b), float(np.hypot(std_a, std_b))
            if step > max(POLICY.min_clock_step, POLICY.min_sigmas * sigma):
                yield (
                    f"{one} and {other} do not share the clock {clock}: on the model its offset is "
                    f"{with_unit(a, 's', 3)} in the one and {with_unit(b, 's', 3)} in the other, "
                    f"+- {with_unit(sigma, 's', 1)}; if it was set anew, give it two names"
                )


def _delay(measured: Floats, predicted: Floats, regressors: Floats) -> tuple[float, float]:
    """Return the delay (1) of a channel and its sigma [s]; an infinite sigma if it does not move."""
    A = np.column_stack([predicted, regressors[:, :-1]])
    Q = np.linalg.qr(A[:, np.any(A != 0, axis=0)])[0]
    e, v = (each - Q @ (Q.T @ each) for each in (measured, regressors[:, -1]))
    square = float(v @ v)
    if square <= 0:
        return 0.0, np.inf
    delay = float(v @ e) / square
    left = float(np.sum((e - delay * v) ** 2))
    return delay, float(np.sqrt(left / min(len(e), POLICY.independent_samples) / square))


def remarks_on_late_signals(simulations: Mapping[str, SimulatedRecord]) -> Iterator[str]:
    """Report signals that come late or early on their stated clocks, by more than the model misses."""
    for name, simulated in simulations.items():
        if simulated.record.kind == "motion":
            placement = initial_alignment(simulated)
            for signal in simulated.evidence.values():
                if signal.quantity in QUASI_STATIC and not simulated.record.clocks[signal.clock].unknown:
                    yield from (f"{name}: {what}" for what in _lateness(simulated, placement, signal))


def _lateness(simulated: SimulatedRecord, placement: Placement, signal: Signal) -> Iterator[str]:
    rows = np.flatnonzero(signal.valid)
    rows = rows[:: -(-len(rows) // POLICY.rigid_rows) or 1]
    if len(rows) < POLICY.min_rows:
        return
    instants, values = simulated.instants(signal, placement)[rows], signal.values[rows]
    shown = told(simulated.simulation, signal, simulated.record.drive)

    def centred(shift: float) -> Floats:
        shifted = np.clip(instants - shift, *simulated.simulation.time[[0, -1]])
        found = simulated.reading(shown, shifted, placement)
        return np.asarray(found - np.mean(found, axis=0))

    measured = values - np.mean(values, axis=0)
    delay, h = 0.0, POLICY.short_delay
    for _ in range(POLICY.registration_steps):
        rate = (centred(delay + h) - centred(delay - h)) / (2 * h)
        square = float(np.sum(rate**2))
        change = float(np.sum(rate * (measured - centred(delay)))) / square if square > 0 else 0.0
        delay += change
        if abs(change) < POLICY.min_clock_step / 10:
            break
    before, after = (float(np.sqrt(np.sum((measured - centred(d)) ** 2))) for d in (0.0, delay))
    if square <= 0 or not before > POLICY.unusual_ratio * after:
        return
    sigma = after / np.sqrt(min(len(rows), POLICY.independent_samples) * square)
    stated = float(np.hypot(sigma, simulated.record.clocks[signal.clock].sigma))
    if abs(delay) > max(POLICY.min_clock_step, POLICY.min_sigmas * stated):
        word = "late" if delay > 0 else "early"
        was, left = (with_unit(size / len(rows) ** 0.5, signal.unit, 2) for size in (before, after))
        yield (
            f"{signal.name} comes {with_unit(abs(delay), 's', 3)} {word} on the clock {signal.clock}: so "
            f"shifted, its gap is {left} rms in place of {was}; give it a clock of its own "
            'in [clocks], "unknown" if nobody knows how late it is'
        )
