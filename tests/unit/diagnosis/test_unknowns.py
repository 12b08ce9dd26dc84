"""What is fitted along, and how well it is known beforehand."""

import numpy as np
import pytest
from arms import crane

from flexarm.diagnosis.fitting.unknowns import nominal
from flexarm.record import Record, Signal
from flexarm.record.table import CarriedPayload

TIME = np.arange(0.0, 1.0, 0.1)


def record(**stated):
    """A run of a crane, of which the tip is seen on a clock and in a frame of its own."""
    hinge = Signal(name="q", quantity="joint_angle", joint="hinge", time=TIME, values=TIME, noise_std=1e-6)
    tip = Signal(name="tip", quantity="position", point="tip", axes=("x", "z"), time=TIME,
                 values=np.zeros((len(TIME), 2)), noise_std=1e-4)  # fmt: skip
    return Record(signals=[hinge, tip], drive=("q",), **stated)


@pytest.mark.parametrize(
    "loads, uncertain",
    [
        ([{"mass": 5.0}, {"mass": 6.0}], []),
        ([{"mass": 5.0}, {}], ["payloads.load.mass"]),
        ([{"inertia": (0.1, 0.1, 0.1)}], ["payloads.load.mass"]),
        ([], ["payloads.load.mass"]),
    ],
    ids=["by all", "by one", "turned alone", "no record"],
)
@pytest.mark.parametrize("key", ["payloads.load.mass", "payloads.load.mass_kg"])
def test_a_mass_is_known_where_every_record_weighed_it(loads, uncertain, key):
    """A record that states an inertia and no mass says nothing of the mass."""
    arm = crane(uncertainty={key: 0.05})
    records = {f"{k}": record(payloads={"load": CarriedPayload(**load)}) for k, load in enumerate(loads)}
    assert [each.key for each in nominal(arm, records)] == uncertain
