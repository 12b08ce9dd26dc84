"""Keys that name no number to differentiate by are refused with the reason."""

import pytest
from tests.helpers.arms import beam, hinge, point

import flexarm

ARM = flexarm.Arm.from_dict(
    {
        "joints": [hinge("hinge", "rod")],
        "links": [beam("rod", [0, 0, 1.0], {"shape": "round", "diameter": 0.05})],
        "payloads": [{"name": "load", "link": "rod", "position": [0, 0, 1.0], "mass": 3.0}],
        "points": [point("tip", "rod", [0, 0, 1.0])],
        "effects": [{"name": "joint_compliance", "at": "hinge"}],
    }
)
REFUSED = {
    "effects.joint_compliance.hinge.stiffness": "was left out and is infinite",
    "links.rod.elements": "elements = 4 is not a real number",
    "payloads.load.mass.x": "payloads.load.mass has no components",
    "points.tip.position.xy": "position has 3 components",
}


@pytest.mark.parametrize("key", REFUSED)
def test_a_key_without_a_derivative_is_refused_with_the_reason(key: str) -> None:
    with pytest.raises(flexarm.InvalidParameter) as caught:
        flexarm.static(ARM, {"hinge": 0.5}, sensitivities=[key])
    assert key in str(caught.value)
    assert REFUSED[key] in str(caught.value)
