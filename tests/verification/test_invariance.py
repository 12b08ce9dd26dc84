"""What must not change a result: where the arm stands, how it is cut into pieces, how its load is applied."""

import numpy as np
import pytest
from arms import STEEL, G, arm, beam, compliance, drive, fixed, general, hinge, paper_arm, point, smooth_step
from scipy.spatial.transform import Rotation

import flexarm

TURN = Rotation.from_euler("xyz", [0.7, -1.1, 2.3])
PLATE = {"shape": "rectangle", "width": 0.03, "height": 0.05}


def two_links(R: np.ndarray, origin_rpy: tuple = (0.0, 0.0, 0.0), tilt: bool = False) -> flexarm.Arm:
    """Two beams with EIy != EIz on skew hinges, a payload with offset and inertia; every vector turned by R.

    With `tilt` only gravity and the first joint's frame turn, by its rpy.
    """
    inner = np.eye(3) if tilt else R

    def v(*xyz):
        return (inner @ np.array(xyz)).tolist()

    inertia = inner @ np.diag([0.05, 0.08, 0.03]) @ inner.T
    return arm(
        gravity=(R @ [0.0, 0.0, -G]).tolist(),
        joints=[
            hinge(
                "shoulder",
                "upper",
                axis=v(0.2, 1, 0.1),
                origin={"xyz": (R @ [0.1, 0.2, 0.3]).tolist(), "rpy": list(origin_rpy)},
            ),
            hinge("elbow", "lower", "upper", at="end", axis=v(1, 0.3, 0), origin={"xyz": v(0, 0.02, 0.05)}),
        ],
        links=[
            beam(
                "upper",
                v(0, 0, 1.2),
                PLATE,
                up=v(1, 0, 0),
                elements=3,
                theory="timoshenko",
                damping_ratio=0.01,
            ),
            beam("lower", v(0.9, 0, 0.2), PLATE, up=v(0, 1, 1), elements=3, theory="timoshenko"),
        ],
        payloads=[
            {
                "name": "load",
                "link": "lower",
                "position": v(0.9, 0.05, 0.25),
                "mass": 6.0,
                "inertia": [
                    *np.diag(inertia).tolist(),
                    float(inertia[0, 1]),
                    float(inertia[0, 2]),
                    float(inertia[1, 2]),
                ],
            }
        ],
        points=[point("tip", "lower", v(0.9, 0, 0.2))],
        effects=[compliance("shoulder", 2e4, 10.0), compliance("elbow", 1e4, 5.0)],
    )


POSE = {"shoulder": 0.7, "elbow": -1.1}
TURNED = {
    "every vector": (two_links(TURN.as_matrix())),
    "base frame": (two_links(TURN.as_matrix(), tuple(TURN.as_euler("xyz")), tilt=True)),
}


@pytest.mark.parametrize("how", list(TURNED))
def test_statics_turn_with_the_whole_set_up(how):
    """Displacements and base wrench turn, torques and section forces stay."""
    R = TURN.as_matrix()
    one, other = flexarm.static(two_links(np.eye(3)), POSE), flexarm.static(TURNED[how], POSE)
    assert np.abs(one.displacement).max() > 1e-3
    assert other.position == pytest.approx(one.position @ R.T, abs=1e-11)
    assert other.displacement == pytest.approx(one.displacement @ R.T, abs=1e-11)
    assert other.joint_torque == pytest.approx(one.joint_torque, abs=1e-8)
    assert other.section_forces == pytest.approx(one.section_forces, abs=1e-6)
    force, moment = np.split(one.base_wrench, 2)
    assert other.base_wrench == pytest.approx(np.concatenate([R @ force, R @ moment]), abs=1e-8)


@pytest.mark.parametrize("how", list(TURNED))
def test_modes_stay_when_the_whole_set_up_turns(how):
    """Frequencies and damping ratios about the loaded pose."""
    one, other = flexarm.modes(two_links(np.eye(3)), POSE), flexarm.modes(TURNED[how], POSE)
    assert other.frequency_hz == pytest.approx(one.frequency_hz, rel=1e-8)
    assert other.damping_ratio == pytest.approx(one.damping_ratio, rel=1e-6)


