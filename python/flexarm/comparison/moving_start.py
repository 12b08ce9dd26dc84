"""Records that state a start at rest while a drive moves in its first sample.

A simulation that begins at rest with a moving drive rings, which the arm did not.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexarm.comparison.simulated_record import SimulatedRecord

MOVING_RATE = 0.05
"""Share of its greatest rate above which a drive moves [-]; `ValidationPolicy` has it too."""


def moving_starts(simulated: SimulatedRecord) -> Iterator[str]:
    """Yield a sentence on each drive that moves in the first sample, if the record states a start at rest."""
    record, run = simulated.record, simulated.simulation
    if record.kind == "static" or record.initial == "moving":
        return
    for signal in (record.signals[drive] for drive in record.drive):
        if signal.quantity != "joint_angle":
            continue
        rate = np.abs(run.drive_rate[:, run.joints.index(signal.joint)])
        if len(rate) > 1 and rate[1] > MOVING_RATE * rate.max():
            share = f"{100 * rate[1] / rate.max():.0f} % of its greatest rate"
            yield (
                f"{signal.name} moves in the first sample, at {share}, and the record says that it begins at "
                'rest; if it does not, state initial = "moving"'
            )
