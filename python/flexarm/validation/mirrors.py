"""Exchanged and turned axes of sensors of three axes, which no gain of a single channel shows.

    y_k = s_k p_j(k),    s_k = 1 or -1,    j a permutation of x, y, z other than x, y, z itself         (1)

Axes of an inertial sensor that are exchanged leave a reading that no gain explains, and offsets of an
accelerometer hide it, since gravity is one. So (1) is tried as it stands.

Places show an exchanged or turned axis, or a frame of the other hand, in a mirror. Where a frame is unknown
the best turn spreads the fault over all axes. Readings y and predictions p, both from their means, have the
singular values S_1 >= ... >= S_n of sum y p^T. The best turn and the best mirror leave [Umeyama1991]

    sum |y|^2 + |p|^2 - 2 (S_1 + ... -+ S_n)    where the determinant is negative.                      (2)

n is 3, or 2 in a frame whose pose is stated: one that nobody knows may look at a plane from behind. A mirror
Q of a stated frame is told as the signed permutation M nearest to it, that of an unknown one, in which all
mirrors are the same up to a turn, as the inversion -1. It is a hypothesis of `validation.finding`: the places
M^T y, their frame found anew, must cost less than y.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import permutations, product

import numpy as np

from flexarm.arrays import Floats
from flexarm.comparison.simulated_record import SimulatedRecord
from flexarm.record import Signal
from flexarm.validation.channel import Channel, channels
from flexarm.validation.finding import ChannelFinding, cost, log_bayes, total_cost
from flexarm.validation.initial_alignment import initial_alignment
from flexarm.validation.policy import POLICY
from flexarm.wording import listed, with_unit

INERTIAL = ("acceleration", "angular_rate")
"""Quantities along the body axes of a point."""


def exchanged_axes(seen: Mapping[str, Sequence[Channel]]) -> Iterator[str]:
    """Report inertial sensors that (1) explains, and their own axes do not."""
    for name, own in seen.items():
        for signal in dict.fromkeys(channel.signal.name for channel in own):
            axes = [channel for channel in own if channel.signal.name == signal]
            if axes[0].signal.quantity in INERTIAL and len(axes) == 3:
                yield from _exchanged(f"{name}: signals.{signal}", axes)


def _exchanged(where: str, axes: Sequence[Channel]) -> Iterator[str]:
    y, p = _common_rows(axes)
    if not y.size:
        return
    own, names = _rms(y - p), [channel.name for channel in axes]
    tried = [
        (_rms(y - np.array(signs)[:, None] * p[list(order)]), order, signs)
        for order in permutations(range(3))
        if order != (0, 1, 2)
        for signs in product((1, -1), repeat=3)
    ]
    least, order, signs = min(tried)
    if least > POLICY.max_unexplained * min(own, _rms(y)):
        return
    told = [
        f"{names[k]} reads {'-' * (signs[k] < 0)}{names[j]}"
        for k, j in enumerate(order)
        if _rms(y[k] - signs[k] * p[j]) <= POLICY.max_unexplained * _rms(y[k] - p[k])
    ]
    unit = axes[0].signal.unit
    left = f"that leaves {with_unit(least, unit, 2)} rms of {with_unit(own, unit, 2)}"
    yield f"{where}: {listed(told)} of the model's point; {left}: is it mounted so, or are columns exchanged?"


def _common_rows(axes: Sequence[Channel]) -> tuple[Floats, Floats]:
    """Return readings and predictions, (axes, n), of rows that hold all axes."""
    held = np.zeros(len(axes[0].signal), dtype=np.intp)
    for axis in axes:
        held[axis.rows] += 1
    kept = [held[axis.rows] == len(axes) for axis in axes]
    y, p = (
        np.stack([values[rows] for values, rows in zip(of, kept, strict=True)])
        for of in ([each.measured for each in axes], [each.predicted for each in axes])
    )
    return y, p


def _rms(values: Floats) -> float:
    return float(np.sqrt(np.mean(np.sum(np.atleast_2d(values) ** 2, axis=0))))


def with_mirrors(
    name: str, simulated: SimulatedRecord, found: Sequence[ChannelFinding]
) -> list[ChannelFinding]:
    """Return the findings of a record, those of places in a mirror replaced where that costs less."""
    kept = list(found)
    for signals in _groups(simulated):
        own = [each for each in kept if each.channel.signal.name in signals]
        axes = Counter(each.channel.signal.name for each in own)
        if any(axes[label] < len(signal.axes) for label, signal in signals.items()):
            continue  # too few readings
        mirrored = _mirrored(name, simulated, signals, [each.channel for each in own])
        if mirrored and total_cost(mirrored) < total_cost(own) - POLICY.clear_log_odds:
            kept = [*(each for each in kept if each not in own), *mirrored]
    return kept


def _groups(simulated: SimulatedRecord) -> Iterator[dict[str, Signal]]:
    """Yield the places seen in each frame, together and one by one."""
    frames: dict[str, dict[str, Signal]] = {}
    for signal in simulated.evidence.values():
        unknown = simulated.record.frame_of(signal).unknown
        if signal.quantity == "position" and len(signal.axes) >= (3 if unknown else 2):
            frames.setdefault(f"{signal.frame} {signal.axes}", {})[signal.name] = signal
    for signals in frames.values():
        yield signals
        yield from ({name: signal} for name, signal in signals.items() if len(signals) > 1)


def _mirrored(
    name: str, simulated: SimulatedRecord, signals: Mapping[str, Signal], seen: Sequence[Channel]
) -> list[ChannelFinding]:
    """Return the channels of places under a mirror; empty if no mirror explains what no turn does."""
    pairs = [_common_rows([each for each in seen if each.signal.name == signal]) for signal in signals]
    y, p = (np.concatenate(values, axis=1) for values in zip(*pairs, strict=True))
    if not y.size:
        return []
    y, p = (values - values.mean(axis=1, keepdims=True) for values in (y, p))
    u, sizes, vt = np.linalg.svd(y @ p.T)
    moved = float(np.sum(y**2) + np.sum(p**2))
    turned, mirrored = (
        float(np.sqrt(max(moved - 2 * (sizes[:-1].sum() + sign * sizes[-1]), 0.0) / y.shape[1]))
        for sign in (-1, 1)
    )
    missed = max(each.model_error for each in seen)  # model error, alike in both
    before, after = float(np.hypot(turned, missed)), float(np.hypot(mirrored, missed))
    if np.linalg.det(u @ vt) > 0 or after > POLICY.max_unexplained * before:
        return []
    first, show = next(iter(signals.values())), "show" if len(signals) > 1 else "shows"
    M, why = -np.eye(3), "two columns are exchanged, a sign is turned, or a joint counts the other way"
    if not simulated.record.frame_of(first).unknown:
        M = _nearest_permutation(u @ vt)
        why = f"{_exchange(M, first.axes)}, or a joint counts the other way"
    left = f"{with_unit(mirrored, 'm', 2)} rms are left, {with_unit(turned, 'm', 2)} in no mirror"
    sentence = f"{listed(list(signals))} {show} the model in a mirror ({left}): {why}"
    there = {label: signal.replace(values=signal.values @ M) for label, signal in signals.items()}
    again = replace(simulated, signals={**simulated.signals, **there})
    placement, bayes = initial_alignment(again), log_bayes(y.shape[1], before, after)
    found = []
    for channel in channels(name, replace(again, signals=there), placement):
        fit = channel.fit_at_gain(1.0)
        price = cost(channel, fit.rms, fit.penalty)
        turned_over = M[channel.index, channel.index] != 1
        found.append(
            ChannelFinding(channel, "sign_error", bayes, price - POLICY.prior_log_odds, {}, sentence)
            if turned_over
            else ChannelFinding(channel, cost=price)
        )
    return found


def _nearest_permutation(Q: Floats) -> Floats:
    """Return the signed permutation nearest to a mirror."""
    from scipy.optimize import linear_sum_assignment

    rows, columns = linear_sum_assignment(-np.abs(Q))
    M = np.zeros_like(Q)
    M[rows, columns] = np.sign(Q[rows, columns])
    return M


def _exchange(M: Floats, axes: Sequence[str]) -> str:
    """Return in words what each axis reads that does not read itself."""
    read = [(k, int(np.argmax(np.abs(row)))) for k, row in enumerate(M)]
    return listed(
        [f"{axes[k]} reads {'-' * bool(M[k, j] < 0)}{axes[j]}" for k, j in read if M[k, j] != (k == j)]
    )
