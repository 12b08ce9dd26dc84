"""The GIRAF boom: its reader, and what its pulls at eight lengths say of stiffness, tilt and compliance.

The boom's bending stiffness is not known, so it is fitted along everywhere, as an effect would be.
"""

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from tests.helpers.pose_fit import fitted, gap, rms

from flexarm import Arm, InvalidFile, Record
from flexarm.arm.effect import read_effect
from flexarm.arm.parameter import parameters

FOLDER = Path(__file__).resolve().parents[2] / "examples/giraf_boom"
HEADER = "Boom Extension (mm),Applied Force (N),Endpoint Height (mm),Deflection (mm)\n"
STIFFNESS = "links.boom.material.youngs_modulus"
READING = 1e-3 / np.sqrt(12)


def load_script() -> ModuleType:
    spec = importlib.util.spec_from_file_location("giraf_records", FOLDER / "make_records.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


SCRIPT = load_script()


# ------------------------------------------------------------------------------------------------- the reader


def test_pulls_become_forces_downward_and_heights_places_of_the_tip(tmp_path):
    """Invented rows of two lengths: a record each, in SI."""
    (tmp_path / "static.csv").write_text(HEADER + "500,0,370,5\n500,2.5,360,15\n1000,0,350,25\n")
    SCRIPT.make_records(tmp_path, tmp_path / "out")
    record = Record.load(tmp_path / "out/static_0500")
    assert record.links["boom"].length == 0.5
    assert record.poses == ("0 N", "2.5 N")
    assert record.signals["pull"].values[:, 0].tolist() == [0.0, -2.5]
    assert record.signals["tip"].values[:, 0].tolist() == [0.37, 0.36]
    assert record.signals["tip"].noise_std == pytest.approx(READING)
    assert record.frames["floor"].xyz == (0.0, 0.0, -0.375)
    assert record.check_against(Arm.from_toml(tmp_path / "out/boom.toml")) == []
    assert Record.load(tmp_path / "out/static_1000").links["boom"].length == 1.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: must be 'Boom Extension"),
        (HEADER, "file: holds no readings"),
        (HEADER + "500,0,370\n", "line 2: must be 4 numbers, got '500,0,370'"),
        (HEADER + "500,0,370,5\n500,1,nan,5\n", "line 3: must be 4 numbers"),
        (HEADER + "500,0,370,6\n", "line 2: height and deflection must add up to 375 mm, got 376 mm"),
    ],
)
def test_wrong_files_are_named_with_the_place_of_the_fault(tmp_path, text, message):
    (tmp_path / "static.csv").write_text(text)
    with pytest.raises(InvalidFile, match=rf"static\.csv: {message}"):
        SCRIPT.make_records(tmp_path, tmp_path / "out")
    assert not (tmp_path / "out").exists()


# --------------------------------------------------------------------------------------------------- the data


@pytest.fixture(scope="module")
def boom(shared_dir, tmp_path_factory):
    """Model, and a record for each length."""
    out = tmp_path_factory.mktemp("giraf") / "records"
    folders = SCRIPT.make_records(shared_dir / "data/giraf_boom", out)
    return Arm.from_toml(out / "boom.toml"), [Record.load(folder) for folder in folders]


TILT = ({"name": "base_tilt", "at": "base"}, "effects.base_tilt.base.angle.y")
COMPLIANCE = (
    {"name": "joint_compliance", "at": "pitch", "stiffness": 2e3},
    "effects.joint_compliance.pitch.stiffness",
)
MASS = ({"name": "link_mass", "at": "boom", "scale": 1.0}, "effects.link_mass.boom.scale")

# Effects; rms over all lengths [m], of each length foretold from the other seven; parameters of the effects.
FITS = {
    "bending alone": ((), 7.35e-3, 7.60e-3, ()),
    "joint compliance": ((COMPLIANCE,), 6.97e-3, 7.12e-3, (1216.0,)),
    "base tilt": ((TILT,), 3.16e-3, 3.72e-3, (10.74e-3,)),
    "base tilt and mass": ((TILT, MASS), 2.34e-3, 2.93e-3, (8.90e-3, 1.318)),
}


def with_effects(arm, effects):
    for table, _ in effects:
        arm = arm.with_effect(read_effect(table))
    return arm, [STIFFNESS, *(key for _, key in effects)]


@pytest.mark.parametrize("name", FITS)
def test_what_effects_leave_at_a_length_that_was_left_out(boom, name):
    effects, all_rms, left_out_rms, values = FITS[name]
    arm, keys = with_effects(boom[0], effects)
    records = boom[1]
    best = fitted(arm, records, keys)
    assert rms(gap(best, records)) == pytest.approx(all_rms, rel=5e-3)
    assert [p.value for p in parameters(best, keys[1:])] == pytest.approx(values, rel=5e-3)
    left_out = []
    for k, record in enumerate(records):
        others = [*records[:k], *records[k + 1 :]]
        left_out += gap(fitted(arm, others, keys), [record])
    assert rms(left_out) == pytest.approx(left_out_rms, rel=5e-3)


def test_a_tilted_base_explains_half_of_what_a_soft_joint_leaves():
    """The tempting name is the wrong one of the two; what remains is ten readings large."""
    left = {name: fit[2] for name, fit in FITS.items()}
    assert left["base tilt"] < 0.55 * left["joint compliance"]
    assert left["base tilt and mass"] < 3.1e-3
    assert left["base tilt and mass"] > 10 * READING
