"""Prediction of held-out data, and the remark beside the verdict where it fails.

Of a record that it never saw a right model leaves what it leaves of the training, or the noise. What is held
out chooses no effect; the sentence beside the verdict tells the signal and the record of which most is left
over the greater one of the two, from `TIMES` of that on.

No model is adequate that leaves `TIMES` of the noise of held-out data, noise of the drives and time steps
included: the verdict is "unexplained" instead. Where the training begins in motion, what the arm swung with
counts as noise too.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import sqrt
from typing import TYPE_CHECKING

from flexarm.report.sentences import contradicted_sentence

if TYPE_CHECKING:
    from flexarm.diagnosis.problem import Problem
    from flexarm.diagnosis.result import Diagnosis


TIMES = 3.0
"""Four readings of noise, as two poses have, are as far off once in three million times."""
LEAST = {"m": 1e-6, "rad": 1e-6}
"""By unit what a simulation misses anyway: of records without noise nothing else is left."""


@dataclass(frozen=True)
class HeldOutGap:
    """Residuals of a signal after the update, in a held-out record and in the training, in its unit."""

    record: str
    signal: str
    unit: str
    held_out: float
    noise: float | None
    training: float | None

    @property
    def least(self) -> float:
        """Return what a simulation misses anyway."""
        return LEAST.get(self.unit, 0.0)

    @property
    def ratio(self) -> float:
        """To the greater one of what is left of the training and the noise; zero where nothing is known."""
        known = max(self.noise or 0.0, self.training or 0.0, self.least)
        return self.held_out / known if known > 0 else 0.0


def unpredicted(diagnosis: Diagnosis) -> HeldOutGap | None:
    """Return the held-out gap that is largest relative to noise and training, or None below `TIMES`."""
    worst = max(held_out_gaps(diagnosis), key=lambda gap: gap.ratio, default=None)
    return None if worst is None or worst.ratio < TIMES else worst


def adequate_if_foretold(diagnosis: Diagnosis, no_gap: Mapping[str, float], swings: bool) -> Diagnosis:
    """Return the diagnosis, "unexplained" if it is "adequate" and held-out data contradict that.

    Parameters
    ----------
    diagnosis : Diagnosis
        With held-out records before and after.
    no_gap : dict of str to float
        Mean square over that of the noise, by signal, of what a right model leaves beside noise.
    swings : bool
        Whether a record of training begins in motion, so that `compare` shows swings that a fit removes.
    """
    d = diagnosis
    if d.verdict != "adequate":
        return d

    def times(left: HeldOutGap) -> float:
        if left.noise is None or swings:
            return left.ratio
        return left.held_out / max(left.noise * sqrt(1 + no_gap.get(left.signal, 0.0)), left.least, 1e-300)

    worst = max(held_out_gaps(d), key=times, default=None)
    if worst is None or times(worst) < TIMES:
        return d
    said = contradicted_sentence(worst)
    return replace(d, verdict="unexplained", remainder=" ".join(filter(None, (said, d.remainder))))


def no_gap_of(problem: Problem, non_smooth: bool) -> dict[str, float]:
    """Return the mean square over that of the noise, by signal, that drives and time steps leave at most."""
    found: dict[str, float] = {}
    for each in problem.rows:
        found[each.signal] = max(found.get(each.signal, 0.0), each.explained_square(non_smooth))
    return found


def held_out_gaps(d: Diagnosis) -> list[HeldOutGap]:
    """Of every record that was held out, and every signal of it that is evidence."""
    found = []
    for record in d.held_out:
        for signal, gap in (d.after[record].evidence if record in d.after else {}).items():
            held, trained = d.gap([record], signal), d.gap(d.training, signal)
            if held.after_rms is not None:
                unit, after = gap.unit, held.after_rms
                found.append(HeldOutGap(record, signal, unit, after, held.noise_rms, trained.after_rms))
    return found
