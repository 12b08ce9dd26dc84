"""The KUKA KR 300: its reader, and what its secondary encoders say of delay, zeros and compliances."""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat
from tests.helpers.example_scripts import load_script

import flexarm
from flexarm import Arm, InvalidFile, Record

SCRIPT = load_script("kuka_kr300", "make_records")
ROWS = np.random.default_rng(2).normal(size=(6, 20))


def written(folder: Path, **changed: np.ndarray) -> Path:
    """Both files with an invented motion of twenty samples."""
    rec = {"time_cont": np.arange(20) * 4e-3, **dict.fromkeys(SCRIPT.VARIABLES[1:], ROWS)}
    para = {"f_vis": np.ones(6), "f_coul": np.ones(6)}
    for file in SCRIPT.FILES.values():
        savemat(folder / file, {"rec": {**rec, **changed}, "para": para})
    return folder


def test_variables_become_signals_in_si_units(tmp_path):
    SCRIPT.make_records(written(tmp_path), tmp_path / "out")
    whole, angles = (Record.load(tmp_path / "out" / name) for name in ("b_torque", "b"))
    assert whole.drive == SCRIPT.AXES
    assert whole.signals["axis_6"].values[:, 0] == pytest.approx(np.radians(ROWS[5]))
    assert whole.signals["axis_2_torque"].values[:, 0] == pytest.approx(ROWS[1])
    assert whole.clocks["secondary"].unknown
    assert set(angles.signals) == {*SCRIPT.AXES, *(f"{axis}_secondary" for axis in SCRIPT.SECONDARY)}


def test_wrong_files_are_named_with_the_variable(tmp_path):
    with pytest.raises(
        InvalidFile, match=r"a\.mat: rec\.act_pos_se_deg: must be 6 rows as long as time_cont"
    ):
        SCRIPT.make_records(written(tmp_path, act_pos_se_deg=np.zeros((6, 3))), tmp_path / "out")
    savemat(tmp_path / SCRIPT.FILES["a"], {"other": 1.0})
    with pytest.raises(InvalidFile, match=r"a\.mat: rec: must hold time_cont, .* in rec and f_vis"):
        SCRIPT.make_records(tmp_path, tmp_path / "out")
    (tmp_path / SCRIPT.FILES["a"]).write_text("no MATLAB file, though it is long enough to be looked at")
    with pytest.raises(InvalidFile, match=r"a\.mat: file: is no MATLAB file"):
        SCRIPT.make_records(tmp_path, tmp_path / "out")


# --------------------------------------------------------------------------------------------------- the data


@pytest.fixture(scope="module")
def robot(shared_dir, tmp_path_factory):
    """Model and records, by name."""
    out = tmp_path_factory.mktemp("kuka") / "records"
    folders = SCRIPT.make_records(shared_dir / "data/kuka_kr300", out)
    return Arm.from_toml(out / "robot.toml"), {folder.name: Record.load(folder) for folder in folders}


def test_at_rest_the_masses_weigh_what_the_table_says(robot):
    """Moments about axes 2, 3 and 5 of the stretched arm [N m]: centres of mass times weights, by hand."""
    torque = flexarm.static(robot[0]).joint_torque
    assert torque[[1, 2, 4]] == pytest.approx([-9366, -3496, -704], abs=1)


def test_no_sensor_is_at_fault(robot):
    """Friction moves the torques of the last axes more than their masses: no drive is to blame for that."""
    from flexarm.validation.sensor_check import check

    assert check(robot[0], {"a": robot[1]["a_torque"]}).faults == ()


def test_by_hand_the_secondary_encoders_are_late_and_soft(shared_dir):
    found, train, held_out = load_script("kuka_kr300", "by_hand").by_hand(shared_dir / "data/kuka_kr300")
    assert found.delay == pytest.approx(2.97e-3, abs=2e-5)
    assert found.offset == pytest.approx([-1.476e-3, -0.231e-3, 2.009e-3], abs=5e-6)
    assert found.compliance == pytest.approx([-0.73e-7, 0.83e-7, 1.29e-7], abs=2e-9)
    assert 1e6 * train == pytest.approx([66, 80, 62], abs=2)
    assert 1e6 * held_out == pytest.approx([97, 78, 79], abs=2)


def test_a_calibration_finds_the_delay_the_zeros_and_the_compliances(robot):
    arm, records = robot
    found = flexarm.calibrate(arm, {"a": records["a"]}, ["joint_compliance"], records["b"], n_jobs=1)
    value = {each.name: each.value for each in found.parameters}
    assert value["effects.time_delay.secondary.delay"] == pytest.approx(3.0e-3, abs=1e-4)
    zeros = [value[f"effects.sensor_offset.axis_{k}_secondary.offset"] for k in (1, 2, 3)]
    assert zeros == pytest.approx([-1.47e-3, -0.93e-3, 1.87e-3], abs=1e-4)
    soft = [1 / value[f"effects.joint_compliance.axis_{k}.stiffness"] for k in (2, 3)]
    assert soft == pytest.approx([0.93e-7, 1.54e-7], rel=0.2)
    assert all(1 / 1.5 < mine / by_hand < 1.5 for mine, by_hand in zip(soft, (0.83e-7, 1.29e-7), strict=True))
    left = found.after["b"].signals
    gaps = [left[f"axis_{k}_secondary"].rms["total"] for k in (1, 2, 3)]
    assert 1e6 * np.array(gaps) == pytest.approx([85, 90, 65], abs=9)
