"""Numbers have physical ranges by unit: beyond them the place is named, within them nothing overflows."""

# ruff: noqa: E501 (a case a line, as a table)

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from tests.helpers.parts import frame_part

import flexarm
from flexarm import Arm, InvalidFile, InvalidParameter, NotConverged
from flexarm.analytic import FlexibleLink
from flexarm.arm import RigidLink
from flexarm.arm.weight import weight_statement
from flexarm.solids import SolidMesh
from flexarm.tables.ranges import RANGES, range_of

BEYOND = {
    "wide tube": ("0.06024", "1e20", "links.rod.section.outer_diameter", "must be at most 1e+10 m, got 1e+20 m"),
    "thin tube": ("3.25e-3", "1e-300", "links.rod.section.thickness", "must not lie between 0 and 1e-09 m"),
    "wall lost in rounding": ("3.25e-3", "1e-9", "links.rod.section.thickness", "at least 1e-06 of the outer"),
    "long beam": ("end = [0, 0, 3.0]", "end = [0, 0, 1e130]", "links.rod.end", "at most 1e+10 m, got 1e+130 m"),
    "heavy load": ("mass = 14.1", "mass = 1e130", "payloads.load.mass", "must be at most 1e+12 kg"),
    "light load": ("mass = 14.1", "mass = 1e-300", "payloads.load.mass", "between 0 and 1e-12 kg"),
    "little noise": ("noise_std = 0.05", "noise_std = 1e-300", "sensors.tracker.noise_std", "between 0 and 1e-18"),
    "little damping": ("= 0.005\n\n", "= 1e-300\n\n", "links.rod.damping_ratio", "between 0 and 1e-12"),
    "soft modulus": ("210e9", "1e-200", "links.rod.material.youngs_modulus", "between 0 and 1e-06 Pa"),
    "stiff joint": ("= 1.0e5", "= 1e200", "effects.joint_compliance.hinge.stiffness", "at most 1e+18 N m/rad"),
    "far origin": ("0.4]", "-1e300]", "joints.hinge.origin.xyz", "must be at least -1e+10 m, got -1e+300 m"),
    "great sigma": ("= 0.02", "= 1e300", "uncertainty", "must be at most 1e+18, got 1e+300"),
    "little sigma": ("= 0.02", "= 1e-300", "uncertainty.links.rod.material.youngs_modulus", "between 0 and"),
    "long integer": ("gear_ratio = 120", "gear_ratio = 1" + 400 * "0", "joints.hinge.gear_ratio", "a double can hold"),
    "endless integer": ("elements = 4", "elements = " + 5000 * "9", "line", "a whole number has thousands of digits"),
}  # fmt: skip


@pytest.mark.parametrize("case", BEYOND)
def test_a_number_beyond_its_physical_range_is_refused_at_its_place(
    case: str, model_text: str, tmp_path: Path
) -> None:
    old, new, where, what = BEYOND[case]
    assert old in model_text
    file = tmp_path / "arm.toml"
    file.write_text(model_text.replace(old, new, 1))
    with pytest.raises(InvalidFile) as caught:
        Arm.from_toml(file)
    assert [line for line in caught.value.lines() if f": {where}" in line and what in line], str(caught.value)


def test_the_ranges_hold_for_tables_made_in_python() -> None:
    with pytest.raises(InvalidParameter, match=r"mass: must be at most 1e\+12 kg, got 1e\+30 kg"):
        RigidLink(name="body", mass=1e30)
    with pytest.raises(InvalidParameter, match="a whole number of thousands of digits"):
        RigidLink(name="body", mass=10**5000)


def test_the_ranges_hold_for_meshes_and_analytic_links() -> None:
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1e300]])
    with pytest.raises(InvalidParameter, match=r"points: coordinates must be finite and within \+-1e\+10 m"):
        SolidMesh(corners, {"tet4": np.array([[0, 1, 2, 3]])}).check()
    with pytest.raises(InvalidParameter, match=r"flexible link: length must be at most 1e\+10 m"):
        FlexibleLink(length=1e130, bending_stiffness=1.0, mass_per_length=1.0)


