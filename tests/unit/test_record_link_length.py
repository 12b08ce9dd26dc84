"""A record that says how far a boom was drawn out, beside the model of that length."""

import numpy as np
import pytest
from tests.helpers.arms import beam, fixed, general, hinge, point

import flexarm
from flexarm import InvalidFile, InvalidParameter, Record, Signal
from flexarm.comparison.poses import solve_poses
from flexarm.comparison.simulated_record import Placement
from flexarm.record import DrawnLink
from flexarm.validation.initial_alignment import simulate_records

MODULUS, SECOND_MOMENT = 70e9, 1.5e-9


def boom(length: float, bow: float = 0.0) -> flexarm.Arm:
    """A clamped boom with a mass at its end and a mark half a decimetre beyond it."""
    return flexarm.Arm.from_dict(
        {
            "joints": [fixed("clamp", "boom")],
            "links": [
                beam(
                    "boom",
                    [length, 0, 0],
                    general(1e-4, SECOND_MOMENT),
                    material={"youngs_modulus": MODULUS, "poisson_ratio": 0.3, "density": 1880.0},
                )
            ],
            "payloads": [{"name": "hook", "link": "boom", "position": [length, 0, 0], "mass": 0.1}],
            "points": [point("tip", "boom", [length + 0.05, 0, 0]), point("mid", "boom", [length / 2, 0, 0])],
            "effects": [{"name": "link_bow", "at": "boom", "tip_offset": [0, 0, bow]}] if bow else [],
        }
    )


def record(**changes) -> Record:
    """Two pulls at the tip."""
    rows = np.array(["a", "b"])
    force = Signal(
        name="pull", quantity="force", point="tip", axes=("z",), values=np.array([[0.0], [-5.0]]), pose=rows
    )
    return Record(kind="static", signals=[force], **changes)


def test_a_boom_drawn_out_is_the_model_of_that_length():
    """Tip, middle, payload and curvature: 2 u/L^2 = 0.004/m in both, u = 2 mm at 1 m and 12.5 mm at 2.5 m."""
    drawn = record(links={"boom": DrawnLink(length=2.5)})
    found = solve_poses(drawn.applied_to(boom(1.0, 2e-3)), drawn)
    wanted = solve_poses(boom(2.5, 12.5e-3), record())
    assert found.position == pytest.approx(wanted.position, abs=1e-12)
    assert found.position[1, 0, 2] < -0.1


def test_a_record_keeps_the_length_in_its_file(tmp_path):
    given = record(links={"boom": DrawnLink(length=2.5)})
    given.save(tmp_path / "record")
    assert Record.load(tmp_path / "record").links == given.links
    (tmp_path / "record/record.toml").write_text(
        (tmp_path / "record/record.toml").read_text().replace("length = 2.5", "length = -2.5")
    )
    with pytest.raises(InvalidFile, match=r"links\.boom\.length .*: must be positive, got -2\.5 m"):
        Record.load(tmp_path / "record")


def test_links_that_have_no_length_are_refused():
    rigid = flexarm.Arm.from_dict(
        {"joints": [fixed("clamp", "block")], "links": [{"name": "block", "type": "rigid", "mass": 1.0}]}
    )
    with pytest.raises(InvalidParameter, match=r"links\.block\.length: must be a beam .* is a rigid link"):
        record(links={"block": DrawnLink(length=1.0)}).applied_to(rigid)
    with pytest.raises(InvalidParameter, match=r"links\.bom: there is no link 'bom'"):
        record(links={"bom": DrawnLink(length=1.0)}).applied_to(boom(1.0))
    with pytest.raises(InvalidParameter, match=r"links\.bom"):
        record(links={"bom": DrawnLink(length=1.0)}).check_against(boom(1.0))


def test_a_check_draws_a_boom_out_once_along_a_motion():
    """A short boom, nearly rigid, sags by less than its readings tell: the tip is where the drive points."""
    t = np.arange(0, 4, 0.02)
    angle = 0.5 - 0.5 * np.cos(np.pi * t / 4)
    section = {"shape": "round", "diameter": 0.1}
    arm = flexarm.Arm.from_dict(
        {
            "joints": [hinge("pitch", "boom", axis=[0, -1, 0])],
            "links": [beam("boom", [1.0, 0, 0], section)],
            "points": [point("tip", "boom", [1.0, 0, 0])],
        }
    )
    drive = Signal(name="pitch", quantity="joint_angle", joint="pitch", time=t, values=angle, noise_std=1e-6)
    tip = Signal(name="tip", quantity="position", point="tip", axes=("x", "z"), time=t, noise_std=1e-3,
                 values=1.5 * np.column_stack([np.cos(angle), np.sin(angle)]))  # fmt: skip
    measured = Record(signals=[drive, tip], drive=("pitch",), links={"boom": DrawnLink(length=1.5)})
    subjects, _, _ = simulate_records(arm, {"run": measured}, 2e-3, -0.05)
    assert np.abs(subjects["run"].residual(tip, Placement())).max() < 1e-3
