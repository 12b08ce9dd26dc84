"""Places that are off by the same along the axes of the base, however the arm turns: that is a frame's doing.

What belongs to an arm turns with it, so that its gap g = measured - predicted, seen in the base, changes as
the prediction p does. A frame that was never stated is taken as the base's own, exact, and then

    |mean g| > ALIKE std g std(p)^-1 |p|                                                             (1)

says that the readings count from elsewhere. Without a frame a diagnosis has no registration to find.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.sizes import reach
from flexarm.diagnosis.checks.placing import placing
from flexarm.diagnosis.wording import with_unit

if TYPE_CHECKING:
    from flexarm.comparison.subject import Subject
    from flexarm.record import Signal

ALIKE = 3.0
"""How much steadier than the direction of the place the gap must be."""
TURNED = 0.1
"""Least scatter of the prediction over its distance from the base: hardly moved, all gaps are alike."""
OFF, NOISE = 5e-3, 10.0
"""Shift that is told: part of the reach, and noises."""
TOLD = 0.05
"""Part of the shift that an axis must have to be told."""


def remarks_on_shifts(subjects: Mapping[str, Subject]) -> Iterator[str]:
    """A sentence for each position without a frame for which (1) holds."""
    for name, subject in subjects.items():
        for signal in subject.evidence.values():
            if signal.quantity == "position" and signal.frame == "base":
                yield from (f"{name}: {what}" for what in _shift(subject, signal))


def _shift(subject: Subject, signal: Signal) -> Iterator[str]:
    placement = placing(subject)
    gap = subject.residual(signal, placement, hold=True)
    known = np.isfinite(gap).all(axis=1)
    if known.sum() < 3:
        return
    gap, place = gap[known], subject.predicted(signal, placement, hold=True)[known]
    off, far = np.mean(gap, axis=0), float(np.sqrt(np.mean(np.sum(place**2, axis=1))))
    size, left, turned = float(np.linalg.norm(off)), _scatter(gap), _scatter(place) / (far or 1.0)
    least = max(OFF * reach(subject.arm), NOISE * float(np.max(subject.noise(signal))))
    if turned > TURNED and size > least and size * turned > ALIKE * left:  # eq. (1)
        along = ", ".join(
            f"{with_unit(float(value), 'm')} along {axis}"
            for axis, value in zip(signal.axes, off, strict=True)
            if abs(value) > TOLD * size
        )
        yield (
            f"{signal.name} is off by {along}, wherever the arm stands, to within {with_unit(left, 'm', 2)}, "
            "and no frame is stated for it: if it does not count from the base, give it one in [frames] with "
            "its sigma; else a diagnosis takes that for the arm's"
        )


def _scatter(values: np.ndarray) -> float:
    """Root mean square distance from the mean."""
    return float(np.sqrt(np.mean(np.sum((values - np.mean(values, axis=0)) ** 2, axis=1))))
