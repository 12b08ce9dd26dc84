"""The solid hinge: its dimensions, meshes, masses, stiffness, and the arms that stand on it."""

from pathlib import Path

import numpy as np
import pytest
from hinges import coarse_design
from pytest import approx

import flexarm
from flexarm import InvalidFile, InvalidParameter
from flexarm.arm.weight import weight_statement
from flexarm.mockup import HingeDesign, SolidHinge, bench_arm, build_hinge, mock_up, model, solid_arm
from flexarm.mockup.arms import shaft_stiffness
from flexarm.mockup.design import PARTS, TUBE_RADIUS
from flexarm.mockup.hinge import MESHERS

SHIPPED = Path(flexarm.mockup.__file__).with_name("hinge.toml")


@pytest.fixture(scope="module")
def hinge(tmp_path_factory: pytest.TempPathFactory) -> SolidHinge:
    return build_hinge(tmp_path_factory.mktemp("hinge"), coarse_design())


def held(part: flexarm.SuperElement, interface: str, by: str) -> np.ndarray:
    """Compliance (6, 6) of an interface with another one held and all else free."""
    a, b = part.interfaces.index(by), part.interfaces.index(interface)
    free = np.setdiff1d(np.arange(part.n_dof), np.arange(6 * a, 6 * a + 6))
    at = [int(np.flatnonzero(free == 6 * b + k)[0]) for k in range(6)]
    return np.linalg.inv(part.stiffness[np.ix_(free, free)])[np.ix_(at, at)]


@pytest.mark.parametrize(
    ("old", "new", "where", "what"),
    [
        (
            "shaft_diameter = 0.040",
            "shaft_diameter = 0.140",
            "reducer.shaft_diameter",
            "does not fit: 0.07 m",
        ),
        ("bore = 0.020", "bore = -0.020", "hub.bore", "must be positive, got -0.02 m"),
        ("around = 32", "around = 30", "mesh.around", "multiple of 16"),
        ("web_offset = 0.060", "web_offset = 0.010", "housing.web_offset", "into the flange"),
        ("length = 0.175", "length = 0.300", "hub.length", "a clearance to the reducer's body"),
        ("ring_mass = 1.6", "ring_weight = 1.6", "rigid.ring_mass", "is missing; needed is mass [kg]"),
    ],
)
def test_impossible_dimensions_are_refused_by_name(
    tmp_path: Path, old: str, new: str, where: str, what: str
) -> None:
    text = SHIPPED.read_text(encoding="utf-8")
    assert text.count(old) == 1
    (tmp_path / "wrong.toml").write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(InvalidFile) as caught:
        HingeDesign.from_toml(tmp_path / "wrong.toml")
    message = str(caught.value)
    assert "wrong.toml" in message
    assert where in message
    assert what in message


def test_volumes_are_those_of_the_rings_that_the_parts_consist_of(hinge: SolidHinge) -> None:
    """pi (R^2 - r^2) h by hand; arcs of 20-node cells are parabolas, 16 around: 2e-5 too little."""
    rings = {
        "housing": [(0.088, 0.15, 0.02), (0.088, 0.1, 0.13), (0.025, 0.088, 0.01), (0.075, 0.1, 0.03)],
        "reducer": [(0, 0.075, 0.03), (0, 0.02, 0.185), (0, 0.05, 0.015)],
        "hub": [(0.02, 0.075, 0.02), (0.063, 0.075, 0.175), (0.075, 0.085, 0.08)],
    }
    for name in PARTS:
        mass = 7850 * sum(np.pi * (R**2 - r**2) * h for r, R, h in rings[name])
        assert hinge.parts[name].mass_total == approx(mass, rel=2e-4), name


def test_interfaces_meet_on_the_axis_and_at_the_tube(hinge: SolidHinge) -> None:
    place = {
        name: dict(zip(part.interfaces, part.positions, strict=True)) for name, part in hinge.parts.items()
    }
    assert place["housing"]["seat"] == approx(place["reducer"]["input"])
    assert place["reducer"]["output"] == approx(place["hub"]["input"])
    assert place["hub"]["output"] == approx([0, 0, 0.085])
    for part in place.values():
        for name, position in part.items():
            assert name == "output" or position[[0, 2]] == approx([0, 0])


def test_the_pad_under_the_tube_is_the_same_on_any_mesh() -> None:
    shipped = HingeDesign.from_toml()
    for size, around in ((0.04, 16), (0.01, 64)):
        design = shipped.replace(mesh={"size": size, "around": around})
        mesh = MESHERS["hub"](design).mesh
        x, y, z = mesh.points[mesh.point_set("output")].T
        assert (y.min(), y.max()) == approx((-TUBE_RADIUS, TUBE_RADIUS))
        assert np.arctan2(x, z).max() == approx(np.pi / 8)
        assert np.hypot(x, z) == approx(0.085)


def test_the_output_shaft_is_the_soft_part_and_nearly_its_bar(hinge: SolidHinge) -> None:
    """G J/l of a bar of that length bounds the reducer from above; its ends yield a little."""
    bar = 210e9 / 2.6 * np.pi * 0.04**4 / 32 / 0.185
    found = shaft_stiffness(hinge)
    assert 0.9 * bar < found < bar
    assert found == approx(1 / held(hinge.parts["reducer"], "output", "input")[4, 4], rel=1e-9)


