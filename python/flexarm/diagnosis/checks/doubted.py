"""Values that no sensor of this arm shows: in another unit, far beyond its reach, or of an arm of kilometres.

A channel that keeps an absurd distance from its prediction may follow its motion all the same, and so be in
order as far as slopes tell; of signals whose stamps are in other units hardly a reading is compared. Beside
such values a check has nothing to say for a sensor.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import TYPE_CHECKING

from flexarm.arm.sizes import doubted_sizes
from flexarm.record.against_arm import doubted_values
from flexarm.record.doubts import doubted_units
from flexarm.record.lasting import spans_apart

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record import Record


def doubted(
    arm: Arm, records: Mapping[str, Record], borne_out: Mapping[str, Collection[str]] | None = None
) -> tuple[str, ...]:
    """A sentence for each, of the model and by record.

    Parameters
    ----------
    arm : Arm
        The model.
    records : dict of str to Record
        What was measured.
    borne_out : dict of str to collection of str, optional
        By record the drives whose angles places bear out, however far they turn.
    """
    found = [f"model: {problem}" for problem in doubted_sizes(arm)]
    for name, record in records.items():
        sure = {f"signals.{drive}" for drive in (borne_out or {}).get(name, ())}
        units = [problem for problem in doubted_units(record, arm) if problem.where not in sure]
        problems = [*units, *spans_apart(record), *doubted_values(record, arm)]
        found += [f"{name}: {problem}" for problem in problems]
    return tuple(found)
