"""Claims about files of results: xarray reads what flexarm wrote without it, name by name."""

import numpy as np
import pytest
import xarray as xr

from flexarm.errors import InvalidFile
from flexarm.netcdf import Contents, save

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
