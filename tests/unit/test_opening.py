"""`flexarm.load` opens files by their kind, and says what cannot be opened."""

from __future__ import annotations

import pytest

import flexarm
from flexarm.example.files import write


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The example, with a result of each quick kind."""
    path = tmp_path_factory.mktemp("example") / "tryout"
    path.mkdir()
    write(path)
    arm = flexarm.Arm.load(path / "arm.toml")
    flexarm.static(arm).save(path / "static.nc")
    flexarm.modes(arm, count=2).save(path / "modes.nc")
    flexarm.linearise(arm).save(path / "linear.nc")
    return path


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("arm.toml", flexarm.Arm),
        ("slow", flexarm.Record),
        ("slow/record.toml", flexarm.Record),
        ("static.nc", flexarm.Statics),
        ("modes.nc", flexarm.Modes),
        ("linear.nc", flexarm.LinearModel),
    ],
)
def test_load_opens_a_file_by_its_kind(folder, name, kind):
    assert type(flexarm.load(folder / name)) is kind


def test_a_model_loads_as_from_toml(folder):
    assert flexarm.load(folder / "arm.toml") == flexarm.Arm.from_toml(folder / "arm.toml")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("bracket.inp", "is a mesh; flexarm.read_mesh opens it"),
        (".", "is a directory without any of report.json"),
        ("none.toml", "there is no such file"),
    ],
)
def test_what_cannot_be_loaded_is_named(folder, name, said):
    with pytest.raises(flexarm.InvalidFile, match=said):
        flexarm.load(folder / name)


def test_an_unknown_sign_of_a_map_is_answered_with_scale():
    from flexarm.tables.messages import sentence

    error = {"type": "extra_forbidden", "loc": ("signals", 0, "sign"), "input": -1}
    assert sentence(error, None, ["scale", "offset"]).endswith("scale = -1 turns the sign over")
    assert "scale = -1" not in sentence(error, None, ["offset"])
