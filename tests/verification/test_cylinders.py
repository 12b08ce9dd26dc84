"""Hydraulic cylinders: oil column, end cushions and friction of slides, against closed forms and ODEs."""

from __future__ import annotations

from math import pi, sqrt

import loops
import numpy as np
import pytest
from arms import G, arm, drive, rigid, smooth_step
from pytest import approx
from scipy.integrate import solve_ivp

import flexarm
from flexarm.effects import CoulombFriction, EndCushion, JointRadialCompliance, OilColumn, ViscousFriction
from flexarm.errors import InvalidParameter

BETA, BORE, RING, DEAD, STROKE, MASS = 1.2e9, 7.9e-3, 4.0e-3, 4e-4, 0.8, 900.0
OIL = OilColumn(
    at="lift",
    bulk_modulus=BETA,
    piston_area=BORE,
    ring_area=RING,
    dead_volume=DEAD,
    stroke=STROKE,
    damping=8e3,
)


def stiffness(stroke):
    """beta (A^2/V + a^2/v), V and v the volumes of the two chambers."""
    return BETA * (BORE**2 / (DEAD + BORE * stroke) + RING**2 / (DEAD + RING * (STROKE - stroke)))


def lift(axis=(0, 0, 1), mass: float = MASS) -> flexarm.Arm:
    """A mass on a slide."""
    slide = {"name": "lift", "type": "prismatic", "parent": "base", "child": "car", "axis": list(axis)}
    return arm(joints=[slide], links=[rigid("car", mass)])


@pytest.mark.parametrize("stroke", [0.0, 0.3, 0.8, 0.9])
def test_oil_sags_by_the_weight_over_its_stiffness_and_rings_with_it(stroke):
    """Beyond the end of the stroke the column is as at its end."""
    k = stiffness(min(stroke, STROKE))
    found = flexarm.static(lift().with_effect(OIL), {"lift": stroke})
    assert stroke - found.link_angle[0] == approx(MASS * G / k, rel=1e-9)
    assert found.joint_torque[0] == approx(MASS * G, rel=1e-12)
    ring = flexarm.modes(lift().with_effect(OIL), {"lift": stroke}, count=1)
    assert ring.frequency_hz[0] == approx(sqrt(k / MASS) / (2 * pi), rel=1e-9)
    assert ring.damping_ratio[0] == approx(8e3 / (2 * sqrt(k * MASS)), rel=1e-6)


def test_a_plunger_has_one_chamber():
    """Without a ring the second chamber holds nothing."""
    plunger = OIL.replace(ring_area=0.0)
    found = flexarm.static(lift().with_effect(plunger), {"lift": 0.5})
    assert 0.5 - found.link_angle[0] == approx(MASS * G * (DEAD + BORE * 0.5) / (BETA * BORE**2), rel=1e-9)


def test_oil_and_rod_are_springs_in_series():
    """1/k = 1/k_oil + 1/k_rod."""
    from flexarm.effects import JointCompliance

    soft = lift().with_effect(OIL).with_effect(JointCompliance(at="lift", stiffness=5e7))
    found = flexarm.static(soft, {"lift": 0.3})
    assert 0.3 - found.link_angle[0] == approx(MASS * G * (1 / stiffness(0.3) + 1 / 5e7), rel=1e-9)


def extend(t):
    return 0.1 + 0.6 * smooth_step(t)


def test_a_lifted_mass_rides_on_its_oil_as_the_equation_says():
    """m x'' = k(s) (s - x) + c (s' - x') - m g, of second order in the step."""
    time = np.linspace(0, 1.2, 13)

    def change(t, y):
        h = 1e-6
        rate = (extend(np.array(t + h)) - extend(np.array(t - h))) / (2 * h)
        s = float(extend(np.array(t)))
        return [y[1], (stiffness(s) * (s - y[0]) + 8e3 * (float(rate) - y[1])) / MASS - G]

    start = [0.1 - MASS * G / stiffness(0.1), 0.0]
    exact = solve_ivp(change, (0, 1.2), start, "DOP853", time, rtol=1e-10, atol=1e-13, max_step=2e-3).y[0]
    error = []
    for step in (2e-3, 1e-3):
        run = flexarm.simulate(
            lift().with_effect(OIL), drive({"lift": extend}, 1.2, 1201), step=step, alpha=0.0
        )
        error.append(np.abs(run.joint_angle[:: round(0.1 / step), 0] - exact).max())
    assert np.ptp(exact) > 0.5
    assert error[1] < 2e-6
    assert error[0] / error[1] == approx(4, rel=0.15)


