"""What a first user gets wrong is said, with a word of what is right."""

import subprocess
import sys

import numpy as np
import pytest
from arms import paper_arm

import flexarm
from flexarm import InvalidFile, InvalidParameter
from flexarm.record import Frame
from flexarm.record.plausibility import validate

MODEL = "examples/one_link.toml"


def test_a_drive_in_degrees_is_doubted(tmp_path, request):
    drive = tmp_path / "drive.csv"
    drive.write_text("time_s,hinge\n0,0\n0.05,40\n0.1,90\n0.15,90\n")
    command = ["simulate", MODEL, "--drive", str(drive), "--out", str(tmp_path / "out")]
    done = subprocess.run(
        [sys.executable, "-m", "flexarm", *command],
        cwd=request.config.rootpath,
        capture_output=True,
        text=True,
    )
    assert "warning:" in done.stderr
    assert "degrees" in done.stderr


def test_a_run_wants_a_drive_and_a_comparison_a_record():
    arm = paper_arm()
    with pytest.raises(InvalidParameter, match=r"Drive\.from_samples"):
        flexarm.simulate(arm, {"hinge": np.zeros(3)})
    with pytest.raises(InvalidParameter, match=r"Record\.load"):
        flexarm.compare(arm, "record")


def test_a_result_is_not_saved_into_a_directory_that_is_not_there(tmp_path):
    with pytest.raises(InvalidFile, match="there is no directory"):
        flexarm.static(paper_arm()).save(tmp_path / "missing" / "statics.nc")


def test_a_run_knows_the_hash_of_its_drive():
    arm = paper_arm()
    drives = [flexarm.Drive.from_samples([0, 0.01, 0.02], {"hinge": [0, 0, q]}) for q in (0.0, 1e-9)]
    hashes = [flexarm.simulate(arm, drive).solver["drive_sha256"] for drive in drives]
    assert hashes[0] != hashes[1]
    assert hashes[0] == drives[0].sha256()


def test_a_frame_turned_by_degrees_is_doubted():
    t = np.linspace(0.0, 1.0, 11)
    signals = [
        flexarm.Signal(name="hinge", quantity="joint_angle", values=t, time=t, joint="hinge", noise_std=1e-6),
        flexarm.Signal(
            name="tip",
            quantity="position",
            values=t,
            time=t,
            point="tip",
            axes=("x",),
            frame="tracker",
            noise_std=1e-4,
        ),
    ]
    turned = Frame(rpy=(0.0, 0.0, 74.5))
    record = flexarm.Record(signals=signals, drive=("hinge",), frames={"tracker": turned})
    [found] = [problem for problem in validate(record) if problem.where == "frames.tracker.rpy"]
    assert found.what == "is [0.0, 0.0, 74.5] rad; write degrees as radians"


@pytest.mark.parametrize(("up", "fibre"), [(None, [0.0, 0.03]), ([1, 0, 0], [0.0, 0.03]), (None, [0.0, 0.0])])
def test_a_strain_gauge_off_the_axis_of_a_beam_needs_its_up(up, fibre):
    """On the axis it sees the axial force alone, whatever the section's axes."""
    gauge = {"name": "gauge", "quantity": "strain", "link": "rod", "position": 0.5, "fibre": fibre}
    table = paper_arm().to_dict() | {"sensors": [{**gauge, "rate_hz": 10}]}
    table["links"] = [{**table["links"][0], **({} if up is None else {"up": up})}]
    arm = flexarm.Arm.from_dict(table)
    signal = flexarm.Signal(**gauge, values=np.zeros(3), time=np.arange(3.0))
    problems = [*arm.warnings, *flexarm.Record(signals=[signal]).check_against(arm)]
    told = [each.where for each in problems if "states no `up`" in each.what]
    assumed = up is None and any(fibre)
    assert told == (["sensors.gauge.fibre", "signals.gauge.fibre"] if assumed else [])


def test_a_beam_of_no_length_to_speak_of_is_told(tmp_path, request):
    text = (request.config.rootpath / "examples/telescopic_crane.toml").read_text()
    model = tmp_path / "crane.toml"
    model.write_text(text.replace("end = [3, 0, 0]", "end = [1e-300, 0, 0]"))
    with pytest.raises(InvalidParameter, match="`end` must not be the origin"):
        flexarm.static(flexarm.Arm.load(model))
    assert any("1e-300 m long" in str(warning) for warning in flexarm.Arm.load(model).warnings)
