"""Examples with closed loops beside virtual records of machines that hide something."""

import pytest
from loop_examples import EXAMPLES_IN_MOTION

import flexarm


def test_a_dry_pin_of_an_excavator_is_named():
    """From one motion, with a quicker one held out; the parallelogram is diagnosed on its page."""
    example = EXAMPLES_IN_MOTION["excavator"]
    hidden = example.hidden(example.arm)
    found = example.diagnosed()
    assert found.verdict == "effects"
    [effect] = found.effects
    assert (effect.name, effect.at) == (hidden.name, hidden.at)
    [size] = effect.parameters
    assert size.value == pytest.approx(hidden.value_of(size.name), abs=3 * size.std)


@pytest.mark.parametrize("name", EXAMPLES_IN_MOTION)
def test_what_a_machine_hides_shows_in_its_record(name):
    """By ten times the noise of the tracker or of a force; the record closes the loop of the model."""
    example = EXAMPLES_IN_MOTION[name]
    gaps = flexarm.compare(example.arm, example.record(example.machine, 5, step=2e-3), step=2e-3).signals
    assert max(gap.rms["total"] / gap.noise_rms for gap in gaps.values()) > 10
