"""What a search tries of bearings, bases on two springs and late drives, and where it does not."""

from types import SimpleNamespace

import numpy as np
import pytest
from arms import G, arm, compliance, crane, hinge, point, rigid, smooth_step, tracker

from flexarm import Drive, Signal, simulate
from flexarm.arm.effect import Probes, Search
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.moves.search_state import vibrations_about
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.screening import Probed, _seen
from flexarm.effects import BaseCompliance, JointCompliance, JointTiltCompliance
from flexarm.measurement.measure import measure

TIME = np.linspace(0, 1, 51)
PLACE = ("external_vibration", "base")


def carousel():
    return arm(
        gravity=[0, 0, -G],
        joints=[hinge("turn", "rod", axis=[0, 0, 1]), hinge("lean", "tool", "rod")],
        links=[rigid("rod", 5.0, com=(1, 0, 0)), rigid("tool", 2.0, com=(0.3, 0.1, 0))],
        points=[point("tip", "tool", [0.4, 0, 0])],
    )


def problem_of(model, moved, quantity="joint_angle"):
    """A model whose joints move along with a tracker at its tip."""
    drive = Drive.from_samples(TIME, {name: 0.4 * smooth_step(TIME) for name in moved})
    record = measure(simulate(model, drive), [tracker(rate_hz=50)], np.random.default_rng(0))
    told = {
        name: Signal(
            name=name, quantity=quantity, joint=name, unit="rad", time=TIME, noise_std=0.0, clock="clock",
            values=drive.joints[name](TIME), side="motor" if quantity == "joint_angle" else None,
        )
        for name in moved
    }  # fmt: skip
    record = record.replace(signals={**told, **record.signals}, drive=tuple(told))
    return Problem(model, {"run": record})


def found(model, moved, quantity="joint_angle", rhythm=()):
    """All its candidates by place."""
    places = {}
    problem = problem_of(model, moved, quantity)
    for each in candidates(problem, model, rhythm, softer=(1.0, 30.0, 300.0)):
        places.setdefault(each.place, []).append(each)
    return places


def test_a_planar_arm_is_not_searched_for_bearings_that_tilt():
    assert not any(name == "joint_tilt_compliance" for name, _ in found(crane(), ["hinge"]))


def test_a_spatial_arm_is_at_every_joint_and_each_bearing_twice():
    places = found(carousel(), ["turn", "lean"])
    for joint in ("turn", "lean"):
        tried = [each.effect.stiffness for each in places["joint_tilt_compliance", joint]]
        assert tried == pytest.approx([2e5, 2e5 / 30])
        assert places["joint_tilt_compliance", joint][0].free == ("stiffness", "damping")


def test_a_base_under_an_upright_axis_is_tried_about_that_and_about_x_and_y():
    tried = [each.effect.stiffness for each in found(carousel(), ["turn"])["base_compliance", "base"]]
    assert [isinstance(stiffness, tuple) for stiffness in tried] == [False] * 3 + [True] * 3
    assert all(
        isinstance(each.effect.stiffness, float)
        for each in found(crane(), ["hinge"])["base_compliance", "base"]
    )


def test_a_spring_that_no_model_states_is_first_tried_where_its_prior_is_greatest():
    """A probe far softer than any base is out of phase with the machine, and promises nothing.

    In a model of rigid joints a base may stand for one of them, and begins as soft.
    """
    rigid = found(carousel(), ["turn", "lean"])["base_compliance", "base"][0]
    assert rigid.probes[0].stiffness == JointCompliance.typical_stiffness
    model = carousel().with_effect(JointCompliance(at="turn", stiffness=2e5, damping=400.0))
    first = [tried[0] for tried in found(model, ["turn", "lean"]).values()]
    springs = [each for each in first if each.effect.is_spring and each.without is None]
    names = {"joint_compliance", "joint_tilt_compliance", "base_compliance"}
    assert names <= {each.name for each in springs}
    for each in springs:
        typical = each.priors_in(model)["stiffness"].typical
        assert each.probes[0].stiffness == pytest.approx(typical), each.place


def test_vibrations_are_sought_at_the_frequencies_of_what_a_fit_leaves():
    """About the nominal model friction or a soft joint may hide them."""
    problem = problem_of(crane(), ["hinge"])
    estimator = Estimator.nominal(problem, nuisance_model(problem))
    rest = np.zeros(len(problem))
    for row in problem.rows:
        rest[row.where] = np.sin(2 * np.pi * 3.2 * row.time)
    left = SimpleNamespace(members=(), spots=frozenset(), projected=rest)
    probed = [Probed(SimpleNamespace(place=PLACE), np.empty((0, 0)))]
    strongest, *_ = vibrations_about(estimator, probed, left)
    assert strongest.candidate.place == PLACE
    assert strongest.candidate.value_of("frequency") == pytest.approx(3.2, abs=0.25)  # a record of 1 s
    assert np.abs(strongest.moves).max() > 0
    there = SimpleNamespace(**{**vars(left), "spots": frozenset({PLACE})})
    assert vibrations_about(estimator, probed, there) == []


