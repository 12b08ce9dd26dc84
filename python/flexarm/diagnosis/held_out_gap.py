"""Held-out gap: what a diagnosis leaves of records that it did not fit.

A right model leaves of a held-out record what it leaves of the training, or the noise. Held-out data choose
no effect. The signal with the largest held-out residual relative to training and noise is reported beside the
verdict if it exceeds them by `HELD_OUT_RATIO`.

No model is adequate that leaves `HELD_OUT_RATIO` of the noise of held-out data, input noise and
discretisation error included: the verdict is then "unexplained". Where the training begins in motion, the
initial vibration counts as noise too.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import sqrt
from typing import TYPE_CHECKING

from flexarm.report.sentences import contradicted_sentence

if TYPE_CHECKING:
    from flexarm.diagnosis.result import Diagnosis

HELD_OUT_RATIO = 3.0
"""Four readings of noise, as two poses have, are as far off once in three million times."""
SIMULATION_ERROR = {"m": 1e-6, "rad": 1e-6}
"""Error of any simulation by unit, for records without noise."""


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
        return SIMULATION_ERROR.get(self.unit, 0.0)

    @property
    def ratio(self) -> float:
        """To the greater one of what is left of the training and the noise; zero where nothing is known."""
        known = max(self.noise or 0.0, self.training or 0.0, self.least)
        return self.held_out / known if known > 0 else 0.0


def adequate_if_predicted(
    d: Diagnosis, input_variance_ratio: Mapping[str, float], initial_transient: bool
) -> Diagnosis:
    """Return the diagnosis, "unexplained" if it is "adequate" and held-out data contradict that.

    `input_variance_ratio` is the mean square of input noise and discretisation error over that of the noise,
    by signal. `initial_transient` is True if a training record begins in motion: `compare` then shows
    vibrations that a fit removes.
    """
    if d.verdict != "adequate":
        return d

    def times(left: HeldOutGap) -> float:
        if left.noise is None or initial_transient:
            return left.ratio
        return left.held_out / max(
            left.noise * sqrt(1 + input_variance_ratio.get(left.signal, 0.0)), left.least, 1e-300
        )

    worst = max(held_out_gaps(d), key=times, default=None)
    if worst is None or times(worst) < HELD_OUT_RATIO:
        return d
    said = contradicted_sentence(worst)
    return replace(d, verdict="unexplained", remainder=" ".join(filter(None, (said, d.remainder))))


def held_out_gaps(d: Diagnosis) -> list[HeldOutGap]:
    """Return the held-out gap of each signal that is evidence, in each record."""
    found = []
    for record in d.held_out:
        for signal, gap in (d.after[record].evidence if record in d.after else {}).items():
            held, trained = d.gap([record], signal), d.gap(d.training, signal)
            if held.after_rms is not None:
                unit, after = gap.unit, held.after_rms
                found.append(HeldOutGap(record, signal, unit, after, held.noise_rms, trained.after_rms))
    return found
