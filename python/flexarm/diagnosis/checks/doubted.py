"""Values that no sensor of this arm shows: in another unit, far beyond its reach, or of an arm of kilometres.

A channel that keeps an absurd distance from its prediction may follow its motion all the same, and so be in
order as far as slopes tell. Beside such values a check has nothing to say for a sensor.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from flexarm.arm.sizes import doubted_sizes
from flexarm.record.against_arm import doubted_values
from flexarm.record.doubts import doubted_units

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record import Record


def doubted(arm: Arm, records: Mapping[str, Record]) -> tuple[str, ...]:
    """A sentence for each, of the model and by record."""
    found = [f"model: {problem}" for problem in doubted_sizes(arm)]
    for name, record in records.items():
        problems = [*doubted_units(record), *doubted_values(record, arm)]
        found += [f"{name}: {problem}" for problem in problems]
    return tuple(found)
