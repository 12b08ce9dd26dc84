"""Zeros of sensors are uncertain values of the model, unless the model or the record states them."""

import numpy as np
import pytest
from arms import rod_arm, smooth_step

import flexarm
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.sensor_zeros import of_model, set_zeros, with_zeros, without_idle_zeros
from flexarm.named_effects import Refined

ENCODER = {"quantity": "joint_angle", "joint": "hinge"}
SENSORS = [
    {"name": "hinge", **ENCODER, "side": "motor", "rate_hz": 100, "noise_std": 5e-6},
    {"name": "second", **ENCODER, "side": "output", "rate_hz": 50, "noise_std": 1e-5},
    {
        "name": "lean",
        "quantity": "inclination",
        "point": "tip",
        "axes": ["x"],
        "rate_hz": 20,
        "noise_std": 1e-4,
    },
    {"name": "tip", "quantity": "position", "point": "tip", "rate_hz": 20, "noise_std": 5e-5},
]
ZERO = 2.4e-3


def model(*effects):
    return rod_arm(SENSORS, effects=list(effects))


def measured(*effects):
    """A record of 4 s of a machine with effects, driven by the motor's encoder."""
    t = np.linspace(0, 4, 201)
    drive = flexarm.Drive.from_samples(t, {"hinge": 0.5 * smooth_step(t / 4)})
    run = flexarm.simulate(model(*effects), drive, step=5e-3, rotations=True)
    return flexarm.measure(run, model().sensors, np.random.default_rng(1), drive=["hinge"])


@pytest.fixture(scope="module")
def record():
    return measured({"name": "sensor_offset", "at": "second", "offset": ZERO})


def stating(record, **sigmas):
    signals = {
        name: signal.replace(zero_std=sigmas.get(name, signal.zero_std))
        for name, signal in record.signals.items()
    }
    return record.replace(signals=signals)


def sigmas(arm, record):
    return dict(with_zeros(arm, {"run": record}, SelectionPolicy()).uncertainty)


def test_angles_that_do_not_drive_have_a_zero_that_is_uncertain_by_the_policy(record):
    assert sigmas(model(), record) == {
        "effects.sensor_offset.second.offset_rad": 5e-3,
        "effects.sensor_offset.lean.offset_rad": 5e-3,
    }


def test_a_record_states_the_zero_of_any_sensor(record):
    found = sigmas(model(), stating(record, hinge=1e-3, second=0.0, lean=2e-4))
    assert found == {
        "effects.encoder_offset.hinge.offset_rad": 1e-3,
        "effects.sensor_offset.lean.offset_rad": 2e-4,
    }


def test_a_model_that_has_an_offset_states_it(record):
    arm = model({"name": "encoder_offset", "at": "second", "offset": 1e-3})
    assert "effects.sensor_offset.second.offset_rad" not in sigmas(arm, record)


def test_of_the_zeros_those_that_moved_stay_in_the_model(record):
    arm = with_zeros(model(), {"run": record}, SelectionPolicy())
    refined = [Refined("effects.sensor_offset.second.offset", ZERO, 1e-6, 0.0)]
    moved, kept = set_zeros(arm, refined, model())
    assert kept == tuple(refined)
    left = without_idle_zeros(moved, model())
    assert [(effect.at, effect.offset) for effect in left.effects] == [("second", ZERO)]
    assert list(left.uncertainty) == ["effects.sensor_offset.second.offset_rad"]
    assert without_idle_zeros(arm, model()) == model()


def test_a_zero_is_stored_in_the_unit_of_the_record(record, tmp_path):
    stating(record, second=2e-3).save(tmp_path / "run")
    assert flexarm.Record.load(tmp_path / "run").signals["second"].zero_std == 2e-3
    text = (tmp_path / "run/record.toml").read_text()
    (tmp_path / "run/record.toml").write_text(text.replace("zero_std = 0.002", "zero_std = -1.0"))
    with pytest.raises(flexarm.InvalidFile, match="zero_std"):
        flexarm.Record.load(tmp_path / "run")


def test_a_frame_has_the_zero_of_a_place(record):
    with pytest.raises(flexarm.InvalidParameter, match=r"signals\.tip\.zero_std.*that of its frame"):
        stating(record, tip=1e-3)


def test_a_zero_within_its_sigma_is_refined_and_no_effect(record):
    found = flexarm.diagnose(model(), record, n_jobs=1)
    assert found.verdict == "adequate", found
    [zero] = [each for each in found.refined if each.parameter == "effects.sensor_offset.second.offset"]
    assert zero.value == pytest.approx(ZERO, abs=5e-6)
    offset = found.updated.effect("sensor_offset", "second")
    assert offset.offset == pytest.approx(ZERO, abs=5e-6)


def test_a_zero_beyond_what_the_record_states_is_an_effect(record):
    found = flexarm.diagnose(model(), stating(record, second=1e-4), n_jobs=1)
    assert [(effect.name, effect.at) for effect in found.effects] == [("sensor_offset", "second")]
    assert found.effects[0].parameters[0].value == pytest.approx(ZERO, abs=5e-6)


def test_a_zero_that_the_model_is_left_without_is_no_refined_value():
    """A stored diagnosis that told such a one could not be loaded: its model has no such effect."""
    zero = Refined("effects.sensor_offset.second.offset", 1e-6, 1e-6, 0.0, "rad")
    modulus = Refined("links.rod.material.youngs_modulus", 2.08e11, 1e9, 2.1e11, "Pa")
    there = model({"name": "sensor_offset", "at": "second", "offset": 0.0})
    assert of_model([zero, modulus], there) == (zero, modulus)
    assert of_model([zero, modulus], without_idle_zeros(there, model())) == (modulus,)
