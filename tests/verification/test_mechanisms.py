"""Prismatic joints, gears, payloads with offset and inertia, branches: against formulas."""

import numpy as np
import pytest
from arms import G, arm, beam, compliance, drive, fixed, general, hinge, point, rigid, smooth_step
from rigid_chain import Body, RigidChain

import flexarm

STEP = 2e-3


def slide(t):
    return 0.3 * np.sin(3 * t) * smooth_step(t / 2)


def turn(t):
    return 0.6 * np.sin(2 * t) * smooth_step(t / 2)


def test_prismatic_drive_gives_force():
    """A mass on a vertical slide: F = m (g + x''), in statics and in motion; x is in metres."""
    lift = arm(
        joints=[{"name": "lift", "type": "prismatic", "parent": "base", "child": "car", "axis": [0, 0, 2]}],
        links=[rigid("car", 3.0)],
        points=[point("floor", "car", [0.1, 0, 0])],
    )
    held = flexarm.static(lift, {"lift": 0.4})
    assert held.joint_torque == pytest.approx([3.0 * G], abs=1e-9)
    assert held.position == pytest.approx(np.array([[0.1, 0, 0.4]]), abs=1e-12)
    run = flexarm.simulate(lift, drive({"lift": slide}, 2.0), step=STEP)
    t = run.time[10:-10]
    x_ddot = np.gradient(np.gradient(slide(np.linspace(0, 2, 20001)), 1e-4), 1e-4)
    expected = 3.0 * (G + np.interp(t, np.linspace(0, 2, 20001), x_ddot))
    assert run.joint_torque[10:-10, 0] == pytest.approx(expected, abs=1e-3)
    assert run.position[:, 0, 2] == pytest.approx(slide(run.time), abs=1e-9)


def test_sliding_on_a_turning_arm_feels_coriolis_and_centrifugal_forces():
    """A prismatic joint carried by a revolute one, against Newton's and Euler's equations, to order h^2."""
    chain = RigidChain(
        [
            Body((0, 1, 0), (0, 0, 0.2), 2.0, (0.3, 0, 0.1), (0.1, 0.2, 0.15)),
            Body((1, 0, 0.5), (0.4, 0.1, 0), 1.5, (0.1, 0.05, 0.2), (0.02, 0.03, 0.01), prismatic=True),
        ]
    )
    model = arm(**chain.tables())
    coarse, fine = (
        flexarm.simulate(
            model, drive({"joint0": turn, "joint1": slide}, 2.0), step=h, alpha=-0.3, forces=True
        )
        for h in (8e-3, 4e-3)
    )
    dense = np.linspace(0, 2, 20001)
    rates = [np.gradient(f(dense), 1e-4) for f in (turn, slide)]
    for t in (0.8, 1.2, 1.6):
        i, k = int(np.rint(t / 8e-3)), int(np.rint(t / 1e-4))
        q, v = [f(t) for f in (turn, slide)], [rate[k] for rate in rates]
        a = [(rate[k + 10] - rate[k - 10]) / 2e-3 for rate in rates]
        torque, wrench = chain.inverse_dynamics(q, v, a)
        found = (4 * fine.joint_torque[2 * i] - coarse.joint_torque[i]) / 3
        base = (4 * fine.base_wrench[2 * i] - coarse.base_wrench[i]) / 3
        assert found == pytest.approx(torque, abs=1e-4 * np.abs(wrench).max())
        assert base == pytest.approx(wrench, abs=1e-4 * np.abs(wrench).max())


RATIO, ROTOR = 60.0, 4e-4
LOAD = {"mass": 2.0, "com": [0, 0, 0.5], "inertia": [0.1, 0.1, 0.05]}


def with_gear_ratio() -> flexarm.Arm:
    """A lever behind a reducer, as one joint."""
    return arm(
        joints=[hinge("hinge", "lever", gear_ratio=RATIO, rotor_inertia=ROTOR)],
        links=[rigid("lever", **LOAD)],
        points=[point("tip", "lever", [0, 0, 1])],
    )


def with_gears() -> flexarm.Arm:
    """The same with the motor's shaft as a link of its own."""
    return arm(
        joints=[hinge("shaft", "motor"), hinge("hinge", "lever")],
        gears=[{"name": "reducer", "input": "shaft", "output": "hinge", "ratio": RATIO}],
        links=[rigid("motor", 0.1, inertia=[ROTOR, ROTOR, ROTOR]), rigid("lever", **LOAD)],
        points=[point("tip", "lever", [0, 0, 1])],
    )


def test_gears_equal_a_gear_ratio():
    """Same motion of the tip; the motor's torque on its shaft is the output-referred one over the ratio."""
    one = flexarm.simulate(with_gear_ratio(), drive({"hinge": turn}, 2.0), step=STEP)
    other = flexarm.simulate(with_gears(), drive({"shaft": lambda t: RATIO * turn(t)}, 2.0), step=STEP)
    assert other.position == pytest.approx(one.position, abs=1e-8)
    late = slice(100, -50)
    scale = np.abs(one.motor_torque).max()
    found = RATIO * other.motor_torque[late, 0]
    assert found == pytest.approx(one.motor_torque[late, 0], abs=1e-3 * scale)


