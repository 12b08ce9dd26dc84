"""Development cases whose cause is a sensor or a clock, with the effect that their answers state."""

import json

import pytest

from flexarm import Arm, Record, compare
from flexarm.effects import SignError, TimeDelay


@pytest.fixture(scope="module")
def case(shared_dir):
    def load(number):
        folder = shared_dir / "cases" / f"case_{number:02d}"
        answer = json.loads((shared_dir / "cases/answers" / f"case_{number:02d}.json").read_text())
        records = {name: Record.load(folder / name) for name in ("train_a", "train_b", "held_out")}
        return Arm.from_toml(folder / "model.toml"), records, answer

    return load


def with_true_values(arm, nuisances):
    """The model with the values that the simulated arm had: modulus, mass, places of the reflectors."""
    tables = arm.to_dict()
    for link in tables["links"]:
        link["material"]["youngs_modulus"] *= 1 + nuisances["E"]
    for load in tables["payloads"]:
        load["mass"] *= 1 + nuisances["mass"]
    for place in tables["points"]:
        place["position"][0] += nuisances[f"{place['name']}.x"]
        place["position"][2] += nuisances[f"{place['name']}.z"]
    return Arm.from_dict(tables)


def test_a_late_tracker_with_its_delay_leaves_the_gap_of_an_independent_simulator(case):
    """Tip rms of the held-out record: aligned within 0.1 % (found 0.005 %), in time alone within 0.5 %.

    The tracker's clock is 14 ms late where 2 ms are stated. The effect takes that up, so that the alignment
    has nothing left to move beyond its sigmas; taken raw, the gap is that of the registration alone.
    """
    arm, records, answer = case(10)
    delay = answer["effects"][0]["parameters"][0]["value"]
    late = arm.with_effect(TimeDelay(at="tracker", delay=delay))
    record, floor = records["held_out"], answer["held_out"]
    found = compare(late, record)
    for direction in ("tangential", "radial", "total"):
        rms = found.signals["tip"].rms[direction]
        assert rms == pytest.approx(floor["floor_nominal"][direction], rel=1e-3)
    assert not any("moved further" in note for note in found.notes)
    assert any("delay of tracker (7 sigma)" in note for note in compare(arm, record).notes)
    true = with_true_values(late, answer["nuisances"])
    raw = compare(true, record, align=False).signals["tip"]
    assert raw.rms["total"] == pytest.approx(floor["floor_unaligned"]["total"], rel=5e-3)


@pytest.mark.parametrize("name", ["train_a", "train_b", "held_out"])
def test_a_flipped_channel_with_its_sign_leaves_the_noise(case, name):
    """With the arm's true values every reflector's total is its noise, to 6 % (700 numbers: 2.7 %).

    With nominal values the tip, 19 000 times its noise before, is within a few of it, as the other two are.
    """
    arm, records, answer = case(15)
    flipped = arm.with_effect(SignError(at=answer["effects"][0]["at"], channels=("x",)))
    true = compare(with_true_values(flipped, answer["nuisances"]), records[name])
    nominal = compare(flipped, records[name])
    for signal in ("tip", "mid", "hub"):
        gap = true.signals[signal]
        assert gap.rms["total"] == pytest.approx(gap.noise_rms, rel=0.06)
        assert nominal.signals[signal].rms["total"] < 15 * gap.noise_rms
    assert not any("moved further" in note for note in nominal.notes)
