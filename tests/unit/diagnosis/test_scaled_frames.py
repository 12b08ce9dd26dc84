"""A tracker whose metre is wrong and an encoder that errs several times a turn are named, or tied."""

import numpy as np
import pytest
from arms import rod_arm, smooth_step, tracker

import flexarm
from flexarm.arm.effect import read_effect
from flexarm.diagnosis.candidates import places_of
from flexarm.diagnosis.problem import Problem
from flexarm.effects import FrameDrift, FrameScale
from flexarm.record import Clock, Frame

ARM = rod_arm(
    [
        {"name": "hinge", "quantity": "joint_angle", "joint": "hinge", "rate_hz": 100, "noise_std": 5e-6},
        tracker("tip", rate_hz=20),
    ],
    damping_ratio=0.01,
    payloads=[{"name": "load", "link": "rod", "position": [0, 0, 3.0], "mass": 14.1}],
)


def measured(effect: dict[str, object]) -> flexarm.Record:
    """A virtual record of the arm with an effect."""
    t = np.linspace(0, 8, 401)
    angle = 0.6 * np.sin(np.pi * t / 2) * smooth_step(np.minimum(t / 2, 1)) - 0.2 * smooth_step(t / 8)
    arm = ARM.with_effect(read_effect(effect))
    run = flexarm.simulate(arm, flexarm.Drive.from_samples(t, {"hinge": angle}))
    clocks = {"controller": Clock(), "tracker": Clock(sigma=2e-3)}
    frames = {"tracker": Frame(translation=1e-3, rotation=5e-4)}
    rng = np.random.default_rng(1)
    return flexarm.measure(run, arm.sensors, rng, drive=["hinge"], clocks=clocks, frames=frames)


def told(found: flexarm.Diagnosis) -> dict[str, float]:
    """Return names of the first effect and its alternatives with their probabilities."""
    first = found.effects[0]
    return {first.name: first.probability} | {other.name: other.probability for other in first.alternatives}


@pytest.mark.parametrize("error", [3e-4, 1e-3])
def test_a_scale_of_the_tracker_is_named_or_tied_and_within_its_interval(error):
    found = flexarm.diagnose(ARM, [measured({"name": "frame_scale", "at": "tracker", "scale": 1 + error})])
    assert found.verdict == "effects"
    assert len(found.effects) == 1
    assert "frame_scale" in told(found)
    if found.effects[0].name == "frame_scale":
        scale = found.effects[0].parameters[0]
        assert scale.value == pytest.approx(1 + error, abs=4 * scale.std)


def test_a_longer_link_is_not_told_as_a_scale_of_the_tracker():
    found = flexarm.diagnose(ARM, [measured({"name": "link_length", "at": "rod", "error": 3e-3})])
    assert [effect.name for effect in found.effects] == ["link_length"]


def test_the_order_of_an_encoder_error_is_found_and_said():
    effect = {"name": "encoder_harmonics", "at": "hinge", "order": 3, "amplitude": 4e-4, "phase": 0.7}
    found = flexarm.diagnose(ARM, [measured(effect)])
    assert [named.name for named in found.effects] == ["encoder_harmonics"]
    assert "its order is 3" in found.effects[0].evidence
    assert found.updated.effect("encoder_harmonics", "hinge").order == 3
    amplitude = found.effects[0].parameters[0]
    assert amplitude.value == pytest.approx(4e-4, abs=4 * amplitude.std)


def test_one_place_in_a_frame_does_not_tell_its_scale():
    record = measured({"name": "frame_scale", "at": "tracker", "scale": 1.001})
    tip = record.signals["tip"]
    short = tip.replace(values=tip.values[:1], time=tip.time[:1])
    few = record.replace(signals=[record.signals["hinge"], short])
    assert places_of(FrameScale, Problem(ARM, {"run": record}), ARM) == ["tracker"]
    assert places_of(FrameScale, Problem(ARM, {"run": few}), ARM) == []
    assert places_of(FrameDrift, Problem(ARM, {"run": few}), ARM) == ["tracker"]
