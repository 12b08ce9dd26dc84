"""Slow motions and forces whose causes are simulated by other means than the responses that find them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from arms import LENGTH, TUBE, arm, beam, compliance, drive, hinge, point, rigid
from planted import swing
from scipy.spatial.transform import Rotation

import flexarm
from flexarm.arm.attachment import Point
from flexarm.arm.sensor import Sensor
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.verification import SplitRecords
from flexarm.effects.tabulated_law import TabulatedLaw
from flexarm.missing_law.policy import LawPolicy
from flexarm.missing_law.prediction import LawCheck
from flexarm.missing_law.search import MissingLaws, missing_laws
from flexarm.missing_law.slow import SlowMotion, slow_motions
from flexarm.record import Record, Signal

QUICK = LawPolicy(spacing=0.4)
"""Coarser than the default: these motions are slow."""
END, NOISE = 16.0, 4e-5


def wave(t):
    """At rest at both ends, so that it excites no mode."""
    return np.sin(np.pi * t / END) ** 2 * np.cos(2 * np.pi * t / END)


def sensors(*points: str) -> list[Sensor]:
    return [
        Sensor(name=name, quantity="position", point=name, axes=("x", "y", "z"), rate_hz=10, noise_std=NOISE)
        for name in points
    ]


def motors(*joints: str) -> list[Sensor]:
    return [
        Sensor(name=name, quantity="joint_angle", joint=name, side="motor", rate_hz=50, noise_std=1e-6)
        for name in joints
    ]


def told(*joints: str) -> dict:
    return {name: swing(0.5 + 0.1 * k, 5.0 + 2 * k, 0.5) for k, name in enumerate(joints)}


def record_of(
    truth: flexarm.Arm, joints: tuple[str, ...], hidden: dict, *points: str, seed: int = 0
) -> Record:
    """A run of an arm with hidden joints that follow functions of time."""
    seen = drive(told(*joints), END)
    beside = drive(hidden, END, side="output")
    both = replace(seen, joints={**seen.joints, **beside.joints})
    run = flexarm.simulate(truth, both, step=2e-3)
    sensed = motors(*joints) + sensors(*points)
    return flexarm.measure(run, sensed, np.random.default_rng(seed), drive=list(joints))


def two_links(bearing: bool = False) -> flexarm.Arm:
    """Two tubes on springs in a plane; the elbow may turn on a bearing about x."""
    geared, end = {"gear_ratio": 30}, {"at": "end"}
    joints = [
        hinge("shoulder", "upper", gear_ratio=30),
        hinge("elbow", "fore", "upper", gear_ratio=30, **end),
    ]
    links = [beam("upper", [0, 0, 1.5], TUBE, elements=2), beam("fore", [0, 0, 1.0], TUBE, elements=2)]
    if bearing:
        joints[1:] = [
            {**hinge("bearing", "hub", "upper", **end), "axis": [1, 0, 0]},
            hinge("elbow", "fore", "hub", **geared),
        ]
        links.insert(1, rigid("hub", 0.0))
    return arm(
        name="two links",
        gravity=[0, 0, -9.81],
        joints=joints,
        links=links,
        payloads=[{"name": "load", "link": "fore", "position": [0, 0, 1.0], "mass": 5.0}],
        points=[point("tip", "fore", [0, 0, 1.0]), point("mid", "upper", [0, 0, 1.5])],
        effects=[compliance(name, 6e4, 120.0) for name in ("shoulder", "elbow")],
    )


def rod(bent: bool = False) -> flexarm.Arm:
    """A tube on a hinge, seen in two places; it may bend in three hidden hinges that are its curvature."""
    lengths = [LENGTH / 6, LENGTH / 3, LENGTH / 3, LENGTH / 6] if bent else [LENGTH]
    names = ["rod", "rod_b", "rod_c", "rod_d"][: len(lengths)]
    joints = [hinge("hinge", "rod", gear_ratio=30)]
    joints += [hinge(f"to_{b}", b, a, at="end") for a, b in pairwise(names)]
    seen = point("mid", "rod_c", [0, 0, LENGTH / 6]) if bent else point("mid", "rod", [0, 0, 2 * LENGTH / 3])
    return arm(
        name="rod",
        gravity=[0, 0, -9.81],
        joints=joints,
        links=[
            beam(name, [0, 0, each], TUBE, elements=round(6 * each / LENGTH))
            for name, each in zip(names, lengths, strict=True)
        ],
        payloads=[{"name": "load", "link": names[-1], "position": [0, 0, lengths[-1]], "mass": 10.0}],
        points=[point("tip", names[-1], [0, 0, lengths[-1]]), seen],
        effects=[compliance("hinge", 1.2e5, 240.0)],
    )


def pushed(force) -> Record:
    """The rod, stepped with a force at its tip, base axes [N], a function of time."""
    seen, step, rng = ("tip", "mid"), 4e-3, np.random.default_rng(0)
    model = rod().replace(sensors=tuple(sensors(*seen)))
    sim = flexarm.Stepper(model, {"hinge": "motor"}, forces=["tip"], step=step)
    t = np.arange(0, END, step)
    phi = told("hinge")["hinge"](t)
    state = sim.start(joints={"hinge": phi[0]}, forces={"tip": force(0.0)})
    readings = [[sim.sensor(state, name) for name in seen]]
    for now, angle in zip(t[1:], phi[1:], strict=True):
        state = sim.step(state, {"hinge": angle}, forces={"tip": force(now)})
        readings.append([sim.sensor(state, name) for name in seen])
    shown = np.array(readings)[::25]
    signals = [
        Signal(
            name=each.name,
            quantity="position",
            point=each.name,
            axes=each.axes,
            time=t[::25],
            values=shown[:, k] + NOISE * rng.standard_normal(shown[:, k].shape),
            noise_std=NOISE,
        )
        for k, each in enumerate(model.sensors)
    ]
    motor = Signal(
        name="hinge",
        quantity="joint_angle",
        joint="hinge",
        side="motor",
        time=t,
        values=phi[:, None],
        noise_std=1e-6,
    )
    return Record(signals=[motor, *signals], drive=("hinge",))


def tilting(size: float) -> Record:
    """Two links whose elbow tilts about x by a milliradian times size."""
    hidden = {"bearing": lambda t: 1e-3 * size * wave(t)}
    return record_of(two_links(True), ("shoulder", "elbow"), hidden, "tip", "mid")


def bending(size: float) -> Record:
    """A rod that bends by 1.5 mrad times size over its length."""
    hidden = {f"to_rod_{k}": lambda t: 5e-4 * size * wave(t) for k in "bcd"}
    return record_of(rod(True), ("hinge",), hidden, "tip", "mid")


def pulling(size: float) -> Record:
    """A rod whose load is pulled by 20 N times size along x."""
    return pushed(lambda t: 20 * size * wave(t) * np.array([1.0, 0.0, 0.0]))


@dataclass(frozen=True)
class Case:
    """A hidden slow motion."""

    model: flexarm.Arm
    record: Callable[[float], Record]
    """Shows it, given its size."""
    at: str
    quantity: str
    peak: float
    """Its motion of size 1 over `wave`."""


CASES = {
    "tilt": Case(two_links(), tilting, "elbow", "rotation about x", 1e-3),
    "bend": Case(rod(), bending, "rod", "curvature towards x", 1.5e-3 / LENGTH),
    "pull": Case(rod(), pulling, "load", "force along x and z", 20.0),
}


@cache
def laws(name: str) -> MissingLaws:
    """What is missing of a record, and of one held out in which it is less."""
    case = CASES[name]
    return searched(case.model, case.record(1.0), case.record(0.7))


def searched(model: flexarm.Arm, record: Record, held_out: Record) -> MissingLaws:
    records = SplitRecords({"run": record}, {"other": held_out}, 8e-3, -0.05, 1)
    problem = Problem(model, records.training, step=8e-3, jobs=1)
    estimator = Estimator.nominal(problem, nuisance_model(problem))
    return missing_laws(estimator, [estimator.fit(())], LawCheck(records, model, model, "tip"), QUICK)


@pytest.mark.parametrize("name", list(CASES))
def test_a_slow_motion_is_shown_first_with_its_place_direction_and_size(name):
    """Hidden hinges tilt an elbow or bend a rod; a stepper pulls a load."""
    found, case = laws(name), CASES[name]
    curve = found.curves[0]
    assert (curve.at, curve.quantity) == (case.at, case.quantity)
    assert curve.probability > 0.9
    assert not any(each.quantity in ("windup", "torque") for each in found.curves)
    rest = np.array(curve.value) - case.peak * wave(np.array(curve.x))
    rest -= rest.mean()  # frames and clocks imitate a constant
    assert np.abs(rest).max() < 0.1 * case.peak
    assert found.added is None and "it is no part of the model" in curve.says


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("model", [two_links(), rod()], ids=["two links", "rod"])
def test_no_slow_motion_is_shown_where_none_is_missing(model, seed):
    record = record_of(model, tuple(each.name for each in model.joints), {}, "tip", "mid", seed=seed)
    assert searched(model, record, record).curves == ()


def fore_link_seen_twice() -> flexarm.Arm:
    """So that a rotation of the elbow is told from a curvature of its link."""
    ends = {"tip": 1.0, "mid": 0.5}
    points = tuple(Point(name=name, link="fore", position=(0.0, 0.0, z)) for name, z in ends.items())
    return two_links().replace(points=points)


def test_a_windup_that_follows_another_joint_is_told_over_the_angle_of_that_joint():
    """An elbow whose motor is turned along by the shoulder, as cables through a common hub do."""
    part, joints = 4e-3, ("shoulder", "elbow")

    def coupled(seed: int) -> Record:
        record = record_of(fore_link_seen_twice(), joints, {}, "tip", "mid", seed=seed)
        shoulder, elbow = (record.signals[name] for name in joints)
        read = elbow.replace(values=elbow.values - part * shoulder.values)
        return record.replace(signals={**record.signals, "elbow": read})

    curves = searched(fore_link_seen_twice(), coupled(1), coupled(2)).curves
    curve = next(each for each in curves if each.quantity == "windup")
    assert (curve.at, curve.of, curve.of_unit, curve.kind) == ("elbow", "angle of shoulder", "rad", "law")
    assert "as a function of angle of shoulder is linear" in curve.says
    assert np.gradient(curve.value, curve.x) == pytest.approx(part, rel=0.05)
    assert curve.held_out.after_rms < 0.1 * curve.held_out.before_rms


@pytest.mark.parametrize("turn", [1.5e-3, -1.5e-3])
def test_a_joint_that_stands_otherwise_than_in_the_model_is_told_as_its_origin(turn):
    model = fore_link_seen_twice()
    shoulder, elbow = model.joints
    turned = elbow.replace(origin=elbow.origin.replace(rpy=(turn, 0.0, 0.0)))
    record = record_of(model.replace(joints=(shoulder, turned)), ("shoulder", "elbow"), {}, "tip", "mid")
    curve = searched(model, record, record).curves[0]
    assert (curve.at, curve.quantity) == ("elbow", "rotation about x")
    assert np.array(curve.value) == pytest.approx(turn, abs=0.1 * abs(turn))
    assert curve.says.startswith("the rotation about x at elbow is constant")
    assert 'with an uncertainty "joints.elbow.origin.rpy_rad"' in curve.says


def test_a_windup_of_a_joint_stands_before_slow_motions_that_fit_alike():
    """An elbow that gives way with its torque, seen in two places."""
    x = np.linspace(-150.0, 150.0, 21)
    law = TabulatedLaw(
        at="elbow", quantity="windup", of="torque", x=tuple(x), value=tuple(-8e-4 * np.tanh(x / 20))
    )
    joints = ("shoulder", "elbow")
    record = record_of(two_links().with_effect(law), joints, {}, "tip", "mid")
    found = searched(two_links(), record, record)
    assert (found.curves[0].at, found.curves[0].of, found.curves[0].kind) == ("elbow", "torque", "law")
    assert found.added is not None


def motions(model: flexarm.Arm) -> dict[tuple[str, str], SlowMotion]:
    return {(each.at, f"{each.quantity} {each.direction}"): each for each in slow_motions(model, LawPolicy())}


def moves(motion: SlowMotion, joints: dict[str, float]):
    """Return what it moves of the points in a pose."""
    return sum(factor * flexarm.static(model, joints).position for factor, model in motion.models)


@pytest.mark.parametrize("pose", [(0.3, 0.4), (-0.7, 0.9), (1.2, -0.5)])
@pytest.mark.parametrize("axis", range(3))
def test_the_response_to_a_force_at_a_payload_is_that_of_statics(pose, axis):
    """A mass in a turned gravity against a force at the tip; along gravity it softens the arm by 2 %."""
    model, joints = two_links(), dict(zip(("shoulder", "elbow"), pose, strict=True))
    found = moves(motions(model)["load", f"force along {'xyz'[axis]}"], joints)
    force = 0.1 * np.eye(3)[axis]
    above, below = (flexarm.static(model, joints, {"tip": sign * force}).position for sign in (1, -1))
    expected = (above - below) / 0.2
    assert found == pytest.approx(expected, abs=0.025 * np.abs(expected).max())


def test_a_joint_turns_across_its_axis_where_its_frame_pitches_by_a_right_angle():
    """Rigid links without weight: points move by the axis times their lever."""
    origin = {"xyz": [0, 0, 1.0], "rpy": [0.4, np.pi / 2, 0.0]}
    model = arm(
        gravity=[0, 0, 0],
        joints=[hinge("a", "upper"), hinge("b", "fore", "upper", origin=origin)],
        links=[rigid(name, 5.0, [0, 0, 0.2], [0.1, 0.1, 0.1]) for name in ("upper", "fore")],
        points=[point("tip", "fore", [0.3, 0.2, 0.5]), point("elbow", "upper", [0, 0, 1.0])],
    )
    turn = Rotation.from_euler("xyz", origin["rpy"])
    tip = turn.apply([0.3, 0.2, 0.5])
    for letter, axis in (("x", [1, 0, 0]), ("z", [0, 0, 1])):
        found = moves(motions(model)["b", f"rotation about {letter}"], {})
        expected = [np.cross(turn.apply(axis), tip), np.zeros(3)]
        assert np.asarray(found) == pytest.approx(np.array(expected), abs=1e-6)


HIDDEN = {
    "curvature": (rod(), {"at": "rod", "direction": "x"}, 5e-4, "curvature towards x"),
    "turning base": (rod(), {"at": "base", "direction": "z"}, 1e-3, "rotation about z"),
    "force": (two_links(), {"at": "load", "direction": "y"}, 20.0, "force along y"),
}
"""Model, place, size of a table of the angle, and what it is called."""


@cache
def hidden_law(name: str) -> tuple[TabulatedLaw, MissingLaws]:
    """A table of the angle of the joint that carries a place, and what is found of it."""
    model, place, size, _ = HIDDEN[name]
    x = np.linspace(-1.2, 1.2, 25)
    quantity = {"rod": "curvature", "base": "windup", "load": "force"}[place["at"]]
    value = tuple(size * np.tanh(x / 0.3))
    law = TabulatedLaw(quantity=quantity, of="angle", x=tuple(x), value=value, **place)
    joints = tuple(each.name for each in model.joints)
    records = (record_of(model.with_effect(law), joints, {}, "tip", "mid", seed=seed) for seed in (1, 2))
    return law, searched(model, *records)


@pytest.mark.slow
@pytest.mark.parametrize("name", list(HIDDEN))
def test_a_table_beside_a_joint_is_found_and_enters_the_model(name):
    law, found = hidden_law(name)
    _, _, size, quantity = HIDDEN[name]
    curve = found.curves[0]
    assert (curve.at, curve.quantity, curve.of, curve.kind) == (law.at, quantity, "angle", "law")
    assert "it is no part of the model" not in curve.says
    assert found.added is not None
    added = found.added.arm.effect("tabulated_law", law.at)
    assert isinstance(added, TabulatedLaw)
    assert (added.quantity, added.of, added.direction) == (law.quantity, law.of, law.direction)
    assert curve.held_out.after_rms < 0.2 * curve.held_out.before_rms
    rest = np.array(curve.value) - law(np.array(curve.x))
    rest -= rest.mean()  # frames and clocks imitate a constant
    assert np.abs(rest).max() < 0.2 * size
