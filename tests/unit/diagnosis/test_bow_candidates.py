"""What of a bow is looked for: the part across the link. What draws a link longer is no bow."""

import numpy as np
import pytest
from arms import arm, beam, general, hinge, point

from flexarm import Record, Signal
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.problem import Problem

TIME = np.arange(0.0, 1.0, 0.05)


@pytest.mark.parametrize("end, across", [([0, 0, 2], {"x", "y"}), ([2, 0, 0], {"y", "z"})])
def test_only_the_part_across_the_link_is_free(end, across):
    model = arm(
        joints=[hinge("hinge", "rod")],
        links=[beam("rod", end, general(1e-3, 1e-7))],
        points=[point("end", "rod", end)],
    )
    swing = 0.1 * np.sin(3 * TIME) ** 2
    signals = [
        Signal(name="hinge", quantity="joint_angle", joint="hinge", values=swing, time=TIME, file="run.csv",
               noise_std=1e-6),
        Signal(name="tip", quantity="position", point="end", values=np.tile(end, (len(TIME), 1)), time=TIME,
               file="run.csv", noise_std=1e-4),
    ]  # fmt: skip
    record = Record(signals={s.name: s for s in signals}, drive=("hinge",))
    bows = [each for each in candidates(Problem(model, {"run": record}), model) if each.name == "link_bow"]
    assert len(bows) == 3  # constant, and growing in two ways
    for bow in bows:
        assert {key[-1] for key in bow.free if key.startswith("tip_offset")} == across