def test_gears_in_statics():
    """Shaft at 30 rad turns the lever by 30/60, and the lever's joint carries its weight."""
    held = flexarm.static(with_gears(), {"shaft": 30.0})
    assert held.link_angle == pytest.approx([30.0, 0.5], abs=1e-12)
    expected = -2.0 * G * 0.5 * np.sin(0.5)
    assert held.joint_torque[1] == pytest.approx(expected, abs=1e-9)


def test_payload_beside_the_axis_bends_and_twists():
    """Weight P at d beside the tip of a horizontal beam: torsion P d, sag as at the tip, twist P d L/GJ.

    So small a load that nothing is nonlinear.
    """
    E, nu, L, d, mass = 210e9, 0.3, 1.0, 0.2, 1e-4
    second, torsion = 1e-8, 1.5e-8
    material = {"youngs_modulus": E, "poisson_ratio": nu, "density": 0.0}
    bar = arm(
        joints=[fixed("clamp", "bar")],
        links=[
            beam(
                "bar", [L, 0, 0], general(1e-4, second, torsion), up=[0, 0, 1], material=material, elements=2
            )
        ],
        payloads=[{"name": "load", "link": "bar", "position": [L, d, 0], "mass": mass}],
        points=[point("tip", "bar", [L, 0, 0]), point("load", "bar", [L, d, 0])],
    )
    found = flexarm.static(bar)
    sag, twist = mass * G * L**3 / (3 * E * second), mass * G * d * L * 2 * (1 + nu) / (E * torsion)
    assert found.displacement[0, 2] == pytest.approx(-sag, rel=1e-6)
    assert found.displacement[1, 2] == pytest.approx(-sag - d * twist, rel=1e-6)
    assert found.section_forces[0, 0] == pytest.approx(
        [0, 0, -mass * G, -mass * G * d, mass * G * L, 0], abs=1e-5 * mass * G
    )


def test_payload_inertia_lowers_the_torsional_frequency():
    """f = sqrt(GJ/(L I_x))/2 pi for a massless shaft with inertia I_x at its end."""
    material = {"youngs_modulus": 2e11, "poisson_ratio": 0.25, "density": 1e-9}
    shaft = arm(
        gravity=[0, 0, 0],
        joints=[fixed("clamp", "shaft")],
        links=[beam("shaft", [2.0, 0, 0], general(1e-3, 1e-4, 3e-9), material=material, elements=2)],
        payloads=[
            {"name": "disc", "link": "shaft", "position": [2, 0, 0], "mass": 1, "inertia": [0.4, 0.2, 0.2]}
        ],
    )
    expected = np.sqrt(8e10 * 3e-9 / (2.0 * 0.4)) / (2 * np.pi)
    assert flexarm.modes(shaft, count=1).frequency_hz == pytest.approx([expected], rel=1e-7)


def test_branches_carry_their_own_weight():
    """Two levers on one column: each joint holds its own lever, the base all of them."""
    tree = arm(
        joints=[
            fixed("foot", "column"),
            hinge("left", "lever", "column", at="end"),
            hinge("right", "other", "column", at="end", axis=[1, 0, 0]),
        ],
        links=[
            beam("column", [0, 0, 1.0], general(1e-2, 1e-5)),
            rigid("lever", 2.0, com=[0.3, 0, 0]),
            rigid("other", 3.0, com=[0, 0.4, 0]),
        ],
        effects=[compliance("left", 1e4)],
    )
    held = flexarm.static(tree, {"left": 0.0})
    assert held.base_wrench[2] == pytest.approx(-(5.0 + 78.5) * G, rel=1e-12)
    lean = held.link_angle[1]
    assert lean == pytest.approx(2.0 * G * 0.3 / 1e4, rel=2e-3)
    assert held.joint_torque[1] == pytest.approx(-2.0 * G * 0.3, rel=2e-3)
    assert held.joint_torque[2] == pytest.approx(3.0 * G * 0.4, rel=2e-3)


def test_static_reactions_are_the_weight_and_its_moment():
    """Force on the base: all weight, to 1e-8; moment: horizontal places times weights, of a stiff arm."""
    stiff = {"youngs_modulus": 2.1e17, "poisson_ratio": 0.3, "density": 7850.0}
    section = {"shape": "rectangle", "width": 0.03, "height": 0.05}
    boom = arm(
        joints=[hinge("hinge", "boom", origin={"xyz": [0.1, 0.2, 0.5]})],
        links=[beam("boom", [0, 0, 2.0], section, up=[1, 0, 0], material=stiff)],
        payloads=[{"name": "load", "link": "boom", "position": [0, 0.1, 1.5], "mass": 4.0}],
    )
    q, mass = 0.8, 7850.0 * 0.0015 * 2.0
    force = np.array([0, 0, -(mass + 4.0) * G])
    centres = [np.array([0.1 + np.sin(q), 0.2, 0]), np.array([0.1 + 1.5 * np.sin(q), 0.3, 0])]
    moment = sum(np.cross(r, [0, 0, -m * G]) for r, m in zip(centres, (mass, 4.0), strict=True))
    found = flexarm.static(boom, {"hinge": q})
    assert found.base_wrench[:3] == pytest.approx(force, abs=1e-8 * np.abs(force).max())
    assert found.base_wrench[3:] == pytest.approx(moment, abs=1e-6 * np.abs(moment).max())
