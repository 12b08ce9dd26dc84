"""Arms of super-elements beside arms of beam elements, through files and the public functions."""

from pathlib import Path

import numpy as np
import pytest
from arms import arm, compliance, drive, paper_arm, swing_angle
from part_arms import arm_of_parts, tube_part
from pytest import approx

import flexarm

SPRING = 1e5


@pytest.fixture
def of_parts(tmp_path: Path) -> flexarm.Arm:
    return arm(name="parts", **arm_of_parts(tmp_path, 4), effects=[compliance("hinge", SPRING)])


def test_a_chain_of_parts_sags_as_the_beam(of_parts: flexarm.Arm) -> None:
    beam = flexarm.static(paper_arm(4, SPRING), joints={"hinge": 1.0})
    parts = flexarm.static(of_parts, joints={"hinge": 1.0})
    # Of 44 mm. Gravity acts on a part's first-order displacements, on a beam's at its nodes.
    assert parts.position[0] == approx(beam.position[0], abs=1e-6)
    assert parts.displacement[0] == approx(beam.displacement[0], abs=1e-6)
    assert parts.base_wrench == approx(beam.base_wrench, rel=1e-6, abs=1e-4)
    assert parts.joint_torque[0] == approx(beam.joint_torque[0], rel=1e-6)


def test_a_chain_of_parts_vibrates_as_the_beam(of_parts: flexarm.Arm) -> None:
    beam = flexarm.modes(paper_arm(4, SPRING), joints={"hinge": 1.0}, count=6).frequency_hz
    assert flexarm.modes(of_parts, joints={"hinge": 1.0}, count=6).frequency_hz == approx(beam, rel=2e-5)


def test_a_chain_of_parts_swings_as_the_beam(of_parts: flexarm.Arm) -> None:
    motion = drive({"hinge": swing_angle}, 5.0)
    beam = flexarm.simulate(paper_arm(4, SPRING), motion, step=5e-3)
    parts = flexarm.simulate(of_parts, motion, step=5e-3)
    assert np.abs(parts.position - beam.position).max() < 2e-6  # of 48 mm
    total = parts.kinetic + parts.elastic + parts.gravity - parts.work + parts.damped
    assert np.ptp(total) < 2e-3 * np.ptp(parts.work)


def test_how_the_part_lies_in_its_frame_does_not_matter(tmp_path: Path) -> None:
    """The same part in a turned and shifted frame, held through its interface's own axes: the same arm."""
    turn, shift = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]]), np.array([0.3, -0.2, 5.0])
    tables = arm_of_parts(tmp_path, 2)
    here = flexarm.static(arm(**tables), joints={"hinge": 0.7})
    part = tube_part(1.5).moved(turn, shift)
    assert part.rotations[0] == approx(turn)  # the interfaces' axes turn with the part
    part.save(tmp_path / "segment.nc", force=True)
    there = flexarm.static(arm(**tables), joints={"hinge": 0.7})
    assert there.position == approx(here.position, abs=1e-12)
    assert there.base_wrench == approx(here.base_wrench, rel=1e-9, abs=1e-9)


def test_damping_of_a_part_is_that_of_its_first_clamped_mode(tmp_path: Path) -> None:
    """C = 2 zeta/omega1 K, omega1 of the held part: the beam's own rule with one element."""
    tables = arm_of_parts(tmp_path, 1)
    tables["links"][0]["damping_ratio"] = 0.01
    part = flexarm.modes(arm(**tables), count=2, gravity=False).damping_ratio
    beam = flexarm.modes(paper_arm(1, damping_ratio=0.01), count=2, gravity=False).damping_ratio
    assert part == approx(beam, rel=1e-9)


def test_the_shape_of_a_part_moves_its_end_to_the_tip(of_parts: flexarm.Arm, tmp_path: Path) -> None:
    found = flexarm.static(of_parts, joints={"hinge": 1.0})
    last = found.parts["s3"]
    end = last.position + last.rotation @ (np.array([0, 0, 0.75]) + last.freedoms[6:9])
    assert end == approx(found.position[0], abs=1e-6)  # displacements to first order
    found.save(tmp_path / "static.nc")
    again = flexarm.Statics.load(tmp_path / "static.nc").parts["s3"]
    assert len(found.dataset.attrs["s3_sha256"]) == 64  # of the file that the part came from
    assert np.array_equal(again.freedoms, last.freedoms)
    assert np.array_equal(again.rotation, last.rotation)


def test_a_rigid_part_is_the_rigid_arm(tmp_path: Path) -> None:
    """As the modulus grows, the tip's displacement vanishes as 1/E."""
    tables = arm_of_parts(tmp_path, 1)
    soft = tube_part()
    stiff = soft.replace(stiffness=1e4 * soft.stiffness)
    first = flexarm.static(arm(**tables), joints={"hinge": 1.0}).displacement[0]
    stiff.save(tmp_path / "segment.nc", force=True)
    second = flexarm.static(arm(**tables), joints={"hinge": 1.0}).displacement[0]
    assert np.linalg.norm(second) == approx(1e-4 * np.linalg.norm(first), rel=0.02)


def test_a_deflection_sensor_sees_a_part_bend_as_a_beam(tmp_path: Path) -> None:
    """From the link's rigid place, in its axes; the interface's own frame does not matter."""
    motion = drive({"hinge": swing_angle}, 3.0)
    sensor = {"name": "d", "quantity": "deflection", "axes": ["x", "z"], "point": "tip", "rate_hz": 10}
    found = []
    for model in (arm(**arm_of_parts(tmp_path, 1), sensors=[sensor]), paper_arm(1).replace(sensors=[sensor])):
        run = flexarm.simulate(model, motion, step=5e-3)
        found.append(flexarm.measure(run, model.sensors, np.random.default_rng(0)).signals["d"].values)
    assert np.ptp(found[1][:, 0]) > 0.02
    assert found[0] == approx(found[1], abs=1e-4)


def test_no_deflection_is_measured_from_a_part_that_bends_itself(tmp_path: Path) -> None:
    sensor = {"name": "d", "quantity": "deflection", "axes": ["x"], "point": "tip", "rate_hz": 10}
    model = arm(**arm_of_parts(tmp_path, 2), sensors=[sensor])
    run = flexarm.simulate(model, drive({"hinge": swing_angle}, 0.5), step=5e-3)
    with pytest.raises(flexarm.InvalidParameter, match="stands on the flexible 's0:end'"):
        flexarm.measure(run, model.sensors, np.random.default_rng(0))
