"""Missing laws of a joint from poses, whose equilibria are solved by hand for two rigid links in a plane."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from arms import arm, compliance, hinge, point, rigid
from numpy.typing import NDArray

import flexarm
from flexarm.comparison.alignment_parameters import stated_placement
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.verification import SplitRecords
from flexarm.missing_law.latent import latent_motions
from flexarm.missing_law.policy import LawPolicy
from flexarm.missing_law.prediction import LawCheck
from flexarm.missing_law.search import MissingLaws, missing_laws, not_inferred
from flexarm.missing_law.states import joint_states
from flexarm.record import Record, Signal

Floats = NDArray[np.float64]

UPPER, FORE = 2.0, 1.5
MASSES = (30.0, 20.0, 10.0)
"""Of the upper arm, the forearm, whose centres are in their middle, and the load at the tip [kg]."""
STIFFNESS = (8e4, 5e4)
NOISE = 1e-4
PEAK = 2e-3

LAWS: dict[str, Callable[[Floats, Floats], Floats]] = {
    "torque": lambda torque, angle: -PEAK * np.tanh(torque / 150.0),
    "angle": lambda torque, angle: PEAK * np.sin(3.0 * angle),
}
"""Hidden windups of the shoulder: a coupling that gives way early, a pulley that is not round."""


def nominal(**more: object) -> flexarm.Arm:
    """Two links on springs, upright at 0."""
    return arm(
        name="two links",
        gravity=[0, 0, -9.81],
        joints=[
            hinge("shoulder", "upper", gear_ratio=100),
            hinge("elbow", "fore", "upper", origin={"xyz": [0, 0, UPPER], "rpy": [0, 0, 0]}, gear_ratio=100),
        ],
        links=[
            rigid("upper", MASSES[0], [0, 0, UPPER / 2], [1, 1, 0.1]),
            rigid("fore", MASSES[1], [0, 0, FORE / 2], [1, 1, 0.1]),
        ],
        payloads=[{"name": "load", "link": "fore", "position": [0, 0, FORE], "mass": MASSES[2]}],
        points=[point("tip", "fore", [0, 0, FORE])],
        effects=[compliance(joint, k) for joint, k in zip(("shoulder", "elbow"), STIFFNESS, strict=True)],
        **more,
    )


def weight(theta: Floats) -> Floats:
    """Moments of gravity about both joints, shape (n, 2), that turn them on [N m]."""
    g = 9.81
    elbow = UPPER * np.sin(theta[:, 0])
    out = FORE * np.sin(theta.sum(axis=1))
    fore = g * out * (MASSES[1] / 2 + MASSES[2])
    return np.column_stack([g * elbow * (MASSES[0] / 2 + MASSES[1] + MASSES[2]) + fore, fore])


def record(law: Callable[[Floats, Floats], Floats], count: int, seed: int) -> Record:
    """Random poses with a hidden windup w of the shoulder: iterate theta = phi + w + M/k."""
    rng = np.random.default_rng(seed)
    phi = rng.uniform(-1.3, 1.3, (count, 2))
    theta = phi.copy()
    for _ in range(200):
        moment = weight(theta)
        theta = phi + moment / STIFFNESS
        theta[:, 0] += law(-moment[:, 0], theta[:, 0])
    sums = np.cumsum(theta, axis=1)
    tip = np.column_stack([f(sums) @ [UPPER, FORE] for f in (np.sin, np.cos)])
    names = np.array([f"p{k}" for k in range(count)])
    drives = [
        Signal(name=joint, quantity="joint_angle", joint=joint, side="motor", pose=names, values=column)
        for joint, column in zip(("shoulder", "elbow"), phi.T, strict=True)
    ]
    seen = Signal(
        name="tip",
        quantity="position",
        point="tip",
        axes=("x", "z"),
        pose=names,
        values=tip + NOISE * rng.standard_normal(tip.shape),
        noise_std=NOISE,
    )
    return Record(kind="static", drive=("shoulder", "elbow"), signals=[*drives, seen])


@cache
def found(of: str) -> MissingLaws:
    law = LAWS.get(of, lambda torque, angle: 0 * torque)
    return found_of(law, law)


def found_of(law: Callable[..., Floats], other: Callable[..., Floats]) -> MissingLaws:
    """What is missing of two records, where the one held out has another law."""
    return found_in(record(law, 60, 1), record(law, 60, 2), record(other, 60, 3))


def found_in(first: Record, second: Record, last: Record) -> MissingLaws:
    """What is missing of two records, where the last one is held out."""
    training, held_out = {"a": first, "b": second}, {"c": last}
    problem = Problem(nominal(), training, jobs=1)
    estimator = Estimator.nominal(problem, nuisance_model(problem))
    check = LawCheck(SplitRecords(training, held_out, 2e-3, -0.05, 1), nominal(), nominal(), "tip")
    return missing_laws(estimator, [estimator.fit(())], check)


@pytest.mark.slow
@pytest.mark.parametrize("of", list(LAWS))
def test_a_law_of_poses_is_the_hidden_one_and_closes_the_held_out_gap(of):
    laws = found(of)
    best = next(each for each in laws.curves if each.quantity == "windup")
    assert (best.at, best.of, best.kind) == ("shoulder", of, "law")
    x = np.array(best.x)
    expected = LAWS[of](x, x)
    seen = (x > np.quantile(best.cloud_x, 0.02)) & (x < np.quantile(best.cloud_x, 0.98))
    assert np.abs(np.array(best.value) - expected)[seen].max() < 0.1 * PEAK
    inside = (np.array(best.low90) <= expected) & (expected <= np.array(best.high90))
    assert inside[seen].mean() > 0.8
    assert best.held_out.before_rms > 10 * best.held_out.noise_rms
    assert best.held_out.after_rms == pytest.approx(best.held_out.noise_rms, rel=0.15)
    assert laws.added is not None
    assert laws.added.arm.effect("tabulated_law", "shoulder") is not None


def test_a_law_of_poses_that_no_table_holds_tells_the_gap_that_it_closes():
    """A shoulder that the motor of the elbow turns along, by 4 mrad/rad, as through a common hub."""

    def coupled(seed: int) -> Record:
        one = record(lambda torque, angle: 0 * torque, 60, seed)
        shoulder, elbow = (one.signals[name] for name in one.drive)
        read = shoulder.replace(values=shoulder.values - 4e-3 * elbow.values)
        return one.replace(signals={**one.signals, "shoulder": read})

    laws = found_in(coupled(1), coupled(2), coupled(3))
    curve = next(each for each in laws.curves if each.quantity == "windup")
    assert (curve.at, curve.of, curve.kind) == ("shoulder", "angle of elbow", "law")
    for gap in (curve.train, curve.held_out):
        assert gap.before_rms > 20 * gap.noise_rms
        assert gap.after_rms < 0.05 * gap.before_rms


def test_poses_without_a_hidden_law_have_none_and_say_so():
    assert found("nothing").curves == ()
    assert found("nothing").why.startswith("no missing law was found: no motion of a joint")


@pytest.mark.slow
def test_a_law_with_which_the_held_out_gap_grows_is_none():
    """The records that are held out have the opposite windup."""
    laws = found_of(LAWS["angle"], lambda torque, angle: -LAWS["angle"](torque, angle))
    assert laws.added is None
    shoulder = [each for each in laws.curves if each.at == "shoulder"]
    assert shoulder and all(each.kind == "none" for each in shoulder)
    assert all("but with it the held-out gap grows" in each.says for each in shoulder)


def test_a_joint_that_stands_still_has_no_law_over_its_angle():
    """Its link's angle is the windup itself, which would be one radian per radian."""
    one = record(LAWS["torque"], 60, 1)
    shoulder = one.signals["shoulder"]
    still = shoulder.replace(values=np.full_like(shoulder.values, 0.3))
    elbow = one.replace(signals={**one.signals, "shoulder": still})
    seen = Problem(nominal(), {"a": elbow}, jobs=1).simulations.run("a", nominal())
    tip = one.signals["tip"]
    loads = np.random.default_rng(0).normal(0, 1e-3, tip.values.shape)
    moved = tip.replace(values=seen.predicted(tip, stated_placement(elbow)) + loads)
    problem = Problem(nominal(), {"a": elbow.replace(signals={**elbow.signals, "tip": moved})}, jobs=1)
    fit = Estimator.nominal(problem, nuisance_model(problem)).fit(())
    latent = next(each for each in latent_motions(problem, fit, LawPolicy()) if each.at == "shoulder")
    assert set(joint_states(latent, LawPolicy()).values) == {"torque"}


def test_a_record_that_turns_no_motor_is_told():
    one = record(LAWS["angle"], 5, 1)
    at_link = {name: one.signals[name].replace(side="output") for name in one.drive}
    one = one.replace(signals={**one.signals, **at_link})
    problem = Problem(nominal(), {"a": one}, jobs=1)
    assert not_inferred(problem, nominal()) == (
        "no missing law was sought: a turns no joint by the angle of its motor"
    )
