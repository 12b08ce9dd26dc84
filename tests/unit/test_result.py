"""Claims about stored results: whole files or none, and errors that name the file."""

import hashlib

import pytest
from arms import paper_arm

import flexarm
from flexarm import Arm, InvalidFile, Modes
from flexarm.result import load, model_of, provenance


@pytest.fixture(scope="module")
def found() -> Modes:
    return flexarm.modes(paper_arm(1), count=2)


def test_provenance_names_model_backend_and_version(found):
    told = provenance(found.arm)
    assert told["flexarm_version"] == flexarm.__version__
    assert told["model_sha256"] == hashlib.sha256(told["model"].encode()).hexdigest()
    assert told["backend"]


def test_the_model_comes_back_from_the_file(found, tmp_path):
    found.save(tmp_path / "modes.nc")
    again = model_of(load(tmp_path / "modes.nc", "modes"))
    assert isinstance(again, Arm)
    assert again == found.arm


def test_saving_replaces_and_leaves_no_other_file(found, tmp_path):
    for _ in range(2):
        found.save(tmp_path / "modes.nc")
    assert [p.name for p in tmp_path.iterdir()] == ["modes.nc"]


def test_a_name_that_would_not_be_opened_again_is_refused(found, tmp_path):
    """A run.csv of NetCDF is no table, and `flexarm.load` goes by the ending."""
    with pytest.raises(InvalidFile, match=r"must end in \.nc, got run\.csv; .*to_dataframe"):
        found.save(tmp_path / "run.csv")
    assert list(tmp_path.iterdir()) == []


def test_an_unwritable_place_is_named_and_left_clean(found, tmp_path):
    with pytest.raises(InvalidFile, match=r"absent/modes\.nc: output: cannot be written"):
        found.save(tmp_path / "absent" / "modes.nc")
    assert list(tmp_path.iterdir()) == []


def test_a_failure_while_writing_keeps_the_old_file(found, tmp_path, monkeypatch):
    """The file is replaced when the new one is whole, not before."""
    path = tmp_path / "modes.nc"
    found.save(path)
    before = path.read_bytes()

    def fail(self, content):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(type(path), "write_bytes", fail)
    with pytest.raises(InvalidFile, match="No space left on device"):
        found.save(path)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["modes.nc"]


@pytest.mark.parametrize("content", [b"", b"not a NetCDF file", b"CDF\x01"])
def test_a_file_that_is_no_result_is_named(tmp_path, content):
    path = tmp_path / "odd.nc"
    path.write_bytes(content)
    with pytest.raises(InvalidFile, match=r"odd\.nc: file: cannot be read as NetCDF"):
        Modes.load(path)


def test_a_foreign_netcdf_file_is_named(tmp_path):
    import xarray as xr

    xr.Dataset({"x": ("t", [1.0, 2.0])}).to_netcdf(tmp_path / "x.nc", engine="h5netcdf")
    with pytest.raises(InvalidFile, match="kind: must be 'modes', got 'nothing that flexarm wrote'"):
        Modes.load(tmp_path / "x.nc")
