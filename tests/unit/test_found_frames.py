"""Poses of unknown frames are told as a record would state them."""

import json
import re

import numpy as np
import pytest
from arms import smooth_step, waist_and_elbow

import flexarm
from flexarm.measurement import Registration
from flexarm.measurement.frames import rotation_from_rpy
from flexarm.record import Frame

XYZ, RPY = (2.0, -1.5, 0.8), (0.3, -0.2, 1.1)
ARM = waist_and_elbow({"noise_std": 2e-5})


@pytest.fixture(scope="module")
def record() -> flexarm.Record:
    t = np.linspace(0, 6, 301)
    s = smooth_step(t / 6)
    drive = flexarm.Drive.from_samples(t, {"waist": 1.5 * s, "elbow": 0.6 * np.sin(2 * np.pi * s)})
    return flexarm.measure(
        flexarm.simulate(ARM, drive),
        ARM.sensors,
        np.random.default_rng(1),
        drive=["waist", "elbow"],
        frames={"tracker": Frame(unknown=True)},
        registrations={"tracker": Registration(origin=XYZ, rpy=RPY)},
    )


def test_a_pose_is_that_of_its_frame_and_its_error():
    frame = Registration((1e-3, 2e-3, -1e-3), (0.01, -0.02, 0.03), XYZ, RPY)
    xyz, rpy = frame.pose
    seen = np.array([[0.1, 0.2, 0.3], [1.0, -1.0, 0.5]])
    base = seen @ rotation_from_rpy(*rpy).T + xyz
    assert frame.positions(base) == pytest.approx(seen, abs=1e-14)


def test_compare_tells_the_pose_of_an_unknown_frame(record):
    found = flexarm.compare(ARM, record)
    xyz, rpy = found.frames["tracker"]
    assert xyz == pytest.approx(XYZ, abs=1e-4)
    assert rpy == pytest.approx(RPY, abs=1e-4)
    assert found.to_json_dict()["frames"]["tracker"] == {"xyz": xyz, "rpy": rpy}
    assert "frame tracker found at xyz = [2.0000" in found.summary()
    assert "translation of tracker" not in found.summary()  # how far from a guess says nothing
    assert re.search(r"rad in the base, \+- (\S+, ){2}\S+ m and (\S+, ){2}\S+ rad", found.summary())
    assert flexarm.compare(ARM, record, align=False).frames == {}


@pytest.mark.slow
def test_a_diagnosis_tells_it_too_and_keeps_it(record, tmp_path):
    found = flexarm.diagnose(ARM, {"run": record})
    assert "run: frame tracker found at xyz = [" in found.summary()
    assert "against its stated pose" not in found.summary()
    found.save(tmp_path / "out")
    told = json.loads((tmp_path / "out" / "report.json").read_text())["details"]["frames"]
    assert told["run"]["tracker"]["xyz"] == pytest.approx(XYZ, abs=1e-3)
    assert flexarm.Diagnosis.load(tmp_path / "out").summary() == found.summary()