def test_equivalent_stiffness_is_that_of_three_springs_in_series(hinge: SolidHinge) -> None:
    """1/k = sum of the parts' compliances: torque passes through all three; from the matrices alone."""
    parts = hinge.parts
    compliance = [
        held(parts["housing"], "seat", "base")[4, 4],
        held(parts["reducer"], "output", "input")[4, 4],
        held(parts["hub"], "output", "input")[4, 4],
    ]
    # The seat of the tube turns a little more than the hub's own compliance says: 100 N m tilt nothing else.
    assert hinge.stiffness == approx(1 / sum(compliance), rel=1e-6)
    assert 0.5e5 < hinge.stiffness < 2e5


def test_a_part_made_rigid_takes_its_share_of_the_compliance_away(hinge: SolidHinge, tmp_path: Path) -> None:
    shares = []
    for name in PARTS:
        without = hinge.with_compliance({name: 1e-6}, tmp_path / name)
        shares.append(1 / hinge.stiffness - 1 / without.stiffness)
    assert sum(shares) == approx(1 / hinge.stiffness, rel=1e-5)
    assert min(shares) > 0
    doubled = hinge.with_compliance(dict.fromkeys(PARTS, 2.0), tmp_path / "soft")
    assert doubled.stiffness == approx(hinge.stiffness / 2, rel=1e-5)  # 1 mrad of turn


def test_the_rigid_tip_is_three_metres_from_the_hinge_axis(hinge: SolidHinge) -> None:
    for arm in (solid_arm(hinge), bench_arm(hinge, mock_up())):
        found = flexarm.static(arm, joints={"hinge": 0.7})
        rigid = found.position - found.displacement
        assert rigid[-1] == approx([3 * np.sin(0.7), 0, 3 * np.cos(0.7)], abs=1e-12)
        assert rigid[0] == approx(0.15 * rigid[-1] / 3, abs=1e-12)


def test_the_motor_shaft_turns_by_the_ratio(hinge: SolidHinge) -> None:
    found = flexarm.static(solid_arm(hinge), joints={"motor_shaft": 84.0})
    angle = dict(zip(found.joints, found.link_angle, strict=True))
    assert angle["hinge"] == approx(0.7)
    assert found.position[-1, 0] == approx(3 * np.sin(0.7), abs=0.05)


def test_every_part_weighs_on_the_base(hinge: SolidHinge) -> None:
    arm = solid_arm(hinge)
    rigid = hinge.design.rigid
    parts = sum(part.mass_total for part in hinge.parts.values())
    lumped = rigid.motor_mass + rigid.rotor_mass + 2 * rigid.ring_mass
    tube = 5.82e-4 * 7850 * (3 - 0.085)
    mass = parts + lumped + tube + 14.1
    assert weight_statement(arm).whole.mass == approx(mass)
    assert flexarm.static(arm).base_wrench[2] == approx(-9.81 * mass)


def test_the_arm_on_solid_parts_sags_and_vibrates_as_one_on_their_springs(hinge: SolidHinge) -> None:
    """A rigid hub of 85 mm on a spring of the equivalent stiffness: the lumped model with the same shape.

    Gravity tilts the solid hinge a little too, and the hub's own mass swings with it: a few thousandths.
    """
    arm = solid_arm(hinge)
    tube = arm.link("tube")
    spring = flexarm.Arm.from_dict(
        {
            "format": "flexarm-arm/1",
            "joints": [
                {"name": "hinge", "type": "revolute", "parent": "base", "child": "hub", "axis": [0, 1, 0]},
                {
                    "name": "weld",
                    "type": "fixed",
                    "parent": "hub",
                    "child": "tube",
                    "origin": {"xyz": [0, 0, 0.085]},
                },
            ],
            "links": [
                {"name": "hub", "type": "rigid", "mass": hinge.parts["hub"].mass_total},
                tube.to_plain(),
            ],
            "payloads": [load.to_plain() for load in arm.payloads if load.name == "load"],
            "points": [point.to_plain() for point in arm.points],
            "effects": [{"name": "joint_compliance", "at": "hinge", "stiffness": hinge.stiffness}],
        }
    )
    solid, lumped = (flexarm.static(a, joints={"hinge": 1.2}).displacement[-1] for a in (arm, spring))
    assert solid[[0, 2]] == approx(lumped[[0, 2]], rel=5e-3)
    first = [flexarm.modes(a, count=1).frequency_hz[0] for a in (arm, spring, bench_arm(hinge, model()))]
    assert first == approx(first[0] * np.ones(3), rel=5e-3)


def test_damping_of_the_first_mode_stays_that_of_the_lumped_model(hinge: SolidHinge) -> None:
    ratios = [flexarm.modes(arm, count=1).damping_ratio[0] for arm in (solid_arm(hinge), model())]
    assert ratios == approx([0.014, 0.014], abs=1e-3)


def test_files_are_not_overwritten_unasked(hinge: SolidHinge) -> None:
    with pytest.raises(InvalidFile, match="housing"):
        build_hinge(hinge.folder, hinge.design)


def test_factors_are_for_parts_that_exist(hinge: SolidHinge, tmp_path: Path) -> None:
    with pytest.raises(InvalidParameter, match="housing, reducer, hub"):
        hinge.with_compliance({"hubb": 2.0}, tmp_path)
    with pytest.raises(InvalidParameter, match="positive"):
        hinge.with_compliance({"hub": 0.0}, tmp_path)
