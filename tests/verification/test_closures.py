"""Closed loops: kinematics, forces and frequencies against closed forms; bad loops are refused in words."""

from __future__ import annotations

import json
from math import atan2, cos, hypot, pi, sin, sqrt

import loops
import numpy as np
import pytest
from pytest import approx

import flexarm
from flexarm.cli.run import run
from flexarm.effects import BaseTilt, JointCompliance, LinkLength
from flexarm.errors import InvalidParameter

G = 9.81


def boom_angle(stroke: float) -> float:
    """Angle of the crane's boom, from the triangle of boom pin, cylinder pin and rod eye."""
    eye, pins, rod = hypot(1.2, 0.15), hypot(0.3, 0.8), 0.9 + stroke
    between = np.arccos((eye**2 + pins**2 - rod**2) / (2 * eye * pins))
    return float(between - pi / 2 + atan2(0.3, 0.8) + atan2(0.15, 1.2))


def crane_energy(stroke: float) -> float:
    """Potential energy of the rigid crane [J]."""
    q = boom_angle(stroke)
    eye = np.array([1.2 * cos(q) + 0.15 * sin(q), 1 + 1.2 * sin(q) - 0.15 * cos(q)])
    up = (eye[1] - 0.2) / (0.9 + stroke)  # cosine of the cylinder's lean
    return G * ((200 * 1.5 + 500 * 3) * sin(q) + up * (25 * 0.35 + 12 * (stroke + 0.5)))


def slope(f, x: float, h: float = 1e-3) -> float:
    return (8 * (f(x + h) - f(x - h)) - (f(x + 2 * h) - f(x - 2 * h))) / (12 * h)


@pytest.mark.parametrize("stroke", [0.1, 0.4, 0.7])
def test_the_cylinder_of_a_crane_holds_it_by_virtual_work(stroke):
    """F ds = dV; the force in the rod eye is that of the cylinder less the weight of the rod."""
    found = flexarm.static(loops.crane(), {"piston": stroke})
    force = slope(crane_energy, stroke)
    assert found.joint_torque[2] == approx(force, rel=1e-9)
    assert found.link_angle[0] == approx(boom_angle(stroke), abs=1e-10)
    assert found.base_wrench[2] == approx(-G * 737, rel=1e-12)
    told = found.to_json_dict()["closures"]["rod_eye"]
    lean = 0.2 + 0.9 + stroke, boom_angle(stroke)
    q = lean[1]
    along = np.array([1.2 * cos(q) + 0.15 * sin(q) - 0.3, 0, 0.8 + 1.2 * sin(q) - 0.15 * cos(q)])
    along /= np.linalg.norm(along)
    assert np.array(told["force"]) @ along == approx(force - 12 * G * along[2], rel=1e-9)
    assert np.allclose(told["moment"], 0, atol=1e-6)


def test_a_flat_loop_of_rigid_links_in_space_repeats_three_conditions():
    """Position across the plane and two rotations hold by the joints; their forces stay zero."""
    found = flexarm.static(loops.crane(), {"piston": 0.4})
    assert found.solver["redundant_conditions"] == 3
    assert found.closure_force[0][[1, 3, 5]] == approx(0, abs=1e-6)
    assert found.solver["indeterminate_forces"] == ("rod_eye force y, rod_eye moment x, rod_eye moment z")
    assert "repeat others" in found.summary()
    assert "rod_eye moment x" in found.summary()
    flexible = flexarm.static(loops.crane(loops.beam("boom", 3.0, side=0.1)), {"piston": 0.4})
    assert flexible.solver["redundant_conditions"] == 0
    assert flexible.solver["indeterminate_forces"] == ""


