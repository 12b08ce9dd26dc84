"""Signs of joints and counts of encoders, by how near the model's points come to the measured ones.

That is how near the rigid arm's point comes to a measured one after the best lag and rigid motion. With
measured points y, predicted ones x at the same instants and their means taken off,

    r² = min over R, det R = 1, of mean |y − R x|² = mean |y|² + mean |x|² − 2 (σ₁ + σ₂ + s σ₃)          (1)

with σ the singular values of mean y xᵀ and s = sign det. The lag is the best around the
one of `agreement`. Source: [Umeyama1991].
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.joint import motor_ratio
from flexarm.arrays import Floats
from flexarm.importing.guess.motion import Track, agreement, rigid_track
from flexarm.importing.guess.proposal import Option, Proposal, drives_of, in_output, words_of

NEARER = 0.5
"""A sign or count is taken where it leaves at most this share of what the model leaves without it."""
ALIKE = 1.2
"""Hypotheses that leave up to so many times what the best one leaves are not told apart."""
COUNTS = tuple(
    sorted(
        {2**k for k in range(9, 25)}
        | {digit * 10**k for digit in (1, 2, 4, 5, 8) for k in (3, 4, 5)}
        | {360, 2500, 3600, 7200, 36_000, 360_000, 1_000_000}
    )
)
"""Usual counts of an encoder for one turn."""


@dataclass(frozen=True)
class Hypothesis:
    """Signs of joints, counts per turn, and what they leave of a measured point."""

    signs: Mapping[str, float]
    option: Option | None
    left: Registration

    @property
    def turned(self) -> tuple[str, ...]:
        """Joints that run against the model's axes."""
        return tuple(name for name, sign in self.signs.items() if sign < 0)


def settle_signs(proposals: Sequence[Proposal], arm: Arm) -> None:
    """Give signs and counts per turn, where a point that moves was measured along three axes."""
    most_joints = 6  # joints whose signs are tried together
    points = [p for p in proposals if p.quantity == "position" and not p.out and len(p.columns) == 3]
    moving = [p for p in points if p.moves() and len(p.track().time) > 8]
    seen = max(moving, key=lambda p: p.track().size, default=None)
    drives = drives_of(proposals)
    known, counted = [p for p in drives if not p.counts], [p for p in drives if p.counts]
    if seen is not None and known and len(known) <= most_joints:
        _settle_units(known, seen, arm)
        left = _leaves(arm, seen, {p.place[1]: in_output(p, arm) for p in known})
        tried = [Hypothesis(signs, None, left(signs)) for signs in _signs(known)]
        _give_signs(tried, known, seen)
    if seen is not None and counted and len(counted) <= most_joints:
        still, *tried = _tried_counts(arm, seen, known, counted)
        _give_counts(still, tried, counted, seen)
    for proposal in (p for p in proposals if p.counts and "unit" not in p.keys):
        proposal.out = True
        proposal.keys["unit"] = {"counts_per_turn": 0}
        proposal.unknown["unit"] = "no measured point tells how many counts are a turn"


def _signs(of: Sequence[Proposal]) -> Iterator[dict[str, float]]:
    """Yield all signs of joints that move, those with fewer turned ones first."""
    moving = [p.place[1] for p in of if p.moves()]
    for signs in sorted(product((1.0, -1.0), repeat=len(moving)), key=lambda each: -sum(each)):
        yield dict.fromkeys((p.place[1] for p in of), 1.0) | dict(zip(moving, signs, strict=True))


def _leaves(
    arm: Arm, seen: Proposal, joints: Mapping[str, Track]
) -> Callable[[Mapping[str, float]], Registration]:
    """Return what signs of joints leave of a measured point."""
    measured = seen.track()

    def left(signs: Mapping[str, float]) -> Registration:
        turned = {name: replace(t, values=signs.get(name, 1.0) * t.values) for name, t in joints.items()}
        return registration(arm, seen.place[1], turned, measured)

    return left


