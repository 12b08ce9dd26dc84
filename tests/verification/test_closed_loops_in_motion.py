"""Closed loops in motion: against minimal coordinates, energy, the cut, and a driven crane."""

from __future__ import annotations

from functools import cache

import loops
import numpy as np
import pytest
from arms import drive, smooth_step
from pytest import approx
from scipy.integrate import solve_ivp

import flexarm

G, START, RAMP, END = 9.81, 0.9, 0.4, 2.0
MASSES = {"crank": 2.0, "coupler": 3.0, "rocker": 4.0}
LENGTHS = {"crank": loops.CRANK, "coupler": loops.COUPLER, "rocker": loops.ROCKER}


def bars(angle: complex) -> dict[str, tuple[complex, complex, complex]]:
    """Angle, x and z of the centre of each bar; analytic in the angle, for derivatives by a complex step."""
    bx, bz = loops.CRANK * np.cos(angle), loops.CRANK * np.sin(angle)
    dx, dz = loops.GROUND - bx, -bz
    span = np.sqrt(dx**2 + dz**2)
    at_b = np.arccos((span**2 + loops.COUPLER**2 - loops.ROCKER**2) / (2 * span * loops.COUPLER))
    coupler = np.arctan(dz / dx) + at_b
    cx, cz = bx + loops.COUPLER * np.cos(coupler), bz + loops.COUPLER * np.sin(coupler)
    rocker = (
        np.pi + np.arctan(cz / (cx - loops.GROUND))
        if (cx - loops.GROUND).real < 0
        else np.arctan(cz / (cx - loops.GROUND))
    )
    return {
        "crank": (angle, bx / 2, bz / 2),
        "coupler": (coupler, (bx + cx) / 2, (bz + cz) / 2),
        "rocker": (rocker, (loops.GROUND + cx) / 2, cz / 2),
    }


def rates(angle: complex) -> complex:
    """Inertia that the crank feels: 2 T over its rate squared."""
    h, found = 1e-30, 0.0
    ahead = bars(angle + 1j * h)
    for name, values in ahead.items():
        turn, x, z = (value.imag / h for value in values)
        m, length = MASSES[name], LENGTHS[name]
        found += m * (x**2 + z**2) + m * length**2 / 12 * turn**2
    return found


def height(angle: complex) -> complex:
    """Potential energy over g."""
    return sum(MASSES[name] * z for name, (_, _, z) in bars(angle).items())


def slope(f, x: float, h: float = 2e-3) -> float:
    return (8 * (f(x + h) - f(x - h)) - (f(x + 2 * h) - f(x - 2 * h))) / (12 * h)


@cache
def holding_torque() -> float:
    """Torque on the crank at rest."""
    return float(G * height(START + 1e-30j).imag / 1e-30)


def torque(t: float) -> float:
    """Torque that lets the crank go."""
    return holding_torque() * (1 - smooth_step(t / RAMP))


def crank_angles(time: np.ndarray) -> np.ndarray:
    """Angle of the crank by Lagrange's equation J q'' + J' q'^2/2 + V' = T."""

    def change(t: float, y: np.ndarray) -> list[float]:
        q, rate = y
        weight = G * height(q + 1e-30j).imag / 1e-30
        return [rate, (torque(t) - weight - 0.5 * slope(rates, q) * rate**2) / rates(q)]

    found = solve_ivp(change, (0, END), [START, 0.0], "DOP853", time, rtol=1e-11, atol=1e-12)
    return found.y[0]


def let_go(cut: str, step: float, alpha: float = 0.0, make=loops.bar, **more) -> flexarm.Simulation:
    points = [
        {"name": "C1", "link": "coupler", "position": [loops.COUPLER if cut != "B" else 0, 0, 0]},
        {"name": "C2", "link": "rocker", "position": [loops.ROCKER if cut != "D" else 0, 0, 0]},
    ]
    arm = loops.four_bar(cut, make, assembly=loops.assembled(cut, START), points=points)
    push = drive({"A": torque}, END, 2001, side="torque")
    return flexarm.simulate(arm, push, step=step, alpha=alpha, energies=True, **more)


