"""Bearings that tilt, bases that give about two axes: closed forms, and the same arm with joints spelt out.

A mass m on a light rod of length L across a vertical axis sags by theta, k theta = m g L cos(theta). About
that it swings with omega^2 = (k + m g L sin(theta))/(m L^2).
"""

from pathlib import Path

import numpy as np
import pytest
from arms import TUBE, G, arm, beam, compliance, hinge, point, rigid, smooth_step
from part_arms import tube_part
from scipy.optimize import brentq

import flexarm
from flexarm import Drive, InvalidParameter, modes, simulate, static
from flexarm.effects import BaseCompliance, ExternalVibration, JointTiltCompliance
from flexarm.measurement.deformation import deflection
from flexarm.measurement.sampling import CannotMeasure

MASS, LEVER, STIFFNESS = 20.0, 1.5, 4e3


def carousel(**more: object) -> flexarm.Arm:
    """A mass at (L, 0, 0) on a rod that turns about z."""
    tables = {
        "gravity": [0, 0, -G],
        "joints": [hinge("turn", "rod", axis=[0, 0, 1])],
        "links": [rigid("rod", MASS, com=(LEVER, 0, 0))],
        "points": [point("tip", "rod", [LEVER, 0, 0])],
    }
    return arm(**{**tables, **more})


def two_links(forearm: dict | None = None, **more: object) -> flexarm.Arm:
    """A column that turns about z with a boom that leans about y and carries a load beside its axis."""
    tables = {
        "gravity": [0, 0, -G],
        "joints": [
            hinge("turn", "column", axis=[0, 0, 1], origin={"xyz": [0.1, 0, 0.2], "rpy": [0, 0, 0.4]}),
            hinge("lean", "boom", "column", at="end"),
        ],
        "links": [
            beam("column", [0, 0, 1.0], TUBE, elements=2),
            forearm or beam("boom", [0.9, 0, 0.3], TUBE, elements=2, damping_ratio=0.01),
        ],
        "payloads": [{"name": "load", "link": "boom", "position": [0.9, 0.2, 0.3], "mass": 9.0}],
        "points": [point("tip", "boom", [0.9, 0, 0.3])],
    }
    return arm(**{**tables, **more})


def spelt_out(model: flexarm.Arm, joint: str, axes: list, stiffness: tuple, damping: tuple) -> flexarm.Arm:
    """The same arm with two more joints before one, each with a compliance of its own; behind the model's."""
    tables = model.to_dict()
    own = next(each for each in tables["joints"] if each["name"] == joint)
    before = {key: own[key] for key in ("parent", "at", "origin") if key in own}
    for key in ("at", "origin"):
        own.pop(key, None)
    for k, axis in enumerate(axes):
        tables["links"].append(rigid(f"ring{k}", 0.0))
        tables["joints"].append({**hinge(f"give{k}", f"ring{k}"), **before, "axis": list(axis)})
        tables.setdefault("effects", []).append(compliance(f"give{k}", stiffness[k], damping[k]))
        before = {"parent": f"ring{k}"}
    own["parent"] = f"ring{len(axes) - 1}"
    return flexarm.Arm.from_dict(tables)


def sag(stiffness: float) -> float:
    """The angle of the closed form [rad]."""
    return brentq(lambda x: stiffness * x - MASS * G * LEVER * np.cos(x), 0, 1.5)


@pytest.mark.parametrize("turned", [0.0, 0.7, 2.5])
@pytest.mark.parametrize(
    "effect",
    [
        JointTiltCompliance(at="turn", stiffness=STIFFNESS),
        BaseCompliance(at="base", stiffness=(STIFFNESS,) * 2),
    ],
    ids=lambda effect: effect.name,
)
def test_a_heavy_load_sags_and_swings_as_the_closed_form_says(
    turned: float, effect: flexarm.effects.Effect
) -> None:
    """Alike about both axes, it matters to second order in theta where the arm is turned to."""
    model = carousel().with_effect(effect)
    theta = sag(STIFFNESS)
    tip = static(model, {"turn": turned}).position[0]
    assert theta > 0.07
    within = theta**2 / 3 if turned else 1e-9
    assert tip[2] == pytest.approx(-LEVER * np.sin(theta), rel=within)
    assert np.hypot(tip[0], tip[1]) == pytest.approx(LEVER * np.cos(theta), rel=within)
    omega = np.sqrt((STIFFNESS + MASS * G * LEVER * np.sin(theta)) / (MASS * LEVER**2))
    found = modes(model, {"turn": turned}).frequency_hz
    assert np.min(np.abs(found / (omega / 2 / np.pi) - 1)) < (theta if turned else 1e-7)