@pytest.mark.parametrize("kind", ["revolute", "spherical", "universal", "cylindrical", "point_on_line"])
def test_the_same_crane_is_closed_by_other_joints(kind):
    """A flat loop moves alike where its last joint leaves more free, as long as that holds the eye."""
    arm = loops.crane()
    closure = arm.closures[0].to_plain()
    closure["type"] = kind
    if kind == "spherical":
        del closure["axis"]
    found = flexarm.static(flexarm.Arm.from_dict({**arm.to_dict(), "closures": [closure]}), {"piston": 0.4})
    assert found.position[0] == approx(flexarm.static(arm, {"piston": 0.4}).position[0], abs=1e-10)


def parallelogram(pin: tuple[float, float], **more) -> flexarm.Arm:
    """Two cranks of 1 m and a hand; the upper crank's pin is beside the lower's."""
    x, z = pin
    return flexarm.Arm.from_dict(
        {
            "links": [
                loops.bar("lower", 1.0, 4.0),
                loops.bar("upper", 1.0, 3.0),
                loops.bar("hand", 0.5, 2.0),
            ],
            "joints": [
                loops.hinge("shoulder", "base", "lower"),
                loops.hinge("guide", "base", "upper", (x, 0, z)),
                loops.hinge("wrist", "lower", "hand", (1, 0, 0)),
            ],
            "closures": [loops.pin("eye", "upper", (1, 0, 0), "hand", (x, 0, z))],
            "points": [{"name": "tip", "link": "hand", "position": [0.5, 0, 0]}],
            **more,
        }
    )


@pytest.mark.parametrize("angle", [-0.7, 0.0, 0.4, 1.3])
def test_a_parallelogram_keeps_its_hand_level(angle):
    """Two cranks of one length: the hand moves on a circle and does not turn."""
    arm = parallelogram((0.05, 0.3))
    found = flexarm.static(arm, {"shoulder": angle})
    assert found.position[0] == approx([cos(angle) + 0.5, 0, sin(angle)], abs=1e-12)
    assert found.rotation[0] == approx(np.eye(3), abs=1e-12)
    torque = G * cos(angle) * (4 / 2 + 3 / 2 + 2)  # whole weights at their lever arms
    assert found.joint_torque[0] == approx(torque, rel=1e-9)


def test_a_flat_parallelogram_keeps_its_branch_and_refuses_the_pose_in_line():
    """With all bars in line the loop could go on as an antiparallelogram; its forces are not determined."""
    bent = {"shoulder": 0.5, "guide": 0.5, "wrist": -0.5}
    for more in ({}, {"assembly": bent}):
        arm = parallelogram((0.5, 0.0), **more)
        for angle in (0.6, -1.0):
            found = flexarm.static(arm, {"shoulder": angle})
            assert found.link_angle == approx([angle, angle, -angle], abs=1e-9)
        with pytest.raises(InvalidParameter, match="singular at this pose"):
            flexarm.static(arm, {"shoulder": 0.0})


def test_two_props_of_a_rigid_bar_share_its_weight_by_their_levers():
    """Of all forces with a F_1 + b F_2 = M the smallest are M a/(a^2 + b^2) and M b/(a^2 + b^2)."""
    props = [loops.pin(f"prop{x}", "base", (x, 0, 0), "bar", (x, 0, 0), "spherical") for x in (1.0, 2.0)]
    for i, prop in enumerate(props):
        prop["name"] = f"prop_{i}"
    hinged = {"links": [loops.bar("bar", 2.0, 10.0)], "closures": props}
    arm = flexarm.Arm.from_dict({**hinged, "joints": [loops.hinge("wall", "base", "bar")]})
    found = flexarm.static(arm)
    assert found.closure_force[:, 2] == approx([10 * G / 5, 10 * G * 2 / 5], rel=1e-12)
    assert found.solver["redundant_conditions"] == 5
    assert "prop_0 force z" in found.solver["indeterminate_forces"]
    wall = {"name": "wall", "type": "fixed", "parent": "base", "child": "bar"}
    held = flexarm.static(flexarm.Arm.from_dict({**hinged, "joints": [wall]}))
    assert held.closure_force == approx(np.zeros((2, 6)))
    assert held.solver["redundant_conditions"] == 6


