"""A clock or a frame that several records name is one, also where nothing is stated of it."""

import numpy as np
import pytest
from arms import crane, smooth_step, tracker

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.diagnosis.cross_validation import folds
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.problem import Problem
from flexarm.effects import JointCompliance
from flexarm.errors import InvalidParameter
from flexarm.measurement import ClockError, Registration
from flexarm.record import Clock, Frame

LATE = 1000.331
AWAY = Registration(origin=(4.0, 0.0, 1.0), rpy=(0.0, 0.02, 0.0))
OPEN = Clock(unknown=True), Frame(unknown=True)
PLC = {"joint": "hinge", "clock": "plc"}
SENSORS = [
    Sensor(name="hinge", quantity="joint_angle", rate_hz=100, noise_std=1.5e-6, **PLC),
    Sensor(name="torque", quantity="motor_torque", side="output", rate_hz=20, noise_std=2.0, **PLC),
    tracker("tip", noise=5e-5),
]


@pytest.fixture(scope="module")
def machine():
    return crane(effects=[]).with_effect(JointCompliance(at="hinge", stiffness=1.4e5, damping=280.0))


@pytest.fixture(scope="module")
def record(machine):
    """Swings of 8 s seen by a tracker whose clock and frame nobody knows."""

    def made(rate, seed, late=LATE, known=OPEN, swing=0.5):
        t = np.arange(0, 8, 0.01)
        angle = swing * np.sin(2 * np.pi * rate * t) * smooth_step(t / 3)
        run = flexarm.simulate(machine, flexarm.Drive.from_samples(t, {"hinge": angle}), step=4e-3)
        return flexarm.measure(
            run,
            SENSORS,
            np.random.default_rng(seed),
            drive=["hinge"],
            clocks={"plc": Clock(), "tracker": known[0]},
            frames={"tracker": known[1]},
            clock_errors={"tracker": ClockError(delay=late)},
            registrations={"tracker": AWAY},
        )

    return made


def test_one_offset_and_one_frame_explain_all_records(machine, record):
    """Guessed for each record, the offsets were 20 ms apart, hundreds of sigmas of a swing."""
    problem = Problem(machine, {"a": record(0.15, 1), "b": record(0.23, 2)}, step=4e-3)
    a, b = problem.placement.values()
    assert a.clocks["tracker"] == b.clocks["tracker"]
    assert a.clocks["tracker"].delay == pytest.approx(LATE, abs=1e-2)  # fits go on from here
    assert a.frames["tracker"] is b.frames["tracker"]
    point = np.array([[0.5, 0.0, 2.0]])
    assert a.frames["tracker"].positions(point) == pytest.approx(AWAY.positions(point), abs=5e-3)
    estimator = Estimator.nominal(problem, nuisance_model(problem))
    fit = estimator.fit(())
    assert estimator.about(fit).fit(()).cost == pytest.approx(len(problem), rel=0.2)


def test_what_one_record_states_is_where_all_begin(machine, record):
    known = record(0.15, 1, known=(Clock(offset=LATE, sigma=1e-3), Frame(xyz=AWAY.origin, rpy=AWAY.rpy)))
    problem = Problem(machine, {"a": known, "b": record(0.23, 2)}, step=4e-3)
    a, b = problem.placement.values()
    assert a.clocks["tracker"] == b.clocks["tracker"] == ClockError(delay=LATE)
    assert a.frames["tracker"] == b.frames["tracker"]


def test_a_clock_that_was_set_anew_needs_a_name_of_its_own(machine, record):
    with pytest.raises(InvalidParameter, match=r"clocks\.tracker: cannot have one offset in all 2 records"):
        Problem(machine, {"a": record(0.15, 1), "b": record(0.23, 2, late=0.0)}, step=4e-3)


def test_blocks_of_time_hold_all_signals_whatever_their_clocks_say(machine, record):
    """By raw stamps, 1000 s apart, all of the torque was one block and all of the tip another."""
    problem = Problem(machine, {"a": record(0.15, 1)}, step=4e-3)
    found = folds(problem)
    assert len(found) == SelectionPolicy.blocks
    signal_of = np.concatenate([np.full(len(row.time), row.signal) for row in problem.rows])
    for block in found:
        assert set(signal_of[block]) == {"tip", "torque"}


def test_a_record_that_hardly_moves_is_dated_by_the_others(machine, record):
    """By itself the noise of a tracker that sees nothing move would put it anywhere."""
    problem = Problem(machine, {"still": record(0.15, 1, swing=1e-6), "b": record(0.23, 2)}, step=4e-3)
    assert problem.placement["still"].clocks["tracker"].delay == pytest.approx(LATE, abs=1e-2)
