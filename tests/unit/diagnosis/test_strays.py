"""Outliers that a gap had hidden: left out where the verdict hangs on them, and only there."""

from dataclasses import dataclass
from types import SimpleNamespace

import diagnoses
import numpy as np
import pytest
from posed import changed

import flexarm
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.hold_out import masked_outliers, outlier_remarks, residual_outliers
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.residual_rows import Rows, rows_left

N = 400
RNG = np.random.default_rng(3)
GAP = 20.0 * np.sin(0.05 * np.arange(N))


@dataclass
class Left:
    """As much of a fit as strays ask for."""

    projected: np.ndarray
    non_smooth: bool = False


class Channel:
    """As much of `Problem`: one channel of one record."""

    policy = SelectionPolicy()

    def __init__(self, kind="motion", quantity="position"):
        self.row = Rows("run", "tip", 0, slice(0, N), np.ones(N, dtype=bool), 1.0, np.arange(N))
        signals = {"tip": SimpleNamespace(quantity=quantity)}
        self.records = {"run": SimpleNamespace(kind=kind, signals=signals)}

    def __len__(self):
        return N

    def channels(self):
        return [(self.row, self.row.where)]


def spoiled(share, size, seed=3):
    """White noise, and some rows that are so many times as far off; which ones."""
    rng = np.random.default_rng(seed)
    out = rng.random(N) < share
    return rng.normal(size=N) + size * out * rng.choice([-1.0, 1.0], N), out


def test_rows_that_stand_alone_in_noise_are_strays():
    """Twelve sigmas beside noise of one are at least nine off; of two neighbours one may hide the other."""
    values, out = spoiled(0.05, 12.0)
    found = residual_outliers(values, Channel())
    assert not (found & ~out).any()
    assert found[out].mean() > 0.8


def test_noise_has_no_strays_and_noise_that_is_larger_than_stated_has_none():
    """A hundred records; by (1) of the module one row in ten millions is one."""
    for times in (1.0, 5.0):
        for _ in range(50):
            assert not residual_outliers(times * RNG.normal(size=N), Channel()).any()


def test_what_rings_for_some_rows_and_what_most_rows_do_is_no_stray():
    ringing = 30.0 * np.exp(-((np.arange(N) - 200) ** 2) / 200.0) * np.cos(2.4 * np.arange(N))
    assert not residual_outliers(RNG.normal(size=N) + ringing, Channel()).any()
    often = RNG.normal(size=N) + 30.0 * (np.arange(N) % 6 == 0)
    assert not residual_outliers(often, Channel()).any()


def test_poses_follow_no_order_and_have_none():
    assert not residual_outliers(spoiled(0.05, 12.0)[0], Channel("static")).any()


@pytest.mark.parametrize("quantity", ["torque", "acceleration", "strain"])
def test_what_jumps_by_itself_must_be_beyond_all_else(quantity):
    """Teeth that strike show in single samples of a torque and are a gap; a broken word is far beyond."""
    values, _ = spoiled(0.05, 8.0)
    assert residual_outliers(values, Channel()).any()
    assert not residual_outliers(values, Channel(quantity=quantity)).any()
    values[200] = 400.0
    assert np.flatnonzero(residual_outliers(values, Channel(quantity=quantity))).tolist() == [200]


def test_strays_that_make_a_gap_are_left_out():
    """A fifteenth of the rows thirty sigmas off: their chance correlation is above the noise."""
    values, out = spoiled(0.07, 30.0)
    channel, null = Channel(), Left(values + GAP)
    assert Criteria(channel, null).leaves_gap(Left(values))
    found = masked_outliers(Left(values), Criteria(channel, null))
    assert found[out].mean() > 0.8
    [said] = outlier_remarks(found, channel)
    assert said.startswith(f"{found.sum()} values of tip in run left out: outliers")


def test_nothing_is_left_out_where_nothing_or_something_else_is_left():
    values, _ = spoiled(0.02, 8.0)
    assert not Criteria(Channel(), Left(values + GAP)).leaves_gap(Left(values))
    assert not masked_outliers(Left(values), Criteria(Channel(), Left(values + GAP))).any()
    both = spoiled(0.07, 30.0)[0] + 0.3 * GAP
    assert Criteria(Channel(), Left(both + GAP)).leaves_gap(Left(both))
    assert not masked_outliers(Left(both), Criteria(Channel(), Left(both + GAP))).any()


def test_rows_that_are_left_keep_their_values_and_instants():
    """Two channels of a signal, one of which loses the row that the other keeps."""
    kept = np.array([True, False, True, True])
    rows = [
        Rows("run", "tip", k, slice(3 * k, 3 * k + 3), kept, 1.0, np.array([0.0, 2.0, 3.0])) for k in (0, 1)
    ]
    out = np.array([False, True, False, False, False, False])
    one, other = rows_left(rows, out)
    assert (one.where, other.where) == (slice(0, 2), slice(2, 5))
    assert one.mask.tolist() == [True, False, False, True]
    assert one.time.tolist() == [0.0, 3.0]
    assert other.mask.tolist() == kept.tolist()
    assert kept.tolist() == [True, False, True, True]
    assert [each.channel for each in rows_left(rows, np.array([True, True, True, False, False, False]))] == [
        1
    ]


@pytest.mark.parametrize("count, words", [(1, "1 value of tip"), (2, "2 values of tip")])
def test_they_are_counted_in_words(count, words):
    found = np.zeros(N, dtype=bool)
    found[:count] = True
    assert outlier_remarks(found, Channel())[0].startswith(words)


def with_outliers(record, seed):
    """Every twentieth value of the tip fourteen sigmas off, which no check sees beside the gap."""
    tip, rng = record.signals["tip"], np.random.default_rng(seed)
    out = rng.random(tip.values.shape) < 0.05
    return changed(record, "tip", tip.values + 14 * tip.noise_std * out * rng.choice([-1.0, 1.0], out.shape))


@pytest.mark.slow
def test_a_diagnosis_names_what_it_would_without_them_and_shows_gaps_without_them():
    """Both records are told by their good readings: left is noise of three axes, to 2 % by 1200 rows."""
    one, other = with_outliers(diagnoses.record(1), 1), with_outliers(diagnoses.record(3, 0.2), 3)
    d = flexarm.diagnose(diagnoses.nominal(), {"one": one}, other, n_jobs=1, step=0.004)
    [spring] = d.effects
    assert (d.verdict, spring.name, spring.at) == ("effects", "joint_compliance", "hinge")
    assert spring.parameters[0].value == pytest.approx(diagnoses.STIFFNESS, rel=0.02)
    for name in ("one", "held_out"):
        assert any(f"of tip in {name} left out: outliers" in said for said in d.remarks)
        assert d.after[name].signals["tip"].rms["total"] < 1.1 * np.sqrt(3) * diagnoses.TRACKER