@pytest.mark.parametrize("factor", [1e-300, 1e-40, 0.0, 1e40])
def test_matrices_of_a_part_of_any_scale_give_a_result_or_a_clear_error(factor: float) -> None:
    part = frame_part()
    for field in ("mass", "stiffness"):
        try:
            scaled = part.replace(**{field: factor * getattr(part, field)})
            assert "super-element" in scaled.summary()
            assert all(map(str, scaled.check()))
        except InvalidParameter as error:
            assert field in str(error)


@pytest.mark.parametrize("unit", RANGES)
def test_products_of_two_numbers_of_a_unit_stay_within_doubles(unit: str) -> None:
    least, most = range_of(unit)
    assert 0 < least < 1 < most
    assert 1e-100 < least**2 < most**2 < 1e100


ROWS = "time_s,encoder_deg\n0,0\n0.01,{}\n{},2\n"
LIMIT = math.degrees(range_of("rad")[1])
COLUMNS = {
    "value": (ROWS.format("1e300", "0.02"), f"line 3, column encoder_deg: must lie within +-{LIMIT:g}, got 1e+300"),
    "stamp": (ROWS.format("1", "1e30"), "line 4, column time_s: must lie within +-1e+11, got 1e+30"),
    "no step": (ROWS.format("1", "0.01000000000000001"), "line 4, column time_s: 0.01000000000000001 all but repeats 0.01"),
}  # fmt: skip


@pytest.mark.parametrize("case", COLUMNS)
def test_samples_of_a_record_beyond_their_range_are_refused_with_their_line(
    case: str, record_dir: Path
) -> None:
    rows, what = COLUMNS[case]
    (record_dir / "encoder.csv").write_text(rows)
    with pytest.raises(InvalidFile, match=re.escape(what)):
        flexarm.Record.load(record_dir)


def test_noise_that_no_sensor_has_is_refused(record_dir: Path) -> None:
    file = record_dir / "record.toml"
    file.write_text(file.read_text().replace("noise_std = 1.0e-4", "noise_std = 1e-300"))
    with pytest.raises(InvalidFile, match=r"signals\.hinge\.noise_std.*between 0 and 1e-18"):
        flexarm.Record.load(record_dir)


def test_samples_of_a_drive_beyond_their_range_are_refused(model_text: str, tmp_path: Path) -> None:
    (tmp_path / "arm.toml").write_text(model_text)
    arm = Arm.from_toml(tmp_path / "arm.toml")
    (tmp_path / "drive.csv").write_text("time_s,hinge\n0,0\n1,1e300\n")
    with pytest.raises(
        InvalidFile, match=r"line 3, column hinge: must be at most 1e\+09 rad, got 1e\+300 rad"
    ):
        flexarm.Drive.from_csv(tmp_path / "drive.csv", arm)
    with pytest.raises(InvalidParameter, match=r"hinge: must be at most 1e\+09 rad"):
        flexarm.Drive.from_samples([0, 1], {"hinge": [0, 1e300]})
    with pytest.raises(InvalidParameter, match=r"joints\.hinge: must be at most 1e\+09 rad"):
        flexarm.static(arm, {"hinge": 1e300})
    with pytest.raises(InvalidParameter, match=r"forces\.tip: must be at least -1e\+18 N"):
        flexarm.static(arm, forces={"tip": [0, 0, -1e300]})


def _some(rng: np.random.Generator, unit: str) -> float:
    """A size in the range of a unit, each end as likely as all between."""
    low, high = (math.log(limit) for limit in range_of(unit))
    u = float(rng.choice([0.0, 1.0, rng.uniform()], p=[0.2, 0.2, 0.6]))
    return min(max(math.exp(low + u * (high - low)), range_of(unit)[0]), range_of(unit)[1])


def _vector(rng: np.random.Generator, unit: str) -> list[float]:
    return [float(rng.choice([-1, 0, 1])) * _some(rng, unit) for _ in range(3)]


