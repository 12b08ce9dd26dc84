"""Arms side by side in vector registers move as each does alone, but for rounding."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest
from tests.helpers.arms import STEEL, TUBE, beam, compliance, fixed, hinge, point, rigid

import flexarm
from flexarm import _core
from flexarm.simulation.side_by_side import side_by_side

pytestmark = pytest.mark.skipif(_core.lanes() == 0, reason="this processor takes no arms side by side")

TIME = np.linspace(0.0, 1.2, 13)
DRIVE = flexarm.Drive.from_samples(TIME, {"hinge": 0.9 * np.sin(2.5 * TIME) ** 2})


def mast(rng: np.random.Generator, *effects: dict[str, Any], **joint: Any) -> flexarm.Arm:
    """Return a hinged beam, a rigid knee, a beam and a payload, with numbers of its own."""
    steel = STEEL | {"youngs_modulus": 210e9 * rng.uniform(0.8, 1.2), "density": 7850 * rng.uniform(0.9, 1.1)}
    long = beam("rod", [0, 0, rng.uniform(1.5, 2.5)], TUBE, elements=3, damping_ratio=rng.uniform(0, 0.02))
    short = beam("tail", [rng.uniform(0.5, 0.8), 0, 0], TUBE, elements=2, theory="timoshenko")
    for link in (long, short):
        link["material"] = steel
    end = short["end"]
    return flexarm.Arm.from_dict(
        {
            "joints": [
                hinge("hinge", "rod", origin={"xyz": [0.1, 0, 0.4]}, **joint),
                fixed("knee", "elbow", "rod", at="end"),
                fixed("wrist", "tail", "elbow", origin={"xyz": [0.05, 0, 0.1]}),
            ],
            "links": [long, rigid("elbow", rng.uniform(1, 3), [0.02, 0, 0.05], [0.02, 0.03, 0.01]), short],
            "payloads": [{"name": "load", "link": "tail", "position": end, "mass": rng.uniform(2, 12)}],
            "points": [point("knee", "elbow", [0, 0, 0.1]), point("tip", "tail", [end[0], 0, 0.05])],
            "effects": [compliance("hinge", rng.uniform(2e4, 9e4), rng.uniform(50, 300)), *effects],
        }
    )


def assert_same(
    run: flexarm.Simulation, alone: flexarm.Simulation, more: float = 1.0, driven: bool = True
) -> None:
    """Assert that runs differ by rounding; laws that are not smooth make `more` of it.

    Motors have the same angles to the last bit if all of them are `driven`.
    """
    # Rates take up a rounding of positions over a step, torques times stiffness.
    bounds = {"position": 1e-12, "joint_angle": 1e-12, "drive_angle": 0.0, "drive_rate": 0.0}
    bounds |= {"velocity": 1e-11, "joint_rate": 1e-11, "joint_torque": 1e-9, "motor_torque": 1e-9}
    bounds |= {} if driven else {"drive_angle": 1e-12, "drive_rate": 1e-11}
    for name, bound in bounds.items():
        found, wanted = getattr(run, name), getattr(alone, name)
        assert np.abs(found - wanted).max() <= more * bound * np.abs(wanted).max(), name
    assert np.array_equal(run.time, alone.time)
    counts = ("steps", "iterations", "factorisations", "halvings", "dimension", "drive_sha256")
    assert all(run.solver[name] == alone.solver[name] for name in counts)


@pytest.mark.parametrize("consistent", [True, False])
def test_a_run_in_company_is_the_run_alone(consistent: bool) -> None:
    rng = np.random.default_rng(7)
    arms = [mast(rng) for _ in range(11)]
    runs = side_by_side([(arm, DRIVE) for arm in arms], consistent_forces=consistent)
    for arm, run in zip(arms, runs, strict=True):
        assert run is not None
        assert_same(run, flexarm.simulate(arm, DRIVE, consistent_forces=consistent))


def leaning(rng: np.random.Generator, *effects: dict[str, Any]) -> flexarm.Arm:
    """Return an arm that leaves its plane: a leaning beam on a turning base, and a beam across it."""
    end = [rng.uniform(0.8, 1.2), 0, 0.7]
    links = [beam("rod", end, TUBE, elements=3, damping_ratio=0.01), beam("tail", [0, 0.9, 0.1], TUBE)]
    return flexarm.Arm.from_dict(
        {
            "joints": [hinge("hinge", "rod", axis=[0, 0, 1]), fixed("knee", "tail", "rod", at="end")],
            "links": links,
            "payloads": [
                {"name": "load", "link": "tail", "position": [0, 0.9, 0.1], "mass": rng.uniform(2, 9)}
            ],
            "points": [point("tip", "tail", [0, 0.9, 0.1])],
            "effects": [compliance("hinge", rng.uniform(2e4, 9e4), rng.uniform(50, 300)), *effects],
        }
    )


@pytest.mark.parametrize("consistent", [True, False])
def test_arms_in_space_move_as_each_does_alone(consistent: bool) -> None:
    rng = np.random.default_rng(13)
    arms = [leaning(rng) for _ in range(11)]
    runs = side_by_side([(arm, DRIVE) for arm in arms], consistent_forces=consistent)
    for arm, run in zip(arms, runs, strict=True):
        assert run is not None
        assert run.solver["dimension"] == 3
        assert_same(run, flexarm.simulate(arm, DRIVE, consistent_forces=consistent))
    [single] = side_by_side([(arms[0], DRIVE)], consistent_forces=consistent)
    assert single is not None
    assert runs[0] is not None
    assert np.array_equal(runs[0].joint_torque, single.joint_torque)


def test_a_planar_arm_is_computed_in_space_where_that_is_asked_for() -> None:
    arms = [mast(np.random.default_rng(seed)) for seed in (14, 15)]
    for arm, run in zip(arms, side_by_side([(arm, DRIVE) for arm in arms], dimension="space"), strict=True):
        assert run is not None
        assert_same(run, flexarm.simulate(arm, DRIVE, dimension="space"))


BACKLASH = {"name": "backlash", "at": "hinge", "gap": 1e-3}
FRICTION = {"name": "coulomb_friction", "at": "hinge", "torque": 60.0}


@pytest.mark.parametrize(
    ("make", "effects"),
    [(mast, [BACKLASH]), (mast, [FRICTION]), (mast, [BACKLASH, FRICTION]), (leaning, [FRICTION])],
)
def test_laws_that_are_not_linear_are_followed_in_each_lane(
    make: Callable[..., flexarm.Arm], effects: list[dict[str, Any]]
) -> None:
    rng = np.random.default_rng(12)
    arms = [make(rng, *effects) for _ in range(5)]
    for arm, run in zip(arms, side_by_side([(arm, DRIVE) for arm in arms]), strict=True):
        assert run is not None
        assert_same(run, flexarm.simulate(arm, DRIVE), 1e3)


def elbowed(rng: np.random.Generator) -> flexarm.Arm:
    return flexarm.Arm.from_dict(
        {
            "joints": [hinge("hinge", "rod"), hinge("elbow", "tail", "rod", at="end")],
            "links": [beam("rod", [0, 0, rng.uniform(1, 2)], TUBE), beam("tail", [0.7, 0, 0], TUBE)],
            "payloads": [
                {"name": "load", "link": "tail", "position": [0.7, 0, 0], "mass": rng.uniform(2, 9)}
            ],
            "points": [point("tip", "tail", [0.7, 0, 0])],
            "effects": [compliance("hinge", rng.uniform(2e4, 9e4), 90), compliance("elbow", 3e4, 60)],
        }
    )


def robot(rng: np.random.Generator, *effects: dict[str, Any], slides: bool = False) -> flexarm.Arm:
    """Return an arm in space with three joints, the last of which turns or slides."""
    last = {"name": "elbow", "type": "prismatic" if slides else "revolute", "axis": [0, 1, 0]}
    reach = rng.uniform(0.8, 1.1)
    return flexarm.Arm.from_dict(
        {
            "joints": [
                hinge("hinge", "column", axis=[0, 0, 1]),
                hinge("shoulder", "rod", "column", origin={"xyz": [0, 0, 0.4]}),
                last | {"parent": "rod", "child": "tail", "at": "end"},
            ],
            "links": [
                rigid("column", 12.0, [0, 0, 0.2], [0.3, 0.3, 0.2]),
                beam("rod", [0, 0, 1.2], TUBE, elements=3, damping_ratio=rng.uniform(0, 0.02)),
                beam("tail", [reach, 0, 0], TUBE, elements=2),
            ],
            "payloads": [
                {"name": "load", "link": "tail", "position": [reach, 0, 0], "mass": rng.uniform(2, 9)}
            ],
            "points": [point("tip", "tail", [reach, 0, 0])],
            "effects": [
                compliance("hinge", rng.uniform(5e4, 9e4), 90),
                compliance("shoulder", 6e4, 90),
                compliance("elbow", 3e4, 60),
                *effects,
            ],
        }
    )


REACHES = flexarm.Drive.from_samples(
    TIME,
    {
        "hinge": 0.9 * np.sin(2.5 * TIME) ** 2,
        "shoulder": 0.5 * np.sin(2 * TIME) ** 2,
        "elbow": -0.7 * np.sin(2 * TIME) ** 2,
    },
)
BENDS = flexarm.Drive.from_samples(
    TIME, {"hinge": 0.9 * np.sin(2.5 * TIME) ** 2, "elbow": 0.7 * np.sin(2 * TIME) ** 2}
)


@pytest.mark.parametrize("consistent", [True, False])
@pytest.mark.parametrize(
    ("make", "drive"), [(elbowed, BENDS), (robot, REACHES), (partial(robot, slides=True), REACHES)]
)
def test_inner_joints_are_followed(
    make: Callable[..., flexarm.Arm], drive: flexarm.Drive, consistent: bool
) -> None:
    arms = [make(np.random.default_rng(seed)) for seed in range(10)]
    runs = side_by_side([(arm, drive) for arm in arms], consistent_forces=consistent)
    for arm, run in zip(arms, runs, strict=True):
        assert run is not None
        assert_same(run, flexarm.simulate(arm, drive, consistent_forces=consistent), 1e2)
    [single] = side_by_side([(arms[9], drive)], consistent_forces=consistent)
    assert single is not None
    assert runs[9] is not None
    assert np.array_equal(runs[9].position, single.position)
    assert np.array_equal(runs[9].joint_torque, single.joint_torque)


def test_matrices_that_are_factored_anew_disturb_no_other_lane() -> None:
    arms = [elbowed(np.random.default_rng(seed)) for seed in range(6)]
    swing = {"hinge": 2.7 * np.sin(2.5 * TIME) ** 2, "elbow": 2.1 * np.sin(2 * TIME) ** 2}
    drive = flexarm.Drive.from_samples(TIME, swing)
    runs = side_by_side([(arm, drive) for arm in arms], step=5e-3)
    for arm, run in zip(arms, runs, strict=True):
        assert run is not None
        assert run.solver["factorisations"] > 5
        assert_same(run, flexarm.simulate(arm, drive, step=5e-3), 1e2)
        [single] = side_by_side([(arm, drive)], step=5e-3)
        assert single is not None
        assert np.array_equal(run.position, single.position)


def hanging(load: float) -> flexarm.Arm:
    """Return a beam that hangs straight, so that stretching and bending are apart until it swings."""
    return flexarm.Arm.from_dict(
        {
            "joints": [hinge("hinge", "rod")],
            "links": [beam("rod", [0, 0, -2.0], TUBE, elements=2)],
            "payloads": [{"name": "load", "link": "rod", "position": [0, 0, -2.0], "mass": load}],
            "points": [point("tip", "rod", [0, 0, -2.0])],
            "effects": [compliance("hinge", 5e4)],
        }
    )


def test_matrices_whose_pattern_grows_stay_side_by_side() -> None:
    arms = [hanging(load) for load in (4.0, 8.0, 12.0)]
    for arm, run in zip(arms, side_by_side([(arm, DRIVE) for arm in arms]), strict=True):
        assert run is not None
        assert run.solver["factorisations"] > 5
        assert_same(run, flexarm.simulate(arm, DRIVE), 1e2)


def test_laws_that_are_not_linear_go_with_inner_joints() -> None:
    arms = [robot(np.random.default_rng(seed), FRICTION) for seed in range(3)]
    for arm, run in zip(arms, side_by_side([(arm, REACHES) for arm in arms]), strict=True):
        assert run is not None
        assert_same(run, flexarm.simulate(arm, REACHES), 1e3)


def rippled(at: str, rng: np.random.Generator) -> dict[str, Any]:
    return {"name": "transmission_error", "at": at, "amplitude": rng.uniform(0, 2e-3), "multiple": 3.0}


def tilting(at: str, rng: np.random.Generator) -> dict[str, Any]:
    stiffness = [rng.uniform(1e5, 3e5), rng.uniform(1e5, 3e5)]
    return {"name": "joint_tilt_compliance", "at": at, "stiffness": stiffness, "damping": 100.0}


def on_a_soft_base(at: str, rng: np.random.Generator) -> dict[str, Any]:
    return {"name": "base_compliance", "at": at, "stiffness": rng.uniform(1e5, 3e5), "damping": 200.0}


@pytest.mark.parametrize("consistent", [True, False])
@pytest.mark.parametrize(
    ("effect", "make", "drive"),
    [
        (partial(rippled, "hinge"), mast, DRIVE),
        (partial(rippled, "elbow"), robot, REACHES),
        (partial(tilting, "shoulder"), robot, REACHES),
        (partial(tilting, "hinge"), robot, REACHES),
        (partial(on_a_soft_base, "base"), robot, REACHES),
    ],
)
def test_gears_and_bearings_that_give_are_followed(
    effect: Callable[..., dict[str, Any]],
    make: Callable[..., flexarm.Arm],
    drive: flexarm.Drive,
    consistent: bool,
) -> None:
    arms = [make(rng, effect(rng)) for rng in map(np.random.default_rng, range(9))]
    runs = side_by_side([(arm, drive) for arm in arms], consistent_forces=consistent)
    for arm, run in zip(arms, runs, strict=True):
        assert run is not None
        assert_same(run, flexarm.simulate(arm, drive, consistent_forces=consistent), 1e2)
    [single] = side_by_side([(arms[8], drive)], consistent_forces=consistent)
    assert single is not None
    assert runs[8] is not None
    assert np.array_equal(runs[8].position, single.position)
    assert np.array_equal(runs[8].joint_torque, single.joint_torque)


def bowing(at: str, rng: np.random.Generator) -> dict[str, Any]:
    """A bow that grows in tenths of a second; of every other arm it is there from the start."""
    offset = [rng.uniform(-0.02, 0.02), 0, 0]
    return {"name": "link_bow", "at": at, "tip_offset": offset, "time_constant": rng.choice([0.0, 0.4])}


@pytest.mark.parametrize(("make", "drive"), [(mast, DRIVE), (robot, REACHES)])
def test_bows_grow_in_each_lane(make: Callable[..., flexarm.Arm], drive: flexarm.Drive) -> None:
    """A bow of 20 mm that grows shows: its tip is millimetres from where it stays without."""
    arms = [make(rng, bowing("rod", rng)) for rng in map(np.random.default_rng, range(6))]
    grow = [arm.effects[-1].time_constant > 0 for arm in arms]  # type: ignore[attr-defined]
    assert 0 < sum(grow) < len(arms)
    for arm, run in zip(arms, side_by_side([(arm, drive) for arm in arms]), strict=True):
        assert run is not None
        assert_same(run, flexarm.simulate(arm, drive), 1e2)
    straight = arms[grow.index(True)].replace(effects=arms[grow.index(True)].effects[:-1])
    [without] = side_by_side([(straight, drive)])
    run = side_by_side([(arms[grow.index(True)], drive)])[0]
    assert run is not None
    assert without is not None
    assert np.abs(run.position[-1] - without.position[-1]).max() > 1e-3


def test_bows_grow_from_the_start_of_a_run_whenever_its_drive_begins() -> None:
    rng = np.random.default_rng(4)
    bow = {"name": "link_bow", "at": "rod", "tip_offset": [0.02, 0, 0], "time_constant": 0.4}
    late = flexarm.Drive.from_samples(TIME + 3.0, {"hinge": DRIVE.joints["hinge"](TIME)})
    arms = [mast(rng, bow) for _ in range(3)]
    for arm, run in zip(arms, side_by_side([(arm, late) for arm in arms]), strict=True):
        assert run is not None
        assert_same(run, flexarm.simulate(arm, late), 1e2)


def test_arms_without_damping_go_with_those_that_have_it() -> None:
    """The first arm has none: its company keeps its own."""
    data = [mast(rng).to_dict() for rng in map(np.random.default_rng, range(3))]
    data[0]["links"][0]["damping_ratio"] = 0.0
    arms = [flexarm.Arm.from_dict(each) for each in data]
    for arm, run in zip(arms, side_by_side([(arm, DRIVE) for arm in arms]), strict=True):
        assert run is not None
        assert_same(run, flexarm.simulate(arm, DRIVE))


def coupled(rng: np.random.Generator, ratio: float) -> flexarm.Arm:
    """Return an arm whose elbow a gear turns along with the hinge."""
    data = elbowed(rng).to_dict()
    return flexarm.Arm.from_dict(
        data | {"gears": [{"name": "belt", "input": "hinge", "output": "elbow", "ratio": ratio}]}
    )


def test_gears_between_joints_are_followed() -> None:
    arms = [coupled(rng, rng.uniform(-3, -2)) for rng in map(np.random.default_rng, range(3))]
    for arm, run in zip(arms, side_by_side([(arm, DRIVE) for arm in arms]), strict=True):
        assert run is not None
        assert_same(run, flexarm.simulate(arm, DRIVE), 1e2, driven=False)


def test_a_run_does_not_depend_on_its_company_by_one_bit() -> None:
    rng = np.random.default_rng(8)
    arms = [mast(rng) for _ in range(9)]
    all_of_them = side_by_side([(arm, DRIVE) for arm in arms])
    for arm, run in zip(arms, all_of_them, strict=True):
        [single] = side_by_side([(arm, DRIVE)])
        assert run is not None
        assert single is not None
        assert np.array_equal(run.position, single.position)
        assert np.array_equal(run.motor_torque, single.motor_torque)


def test_motors_driven_by_torque_are_let_go_at_the_start() -> None:
    rng = np.random.default_rng(11)
    arms = [mast(rng, rotor_inertia=0.5) for _ in range(3)]
    drive = flexarm.Drive.from_samples(TIME, {"hinge": 40 * np.cos(3 * TIME)}, side="torque")
    for arm, run in zip(arms, side_by_side([(arm, drive) for arm in arms]), strict=True):
        assert run is not None
        alone = flexarm.simulate(arm, drive)
        for name in ("position", "drive_angle"):
            found, wanted = getattr(run, name), getattr(alone, name)
            assert np.abs(found - wanted).max() <= 1e-11 * np.abs(wanted).max(), name


def test_energies_and_states_are_those_of_the_run_alone() -> None:
    arms = [mast(np.random.default_rng(seed)) for seed in (3, 4)]
    [run, _] = side_by_side([(arm, DRIVE) for arm in arms])
    assert run is not None
    alone = flexarm.simulate(arms[0], DRIVE)
    assert run.kinetic == pytest.approx(alone.kinetic, rel=1e-12)
    assert run.work == pytest.approx(alone.work, rel=1e-12)


def seen_within(arm: flexarm.Arm) -> flexarm.Arm:
    """Return the arm with a point that lies inside an element, beside the link's axis."""
    return arm.replace(points=(arm.points[0].replace(link="rod", position=(0.05, 0, 0.3)),))