def test_two_stiffnesses_count_about_the_axes_of_the_joint_s_frame() -> None:
    """Across z the first axis is x, the second y: a load along x bends the second, one along y the first."""
    soft = JointTiltCompliance(at="turn", stiffness=(1e12, STIFFNESS))
    for effect in (soft, BaseCompliance(at="base", stiffness=(1e12, STIFFNESS))):
        model = carousel().with_effect(effect)
        assert static(model, {"turn": 0.0}).position[0, 2] == pytest.approx(-LEVER * np.sin(sag(STIFFNESS)))
        assert static(model, {"turn": np.pi / 2}).position[0, 2] == pytest.approx(0.0, abs=1e-9)
    turned = carousel(joints=[hinge("turn", "rod", axis=[0, 0, 1], origin={"rpy": [0, 0, np.pi / 2]})])
    model = turned.with_effect(soft)  # the frame is fixed to the parent, and turned with it
    assert static(model, {"turn": 0.0}).position[0, 2] == pytest.approx(-LEVER * np.sin(sag(STIFFNESS)))
    assert static(model, {"turn": np.pi / 2}).position[0, 2] == pytest.approx(0.0, abs=1e-9)


AXES = {"turn": [[1, 0, 0], [0, 1, 0]], "lean": [[1, 0, 0], [0, 0, -1]]}
"""Across z: x and y; across y: x and y times x."""
SPRINGS, DAMPERS = (3e4, 5e4), (60.0, 40.0)
FOREARMS = {
    "beam": None,
    "rigid": rigid("boom", 6.0, com=(0.4, 0.05, 0.1), inertia=(0.1, 0.5, 0.5)),
}
DRIVE = np.linspace(0, 0.6, 31)


def moves() -> Drive:
    """Both joints from rest, and with a stop that rings."""
    s = smooth_step(DRIVE / 0.4)
    return Drive.from_samples(DRIVE, {"turn": 0.3 * s, "lean": -0.4 * s})


@pytest.mark.parametrize("forearm", FOREARMS)
@pytest.mark.parametrize("joint", AXES)
def test_a_tilting_joint_is_the_arm_with_two_more_joints(joint: str, forearm: str) -> None:
    """Statics to rounding, modes and a run to Newton's tolerance."""
    plain = two_links(FOREARMS[forearm])
    tilting = plain.with_effect(JointTiltCompliance(at=joint, stiffness=SPRINGS, damping=DAMPERS))
    separate = spelt_out(plain, joint, AXES[joint], SPRINGS, DAMPERS)
    q = {"turn": 0.6, "lean": 0.4}
    ours, theirs = static(tilting, q), static(separate, q)
    assert ours.position == pytest.approx(theirs.position, abs=1e-9)
    assert np.abs(ours.position - static(plain, q).position).max() > 1e-5
    assert ours.joint_torque == pytest.approx(theirs.joint_torque[:2], abs=1e-6)
    assert ours.base_wrench == pytest.approx(theirs.base_wrench, abs=1e-6)
    found, wanted = modes(tilting, q, count=4), modes(separate, q, count=4)
    assert found.frequency_hz == pytest.approx(wanted.frequency_hz, rel=1e-7)
    assert found.damping_ratio == pytest.approx(wanted.damping_ratio, rel=1e-5)
    run, reference = (simulate(each, moves(), rotations=True) for each in (tilting, separate))
    assert run.position == pytest.approx(reference.position, abs=1e-8)
    assert run.joint_torque == pytest.approx(reference.joint_torque[:, :2], abs=1e-3)
    assert run.joints == ("turn", "lean")
    assert np.abs(run.position - simulate(plain, moves()).position).max() > 1e-4


