"""Residuals of motions: what is simulated and read for them, and how exact their derivatives are."""

import gc
import weakref
from dataclasses import replace

import numpy as np
import pytest
from arms import TUBE, beam, hinge, point, rigid, tracker
from planted import run_of

import flexarm
from flexarm.arm.parameter import with_value
from flexarm.arm.sensor import Sensor
from flexarm.comparison.simulated_record import SimulatedRecord
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.screening import probe
from flexarm.diagnosis.simulation_cache import SimulationCache
from flexarm.effects import Backlash, EncoderScale, SensorOffset
from flexarm.measurement.slopes import predict_slopes
from flexarm.record import Clock, Frame

MODULUS = "links.rod.material.youngs_modulus"


@pytest.fixture
def run():
    """Half a minute of an arm of one joint that swings on at 2.4 Hz."""
    return run_of("one joint")


def problem(run, step):
    return Problem(run.simulation.arm, {"run": run.record}, step=step)


def test_what_an_imperfect_sensor_shows_costs_no_run_and_no_reading_of_the_others(run, monkeypatch):
    there = problem(run, 4e-3)
    arm = run.simulation.arm
    before, made = there.residual(arm), there.simulations.made
    read, plain = [], SimulatedRecord.residual

    def spied(self, signal, *given, **named):
        read.append(signal.name)
        return plain(self, signal, *given, **named)

    monkeypatch.setattr(SimulatedRecord, "residual", spied)
    after = there.residual(arm.with_effect(SensorOffset(at="tip", offset=(1e-3, 0.0, 0.0))))
    assert (there.simulations.made, read) == (made, ["tip"])
    moved = {row.signal for row in there.rows if not np.array_equal(before[row.where], after[row.where])}
    assert moved == {"tip"}


@pytest.mark.parametrize("step", [4e-3, 8e-3])
def test_derivatives_of_a_long_swing_are_those_of_the_equations(run, step):
    """Newton's iterations stop 1e-7 m apart, half a percent of 3e-4 of the modulus at the longer step."""
    there, arm = problem(run, step), run.simulation.arm
    found = there.jacobian(arm, [MODULUS])[:, 0]
    drive = there.simulations.drive("run", arm)
    simulation = flexarm.simulate(
        arm, drive, step=step, alpha=there.alpha, rotations=True, sensitivities=[MODULUS]
    )
    exact = np.zeros(len(there))
    for row in there.rows:
        signal, placement = run.record.signals[row.signal], there.placement["run"]
        jacobian = predict_slopes(simulation, signal, placement.clock(signal), placement.frame(signal))
        exact[row.where] = -jacobian[row.mask, row.channel, 0] / row.sigma
    assert np.linalg.norm(found - exact) < 0.02 * np.linalg.norm(exact)


@pytest.mark.parametrize("step, finest", [(8e-3, 2), (16e-3, 4)])
def test_steps_are_halved_again_where_half_a_step_moves_more_than_the_noise(run, monkeypatch, step, finest):
    """16 ms leave several sigmas of phase after half a minute, 8 ms a quarter of that."""
    there = problem(run, step)
    seen, plain = [], flexarm.simulate
    monkeypatch.setattr(
        "flexarm.simulation.simulate",
        lambda *given, **named: seen.append(named["step"]) or plain(*given, **named),
    )
    there.correction(run.simulation.arm)
    assert min(seen) == pytest.approx(step / finest)


def test_steps_are_halved_again_beside_laws_with_corners(run, monkeypatch):
    there = problem(run, 4e-3)
    steps = []
    monkeypatch.setattr(there, "with_step", lambda step: steps.append(step) or replace(there, step=step))
    there.correction(run.simulation.arm.with_effect(Backlash(at="hinge", gap=1e-3)))
    assert min(steps) == pytest.approx(1e-3)