def test_a_slider_crank_slides_as_the_textbook_says():
    """x = r cos q + sqrt(l^2 - r^2 sin^2 q), and the torque for a push F on the slider by virtual work."""
    r, rod, push = 0.3, 0.8, 50.0
    arm = flexarm.Arm.from_dict(
        {
            "gravity": [0, 0, 0],
            "links": [loops.bar("crank", r, 1), loops.bar("rod", rod, 1), loops.bar("slider", 0.1, 1)],
            "joints": [
                loops.hinge("crank", "base", "crank"),
                loops.hinge("big_end", "crank", "rod", (r, 0, 0)),
                {**loops.hinge("slide", "base", "slider"), "type": "prismatic", "axis": [1, 0, 0]},
            ],
            "closures": [loops.pin("small_end", "rod", (rod, 0, 0), "slider", (0, 0, 0))],
            "points": [{"name": "slider", "link": "slider", "position": [0, 0, 0]}],
            "assembly": {"slide": 1.0},
        }
    )

    def x(q: float) -> float:
        return r * cos(q) + sqrt(rod**2 - (r * sin(q)) ** 2)

    for q in (0.2, 1.0, 2.5, 4.0, -1.0):
        found = flexarm.static(arm, {"crank": q}, {"slider": [-push, 0, 0]})
        assert found.position[0] == approx([x(q), 0, 0], abs=1e-11)
        assert found.joint_torque[0] == approx(push * slope(x, q), rel=1e-9)


def test_a_bar_clamped_at_both_ends_bends_and_vibrates_as_one():
    """A load P in the middle: w = P l^3/(192 EI), ends P/2 and P l/8; w1 = 4.7300^2 sqrt(EI/(rho A l^4))."""
    side, length, load = 0.02, 2.0, 10.0
    EI, mass = 210e9 * side**4 / 12, 7850 * side**2
    bar = {**loops.beam("bar", length, 16, side), "theory": "euler-bernoulli"}
    arm = flexarm.Arm.from_dict(
        {
            "gravity": [0, 0, 0],
            "links": [bar],
            "joints": [{"name": "wall", "type": "fixed", "parent": "base", "child": "bar"}],
            "closures": [
                {"name": "end", "type": "fixed", "a": "base", "a_origin": {"xyz": [length, 0, 0]}}
                | {"b": "bar", "b_at": "end"}
            ],
            "points": [{"name": "middle", "link": "bar", "position": [length / 2, 0, 0]}],
        }
    )
    found = flexarm.static(arm, forces={"middle": [0, 0, -load]})
    # Being held at both ends it stretches too, which stiffens it by about (w/h)^2 = 6e-5.
    assert found.displacement[0, 2] == approx(-load * length**3 / (192 * EI), rel=1e-4)
    assert found.closure_force[0][[2, 4]] == approx([load / 2, load * length / 8], rel=1e-4)
    first = 4.730041**2 * sqrt(EI / (mass * length**4)) / (2 * pi)
    assert flexarm.modes(arm, count=1).frequency_hz[0] == approx(first, rel=1e-5)


@pytest.mark.parametrize("make", [loops.bar, lambda name, length, mass: loops.beam(name, length, 2)])
def test_a_loop_cut_at_another_pin_is_the_same(make):
    """Where the tree ends is bookkeeping: torque, places, frequencies and forces in the pins stay."""
    angle = 0.9
    found = {}
    for cut in "BCD":
        arm = loops.four_bar(cut, make, assembly=loops.assembled(cut, angle))
        stiff = arm.with_effect(JointCompliance(at="A", stiffness=2e3))
        found[cut] = (
            flexarm.static(arm, {"A": angle}).joint_torque[0],
            flexarm.static(arm, {"A": angle}).position,
            flexarm.static(arm, {"A": angle}).base_wrench[[0, 2, 4]],
            flexarm.modes(stiff, {"A": angle}, count=1).frequency_hz,
        )
    for cut in "BC":
        for one, other in zip(found[cut], found["D"], strict=True):
            assert one == approx(other, rel=1e-8, abs=1e-8)


