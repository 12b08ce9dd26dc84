"""Energy is neither made nor lost: kinetic + elastic + gravity = start + work of drives - losses."""

import numpy as np
import pytest
from arms import (
    LENGTH,
    PAYLOAD,
    RHO_A,
    G,
    arm,
    compliance,
    drive,
    hinge,
    observed_order,
    paper_arm,
    rigid,
    smooth_step,
    swing_angle,
)

import flexarm

FRICTION = [
    {"name": "joint_compliance", "at": "hinge", "stiffness": 1e5, "damping": 200.0},
    {"name": "coulomb_friction", "at": "hinge", "torque": 6.0},
    {"name": "viscous_friction", "at": "hinge", "coefficient": 4.0},
    {"name": "motor_friction", "at": "hinge", "coulomb": 3.0, "viscous": 2.0},
]


def imbalance(run: flexarm.Simulation) -> np.ndarray:
    """Energy that came from nowhere since the start [J]."""
    total = run.kinetic + run.elastic + run.gravity + run.damped - run.work
    return total - total[0]


def swing(effects: list[dict], step: float, alpha: float = -0.05, **link) -> flexarm.Simulation:
    """10 s of the swing."""
    model = flexarm.Arm.from_dict(paper_arm(4, **link).to_dict() | {"effects": effects})
    motion = drive({"hinge": lambda t: np.pi + swing_angle(t)}, 10.0, 4001)
    return flexarm.simulate(model, motion, step=step, alpha=alpha)


def test_balance_over_a_damped_swing_closes_at_second_order():
    """Damping of link and joint, dry and viscous friction of bearing and motor; 100 J are exchanged."""
    h = np.array([8e-3, 4e-3, 2e-3])
    error = []
    for step in h:
        run = swing(FRICTION, step, damping_ratio=0.01)
        error.append(np.abs(imbalance(run)).max())
    assert run.damped[-1] > 10
    assert np.ptp(run.gravity) > 100
    assert observed_order(h, error) > 1.8
    assert error[-1] < 2e-4 * np.ptp(run.gravity)


def test_undamped_swing_keeps_its_energy():
    """Without any damping `damped` stays zero; the balance closes to 1e-5 of what is exchanged."""
    run = swing([compliance("hinge", 1e5)], 2e-3, alpha=0.0)
    assert np.abs(run.damped).max() == 0
    assert np.abs(imbalance(run)).max() < 1e-5 * np.ptp(run.gravity)


def test_losses_never_come_back():
    """Damping and friction take at every step, but for the spring in Dahl's law: up to T_c w = 9 * 2e-5 J."""
    run = swing(FRICTION, 4e-3, damping_ratio=0.01)
    assert np.diff(run.damped).min() > -9 * 2e-5


def test_dry_friction_takes_torque_times_path():
    """2 T_c A for a swing to A and back, less what the start and the reversal need to saturate."""
    torque, angle = 5.0, 0.8
    body = arm(
        joints=[hinge("hinge", "body", axis=[0, 0, 1])],
        links=[rigid("body", 1.0, inertia=[1, 1, 1])],
        effects=[{"name": "coulomb_friction", "at": "hinge", "torque": torque}],
    )
    there_and_back = {"hinge": lambda t: angle * (smooth_step(t) - smooth_step(t - 1))}
    run = flexarm.simulate(body, drive(there_and_back, 2.0), step=2e-3)
    assert run.damped[-1] == pytest.approx(2 * torque * angle, abs=2 * torque * 4e-5 + 2e-3)


def test_energies_of_a_stiff_swinging_arm_are_the_rigid_arms():
    """Kinetic (M + m/3) L^2 q'^2/2 and gravity (M + m/2) g L cos q of rod and payload; E = 2.1e17 Pa."""
    stiff = {"youngs_modulus": 2.1e17, "poisson_ratio": 0.3, "density": 7850.0}
    motion = drive({"hinge": lambda t: np.pi + swing_angle(t)}, 5.0, 4001)
    run = flexarm.simulate(paper_arm(2, material=stiff), motion, step=5e-3)
    q, v = run.joint_angle[:, 0], run.joint_rate[:, 0]
    m = RHO_A * LENGTH
    kinetic = 0.5 * (PAYLOAD + m / 3) * LENGTH**2 * v**2
    height = (PAYLOAD + m / 2) * G * LENGTH * np.cos(q)
    assert run.kinetic == pytest.approx(kinetic, abs=1e-5 * kinetic.max())
    assert run.gravity - run.gravity[0] == pytest.approx(height - height[0], abs=1e-6 * np.ptp(height))
