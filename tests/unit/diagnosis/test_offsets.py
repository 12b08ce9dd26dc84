"""How far a sensor's zero may be off, as the records say."""

import numpy as np
import pytest
from planted import run_of

from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.problem import Problem


def test_the_zero_of_a_sensor_may_be_off_by_a_part_of_what_it_reads():
    """Newton metres of a torque and metres of a deflection have no range in common."""
    run = run_of("one joint")
    record = run.showing({}, 1).record
    problem = Problem(run.simulation.arm, {"run": record})
    torque = next(s for s in record.signals.values() if s.quantity == "motor_torque")
    found = next(c for c in candidates(problem, problem.arm) if c.place == ("sensor_offset", torque.name))
    prior = found.priors_in(problem.arm)["offset"]
    assert prior.high == pytest.approx(0.1 * np.nanmax(np.abs(torque.values)))
    assert (prior.low, prior.typical) == (-prior.high, 0.0)
    assert prior.unit == torque.unit == "N m"
    assert found.free == ("offset",)
