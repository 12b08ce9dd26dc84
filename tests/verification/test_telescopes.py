"""Telescopic booms whose overlap slides, against the beams of textbooks and the arm of variable length."""

from __future__ import annotations

import loops
import numpy as np
import pytest
from arms import G, drive, smooth_step
from pytest import approx
from scipy.integrate import solve_ivp
from telescopes import telescope

import flexarm
from flexarm.errors import InvalidParameter, NotConverged

OUTER, INNER, MODULUS = 3.0, 2.4, 210e9


def section(name: str, length: float, side: float, elements: int = 6, **more) -> dict:
    """A square section of steel as an Euler-Bernoulli beam."""
    made = loops.beam(name, length, elements, side)
    return {**made, "theory": "euler-bernoulli", **more}


def deflection(tail: float, force: float) -> float:
    """Sag of the tip of both cantilevered sections under a force down at the tip.

    The inner one is an overhanging beam on mouth and tail, the outer one a cantilever with both their forces.
    """
    overlap = OUTER - tail
    free = INNER - overlap
    stiff, soft = (MODULUS * side**4 / 12 for side in (0.1, 0.06))
    mouth = force * INNER / overlap
    up = mouth - force  # the tail lifts the outer section

    def sag(x: float) -> float:
        def by(load: float, at: float) -> float:
            near, far = min(x, at), max(x, at)
            shape = near**2 * (3 * far - near) if x <= at else at**2 * (3 * x - at)
            return load * shape / (6 * stiff)

        return by(mouth, OUTER) - by(up, tail)

    chord = sag(OUTER) + (sag(OUTER) - sag(tail)) * free / overlap
    return chord + force * free**2 * (overlap + free) / (3 * soft)


def boom(tail: float, elements: int = 6, **more) -> flexarm.Arm:
    light = {"youngs_modulus": MODULUS, "poisson_ratio": 0.3, "density": 1e-3}
    return telescope(
        section("outer", OUTER, 0.1, elements, material=light),
        section("inner", INNER, 0.06, elements, material=light),
        tail,
        gravity=[0, 0, 0],
        **more,
    )


@pytest.mark.parametrize("tail", [1.5, 1.9, 2.3, 2.71])
def test_a_telescope_sags_as_two_sections_on_their_pads(tail):
    """Wherever the pads stand in their elements; local bending there errs by their length cubed."""
    force, error = 200.0, []
    for elements in (6, 24):
        held = {"pin": 0.0, "extension": tail}
        found = flexarm.static(boom(1.5, elements), held, {"tip": [0, 0, -force]})
        error.append(-found.position[0, 2] / deflection(tail, force) - 1)
        assert found.closure_force[1, 2] == approx(-force * INNER / (OUTER - tail), rel=2e-3)
    assert abs(error[0]) < 2e-3
    assert abs(error[1]) < 2e-5


def test_the_pads_do_no_work_while_a_telescope_extends_and_swings():
    """Kinetic, elastic and potential energy are what the drives put in; of second order in the step."""
    model = telescope(section("outer", OUTER, 0.1), section("inner", INNER, 0.06), 1.2)
    told = drive(
        {
            "pin": lambda t: 0.4 * smooth_step(t / 1.5),
            "extension": lambda t: 1.2 + 1.3 * smooth_step(t / 2.0),
        },
        2.5,
        501,
    )
    left = []
    for step in (4e-3, 2e-3):
        run = flexarm.simulate(model, told, step=step, energies=True)
        balance = run.kinetic + run.elastic + run.gravity + run.damped - run.work
        left.append(np.abs(balance - balance[0]).max() / np.ptp(run.kinetic))
    assert np.ptp(run.elastic) > 1.0
    assert left[1] < 3e-6
    assert left[0] / left[1] == approx(4, rel=0.05)


def test_a_stiff_telescope_swings_as_a_pendulum_whose_length_changes():
    """(r^2 m q')' = -m g r cos q of the load at its tip, begun in motion as it hangs."""
    load = {"name": "load", "link": "inner", "position": [INNER, 0, 0], "mass": 50.0}
    stiff = {"youngs_modulus": 2e14, "poisson_ratio": 0.3, "density": 1e-3}
    model = telescope(
        section("outer", OUTER, 0.1, 2, material=stiff),
        section("inner", INNER, 0.06, 2, material=stiff),
        1.2,
        payloads=[load],
    )
    end, start = 1.5, -np.pi / 2
    tail = lambda t: 1.2 + 1.3 * smooth_step(t / 1.2)  # noqa: E731
    told = flexarm.Drive(
        {
            **drive({"extension": tail}, end, 1001).joints,
            **drive({"pin": np.zeros_like}, end, 11, side="torque").joints,
        },
        {"pin": start, "extension": 1.2},
        0.0,
        end,
        rates={"pin": 1.5},
    )

    def change(t, y):
        h = 1e-5
        r = float(tail(np.array(t))) + INNER
        rate = float(tail(np.array(t + h)) - tail(np.array(t - h))) / (2 * h)
        return [y[1], -(2 * r * rate * y[1] + G * r * np.cos(y[0])) / r**2]

    time = np.linspace(0, end, 16)
    exact = solve_ivp(change, (0, end), [start, 1.5], "DOP853", time, rtol=1e-10, atol=1e-12, max_step=0.01)
    run = flexarm.simulate(model, told, step=1e-3)
    assert np.ptp(exact.y[0]) > 0.5
    assert run.joint_angle[::100, 0] == approx(exact.y[0], abs=3e-6)


def test_derivatives_of_a_telescope_are_those_of_differences():
    key = "payloads.load.mass"

    def found(mass: float, **more) -> list:
        load = {"name": "load", "link": "inner", "position": [INNER, 0, 0], "mass": mass}
        model = telescope(
            section("outer", OUTER, 0.1, 3), section("inner", INNER, 0.06, 3), 1.2, payloads=[load]
        )
        told = drive({"extension": lambda t: 1.2 + 1.3 * smooth_step(t), "pin": np.zeros_like}, 0.6, 301)
        held = {"pin": 0.2, "extension": 1.6}
        return [flexarm.static(model, held, **more), flexarm.simulate(model, told, step=2e-3, **more)]

    for at, plus, minus in zip(found(40.0, sensitivities=[key]), found(40.04), found(39.96), strict=True):
        expected = (plus.position - minus.position) / 0.08
        assert np.abs(expected).max() > 1e-5
        assert at.sensitivities["position"][..., 0] == approx(expected, abs=1e-3 * np.abs(expected).max())


@pytest.mark.parametrize(
    "change",
    [{"a": "piston"}, {"a": "base"}, {"a_origin": {"xyz": [0.1, 0, 0]}}, {"a_at": "end"}],
)
def test_a_point_slides_along_a_whole_beam_only(change):
    table = boom(1.5).to_dict()
    table["closures"][0] |= change
    with pytest.raises(InvalidParameter, match="'tail': a point slides along a whole beam"):
        flexarm.static(flexarm.Arm.from_dict(table), {"pin": 0.0, "extension": 1.5})


def test_a_tail_drawn_out_of_the_mouth_is_told():
    with pytest.raises(NotConverged, match=r"closure 'tail' is 0.2.* m beyond the end of its beam"):
        flexarm.static(boom(1.5), {"pin": 0.0, "extension": 3.2})
