"""Friction, damping and springs of joints against closed forms."""

import dataclasses

import numpy as np
import pytest
from arms import TUBE, arm, beam, compliance, drive, hinge, point, rigid, smooth_step

import flexarm

INERTIA, SPRING = 2.0, 800.0  # of a balanced body about its axis [kg m2], of its joint [N m/rad]
OMEGA = np.sqrt(SPRING / INERTIA)


def rotor(*effects: dict, **joint) -> flexarm.Arm:
    """A body balanced on its vertical axis: no gravity torque, inertia INERTIA about the axis."""
    return arm(
        joints=[hinge("hinge", "body", **{"axis": [0, 0, 1], **joint})],
        links=[rigid("body", 5.0, inertia=[1.5, 1.5, INERTIA])],
        effects=list(effects),
    )


def pendulum(*effects: dict) -> flexarm.Arm:
    """A point mass of 2 kg, 0.5 m below a hinge about y."""
    return arm(
        joints=[hinge("hinge", "body")],
        links=[rigid("body", 2.0, com=[0, 0, -0.5])],
        points=[point("bob", "body", [0, 0, -0.5])],
        effects=list(effects),
    )


def plucked(model: flexarm.Arm, amplitude: float, end: float, step: float = 2e-3) -> flexarm.Simulation:
    """The motor turns within half a period of the spring and then stands; the body swings about it."""
    rise = np.pi / OMEGA
    turn = {"hinge": lambda t: amplitude * smooth_step(t / rise)}
    return flexarm.simulate(model, drive(turn, end, 8001), step=step)


def peaks(x: np.ndarray) -> np.ndarray:
    """Maxima of a sampled oscillation, parabola through three samples."""
    i = np.flatnonzero((x[1:-1] > x[:-2]) & (x[1:-1] >= x[2:])) + 1
    bend = x[i - 1] - 2 * x[i] + x[i + 1]
    return x[i] - (x[i + 1] - x[i - 1]) ** 2 / (8 * bend)


def test_viscous_friction_damps_by_its_ratio():
    """zeta = c/(2 sqrt(k J)): successive peaks fall by exp(-2 pi zeta/sqrt(1 - zeta^2))."""
    zeta = 0.02
    c = 2 * zeta * np.sqrt(SPRING * INERTIA)
    friction = {"name": "viscous_friction", "at": "hinge", "coefficient": c}
    run = plucked(rotor(compliance("hinge", SPRING), friction), 0.1, end=5.0)
    found = peaks(run.joint_angle[run.time > 0.5, 0] - 0.1)
    decrement = np.log(found[0] / found[-1]) / (len(found) - 1)
    assert decrement == pytest.approx(2 * np.pi * zeta / np.sqrt(1 - zeta**2), rel=5e-3)


def test_coulomb_friction_takes_4_t_over_k_a_period():
    """Peaks fall on a straight line, by 4 T_c/k a period; Dahl's width, 2e-5 rad, is 1e-3 of the swing."""
    torque = 0.4
    friction = {"name": "coulomb_friction", "at": "hinge", "torque": torque}
    run = plucked(rotor(compliance("hinge", SPRING), friction), 0.05, end=3.0, step=1e-3)
    found = peaks(run.joint_angle[run.time > 0.4, 0] - 0.05)[:5]
    assert -np.diff(found) == pytest.approx(np.full(4, 4 * torque / SPRING), rel=0.01)


def test_dry_friction_holds_until_the_spring_breaks_it_away():
    """The motor winds the spring up, phi = r t: stuck while k r t < T_c, then with t_0 = T_c/(k r)

        theta = r (t - t_0) - r/w sin w (t - t_0)

    The motor starts with a smooth step over 50 ms, so its ramp is late by 25 ms. Dahl's law creeps by its
    width, 2e-5 rad, before it gives way.
    """
    breakaway, rate = 4.0, 0.02
    friction = {"name": "coulomb_friction", "at": "hinge", "torque": breakaway}

    def wound(t):
        x = np.minimum(t / 0.05, 1.0)
        return rate * (0.05 * (2.5 * x**4 - 3 * x**5 + x**6) + np.maximum(t - 0.05, 0.0))

    winding = drive({"hinge": wound}, 0.5, 5001)
    run = flexarm.simulate(rotor(compliance("hinge", SPRING), friction), winding, step=1e-3)
    t_0 = breakaway / (SPRING * rate) + 0.025
    stuck = run.time < t_0 - 0.03
    assert stuck.sum() > 200
    assert np.abs(run.joint_angle[stuck]).max() < 1e-4
    t = np.maximum(run.time - t_0, 0.0)
    free = rate * t - rate / OMEGA * np.sin(OMEGA * t)
    assert free.max() > 3e-3
    assert run.joint_angle[:, 0] == pytest.approx(free, abs=2e-4)


def test_pendulum_decays_under_viscous_friction():
    """Small swings: theta'' + (c/J) theta' + (g/l) theta = 0, zeta = c/(2 m sqrt(g l^3)).

    Swings of 0.02 rad, whose period is 3e-5 longer; a pulse of torque sets it off.
    """
    c, mass, length, g = 0.05, 2.0, 0.5, 9.81
    friction = {"name": "viscous_friction", "at": "hinge", "coefficient": c}
    pulse = {"hinge": lambda t: 0.2 * smooth_step(t / 0.3) * smooth_step((0.9 - t) / 0.3)}
    run = flexarm.simulate(pendulum(friction), drive(pulse, 15.0, 7501, side="torque"), step=4e-3)
    free = run.time > 1.0
    found = peaks(run.joint_angle[free, 0])
    zeta = c / (2 * mass * np.sqrt(g * length**3))
    decrement = np.log(found[0] / found[-1]) / (len(found) - 1)
    assert len(found) >= 8
    assert decrement == pytest.approx(2 * np.pi * zeta / np.sqrt(1 - zeta**2), rel=5e-3)