@pytest.mark.parametrize("parameter", ["bulk_modulus", "piston_area", "dead_volume", "retracted", "damping"])
def test_derivatives_with_respect_to_the_oil_are_those_of_differences(parameter):
    """Central differences of runs."""
    motion, key = drive({"lift": extend}, 0.6, 601), f"effects.oil_column.lift.{parameter}"
    value = OIL.value_of(parameter)
    change = 1e-4 * (value or 1.0)

    def run(amount, **more):
        oil = OIL.with_parameters({parameter: value + amount})
        return flexarm.simulate(lift().with_effect(oil), motion, step=2e-3, **more)

    found = run(0.0, sensitivities=[key]).sensitivities.by(key)["joint_angle"][:, 0]
    expected = (run(change).joint_angle - run(-change).joint_angle)[:, 0] / (2 * change)
    assert found == approx(expected, abs=1e-5 * np.abs(expected).max())


def test_a_crane_sinks_by_the_oil_of_its_cylinder():
    """The cylinder holds F; its piston gives way by F/k, and the boom as with a rigid cylinder so far in."""
    oil = OIL.replace(at="piston")
    soft = flexarm.static(loops.crane().with_effect(oil), {"piston": 0.4})
    force = soft.joint_torque[2]
    stroke = 0.4 - force / stiffness(0.4)
    assert soft.link_angle[2] == approx(stroke, abs=1e-9)
    rigid_there = flexarm.static(loops.crane(), {"piston": stroke})
    assert soft.position == approx(rigid_there.position, abs=1e-9)
    assert force == approx(rigid_there.joint_torque[2], rel=1e-9)


# ------------------------------------------------------------------- ends

WAY, LENGTH, HEAD, THROTTLE, IMPULSE = 0.4, 0.05, 2e6, 4e3, 120.0
ENDS = EndCushion(at="lift", low=-WAY, high=WAY, stiffness=HEAD, length=LENGTH, damping=THROTTLE)


def push(sign: float, end: float = 1.5) -> flexarm.Drive:
    """A force that gives the car sign x IMPULSE within 0.2 s."""
    return drive(
        {"lift": lambda t: sign * IMPULSE * 10 * np.sin(5 * pi * np.minimum(t, 0.2)) ** 2},
        end,
        3001,
        side="torque",
    )


def slid(effect, sign: float = 1.0, step: float = 2.5e-4, **more) -> flexarm.Simulation:
    return flexarm.simulate(
        lift((1, 0, 0), 100.0).with_effect(effect), push(sign), step=step, alpha=0.0, **more
    )


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_cushion_takes_c_w_over_2_m_of_the_rate(sign):
    """m v dv/dx = -c g(x) v gives v = v_0 - c w/(2 m) at the end; both ends alike."""
    run = slid(ENDS, sign)
    x, v = sign * run.joint_angle[:, 0], sign * run.joint_rate[:, 0]
    free = (x > 0.2) & (x < WAY - LENGTH) & (v > 0)
    assert v[free] == approx(IMPULSE / 100, rel=1e-5)
    reached = int(np.argmax(x > WAY))
    at_end = np.interp(WAY, x[reached - 1 : reached + 1], v[reached - 1 : reached + 1])
    assert at_end == approx(IMPULSE / 100 - THROTTLE * LENGTH / (2 * 100), rel=2e-3)


def test_a_bare_stop_throws_the_car_back():
    """Depth v sqrt(m/k), and the rate turns round: energy stays."""
    run = slid(ENDS.replace(damping=0.0), energies=True)
    x, v = run.joint_angle[:, 0], run.joint_rate[:, 0]
    speed = IMPULSE / 100
    assert x.max() - WAY == approx(speed * sqrt(100 / HEAD), rel=1e-3)
    back = (run.time > 0.6) & (run.time < 1.0)
    assert v[back] == approx(-speed, rel=1e-3)
    balance = run.kinetic + run.elastic + run.gravity + run.damped - run.work
    assert np.abs(balance - balance[0]).max() < 1e-3 * np.ptp(run.kinetic)


