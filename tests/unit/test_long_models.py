"""Chains of many joints: work that grows with their number, and messages that can still be read."""

import pytest

from flexarm import Arm
from flexarm.arm import consistency
from flexarm.arm.weight import first_turning_joint, weight_statement
from flexarm.errors import InvalidFile
from flexarm.tables import place


def chain(n, axis=(0, 0, 1)):
    """Tables of n rigid links, each 0.1 m behind the one before it."""
    joints = [
        {
            "name": f"j{i}",
            "type": "revolute",
            "parent": f"l{i - 1}" if i else "base",
            "child": f"l{i}",
            "origin": {"xyz": [0.1, 0.0, 0.0]},
            "axis": list(axis),
        }
        for i in range(n)
    ]
    links = [{"name": f"l{i}", "type": "rigid", "mass": 1.0, "com": [0.05, 0.0, 0.0]} for i in range(n)]
    return {"format": "flexarm-arm/1", "name": "chain", "joints": joints, "links": links}


def toml(model):
    lines = [f'format = "{model["format"]}"']
    for table in ("joints", "links"):
        for entry in model[table]:
            lines.append(f"[[{table}]]")
            for key, value in entry.items():
                lines.append(
                    f"{key} = {{ xyz = {value['xyz']} }}" if key == "origin" else f"{key} = {value!r}"
                )
    return "\n".join(lines) + "\n"


def test_joints_may_stand_in_any_order():
    """m = n kg, and the centre of n links of 0.1 m, each 0.1 m on, lies at (n/2 + 1/2) 0.1 + 0.05 m."""
    n = 40
    model = chain(n)
    for joints in (model["joints"], model["joints"][::-1], model["joints"][1::2] + model["joints"][::2]):
        arm = Arm.from_dict({**model, "joints": joints})
        whole = weight_statement(arm).whole
        assert whole.mass == pytest.approx(n)
        assert whole.centre == pytest.approx((0.1 * (n + 1) / 2 + 0.05, 0, 0))
        assert first_turning_joint(arm).name == "j0"


def test_walks_to_the_base_grow_with_the_number_of_joints(monkeypatch):
    def walked(n):
        walks = []
        link_of = consistency.link_of
        monkeypatch.setattr(consistency, "link_of", lambda name: walks.append(name) or link_of(name))
        Arm.from_dict(chain(n))
        monkeypatch.setattr(consistency, "link_of", link_of)
        return len(walks)

    assert walked(400) < 2.2 * walked(200)


def test_each_link_that_hangs_on_a_loop_is_named():
    model = chain(4)
    model["joints"][0]["parent"] = "l1"
    with pytest.raises(ValueError, match="hangs on itself") as caught:
        Arm.from_dict(model)
    assert [problem.where for problem in caught.value.problems] == [f"links.l{i}" for i in range(4)]


def test_each_of_many_wrong_joints_is_named_with_its_line(tmp_path):
    text = toml(chain(200, axis=(0, 0, 0)))
    (tmp_path / "arm.toml").write_text(text)
    place._layout.cache_clear()
    with pytest.raises(InvalidFile) as caught:
        Arm.from_toml(tmp_path / "arm.toml")
    lines = text.splitlines()
    wrong = [i + 1 for i, line in enumerate(lines) if line == "axis = [0, 0, 0]"]
    assert [problem.line for problem in caught.value.problems] == wrong
    assert place._layout.cache_info().misses == 1  # the text is looked through once


def test_of_many_known_names_a_message_lists_the_first():
    model = chain(200)
    model["joints"][7]["parent"] = "nothing"
    with pytest.raises(ValueError, match="l49 and 150 more"):
        Arm.from_dict(model)
