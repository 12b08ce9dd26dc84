"""What Newton's iteration leaves is too small to matter for positions and torques (docs/decisions/0002)."""

import numpy as np
import pytest
from arms import arm, drive, hinge, paper_arm, rigid, smooth_step, swing_angle
from scipy.interpolate import CubicSpline

import flexarm
from flexarm import _core
from flexarm.assembly import assemble


def test_the_default_tolerance_moves_the_tip_by_less_than_a_tenth_of_a_micrometre():
    """Against a tolerance at which the iteration goes on to rounding."""
    motion = drive({"hinge": lambda t: np.pi + swing_angle(t)}, 20.0, 2001)
    paper = paper_arm(4, spring=1e5)
    system = assemble(paper, {"hinge": motion.joints["hinge"].kind})
    rest = _core.static_equilibrium(system, [np.pi], _core.Loads(gravity=np.array(paper.gravity)))
    tips = []
    for tolerance in (_core.TransientOptions().tolerance, 1e-14):
        options = _core.TransientOptions()
        options.end, options.step, options.tolerance = 20.0, 2e-3, tolerance
        tips.append(
            np.array(_core.simulate(system, rest, [motion.joints["hinge"].polynomial()], options).position)
        )
    assert np.abs(tips[0] - tips[1]).max() < 1e-7


@pytest.mark.parametrize("step", [2e-3, 5e-4])
def test_torques_of_a_rigid_arm_stay_quiet_at_small_steps(step):
    """T = J q'' + m g l sin q; an error d of a position would be one of d J/(beta h^2) in the torque."""
    swung = arm(joints=[hinge("hinge", "rod")], links=[rigid("rod", 10.0, (0, 0, -1), (1, 1, 1))])
    time = np.linspace(0, 4, 4001)
    angle = CubicSpline(time, 0.5 * np.sin(2 * time) * smooth_step(time))
    run = flexarm.simulate(swung, flexarm.Drive.from_samples(time, {"hinge": angle(time)}), step=step)
    exact = 11 * angle(run.time, 2) + 10 * 9.81 * np.sin(angle(run.time))
    settled = run.time > 2  # after the jump of the ramp's third derivative at 1 s
    assert np.abs(run.joint_torque[settled, 0] - exact[settled]).max() < 2e-3
