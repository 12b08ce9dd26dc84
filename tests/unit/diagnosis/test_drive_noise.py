"""Noise of an encoder that drives a lightly damped arm moves its tip, and is no gap."""

import numpy as np
import pytest
from arms import crane, smooth_step, tracker

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.diagnosis.residuals.drive_noise import with_drive_noise
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


def rms(rows, residual):
    return np.array([np.sqrt(np.mean(residual[row.where] ** 2)) for row in rows])


def test_the_right_model_leaves_the_noise_that_is_foretold(arm):
    """A tenth of a milliradian: what is left of it moves the tip by more than the tracker sees."""
    there = observed(arm, 1e-4)
    found, said = with_drive_noise(there, seed=0)
    before, after = (rms(each.rows, each.residual(arm)) for each in (there, found))
    assert before.max() > 1.5
    assert after == pytest.approx(1.0, rel=0.35)  # a mode is shaken by a few independent values
    assert len(said) == 1 and said[0].startswith("noise of hinge, as stated, moves tip by up to ")


def test_a_good_encoder_changes_nothing(arm):
    there = observed(arm, 1e-7)
    assert with_drive_noise(there, seed=0) == (there, ())


def test_the_same_seed_gives_the_same_noise(arm):
    there = observed(arm, 1e-4)
    one, other = (with_drive_noise(there, seed=3)[0] for _ in range(2))
    assert [row.sigma for row in one.rows] == [row.sigma for row in other.rows]
