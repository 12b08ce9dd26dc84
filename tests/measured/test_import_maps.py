"""The maps of the examples read measured files as they lie: what NumPy or a script makes of them."""

from pathlib import Path

import numpy as np
import pytest
from tests.helpers.example_scripts import EXAMPLES, load_script

import flexarm
from flexarm import Record

DATA = EXAMPLES.parent.parent / "shared" / "data"


def imported(folder: str, name: str) -> Record:
    """The record of a map of the examples."""
    if not DATA.is_dir():
        pytest.skip(f"no folder {DATA}, from which the maps read")
    return flexarm.import_record(EXAMPLES / folder / f"{name}.map.toml")


def assert_alike(record: Record, expected: Record, shift: float = 0.0) -> None:
    """The same signals: values to the digits of the map, stamps after a shift."""
    assert record.drive == expected.drive
    lengths = {name: drawn.length for name, drawn in expected.links.items()}
    assert {name: drawn.length for name, drawn in record.links.items()} == pytest.approx(lengths)
    assert dict(record.controllers) == dict(expected.controllers)
    assert dict(record.frames) == dict(expected.frames)
    assert dict(record.clocks) == dict(expected.clocks)
    assert list(record.signals) == list(expected.signals)
    for name, signal in record.signals.items():
        other = expected.signals[name]
        for key in ("quantity", "joint", "point", "side", "axes", "unit", "clock", "frame"):
            assert getattr(signal, key) == getattr(other, key), (name, key)
        size = np.abs(other.values).max()
        np.testing.assert_allclose(signal.values, other.values, rtol=0, atol=1e-5 * size)
        np.testing.assert_allclose(signal.time - shift, other.time, rtol=0, atol=1e-6)


@pytest.mark.parametrize("test", [2, 3])
def test_the_asen_maps_equal_its_script(test, tmp_path):
    record = imported("asen_flexible_arm", f"test_{test}")
    script = load_script("asen_flexible_arm", "make_records")
    script.make_records(DATA / "asen_flexible_arm", tmp_path / "out")
    expected = Record.load(tmp_path / f"out/test_{test}/by_hub_angle")
    assert_alike(record, expected, shift=record.signals["hub"].time[0])
    assert record.initial == expected.initial == "moving"
    assert record.duration == pytest.approx(9.999)  # of the motion, though stamps start at 1468 or 3688 s


def test_the_giraf_maps_equal_its_scripts(tmp_path):
    found = {path.name.partition(".")[0] for path in (EXAMPLES / "giraf_boom").glob("*.map.toml")}
    records = {name: imported("giraf_boom", name) for name in sorted(found)}
    made = load_script("giraf_boom", "make_records").make_records(DATA / "giraf_boom", tmp_path / "out")
    assert {path.name for path in made} == found
    for name, record in records.items():
        assert_alike(record, Record.load(tmp_path / "out" / name))


@pytest.mark.parametrize("name", ["a", "b"])
def test_the_kuka_maps_read_the_matrices_row_by_row(name):
    from scipy.io import loadmat

    record = imported("kuka_kr300", f"trajectory_{name}")
    path = Path(DATA / "kuka_kr300" / f"trajectory_{name}.mat")
    rec = loadmat(path, squeeze_me=True, struct_as_record=False)["rec"]
    for axis in range(6):
        signal = record.signals[f"axis_{axis + 1}"]
        np.testing.assert_array_equal(signal.time, rec.time_cont)
        np.testing.assert_allclose(signal.values[:, 0], np.radians(rec.act_pos_mot_deg[axis]), rtol=1e-12)
        torque = record.signals[f"axis_{axis + 1}_torque"].values[:, 0]
        np.testing.assert_array_equal(torque, rec.act_torque_abs_nm[axis])
    seen = record.signals["axis_2_secondary"].values[:, 0]
    np.testing.assert_allclose(seen, np.radians(rec.act_pos_se_deg[1]), rtol=1e-12)


def test_the_justin_map_equals_its_script():
    record = imported("dlr_justin", "poses")
    script = load_script("dlr_justin", "make_records")
    rows = np.loadtxt(DATA / "dlr_justin" / "poses.csv", delimiter=",", skiprows=1)
    expected = script.record(rows, "all poses")
    assert_alike(record, expected)
    assert record.description == expected.description
    assert len(record.poses) == 400
    assert record.poses == expected.poses
