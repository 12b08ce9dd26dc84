"""Noise of an encoder that drives a lightly damped arm moves its tip, and is no gap."""

import numpy as np
import pytest
from arms import crane, smooth_step, tracker

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.diagnosis.choosing.evidence import above_noise
from flexarm.diagnosis.residuals.drive_noise import allow_for_drives, shaken_signals
from flexarm.diagnosis.residuals.observed import Observed
from flexarm.effects import JointCompliance
from flexarm.record import Clock, Frame

TRACKER = 5e-5


@pytest.fixture(scope="module")
def arm():
    """A first mode at 2.6 Hz that answers 1 % damped."""
    return crane(effects=[]).with_effect(JointCompliance(at="hinge", stiffness=1.4e5, damping=180.0))


def observed(arm, noise):
    """The tip beside the model along what an encoder showed of quick moves, all else exact."""
    t = np.arange(0, 20, 0.01)
    angle = 0.4 * np.sin(2 * np.pi * 0.4 * t) * smooth_step(t / 3)
    run = flexarm.simulate(arm, flexarm.Drive.from_samples(t, {"hinge": angle}), step=4e-3)
    encoder = {"quantity": "joint_angle", "joint": "hinge", "rate_hz": 100, "clock": "plc"}
    record = flexarm.measure(
        run,
        [Sensor(name="hinge", noise_std=noise, **encoder), tracker("tip", noise=TRACKER)],
        np.random.default_rng(5),
        drive=["hinge"],
        clocks={"plc": Clock(), "tracker": Clock()},
        frames={"tracker": Frame()},
    )
    return Observed(arm, {"run": record}, step=4e-3)


def left(there, residual):
    """Above the noise, in each channel."""
    return np.array(list(above_noise(residual, there).values()))


def test_the_right_model_leaves_no_gap_but_the_noise_that_is_foretold(arm):
    """A tenth of a milliradian: what is left of it moves the tip by more than the tracker sees."""
    there = observed(arm, 1e-4)
    residual = there.residual(arm)
    assert left(there, residual).max() > 1.0
    allow_for_drives(there, arm)
    assert left(there, residual).max() < 1.0  # a mode is shaken by a few independent values
    [said] = shaken_signals(there)
    assert said.startswith("noise of hinge, as stated, moves tip by up to ")


def test_a_gap_stays_a_gap(arm):
    """A softer spring moves the tip by more than the drive's noise does."""
    there = observed(arm, 1e-4)
    softer = arm.with_effect(JointCompliance(at="hinge", stiffness=1.2e5, damping=180.0))
    allow_for_drives(there, arm)
    assert left(there, there.residual(softer)).max() > 2.0


def test_a_good_encoder_changes_nothing(arm):
    there = observed(arm, 1e-7)
    rows = there.rows
    allow_for_drives(there, arm)
    assert there.rows is rows
    assert shaken_signals(there) == []


def test_the_same_model_is_allowed_the_same_and_never_less(arm):
    one, other = (observed(arm, 1e-4) for _ in range(2))
    for there in (one, other):
        allow_for_drives(there, arm)
    first = [row.shaken for row in one.rows]
    assert first == [row.shaken for row in other.rows]
    rigid = arm.without_effect("joint_compliance", "hinge")  # follows its drive, and rings far less
    allow_for_drives(one, rigid)
    assert all(row.shaken >= before for row, before in zip(one.rows, first, strict=True))


def test_noise_that_is_larger_is_shaken_by_less_of_it(arm):
    there = observed(arm, 1e-4)
    allow_for_drives(there, arm)
    noisier = there.with_noise(np.full(len(there.rows), 2.0))
    assert [row.shaken for row in noisier.rows] == pytest.approx([row.shaken / 4 for row in there.rows])
