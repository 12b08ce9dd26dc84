"""Records that say they begin at rest, and a drive that moves in their first sample.

The run would start with a jump of the rate and ring with it, which the arm did not: it was moving before.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from flexarm.comparison.subject import Subject

SUDDEN = 0.05
"""Rate with which a drive begins, over its greatest one, above which it was moving before."""


def remarks_on_starts(subjects: Mapping[str, Subject]) -> Iterator[str]:
    """A sentence for every record of which a drive says otherwise than the record."""
    for name, subject in subjects.items():
        record = subject.record
        if record.kind == "static" or record.initial == "moving":
            continue
        run = subject.simulation
        for signal in (record.signals[drive] for drive in record.drive):
            if signal.quantity != "joint_angle":
                continue
            rate = np.abs(run.drive_rate[:, run.joints.index(signal.joint)])
            if len(rate) > 1 and rate[1] > SUDDEN * rate.max():
                share = f"{100 * rate[1] / rate.max():.0f} % of its greatest rate"
                yield (
                    f"{name}: {signal.name} moves in the first sample, at {share}, and the record says that "
                    'it begins at rest; if it does not, state initial = "moving"'
                )
