"""One formulation against the other: the arms of the blind tests as rods and as flexarm's elements."""

from dataclasses import replace

import numpy as np
import pytest
from arms import drive
from chain import Base
from joint_motions import Sines
from lab_arms import HINGED, LAB_ARMS, PLANAR, SPATIAL, LabArm
from robot import Robot
from robot_motion import move

import flexarm
from flexarm.effects import effect_class

END = 8.0
MIDDLES = {"hinge": 0.3, "waist": 0.1, "shoulder": 0.2, "elbow": 0.6}


def angles(arm: LabArm) -> dict[str, Sines]:
    """A lively motion of all joints, other phases for each."""
    return {
        joint.name: Sines(
            [0.4, 0.15, 0.05, 0.01], [0.1, 0.3, 0.6, 1.1], [k, 2 * k, 1.0, k + 2], MIDDLES[joint.name]
        )
        for k, joint in enumerate(arm.joints)
    }


def differences(arm: LabArm, robot: Robot, model: flexarm.Arm) -> tuple[float, float]:
    """Largest distance of any reflector [m], rms of all joints' torques [N m]."""
    motions = angles(arm)
    gaps = any(turn.hub.gap for turn in robot.turns)
    run = move(robot, motions, END, 2.5e-3 if gaps else 5e-3)
    driven = drive({name: lambda t, f=f: f(t)[0] for name, f in motions.items()}, END, 2001)
    elements = flexarm.simulate(model, driven, step=1e-3)
    every = run.time[::40]
    furthest = max(
        np.linalg.norm(elements.at(every, name) - run.place(r.link, r.fraction, r.offset)[::40], axis=1).max()
        for name, r in arm.reflectors.items()
    )
    torque = np.stack([np.interp(run.time, elements.time, row) for row in elements.motor_torque.T], -1)
    return furthest, np.sqrt(np.mean((torque - run.motor_torque) ** 2))


@pytest.mark.parametrize("stiff", [False, True], ids=["soft joints", "rigid joints"])
@pytest.mark.parametrize("arm", LAB_ARMS.values(), ids=list(LAB_ARMS))
def test_nominal_arms_agree(arm, stiff):
    """Every reflector within 2e-5 m, the noise of a good tracker; torques within 0.05 N m rms of hundreds.

    The tip of one tube of 2.8 m that bends by 10 cm differs by 1e-5 m, those of several tubes by 2e-6 m.
    """
    rigid = [joint.name for joint in arm.joints] if stiff else []
    robot = arm.robot
    for name in rigid:
        robot = robot.with_hub(name, stiffness=np.inf)
    furthest, torque = differences(arm, robot, arm.model(rigid))
    assert furthest < 2e-5
    assert torque < 0.05


P, S, H = PLANAR.robot, SPATIAL.robot, HINGED.robot
EFFECTS = {
    "elbow gap": (PLANAR, P.with_hub("elbow", gap=6e-4), [("backlash", "elbow", {"gap": 6e-4})]),
    "elbow hysteresis": (
        PLANAR,
        P.with_hub("elbow", hysteresis=15.0, hysteresis_width=3e-4),
        [("joint_hysteresis", "elbow", {"torque": 15.0, "width": 3e-4})],
    ),
    "shoulder friction": (
        SPATIAL,
        S.with_hub("shoulder", coulomb=20.0, viscous=40.0),
        [
            ("coulomb_friction", "shoulder", {"torque": 20.0}),
            ("viscous_friction", "shoulder", {"coefficient": 40.0}),
        ],
    ),
    "waist gap": (SPATIAL, S.with_hub("waist", gap=5e-4), [("backlash", "waist", {"gap": 5e-4})]),
    "waist teeth": (
        SPATIAL,
        S.with_hub("waist", error_amplitude=2e-4, error_multiple=0.1, error_phase=0.5),
        [("transmission_error", "waist", {"amplitude": 2e-4, "multiple": 0.1, "phase": 0.5})],
    ),
    "elbow stiffening": (
        SPATIAL,
        S.with_hub("elbow", cubic=5e9),
        [("joint_stiffening", "elbow", {"cubic_stiffness": 5e9})],
    ),
    "bowed forearm": (
        SPATIAL,
        S.with_link("forearm", bow=(3e-3, 2e-3), bow_time=3.0),
        [("link_bow", "forearm", {"tip_offset": [3e-3, 2e-3, 0.0], "time_constant": 3.0})],
    ),
    "longer upper arm": (
        PLANAR,
        P.with_link("upper_arm", length=2.203),
        [("link_length", "upper_arm", {"error": 3e-3})],
    ),
    "heavier tube": (
        PLANAR,
        P.with_link("forearm", rho_A=1.1 * PLANAR.tubes["forearm"].rods.rho_A),
        [("link_mass", "forearm", {"scale": 1.1})],
    ),
    "softer tube": (
        SPATIAL,
        S.with_link("upper_arm", EI=0.9 * SPATIAL.tubes["upper_arm"].rods.EI),
        [("link_stiffness", "upper_arm", {"scale": 0.9})],
    ),
    "damped tube": (
        PLANAR,
        P.with_link("upper_arm", damping_ratio=0.06),
        [("link_damping", "upper_arm", {"damping_ratio": 0.06})],
    ),
    "load beside": (
        SPATIAL,
        S.with_load("forearm", offset=(0.03, 0.05 - 0.02, 0.04)),
        [("payload_offset", "load", {"offset": [0.03, -0.02, 0.04]})],
    ),
    "load with inertia": (
        HINGED,
        H.with_load("rod", inertia=0.8),
        [("payload_inertia", "load", {"inertia": 0.8})],
    ),
    "tilted base": (
        SPATIAL,
        replace(S, tilt=(2e-3, -3e-3)),
        [("base_tilt", "base", {"angle": [2e-3, -3e-3]})],
    ),
    "soft base": (
        SPATIAL,
        replace(S, base=Base(6e5, 600.0)),
        [("base_compliance", "base", {"stiffness": 6e5, "damping": 600.0})],
    ),
    "soft base in the plane": (
        PLANAR,
        replace(P, base=Base(6e5, 600.0)),
        [("base_compliance", "base", {"stiffness": 6e5, "damping": 600.0})],
    ),
    "cable": (
        PLANAR,
        P.with_hub("elbow", cable=30.0, cable_rest=0.2),
        [("cable_torque", "elbow", {"stiffness": 30.0, "rest_angle": 0.2})],
    ),
    "ratio": (SPATIAL, S.with_hub("elbow", ratio_scale=1.001), [("gear_ratio", "elbow", {"scale": 1.001})]),
}


@pytest.mark.parametrize("effect", EFFECTS)
def test_hidden_effects_are_flexarms_effects(effect):
    """The same law on both sides, at any joint or link: reflectors within 2e-5 m."""
    arm, robot, effects = EFFECTS[effect]
    model = arm.model()
    for name, at, values in effects:
        model = model.with_effect(effect_class(name)(at=at, **values))
    assert differences(arm, robot, model)[0] < 2e-5
