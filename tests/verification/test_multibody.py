"""Arms with several joints against equations of motion written apart from flexarm and solved by SciPy."""

import dataclasses
import functools

import numpy as np
import pytest
from arms import arm, compliance, drive, observed_order, point, smooth_step
from rigid_chain import Body, RigidChain
from scipy.integrate import solve_ivp
from scipy.interpolate import PPoly
from scipy.optimize import root

import flexarm

PLANAR = RigidChain(
    [
        Body((0, 1, 0), (0, 0, 0), 4.0, (0, 0, 0.4), (0.2, 0.2, 0.01)),
        Body((0, 1, 0), (0, 0, 0.9), 2.5, (0.05, 0, 0.3), (0.1, 0.12, 0.02)),
    ]
)
SPATIAL = RigidChain(
    [
        Body((0, 0, 1), (0.1, 0, 0.3), 6.0, (0.02, 0.03, 0.2), (0.3, 0.25, 0.1, 0.01, -0.02, 0.03)),
        Body((0, 1, 0), (0, 0.1, 0.4), 4.0, (0.3, 0, 0.05), (0.05, 0.3, 0.31, 0.0, 0.01, 0.0)),
        Body((1, 0, 1), (0.7, 0, 0), 2.0, (0.2, 0.1, 0.0), (0.05, 0.08, 0.1)),
    ]
)
STIFFNESS, DAMPING = (1000.0, 600.0, 400.0), (10.0, 6.0, 3.0)
END = 1.0


def sprung(chain: RigidChain, **joint) -> flexarm.Arm:
    """The chain with a spring and damper in every drive, and a point on its last link."""
    tables = chain.tables()
    tables["joints"] = [entry | joint for entry in tables["joints"]]
    n = len(chain.bodies)
    springs = [compliance(f"joint{k}", STIFFNESS[k], DAMPING[k]) for k in range(n)]
    return arm(**tables, effects=springs, points=[point("tip", f"link{n - 1}", [0.3, 0.1, 0.2])])


def couplings(phi, phi_dot, theta, theta_dot):
    """T = k (phi - theta) + c (phi' - theta')."""
    n = len(theta)
    k, c = np.array(STIFFNESS[:n]), np.array(DAMPING[:n])
    return k * (np.asarray(phi) - theta) + c * (np.asarray(phi_dot) - theta_dot)


def swings(t, d: int = 0):
    """Drive angles of up to three joints, or their rates: A sin(w t) s(t), s the smooth step over 1 s."""
    w = np.array([3.0, 4.0, 5.0])
    size = np.array([1.2, -0.9, 1.0])
    t = np.asarray(t, float)[..., None]
    x = np.clip(t, 0, 1)
    s, ds = smooth_step(x), 30 * x**2 * (1 - x) ** 2
    return size * (np.sin(w * t) * s if d == 0 else w * np.cos(w * t) * s + np.sin(w * t) * ds)


def driven(n: int, end: float) -> flexarm.Drive:
    """The drives of the first n joints."""
    return drive({f"joint{k}": lambda t, k=k: swings(t)[:, k] for k in range(n)}, end, samples=4001)


@functools.cache
def reference(kind: str):
    """Dense solution (theta, theta') of the chain whose motors follow `swings`, from rest, to 1e-10."""
    chain = {"planar": PLANAR, "spatial": SPATIAL}[kind]
    n = len(chain.bodies)
    still = np.zeros(n)

    def unbalanced(theta):
        return couplings(still, still, theta, still) - chain.inverse_dynamics(theta, still, still)[0]

    start = root(unbalanced, still, tol=1e-13).x

    def slope(t, y):
        torque = couplings(swings(t)[:n], swings(t, 1)[:n], y[:n], y[n:])
        return np.concatenate([y[n:], chain.acceleration(y[:n], y[n:], torque)])

    solution = solve_ivp(
        slope,
        (0, END),
        np.concatenate([start, still]),
        method="DOP853",
        rtol=1e-9,
        atol=1e-11,
        dense_output=True,
    )
    return chain, solution.sol


@functools.cache
def driven_run(kind: str, step: float) -> flexarm.Simulation:
    """flexarm's motion of the same arm."""
    chain = {"planar": PLANAR, "spatial": SPATIAL}[kind]
    n = len(chain.bodies)
    return flexarm.simulate(sprung(chain), driven(n, END), step=step, forces=True)


STEPS = np.array([8e-3, 4e-3, 2e-3])


