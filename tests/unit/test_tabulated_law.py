"""Tabulated laws as tables of a file: written as they are read, refused with what is allowed."""

import json

import numpy as np
import pytest
from arms import TUBE, arm, beam, fixed, hinge, paper_arm, rigid
from diagnoses import STIFFNESS, nominal, record

import flexarm
from flexarm.arm.parameter import parameters, with_value
from flexarm.cli.run import run as command
from flexarm.diagnosis.workflow import diagnose
from flexarm.effects import JointCompliance, TabulatedLaw, TransmissionError
from flexarm.errors import InvalidFile, InvalidParameter
from flexarm.tables import toml_text

TABLE = {
    "name": "tabulated_law",
    "at": "hinge",
    "quantity": "windup",
    "of": "torque",
    "x": [-400.0, 0.0, 400.0],
    "value": [2e-3, 0.0, -1e-3],
}
BENT = {"at": "rod", "quantity": "curvature", "of": "angle"}
LAW = TabulatedLaw(**{key: value for key, value in TABLE.items() if key != "name"})
SPRING = JointCompliance(at="hinge", stiffness=1e5, damping=100.0)


def written(tmp_path, **changes):
    """Path of a model's file with the table changed; None leaves a key out."""
    table = {key: value for key, value in {**TABLE, **changes}.items() if value is not None}
    plain = paper_arm(1).replace(effects=(SPRING,)).to_plain()
    plain["effects"].append(table)
    path = tmp_path / "arm.toml"
    path.write_text(toml_text(plain), encoding="utf-8")
    return path


def test_a_law_is_written_as_it_is_read(tmp_path):
    arm = flexarm.Arm.from_toml(written(tmp_path))
    assert arm.effect("tabulated_law", "hinge") == LAW
    arm.to_toml(tmp_path / "again.toml")
    assert flexarm.Arm.from_toml(tmp_path / "again.toml") == arm
    assert LAW.to_plain() == TABLE


def test_arrays_become_lists():
    law = TabulatedLaw(at="hinge", quantity="torque", of="angle", x=np.arange(3.0), value=np.zeros(3))
    assert law.x == (0.0, 1.0, 2.0) and law.value == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("changes", "where", "what"),
    [
        ({"x": [0.0, 0.0, 1.0]}, "x", "must rise from knot to knot, got 0 after 0"),
        ({"x": [0.0, 2.0, 1.0]}, "x", "must rise from knot to knot, got 1 after 2"),
        ({"value": [0.0, 1e-3]}, "value", "must have as many numbers as x, 3, got 2"),
        ({"x": [1.0], "value": [1.0]}, "x", "must be two knots or more, got 1"),
        ({"value": [0.0, float("nan"), 1e-3]}, r"value\[1\]", "must be a finite number, got nan"),
        ({"x": [0.0, float("inf"), 1e-3]}, r"x\[1\]", "must be a finite number, got inf"),
        ({"value": 1e-3}, "value", "must be a list"),
        ({"value": None}, "value", "is missing; needed is values at the knots"),
        ({"quantity": "wind-up"}, "quantity", "must be 'windup', 'torque', 'curvature' or 'force'"),
        ({"of": "time"}, "of", "must be 'angle', 'rate', 'torque' or 'motor_angle', got 'time'"),
        ({"quantity": "torque"}, "of", "must be 'angle' or 'rate' or 'motor_angle' of a torque at 'hinge'"),
        ({"quantity": "curvature"}, "of", "must be 'angle' or 'rate' or 'motor_angle' of a curvature"),
        (
            {"quantity": "curvature", "of": "angle", "direction": "x"},
            "quantity",
            "must be 'windup' or 'torque' at 'hinge', got 'curvature'",
        ),
        (BENT, "direction", "is missing: a curvature at 'rod' has one, 'x' or 'y' or 'z'"),
        ({**BENT, "direction": "w"}, "direction", "must be 'x', 'y' or 'z', got 'w'"),
        ({**BENT, "direction": "z"}, "direction", "must be 'x' or 'y', across the beam 'rod', got 'z'"),
        ({**BENT, "quantity": "force", "direction": "z"}, "quantity", "must be 'curvature' at 'rod', got"),
        ({**BENT, "at": "load"}, "direction", "is missing"),
        ({**BENT, "at": "load", "direction": "x"}, "quantity", "must be 'force' at 'load'"),
        ({"at": "base"}, "of", "of a windup at 'base', got 'torque'"),
        ({"at": "base", "of": "rate"}, "of", "must be 'angle' or 'motor_angle' of a windup at 'base', got"),
        ({"at": "base", "of": "angle"}, "direction", "is missing: a windup at 'base'"),
        ({"at": "base", "of": "angle", "quantity": "torque"}, "quantity", "must be 'windup' at 'base'"),
        ({"direction": "x"}, "direction", "must be left out at a joint"),
        ({"at": "nowhere"}, "at", "there is no joint, link, payload or base 'nowhere'; there are hinge, rod"),
        ({"knots": []}, "knots", "unknown key; allowed are at, quantity, of, x, value, direction"),
        ({"value": [-2e-3, 0.0, 6e-3]}, "value", "must not rise with the torque by 1/stiffness = 1e-05"),
        (
            {"of": "motor_angle", "x": [0.0, 1e-3, 2e-3]},
            "value",
            "must change by less than 1 rad per rad of the motor's angle",
        ),
    ],
)
def test_what_is_wrong_is_named_with_its_place_and_what_is_allowed(tmp_path, changes, where, what):
    with pytest.raises(InvalidFile, match=what) as error:
        flexarm.Arm.from_toml(written(tmp_path, **changes))
    assert any(where.replace("\\", "") in problem.where for problem in error.value.problems)