def test_a_delay_is_sought_at_commands_and_a_time_constant_at_all_drives():
    told = found(crane(), ["hinge"])["drive_lag", "hinge"][0]
    assert told.free == ("time_constant",)
    assert told.effect.delay == 0
    asked = found(crane(), ["hinge"], "joint_command")["drive_lag", "hinge"][0]
    assert asked.free == ("delay", "time_constant")
    assert [(probe.delay > 0, probe.time_constant > 0) for probe in asked.probes] == [
        (True, False),
        (False, True),
    ]
    places = found(carousel(), ["lean"])
    assert ("drive_lag", "turn") not in places


def two():
    """A base on two springs under the carousel."""
    tried = found(carousel(), ["turn"])["base_compliance", "base"]
    return next(each for each in tried if len(each.probes) == 2)


def test_a_base_on_two_springs_is_probed_about_one_axis_after_the_other():
    base = two()
    assert base.free == ("stiffness.x", "stiffness.y", "damping")
    assert [probe.stiffness for probe in base.probes] == [(1e5, 1e12), (1e12, 1e5)]
    sized = base.sized([1.0, 4.0]).stiffness
    assert sized == pytest.approx((1e5, 2.5e4))
    assert base.sized([1.0, -4.0]).stiffness == pytest.approx((1e5, 1e5 / 0.02))


def test_an_axis_about_which_nothing_is_seen_stays_rigid():
    seen = _seen(Probed(two(), np.array([[1.0, 1e-3], [0.0, 0.0]])))
    assert seen.candidate.free == ("stiffness.x", "damping")
    assert seen.candidate.sized([2.0]).stiffness == pytest.approx((5e4, 1e12))


def test_springs_about_two_axes_act_as_others_and_others_as_they():
    soft = JointCompliance(at="turn", stiffness=1e4, damping=20.0)
    base = BaseCompliance(at="base", stiffness=(1e6, 1e6))
    assert base.acting_as(soft, None, None) == pytest.approx(
        {"stiffness.x": 1e4, "stiffness.y": 1e4, "damping": 20.0}
    )
    softer = BaseCompliance(at="base", stiffness=(1e5, 1e4), damping=20.0)
    assert soft.acting_as(softer, None, None) == pytest.approx({"stiffness": 1e4, "damping": 20.0})


def test_a_stated_spring_about_two_axes_is_probed_a_little_softer_about_each():
    stated = BaseCompliance(at="base", stiffness=(1e5, 3e5), damping=(100.0, 600.0))
    [form] = BaseCompliance.variants("base", carousel(), stated)
    trial = next(iter(form.trials(Search(carousel(), stated, softer=(1.0,)))))
    here = form.with_parameters(trial.start)
    null = dict((name, value) for name, value, _ in stated.parameters())
    probes = list(here.probes(stated, (), null, {}))
    assert probes[0].stiffness == pytest.approx((1e5 / 1.2, 3e5))
    assert probes[1].stiffness == pytest.approx((1e5, 3e5 / 1.2))
    again = here.sized([1.0, 0.0], Probes(probes, null, stated, 0.02))
    assert again["stiffness.x"] == pytest.approx(1e5 / 1.2)
    assert again["stiffness.y"] == pytest.approx(3e5)


def test_a_bearing_is_one_spring_among_others():
    assert JointTiltCompliance(at="turn").inert
    assert not JointTiltCompliance(at="turn", stiffness=1e5).inert
    assert carousel().replace(effects=()).with_effect(JointTiltCompliance(at="turn", stiffness=1e5))
    assert compliance("turn", 1.0)["name"] == "joint_compliance"


def test_the_base_of_a_gantry_gives_about_x_and_y_also_in_small_steps():
    """No joint turns, so that no base gives about a first axis; about the other axis it stays rigid."""
    slide = {"name": "way", "type": "prismatic", "parent": "base", "child": "rod", "axis": [1, 0, 0]}
    gantry = arm(
        gravity=[0, 0, -G],
        joints=[slide],
        links=[rigid("rod", 5.0, com=(0, 0, -1))],
        points=[point("tip", "rod", [0, 0, -1])],
    )
    places = found(gantry, ["way"], rhythm=[5.0])
    base = places["base_compliance", "base"][0]
    assert {each.needs for each in places.get(("external_vibration", "base"), ())} <= {base.effect, None}
    for k, turning in enumerate(("x", "y")):
        soft = base.nudged(k, 1e-3).stiffnesses
        assert {key: value >= BaseCompliance.rigid for key, value in soft.items()} == {
            key: not key.endswith(f".{turning}") for key in soft
        }