@pytest.mark.parametrize("make", [mast, leaning])
def test_points_inside_elements_are_seen_as_alone(make: Callable[..., flexarm.Arm]) -> None:
    """Also where each arm has its point in another element, or at a node."""
    rng = np.random.default_rng(16)
    arms = [make(rng) for _ in range(6)]
    end = np.array(arms[0].link("rod").end)
    places = (0.0, 1 / 6, 0.3, 0.5, 0.9, 1.0)
    seen = [
        arm.replace(points=(arm.points[0].replace(link="rod", position=tuple(end * part + (0, 0.1, 0.05))),))
        for arm, part in zip(arms, places, strict=True)
    ]
    runs = side_by_side([(arm, DRIVE) for arm in seen])
    for arm, run in zip(seen, runs, strict=True):
        assert run is not None
        assert_same(run, flexarm.simulate(arm, DRIVE))
        [single] = side_by_side([(arm, DRIVE)])
        assert single is not None
        assert np.array_equal(run.position, single.position)
        assert np.array_equal(run.velocity, single.velocity)


def test_runs_without_joints_move_as_those_with_them() -> None:
    rng = np.random.default_rng(9)
    late = {"name": "drive_lag", "at": "hinge", "delay": 0.01}
    pairs = [(mast(rng, late), DRIVE) for _ in range(2)]
    for run, whole in zip(side_by_side(pairs, joints=False), side_by_side(pairs), strict=True):
        assert run is not None and whole is not None
        assert run.joint_angle is None and run.motor_torque is None
        assert np.array_equal(run.position, whole.position)
        assert run.joint_command is not None
        assert np.array_equal(run.joint_command, whole.joint_command, equal_nan=True)


def test_what_does_not_fit_is_left_to_run_alone() -> None:
    rng = np.random.default_rng(9)
    arm = mast(rng)
    assert side_by_side([(arm, DRIVE)], forces=True) == [None]
    assert side_by_side([(arm, DRIVE)], sensitivities=["payloads.load.mass"]) == [None]
    assert side_by_side([(arm, DRIVE)], step=-1.0) == [None]


def test_simulate_all_takes_what_fits_and_what_does_not() -> None:
    rng = np.random.default_rng(10)
    arms = [mast(rng), mast(rng, BACKLASH), mast(rng), seen_within(mast(rng)), leaning(rng)]
    slower = flexarm.Drive.from_samples(2 * TIME, {"hinge": 0.9 * np.sin(2.5 * TIME) ** 2})
    pairs = [(arm, drive) for arm in arms for drive in (DRIVE, slower)]
    for (arm, drive), run in zip(pairs, flexarm.simulate_all(pairs, n_jobs=1), strict=True):
        assert_same(run, flexarm.simulate(arm, drive))