def test_a_four_bar_finds_its_pose_from_anywhere():
    """Without [assembly] some pose is found in which all bars meet."""
    for cut in "BCD":
        found = flexarm.static(loops.four_bar(cut), {"A": 1.0})
        ends = np.linalg.norm(found.position[1] - found.position[2])
        assert ends < 2 * loops.COUPLER
        assert found.solver["redundant_conditions"] == 3


def test_stated_values_that_contradict_one_another_are_closed_near_them():
    """A boom that stands 0.02 rad from where the piston puts it: both move a little."""
    stroke, angle = 0.4, boom_angle(0.4) + 0.02
    arm = loops.crane().replace(assembly={"piston": stroke, "boom_pin": angle})
    stands = flexarm.static(arm).link_angle[0]
    assert boom_angle(stroke) < stands < angle


def test_a_loop_that_does_not_reach_says_by_how_much():
    """Pins 2.1 m apart, bars of 1.9 m."""
    arm = loops.four_bar("C")
    joints = [joint.to_plain() for joint in arm.joints]
    joints[2]["origin"]["xyz"] = [2.5, 0, 0]
    with pytest.raises(InvalidParameter, match=r"closure 'C' cannot be closed: 0.2 m apart at the nearest"):
        flexarm.static(flexarm.Arm.from_dict({**arm.to_dict(), "joints": joints}))
    with pytest.raises(InvalidParameter, match=r"'rod_eye' cannot be closed with piston = 2: .* m apart"):
        flexarm.static(loops.crane(), {"piston": 2.0})


def test_more_drives_than_the_loop_has_freedoms_are_refused():
    """A crane has one freedom."""
    with pytest.raises(InvalidParameter, match=r"driven joints \(boom_pin, piston\)"):
        flexarm.static(loops.crane(), {"piston": 0.4, "boom_pin": boom_angle(0.4)})
    with pytest.raises(InvalidParameter, match=r"apart at the nearest; 2 joints .* given where 1 suffices"):
        flexarm.static(loops.crane(), {"piston": 0.4, "boom_pin": boom_angle(0.4) + 0.1})


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"a": "boom"}, "closures.rod_eye.b: is on 'boom' as a is"),
        ({"a": "nothing"}, "there is no link 'nothing'"),
        ({"type": "hinge"}, "closures.rod_eye.type"),
        ({"axis": [0, 0, 0]}, "must not be zero"),
        ({"a_at": "end"}, '"end" needs a beam'),
        ({"second_axis": [0, 0, 1]}, "belongs to universal closures"),
        ({"a": "rod:eye"}, "must be LINK"),
        ({"stiffness": 1.0}, "stiffness"),
    ],
)
def test_a_wrong_table_is_named(change, said):
    """Every mistake names its place."""
    arm = loops.crane()
    with pytest.raises(InvalidParameter) as raised:
        flexarm.Arm.from_dict({**arm.to_dict(), "closures": [{**arm.closures[0].to_plain(), **change}]})
    assert said in str(raised.value)


def test_assembly_names_joints_of_a_model_with_closures():
    """A pose of a joint that does not exist, or of a tree, is refused."""
    with pytest.raises(InvalidParameter, match="moving joint 'knee'"):
        flexarm.Arm.from_dict({**loops.crane().to_dict(), "assembly": {"knee": 1.0}})
    tree = {**loops.crane().to_dict(), "closures": [], "assembly": {"piston": 0.1}}
    with pytest.raises(InvalidParameter, match="the model has no closures"):
        flexarm.Arm.from_dict(tree)