def test_a_base_on_two_springs_is_the_arm_with_two_more_joints() -> None:
    """Under a base that is tilted, the axes are those of the tilted base."""
    plain = two_links(
        joints=[hinge("turn", "column", axis=[0, 0, 1]), hinge("lean", "boom", "column", at="end")]
    )
    soft = plain.with_effect(BaseCompliance(at="base", stiffness=SPRINGS, damping=DAMPERS))
    separate = spelt_out(plain, "turn", [[1, 0, 0], [0, 1, 0]], SPRINGS, DAMPERS)
    q = {"turn": 0.6, "lean": 0.4}
    assert static(soft, q).position == pytest.approx(static(separate, q).position, abs=1e-9)
    assert modes(soft, q, count=3).frequency_hz == pytest.approx(modes(separate, q, count=3).frequency_hz)
    run, reference = (simulate(each, moves()) for each in (soft, separate))
    assert run.position == pytest.approx(reference.position, abs=1e-8)


def test_a_tilting_joint_carries_a_super_element_as_two_more_joints_do(tmp_path: Path) -> None:
    tube_part(length=1.2).save(tmp_path / "tube.nc")
    part = {"name": "boom", "type": "superelement", "file": str(tmp_path / "tube.nc")}
    plain = two_links(
        part,
        joints=[
            hinge("turn", "column", axis=[0, 0, 1]),
            hinge("lean", "boom:start", "column", at="end", origin={"rpy": [0, 1.2, 0]}),
        ],
        payloads=[{"name": "load", "link": "boom:end", "position": [0, 0.2, 0.1], "mass": 9.0}],
        points=[point("tip", "boom:end", [0, 0, 0])],
    )
    tilting = plain.with_effect(JointTiltCompliance(at="lean", stiffness=SPRINGS, damping=DAMPERS))
    separate = spelt_out(plain, "lean", AXES["lean"], SPRINGS, DAMPERS)
    q = {"turn": 0.6, "lean": 0.4}
    assert static(tilting, q).position == pytest.approx(static(separate, q).position, abs=1e-9)
    assert modes(tilting, q, count=3).frequency_hz == pytest.approx(modes(separate, q, count=3).frequency_hz)
    run, reference = (simulate(each, moves()) for each in (tilting, separate))
    assert run.position == pytest.approx(reference.position, abs=1e-8)


def test_a_planar_arm_with_a_tilting_joint_moves_as_without_it_and_in_space() -> None:
    planar = arm(
        gravity=[0, 0, -G],
        joints=[hinge("hinge", "rod")],
        links=[beam("rod", [0, 0, 2.0], TUBE, elements=2)],
        points=[point("tip", "rod", [0, 0, 2.0])],
    )
    drive = Drive.from_samples(DRIVE, {"hinge": 0.5 * smooth_step(DRIVE / 0.4)})
    tilting = planar.with_effect(JointTiltCompliance(at="hinge", stiffness=1e4))
    run, plain = simulate(tilting, drive), simulate(planar, drive)
    assert (run.solver["dimension"], plain.solver["dimension"]) == (3, 2)
    assert run.position == pytest.approx(plain.position, abs=1e-8)
    with pytest.raises(InvalidParameter, match="the mount of a joint moves out of the plane"):
        simulate(tilting, drive, dimension="plane")
    assert min(modes(tilting, {"hinge": 0.5}).frequency_hz) < min(modes(planar, {"hinge": 0.5}).frequency_hz)


def test_a_base_on_two_springs_needs_no_turning_joint_and_one_about_its_axis_does() -> None:
    slide = {"name": "slide", "type": "prismatic", "parent": "base", "child": "rod", "axis": [1, 0, 0]}
    model = carousel(joints=[slide])
    soft = model.with_effect(BaseCompliance(at="base", stiffness=(STIFFNESS,) * 2))
    assert static(soft).position[0, 2] == pytest.approx(-LEVER * np.sin(sag(STIFFNESS)))
    with pytest.raises(InvalidParameter, match="needs no joint"):
        model.with_effect(BaseCompliance(at="base", stiffness=STIFFNESS))