def test_a_gear_of_another_ratio_is_another_run():
    """A coupling of joints is a part of the mechanics, and its ratio may be uncertain."""
    tables = {"format": "flexarm-arm/1", "gravity": [0, 0, -9.81]}
    tables["joints"] = [hinge("shaft", "rotor"), hinge("hinge", "rod")]
    tables["gears"] = [{"name": "reducer", "input": "shaft", "output": "hinge", "ratio": 120.0}]
    tables["links"] = [rigid("rotor", 1.0, inertia=[1e-3] * 3), beam("rod", [0, 0, 3.0], TUBE)]
    tables["points"] = [point("tip", "rod", [0, 0, 3.0])]
    arm = flexarm.Arm.from_dict(tables)
    t = np.arange(0, 2, 0.01)
    drive = flexarm.Drive.from_samples(t, {"shaft": 120 * 0.3 * np.sin(t) ** 2})
    encoder = {"quantity": "joint_angle", "joint": "shaft", "rate_hz": 100, "noise_std": 1e-5}
    record = flexarm.measure(
        flexarm.simulate(arm, drive, step=0.01),
        [Sensor(name="shaft", clock="plc", **encoder), tracker("tip")],
        np.random.default_rng(1),
        drive=["shaft"],
        clocks={"plc": Clock(), "tracker": Clock()},
        frames={"tracker": Frame()},
    )
    there = Problem(arm, {"run": record}, step=0.01)
    other = with_value(arm, "gears.reducer.ratio", 121.0)
    change = there.residual(other) - there.residual(arm)
    assert np.abs(change).max() > 10


def test_a_reflector_elsewhere_is_probed_without_a_simulation(run):
    """Its moves are those of its point, which are known before as the point is uncertain.

    Their rates are differences of turned sections, which leave 2e-6 between steps.
    """
    key = "points.tip.position_m"
    arm = run.simulation.arm.replace(uncertainty={key: 1e-3})
    there = Problem(arm, {"run": run.record}, step=4e-3)
    estimator = Estimator.nominal(there, nuisance_model(there))
    reflectors = [
        c for c in candidates(there, estimator.nuisance.arm) if c.place == ("reflector_offset", "tip")
    ]
    made = there.simulations.made
    [probed] = probe(estimator, reflectors)
    assert there.simulations.made == made
    for k, effect in enumerate(probed.candidate.probes):
        moved = there.residual(estimator.arm.with_effect(effect)) - there.residual(estimator.arm)
        assert probed.moves[:, k] == pytest.approx(moved, abs=1e-5 * np.abs(moved).max())


def test_a_run_with_rotations_serves_where_none_are_needed(run):
    cache, arm = SimulationCache({"run": run.record}, 0.04, -0.05), run.simulation.arm
    turned = cache.run("run", arm, rotations=True).simulation
    assert cache.run("run", arm).simulation is turned
    alone = SimulationCache({"run": run.record}, 0.04, -0.05).run("run", arm).simulation
    assert np.array_equal(turned.position, alone.position)
    assert (alone.orientation is None, cache.made) == (True, 1)


def test_models_of_a_batch_share_a_drive(run):
    """Runs side by side do; an encoder that drives and reads otherwise makes another drive."""
    arm, [encoder] = run.simulation.arm, run.record.drive
    models = [with_value(arm, MODULUS, (2.0 + 0.01 * k) * 1e11) for k in range(3)]
    models[1:1] = [arm.with_effect(EncoderScale(at=encoder, scale=1.0 + 0.01 * k)) for k in (1, 2)]
    batches = SimulationCache({"run": run.record}, 0.04, -0.05).batches("run", models)
    assert sorted(map(len, batches)) == [1, 1, 3]


def test_runs_of_many_records_are_remembered(run):
    """An effect on a sensor costs no run however many records there are."""
    records = {f"day {k}": run.record for k in range(9)}
    there = Problem(run.simulation.arm, records, step=0.04)
    made = there.simulations.made
    there.residual(run.simulation.arm.with_effect(SensorOffset(at="tip", offset=(1e-3, 0.0, 0.0))))
    assert there.simulations.made == made


def test_runs_in_shorter_steps_fill_no_more_memory(run):
    """Of 133 s a run takes 5 MB in steps of 4 ms, and 21 MB in a quarter of that."""
    arm = run.simulation.arm
    stretched = [with_value(arm, MODULUS, (2.0 + 0.01 * k) * 1e11) for k in range(10)]
    seen = {}
    for step in (0.08, 0.04, 0.02):
        there = SimulationCache({"run": run.record}, 0.04, -0.05).with_step(step)
        each = [weakref.ref(there.run("run", arm).simulation) for arm in stretched]
        gc.collect()
        seen[step] = sum(ref() is not None for ref in each)
    assert seen == {0.08: 8, 0.04: 8, 0.02: 4}
    many = SimulationCache({f"day {k}": run.record for k in range(9)}, 0.04, -0.05).with_step(0.01)
    for name in 2 * list(many.records):
        many.run(name, arm)
    assert many.made == 9
