"""The residual of one signal over all records, and its parts: motor orders first, then bands of frequency.

    residual = motor orders + parts by band,    orthogonal to each other in every record              (1)

so the squares of the parts add up to those of the residual. Motor orders come first: in the motor's angle
they are few columns, whatever their frequencies (`residual_analysis.spectrum`). A part with k of n degrees
of freedom has the share k/n of white noise.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexarm.arm.joint import motor_ratio
from flexarm.arm.kinematics import point_jacobian
from flexarm.arrays import Floats
from flexarm.comparison.aligned_record import AlignedRecord
from flexarm.comparison.bands import band_parts
from flexarm.comparison.gap import SignalGap, directions_of, drive_angles, signal_gap
from flexarm.record import Signal
from flexarm.residual_analysis.motion_states import JointStates, joined_states, joint_states
from flexarm.residual_analysis.spectrum import (
    Harmonic,
    MotorHarmonics,
    Named,
    detected_harmonics,
    harmonic_parts,
    named_bands,
)

PER_TURN = "per motor turn"
"""Part of the name of a motor order."""
POSES = "all poses"
"""Name of the one band of poses."""


@dataclass(frozen=True, eq=False)
class ResidualPart:
    """Part of a residual in one band, along one direction."""

    band: str
    """Its name."""
    band_hz: tuple[float, float]
    """Edges [Hz]; of a motor order the frequencies that it had."""
    values: Floats
    noise: Floats
    """The part, and 1 sigma of white noise in it, at every sample. Shape (n,)."""
    freedoms: float
    """Degrees of freedom."""


@dataclass(frozen=True, eq=False)
class SignalResidual:
    """Residual of one signal at the samples of all records, one record after the other."""

    signal: str
    unit: str
    """Its name, and the unit of the residual."""
    labels: tuple[str, ...]
    """Names of the records that hold it."""
    record: NDArray[np.intp]
    """Number of each sample's record in `labels`. Shape (n,)."""
    time: Floats
    """Instants [s], or numbers of poses. Shape (n,)."""
    directions: Mapping[str, Floats]
    noise: Mapping[str, Floats]
    """Residual along each direction, and its noise, 1 sigma. Shape (n,)."""
    parts: Mapping[str, tuple[ResidualPart, ...]]
    """By direction: the parts (1)."""
    states: tuple[JointStates, ...]
    """Of the joints that move."""
    notes: tuple[str, ...] = ()
    """Notes for the reader on aliasing."""

    @property
    def whitened(self) -> Floats:
        """Residual over its noise, shape (n, directions)."""
        return np.stack([self.directions[name] / self.noise[name] for name in self.directions], axis=1)

    @property
    def largest_direction(self) -> str:
        """Direction in which the residual is greatest."""
        return max(self.directions, key=lambda name: float(np.sum(self.directions[name] ** 2)))


def signal_residual(
    pairs: Mapping[str, AlignedRecord],
    waves: Mapping[str, MotorHarmonics],
    signal: str,
    joints: Sequence[str],
    joint: str | None,
    noise: float,
) -> SignalResidual | None:
    """Return the residual of a signal in every record that holds it; None if no row of it can be compared.

    `waves` are of the same records, `joints` those that move. The directions shown are those of `joint`, or
    x, y, z of the base. `noise` is 1 sigma of a channel where the record states none.
    """
    holding = [name for name, pair in pairs.items() if signal in pair.simulated.evidence]
    found = {name: _of_record(pairs[name], waves[name], signal, joints, joint, noise) for name in holding}
    found = {name: piece for name, piece in found.items() if len(piece.time)}
    if not found:
        return None
    directions = tuple(next(iter(found.values())).directions)
    other = [name for name, piece in found.items() if tuple(piece.directions) != directions]
    labels = tuple(name for name in found if name not in other)
    pieces = [found[name] for name in labels]
    lengths = [len(each.time) for each in pieces]
    notes = [note for each in pieces for note in each.notes]
    notes += [f"{signal} of {name} has other directions and is left out" for name in other]
    return SignalResidual(
        signal,
        pieces[0].unit,
        labels,
        np.repeat(np.arange(len(pieces)), lengths),
        np.concatenate([each.time for each in pieces]),
        {name: np.concatenate([each.directions[name] for each in pieces]) for name in directions},
        {name: np.concatenate([each.noise[name] for each in pieces]) for name in directions},
        {name: _joined_parts([each.parts[name] for each in pieces], lengths) for name in directions},
        tuple(joined_states([each.states[j] for each in pieces]) for j in range(len(joints))),
        tuple(dict.fromkeys(notes)),
    )


