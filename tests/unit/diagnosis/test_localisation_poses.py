"""Claims about poses: no time, no bands, and joints as in motion."""

import numpy as np
import pytest
from planted import two_joints

import flexarm
from flexarm.comparison.aligned_record import simulate_record
from flexarm.record import Record, Signal
from flexarm.residual_analysis.localisation import localise
from flexarm.residual_analysis.noise_floor import noise_floor
from flexarm.residual_analysis.unexplained import unexplained_residual

SPRING = 1e5  # N m/rad


@pytest.fixture(scope="module")
def pairs():
    """Sixty poses of an arm with a spring in its elbow, each measured twice, beside the arm without one."""
    model, rng = two_joints(), np.random.default_rng(12)
    poses = np.array([f"p{i}" for i in range(60)])
    angles = {joint: rng.uniform(-1.0, 1.0, 60) for joint in ("shoulder", "elbow")}
    signals = [
        Signal(
            name=joint, quantity="joint_angle", joint=joint, side="motor", pose=poses, values=angles[joint]
        )
        for joint in angles
    ]
    seen = [
        Signal(
            name=name,
            quantity="position",
            point=name,
            axes=("x", "z"),
            pose=np.tile(poses, 2),
            values=np.zeros((120, 2)),
            noise_std=4e-5,
        )
        for name in ("tip", "middle")
    ]
    empty = Record(signals=[*signals, *seen], drive=("shoulder", "elbow"), kind="static")
    machine = model.with_effect(
        flexarm.effects.effect_class("joint_compliance")(at="elbow", stiffness=SPRING, damping=0.0)
    )
    true = simulate_record(machine, empty, align=False)
    filled = [
        signal.replace(
            values=true.simulated.predicted(signal, true.aligned.placement)
            + 4e-5 * rng.standard_normal((120, 2))
        )
        for signal in seen
    ]
    record = empty.replace(signals=[*signals, *filled])
    return {
        "spring": simulate_record(model, record, align=False),
        "none": simulate_record(machine, record, align=False),
    }


def test_a_gap_of_poses_has_one_band_and_no_velocity(pairs):
    located = localise(pairs["spring"])
    assert {cell.band for cell in located.cells} == {"all poses"}
    assert {cell.state.split()[0] for cell in located.cells} == {"all", "angle", "torque"}
    assert located.where[0]["band_hz"] == [0.0, 0.0]
    assert located.where[0]["signal"] == "tip"


def test_a_spring_in_the_elbow_is_found_there(pairs):
    located = localise(pairs["spring"])
    first = located.rotations.joints[0]
    assert (first.joint, first.hint) == ("elbow", "compliance")
    assert first.share > 0.9
    torque = located.rotations.states[0].torque
    assert float(first.angle @ torque / (torque @ torque)) == pytest.approx(-1 / SPRING, rel=0.05)


def test_poses_of_the_right_arm_exceed_nowhere(pairs):
    assert localise(pairs["none"]).where == ()


def test_the_floor_of_poses_comes_from_repeats_and_mesh(pairs):
    rows = {each.signal: each for each in noise_floor(pairs["spring"]).signals}
    assert rows["tip"].estimated == pytest.approx(4e-5, rel=0.2)
    assert set(rows["tip"].errors) == {"mesh"}
    assert rows["tip"].below["mesh"]


def test_what_is_left_of_poses_has_no_frequency(pairs):
    found = unexplained_residual(localise(pairs["spring"]))
    assert found.frequency_hz is None
    assert "pose" in str(found)
    assert "Hz" not in str(found)


def test_a_figure_of_poses_shows_angle_and_torque(pairs):
    figure = localise(pairs["spring"]).plot()
    assert [ax.get_xlabel() for ax in figure.axes] == ["angle of elbow [rad]", "torque of elbow [N m]"]
