"""Claims about the way from the model to the core."""

import numpy as np
import pytest
from arms import arm, beam, general, hinge, paper_arm, point, rigid

import flexarm
from flexarm import InvalidParameter, _core
from flexarm.arm import Rectangle
from flexarm.assembly import assemble, joint_values, point_loads


def test_system_has_the_mass_of_the_model():
    """rho A L + M; the weight statement of `check` counts the same."""
    assert assemble(paper_arm(3)).mass == pytest.approx(7850 * 5.82e-4 * 3 + 14.1, rel=1e-12)


@pytest.mark.parametrize(
    ("section", "made"),
    [
        ({"shape": "tube", "outer_diameter": 0.06, "thickness": 0.003}, _core.tube_section(0.06, 0.003)),
        ({"shape": "round", "diameter": 0.02}, _core.round_section(0.02)),
        ({"shape": "rectangle", "width": 0.02, "height": 0.05}, _core.rectangle_section(0.02, 0.05)),
    ],
)
def test_model_and_core_agree_about_sections(section, made):
    """Areas and second moments are written down twice, for the weight statement and for the elements."""
    link = paper_arm(1, section=section, up=[1, 0, 0]).links[0]
    assert link.section.area == pytest.approx(made.area, rel=1e-12)
    assert link.section.second_moments == pytest.approx(
        (made.second_moment_y, made.second_moment_z), rel=1e-12
    )


def test_shear_factors():
    """A_s/A: 0.53 of a tube, 0.886 of a round, 5/6 of a rectangle."""
    for made, factor in (
        (_core.tube_section(0.06, 0.003), 0.53),
        (_core.round_section(0.02), 0.886),
        (_core.rectangle_section(0.02, 0.05), 5 / 6),
    ):
        assert made.shear_area_y == pytest.approx(factor * made.area)
        assert made.shear_area_z == pytest.approx(factor * made.area)


def test_a_hollow_rectangle_is_the_outer_one_without_the_inner_one():
    box, outer, inner = (
        Rectangle(**each)
        for each in (
            {"width": 0.08, "height": 0.12, "thickness": 0.005},
            {"width": 0.08, "height": 0.12},
            {"width": 0.07, "height": 0.11},
        )
    )
    assert box.area == pytest.approx(outer.area - inner.area)
    assert box.second_moments == pytest.approx(np.subtract(outer.second_moments, inner.second_moments))


def test_a_thin_square_tube_has_cowpers_shear_factor_and_bredts_torsion():
    """20/48 at a Poisson ratio of 0 [Cowper1966], and J = t b^3 [Bredt]."""
    wall, b = 1e-5, 0.1
    square = Rectangle(width=b + wall, height=b + wall, thickness=wall)
    torsion, shear = square.hollow(wall)
    assert torsion == pytest.approx(wall * b**3, rel=1e-7)
    assert shear == pytest.approx((20 / 48 * square.area,) * 2, rel=1e-3)


@pytest.mark.parametrize(("height", "factor"), [(0.1, 0.1406), (0.2, 0.2287), (0.3, 0.2633)])
def test_a_tube_that_is_nearly_solid_twists_as_a_solid_bar(height, factor):
    """J = factor w^3 h of Saint-Venant; Bredt's formula alone is 55 to 34 % below."""
    wall = 0.0499
    torsion, _ = Rectangle(width=0.1, height=height, thickness=wall).hollow(wall)
    assert torsion == pytest.approx(factor * 0.1**3 * height, rel=0.05)


def test_a_hollow_bar_sags_by_bending_and_by_the_energy_of_its_shear_flow():
    """P L^3/(3 E I) + P L/(G A_z), the flow q = P S/I summed up along the middle of the wall."""
    w, h, t, L, E, nu, P = 0.04, 0.09, 0.002, 0.3, 70e9, 0.33, 50.0
    a, b, n = h - t, w - t, 20001
    s, y = np.linspace(0, b / 2, n), np.linspace(-a / 2, a / 2, n)
    second = t * a**3 / 6 + t * b * a**2 / 2
    flange, web = t * a / 2 * s, t * a * b / 4 + t * (a**2 / 4 - y**2) / 2
    energy = 4 * np.trapezoid(flange**2 / t, s) + 2 * np.trapezoid(web**2 / t, y)
    section = {"shape": "rectangle", "width": w, "height": h, "thickness": t}
    material = {"youngs_modulus": E, "poisson_ratio": nu, "density": 1e-6}
    rod = beam("rod", [L, 0, 0], section, up=[0, 0, 1], theory="timoshenko", material=material)
    load = {"name": "load", "link": "rod", "position": [L, 0, 0], "mass": P / 9.81}
    held = arm(
        joints=[hinge("hinge", "rod")], links=[rod], payloads=[load], points=[point("tip", "rod", [L, 0, 0])]
    )
    I_y, G = Rectangle(**section).second_moments[0], E / (2 + 2 * nu)
    wanted = P * L**3 / (3 * E * I_y) + P * L / (G * second**2 / energy)
    assert -flexarm.static(held).displacement[0, 2] == pytest.approx(wanted, rel=1e-4)


@pytest.mark.parametrize("wall", [0.02, 0.03, 1e-9])
def test_a_wall_that_leaves_no_hole_is_refused(wall):
    with pytest.raises(InvalidParameter, match=r"thickness: must be less than half of 0.04 m, and at least"):
        Rectangle(width=0.04, height=0.09, thickness=wall)


def test_joint_values_stand_in_the_models_order():
    two = arm(
        joints=[
            hinge("a", "one"),
            {"name": "w", "type": "fixed", "parent": "one", "child": "two"},
            hinge("b", "three", "two"),
        ],
        links=[rigid(name, 1.0) for name in ("one", "two", "three")],
    )
    assert joint_values(two, {"b": 0.4}) == [0.0, 0.0, 0.4]


def test_outputs_of_gears_follow_their_inputs():
    geared = arm(
        joints=[hinge("shaft", "motor"), hinge("hinge", "lever")],
        gears=[{"name": "g", "input": "shaft", "output": "hinge", "ratio": 4.0}],
        links=[rigid("motor", 1.0), rigid("lever", 1.0)],
    )
    assert joint_values(geared, {"shaft": 2.0}) == [2.0, 0.5]


def test_a_fixed_joint_takes_no_value():
    welded = arm(
        joints=[{"name": "weld", "type": "fixed", "parent": "base", "child": "rod"}],
        links=[beam("rod", [0, 0, 1], general(1e-4, 1e-8))],
    )
    with pytest.raises(InvalidParameter, match="no moving joint 'weld'; there are none"):
        joint_values(welded, {"weld": 0.0})


def test_point_loads_name_their_point():
    (load,) = point_loads(paper_arm(1), {"tip": np.array([1.0, 2.0, 3.0])})
    assert isinstance(load, _core.PointLoad)
