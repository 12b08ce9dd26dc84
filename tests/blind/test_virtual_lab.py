"""Records of the chain of rods, read by flexarm: only what was hidden is left in the gap."""

from dataclasses import replace

import numpy as np
import pytest
from arms import EI, LENGTH, PAYLOAD, RHO_A, paper_arm
from chain import Link
from hub import Hub
from motion import Arm
from swings import Swing
from virtual_lab import Lab, Nuisances, record

import flexarm
from flexarm.effects import Backlash

LAB = Lab()
SWING = Swing(0.6, 5.0, 3.0)
HUB = Hub(stiffness=1e5, damping=200.0)
RODS = Arm(Link(LENGTH, EI, RHO_A, mass=PAYLOAD), HUB)


def nominal() -> flexarm.Arm:
    """flexarm's model of the same arm, without what is hidden."""
    arm = paper_arm(4, 1e5)
    return arm.with_effect(arm.effects[0].model_copy(update={"damping": 200.0}))


@pytest.fixture(scope="module")
def nuisances() -> Nuisances:
    return Nuisances.drawn(LAB, np.random.default_rng(11))


def lab_record(arm: Arm, nuisances: Nuisances, **options: object) -> flexarm.Record:
    return record(arm, SWING, 10.0, np.random.default_rng(7), LAB, nuisances, **options)


def test_of_an_arm_without_a_secret_the_noise_is_left(nuisances):
    """Clock and frame are aligned; rms over both axes within 15 % of the noise (a hundred instants)."""
    found = flexarm.compare(nominal(), lab_record(RODS, nuisances))
    assert found.skipped == {}
    gap = found.signals["tip"]
    assert gap.rms["total"] == pytest.approx(gap.noise_rms, rel=0.15)


def test_alignment_finds_what_was_true_of_the_tracker(nuisances):
    """Without it the gap is many times the noise: the record does hold a delay and a registration."""
    readings = lab_record(RODS, nuisances).signals["tip"]
    plain = lab_record(RODS, Nuisances()).signals["tip"]
    good = readings.valid
    assert np.array_equal(good, plain.valid)
    assert 0.0 < 1 - good.mean() < 0.1
    assert readings.time - plain.time == pytest.approx(nuisances.delay)
    c, s = np.cos(nuisances.turn), np.sin(nuisances.turn)
    x, z = plain.values[good].T
    turned = np.column_stack([c * x + s * z, c * z - s * x]) + nuisances.shift
    assert np.abs(turned - readings.values[good]).max() < 10 * LAB.tracker * abs(nuisances.turn) + 1e-9


@pytest.mark.slow
def test_a_hidden_gap_shows_and_its_effect_closes_it(nuisances):
    """Backlash of 6e-4 rad: ten times the noise without the effect, the noise with it."""
    hidden = lab_record(replace(RODS, hub=replace(HUB, gap=6e-4)), nuisances, torque=False)
    before = flexarm.compare(nominal(), hidden).signals["tip"]
    after = flexarm.compare(nominal().with_effect(Backlash(at="hinge", gap=6e-4)), hidden).signals["tip"]
    assert before.rms["total"] > 5 * before.noise_rms
    assert after.rms["total"] == pytest.approx(after.noise_rms, rel=0.15)


def test_a_seed_gives_one_record(nuisances):
    """And another seed another one."""
    one, two = (record(RODS, SWING, 1.0, np.random.default_rng(5), LAB, nuisances) for _ in range(2))
    assert one == two
    assert one != record(RODS, SWING, 1.0, np.random.default_rng(6), LAB, nuisances)


def test_the_record_is_a_file_like_any_other(nuisances, tmp_path):
    """Saved and loaded it is the same; the model knows all its names."""
    arm = nominal()
    kept = record(RODS, SWING, 1.0, np.random.default_rng(5), LAB, nuisances)
    kept.save(tmp_path / "run")
    assert flexarm.Record.load(tmp_path / "run").check_against(arm) == []