def test_a_cushion_takes_the_energy_that_it_damps():
    """Kinetic and elastic energy, and what the cushion takes, make up the work."""
    left = []
    for step in (5e-4, 2.5e-4):
        run = slid(ENDS, step=step, energies=True)
        balance = run.kinetic + run.elastic + run.gravity + run.damped - run.work
        left.append(np.abs(balance - balance[0]).max() / np.ptp(run.kinetic))
    assert run.damped[-1] > 0.5 * np.ptp(run.kinetic)
    assert left[1] < 1e-3
    assert left[0] / left[1] > 3


def test_a_load_rests_on_its_lower_stop():
    """A lift without a motor's force lies d = m g/k beyond its end."""
    sagging = lift().with_effect(ENDS).with_effect(OIL.replace(bulk_modulus=1.0))
    found = flexarm.static(sagging, {"lift": 0.0})
    assert -WAY - found.link_angle[0] == approx(MASS * G / HEAD, rel=1e-4)


@pytest.mark.parametrize("parameter", ["high", "stiffness", "length", "damping"])
def test_derivatives_with_respect_to_an_end_are_those_of_differences(parameter):
    """Away from the instants at which the car meets cushion or head."""
    motion, key = push(1.0, 0.62), f"effects.end_cushion.lift.{parameter}"
    value = ENDS.value_of(parameter)
    change = 1e-4 * value

    def run(amount, **more):
        ends = ENDS.with_parameters({parameter: value + amount})
        return flexarm.simulate(lift((1, 0, 0), 100.0).with_effect(ends), motion, step=5e-4, **more)

    found = run(0.0, sensitivities=[key]).sensitivities.by(key)["joint_angle"][:, 0]
    expected = (run(change).joint_angle - run(-change).joint_angle)[:, 0] / (2 * change)
    assert np.abs(expected).max() > 0
    assert found == approx(expected, abs=2e-2 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"low": 0.5}, "high: must lie above low = 0.5, got 0.4"),
        ({"length": 0.5}, "at most half the way between the ends, 0.8, got 0.5"),
        ({"stiffness": 0.0}, "stiffness"),
    ],
)
def test_ends_that_are_none_are_refused(change, said):
    """The message names the key."""
    with pytest.raises(InvalidParameter, match=said):
        ENDS.replace(**change)


def test_oil_is_told_in_units_of_a_cylinder():
    """Areas in m2 where the joint slides."""
    from flexarm.arm.joint_units import parameters_in

    told = {name: unit for name, _, unit in parameters_in(OIL, lift())}
    assert (told["piston_area"], told["dead_volume"], told["damping"]) == ("m2", "m3", "N s/m")


# ------------------------------------------------------------------- friction of slides that close a loop


def slider_crank(kind: str, *effects: flexarm.Effect) -> flexarm.Arm:
    """A crank of 0.3 m, a rod of 0.8 m and a slider on the x axis, whose slide is a joint or a closure.

    `kind` is the type of the closure at the slide; "revolute": the slide is a joint and the rod's eye the
    closure.
    """
    links = [loops.bar("crank", 0.3, 2.0), loops.bar("rod", 0.8, 3.0)]
    joints = [loops.hinge("A", "base", "crank"), loops.hinge("B", "crank", "rod", (0.3, 0, 0))]
    slider = {"name": "slider", "type": "rigid", "mass": 5.0, "com": [0, 0, 0], "inertia": [0.01] * 3}
    found = {"name": "S", "type": kind, "axis": [1, 0, 0]}
    if kind == "revolute":
        slide = {"name": "S", "type": "prismatic", "parent": "base", "child": "slider", "axis": [1, 0, 0]}
        joints.append(slide)
        links.append(slider)
        found = loops.pin("eye", "rod", (0.8, 0, 0), "slider", (0, 0, 0))
    elif kind == "point_on_line":
        found |= {"a": "base", "b": "rod", "b_origin": {"xyz": [0.8, 0, 0]}}
    else:
        joints.append(loops.hinge("eye", "rod", "slider", (0.8, 0, 0)))
        links.append(slider)
        found |= {"a": "base", "b": "slider"}
    loads = [{"name": "head", "link": "rod", "position": [0.8, 0, 0], "mass": 5.0}]
    model = flexarm.Arm.from_dict(
        {
            "name": f"slider-crank, {kind}",
            "links": links,
            "joints": joints,
            "closures": [found],
            "payloads": loads if kind == "point_on_line" else [],
            "assembly": {"A": 0.9, "B": -0.9 - float(np.arcsin(0.3 * np.sin(0.9) / 0.8))},
        }
    )
    for effect in effects:
        model = model.with_effect(effect)
    return model


