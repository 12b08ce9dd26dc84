"""Places of a missing law in an arm of four joints, and the time that seeking them takes."""

from __future__ import annotations

import inspect
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from arms import arm, compliance, hinge, point, rigid
from planted import swing

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.budget import limited
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.problem import Problem
from flexarm.effects.tabulated_law import TabulatedLaw
from flexarm.missing_law.latent import latent_motions
from flexarm.missing_law.policy import LawPolicy
from flexarm.missing_law.states import states_of
from flexarm.missing_law.windup import WindupResponse

JOINTS = ("a", "b", "c", "d")
QUICK = LawPolicy(spacing=0.4, pass_spacing=0.8, linearisations=0)
"""Coarser than the default: these motions are slow."""


def chain() -> flexarm.Arm:
    """Four rigid links of half a metre in a plane, each on a spring, upright at 0."""
    end = [0.0, 0.0, 0.5]
    joints = [hinge(JOINTS[0], "link_a", gear_ratio=30.0)]
    for before, name in pairwise(JOINTS):
        origin = {"xyz": end, "rpy": [0, 0, 0]}
        joints.append(hinge(name, f"link_{name}", f"link_{before}", origin=origin, gear_ratio=30.0))
    return arm(
        name="chain",
        gravity=[0, 0, -9.81],
        joints=joints,
        links=[rigid(f"link_{name}", 5.0, [0, 0, 0.25], [0.1, 0.1, 0.01]) for name in JOINTS],
        points=[point("tip", "link_d", end), point("elbow", "link_b", end)],
        effects=[compliance(name, 2e4, 100.0) for name in JOINTS],
    )


def drive_of_all() -> flexarm.Drive:
    t = np.arange(0, 8.005, 0.02)
    return flexarm.Drive.from_samples(t, {name: swing(0.3, 4.0 + k, 0.5)(t) for k, name in enumerate(JOINTS)})


def motors() -> list[Sensor]:
    return [
        Sensor(name=name, quantity="joint_angle", joint=name, side="motor", rate_hz=50, noise_std=1e-6)
        for name in JOINTS
    ]


@cache
def problem() -> Problem:
    """A record of 8 s of a chain whose third joint loses a torque that saturates with its rate."""
    x = np.linspace(-1.0, 1.0, 21)
    law = TabulatedLaw(at="c", quantity="torque", of="rate", x=tuple(x), value=tuple(20 * np.tanh(x / 0.1)))
    sensors = motors() + [
        Sensor(name=name, quantity="position", point=name, axes=("x", "z"), rate_hz=10, noise_std=4e-5)
        for name in ("tip", "elbow")
    ]
    run = flexarm.simulate(chain().with_effect(law), drive_of_all(), step=4e-3)
    shown = flexarm.measure(run, sensors, np.random.default_rng(0), drive=list(JOINTS))
    return Problem(chain(), {"run": shown}, step=8e-3, jobs=1)


def test_a_linear_pass_over_all_joints_keeps_the_one_with_the_law():
    fit = Estimator.nominal(problem(), nuisance_model(problem())).fit(())
    found = list(latent_motions(problem(), fit, QUICK))
    joints = [each for each in found if each.quantity == "windup"]
    assert len(joints) == QUICK.most_joints < len(JOINTS)
    assert max(found, key=lambda each: each.gain).at == "c"


def test_the_response_of_each_quantity_is_that_of_a_simulated_windup():
    """Positions, an attitude, a torque and a rate of an arm with other joints; in the steps of responses."""
    run = flexarm.simulate(chain(), drive_of_all(), step=4e-3, rotations=True)
    seen = {
        "position": {"point": "tip", "axes": ("x", "z")},
        "orientation": {"point": "tip"},
        "angular_rate": {"point": "tip", "axes": ("y",)},
        "motor_torque": {"joint": "b"},
    }
    sensors = motors() + [
        Sensor(name=quantity, quantity=quantity, rate_hz=20, noise_std=1e-4, **where)
        for quantity, where in seen.items()
    ]
    record = flexarm.measure(run, sensors, np.random.default_rng(0), drive=list(JOINTS))
    problem = Problem(chain(), {"run": record}, step=QUICK.response_step, jobs=1)
    assert {rows.signal for rows in problem.rows} == set(seen)
    response = WindupResponse.of(problem, chain(), "b", QUICK)
    motion = 1e-5 * np.sin(response.bases["run"].places)
    expected, found = response.moved(motion), response.jacobian @ motion
    for rows, where in problem.channels():
        error = np.linalg.norm(found[where] - expected[where])
        assert error < 0.02 * np.linalg.norm(expected[where]) + 1e-9, rows.signal


def test_the_angle_within_a_turn_is_that_of_the_motor_before_all_gears():
    """A motor with a reducer of its own and two gears in series: 3 x 4 x 5 turns for one of the joint."""
    time, names = np.linspace(0, 4.0, 2001), ("a", "b", "c")
    rotors = [rigid(f"link_{name}", 1.0, inertia=[0.1, 0.1, 0.1]) for name in names]
    trains = (
        {"joints": [hinge("a", "link_a", gear_ratio=60.0)], "links": rotors[:1]},
        {
            "joints": [hinge(name, f"link_{name}", gear_ratio=3.0 if name == "c" else 1.0) for name in names],
            "links": rotors,
            "gears": [
                {"name": "first", "input": "c", "output": "b", "ratio": -4.0},
                {"name": "second", "input": "b", "output": "a", "ratio": -5.0},
            ],
        },
    )
    angles = []
    for train in trains:
        run = flexarm.simulate(arm(**train), flexarm.Drive.from_samples(time, {"a": time}), step=2e-3)
        angles.append(states_of(run, "a", run.time, QUICK)["motor_angle"])
    np.testing.assert_allclose(*np.exp(1j * np.array(angles)), atol=1e-9)


def test_the_budget_of_time_ends_the_search_within_a_place():
    fit = Estimator.nominal(problem(), nuisance_model(problem())).fit(())
    with limited(1e-9) as budget:
        found = list(latent_motions(problem(), fit, QUICK))
    assert [each.quantity for each in found] == ["offset", "offset"]
    (remark,) = budget.remarks
    assert "the missing motion of a was sought" in remark


def test_every_setting_has_a_unit_and_a_reason():
    source = inspect.getsource(LawPolicy)
    fields = LawPolicy.__dataclass_fields__
    assert source.count('    """') - 1 == len(fields)
    assert source.count("[") - source.count("tuple[") >= len(fields)


@pytest.mark.parametrize("spacing", [0.2, 0.8])
def test_samples_of_states_are_finer_than_knots(spacing):
    from flexarm.missing_law.basis import TimeBasis

    policy = LawPolicy(spacing=spacing)
    basis = TimeBasis.over(0.0, 8.0, policy)
    time = basis.fine(policy)
    assert np.diff(time).max() < spacing / (policy.samples - 1)
    wave = np.sin(time)
    assert basis.at(time) @ basis.nearest(time, wave) == pytest.approx(wave, abs=spacing**4)