def _link(rng: np.random.Generator, name: str) -> dict[str, object]:
    if rng.uniform() < 0.3:
        moment = _some(rng, "kg m2")
        return {
            "name": name,
            "type": "rigid",
            "mass": _some(rng, "kg"),
            "com": _vector(rng, "m"),
            "inertia": [moment, moment, moment],
        }
    width = _some(rng, "m")
    sections = [
        {"shape": "round", "diameter": width},
        {"shape": "tube", "outer_diameter": width, "thickness": max(width * rng.uniform(2e-6, 0.49), 1e-9)},
        {"shape": "rectangle", "width": width, "height": _some(rng, "m")},
        {
            "shape": "general",
            "area": _some(rng, "m2"),
            "second_moment": [_some(rng, "m4"), _some(rng, "m4")],
            "torsion_constant": _some(rng, "m4"),
        },
    ]
    return {
        "name": name,
        "type": "beam",
        "end": [0.0, 0.0, _some(rng, "m")],
        "up": [1.0, 0.0, 0.0],
        "section": sections[rng.integers(4)],
        "material": {
            "youngs_modulus": _some(rng, "Pa"),
            "poisson_ratio": 0.3,
            "density": _some(rng, "kg/m3") * float(rng.uniform() < 0.9),
        },
        "theory": str(rng.choice(["timoshenko", "euler-bernoulli"])),
        "damping_ratio": float(rng.choice([0.0, 1e-12, 0.01, 0.99])),
        "elements": int(rng.integers(1, 4)),
    }


def _extreme(rng: np.random.Generator) -> dict[str, object]:
    """A chain of one to three links with sizes from anywhere in their ranges."""
    names = [f"link{k}" for k in range(int(rng.integers(1, 4)))]
    joints = [
        {
            "name": f"joint{k}",
            "type": str(rng.choice(["revolute", "prismatic"])),
            "parent": names[k - 1] if k else "base",
            "child": name,
            "origin": {"xyz": _vector(rng, "m"), "rpy": [0.0, float(rng.uniform(-3, 3)), 0.0]},
            "axis": [0.0, 1.0, 0.0],
            "gear_ratio": _some(rng, "-"),
            "rotor_inertia": _some(rng, "kg m2") * float(rng.uniform() < 0.5),
        }
        for k, name in enumerate(names)
    ]
    effects = [
        {"name": "joint_compliance", "at": "joint0", "stiffness": _some(rng, "N m/rad")},
        {"name": "link_mass", "at": names[-1], "scale": _some(rng, "-")},
    ]
    return {
        "gravity": _vector(rng, "m/s2") if rng.uniform() < 0.3 else [0, 0, -9.81],
        "joints": joints,
        "links": [_link(rng, name) for name in names],
        "payloads": [
            {"name": "load", "link": names[-1], "position": _vector(rng, "m"), "mass": _some(rng, "kg")}
        ],
        "points": [{"name": "tip", "link": names[-1], "position": _vector(rng, "m")}],
        "effects": [effect for effect in effects if rng.uniform() < 0.4],
    }


@pytest.mark.parametrize("seed", range(8))
def test_models_at_the_ends_of_the_ranges_give_a_result_or_a_clear_error(seed: int) -> None:
    """Warnings are errors here, so that an overflow or a division by zero would fail."""
    rng = np.random.default_rng(seed)
    for _ in range(25):
        try:
            arm = Arm.from_dict(_extreme(rng))
        except InvalidParameter:  # such as inertias that no body has
            continue
        assert all(str(problem) for problem in arm.warnings)
        whole = weight_statement(arm).whole
        assert np.isfinite([whole.mass, *whole.centre, *np.ravel(whole.inertia)]).all()
        for compute in (flexarm.static, flexarm.modes):
            try:
                result = compute(arm)
            except (InvalidParameter, NotConverged):
                continue
            numbers = result.position if compute is flexarm.static else result.frequency_hz
            assert np.isfinite(numbers).all()
