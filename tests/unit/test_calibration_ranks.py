"""The benchmark of ranks: what it draws, and its table."""

import sys
from pathlib import Path

import numpy as np
import pytest
from pytest import approx

sys.path.append(str(Path(__file__).parents[2] / "benchmarks"))

from calibration_ranks import STEP, STUDIES, draw_all, picture, rows

import flexarm
from flexarm.arm.parameter import with_value


def test_truths_are_those_of_the_priors():
    """ln of a stiffness that is known to 30 % is normal with sigma 0.3 about the nominal one."""
    study = STUDIES["smooth hinge"]
    truth, record = study.draw(np.random.default_rng(3))
    again, _ = study.draw(np.random.default_rng(3))
    assert truth == again
    assert set(study.arm().uncertainty) < set(truth)
    assert record.signals["output"].zero_std is not None
    assert truth["effects.joint_compliance.hinge.stiffness"] != approx(1e5, rel=1e-3)


def test_the_true_arm_leaves_noise():
    """A model with the truths, a coarser mesh and a longer step is left with the noise of the record."""
    study = STUDIES["smooth hinge"]
    truth, record = study.draw(np.random.default_rng(3))
    arm = study.arm()
    for key in arm.uncertainty:
        arm = with_value(arm, key, truth[key])
    gap = flexarm.compare(arm, record, step=STEP).evidence["tip"]
    assert gap.rms["total"] == approx(np.sqrt(3) * study.noise, rel=0.15)


def test_what_is_in_the_file_is_not_drawn_again(tmp_path):
    path = tmp_path / "ranks.json"
    path.write_text('{"smooth hinge: 1000": {"payloads.load.mass": 0.97}}')
    found = draw_all(1, 1, ["smooth hinge"], path)
    assert found == {"smooth hinge: 1000": {"payloads.load.mass": 0.97}}
    [*_, last] = rows(found)
    assert last.startswith("| all | 0 of 1 | 0 % |")


@pytest.mark.slow
def test_a_draw_has_a_rank_of_each_truth(tmp_path):
    found = draw_all(1, 1, ["smooth hinge"], tmp_path / "ranks.json")
    [ranks] = found.values()
    assert len(ranks) == 6
    assert all(0 < rank < 1 for rank in ranks.values())
    picture(found, tmp_path / "ranks.png")
    assert (tmp_path / "ranks.png").stat().st_size > 1000
