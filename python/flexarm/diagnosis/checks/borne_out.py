"""Drives whose angles are borne out: places follow the model that they move, however far they turn.

A crane that slews three times round goes as far as a swing in degrees. Driven by the latter, places would go
round 57 times too often; a place that such a drive alone moves, and that follows the model, says otherwise.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from flexarm.diagnosis.checks.finding import Finding
from flexarm.diagnosis.checks.slopes import CERTAIN, FOLLOWS
from flexarm.record.reached import span_by

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record import Record

MUCH = 0.1
"""Part of the reach over which a drive alone must move a place."""


def borne_out(arm: Arm, record: Record, found: Sequence[Finding]) -> set[str]:
    """Drives that a place follows which they move, and beside which no channel is at fault or strange."""
    if any(each.name or each.strange for each in found):
        return set()
    firm = [each.channel for each in found if each.channel.signal.quantity == "position" and _follows(each)]
    return {
        name
        for name in record.drive
        if any(span_by(record, arm, name, str(c.signal.point)) > MUCH * c.size for c in firm)
    }


def _follows(found: Finding) -> bool:
    fit = found.channel.fit()
    return fit.slope > CERTAIN * fit.std and fit.missed < FOLLOWS
