"""Claims about files of results: xarray reads what flexarm wrote without it, name by name."""

import random

import h5py
import numpy as np
import pytest
import xarray as xr

from flexarm.errors import InvalidFile
from flexarm.netcdf import Contents, growing_hdf5, save
from flexarm.reading import check_hdf5

TIME = np.linspace(0.0, 1.0, 5)
EXAMPLE = Contents(
    {
        "position": (("time", "point", "axis"), np.arange(30.0).reshape(5, 2, 3), {"units": "m"}),
        "voltage": (("time",), np.array([np.nan, 1.0, np.inf, -0.0, 2.0]), {"units": "V", "long_name": "V"}),
        "order": (("point",), np.array([2, 1]), {}),
    },
    {"point": ["tip", "bogen-ü"], "axis": ["x", "y", "z"]},
    {"kind": "example", "model": "a\nb = 'c'", "empty": "", "steps": 5, "alpha": -0.05},
    {"time": (("time",), TIME, {"units": "s"})},
)


def test_a_file_comes_back_as_the_dataset_it_was(tmp_path):
    save(EXAMPLE, tmp_path / "example.nc")
    with xr.open_dataset(tmp_path / "example.nc", engine="h5netcdf") as found:
        again = found.load()
    xr.testing.assert_equal(again, EXAMPLE.dataset())
    assert dict(again.attrs) == dict(EXAMPLE.attributes)
    for name, (_, _, attributes) in {**EXAMPLE.variables, **EXAMPLE.coordinates}.items():
        assert again[name].attrs == attributes, name


def test_a_matrix_may_repeat_a_dimension_and_another_have_no_length(tmp_path):
    """As the matrices of a super-element do, and its inner modes where there are none."""
    stiffness = np.array([[2.0, -1.0], [-1.0, 2.0]])
    matrix = {"stiffness": (("dof", "dof"), stiffness, {}), "frequency": (("mode",), np.zeros(0), {})}
    save(Contents(matrix), tmp_path / "matrix.nc")
    with pytest.warns(UserWarning, match="Duplicate dimension"):
        found = xr.load_dataset(tmp_path / "matrix.nc", engine="h5netcdf")
    np.testing.assert_array_equal(found["stiffness"].values, stiffness)
    assert found["frequency"].shape == (0,)


def test_sizes_that_contradict_one_another_leave_no_file(tmp_path):
    two = {"a": (("time",), np.zeros(2), {}), "b": (("time",), np.zeros(3), {})}
    with pytest.raises(ValueError, match="b has 3 along time, of 2"):
        save(Contents(two), tmp_path / "two.nc")
    assert list(tmp_path.iterdir()) == []


def test_a_directory_in_the_place_of_the_file_is_named(tmp_path):
    (tmp_path / "run.nc").mkdir()
    with pytest.raises(InvalidFile, match=r"run\.nc: output: must be a file"):
        save(EXAMPLE, tmp_path / "run.nc")
    assert [p.name for p in tmp_path.iterdir()] == ["run.nc"]


@pytest.mark.parametrize("grows", [False, True])
def test_a_damaged_byte_anywhere_is_told(tmp_path, grows):
    path = tmp_path / "example.nc"
    if grows:
        with growing_hdf5(path) as file:
            file["x"] = TIME
    else:
        save(EXAMPLE, path)
    check_hdf5(path)
    whole = path.read_bytes()
    generator = random.Random(1)
    for _ in range(200):
        at = generator.randrange(len(whole) - 20)
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 1 << generator.randrange(8)]) + whole[at + 1 :])
        with pytest.raises(InvalidFile, match="is damaged: its checksum"):
            check_hdf5(path)


def test_a_file_that_another_program_changes_has_no_checksum_any_more(tmp_path):
    save(EXAMPLE, tmp_path / "example.nc")
    with h5py.File(tmp_path / "example.nc", "r+") as file:
        file.attrs["comment"] = "looked at"
        file["position"][0] = 7.0
    check_hdf5(tmp_path / "example.nc")
    with xr.open_dataset(tmp_path / "example.nc", engine="h5netcdf") as found:
        assert found.attrs["comment"] == "looked at"
