"""The stick-slip motion of Canudas de Wit et al. 1995: a mass pulled over a rough table by a spring.

M = 1 kg, K = 2 N/m, pulled at 0.1 m/s; sigma_0 = 1e5 N/m, sigma_1 = sqrt(1e5) N s/m, sigma_2 = 0.4 N s/m,
F_c = 1 N, F_s = 1.5 N, v_s = 1 mm/s. As an arm: a slide whose joint is the
spring, its motor the hand that pulls.
"""

import numpy as np
import pytest
from arms import arm, compliance, drive, hinge, rigid
from scipy.integrate import solve_ivp

import flexarm
from flexarm.effects import LugreFriction
from flexarm.errors import InvalidParameter

M, K, PULL = 1.0, 2.0, 0.1
S0, S1, S2, COULOMB, BREAKAWAY, STRIBECK = 1e5, np.sqrt(1e5), 0.4, 1.0, 1.5, 1e-3
END = 40.0


def pulled(step: float) -> tuple[np.ndarray, np.ndarray]:
    """Instants and the force of the spring."""
    table = arm(
        joints=[hinge("slide", "mass", type="prismatic", axis=[1, 0, 0])],
        links=[rigid("mass", M)],
        effects=[
            compliance("slide", K),
            LugreFriction(
                at="slide",
                coulomb=COULOMB,
                breakaway=BREAKAWAY,
                bristle_stiffness=S0,
                bristle_damping=S1,
                viscous=S2,
                stribeck_rate=STRIBECK,
            ),
        ],
    )
    run = flexarm.simulate(table, drive({"slide": lambda t: PULL * t}, END, 11), step=step)
    assert run.solver["halvings"] == 0
    return run.time, K * (run.drive_angle - run.joint_angle)[:, 0]


def integrated() -> tuple[np.ndarray, np.ndarray]:
    """The same from the equations of the paper, by an implicit Runge-Kutta method."""

    def rates(t: float, y: np.ndarray) -> list[float]:
        x, v, z = y
        g = COULOMB + (BREAKAWAY - COULOMB) * np.exp(-((v / STRIBECK) ** 2))
        bend = v - S0 * abs(v) / g * z
        return [v, (K * (PULL * t - x) - S0 * z - S1 * bend - S2 * v) / M, bend]

    # Peaks are read off these instants; steps of the integrator are longer than a thousandth of a period.
    seen = np.linspace(0, END, 40_001)
    found = solve_ivp(
        rates, (0, END), [0, 0, 0], method="Radau", t_eval=seen, rtol=1e-7, atol=1e-11, max_step=0.01
    )
    return found.t, K * (PULL * found.t - found.y[0])


def peaks(t: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Instants and heights of the maxima of the spring's force."""
    i = np.flatnonzero((force[1:-1] > force[:-2]) & (force[1:-1] >= force[2:]) & (force[1:-1] > 1.2)) + 1
    keep = np.concatenate([[True], np.diff(t[i]) > 1.0])
    return t[i][keep], force[i][keep]


def test_the_limit_cycle_has_the_period_and_peak_of_the_equations():
    """Period and peak force of the cycle against the integrator, and the published picture: peaks near F_s.

    The law is of first order in the step where the rate changes; at 1 ms the period errs by less than 0.5 %.
    """
    t_ref, f_ref = peaks(*integrated())
    assert len(t_ref) >= 3
    assert np.diff(t_ref)[1:] == pytest.approx(np.diff(t_ref)[1], rel=1e-3)  # a limit cycle
    assert f_ref[1:] == pytest.approx(BREAKAWAY, rel=0.02)
    errors = []
    for step in (2e-3, 1e-3):
        t, force = peaks(*pulled(step))
        assert len(t) == len(t_ref)
        assert np.diff(t)[1:] == pytest.approx(np.diff(t_ref)[1:], rel=0.01)
        assert force == pytest.approx(f_ref, rel=0.01)
        errors.append(np.abs(t - t_ref).max())
    assert errors[1] < max(0.6 * errors[0], 5e-3)


def test_a_break_away_torque_below_that_of_slipping_is_refused():
    with pytest.raises(InvalidParameter, match="must not be below coulomb = 2 N m, got 1 N m"):
        LugreFriction(at="hinge", coulomb=2.0, breakaway=1.0, bristle_stiffness=1e4)
