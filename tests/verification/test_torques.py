"""Torques and reactions of driven arms against inverse dynamics, with and without numerical damping."""

import dataclasses

import numpy as np
import pytest
from arms import arm, beam, compliance, drive, hinge, observed_order, point, smooth_step
from rigid_chain import RigidChain, random_chain
from scipy.interpolate import PPoly

import flexarm
from flexarm import Stepper

ALPHAS = pytest.mark.parametrize("alpha", [0.0, -0.05])
SEEDS = range(8)


def swings(rng: np.random.Generator, n: int) -> flexarm.Drive:
    """A sin(w t) for every joint, put on within 0.5 s; its jerk jumps there."""
    size, rate = rng.uniform(0.2, 1.0, n), rng.uniform(1, 6, n)
    return drive(
        {f"joint{k}": lambda t, k=k: size[k] * np.sin(rate[k] * t) * smooth_step(t / 0.5) for k in range(n)},
        1.0,
    )


def moves(rng: np.random.Generator, n: int) -> flexarm.Drive:
    """Moves at constant acceleration, then rate, then deceleration, from 0.1 s to 0.9 s."""
    size = rng.uniform(1, 6, n)

    def angle(t):
        return (np.clip(t - 0.1, 0, 0.2) ** 2 - np.clip(t - 0.7, 0, 0.2) ** 2) / 2 + 0.2 * (
            np.clip(t, 0.3, 0.9) - 0.3
        )

    return drive({f"joint{k}": lambda t, k=k: size[k] * angle(t) for k in range(n)}, 1.0)


def inverse_dynamics(chain: RigidChain, motion: flexarm.Drive, times) -> np.ndarray:
    """Joint torques and the base's wrench of the motion as flexarm gets it, a spline."""
    pieces = [motion.joints[f"joint{k}"] for k in range(len(chain.bodies))]
    splines = [PPoly(one.coefficients, one.breaks) for one in pieces]
    return np.array(
        [
            np.concatenate(chain.inverse_dynamics(*(np.array([s(t, d) for s in splines]) for d in range(3))))
            for t in times
        ]
    )


def forces(run: flexarm.Simulation, stride: int) -> np.ndarray:
    """Joint torques and the base's wrench of every so many instants."""
    return np.hstack([run.joint_torque, run.base_wrench])[::stride]