@pytest.mark.parametrize(("farthest", "goes_on"), [(0.6, True), (1.13, False)])
def test_a_plan_of_a_crane_moves_the_piston_where_that_reaches_and_no_joint_that_follows(farthest, goes_on):
    """The bars are in line at a stroke of 1.163 m."""
    time = np.linspace(0, 1, 21)
    lift = flexarm.Drive.from_samples(time, {"piston": farthest - 0.2 * (1 - time) ** 2})
    told = str(flexarm.plan(loops.crane(), {"lift": lift}, step=0.02))
    assert ("with piston moved by 0.05 m throughout" in told) == goes_on
    assert "pin moved by" not in told
    assert "joint radial compliance at rod_eye" in told


def test_modes_tell_where_the_joints_that_follow_stand():
    """At the angles of the equilibrium."""
    found = flexarm.modes(loops.crane(loops.beam("boom", 3.0)), {"piston": 0.4}, count=1)
    at_rest = flexarm.static(loops.crane(loops.beam("boom", 3.0)), {"piston": 0.4})
    assert found.drive_angle == approx(at_rest.drive_angle, abs=1e-12)


def test_a_stored_equilibrium_keeps_its_closures(tmp_path):
    """Save and load."""
    found = flexarm.static(loops.crane(), {"piston": 0.4})
    found.save(tmp_path / "crane.nc")
    again = flexarm.Statics.load(tmp_path / "crane.nc")
    assert np.array_equal(again.closure_force, found.closure_force)
    assert again.arm == found.arm
    assert again.to_json_dict()["closures"] == found.to_json_dict()["closures"]


def test_a_model_with_closures_is_written_and_read(tmp_path):
    """The file gives an equal arm."""
    arm = loops.four_bar("C", assembly=loops.assembled("C", 0.9))
    arm.to_toml(tmp_path / "four_bar.toml")
    assert flexarm.Arm.from_toml(tmp_path / "four_bar.toml") == arm


def test_a_longer_beam_takes_its_closure_along():
    """The eye keeps its fraction of the boom's length, as payloads do."""
    boom = loops.beam("boom", 3.0, side=0.2)
    longer = flexarm.static(loops.crane(boom).with_effect(LinkLength(at="boom", error=0.3)), {"piston": 0.4})
    other = loops.crane(loops.beam("boom", 3.3, side=0.2)).to_dict()
    other["closures"][0]["b_origin"]["xyz"][0] *= 1.1
    for table in ("payloads", "points"):
        other[table][0]["position"][0] *= 1.1
    made = flexarm.static(flexarm.Arm.from_dict(other), {"piston": 0.4})
    assert longer.position[0] == approx(made.position[0], abs=1e-10)
    assert longer.joint_torque == approx(made.joint_torque, rel=1e-9, abs=1e-6)


def test_a_loop_through_a_gear_follows_its_shaft():
    """A crank geared to a motor's shaft stands at a third of its angle, whichever of the two is told."""
    arm = loops.four_bar("C", assembly=loops.assembled("C", 0.9)).to_dict()
    arm["links"].append(loops.bar("shaft", 0.1, 0.0) | {"com": [0, 0, 0], "inertia": [0, 0, 0]})
    arm["joints"].append(loops.hinge("shaft", "base", "shaft"))
    arm["gears"] = [{"name": "reducer", "input": "shaft", "output": "A", "ratio": 3.0}]
    arm["assembly"]["shaft"] = 2.7
    geared = flexarm.Arm.from_dict(arm)
    direct = flexarm.static(loops.four_bar("C", assembly=loops.assembled("C", 0.9)), {"A": 1.1})
    for told in ({"shaft": 3.3}, {"A": 1.1}):
        found = flexarm.static(geared, told)
        assert found.position == approx(direct.position, abs=1e-10)
        assert found.joint_torque[0] == approx(direct.joint_torque[0], rel=1e-8)