def _joined_parts(
    pieces: Sequence[tuple[ResidualPart, ...]], lengths: Sequence[int]
) -> tuple[ResidualPart, ...]:
    """Return the parts over the samples of all records; a band that a record lacks is zero there."""
    found = []
    for band in dict.fromkeys(part.band for parts in pieces for part in parts):
        own = [next((part for part in parts if part.band == band), None) for parts in pieces]
        there = [part for part in own if part is not None]
        pairs = list(zip(own, lengths, strict=True))
        found.append(
            ResidualPart(
                band,
                (min(p.band_hz[0] for p in there), max(p.band_hz[1] for p in there)),
                np.concatenate([p.values if p else np.zeros(n) for p, n in pairs]),
                np.concatenate([p.noise if p else np.zeros(n) for p, n in pairs]),
                sum(p.freedoms for p in there),
            )
        )
    return tuple(found)


def _of_record(
    pair: AlignedRecord,
    waves: MotorHarmonics,
    name: str,
    joints: Sequence[str],
    joint: str | None,
    noise: float,
) -> SignalResidual:
    """Return the residual of a signal in one record."""
    simulated, signal = pair.simulated, pair.simulated.signals[name]
    gap = signal_gap(simulated, signal, pair.aligned.placement, joint, ())
    directions, time, n = _directions(pair, signal, gap), gap.time, len(gap.time)
    sigma = gap.noise_rms / np.sqrt(len(directions)) if gap.noise_rms else noise
    states = tuple(joint_states(pair, each, time) for each in joints)
    ratios = [motor_ratio(simulated.arm, each) for each in joints]
    bands: list[Named] = []
    notes: list[str] = []
    if pair.record.kind == "motion" and n >= 3:
        bands, notes = named_bands(pair.modes_hz, float(1 / np.median(np.diff(time))))
    parts = {}
    for direction, values in directions.items():
        shares = _shares_of_turns(pair, signal, joint, joints, time, direction)
        orders = detected_harmonics(values, sigma, time, waves, states, ratios, shares) if bands else []
        parts[direction] = _split(values, sigma, time, bands, orders, len(joints) > 1)
    stated = {direction: np.full(n, sigma) for direction in directions}
    record = np.zeros(n, dtype=np.intp)
    return SignalResidual(
        name, gap.unit, ("",), record, time, directions, stated, parts, states, tuple(notes)
    )


def _directions(pair: AlignedRecord, signal: Signal, gap: SignalGap) -> dict[str, Floats]:
    """Return the residual along every measured direction, else along the sensor's axes."""
    found = {name: part for name, part in gap.parts.items() if part is not None}
    if len(found) >= (3 if signal.quantity == "orientation" else signal.values.shape[1]):
        return found
    residual = pair.simulated.residual(signal, pair.aligned.placement)
    keep = np.isfinite(residual).all(axis=1) & ~pair.simulated.outliers(signal, residual)
    return {f"sensor {axis}": residual[keep, k] for k, axis in enumerate(signal.axes)}


def _shares_of_turns(
    pair: AlignedRecord,
    signal: Signal,
    joint: str | None,
    joints: Sequence[str],
    time: Floats,
    direction: str,
) -> list[Floats | float]:
    """Return the share of a turn of each joint that a direction shows; 1 where kinematics do not tell."""
    if signal.quantity != "position" or signal.point is None or direction.startswith("sensor"):
        return [1.0] * len(joints)
    unit = directions_of(pair.simulated, signal, joint, time)[direction]
    angles, arm = drive_angles(pair.simulated, time), pair.simulated.arm
    return [np.sum(unit * point_jacobian(arm, each, signal.point, angles), axis=1) for each in joints]


def _split(
    values: Floats,
    sigma: float,
    time: Floats,
    bands: Sequence[Named],
    orders: Sequence[Harmonic],
    several: bool,
) -> tuple[ResidualPart, ...]:
    """Return the parts (1) of one direction; poses, without bands, are one part."""
    n = len(values)
    if not bands:
        return (ResidualPart(POSES, (0.0, 0.0), values, np.full(n, sigma), float(n)),)
    found: dict[str, ResidualPart] = {}

    def add(band: str, band_hz: tuple[float, float], part: Floats, freedoms: float) -> None:
        noise = np.full(n, sigma * np.sqrt(freedoms / n))
        if band in found:  # a folded mode may lie in the midst of a band
            own = found[band]
            band_hz = (min(own.band_hz[0], band_hz[0]), max(own.band_hz[1], band_hz[1]))
            part, noise, freedoms = own.values + part, np.hypot(own.noise, noise), own.freedoms + freedoms
        found[band] = ResidualPart(band, band_hz, part, noise, freedoms)

    waves, rest = harmonic_parts(values, orders)
    for each, wave in zip(orders, waves, strict=True):
        of = f" of {each.joint}" if several else ""
        add(f"{each.multiple} {PER_TURN}{of}", each.band_hz, wave, float(each.columns.shape[1]))
    taken = sum(part.freedoms for part in found.values())
    edges = [0.0, *(high for _, high, _ in bands)]
    split, freedoms = band_parts(time, rest[:, None], edges)
    freedoms = freedoms * (1 - taken / n)
    for (low, high, name), part, k in zip(bands, split, freedoms.tolist(), strict=True):
        add(name, (low, high), part[:, 0], k)
    return tuple(found.values())
