"""Claims about an equilibrium as an object, and about what cannot stand."""

import json

import numpy as np
import pytest
from arms import G, arm, beam, compliance, fixed, general, hinge, paper_arm, point, rigid

import flexarm
from flexarm import InvalidFile, InvalidParameter, NotConverged, Statics


@pytest.fixture(scope="module")
def found() -> Statics:
    """The paper's arm, leaning."""
    return flexarm.static(paper_arm(2, 1e5), joints={"hinge": 0.5})


def test_json_holds_what_the_contract_names(found):
    data = json.loads(json.dumps(found.to_json_dict()))
    assert set(data) == {"points", "joints", "links", "base", "solver"}
    assert data["points"]["tip"]["position"] == pytest.approx(found.position[0])
    assert data["points"]["tip"]["displacement"] == pytest.approx(found.displacement[0])
    assert set(data["joints"]["hinge"]) == {"torque", "drive_angle", "link_angle"}
    assert set(data["links"]["rod"]["start"]) == {"force", "moment"}
    assert data["base"]["force"] == pytest.approx(found.base_wrench[:3])
    assert data["base"]["moment"] == pytest.approx(found.base_wrench[3:])


def test_displacement_counts_from_the_rigid_arm(found):
    rigid_tip = 3.0 * np.array([np.sin(0.5), 0, np.cos(0.5)])
    assert found.position[0] - found.displacement[0] == pytest.approx(rigid_tip, abs=1e-12)


def test_joint_torque_winds_up_its_spring(found):
    """T = k (phi - theta), and it balances the moment on the base about the hinge."""
    assert found.drive_angle == pytest.approx([0.5])
    assert found.joint_torque == pytest.approx(1e5 * (found.drive_angle - found.link_angle), abs=1e-6)
    assert found.joint_torque[0] == pytest.approx(-found.base_wrench[4], abs=1e-6)


def test_section_forces_of_a_horizontal_cantilever():
    """A light load on a cantilever along x, up = z: what the outer part puts on the inner one.

    V_z = -(P + w (L - x)), M_y = P (L - x) + w (L - x)^2/2, both zero beyond the end but for P.
    """
    second, area, L, P = 1e-6, 1e-3, 2.0, 5.0
    bar = arm(
        joints=[fixed("clamp", "bar")],
        links=[beam("bar", [L, 0, 0], general(area, second), up=[0, 0, 1], elements=2)],
        points=[point("tip", "bar", [L, 0, 0])],
    )
    found = flexarm.static(bar, forces={"tip": [0, 0, -P]})
    w = 7850 * area * G
    assert found.section_forces[0, 0, 2] == pytest.approx(-(P + w * L), rel=1e-9)
    assert found.section_forces[0, 0, 4] == pytest.approx(P * L + w * L**2 / 2, rel=1e-4)
    assert found.section_forces[0, 1] == pytest.approx([0, 0, -P, 0, 0, 0], abs=0.02)
    assert found.base_wrench[:3] == pytest.approx([0, 0, -(P + w * L)], abs=1e-7)


def test_section_forces_of_rigid_links_are_not_a_number():
    lever = arm(joints=[hinge("hinge", "lever")], links=[rigid("lever", 1.0, com=[0.5, 0, 0])])
    held = flexarm.static(lever)
    assert np.isnan(held.section_forces).all()
    assert held.to_json_dict()["links"] == held.to_json_dict()["points"] == {}
    assert "no points: the model has no [[points]]" in held.summary()
    assert not [line for line in held.summary().splitlines() if line.startswith(("point", "beam"))]
    assert held.joint_torque == pytest.approx([-0.5 * G])


def test_arrays_are_read_only(found):
    with pytest.raises(ValueError, match="read-only"):
        found.position[0, 0] = 1.0


def test_save_and_load_round_trip(found, tmp_path):
    found.save(tmp_path / "static.nc")
    again = Statics.load(tmp_path / "static.nc")
    assert again.arm == found.arm
    assert (again.points, again.joints) == (found.points, found.joints)
    for name in ("position", "displacement", "joint_torque", "section_forces", "base_wrench"):
        assert np.array_equal(getattr(again, name), getattr(found, name)), name
    with pytest.raises(InvalidFile, match="must be 'modes', got 'statics'"):
        flexarm.Modes.load(tmp_path / "static.nc")


def test_plot_summary_and_repr(found):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots()
    assert found.plot(ax=axes) is axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [m]", "z [m]")
    plt.close(figure)
    assert "equilibrium of paper" in found.summary()
    assert "-0.0000," not in found.summary() and "-0.00000\n" not in found.summary()
    assert repr(found).startswith("<Statics of 'paper': 1 points, moved up to")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"joints": {"elbow": 1.0}}, "joints: there is no moving joint 'elbow'; there are hinge"),
        ({"joints": {"hinge": np.nan}}, r"joints\.hinge: must be finite, got nan"),
        ({"forces": {"elbow": [0, 0, 1]}}, "forces: there is no point 'elbow'; there are tip"),
        ({"forces": {"tip": [0, 1]}}, r"forces\.tip: must be three finite numbers"),
        ({"forces": {"tip": [0, 1, np.inf]}}, r"forces\.tip: must be three finite numbers"),
    ],
)
def test_unknown_places_are_named(arguments, message):
    with pytest.raises(InvalidParameter, match=message):
        flexarm.static(paper_arm(1), **arguments)


def test_an_arm_too_weak_to_stand_says_so():
    """Upright on a spring of less than m g h the paper's arm falls over, already at a part of its weight."""
    with pytest.raises(NotConverged, match=r"buckles at about 0\.8") as caught:
        flexarm.static(paper_arm(2, 500.0))
    assert caught.value.residual is not None


def test_gravity_may_be_absent():
    held = flexarm.static(
        arm(
            gravity=[0, 0, 0],
            joints=[hinge("hinge", "rod")],
            links=[beam("rod", [0, 0, 1], general(1e-4, 1e-8))],
            points=[point("tip", "rod", [0, 0, 1])],
            effects=[compliance("hinge", 10.0)],
        ),
        joints={"hinge": 1.0},
    )
    assert held.displacement == pytest.approx(np.zeros((1, 3)), abs=1e-12)
    assert held.base_wrench == pytest.approx(np.zeros(6), abs=1e-9)


def test_points_beside_a_beam_follow_its_section():
    """A point off the axis turns with the section: it moves by w + theta x offset."""
    second, L, off, P = 1e-8, 1.0, 0.1, 1e-3
    weightless = {"youngs_modulus": 210e9, "poisson_ratio": 0.3, "density": 0.0}
    bar = arm(
        joints=[fixed("clamp", "bar")],
        links=[beam("bar", [L, 0, 0], general(1e-3, second), material=weightless)],
        points=[point("tip", "bar", [L, 0, 0]), point("above", "bar", [L, 0, off])],
    )
    moved = flexarm.static(bar, forces={"tip": [0, 0, -P]}).displacement
    slope = P * L**2 / (2 * 210e9 * second)
    assert moved[1] - moved[0] == pytest.approx([slope * off, 0, 0], abs=1e-6 * slope)
