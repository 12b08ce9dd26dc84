"""Momentum: what the arm takes from the base is what it gains, and spinning bodies precess as they should."""

import functools

import numpy as np
import pytest
from arms import LENGTH, PAYLOAD, STEEL, G, arm, compliance, drive, observed_order, paper_arm, smooth_step
from rigid_chain import Body, RigidChain
from scipy.integrate import cumulative_trapezoid, solve_ivp
from scipy.interpolate import PPoly

import flexarm

STEPS = np.array([4e-3, 2e-3, 1e-3])


def test_impulse_of_the_reactions_is_the_change_of_momentum():
    """A light flexible rod with its payload M: force and moment on the arm, integrated, are M v and r x M v.

    The rod bends by decimetres (EI a tenth of the paper's) and weighs nothing; order two in the step.
    """
    light = STEEL | {"youngs_modulus": STEEL["youngs_modulus"] / 10, "density": 1e-6}
    model = paper_arm(4, 1e4, material=light)
    motion = drive({"hinge": lambda t: 2.5 - 1.2 * smooth_step(t / 0.8)}, 1.2, 2401)
    error = []
    for step in STEPS:
        run = flexarm.simulate(model, motion, step=step, forces=True)
        weight = np.array([0, 0, -PAYLOAD * G])
        moment = np.cross(run.position[:, 0], weight)
        taken = np.concatenate([np.broadcast_to(weight, moment.shape), moment], axis=1) - run.base_wrench
        momentum = PAYLOAD * run.velocity[:, 0]
        held = np.concatenate([momentum, np.cross(run.position[:, 0], momentum)], axis=1)
        impulse = cumulative_trapezoid(taken, run.time, axis=0, initial=0)
        error.append(np.abs(impulse - held).max() / np.abs(held).max())
    bent = run.position[:, 0] - LENGTH * np.stack(
        [np.sin(run.drive_angle[:, 0]), 0 * run.time, np.cos(run.drive_angle[:, 0])], axis=-1
    )
    assert np.abs(bent).max() > 0.1
    assert observed_order(STEPS, error) == pytest.approx(2.0, abs=0.2)
    assert error[-1] < 1e-4


# A disc that a rigid drive spins up to 100 rad/s, on two sprung hinges: its gyroscopic torque couples them.
SPIN, RISE, END = 100.0, 0.1, 0.3
TOP_STEPS = np.array([2e-3, 1e-3, 5e-4])
TOP = RigidChain(
    [
        Body((0, 0, 1), (0, 0, 0.3), 0.5, (0, 0, 0.05), (0.01, 0.01, 0.008)),
        Body((0, 1, 0), (0, 0, 0.1), 0.4, (0.1, 0, 0), (0.004, 0.01, 0.01)),
        Body((1, 0, 0), (0.3, 0, 0), 1.5, (0.02, 0, 0), (0.03, 0.016, 0.016)),
    ]
)
SPRINGS = (60.0, 40.0)


def spun(t):
    """Spin angle: SPIN s(t/RISE) integrated."""
    x = np.minimum(np.asarray(t, float) / RISE, 1.0)
    return SPIN * (RISE * (2.5 * x**4 - 3 * x**5 + x**6) + np.maximum(np.asarray(t) - RISE, 0))


@functools.cache
def top_motion(step: float) -> flexarm.Simulation:
    """flexarm's top."""
    springs = [compliance(f"joint{k}", SPRINGS[k]) for k in range(2)]
    return flexarm.simulate(arm(**TOP.tables(), effects=springs), top_drive(), step=step)


@functools.cache
def top_drive() -> flexarm.Drive:
    return drive({"joint2": spun}, END, 6001)


def test_a_spinning_disc_precesses_on_its_springs():
    """Springs k theta and a prescribed spin against Newton's and Euler's equations, order two in the step.

    Bouncing under its weight the disc throws the vertical hinge about by some 0.1 rad; not spinning it would
    stay in its plane.
    """
    spin = PPoly(top_drive().joints["joint2"].coefficients, top_drive().joints["joint2"].breaks)
    k = np.array(SPRINGS)

    def slope(t, y):
        q, v = np.append(y[:2], spin(t)), np.append(y[2:], spin(t, 1))
        columns = np.zeros((3, 3))
        columns[2] = spin(t, 2)
        columns[:2, 1:] = np.eye(2)
        found = TOP.inverse_dynamics(q, v, columns)[0][:2]
        bias, mass = found[:, 0], found[:, 1:] - found[:, :1]
        return np.concatenate([y[2:], np.linalg.solve(mass, -k * y[:2] - bias)])

    start = top_motion(TOP_STEPS[0]).joint_angle[0, :2]
    weight = TOP.inverse_dynamics([*start, 0], np.zeros(3), np.zeros(3))[0]
    assert -k * start == pytest.approx(weight[:2], abs=1e-9)
    y_0 = np.concatenate([start, [0, 0]])
    exact = solve_ivp(slope, (0, END), y_0, method="DOP853", rtol=1e-8, atol=1e-10, dense_output=True).sol
    error = [
        np.abs(top_motion(step).joint_angle[:, :2] - exact(top_motion(step).time)[:2].T).max()
        for step in TOP_STEPS
    ]
    assert np.abs(top_motion(TOP_STEPS[-1]).joint_angle[:, 0]).max() > 0.02
    assert observed_order(TOP_STEPS, error) == pytest.approx(2.0, abs=0.15)
    assert error[-1] < 3e-4


def test_gyroscopic_torque_of_a_steady_spin():
    """Turning the frame of a spinning disc at Omega takes I w Omega about the axis across both.

    In the disc's axes that is an acceleration at w = 100 rad/s; the step follows it to (w h)^2/4 = 4e-4.
    """
    inertia, omega, turning = 0.03, SPIN, 2.0
    frame = RigidChain(
        [
            Body((0, 0, 1), (0, 0, 0), 0.1, (0, 0, 0), (0.1, 0.1, 0.1)),
            Body((1, 0, 0), (0, 0, 0), 1.0, (0, 0, 0), (inertia, 0.016, 0.016)),
        ],
        gravity=(0, 0, 0),
    )
    ramp = {"joint1": spun, "joint0": lambda t: turning / SPIN * spun(t)}
    run = flexarm.simulate(arm(**frame.tables()), drive(ramp, END, 6001), step=4e-4, alpha=-0.3, forces=True)
    late = run.time > 0.2
    expected = np.array([0, 0, 0, 0, -inertia * omega * turning, 0])
    turned = frame_moment(run.base_wrench[late], run.joint_angle[late, 0])
    assert turned == pytest.approx(
        np.broadcast_to(expected, turned.shape), abs=1e-3 * inertia * omega * turning
    )


def frame_moment(wrench: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Wrenches in axes that turn about z by q."""
    c, s = np.cos(q), np.sin(q)
    R = np.zeros((len(q), 3, 3))
    R[:, 0, 0], R[:, 0, 1], R[:, 1, 0], R[:, 1, 1], R[:, 2, 2] = c, s, -s, c, 1
    return np.concatenate([np.einsum("nij,nj->ni", R, part) for part in np.split(wrench, 2, axis=1)], axis=1)