def test_a_ripple_and_a_windup_of_the_motor_that_turn_the_output_back_together_are_refused():
    law = LAW.replace(of="motor_angle", x=(0.0, 1e-3), value=(0.0, 6e-4))
    wave = TransmissionError(at="hinge", amplitude=0.5, multiple=1.0)
    with pytest.raises(InvalidParameter, match="would turn the output back"):
        flexarm.static(paper_arm(1).replace(effects=(law, wave)), {"hinge": 0.1})


def test_values_are_parameters_with_numbers_and_the_units_of_their_quantity():
    assert LAW.parameters() == [("value.0", 2e-3, "rad"), ("value.1", 0.0, "rad"), ("value.2", -1e-3, "rad")]
    assert LAW.with_parameters({"value.1": 1e-4}).value == (2e-3, 1e-4, -1e-3)
    assert LAW.value_of("value.2") == -1e-3
    with pytest.raises(InvalidParameter, match=r"has no parameter 'value\.3'"):
        LAW.with_parameters({"value.3": 0.0})
    arm = paper_arm(1).replace(effects=(SPRING, LAW))
    found = parameters(arm, ["effects.tabulated_law.hinge.value"])
    assert [each.key for each in found] == [f"effects.tabulated_law.hinge.value.{k}" for k in range(3)]
    assert {each.unit for each in found} == {"rad"}
    changed = with_value(arm, "effects.tabulated_law.hinge.value.2", -4e-3)
    assert changed.effect("tabulated_law", "hinge").value == (2e-3, 0.0, -4e-3)
    for wrong in ("value.3", "value.x"):
        with pytest.raises(InvalidParameter, match=r"value (has 3 components|)"):
            parameters(arm, [f"effects.tabulated_law.hinge.{wrong}"])


def test_a_rigid_link_has_no_curvature_and_an_arm_without_joints_no_state():
    keys = {"of": "angle", "x": (0.0, 1.0), "value": (0.0, 1.0), "direction": "x"}
    bent = TabulatedLaw(at="rod", quantity="curvature", **keys)
    stiff = arm(joints=[hinge("hinge", "rod")], links=[rigid("rod", 1.0)])
    with pytest.raises(InvalidParameter, match="'rod' is a rigid link; only a beam has a curvature"):
        stiff.with_effect(bent)
    still = arm(joints=[fixed("bolt", "rod")], links=[beam("rod", [0, 0, 1.0], TUBE)])
    with pytest.raises(InvalidParameter, match="needs a joint that moves"):
        still.with_effect(bent)


def test_values_have_the_unit_of_their_quantity():
    for at, quantity, unit in (
        ("rod", "curvature", "1/m"),
        ("load", "force", "N"),
        ("base", "windup", "rad"),
    ):
        law = LAW.replace(at=at, quantity=quantity, of="angle", direction="x")
        assert {each[2] for each in law.parameters()} == {unit}
        assert {each.unit for each in law.priors(paper_arm(1)).values()} == {unit}


def test_a_law_at_a_slide_has_the_units_of_the_slide():
    arm = paper_arm(1)
    slide = arm.joints[0].replace(type="prismatic", axis=(0.0, 0.0, 1.0))
    arm = arm.replace(joints=(slide,), effects=(LAW,))
    assert parameters(arm, ["effects.tabulated_law.hinge.value.0"])[0].unit == "m"


def test_a_model_with_a_law_is_viewed_linearised_and_checked(tmp_path, capsys):
    path = written(tmp_path)
    assert command(["check", str(path)]) == 0
    assert command(["view", str(path), "--out", str(tmp_path / "arm.html")]) == 0
    assert command(["linearise", str(path), "--joint", "hinge=0.5", "--out", str(tmp_path / "arm.nc")]) == 0
    capsys.readouterr()
    assert command(["modes", str(path), "--joint", "hinge=0.5", "--json"]) == 0
    frequencies = json.loads(capsys.readouterr().out)["frequency_hz"]
    stiff = flexarm.modes(paper_arm(1).replace(effects=(SPRING,)), {"hinge": 0.5}, count=1).frequency_hz[0]
    assert 0.5 * stiff < frequencies[0] < 0.99 * stiff


def test_a_search_does_not_propose_tables():
    assert not TabulatedLaw.competes


@pytest.mark.slow
def test_a_model_with_the_right_table_explains_a_record_of_a_soft_hinge():
    """The rigid hinge stays behind by T over the stiffness of the hinge that was measured."""
    knots = (-900.0, -100.0, 100.0, 900.0)
    law = LAW.replace(x=knots, value=tuple(-torque / STIFFNESS for torque in knots))
    found = diagnose(nominal().with_effect(law), [record(1)], n_jobs=1, step=1e-2)
    assert found.verdict == "adequate" and not found.effects