@pytest.mark.parametrize("how", list(TURNED))
def test_motions_turn_with_the_whole_set_up(how):
    """Half a second of a fast motion of both joints: positions turn, joints and energies stay."""
    moves = {
        "shoulder": lambda t: 0.7 + 0.5 * smooth_step(t / 0.4),
        "elbow": lambda t: -1.1 + 0.9 * smooth_step(t / 0.3),
    }
    runs = [
        flexarm.simulate(either, drive(moves, 0.5), step=2e-3)
        for either in (two_links(np.eye(3)), TURNED[how])
    ]
    one, other = runs
    assert other.position == pytest.approx(one.position @ TURN.as_matrix().T, abs=2e-8)
    assert other.joint_angle == pytest.approx(one.joint_angle, abs=2e-8)
    assert other.kinetic == pytest.approx(one.kinetic, abs=1e-6)
    assert other.elastic == pytest.approx(one.elastic, abs=1e-5)


def chopped(n: int) -> flexarm.Arm:
    """The paper's arm cut into n beams on fixed joints, 8 elements in all."""
    names = [f"piece{i}" for i in range(n)]
    piece = [0, 0, 3.0 / n]
    section = general(5.82e-4, 2.37e-7, shear_area=3e-4)
    return arm(
        gravity=[0, 0, -G],
        joints=[hinge("hinge", names[0])]
        + [fixed(f"weld{i}", names[i], names[i - 1], at="end") for i in range(1, n)],
        links=[beam(name, piece, section, elements=8 // n, theory="timoshenko") for name in names],
        payloads=[{"name": "load", "link": names[-1], "position": piece, "mass": 14.1}],
        points=[point("tip", names[-1], piece)],
        effects=[compliance("hinge", 1e5)],
    )


@pytest.mark.parametrize("n", [2, 4])
def test_a_beam_cut_and_welded_is_the_same_beam(n):
    """Fixed joints between equal elements change nothing but rounding."""
    whole, cut = chopped(1), chopped(n)
    assert flexarm.static(cut, {"hinge": 1.2}).displacement == pytest.approx(
        flexarm.static(whole, {"hinge": 1.2}).displacement, abs=1e-10
    )
    assert flexarm.modes(cut, {"hinge": 1.2}).frequency_hz == pytest.approx(
        flexarm.modes(whole, {"hinge": 1.2}).frequency_hz, rel=1e-7
    )
    move = drive({"hinge": lambda t: 1.2 - 0.8 * smooth_step(t / 0.4)}, 0.6)
    one, other = flexarm.simulate(whole, move), flexarm.simulate(cut, move)
    assert other.position == pytest.approx(one.position, abs=1e-7)


def test_whole_turns_of_the_drive_change_nothing():
    """Rotations do not drift or wrap: 50 turns and a bit give the statics of the bit."""
    model = paper_arm(4, 1e5)
    turns = 100 * np.pi
    one, other = flexarm.static(model, {"hinge": 0.9}), flexarm.static(model, {"hinge": 0.9 + turns})
    assert other.position == pytest.approx(one.position, abs=1e-11)
    assert other.link_angle - one.link_angle == pytest.approx([turns], abs=1e-10)
    assert other.joint_torque == pytest.approx(one.joint_torque, abs=1e-7)


@pytest.mark.parametrize("steps", [50, 200, 800])
def test_a_slow_motion_ends_in_the_static_equilibrium_whatever_its_steps(steps):
    """Heavily damped, from 0 to 1.5 rad and rest: the end is the equilibrium there, without drift."""
    model = paper_arm(4, damping_ratio=0.9)
    move = drive({"hinge": lambda t: 1.5 * smooth_step(t / 4)}, 10.0)
    run = flexarm.simulate(model, move, step=10.0 / steps, alpha=-0.3)
    assert run.position[-1] == pytest.approx(flexarm.static(model, {"hinge": 1.5}).position, abs=1e-7)


def test_a_huge_modulus_makes_the_rigid_arm():
    """Displacement falls as 1/E; at 1e6 times steel the sag is 1e-6 of steel's, but for its nonlinear 1 %."""
    soft = paper_arm(4)
    stiff = paper_arm(4, material=STEEL | {"youngs_modulus": 210e15})
    sag = flexarm.static(soft, {"hinge": 1.2}).displacement
    left = flexarm.static(stiff, {"hinge": 1.2}).displacement
    assert np.abs(left).max() == pytest.approx(1e-6 * np.abs(sag).max(), rel=0.02)