def test_a_tilted_base_carries_the_loop_along():
    """Closures to the base tilt with it: nothing changes but gravity's direction."""
    tilt = 0.2
    arm = loops.four_bar("D", assembly=loops.assembled("D", 0.9))
    tilted = flexarm.static(arm.with_effect(BaseTilt(at="base", angle=[0, tilt])), {"A": 0.9})
    turned = arm.replace(gravity=(G * sin(tilt), 0.0, -G * cos(tilt)))
    assert tilted.joint_torque == approx(flexarm.static(turned, {"A": 0.9}).joint_torque, rel=1e-9, abs=1e-9)


def test_check_tells_where_loops_close(capsys, tmp_path):
    """Pose, repeated conditions, weight there, and an error with exit code 2 where a loop stays open."""
    model = tmp_path / "crane.toml"
    loops.crane().to_toml(model)
    assert run(["check", str(model), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["loops"]["redundant_conditions"] == 3
    stroke = told["loops"]["assembled"]["piston"]
    assert told["loops"]["assembled"]["boom_pin"] == approx(boom_angle(stroke), abs=1e-9)
    pins = 700 * 1.0 + 37 * 0.2  # boom and load hang on the boom's pin, the cylinder on its own
    whole = told["weight"]["whole"]
    assert G * (whole["mass"] * whole["centre"][2] - pins) == approx(crane_energy(stroke), rel=1e-9)
    arm = loops.crane().to_dict()
    arm["closures"][0]["b_origin"]["xyz"][1] = 0.02
    flexarm.Arm.from_dict(arm).to_toml(model)
    assert run(["check", str(model)]) == 2
    assert "cannot be closed: 0.02 m apart at the nearest" in capsys.readouterr().err


def test_a_page_shows_the_closed_loop(tmp_path):
    """The model and its equilibrium."""
    arm = loops.crane()
    arm.view().save(tmp_path / "crane.html")
    flexarm.static(arm, {"piston": 0.4}).view().save(tmp_path / "static.html")
    assert "rod_eye" in (tmp_path / "crane.html").read_text(encoding="utf-8")


def test_pages_of_modes_and_runs_show_the_closed_loop(tmp_path):
    """Also of stored ones, whether the piston is driven or the boom."""
    arm = loops.crane(loops.beam("boom", 3.0))

    def page(name: str, result) -> str:
        result.save(tmp_path / f"{name}.nc")
        again = type(result).load(tmp_path / f"{name}.nc")
        assert again.solver["driven"] == result.solver["driven"]
        again.view().save(tmp_path / f"{name}.html")
        return (tmp_path / f"{name}.html").read_text(encoding="utf-8")

    for driven, at in (("piston", 0.4), ("boom_pin", boom_angle(0.4))):
        found = flexarm.modes(arm, {driven: at}, count=2)
        assert found.solver["driven"] == driven
        assert f"{found.frequency_hz[0]:.4g} Hz" in page(f"modes-{driven}", found)
        run = flexarm.simulate(arm, flexarm.Drive.from_samples([0, 0.1, 0.2], {driven: [at, at, at]}))
        shown = page(f"run-{driven}", run)
        assert "rod_eye" in shown
        assert "made again" not in shown


def test_derivatives_of_modes_hold_the_joint_that_was_driven():
    """Central differences by the modulus, the boom held at its pin instead of the piston."""
    key, at = "links.boom.material.youngs_modulus", {"boom_pin": boom_angle(0.4)}

    def frequency(modulus: float) -> float:
        boom = loops.beam("boom", 3.0)
        boom["material"] = {**boom["material"], "youngs_modulus": modulus}
        return float(flexarm.modes(loops.crane(boom), at, count=1).frequency_hz[0])

    found = flexarm.modes(loops.crane(loops.beam("boom", 3.0)), at, count=1, sensitivities=[key])
    expected = (frequency(211e9) - frequency(209e9)) / 2e9
    assert found.sensitivities.by(key)["frequency"][0] == approx(expected, rel=1e-4)