@pytest.mark.parametrize("kind", ["planar", "spatial"])
def test_driven_arm_converges_at_second_order(kind):
    """Motor angles in, springs between motors and links: angles and rates at every step."""
    chain, exact = reference(kind)
    n = len(chain.bodies)
    angle, rate = [], []
    for step in STEPS:
        run = driven_run(kind, step)
        y = exact(run.time)
        angle.append(np.abs(run.joint_angle - y[:n].T).max())
        rate.append(np.abs(run.joint_rate - y[n:].T).max())
    assert np.abs(y[:n]).max() > 0.5  # the arm moves far
    assert observed_order(STEPS, angle) == pytest.approx(2.0, abs=0.15)
    assert observed_order(STEPS, rate) == pytest.approx(2.0, abs=0.15)
    assert angle[-1] < 2e-5


@pytest.mark.parametrize("kind", ["planar", "spatial"])
def test_tip_and_reactions_of_the_driven_arm(kind):
    """Tip, torques on the links and wrench on the base, extrapolated from 4 and 2 ms."""
    chain, exact = reference(kind)
    n, times = len(chain.bodies), np.array([0.4, 0.6, 0.8, 1.0])
    coarse, fine = driven_run(kind, 4e-3), driven_run(kind, 2e-3)

    def limit(name):
        return (
            4 * getattr(fine, name)[np.rint(times / 2e-3).astype(int)]
            - getattr(coarse, name)[np.rint(times / 4e-3).astype(int)]
        ) / 3

    tip, torque, base = limit("position")[:, 0], limit("joint_torque"), limit("base_wrench")
    for i, t in enumerate(times):
        theta, rate = exact(t)[:n], exact(t)[n:]
        expected = couplings(swings(t)[:n], swings(t, 1)[:n], theta, rate)
        _, wrench = chain.inverse_dynamics(theta, rate, chain.acceleration(theta, rate, expected))
        assert tip[i] == pytest.approx(chain.place(theta, n - 1, [0.3, 0.1, 0.2]), abs=1e-6)
        assert torque[i] == pytest.approx(expected, abs=1e-4 * np.abs(wrench).max())
        assert base[i] == pytest.approx(wrench, abs=1e-4 * np.abs(wrench).max())


def test_reactions_of_a_prescribed_motion_converge_at_second_order():
    """Rigid drives prescribe the whole motion; the accelerations are still those of the time stepping."""
    motion = driven(3, END)
    error = []
    for step in STEPS:
        run = flexarm.simulate(arm(**SPATIAL.tables()), motion, step=step, forces=True)
        i = int(np.rint(0.8 / step))
        q, v, a = (np.array([derivative(motion, k, run.time[i], d) for k in range(3)]) for d in range(3))
        torque, wrench = SPATIAL.inverse_dynamics(q, v, a)
        assert run.joint_angle[i] == pytest.approx(q, abs=1e-12)
        assert run.motor_torque[i] == pytest.approx(run.joint_torque[i], abs=1e-12)
        error.append(np.abs(np.append(run.base_wrench[i] - wrench, run.joint_torque[i] - torque)).max())
    assert observed_order(STEPS, error) == pytest.approx(2.0, abs=0.1)
    assert error[-1] < 1e-4 * np.abs(wrench).max()


def derivative(motion: flexarm.Drive, joint: int, t: float, d: int) -> float:
    """Derivative of order d of the drive as flexarm gets it, a spline."""
    one = motion.joints[f"joint{joint}"]
    return float(PPoly(one.coefficients, one.breaks)(t, d))


def test_reactions_balance_weight_and_inertia_to_1e_8():
    """Steady turning, where the body's own accelerations are constant and time stepping is exact.

    An unbalanced body with products of inertia on a axis tilted by 0.3 rad, without gravity: base
    wrench and torque are Newton's and Euler's. With alpha = -0.3, which forgets at once what
    the tolerance of a step leaves over: with -0.05 that makes 1e-4 of noise in the accelerations here.
    """
    body = Body(
        (np.sin(0.3), 0, np.cos(0.3)),
        (0.1, 0.2, 0.3),
        3.0,
        (0.2, 0.1, 0.4),
        (0.3, 0.25, 0.1, 0.02, 0.03, 0.04),
    )
    tilted = RigidChain([body], gravity=(0, 0, 0))

    def spun(t):  # rate 5 s(t), s the smooth step over 1 s
        x = np.minimum(t, 1.0)
        return 5 * (2.5 * x**4 - 3 * x**5 + x**6 + np.maximum(t - 1, 0))

    turning = drive({"joint0": spun}, 4.0, 4001)
    run = flexarm.simulate(arm(**tilted.tables()), turning, step=5e-3, alpha=-0.3, forces=True)
    for i in (-200, -50, -1):
        q = run.joint_angle[i]
        torque, wrench = tilted.inverse_dynamics(q, [5.0], [0.0])
        assert run.joint_rate[i] == pytest.approx([5.0], abs=1e-9)
        assert run.base_wrench[i] == pytest.approx(wrench, abs=1e-8 * np.abs(wrench).max())
        assert run.joint_torque[i] == pytest.approx(torque, abs=1e-8 * np.abs(wrench).max())


