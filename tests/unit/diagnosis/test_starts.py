"""Where fits start, and that a start far off stops nothing."""

import pytest
from planted import run_of

from flexarm.arm.spring_effect import SpringEffect
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.nuisance import NuisanceParameter, nuisance_model
from flexarm.diagnosis.problem import Problem


@pytest.mark.parametrize(
    ("centre", "sigma", "step", "kept"),
    [
        (2.0, 0.5, -1.0, -1.0),
        (2.0, 0.5, -3.0, -1.6),
        (-2.0, 0.5, 3.0, 1.6),
        (2.0, 0.5, 9.0, 9.0),
        (0.0, 0.5, -3.0, -3.0),
        (0.1, 0.5, -3.0, -3.0),
    ],
)
def test_a_value_known_to_less_than_itself_keeps_its_sign(centre, sigma, step, kept):
    """Down to a fifth of it; a place that may lie on either side of zero goes where it wants."""
    assert NuisanceParameter("links.rod.density", centre, sigma, "kg/m3", "nominal").limited(
        step
    ) == pytest.approx(kept)


def test_a_clock_goes_where_it_wants():
    assert NuisanceParameter("effects.time_delay.clock.delay", 1e-3, 1e-4, "s", "clock").limited(-1.0) == -1.0


def test_a_spring_that_the_model_lacks_starts_at_several_stiffnesses():
    arm = run_of("one joint").simulation.arm
    arm = arm.replace(effects=tuple(e for e in arm.effects if e.name != "joint_compliance"))
    problem = Problem(arm, {"run": run_of("one joint").showing({}, 1).record})
    found = candidates(problem, nuisance_model(problem).arm, softer=SpringEffect.softer)
    springs = [c for c in found if c.name == "joint_compliance"]
    stiffness = [c.probes[0].value_of("stiffness") for c in springs]
    assert [stiffness[0] / k for k in stiffness] == pytest.approx(SpringEffect.softer)
    assert all("stiffness" in c.free for c in springs)


def test_a_bow_that_grows_starts_at_several_time_constants():
    """Each is fitted from there; a probe grows as its start does, so that its size is what is asked for."""
    problem = Problem(run_of("one joint").simulation.arm, {"run": run_of("one joint").showing({}, 1).record})
    bows = [c for c in candidates(problem, nuisance_model(problem).arm) if c.name == "link_bow"]
    assert [c.effect.value_of("time_constant") for c in bows] == [0.0, 10.0, 100.0]
    assert ["time_constant" in c.free for c in bows] == [False, True, True]
    for bow in bows:
        assert len(bow.probes) == 2  # across the rod
        assert {p.value_of("time_constant") for p in bow.probes} == {bow.effect.value_of("time_constant")}
        sized = bow.sized([2.0, 0.0])
        assert sized.value_of("tip_offset.x") == pytest.approx(2 * bow.probes[0].value_of("tip_offset.x"))
        assert sized.value_of("time_constant") == bow.effect.value_of("time_constant")
