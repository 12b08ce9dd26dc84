"""Whether a model foretells what was held out, and what is said beside the verdict where it does not.

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

from flexarm.wording import number, with_unit

if TYPE_CHECKING:
    from flexarm.diagnosis.problem import Problem
    from flexarm.diagnosis.result import Diagnosis


TIMES = 3.0
"""Four readings of noise, as two poses have, are as far off once in three million times."""
LEAST = {"m": 1e-6, "rad": 1e-6}
"""By unit what a simulation misses anyway: of records without noise nothing else is left."""


@dataclass(frozen=True)
class _Left:
    """What the updated model leaves of a signal, of a held-out record and of the training, in its unit."""

    record: str
    signal: str
    unit: str
    held_out: float
    noise: float | None
    training: float | None

    @property
    def least(self) -> float:
        """What a simulation misses anyway."""
        return LEAST.get(self.unit, 0.0)

    @property
    def ratio(self) -> float:
        """To the greater one of what is left of the training and the noise; zero where nothing is known."""
        known = max(self.noise or 0.0, self.training or 0.0, self.least)
        return self.held_out / known if known > 0 else 0.0


def foretold_sentence(diagnosis: Diagnosis) -> str:
    """What is left of what the model does not foretell, and why that may be; empty if it foretells all."""
    d = diagnosis
    worst = max(_left(d), key=lambda left: left.ratio, default=None)
    if worst is None or worst.ratio < TIMES:
        return ""
    who = "The repaired model" if d.updated != d.arm else "The model"
    what = f"{worst.record!r}" if d.hold_out_kind == "blocks" else f"the held-out record {worst.record!r}"
    size = f"{with_unit(worst.held_out, worst.unit)} rms are left of {worst.signal!r}"
    noise = f", {number(worst.held_out / worst.noise, 2)} times the noise" if worst.noise else ""
    rest = (
        ""
        if worst.training is None
        else f"; the training is left with {with_unit(worst.training, worst.unit)}"
    )
    return f"{who} does not foretell {what}: {size}{noise}{rest}. {_why(d)}"


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

    def times(left: _Left) -> float:
        if left.noise is None or swings:
            return left.ratio
        return left.held_out / max(left.noise * sqrt(1 + no_gap.get(left.signal, 0.0)), left.least, 1e-300)

    worst = max(_left(d), key=times, default=None)
    if worst is None or times(worst) < TIMES:
        return d
    noise = f", {number(worst.held_out / worst.noise, 2)} times the noise" if worst.noise else ""
    said = (
        "No effect is missing as far as the training tells, but the model is not adequate: of "
        f"{worst.signal!r} in the held-out {worst.record!r} "
        f"{with_unit(worst.held_out, worst.unit)} rms are left{noise}."
    )
    return replace(d, verdict="unexplained", remainder=" ".join(filter(None, (said, d.remainder))))


def no_gap_of(problem: Problem, non_smooth: bool) -> dict[str, float]:
    """Return the mean square over that of the noise, by signal, that drives and time steps leave at most."""
    found: dict[str, float] = {}
    for each in problem.rows:
        found[each.signal] = max(found.get(each.signal, 0.0), each.explained_square(non_smooth))
    return found


def remarks_beside(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Remarks but for the one that stands beside the verdict."""
    said = foretold_sentence(diagnosis)
    return tuple(remark for remark in diagnosis.remarks if remark != said)


def _why(d: Diagnosis) -> str:
    fault = "that record has a fault of its own, which `flexarm check MODEL RECORD` looks for"
    if d.hold_out_kind == "blocks":
        return "Either something happens there and nowhere else, or these readings are at fault."
    if d.hold_out_kind == "extrapolation":
        beyond = f" ({d.hold_out_why})" if d.hold_out_why else ""
        return f"Either what lies beyond the training{beyond} shows what the training does not, or {fault}."
    return f"It lies within what the training covers: either the machine was another one then, or {fault}."


def _left(d: Diagnosis) -> list[_Left]:
    """Of every record that was held out, and every signal of it that is evidence."""
    found = []
    for record in d.held_out:
        for signal, gap in (d.after[record].evidence if record in d.after else {}).items():
            held, trained = d.gap([record], signal), d.gap(d.training, signal)
            if held.after_rms is not None:
                unit, after = gap.unit, held.after_rms
                found.append(_Left(record, signal, unit, after, held.noise_rms, trained.after_rms))
    return found
