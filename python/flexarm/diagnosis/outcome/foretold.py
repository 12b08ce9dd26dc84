"""Whether a model foretells what was held out, and what is said beside the verdict where it does not.

Of a record that it never saw a right model leaves what it leaves of the training, or the noise. What is held
out chooses nothing, so that a verdict stays as it is; the sentence beside it tells the signal and the record
of which most is left over the greater one of the two, from `TIMES` of that on.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flexarm.diagnosis.wording import number, with_unit

if TYPE_CHECKING:
    from flexarm.diagnosis.outcome.result import Diagnosis

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
    def ratio(self) -> float:
        """To the greater one of what is left of the training and the noise; zero where nothing is known."""
        known = max(self.noise or 0.0, self.training or 0.0, LEAST.get(self.unit, 0.0))
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