ALONG = [
    ViscousFriction(at="S", coefficient=60.0),
    CoulombFriction(at="S", torque=40.0, width=1e-3),
    EndCushion(at="S", low=-1.2, high=0.95, stiffness=2e5, length=0.1, damping=500.0),
]
TO_AND_FRO = drive({"A": lambda t: 60 * np.sin(8 * t) * smooth_step(5 * t)}, 1.0, 1001, side="torque")


@pytest.mark.parametrize("kind", ["prismatic", "cylindrical"])
@pytest.mark.parametrize("effect", ALONG, ids=lambda effect: effect.name)
def test_a_law_along_a_closure_is_that_of_the_same_slide_as_a_joint(kind, effect):
    """The equations are the same; accelerations are iterated to 1e-5 of the reach."""
    free, as_joint, as_closure = (
        flexarm.simulate(slider_crank(*model), TO_AND_FRO, step=2e-3).joint_angle[:, 0]
        for model in (("revolute",), ("revolute", effect), (kind, effect))
    )
    assert np.abs(as_joint - free).max() > 1e-2
    assert as_closure == approx(as_joint, abs=1e-5)


def test_friction_along_a_line_is_that_of_the_same_slide_as_a_joint():
    """The slider's mass sits on the rod there, so steps err otherwise: by a quarter at half the step."""
    apart = []
    for step in (2e-3, 1e-3):
        as_joint, as_closure = (
            flexarm.simulate(slider_crank(kind, ALONG[0]), TO_AND_FRO, step=step).joint_angle[:, 0]
            for kind in ("revolute", "point_on_line")
        )
        apart.append(np.abs(as_joint - as_closure).max())
    assert apart[1] < 4e-6
    assert apart[0] / apart[1] > 2.5


def test_a_pin_gives_way_radially_by_its_force_over_its_stiffness():
    """Two stiffnesses across the axis; a closure as the same pin as a joint, at rest and in its modes."""
    soft = JointRadialCompliance(at="hinge", stiffness=(2e5, 5e5))
    post = arm(
        joints=[{"name": "hinge", "type": "revolute", "parent": "base", "child": "post", "axis": [0, 1, 0]}],
        links=[rigid("post", 10.0, (0, 0, 0.4), (0.1, 0.1, 0.1))],
        points=[{"name": "foot", "link": "post", "position": [0, 0, 0]}],
    ).with_effect(soft)
    found = flexarm.static(post, {}, {"foot": [300.0, 0, 0]})
    assert found.position[0] == approx([300.0 / 2e5, 0, -10 * G / 5e5], abs=1e-9)
    weak = JointRadialCompliance(at="C", stiffness=(4e4, 9e4), damping=20.0)
    loose = [loops.four_bar(cut, assembly=loops.assembled(cut, 0.9)).with_effect(weak) for cut in "CD"]
    turned = [flexarm.modes(each, {"A": 0.9}, count=2).frequency_hz for each in loose]
    held = [flexarm.static(each, {"A": 0.9}) for each in loose]
    assert held[0].position[:2] == approx(held[1].position[:2], abs=1e-3)
    plain = flexarm.static(loops.four_bar("C", assembly=loops.assembled("C", 0.9)), {"A": 0.9})
    assert np.abs(held[0].position - plain.position).max() > 1e-4
    assert turned[0] == approx(turned[1], rel=1e-6)


def test_energies_on_a_column_of_oil_are_in_balance():
    """What the valve gives as the column stiffens or softens counts as damped."""
    run = flexarm.simulate(
        lift().with_effect(OIL), drive({"lift": extend}, 1.2, 1201), step=5e-4, alpha=0.0, energies=True
    )
    balance = run.kinetic + run.elastic + run.gravity + run.damped - run.work
    assert np.ptp(balance) < 1e-5 * np.ptp(run.work)