def _tried_counts(
    arm: Arm, seen: Proposal, known: Sequence[Proposal], counted: Sequence[Proposal]
) -> Iterator[Hypothesis]:
    """Yield what is left with the counted joints at rest, then with usual counts and all signs."""
    still = 10**12  # counts per turn with which a joint stands still
    # Size of the model's motion over the measured one, beyond which counts are not tried.
    sizes = (1 / 3, 3.0)
    joints = {p.place[1]: in_output(p, arm) for p in known}
    geared = any(abs(motor_ratio(arm, p.place[1])) != 1 for p in counted)
    options = [(count, gear) for gear in ((True, False) if geared else (False,)) for count in COUNTS]
    for option in [(still, False), *options]:
        here = joints | {p.place[1]: in_output(p, arm, option) for p in counted}
        ratio = rigid_track(arm, seen.place[1], here, range(3)).size / seen.track().size
        if option[0] != still and not sizes[0] < ratio < sizes[1]:
            continue
        left = _leaves(arm, seen, here)
        for signs in _signs(counted) if option[0] != still else [{}]:
            yield Hypothesis(signs, option, left(signs))


def _settle_units(joints: Sequence[Proposal], seen: Proposal, arm: Arm) -> None:
    """Take the unit with which the model comes far nearer to the point than with the rivals, if one does."""
    options = [None, *dict.fromkeys(option for proposal in joints for option in proposal.rivals)]
    if len(options) == 1:
        return
    left = {}
    for option in options:
        tracks = {p.place[1]: in_output(p, arm, option if option in p.rivals else None) for p in joints}
        leaves = _leaves(arm, seen, tracks)
        left[option] = min(leaves(signs).rms for signs in _signs(joints))
    best, second = sorted(options, key=lambda option: left[option])[:2]
    if left[best] > NEARER * left[second]:
        return
    near = f"the model comes to within {_size(left[best])} rms, {_size(left[second])} with other units"
    for proposal in (p for p in joints if p.rivals):
        proposal.unknown.pop("unit", None)
        if best in proposal.rivals:
            proposal.take(best)
        key = "unit" if "unit" in proposal.why else "before_gear"
        proposal.why[key] = "; ".join(filter(None, (proposal.why.get(key), near)))


def _give_signs(tried: Sequence[Hypothesis], joints: Sequence[Proposal], seen: Proposal) -> None:
    """Give the signs of known joints."""
    as_is, alike = tried[0], _alike(tried)
    chosen = alike[0]
    gain = chosen.left.rms / as_is.left.rms if as_is.left.rms > 0 else 1.0
    in_axes = [h for h in alike if h.left.shifted <= ALIKE * h.left.rms]
    if len(in_axes) == 1 and in_axes[0] is not chosen:  # a tracker along the base's axes tells more
        chosen = in_axes[0]
        gain = chosen.left.shifted / as_is.left.shifted
    ordered = chosen.left.rms <= NEARER * min(h.left.mirrored for h in tried)
    if "columns" in seen.unknown and ordered:
        seen.unknown.pop("columns")
        seen.why["columns"] += "; x, y, z up to a turn of their axes, by how near the model comes"
    told = f"against the model's axis: {_left_of(chosen, seen)}, {_size(as_is.left.rms)} without"
    for proposal in joints:
        name = proposal.place[1]
        if name in chosen.turned and gain <= NEARER:
            proposal.keys["scale"], proposal.why["scale"] = -1.0, told
            if "columns" in seen.unknown:
                proposal.unknown["scale"] = f"the sign holds if the columns of {seen.place[1]} are x, y, z"
        elif name in chosen.turned:
            proposal.unknown["scale"] = f"the sign; with -1 {_left_of(chosen, seen)}"
        others = [set(h.turned) ^ set(chosen.turned) for h in alike if h is not chosen]
        if len(in_axes) != 1 and (mine := [sorted(names) for names in others if name in names]):
            proposal.unknown["scale"] = f"the sign; with {' and '.join(mine[0])} turned the model fits alike"


