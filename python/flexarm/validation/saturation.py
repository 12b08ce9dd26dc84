"""Saturated and frozen channels, from their plateaus.

A plateau is a run of rows that agree to within the noise while the prediction moves on:

    max y - min y <= 6 noise (or 0),   max p - min p >= max(10 noise, 0.2 std p)                       (1)

A saturated channel shows p cut off at a level:

    its plateaus lie at the greatest (or least) reading, and p is beyond it there                      (2)

With noise the readings at the level must also outnumber those just below it four times, and p must go on by
a good part of its motion and by more than models miss. An arm that friction holds at the end of a move looks
alike, but the model leaves it by little.

A frozen channel repeats a value. p counts in (1) only while a drive moves, as a model without damping may
ring on at rest. Counts of a coarse grid repeat while the arm moves slowly, so that p must move by
`plateau_steps` of theirs; channels of one sensor have one grid. Stiction holds a joint but not its noise. A
noisy plateau is frozen only for places and angles, and only where p moves by `noisy_plateau_motion`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flexarm.arrays import Floats
from flexarm.validation.channel import QUASI_STATIC, Channel
from flexarm.validation.finding import ChannelFinding, cost, log_bayes
from flexarm.validation.policy import POLICY

Rows = NDArray[np.bool_]
Run = tuple[int, int]  # first row, last row (exclusive)


def plateaus(y: Floats, p: Floats, driven: Rows, noise: float, least: float) -> list[Run]:
    """Return all runs (1), exact and noisy; a prediction that moves by less than `least` is at rest."""
    moves = max(10 * noise, POLICY.plateau_motion * float(np.std(p)), least)
    fewest = rows_to_move(p, moves)
    found = exact = repeats(y)
    noisy = constant_runs(y, 6 * noise, fewest) if noise > 0 else []
    if noisy:
        taken = np.zeros(len(y) + 1, dtype=int)
        for first, last in exact:
            taken[first + 1 : last + 1] = 1
        taken = np.cumsum(taken)
        found = [*exact, *((i, j) for i, j in noisy if taken[i] == taken[j])]
    return [(i, j) for i, j in found if j - i >= fewest and moved(p, driven, (i, j)) >= moves]


def rows_to_move(p: Floats, moves: float) -> int:
    """Return the rows below which no run of a prediction moves by `moves`, from its greatest step."""
    step = float(np.max(np.abs(np.diff(p)), initial=0.0))
    if moves <= POLICY.min_plateau_rows * step:
        return POLICY.min_plateau_rows
    return len(p) + 1 if step * len(p) < moves else int(moves / step)


def moved(p: Floats, driven: Rows, run: Run) -> float:
    """Return the range of a prediction in a plateau while a drive moves."""
    part = slice(*run)
    return float(np.ptp(p[part][driven[part]])) if driven[part].any() else 0.0


def repeats(y: Floats) -> list[Run]:
    """Return the longest runs of rows of one value."""
    ends = np.flatnonzero(np.diff(y) != 0) + 1
    firsts, lasts = np.append(0, ends), np.append(ends, len(y))
    long = lasts - firsts >= POLICY.min_plateau_rows
    return [(int(i), int(j)) for i, j in zip(firsts[long], lasts[long], strict=True)]


def constant_runs(y: Floats, width: float, fewest: int = POLICY.min_plateau_rows) -> list[Run]:
    """Return the longest runs of at least `fewest` rows that stay within `width`, from the left."""
    from scipy.ndimage import maximum_filter1d, minimum_filter1d

    if width == 0:
        return repeats(y)
    if fewest > len(y):
        return []
    high, low = (each(y, fewest, origin=-(fewest // 2)) for each in (maximum_filter1d, minimum_filter1d))
    begins = np.flatnonzero((high - low <= width)[: len(y) - fewest + 1])
    found: list[Run] = []
    k = 0
    while k < len(begins):
        i = int(begins[k])
        j = _end_of_run(y, i, width)
        found.append((i, j))
        k = int(np.searchsorted(begins, j))
    return found


def _end_of_run(y: Floats, first: int, width: float) -> int:
    """Return the first row after `first` beyond `width`, looked for in parts that double."""
    rows = 4 * POLICY.min_plateau_rows
    while True:
        part = y[first : first + rows]
        beyond = np.maximum.accumulate(part) - np.minimum.accumulate(part) > width
        if beyond.any():
            return first + int(np.argmax(beyond))
        if first + rows >= len(y):
            return len(y)
        rows *= 2


def find_saturation(channel: Channel) -> tuple[ChannelFinding, Rows] | None:
    """Return the saturated channel and its rows at the ends of the range, or None."""
    y, p = channel.measured, channel.predicted
    noise = channel.signal.noise_std or 0.0
    found = []
    for side in (1.0, -1.0):
        steps = POLICY.plateau_steps * channel.signal.grid_step
        cut = _cut(side * y, side * p, noise, channel.model_error, steps)
        if cut is not None:
            found.append((side, *cut))
    if not found:
        return None
    at = np.logical_or.reduce([rows for _, rows, _ in found])
    ends = " and ".join(
        f"{side * level:.5g} {channel.signal.unit} ({rows.sum()} rows)" for side, rows, level in found
    )
    bayes, after, beyond = _compare_cut(channel, at)
    if bayes <= 0:
        return None
    limit = float(np.mean([abs(level) for _, _, level in found]))
    std = max(noise, 1e-9 * limit) / np.sqrt(at.sum())
    sentence = (
        f"{channel.label} stops at {ends}, the end of its range: the model goes on by "
        f"{beyond:.2g} {channel.signal.unit} there"
    )
    values = {"limit": (limit, float(std), channel.signal.unit)}
    price = cost(channel, max(after, _rms_of(channel.select(~at)))) - POLICY.prior_log_odds
    return ChannelFinding(channel, "saturation", bayes, price, values, sentence), at


def _cut(y: Floats, p: Floats, noise: float, floor: float, steps: float = 0.0) -> tuple[Rows, float] | None:
    """Return the rows at the upper end and its level if (2) holds there, else None."""
    at, level, width = _end(y, noise)
    inner = ~at & ~_end(-y, noise)[0]
    fewest = (
        max(POLICY.min_plateau_rows, POLICY.negligible_share * len(y)) if width else POLICY.min_plateau_rows
    )
    if at.sum() < fewest or at.sum() > 0.9 * len(y):
        return None
    at_level, below = (np.sum(np.abs(y - each) <= noise) for each in (level, level - 5 * noise))
    if width and at_level <= 4 * below:  # at a smooth maximum 2.2 times as many
        return None
    shift, left = _centre_and_scatter(y[inner] - p[inner], floor)
    moving = float(np.std(p))
    least = max(10 * noise, POLICY.plateau_motion * moving, floor) if width else max(5 * noise, 0.02 * moving)
    enough = max(least, 3 * left, steps)
    goes_on = np.ptp(p[at]) >= enough and np.quantile(p[at] + shift - level, 0.8) >= enough / 2
    within = np.mean(p[~at] + shift <= level + max(3 * left, 5 * noise)) > 0.95
    return (at, level) if goes_on and within else None


def _end(y: Floats, noise: float) -> tuple[Rows, float, float]:
    """Return the rows at the upper end, its level, and their width: 0, or that of the noise."""
    top = float(np.max(y))
    exact = y == top
    if exact.sum() >= POLICY.min_plateau_rows:
        return exact, top, 0.0
    at = y >= top - 6 * noise
    return at, float(np.median(y[at])), 6 * noise


def _centre_and_scatter(gap: Floats, floor: float) -> tuple[float, float]:
    """Return the median of a gap and its scatter; for few rows 0 and the model error."""
    if len(gap) < POLICY.min_plateau_rows:
        return 0.0, floor
    middle = float(np.median(gap))
    return middle, float(np.sqrt(np.mean((gap - middle) ** 2)))


def _compare_cut(channel: Channel, at: Rows) -> tuple[float, float, float]:
    """Return the log Bayes factor of a cut at these rows, its scatter, and the greatest distance of p."""
    y, p = channel.measured[at], channel.predicted[at]
    noise = channel.signal.noise_std or 0.0
    gap = _centre_and_scatter(channel.measured[~at] - channel.predicted[~at], channel.model_error)[0]
    before = float(np.sqrt(np.mean((y - p - gap) ** 2)))
    groups = y > np.median(channel.measured)
    spread = max((float(np.std(y[g])) for g in (groups, ~groups) if g.any()), default=0.0)
    after = max(spread, noise, 1e-3 * before)
    return log_bayes(int(at.sum()), before, after), after, float(np.max(np.abs(p + gap - y)))


def _rms_of(rest: Channel) -> float:
    """Return the rms residual of the other rows, 0 if there are none."""
    return rest.fit_at_gain(1.0).rms if len(rest.rows) else 0.0


def find_frozen(channel: Channel) -> tuple[Rows, str] | None:
    """Return the rows where the channel repeats a value while the prediction moves, and a sentence."""
    noise = channel.signal.noise_std or 0.0
    y, p = channel.measured, channel.predicted
    at = np.zeros(len(y), dtype=bool)
    rounding = 1e-9 * float(np.nanmax(np.abs(channel.signal.values)))
    least = max(rounding, POLICY.plateau_steps * channel.signal.grid_step)  # no step: readings on no grid
    for run in plateaus(y, p, channel.driven, noise, least):
        part = slice(*run)
        far = (
            moved(p, channel.driven, run) >= POLICY.noisy_plateau_motion * float(np.std(p))
            and channel.signal.quantity in QUASI_STATIC
        )
        if far or np.ptp(y[part]) == 0:
            at[part] = True
    if not at.any():
        return None
    first = channel.time[np.argmax(at)]
    return at, f"{channel.label} repeats a value in {at.sum()} rows from t = {first:.4g} s on"


def frozen_as_dead(channel: Channel, at: Rows, sentence: str) -> ChannelFinding | None:
    """Return a dead channel if it is frozen in `lost_share` of its rows, else None."""
    if at.mean() < POLICY.lost_share:
        return None
    y, p = channel.measured[at], channel.predicted[at]
    before = replace(channel.select(at), model_error=0.0).fit_at_gain(1.0).scatter
    after = max(channel.noise, 1e-3 * before)
    bayes = log_bayes(int(at.sum()), before, after)
    if bayes <= 0:
        return None
    value = float(np.median(y))
    price = cost(channel, max(after, _rms_of(channel.select(~at)))) - POLICY.prior_log_odds
    values = {"value": (value, channel.noise / np.sqrt(at.sum()), channel.signal.unit)}
    moved = f"{sentence}, while the model moves by {np.ptp(p):.3g} {channel.signal.unit}"
    return ChannelFinding(channel, "dead_channel", bayes, price, values, moved)