def test_a_four_bar_moves_as_its_minimal_equation_says():
    """Second order: a quarter of the error at half the step; the extrapolated angle errs a tenth of that."""
    error, angle = [], []
    for step in (2e-3, 1e-3):
        run = let_go("C", step)
        every = round(0.1 / step)
        angle.append(run.joint_angle[::every, 0])
        error.append(np.abs(angle[-1] - crank_angles(run.time[::every])).max())
    assert np.ptp(angle[0]) > 1.0
    assert error[0] / error[1] == approx(4, rel=0.1)
    assert error[1] < 2e-4
    extrapolated = angle[1] + (angle[1] - angle[0]) / 3
    assert np.abs(extrapolated - crank_angles(0.1 * np.arange(len(extrapolated)))).max() < 2e-5


def test_the_loop_stays_closed_and_its_energy_stays():
    """Every step meets the closure; what the balance of energy lacks falls with the square of the step."""
    left = []
    for step in (2e-3, 1e-3):
        run = let_go("C", step)
        assert np.abs(run.position[:, 0] - run.position[:, 1]).max() < 1e-9
        assert run.solver["redundant_conditions"] == 3
        balance = run.kinetic + run.elastic + run.gravity + run.damped - run.work
        left.append(np.abs(balance - balance[0]).max() / np.ptp(run.kinetic))
    assert left[1] < 1e-4
    assert left[0] / left[1] > 3.5


@pytest.mark.parametrize("make", [loops.bar, lambda name, length, mass: loops.beam(name, length, 2)])
def test_a_loop_cut_at_another_pin_moves_alike(make):
    """The equations are the same; accelerations are iterated to 1e-5 of the reach: 1e-6 after 2 s."""
    runs = {cut: let_go(cut, 2e-3, -0.05, make) for cut in "BCD"}
    for cut in "BC":
        assert runs[cut].joint_angle[:, 0] == approx(runs["D"].joint_angle[:, 0], abs=3e-6)
        assert runs[cut].position[:, 1] == approx(runs["D"].position[:, 1], abs=3e-6)


def test_a_cylinder_lifts_a_flexible_crane():
    """The stroke is prescribed, the boom follows and rings; at rest it stands where statics puts it."""
    arm = loops.crane({**loops.beam("boom", 3.0, side=0.12), "damping_ratio": 0.2})
    lift = drive({"piston": lambda t: 0.3 + 0.3 * smooth_step(t)}, 1.0, 501)
    run = flexarm.simulate(arm, lift, end=6.0, forces=True)
    for at, stroke in ((0, 0.3), (-1, 0.6)):
        found = flexarm.static(arm, {"piston": stroke})
        assert run.position[at] == approx(found.position, abs=1e-6)
        assert run.joint_angle[at] == approx(found.link_angle, abs=1e-6)
        assert run.joint_torque[at] == approx(found.joint_torque, rel=1e-4, abs=1e-3)
        assert run.base_wrench[at] == approx(found.base_wrench, rel=1e-4, abs=1e-1)
    assert np.ptp(run.position[:, 0, 2]) > 1.0


def test_reported_forces_are_those_of_the_minimal_equation():
    """A crank that is driven needs T = J q'' + J' q'^2/2 + V'."""
    arm = loops.four_bar("C", assembly=loops.assembled("C", START))
    turn = drive({"A": lambda t: START + 2.0 * smooth_step(t / END)}, END, 2001)
    run = flexarm.simulate(arm, turn, step=1e-3, alpha=-0.05)
    chosen = slice(100, -100, 50)
    q, rate = run.joint_angle[chosen, 0], run.joint_rate[chosen, 0]
    fine = 1e-3
    angles = run.joint_angle[:, 0]
    acceleration = ((angles[2:] - 2 * angles[1:-1] + angles[:-2]) / fine**2)[99:-99:50][: len(q)]
    weight = np.array([G * height(a + 1e-30j).imag / 1e-30 for a in q])
    needed = [
        rates(a) * acc + 0.5 * slope(rates, a) * w**2 for a, acc, w in zip(q, acceleration, rate, strict=True)
    ]
    assert run.joint_torque[chosen, 0] == approx(np.array(needed) + weight, abs=2e-3)


def test_a_drive_beyond_the_reach_of_the_loop_stops_with_the_time():
    """At full stroke the bars are in line and Newton's method has no solution."""
    arm = loops.crane()
    lift = drive({"piston": lambda t: 0.3 + 1.0 * t}, 1.0, 101)
    with pytest.raises(flexarm.errors.NotConverged, match=r"t = 0\.86"):
        flexarm.simulate(arm, lift)
