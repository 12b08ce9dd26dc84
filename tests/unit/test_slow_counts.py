"""A coarse grid that repeats while the arm moves slowly is not frozen; a channel that stops is."""

import numpy as np
import pytest
from arms import rod_arm

import flexarm
from flexarm.validation.sensor_check import check

ARM = rod_arm(
    [
        {"name": "hinge", "quantity": "joint_angle", "joint": "hinge", "side": "motor", "rate_hz": 50},
        {"name": "tip", "quantity": "position", "point": "tip", "axes": ["x", "z"], "rate_hz": 100},
    ],
    damping_ratio=0.01,
)
RESOLUTION = 1e-3


def slow(amplitude: float) -> flexarm.Record:
    """A slow sine of the hinge, 60 s long; the tip is told in whole millimetres."""
    t = np.linspace(0, 60, 1201)
    drive = flexarm.Drive.from_samples(t, {"hinge": amplitude * (1 - np.cos(2 * np.pi * t / 60))})
    soft = ARM.with_effect(
        flexarm.effects.JointCompliance(at="hinge", stiffness=1e5, damping=100.0)
    )  # the nominal joint is rigid
    record = flexarm.measure(flexarm.simulate(soft, drive, step=0.02), ARM.sensors, rng(), drive=["hinge"])
    tip = record.signals["tip"]
    counts = RESOLUTION * np.round(tip.values / RESOLUTION)
    return record.replace(signals={**record.signals, "tip": tip.replace(values=counts)})


def rng() -> np.random.Generator:
    return np.random.default_rng(1)


@pytest.mark.parametrize("amplitude", [1e-3, 2e-3, 2e-2])
def test_slow_motion_on_a_coarse_grid_is_not_frozen(amplitude):
    found = check(ARM, {"slow": slow(amplitude)})
    assert found.faults == ()
    assert not any("repeats a value" in remark for remark in found.remarks)


def test_counts_that_stop_while_the_arm_moves_are_frozen():
    record = slow(2e-2)
    tip = record.signals["tip"]
    stopped = np.where(np.arange(len(tip.values))[:, None] < 3000, tip.values, tip.values[3000])
    found = check(
        ARM, {"slow": record.replace(signals={**record.signals, "tip": tip.replace(values=stopped)})}
    )
    assert any("repeats a value" in fault.evidence for fault in found.faults)
