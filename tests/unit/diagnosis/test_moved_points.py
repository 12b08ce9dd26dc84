"""Points off their stated places, carried along with sections and interfaces."""

import numpy as np
from arms import drive, smooth_step
from part_arms import arm_of_parts

import flexarm
from flexarm.diagnosis.moved_points import MovedPoints
from flexarm.effects import ReflectorOffset


def test_a_reflector_at_an_interface_of_a_part_goes_with_the_interface(tmp_path):
    """An interface is rigid, so that nothing is left out."""
    stated = flexarm.Arm.from_dict(arm_of_parts(tmp_path))
    assert ":" in stated.point("tip").link
    arm = stated.with_effect(ReflectorOffset(at="tip", offset=(0.01, -0.02, 0.03)))
    moved = MovedPoints(arm, stated.points)
    hinge = stated.moving_joints[0].name
    swing = drive({hinge: lambda t: 0.3 * smooth_step(t)}, 1.0)
    direct, nodes = (flexarm.simulate(each, swing, step=5e-3) for each in (arm, moved.at_nodes))
    bare = flexarm.simulate(stated, swing, step=5e-3)
    assert np.abs(direct.position - bare.position).max() > 0.01
    assert np.abs(moved.carried(nodes).position - direct.position).max() < 1e-7  # iterations end there