def test_motor_friction_is_seen_only_in_the_motor():
    """With the motor's angle prescribed no motion changes; its torque grows by T_c sgn(phi') + c phi'."""
    turn = drive({"hinge": lambda t: 0.5 * np.sin(2 * t) * smooth_step(t)}, 4.0)
    coulomb, viscous = 1.5, 0.7
    plain = rotor(compliance("hinge", SPRING, 5.0), gear_ratio=100, rotor_inertia=1e-4)
    friction = {"name": "motor_friction", "at": "hinge", "coulomb": coulomb, "viscous": viscous}
    rubbing = flexarm.Arm.from_dict(plain.to_dict() | {"effects": [*plain.to_dict()["effects"], friction]})
    one, other = flexarm.simulate(plain, turn), flexarm.simulate(rubbing, turn)
    assert other.joint_angle == pytest.approx(one.joint_angle, abs=1e-13)
    assert other.joint_torque == pytest.approx(one.joint_torque, abs=1e-9)
    rate = one.drive_rate[:, 0]
    running = (np.abs(rate) > 0.3) & (one.time > 1.0)  # Dahl's law has saturated
    extra = (other.motor_torque - one.motor_torque)[running, 0]
    assert extra == pytest.approx((coulomb * np.sign(rate) + viscous * rate)[running], abs=1e-8)


def test_motor_torque_includes_the_rotor():
    """tau = N^2 J phi'' + T, phi'' of the drive, where the drive train is rigid or not."""
    inertia, ratio = 2e-4, 80.0
    turn = drive({"hinge": lambda t: 0.3 * np.sin(3 * t) * smooth_step(t)}, 3.0, 3001)
    for effects in ([], [compliance("hinge", SPRING, 5.0)]):
        run = flexarm.simulate(rotor(*effects, gear_ratio=ratio, rotor_inertia=inertia), turn, step=2e-3)
        late = (run.time > 1.5) & (run.time < 2.95)  # the drive's spline is least smooth at its ends
        phi_ddot = -0.3 * 9 * np.sin(3 * run.time[late])
        extra = (run.motor_torque - run.joint_torque)[late, 0]
        assert extra == pytest.approx(ratio**2 * inertia * phi_ddot, abs=1e-5 * ratio**2 * inertia * 2.7)


@pytest.mark.parametrize("zeta", [1e-3, 0.05, 0.6])
def test_joint_damping_ratio_in_modes(zeta):
    """Body on spring and damper: f = sqrt(k/J)/2 pi, zeta = c/(2 sqrt(k J)), f_d = f sqrt(1 - zeta^2)."""
    found = flexarm.modes(rotor(compliance("hinge", SPRING, 2 * zeta * np.sqrt(SPRING * INERTIA))), count=1)
    assert found.frequency_hz == pytest.approx([OMEGA / (2 * np.pi)], rel=1e-9)
    assert found.damping_ratio == pytest.approx([zeta], rel=1e-7)
    assert found.damped_frequency_hz == pytest.approx([OMEGA / (2 * np.pi) * np.sqrt(1 - zeta**2)], rel=1e-7)


def test_link_damping_ratio_is_that_of_the_clamped_link():
    """First mode: the stated ratio. Damping proportional to stiffness: the second has zeta f_2/f_1."""
    rod = beam("rod", [0, 0, 3], TUBE, theory="timoshenko", damping_ratio=0.004)
    model = arm(joints=[hinge("hinge", "rod")], links=[rod], points=[point("tip", "rod", [0, 0, 3])])
    found = flexarm.modes(model, count=4, gravity=False)
    assert found.damping_ratio[:2] == pytest.approx([0.004, 0.004], rel=1e-9)
    expected = 0.004 * found.frequency_hz[2] / found.frequency_hz[0]
    assert found.damping_ratio[2] == pytest.approx(expected, rel=1e-7)


def test_a_very_stiff_drive_is_a_rigid_one():
    """Spring of 1e8 N m/rad against none: the same swing to T/k = 5e-8 rad, the same torque to 1e-3."""
    turn = drive({"hinge": lambda t: 0.5 * np.sin(2 * t) * smooth_step(t / 3)}, 3.0)
    stiff = flexarm.simulate(rotor(compliance("hinge", 1e8, 1e5)), turn)
    rigid_drive = flexarm.simulate(rotor(), turn)
    assert stiff.joint_angle == pytest.approx(rigid_drive.joint_angle, abs=1e-7)
    scale = np.abs(rigid_drive.joint_torque).max()
    assert stiff.joint_torque == pytest.approx(rigid_drive.joint_torque, abs=1e-3 * scale)


def test_output_side_drive_ignores_the_drive_train():
    """An angle measured after the reducer is the link's own: its spring no longer matters."""
    turn = drive({"hinge": lambda t: 0.5 * np.sin(2 * t) * smooth_step(t)}, 2.0)
    measured = dataclasses.replace(
        turn, joints={name: dataclasses.replace(one, side="output") for name, one in turn.joints.items()}
    )
    soft = flexarm.simulate(rotor(compliance("hinge", SPRING)), measured)
    assert soft.joint_angle[:, 0] == pytest.approx(turn.joints["hinge"](soft.time), abs=1e-12)
