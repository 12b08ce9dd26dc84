"""Free vibration: the time stepping does what its formulas say, and the arm what its modes say."""

from itertools import pairwise

import numpy as np
import pytest
from arms import arm, compliance, drive, general, hinge, observed_order, paper_arm, rigid, smooth_step

import flexarm

INERTIA = 2.0


def amplification(alpha: float, omega_h: float) -> np.ndarray:
    """One HHT step of x'' = -w^2 x for the columns (x, h v, h^2 a), generalised-alpha form.

    a_1 = (1 + alpha) x''_1 - alpha x''_0,  x_1 = x_0 + h v_0 + h^2 [(1/2 - beta) a_0 + beta a_1],
    v_1 = v_0 + h [(1 - gamma) a_0 + gamma a_1],  beta = (1 - alpha)^2/4,  gamma = 1/2 - alpha
    """
    beta, gamma, s = (1 - alpha) ** 2 / 4, 0.5 - alpha, omega_h**2
    new = np.array([[1, 0, -beta], [0, 1, -gamma], [(1 + alpha) * s, 0, 1]])
    old = np.array([[1, 1, 0.5 - beta], [0, 1, 1 - gamma], [alpha * s, 0, 0]])
    return np.linalg.solve(new, old)


def plucked_body(omega: float, step: float, alpha: float, steps: int = 120) -> np.ndarray:
    """Deflection, after the motor has come to rest, of a body on a spring of frequency omega [rad/s]."""
    body = arm(
        gravity=[0, 0, 0],
        joints=[hinge("hinge", "body", axis=[0, 0, 1])],
        links=[rigid("body", 1.0, inertia=[1.5, 1.5, INERTIA])],
        effects=[compliance("hinge", INERTIA * omega**2)],
    )
    rise = 5 * step
    pluck = drive({"hinge": lambda t: 0.5 * smooth_step(t / rise)}, rise, 2001)
    run = flexarm.simulate(body, pluck, step=step, alpha=alpha, end=(steps + 6) * step)
    return run.joint_angle[7:, 0] - 0.5


@pytest.mark.parametrize("alpha", [0.0, -0.05, -0.1, -0.3, -1 / 3])
@pytest.mark.parametrize("omega_h", [0.3, 3.0])
def test_hht_is_the_recurrence_of_its_formulas(alpha, omega_h):
    """Cayley and Hamilton: deflections obey x_3 = c_1 x_2 + c_2 x_1 + c_3 x_0 of the step's matrix.

    So frequency, period error and the amplitude lost are those of alpha and w h. Left over: Newton's 1e-10.
    """
    x = plucked_body(omega_h / 0.01, 0.01, alpha)
    c = np.poly(amplification(alpha, omega_h))
    recurrence = c[0] * x[3:] + c[1] * x[2:-1] + c[2] * x[1:-2] + c[3] * x[:-3]
    assert np.abs(x).max() > 1e-2
    assert np.abs(recurrence).max() < 2e-9


# alpha, spectral radius (1 + alpha)/(1 - alpha)
RADII = [(-0.05, 0.905), (-0.1, 0.818), (-0.2, 0.667), (-0.3, 0.538)]


@pytest.mark.parametrize(("alpha", "radius"), RADII)
def test_fast_oscillations_decay_by_the_spectral_radius(alpha, radius):
    """w h = 2000: a step leaves (1 + alpha)/(1 - alpha) of what is too fast to follow.

    The root is double, so n steps leave about n radius^n: in 20 steps radius^20 and a factor of 2 to 3.
    """
    assert max(abs(np.linalg.eigvals(amplification(alpha, 2000.0)))) == pytest.approx(radius, abs=1e-3)
    x = np.abs(plucked_body(2000.0 / 0.01, 0.01, alpha))
    assert 2.0 < x[30:50].max() / x[10:30].max() / radius**20 < 3.0


def test_frequency_of_the_stepped_motion_converges_at_second_order():
    """Period error of the trapezoidal rule, (w h)^2/12 relative; its third root is zero, of any phase."""
    omega_h = np.array([0.4, 0.2, 0.1])
    roots = [max(np.linalg.eigvals(amplification(0.0, x)), key=abs) for x in omega_h]
    error = [abs(np.angle(root)) / x - 1 for root, x in zip(roots, omega_h, strict=True)]
    assert observed_order(omega_h, error) == pytest.approx(2.0, abs=0.02)
    assert error[-1] == pytest.approx(-(0.1**2) / 12, rel=0.01)


def ringing(run: flexarm.Simulation, since: float) -> tuple[float, float]:
    """Frequency [Hz] and damping ratio of the tip's x about its equilibrium, from crossings and peaks."""
    late = run.time > since
    t, x = run.time[late], run.position[late, 0, 0]
    x = x - flexarm.static(run.arm, {"hinge": run.drive_angle[-1, 0]}).position[0, 0]
    i = np.flatnonzero((x[:-1] < 0) & (x[1:] >= 0))
    crossings = t[i] - x[i] * (t[i + 1] - t[i]) / (x[i + 1] - x[i])
    peaks = np.array([x[a : b + 1].max() for a, b in pairwise(i)])
    decrement = np.log(peaks[0] / peaks[-1]) / (len(peaks) - 1)
    return (len(crossings) - 1) / (crossings[-1] - crossings[0]), decrement / np.hypot(2 * np.pi, decrement)


@pytest.mark.parametrize("q", [0.0, np.pi])
def test_a_loaded_arm_rings_at_its_modes_frequency_and_damping(q):
    """Upright and hanging, on its hinge spring, with link damping: motion and modes() agree to 1e-4 and 1 %.

    The step of 1 ms lowers the frequency by (w h)^2/12 = 2e-5; the swing is 1 mm.
    """
    section = general(5.82e-4, 2.37e-7, shear_area=3.1e-4)
    model = paper_arm(4, 1e5, section=section, theory="timoshenko", damping_ratio=0.02)
    move = drive({"hinge": lambda t: q + 2e-3 * smooth_step(t / 0.1)}, 6.0, 6001)
    run = flexarm.simulate(model, move, step=1e-3)
    frequency, damping = ringing(run, since=2.0)
    found = flexarm.modes(model, joints={"hinge": q + 2e-3}, count=2)
    in_plane = int(np.argmax(np.abs(found.shape[:, 0, 0])))
    assert frequency == pytest.approx(found.damped_frequency_hz[in_plane], rel=1e-4)
    assert damping == pytest.approx(found.damping_ratio[in_plane], rel=0.01)
