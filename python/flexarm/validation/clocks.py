"""Consistency of clocks: clocks that step or were set anew, signals that come late.

The delay of a clock in one record follows from the regression of `validation.channel`,

    d = v . e / v . v,     sigma = rms(e - d v) sqrt(n / m) / |v|                                      (1)

v is minus the rate of the prediction and e the gap, both without what the other regressors explain, m the
number of `independent_samples`. Two records contradict each other beyond `min_clock_step` and `min_sigmas`.
A signal is late, by steps (1) until they rest, if its gap without its mean falls to less than one
`unusual_ratio`, and the delay is beyond both and the stated sigma of its clock.

The delay of a clock that steps by d at the time T adds a term to the model of `validation.channel`, with
Heaviside's step H,

    y = s p + sum a c - d H(t - T) dp/dt + e.                                                          (2)

A step is reported if it explains `predominant_share` of the squares of e for one channel of the clock, and
no other channel contradicts it: (1) gives the uncertainty of d there, beyond which two channels differ as two
records do. A missing effect acts before T as after it, and on each channel otherwise.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from flexarm.arrays import Floats
from flexarm.comparison.alignment_parameters import drive_clock
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.measurement.encoder import told
from flexarm.record import Signal
from flexarm.validation.channel import QUASI_STATIC, Channel, orthonormal_columns
from flexarm.validation.initial_alignment import initial_alignment
from flexarm.validation.policy import POLICY
from flexarm.validation.unshared import Unshared
from flexarm.wording import instant, with_unit


def unshared_clocks(
    simulations: Mapping[str, SimulatedRecord], channels: Mapping[str, Sequence[Channel]]
) -> Iterator[Unshared]:
    """Yield clocks of one name whose delays in two records differ, by the channels of each."""
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
                difference = (
                    f"on the model its offset is {with_unit(a, 's', 3)} in the one and "
                    f"{with_unit(b, 's', 3)} in the other, +- {with_unit(sigma, 's', 1)}"
                )
                yield Unshared(
                    "clocks", clock, one, other, difference, "; if it was set anew, give it two names"
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


def remarks_on_clocks(
    simulations: Mapping[str, SimulatedRecord], seen: Mapping[str, Sequence[Channel]]
) -> list[str]:
    """Report steps of the delay of every clock in every record, of which `seen` are the channels."""
    found = []
    for name, simulated in simulations.items():
        if simulated.record.kind == "static":
            continue
        by_clock: dict[str, list[_Steps]] = {}
        for channel in seen[name]:
            if channel.signal.quantity in QUASI_STATIC and len(channel.rows) > 30:
                by_clock.setdefault(channel.signal.clock, []).append(_steps(channel))
        for clock, steps in by_clock.items():
            best = max(steps, key=lambda each: each.share.max())
            k = int(np.argmax(best.share))
            step, at = float(best.step[k]), float(best.instants[k])
            shown = best.share[k] > POLICY.predominant_share and abs(step) > POLICY.min_clock_step
            if shown and not any(each.contradicts(step, float(best.sigma[k]), at) for each in steps):
                jump = f"{name}: the clock {clock} jumps by {1e3 * step:.3g} ms near t = {instant(at)} s"
                found.append(f"{jump}, as {best.label} shows")
    return found


@dataclass(frozen=True, eq=False)
class _Steps:
    """Steps of the delay of a channel, at each of some instants."""

    label: str
    instants: Floats
    step: Floats
    """[s], with 1 sigma."""
    sigma: Floats
    share: Floats
    """Of the squares that the step explains."""

    def contradicts(self, step: float, sigma: float, at: float) -> bool:
        """Return True if the channel has another step at an instant, beyond what both leave open."""
        k = int(np.argmin(np.abs(self.instants - at)))
        least = POLICY.min_sigmas * float(np.hypot(sigma, self.sigma[k]))
        return abs(float(self.step[k]) - step) > max(POLICY.min_clock_step, least)


def _steps(channel: Channel) -> _Steps:
    """Return the steps of the delay of a channel at instants over its time."""
    rate = channel.regressors[:, -1]  # of a place or angle the last column is -dp/dt
    Q = orthonormal_columns(np.column_stack([channel.predicted, channel.regressors]))
    e = channel.measured - Q @ (Q.T @ channel.measured)
    e -= Q @ (Q.T @ e)
    whole = float(e @ e) or 1.0
    instants = np.linspace(channel.time[0], channel.time[-1], POLICY.clock_step_times + 2)[2:-2]
    first = np.searchsorted(channel.time, instants, side="right")

    def after(rows: Floats) -> Floats:
        """Return the sums of the rows after each instant."""
        sums = np.cumsum(rows, axis=0)
        return np.asarray(sums[-1] - sums[first - 1])

    squares = after(rate**2)
    size = squares - np.sum(after(rate[:, None] * Q) ** 2, axis=1)  # of the step that Q does not explain
    size[size <= 1e-12 * squares] = np.inf
    along = after(rate * e)
    step = along / size
    share = step * along / whole
    left = whole * (1.0 - share) / min(len(e), POLICY.independent_samples)
    sigma = np.where(np.isinf(size), np.inf, np.sqrt(np.maximum(left, 0.0) / size))
    return _Steps(channel.label, instants, step, sigma, share)