@pytest.mark.parametrize("motion", [swings, moves])
@ALPHAS
def test_torques_of_random_rigid_arms_are_those_of_inverse_dynamics(motion, alpha):
    """At 2 ms within 0.1 % of the largest, at every recorded instant, whatever jumps in the drives."""
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        chain = random_chain(rng)
        driven = motion(rng, len(chain.bodies))
        run = flexarm.simulate(arm(**chain.tables()), driven, step=2e-3, alpha=alpha, forces=True)
        expected = inverse_dynamics(chain, driven, run.time[::7])
        for part in np.split(forces(run, 7) - expected, [len(chain.bodies)], axis=1):
            assert np.abs(part).max() < 1e-3 * np.abs(expected).max(), seed
        assert run.motor_torque == pytest.approx(run.joint_torque, abs=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("seed", [12, 18, 33, 45])
@ALPHAS
def test_torques_of_five_and_six_joints_are_free_of_what_iterations_leave(seed, alpha):
    """Within 1e-4 in the motion and in the rest after it, where sliding joints carry much mass."""
    rng = np.random.default_rng(seed)
    chain = random_chain(rng)
    n = len(chain.bodies)
    size = rng.uniform(-1, 1, n)
    driven = drive({f"joint{k}": lambda t, k=k: size[k] * smooth_step(t / 0.6) for k in range(n)}, 1.0)
    run = flexarm.simulate(arm(**chain.tables()), driven, step=2e-3, alpha=alpha, forces=True)
    expected = inverse_dynamics(chain, driven, run.time)
    assert np.abs(forces(run, 1) - expected).max() < 1e-4 * np.abs(expected).max()


@ALPHAS
def test_torques_of_random_rigid_arms_converge_at_second_order(alpha):
    """Median of the arms; what is left comes from the velocities of the time stepping."""
    steps = np.array([32e-3, 16e-3, 8e-3])
    errors = []
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        chain = random_chain(rng)
        driven = swings(rng, len(chain.bodies))
        expected = inverse_dynamics(chain, driven, np.arange(0, 0.97, 32e-3))
        errors.append([])
        for step in steps:
            run = flexarm.simulate(arm(**chain.tables()), driven, step=step, alpha=alpha, forces=True)
            found = forces(run, round(32e-3 / step))[: len(expected)]
            errors[-1].append(np.abs(found - expected).max() / np.abs(expected).max())
    assert observed_order(steps, np.median(errors, axis=0)) > 1.8


@ALPHAS
def test_torques_of_a_flexible_arm_converge_at_second_order(alpha):
    """Two slender tubes on crossed hinges against a run at 1/16 ms: what vibrates is kept."""
    tubes = [
        beam(name, [0, 0, length], {"shape": "tube", "outer_diameter": 0.03, "thickness": 0.002}, elements=2)
        | {"damping_ratio": 0.01}
        for name, length in (("upper", 1.0), ("lower", 0.8))
    ]
    flexible = arm(
        gravity=[0, 0, -9.81],
        joints=[hinge("a", "upper"), hinge("b", "lower", "upper", at="end", axis=[1, 0, 0])],
        links=tubes,
        payloads=[{"name": "load", "link": "lower", "position": [0, 0, 0.8], "mass": 5.0}],
        points=[point("tip", "lower", [0, 0, 0.8])],
    )
    turns = {"a": (1.0, 4.0), "b": (0.8, 5.5)}
    driven = drive(
        {
            name: lambda t, size=size, rate=rate: size * np.sin(rate * t) * smooth_step(t / 0.5)
            for name, (size, rate) in turns.items()
        },
        1.0,
    )
    fine = flexarm.simulate(flexible, driven, step=6.25e-5, forces=True)
    steps = np.array([4e-3, 2e-3, 1e-3])
    errors = []
    for step in steps:
        run = flexarm.simulate(flexible, driven, step=step, alpha=alpha, forces=True)
        exact = forces(fine, round(step / 6.25e-5))
        errors.append(np.abs(forces(run, 1) - exact).max() / np.abs(exact).max())
    assert observed_order(steps, errors) == pytest.approx(2.0, abs=0.2)
    assert errors[1] < 1e-2


def test_torques_of_massless_motors_and_springs_do_not_depend_on_their_accelerations():
    """A motor without inertia behind a spring, driven by torque, gives that torque."""
    rng = np.random.default_rng(1)
    chain = random_chain(rng)
    names = [f"joint{k}" for k in range(len(chain.bodies))]
    springs = [compliance(name, 5e3, 20.0) for name in names]
    model = arm(**chain.tables(), effects=springs)
    told = drive({name: lambda t: 2 * np.sin(5 * t) * smooth_step(t) for name in names}, 0.3, side="torque")
    held = dataclasses.replace(told, rest={})
    run = flexarm.simulate(model, held, step=2e-3, forces=True)
    assert run.motor_torque[1:] == pytest.approx(run.joint_torque[1:], abs=1e-6)
    assert np.isfinite(run.base_wrench).all()


@ALPHAS
def test_a_stepper_reads_the_torques_of_a_run(alpha):
    """Angles, rates and accelerations of a drive told to a Stepper step by step."""
    rng = np.random.default_rng(2)
    chain = random_chain(rng)
    driven = swings(rng, len(chain.bodies))
    model = arm(**chain.tables())
    names = [f"joint{k}" for k in range(len(chain.bodies))]
    splines = {name: PPoly(driven.joints[name].coefficients, driven.joints[name].breaks) for name in names}
    sim = Stepper(model, dict.fromkeys(names, "motor"), step=2e-3, alpha=alpha)
    state = sim.start(joints={name: float(splines[name](0)) for name in names})
    for k in range(1, 60):
        state = sim.step(
            state, {name: tuple(float(s(2e-3 * k, d)) for d in range(3)) for name, s in splines.items()}
        )
    expected = inverse_dynamics(chain, driven, [0.118])[0]
    found = [sim.joint(state, name).torque for name in names]
    assert found == pytest.approx(expected[: len(names)], abs=1e-4 * np.abs(expected).max())
