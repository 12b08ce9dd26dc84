"""Frequencies of beams converge to exact roots at the order of their shape functions."""

import numpy as np
import pytest
from arms import arm, beam, fixed, general, observed_order, point
from scipy.integrate import simpson
from scipy.optimize import brentq

import flexarm

# lam^2 = omega sqrt(m L^4/EI) of a clamped beam with a tip mass M = m L: roots of
# 1 + cos cosh + lam (cos sinh - sin cosh) = 0
TIP_MASS_ROOTS = np.array([1.557298, 16.25009, 50.89584, 105.1983, 179.2320])
CANTILEVER_ROOT = 1.8751040687119611**2
SLENDER = {"youngs_modulus": 1.0, "poisson_ratio": 0.3, "density": 1.0}


def roots(elements: int, payload: float, shear_area: float = 1.0, **link) -> np.ndarray:
    """omega sqrt(m L^4/EI) of the modes that bend in the x-z plane; L = m = 1, EI = 1e-6, EA = 1."""
    rod = arm(
        gravity=[0, 0, 0],
        joints=[fixed("clamp", "rod")],
        links=[
            beam(
                "rod",
                [1.0, 0, 0],
                general(1.0, [1e-6, 1e-2], 1e-2, shear_area=shear_area),
                up=[0, 0, 1],
                material=SLENDER,
                elements=elements,
                **link,
            )
        ],
        payloads=[{"name": "load", "link": "rod", "position": [1.0, 0, 0], "mass": payload}],
        points=[point("tip", "rod", [1.0, 0, 0])],
    )
    found = flexarm.modes(rod, count=8)
    in_plane = np.abs(found.shape[:, 0, 4]) > 1e3 * np.abs(found.shape[:, 0, [3, 5]]).max(axis=1)
    return 2e3 * np.pi * found.frequency_hz[in_plane]


def test_tip_mass_roots():
    """To the seven figures that are quoted."""
    assert roots(64, payload=1.0)[:5] == pytest.approx(TIP_MASS_ROOTS, rel=2e-6)


@pytest.mark.parametrize("mode", [1, 2, 3])
def test_frequency_converges_at_fourth_order(mode):
    """Cubic shape functions and consistent mass; exact roots from the frequency equation to 1e-12."""
    exact = exact_root(mode)
    n = np.array([8, 16, 32])
    error = [roots(int(k), payload=1.0)[mode] - exact for k in n]
    assert np.all(np.array(error) > 0)  # the consistent mass gives upper bounds
    assert observed_order(1 / n, error) == pytest.approx(4.0, abs=0.2)


def exact_root(mode: int) -> float:
    """Root of the frequency equation next to the quoted one."""

    def equation(lam):
        c, s, ch, sh = np.cos(lam), np.sin(lam), np.cosh(lam), np.sinh(lam)
        return (1 + c * ch + lam * (c * sh - s * ch)) / ch

    lam = np.sqrt(TIP_MASS_ROOTS[mode])
    return float(brentq(equation, lam - 1e-3, lam + 1e-3, xtol=1e-14) ** 2)


def test_cantilever_frequency_converges_at_fourth_order():
    """omega_1 = 1.8751^2 sqrt(EI/(m L^4)) of the clamped-free beam."""
    n = np.array([2, 4, 8])
    error = [roots(int(k), payload=0.0)[0] - CANTILEVER_ROOT for k in n]
    assert observed_order(1 / n, error) == pytest.approx(4.0, abs=0.2)


def test_shear_and_rotary_inertia_lower_the_frequencies():
    """Rayleigh's quotient of the first mode w(x), to first order in r^2 = I/A:

        d(omega)/omega = -1/2 r^2 [ int w_x^2/int w^2 + E/(kG) int w_xxx^2/int w_xx^2 ]

    r = 1e-3 L, so the second order is some 1e-4 of the change; E/(kG) = 2 (1 + 0.3)/0.5.
    """
    lam, r = np.sqrt(CANTILEVER_ROOT), 1e-3
    sigma = (np.cosh(lam) + np.cos(lam)) / (np.sinh(lam) + np.sin(lam))
    x = np.linspace(0, 1, 20001)
    ch, sh, c, s = np.cosh(lam * x), np.sinh(lam * x), np.cos(lam * x), np.sin(lam * x)
    w, slope = ch - c - sigma * (sh - s), lam * (sh + s - sigma * (ch - c))
    bend, third = lam**2 * (ch + c - sigma * (sh + s)), lam**3 * (sh - s - sigma * (ch + c))

    def share(f, g):
        return simpson(f**2, x=x) / simpson(g**2, x=x)

    expected = -0.5 * r**2 * (share(slope, w) + 2.6 / 0.5 * share(third, bend))
    thick = roots(32, payload=0.0, theory="timoshenko", shear_area=0.5)[0]
    assert thick / roots(32, payload=0.0)[0] - 1 == pytest.approx(expected, rel=2e-3)
