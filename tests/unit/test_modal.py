"""Claims about modes as an object."""

import json

import numpy as np
import pytest
from arms import G, arm, beam, compliance, general, hinge, paper_arm, rigid

import flexarm
from flexarm import InvalidParameter, Modes


@pytest.fixture(scope="module")
def found() -> Modes:
    """Four modes of the paper's arm on a soft, damped hinge."""
    return flexarm.modes(paper_arm(4, 1e5, damping_ratio=0.01), count=4)


def test_json_holds_what_the_contract_names(found):
    data = json.loads(json.dumps(found.to_json_dict()))
    assert {"frequency_hz", "damping_ratio", "solver"} <= set(data)
    assert data["frequency_hz"] == pytest.approx(found.frequency_hz)
    assert len(data["frequency_hz"]) == len(data["damping_ratio"]) == 4


def test_frequencies_rise(found):
    assert np.all(np.diff(found.frequency_hz) >= 0)
    assert found.damped_frequency_hz == pytest.approx(
        found.frequency_hz * np.sqrt(1 - found.damping_ratio**2), rel=1e-3
    )


def test_shapes_have_unit_modal_mass():
    """A body of inertia J on its spring turns by 1/sqrt(J) at unit modal mass."""
    body = arm(
        gravity=[0, 0, 0],
        joints=[hinge("hinge", "body", axis=[0, 0, 1])],
        links=[rigid("body", 1.0, inertia=[2.5, 2.5, 4.0])],
        points=[{"name": "out", "link": "body", "position": [2.0, 0, 0]}],
        effects=[compliance("hinge", 100.0)],
    )
    shape = flexarm.modes(body, count=1).shape[0, 0]
    assert np.abs(shape) == pytest.approx([0, 1.0, 0, 0, 0, 0.5], abs=1e-9)


def test_pendulum_under_gravity_on_a_spring():
    """Hanging: w^2 = (k + m g l)/(m l^2); upright: k - m g l."""
    k, m, length = 100.0, 2.0, 0.5
    body = arm(
        joints=[hinge("hinge", "body")],
        links=[rigid("body", m, com=[0, 0, length])],
        effects=[compliance("hinge", k)],
    )
    for angle, sign in ((0.0, -1), (np.pi, 1)):
        w = np.sqrt((k + sign * m * G * length) / (m * length**2))
        found = flexarm.modes(body, joints={"hinge": angle}, count=1)
        assert found.frequency_hz == pytest.approx([w / (2 * np.pi)], rel=1e-9)


def test_arms_without_points_have_modes():
    plain = arm(joints=[hinge("hinge", "rod")], links=[beam("rod", [0, 0, 1], general(1e-4, 1e-8))])
    found = flexarm.modes(plain, count=3)
    assert found.shape.shape == (3, 0, 6)
    assert found.frequency_hz.min() > 0


def test_fewer_modes_come_where_there_are_fewer():
    one = arm(
        joints=[hinge("hinge", "body")],
        links=[rigid("body", 1.0, com=[0, 0, -1])],
        effects=[compliance("hinge", 1.0)],
    )
    assert len(flexarm.modes(one, count=6).frequency_hz) == 1


def test_rigid_arms_on_rigid_drives_have_none():
    stiff = arm(joints=[hinge("hinge", "body")], links=[rigid("body", 1.0)])
    found = flexarm.modes(stiff)
    assert len(found.frequency_hz) == 0
    assert found.summary().startswith("modes of arm: none, as nothing with mass can vibrate")
    assert found.to_json_dict()["frequency_hz"] == []


@pytest.mark.parametrize("count", [0, -3])
def test_count_must_be_positive(count):
    with pytest.raises(InvalidParameter, match=f"count: must be at least 1, got {count}"):
        flexarm.modes(paper_arm(1), count=count)


def test_unknown_joint_is_named():
    with pytest.raises(InvalidParameter, match="no moving joint 'elbow'; there are hinge"):
        flexarm.modes(paper_arm(1), joints={"elbow": 0.1})


def test_save_and_load_round_trip(found, tmp_path):
    found.save(tmp_path / "modes.nc")
    again = Modes.load(tmp_path / "modes.nc")
    assert again.arm == found.arm
    assert again.points == found.points
    for name in ("frequency_hz", "damping_ratio", "damped_frequency_hz", "shape"):
        assert np.array_equal(getattr(again, name), getattr(found, name)), name


def test_plot_summary_and_repr(found):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots()
    assert found.plot(ax=axes) is axes
    assert "Hz" in axes.get_title()
    plt.close(figure)
    assert len(found.summary().splitlines()) == 6
    assert repr(found).startswith("<Modes of 'paper': 2.2")