def _give_counts(
    still: Hypothesis, tried: Sequence[Hypothesis], joints: Sequence[Proposal], seen: Proposal
) -> None:
    """Give counts per turn, one for all encoders that count, and their signs."""
    alike = _alike(tried)
    if not alike or alike[0].left.rms > NEARER * still.left.rms:
        return
    chosen = alike[0]
    others = list(dict.fromkeys(h.option for h in alike if h.option != chosen.option and h.option))
    assert chosen.option is not None
    for proposal in joints:
        proposal.keys["unit"] = {"counts_per_turn": chosen.option[0]}
        proposal.why["unit"] = f"of usual counts: {_left_of(chosen, seen)}, {_size(still.left.rms)} at rest"
        if chosen.option[1]:
            proposal.keys["before_gear"] = True
        if others:
            proposal.unknown["unit"] = f"{', '.join(map(words_of, others))} fits almost as well"
        if proposal.place[1] in chosen.turned:
            proposal.keys["scale"], proposal.why["scale"] = -1.0, "against the model's axis, by the same"


def _alike(tried: Sequence[Hypothesis]) -> list[Hypothesis]:
    """Return the hypotheses that leave about as little as the best, those with fewer turned joints first."""
    best = min((h.left.rms for h in tried), default=np.inf)
    found = [h for h in tried if h.left.rms <= ALIKE * best]
    return sorted(found, key=lambda h: (len(h.turned), h.left.rms))


def _left_of(hypothesis: Hypothesis, seen: Proposal) -> str:
    return f"the model comes to within {_size(hypothesis.left.rms)} rms of {seen.place[1]}"


def _size(metres: float) -> str:
    return f"{metres:.2g} m"


COARSE = 400
"""Instants on which a lag is sought."""
NARROWER = 5
"""Times that the steps about the best lag are made three times smaller."""


@dataclass(frozen=True)
class Registration:
    """What the best lag and rigid motion leave between a measured point and the model's."""

    rms: float
    """After both [m], (1)."""
    shifted: float
    """After the lag and a shift alone, the axes being parallel [m]."""
    mirrored: float
    """After both and a reflection, as with two of the columns exchanged [m]."""


def registration(arm: Arm, point: str, joints: Mapping[str, Track], measured: Track) -> Registration:
    """Return how near a point of the rigid arm along its joints comes to a measured one of three axes."""
    predicted = rigid_track(arm, point, joints, range(3), COARSE)
    if measured.poses:
        return _left(measured, predicted, 0.0)
    lag = agreement(measured, predicted, COARSE).lag
    step = max(measured.time[-1], predicted.time[-1]) / COARSE
    best = _left(measured, predicted, lag)
    for _ in range(NARROWER):
        for tried in (lag - step, lag + step):
            found = _left(measured, predicted, tried)
            if found.rms < best.rms:
                best, lag = found, tried
        step /= 3
    return best


def _left(measured: Track, predicted: Track, lag: float) -> Registration:
    at = measured.time - lag
    inside = (at >= predicted.time[0]) & (at <= predicted.time[-1])
    if inside.sum() < 8:
        return Registration(np.inf, np.inf, np.inf)
    y, x = _centred(measured.values[inside]), _centred(predicted.at(at[inside]))
    shifted = float(np.sqrt(np.mean(np.sum((y - x) ** 2, axis=1))))
    u, sizes, v = np.linalg.svd(y.T @ x / len(y))
    sign, both = np.sign(np.linalg.det(u @ v)), float(np.mean(np.sum(y**2 + x**2, axis=1)))
    proper, mirrored = (
        float(np.sqrt(max(both - 2 * (sizes[0] + sizes[1] + s * sizes[2]), 0.0))) for s in (sign, -sign)
    )  # eq. (1)
    return Registration(proper, shifted, mirrored)


def _centred(values: Floats) -> Floats:
    centred: Floats = values - values.mean(axis=0)
    return centred
