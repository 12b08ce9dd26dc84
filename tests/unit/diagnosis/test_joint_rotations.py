"""Claims about a gap as rotations of joints: they are those that were planted."""

import numpy as np
import pytest
from arms import arm, hinge, point, rigid
from planted import run_of

from flexarm.arm.kinematics import link_pose, point_jacobian
from flexarm.comparison.aligned_record import simulate_record
from flexarm.record import Record, Signal
from flexarm.residual_analysis.joint_rotations import joint_rotations
from flexarm.residual_analysis.localisation import localise


def turned(run, rotations):
    """Gaps of both points for small rotations of the joints, functions of time: J d."""
    arm = run.simulation.arm

    def seen(point):
        def gap(t):
            angles = {name: run.state("drive_angle", t, j) for j, name in enumerate(run.simulation.joints)}
            moved = sum(
                point_jacobian(arm, joint, point, angles) * turn(t)[:, None]
                for joint, turn in rotations.items()
            )
            return moved[:, [0, 2]]

        return gap

    return {point.name: seen(point.name) for point in arm.points}


@pytest.fixture(scope="module")
def run():
    return run_of("two joints")


def test_the_jacobian_is_the_derivative_of_the_pose():
    model = run_of("two joints").simulation.arm
    h, at = 1e-6, {"shoulder": np.array([0.4]), "elbow": np.array([-0.7])}
    for joint in at:
        above, below = ({**at, joint: at[joint] + sign * h} for sign in (1, -1))
        ends = [link_pose(model, "fore", values).of_point(np.array([0, 0, 1.2])) for values in (above, below)]
        slope = (ends[0] - ends[1]) / (2 * h)
        assert point_jacobian(model, joint, "tip", at) == pytest.approx(slope, abs=1e-9)
    assert np.all(point_jacobian(model, "elbow", "middle", at) == 0)


def test_a_rotation_at_the_elbow_in_proportion_to_its_torque_is_compliance_there(run):
    def turn(t):
        return run.state("joint_torque", t, 1) / 2e5

    located = localise(run.showing(turned(run, {"elbow": turn})))
    first = located.rotations.joints[0]
    assert (first.joint, first.dependence.best, first.hint) == ("elbow", "torque", "compliance")
    assert first.alone > 0.9
    assert first.share > 0.9
    assert first.angle == pytest.approx(
        turn(located.rotations.time), abs=1.5e-4
    )  # 5 sigma of 4e-5 m at 1.2 m
    assert located.rotations.joints[1].share < 0.02


def test_two_joints_that_turn_are_told_apart(run):
    """Backlash at the shoulder, compliance at the elbow; each rotation follows its own joint's torque."""
    turns = {
        "shoulder": lambda t: 2e-4 * np.sign(run.state("joint_torque", t, 0)),
        "elbow": lambda t: run.state("joint_torque", t, 1) / 2e5,
    }
    located = localise(run.showing(turned(run, turns)))
    hints = {each.joint: each.hint for each in located.rotations.joints}
    assert hints == {"shoulder": "backlash", "elbow": "compliance"}
    assert located.rotations.explained > 0.95
    assert sum(each.share for each in located.rotations.joints) == pytest.approx(
        located.rotations.explained, abs=0.02
    )


def test_joints_that_cannot_be_told_apart_share_a_gap_and_could_explain_it_alone():
    """Two joints in line, in one pose: each shows half of the gap, by its own lever."""
    model = arm(
        name="in line",
        joints=[hinge("near", "a"), hinge("far", "b", "a", origin={"xyz": [0, 0, 1.0]})],
        links=[rigid("a", 1.0), rigid("b", 1.0)],
        points=[point("tip", "b", [0, 0, 1.0])],
        gravity=[0, 0, 0],
    )
    poses = np.array([str(i) for i in range(40)])
    gap = 1e-3 * np.random.default_rng(0).standard_normal(40)
    signals = [
        Signal(name=name, quantity="joint_angle", joint=name, side="output", pose=poses, values=np.zeros(40))
        for name in ("near", "far")
    ]
    values = np.stack([gap, np.full(40, 2.0)], axis=1)
    tip = Signal(
        name="tip",
        quantity="position",
        point="tip",
        axes=("x", "z"),
        pose=poses,
        values=values,
        noise_std=1e-5,
    )
    record = Record(signals=[*signals, tip], drive=("near", "far"), kind="static")
    found = joint_rotations({"poses": simulate_record(model, record)})
    lever = {"near": 2.0, "far": 1.0}
    for each in found.joints:
        assert each.angle == pytest.approx(gap / 2 / lever[each.joint], rel=0.01)
        assert each.alone == pytest.approx(1.0)
        assert each.share == pytest.approx(0.5, abs=0.01)
