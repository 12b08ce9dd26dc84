"""Residuals of poses: derivatives of their equilibria against differences of whole records."""

import numpy as np
import pytest
from tests.helpers.arms import TUBE, beam, hinge, point

from flexarm import Arm, Record, Signal
from flexarm.diagnosis.problem import Problem
from flexarm.errors import InvalidParameter
from flexarm.record import Frame

KEYS = [
    "links.rod.material.youngs_modulus",
    "points.tip.position.x",
    "effects.joint_compliance.hinge.stiffness",
    "effects.encoder_offset.q.offset",
    "effects.frame_registration.tracker.rotation.y",
]


def soft_rod() -> Arm:
    """A rod on a soft hinge."""
    return Arm.from_dict(
        {
            "joints": [hinge("hinge", "rod")],
            "links": [beam("rod", [0, 0, 3.0], TUBE)],
            "payloads": [{"name": "load", "link": "rod", "position": [0, 0, 3.0], "mass": 14.1}],
            "points": [point("tip", "rod", [0.05, 0, 3.0])],
            "effects": [
                {"name": "joint_compliance", "at": "hinge", "stiffness": 5e4},
                {"name": "encoder_offset", "at": "q", "offset": 2e-3},
                {"name": "frame_registration", "at": "tracker", "rotation": [0, 1e-3, 0]},
            ],
        }
    )


def problem(quantity: str = "position") -> tuple[Arm, Problem]:
    """Three poses of it, seen in a frame that is not the base's."""
    arm = soft_rod()
    rows = np.array(["a", "b", "c"])
    angles = np.array([[-0.4], [0.3], [0.9]])
    size = {"position": 3, "orientation": 4}[quantity]
    seen = np.full((3, size), 0.5)
    signals = [
        Signal(name="q", quantity="joint_angle", joint="hinge", values=angles, pose=rows),
        Signal(name="tip", quantity=quantity, point="tip", values=seen, pose=rows, frame="tracker",
               noise_std=1e-4),
    ]  # fmt: skip
    frames = {"tracker": Frame(rpy=(0.0, 0.0, 0.4), xyz=(1.0, 0.0, 0.0))}
    return arm, Problem(arm, {"r": Record(kind="static", drive=("q",), signals=signals, frames=frames)})


@pytest.mark.parametrize("k", range(len(KEYS)), ids=KEYS)
def test_derivatives_of_equilibria_are_differences_of_residuals(k):
    """Differences have an error near 1e-7 of themselves."""
    arm, poses = problem()
    exact = poses.static_jacobian(arm, KEYS)
    poses.static_jacobian = lambda *_: None
    differences = poses.jacobian(arm, [KEYS[k]])[:, 0]
    assert np.abs(differences).max() > 0
    assert exact[:, k] == pytest.approx(differences, abs=1e-6 * np.abs(differences).max())


def test_orientations_are_left_to_differences():
    """Their residual is a rotation vector, no difference of readings."""
    arm, poses = problem("orientation")
    assert poses.static_jacobian(arm, KEYS[:1]) is None


def without_noise_std(repeats: int, noise: float, turned: bool = False) -> Problem:
    """Eight poses between -1 and 1.2 rad, some of them measured again, far from what the model says."""
    rng = np.random.default_rng(5)
    number = np.concatenate([np.arange(8), np.arange(repeats) % 8])
    number = rng.permutation(number) if turned else np.sort(number)
    rows = np.array([f"p{k}" for k in number])
    angles = np.linspace(-1.0, 1.2, 8)[number, None]
    seen = 0.7 + noise * rng.standard_normal((len(rows), 2))
    signals = [
        Signal(name="q", quantity="joint_angle", joint="hinge", values=angles, pose=rows),
        Signal(name="tip", quantity="position", point="tip", axes=("x", "z"), values=seen, pose=rows),
    ]
    return Problem(soft_rod(), {"r": Record(kind="static", drive=("q",), signals=signals)})


@pytest.mark.parametrize("turned", [False, True], ids=["swept", "in any order"])
def test_noise_of_poses_is_what_their_repeats_show(turned):
    """80 freedoms know it to 8 %; from pose to pose the gap changes by decimetres."""
    found = without_noise_std(40, 5e-5, turned)
    assert [each.sigma for each in found.rows] == [pytest.approx(5e-5, rel=0.25)] * 2


@pytest.mark.parametrize(
    "repeats, noise", [(0, 5e-5), (5, 5e-5), (16, 0.0)], ids=["no repeats", "few", "all alike"]
)
def test_poses_that_do_not_show_their_noise_need_it_stated(repeats, noise):
    """Second differences of poses are no noise: any order of them says something else."""
    with pytest.raises(InvalidParameter, match=rf"records\.r\.signals\.tip: state noise_std.*got {repeats}"):
        without_noise_std(repeats, noise)
