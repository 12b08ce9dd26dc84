"""Clocks and frames to look at channels with: as stated, or where unknown as most signals have it.

The first guess of an unknown frame (`flexarm.comparison.start`) turns with a channel that is at fault. Here
the signals of a frame vote: of the guesses of each alone and of all together the one counts for which the
median signal has the smallest scatter over its motion.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexarm.comparison.start import first_guess
from flexarm.comparison.subject import Placement, Subject
from flexarm.comparison.unknowns import stated


def placing(subject: Subject) -> Placement:
    """Clocks and frames of a record."""
    start = stated(subject.record)
    found = first_guess(subject, start)
    for name, frame in subject.record.frames.items():
        seen = [s for s in subject.evidence.values() if s.frame == name and s.quantity == "position"]
        if not frame.unknown or len(seen) < 2:
            continue
        guesses = [found]
        for signal in seen:
            alone = first_guess(replace(subject, signals={signal.name: signal}), start)
            guesses.append(Placement(found.clocks, {**found.frames, name: alone.frames[name]}))
        found = min(guesses, key=lambda placement: _misfit(subject, placement, name))
    return found


def _misfit(subject: Subject, placement: Placement, frame: str) -> float:
    """Of the median signal of a frame: scatter over motion, offsets aside."""
    shares = []
    for signal in subject.evidence.values():
        if signal.frame == frame and signal.quantity == "position":
            residual = subject.residual(signal, placement, hold=True)
            motion = float(np.nanstd(subject.predicted(signal, placement, hold=True)))
            shares.append(float(np.nanstd(residual - np.nanmean(residual, axis=0))) / (motion or 1.0))
    return float(np.median(shares))
