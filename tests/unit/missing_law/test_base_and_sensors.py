"""Latent rotations of the base and offsets of sensors, whose responses are exact."""

from __future__ import annotations

from dataclasses import replace

import hidden_causes
import numpy as np
import pytest
from hidden_pendulum import LENGTH, Study, nominal

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.problem import Problem
from flexarm.missing_law.latent import Latent, _offset, latent_motions, offset_evidence_bound
from flexarm.missing_law.policy import LawPolicy
from flexarm.missing_law.slow import slow_places

QUICK = LawPolicy(spacing=0.5)
"""Coarser than the default: these motions are slow."""


def wave(t):
    """At rest when records begin, as a windup that excites no mode."""
    return 1e-3 * (1 - np.cos(0.7 * t)) / 2


def turned(t, tip):
    """Rotate x and z about y."""
    c, s = np.cos(wave(t)), np.sin(wave(t))
    return np.column_stack([c * tip[:, 0] + s * tip[:, 1], c * tip[:, 1] - s * tip[:, 0]])


def problems(moved) -> tuple[Problem, Problem]:
    """Return records of the nominal arm, and the same with readings of the tip that are moved."""
    records = Study.of(hidden_causes.NOTHING.cause, 3, noise_alone=True).records
    other = {}
    for name, record in records.items():
        signals = [
            each.replace(values=moved(each.time, each.values)) if each.name == "tip" else each
            for each in record.signals.values()
        ]
        other[name] = replace(record, signals=signals)
    return tuple(Problem(nominal(), each, step=8e-3, jobs=1) for each in (records, other))


def latents(problem: Problem) -> dict[tuple[str, str], Latent]:
    fit = Estimator.nominal(problem, nuisance_model(problem)).fit(())
    return {(each.at, each.quantity): each for each in latent_motions(problem, fit, QUICK)}


def test_the_response_to_a_rotation_of_the_base_is_that_of_rotated_readings():
    """Gravity, which does not turn, gives the spring 0.8 % more; the splines are 0.5 s apart."""
    before, after = problems(turned)
    (motion,) = next(slow_places(before, nominal(), QUICK))
    response = motion.response(before, QUICK)
    assert (motion.at, motion.direction) == ("base", "about y")
    c = np.concatenate([basis.nearest(basis.places, wave(basis.places)) for basis in response.bases.values()])
    expected = before.residual(nominal()) - after.residual(nominal())
    assert np.linalg.norm(response.jacobian @ c - expected) < 0.015 * np.linalg.norm(expected)


def test_a_rotation_of_the_base_is_found_and_is_the_windup_of_the_first_joint():
    """One reflector on a hinge: both places explain alike."""
    found = latents(problems(turned)[1])
    base, hinge = found["base", "rotation about y"], found["hinge", "windup"]
    assert base.model.log_evidence == pytest.approx(hinge.model.log_evidence, abs=0.01 * base.gain)
    m = len(base.bases[0])
    motion = base.bases[0].at(base.bases[0].places) @ base.mean[:m]
    expected = wave(base.bases[0].places)
    rest = motion - expected
    assert np.abs(rest - rest.mean()).max() < 0.1 * np.abs(expected).max()


def test_places_that_explain_alike_are_both_shown_and_none_enters_the_model():
    laws = Study.of(hidden_causes.warming().cause, 1).laws(QUICK)
    assert {(each.at, each.quantity) for each in laws.curves} == {
        ("hinge", "windup"),
        ("base", "rotation about y"),
    }
    assert sum(each.probability for each in laws.curves) == pytest.approx(1.0)
    assert laws.added is None


def test_a_law_that_enters_the_model_stands_before_places_that_explain_alike():
    """A base that rocks with the torque does what the hinge does."""
    laws = Study.of(hidden_causes.softening().cause, 1).laws()
    assert [(each.at, each.of, each.kind) for each in laws.curves] == [
        ("hinge", "torque", "law"),
        ("base", "torque", "law"),
    ]
    assert laws.curves[1].says.endswith(
        "with the torque of hinge; it is no part of the model, which has no table of the torque there"
    )
    assert laws.curves[0].probability > 0.5


def test_an_offset_that_cannot_come_near_the_likeliest_joint_is_left_out():
    """The tip shows more of the windup of a soft joint than what clocks and frames explain."""
    arm = nominal()
    middle = arm.points[0].replace(name="mid", position=(0, 0, LENGTH / 2))
    arm = arm.replace(points=(*arm.points, middle))
    t = np.arange(0, 20.001, 0.02)
    drive = flexarm.Drive.from_samples(t, {"hinge": 0.4 * np.sin(t) ** 2})
    soft = arm.with_effect(arm.effect("joint_compliance", "hinge").with_parameters({"stiffness": 1e5}))
    sensors = [
        Sensor(name="motor", quantity="joint_angle", joint="hinge", side="motor", rate_hz=50, noise_std=1e-6)
    ] + [
        Sensor(name=name, quantity="position", point=name, axes=("x", "z"), rate_hz=10, noise_std=4e-5)
        for name in ("tip", "mid")
    ]
    run = flexarm.simulate(soft, drive, step=8e-3)
    record = flexarm.measure(run, sensors, np.random.default_rng(0), drive=["motor"])
    problem = Problem(arm, {"run": record}, step=8e-3, jobs=1)
    fit = Estimator.nominal(problem, nuisance_model(problem)).fit(())
    found = {each.at: each.model.log_evidence for each in latent_motions(problem, fit, QUICK)}
    assert "mid" not in found
    assert offset_evidence_bound("mid", problem, fit) < found["hinge"] - problem.policy.reach
    for signal in ("tip", "mid"):
        evidence = _offset(signal, problem, fit, QUICK).model.log_evidence
        assert evidence < offset_evidence_bound(signal, problem, fit)


def test_the_offset_of_a_sensor_has_the_sign_of_its_readings():
    """Along the link, where no rotation moves the tip; frames hide a constant."""

    def along(t, tip):
        return tip * (1 + wave(t) / LENGTH)[:, None]

    found = latents(problems(along)[1])
    offset = found["tip", "offset"]
    assert offset.gain > max(each.gain for each in found.values() if each is not offset) + 6
    basis = offset.bases[1]  # z, which the upright arm shows
    first = len(offset.bases[0])
    motion = basis.at(basis.places) @ offset.mean[first : first + len(basis)]
    assert np.corrcoef(motion, wave(basis.places))[0, 1] > 0.9