def test_a_prismatic_joint_tilts_in_newton_metres() -> None:
    slide = {"name": "slide", "type": "prismatic", "parent": "base", "child": "rod", "axis": [0, 0, 1]}
    model = carousel(joints=[slide]).with_effect(JointTiltCompliance(at="slide", stiffness=STIFFNESS))
    assert static(model).position[0, 2] == pytest.approx(-LEVER * np.sin(sag(STIFFNESS)))
    parameter = flexarm.arm.parameter.parameters(model, ["effects.joint_tilt_compliance.slide.stiffness"])[0]
    assert parameter.unit == "N m/rad"


def test_derivatives_of_a_run_are_differences_of_runs() -> None:
    keys = ["effects.joint_tilt_compliance.lean.stiffness", "effects.joint_tilt_compliance.lean.damping"]
    keys += ["effects.base_compliance.base.stiffness.x", "effects.base_compliance.base.stiffness.y"]
    model = two_links().with_effect(JointTiltCompliance(at="lean", stiffness=4e4, damping=50.0))
    model = model.with_effect(BaseCompliance(at="base", stiffness=(8e4, 3e5), damping=100.0))
    run = simulate(model, moves(), sensitivities=keys)
    for key in keys:
        value = flexarm.arm.parameter.parameters(model, [key])[0].value
        up, down = (
            simulate(flexarm.arm.parameter.with_value(model, key, value * (1 + h)), moves()).position
            for h in (1e-3, -1e-3)
        )
        difference = (up - down) / (2e-3 * value)
        found = run.sensitivities.by(key)["position"]
        assert found == pytest.approx(difference, abs=2e-4 * np.abs(difference).max())
        assert np.abs(difference).max() * value > 1e-6


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(InvalidParameter, match="stiffness: must be one number or two"):
        JointTiltCompliance(at="turn", stiffness=(1.0, 2.0, 3.0))
    with pytest.raises(InvalidParameter, match=r"stiffness: must be positive, got -1 N m/rad"):
        JointTiltCompliance(at="turn", stiffness=(1.0, -1.0))
    with pytest.raises(InvalidParameter, match="damping: has two numbers and the stiffness one"):
        JointTiltCompliance(at="turn", stiffness=1.0, damping=(1.0, 2.0))
    soft = carousel().with_effect(BaseCompliance(at="base", stiffness=(1e5, 1e5)))
    with pytest.raises(InvalidParameter, match="does not turn; give it one"):
        soft.with_effect(ExternalVibration(at="base", amplitude=1.0, frequency=2.0))


def test_a_shaken_base_on_two_springs_swings_about_the_part_of_the_axis_in_its_plane() -> None:
    """About y alone, a base on two springs is one on one."""
    model = arm(
        gravity=[0, 0, -G],
        joints=[hinge("hinge", "rod")],
        links=[rigid("rod", 10.0, com=(0, 0, 1.0))],
        points=[point("tip", "rod", [0, 0, 1.0])],
    )
    shaken = {"amplitude": 30.0, "frequency": 3.0, "phase": 0.4}
    drive = Drive.from_samples(DRIVE, {"hinge": 0.2 * smooth_step(DRIVE / 0.4)})
    runs = [
        simulate(
            model.replace(
                effects=(
                    BaseCompliance(at="base", stiffness=k, damping=50.0),
                    ExternalVibration(at="base", **shaken),
                )
            ),
            drive,
        )
        for k in (1e4, (2e4, 1e4))
    ]
    assert runs[0].position == pytest.approx(runs[1].position, abs=1e-8)
    assert np.ptp(runs[0].position[:, 0, 0]) > 1e-3
    assert runs[1].work[-1] == pytest.approx(runs[0].work[-1], abs=1e-6)


def test_a_deflection_beyond_a_tilting_joint_is_refused() -> None:
    model = carousel(
        links=[beam("rod", [LEVER, 0, 0], TUBE)],
        sensors=[
            {
                "name": "bend",
                "quantity": "deflection",
                "point": "tip",
                "axes": ["z"],
                "rate_hz": 10,
            }
        ],
    ).with_effect(JointTiltCompliance(at="turn", stiffness=1e5))
    run = simulate(model, Drive.from_samples(DRIVE, {"turn": 0.2 * smooth_step(DRIVE / 0.4)}))
    with pytest.raises(CannotMeasure, match=r"beyond the soft bearing of 'turn'"):
        deflection(run, model.sensors[0], run.time[:3])
