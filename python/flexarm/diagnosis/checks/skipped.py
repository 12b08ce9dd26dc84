"""Signals that a simulation does not predict: nothing is learnt from them, which a person should know."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from flexarm.comparison.poses import is_input
from flexarm.diagnosis.wording import listed

if TYPE_CHECKING:
    from flexarm.comparison.subject import Subject


def remarks_on_skipped(subjects: Mapping[str, Subject]) -> Iterator[str]:
    """A sentence for each signal that is not compared, with the records and the reason."""
    found: dict[tuple[str, str], list[str]] = {}
    for name, subject in subjects.items():
        record = subject.record
        for signal, why in subject.skipped.items():
            if record.kind == "motion" or not is_input(record, record.signals[signal]):
                found.setdefault((signal, why), []).append(name)
    for (signal, why), names in found.items():
        reason = why.removeprefix(f"signal {signal!r}: ").removeprefix(f"signal {signal!r} ")
        yield f"{listed(names)}: {signal} is not compared: {reason}"
