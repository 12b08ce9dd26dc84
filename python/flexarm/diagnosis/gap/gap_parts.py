"""The parts of a gap: harmonics of the motors first, then bands of frequency.

    gap = harmonics of the motors + parts by band,   orthogonal to each other in every record         (1)

so squares of parts add up to those of the gap. Harmonics come first: told in the motor's angle they are few
columns, whatever their frequencies (`gap.motor_harmonics`, `gap.gap_bands`).
A part with k of n freedoms has the share k/n of white noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexarm.arrays import Floats
from flexarm.comparison.bands import band_parts
from flexarm.diagnosis.gap.joint_states import States
from flexarm.diagnosis.gap.motor_harmonics import MotorWaves, harmonic_parts, harmonics_of

PER_TURN = "per motor turn"
"""What a harmonic's name holds."""
POSES = "all poses"
"""Name of the one band that poses have."""


@dataclass(frozen=True, eq=False)
class Part:
    """What of a gap lies in one band, along one direction.

    Attributes
    ----------
    band : str
        Its name.
    band_hz : tuple of float
        Edges [Hz]; of a harmonic the frequencies that it had.
    values, noise : ndarray, shape (n,)
        The part, and 1 sigma of white noise in it, at every sample.
    freedoms : float
        Number of independent values.
    """

    band: str
    band_hz: tuple[float, float]
    values: Floats
    noise: Floats
    freedoms: float


@dataclass(frozen=True, eq=False)
class Split:
    """What the parts (1) of all directions of a signal in one record have in common.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Instants [s].
    states : sequence of States
        Of the joints that move.
    ratios : sequence of float
        Their gear ratios.
    bands : sequence of (float, float, str)
        Named bands; none for poses.
    waves : MotorWaves
        Of the record.
    """

    time: Floats
    states: Sequence[States]
    ratios: Sequence[float]
    bands: Sequence[tuple[float, float, str]]
    waves: MotorWaves

    def __call__(self, values: Floats, sigma: float, shares: Sequence[Floats | float]) -> tuple[Part, ...]:
        """Parts of one direction."""
        n = len(values)
        if not self.bands:
            return (Part(POSES, (0.0, 0.0), values, np.full(n, sigma), float(n)),)
        harmonics = harmonics_of(values, sigma, self.time, self.waves, self.states, self.ratios, shares)
        waves, rest = harmonic_parts(values, harmonics)
        found = []
        for each, wave in zip(harmonics, waves, strict=True):
            of = f" of {each.joint}" if len(self.states) > 1 else ""
            name, k = f"{each.multiple} {PER_TURN}{of}", float(each.columns.shape[1])
            found.append(Part(name, each.band_hz, wave, np.full(n, sigma * np.sqrt(k / n)), k))
        edges = [0.0, *(high for _, high, _ in self.bands)]
        split, freedoms = band_parts(self.time, rest[:, None], edges)
        freedoms = freedoms * (1 - sum(part.freedoms for part in found) / n)
        for (low, high, name), part, k in zip(self.bands, split, freedoms.tolist(), strict=True):
            found.append(Part(name, (low, high), part[:, 0], np.full(n, sigma * np.sqrt(k / n)), k))
        return _merged(found)


def _merged(parts: Sequence[Part]) -> tuple[Part, ...]:
    """Parts of one name as one: a folded mode may lie in the midst of a band."""
    found: dict[str, Part] = {}
    for part in parts:
        if part.band in found:
            part = _sum(found[part.band], part)
        found[part.band] = part
    return tuple(found.values())


def _sum(one: Part, other: Part) -> Part:
    """Two orthogonal parts of the same samples."""
    hull = (min(one.band_hz[0], other.band_hz[0]), max(one.band_hz[1], other.band_hz[1]))
    noise = np.hypot(one.noise, other.noise)
    return Part(one.band, hull, one.values + other.values, noise, one.freedoms + other.freedoms)


def joined_parts(pieces: Sequence[tuple[Part, ...]], lengths: Sequence[int]) -> tuple[Part, ...]:
    """Parts over the samples of all records; a band that a record has not is zero there."""
    found = []
    for band in dict.fromkeys(part.band for parts in pieces for part in parts):
        own = [next((part for part in parts if part.band == band), None) for parts in pieces]
        there = [part for part in own if part is not None]
        pairs = list(zip(own, lengths, strict=True))
        found.append(
            Part(
                band,
                (min(p.band_hz[0] for p in there), max(p.band_hz[1] for p in there)),
                np.concatenate([p.values if p else np.zeros(n) for p, n in pairs]),
                np.concatenate([p.noise if p else np.zeros(n) for p, n in pairs]),
                sum(p.freedoms for p in there),
            )
        )
    return tuple(found)
