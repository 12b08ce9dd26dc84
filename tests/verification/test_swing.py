"""The swing benchmark: the paper's arm on a soft hinge, 20 s from rest; offset of the tip from the rigid arm.

Quoted values are converged in space and time to 2e-4 mm and come from codes independent of flexarm. A third
row, shear without rotary inertia, is no theory of flexarm's; it differs from the first by at most 2e-3 mm.
"""

import functools

import numpy as np
import pytest
from arms import AREA, LENGTH, SECOND_MOMENT, drive, general, observed_order, paper_arm, swing_angle

import flexarm

INSTANTS = np.array([2.0, 5.0, 10.0, 15.0])
# shear factor 0.53 of a tube; offsets at INSTANTS [mm]
QUOTED = {
    "timoshenko": (-21.46624, -47.99204, 0.86707, 46.33846),
    "euler-bernoulli": (-21.45680, -47.96946, 0.85701, 46.34499),
}


def offset(times: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """Tip minus rigid tip along d(tip)/dq [mm]; the arm hangs at q = 0."""
    q = np.pi + swing_angle(times)
    rigid = LENGTH * np.stack([np.sin(q), 0 * q, np.cos(q)], axis=-1)
    tangent = np.stack([np.cos(q), 0 * q, -np.sin(q)], axis=-1)
    return 1e3 * np.sum((positions - rigid) * tangent, axis=-1)


@functools.cache
def swing(step: float, elements: int, theory: str = "euler-bernoulli") -> flexarm.Simulation:
    """The run; sampled cubic splines reproduce the drive to 1e-11 rad."""
    arm = paper_arm(
        elements, 1e5, section=general(AREA, SECOND_MOMENT, shear_area=0.53 * AREA), theory=theory
    )
    motion = drive({"hinge": lambda t: np.pi + swing_angle(t)}, end=20.0, samples=4001)
    return flexarm.simulate(arm, motion, step=step)


def offsets(step: float, elements: int, theory: str = "euler-bernoulli") -> np.ndarray:
    """Offsets at INSTANTS [mm]."""
    return offset(INSTANTS, swing(step, elements, theory).at(INSTANTS, "tip"))


def extrapolated(elements: int, theory: str) -> np.ndarray:
    """Richardson's value from 2 and 1 ms; the fourth-order remainder is below 1e-5 mm."""
    return (4 * offsets(1e-3, elements, theory) - offsets(2e-3, elements, theory)) / 3


@pytest.mark.parametrize("theory", list(QUOTED))
def test_swing_agrees_with_independent_codes(theory):
    """To the 2e-4 mm of the quoted values: 0.2 um in a swing of 7 m."""
    assert extrapolated(6, theory) == pytest.approx(QUOTED[theory], abs=2e-4)


def test_theories_differ_as_they_should():
    """By 0.01 mm; the difference comes out to 2e-4 mm, so an error of a hundredth needs the theory's name."""
    found = extrapolated(6, "timoshenko") - extrapolated(6, "euler-bernoulli")
    quoted = np.subtract(QUOTED["timoshenko"], QUOTED["euler-bernoulli"])
    assert found == pytest.approx(quoted, abs=2e-4)


def test_swing_converges_at_second_order_in_time():
    """Order two, at a cost of about 1900 h^2 mm (h in s)."""
    h = np.array([4e-3, 2e-3, 1e-3])
    exact = extrapolated(6, "euler-bernoulli")
    error = [np.abs(offsets(step, 6) - exact).max() for step in h]
    assert observed_order(h, error) == pytest.approx(2.0, abs=0.05)
    assert error / h**2 == pytest.approx(1900.0, rel=0.3)


def test_swing_converges_at_fourth_order_in_space():
    """Cubic shape functions: order four; four elements are within 1e-3 mm of converged at the same step.

    The order is fitted at 2 and 5 s: later, at 1e-4 mm, fine meshes differ by fast modes that 4 ms damps.
    """
    n = np.array([1, 2, 4])
    exact = offsets(4e-3, 16)
    error = np.array([np.abs(offsets(4e-3, int(k)) - exact) for k in n])
    assert observed_order(1 / n, error[:, :2].max(axis=1)) == pytest.approx(4.0, abs=0.25)
    assert error[-1].max() < 1e-3


def test_largest_offset_of_the_swing():
    """48.008 mm."""
    run = swing(1e-3, 6, "timoshenko")
    assert np.abs(offset(run.time, run.position[:, 0])).max() == pytest.approx(48.008, abs=1e-3)


def test_pure_sine_from_rest_rings():
    """Without the ramp the drive starts with a step in velocity: the arm rings to 125 mm, not 48 mm."""
    sine = {"hinge": lambda t: np.pi + 1.2 * np.sin(2 * np.pi * 0.05 * t)}
    run = flexarm.simulate(paper_arm(4, 1e5), drive(sine, end=20.0, samples=4001), step=2e-3, alpha=0.0)
    q = np.pi + 1.2 * np.sin(2 * np.pi * 0.05 * run.time)
    along = run.position[:, 0, [0, 2]] * np.stack([np.cos(q), -np.sin(q)], axis=-1)
    assert 1e3 * np.abs(along.sum(axis=1)).max() == pytest.approx(125, abs=5)