def test_torque_driven_arm_with_rotor_friction_and_springs_converges():
    """Both motors by torque, from the hanging equilibrium; rotor inertia, spring, damper, viscous friction.

    N^2 J phi'' = tau - T - c_m phi',  M(theta) theta'' + c(theta, theta') = T - b theta'
    """
    ratio, rotor, motor, bearing = 50.0, 2e-4, 1.5, 0.8
    chain = PLANAR
    friction = [
        effect
        for k in range(2)
        for effect in (
            {"name": "motor_friction", "at": f"joint{k}", "viscous": motor},
            {"name": "viscous_friction", "at": f"joint{k}", "coefficient": bearing},
        )
    ]
    tables = sprung(chain, gear_ratio=ratio, rotor_inertia=rotor).to_dict()
    model = flexarm.Arm.from_dict(tables | {"effects": [*tables["effects"], *friction]})

    def tau(t):
        return np.stack([40 * np.sin(6 * t) * smooth_step(t), -8 * np.sin(8 * t) * smooth_step(t)], axis=-1)

    def slope(t, y):
        phi, theta, phi_dot, theta_dot = y.reshape(4, 2)
        T = couplings(phi, phi_dot, theta, theta_dot)
        phi_ddot = (tau(np.asarray(t)) - T - motor * phi_dot) / (ratio**2 * rotor)
        theta_ddot = chain.acceleration(theta, theta_dot, T - bearing * theta_dot)
        return np.concatenate([phi_dot, theta_dot, phi_ddot, theta_ddot])

    samples = {f"joint{k}": lambda t, k=k: tau(t)[:, k] for k in range(2)}
    torques = drive(samples, END, 2001, side="torque")
    bottom = root(lambda q: chain.inverse_dynamics(q, [0, 0], [0, 0])[0], [3.0, 0.0], tol=1e-14).x
    hanging = dataclasses.replace(torques, rest={"joint0": bottom[0], "joint1": bottom[1]})
    runs = [flexarm.simulate(model, hanging, step=step) for step in STEPS]
    start = runs[0].joint_angle[0]
    assert chain.inverse_dynamics(start, [0, 0], [0, 0])[0] == pytest.approx([0, 0], abs=1e-9)
    y_0 = np.concatenate([start, start, np.zeros(4)])
    exact = solve_ivp(slope, (0, END), y_0, method="DOP853", rtol=1e-9, atol=1e-11, dense_output=True).sol
    error = []
    for run in runs:
        y = exact(run.time)
        error.append(max(np.abs(run.drive_angle - y[:2].T).max(), np.abs(run.joint_angle - y[2:4].T).max()))
    assert np.abs(y[:4].T - y_0[:4]).max() > 0.5  # the arm moves far
    assert observed_order(STEPS, error) == pytest.approx(2.0, abs=0.15)
    assert error[-1] < 1e-4


def test_nearly_rigid_beams_move_as_rigid_links():
    """Two very stiff tubes on crossed hinges: torques and reactions of rigid rods at the same steps.

    Forces in a beam are those of its strains, to the order of the time stepping; rigid rods have none.
    """
    stiff = {"youngs_modulus": 2.1e17, "poisson_ratio": 0.3, "density": 7850.0}
    tube = {"shape": "tube", "outer_diameter": 0.06, "thickness": 0.003}
    area, second = np.pi * 0.003 * 0.057, np.pi * (0.06**4 - 0.054**4) / 64
    lengths = (1.0, 0.8)

    def rod(length):
        mass = 7850.0 * area * length
        across = mass * length**2 / 12 + 7850.0 * second * length
        return mass, (0, 0, length / 2), (across, across, 2 * 7850.0 * second * length)

    chain = RigidChain(
        [
            Body((0, 1, 0), (0, 0, 0), *rod(lengths[0])),
            Body((1, 0, 0), (0, 0, lengths[0]), *rod(lengths[1])),
        ]
    )
    tables = chain.tables()
    beams = chain.tables()
    beams["joints"][1] |= {"at": "end", "origin": {"xyz": [0, 0, 0]}}
    beams["links"] = [
        {"name": f"link{k}", "type": "beam", "end": [0, 0, lengths[k]], "section": tube, "material": stiff}
        for k in range(2)
    ]
    one, other = (
        flexarm.simulate(arm(**either), driven(2, END), step=4e-3, forces=True) for either in (tables, beams)
    )
    scale = np.abs(one.base_wrench).max()
    assert other.joint_torque == pytest.approx(one.joint_torque, abs=3e-4 * scale)
    assert other.base_wrench == pytest.approx(one.base_wrench, abs=3e-4 * scale)
