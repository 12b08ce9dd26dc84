"""Claims about the way from the model to the core."""

import numpy as np
import pytest
from arms import arm, beam, general, hinge, paper_arm, rigid

from flexarm import InvalidParameter, _core
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
