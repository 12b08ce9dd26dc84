"""Calibration: families with hierarchical priors, estimates of all that is uncertain, and their files."""

import json
from math import isnan, log, pi
from pathlib import Path

import numpy as np
import pytest
from arms import crane, drive, hinge, point, rigid, smooth_step, tracker
from pytest import approx

import flexarm
from flexarm import Arm, InvalidFile, InvalidParameter, Record, Signal
from flexarm.arm.prior import Prior
from flexarm.arm.sensor import Sensor
from flexarm.calibration.families import Family
from flexarm.calibration.parameters import FreeParameter
from flexarm.calibration.policy import CalibrationPolicy
from flexarm.comparison.poses import solve_poses
from flexarm.diagnosis.family import HierarchicalPrior
from flexarm.effects.encoder_offset import EncoderOffset
from flexarm.effects.joint_compliance import JointCompliance
from flexarm.record import Clock, Frame

EXAMPLES = Path(__file__).parents[2] / "examples"
NOISE = 2e-4
JOINTS = tuple(f"j{k}" for k in range(1, 7))
STIFFNESS = dict(zip(JOINTS, (4e4, 3e4, 2e4, 8e3, 6e3, 5e3), strict=True))
ZEROS = dict(zip(JOINTS, (0.0, 2e-3, -3e-3, 1e-3, -2e-3, 1e-3), strict=True))
TWISTS = ((0, 0, 1), (0, 1, 0), (0, 1, 0), (1, 0, 0), (0, 1, 0), (1, 0, 0))
LENGTHS = (0.4, 0.6, 0.5, 0.2, 0.15, 0.1)


def robot() -> Arm:
    """A rigid arm of six joints whose tip is known to 2 mm."""
    joints, links, parent, reach = [], [], "base", 0.0
    for name, axis, length in zip(JOINTS, TWISTS, LENGTHS, strict=True):
        joints.append({"name": name, "type": "revolute", "parent": parent, "child": f"l{name}",
                       "origin": {"xyz": [reach, 0, 0]}, "axis": axis})  # fmt: skip
        links.append({"name": f"l{name}", "type": "rigid", "mass": 30 * length, "com": [length / 2, 0, 0.05]})
        parent, reach = f"l{name}", length
    tip = {"name": "tip", "link": "lj6", "position": [0.1, 0.05, 0.1]}
    return Arm.from_dict({"format": "flexarm-arm/1", "name": "robot", "joints": joints, "links": links,
                          "points": [tip], "uncertainty": {"points.tip.position_m": 2e-3}})  # fmt: skip


def truth() -> Arm:
    """The same with soft joints and encoders whose zeros are off."""
    arm = robot()
    for name in JOINTS:
        arm = arm.with_effect(JointCompliance(at=name, stiffness=STIFFNESS[name]))
        arm = arm.with_effect(EncoderOffset(at=name, offset=ZEROS[name]))
    return arm


def record(seed: int, poses: int = 40, still: tuple[str, ...] = (), arm: Arm | None = None) -> Record:
    """Poses of the true arm, seen by a tracker of which nobody knows where it stands."""
    rng = np.random.default_rng(seed)
    names = np.array([str(k) for k in range(poses)])
    drives = [
        Signal(name=joint, quantity="joint_angle", joint=joint, side="motor", pose=names, file="joints.csv",
               values=np.zeros((poses, 1)) if joint in still else rng.uniform(-1.5, 1.5, (poses, 1)))
        for joint in JOINTS
    ]  # fmt: skip
    tip = Signal(name="tip", quantity="position", point="tip", values=np.zeros((poses, 3)), pose=names,
                 frame="tracker", noise_std=NOISE, file="tip.csv")  # fmt: skip
    bare = Record(
        kind="static", signals=[*drives, tip], drive=JOINTS, frames={"tracker": Frame(unknown=True)}
    )
    places = solve_poses(arm or truth(), bare).position[:, 0]
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    seen = (places - [1.0, 2.0, 0.5]) @ turn + NOISE * rng.standard_normal((poses, 3))
    return bare.replace(signals=[*drives, tip.replace(values=seen)])


@pytest.fixture(scope="module")
def found():
    return flexarm.calibrate(
        robot(), {"poses": record(1)}, ["encoder_offset", "joint_compliance"], record(2, 15), n_jobs=1
    )


def test_true_stiffnesses_and_zeros_lie_within_their_intervals(found):
    """Of ten 90 % intervals at least seven hold the truth, and none is off by 4 sigma."""
    inside, pulls = 0, []
    for joint in JOINTS[1:]:
        k = found.parameter(f"effects.joint_compliance.{joint}.stiffness")
        inside += k.low90 < STIFFNESS[joint] < k.high90
        pulls.append(log(k.value / STIFFNESS[joint]) / (k.std / k.value))
    for joint in JOINTS[1:]:
        zero = found.parameter(f"effects.encoder_offset.{joint}.offset")
        inside += zero.low90 < ZEROS[joint] < zero.high90
        pulls.append((zero.value - ZEROS[joint]) / zero.std)
    assert inside >= 7
    assert np.abs(pulls).max() < 4.0


def test_held_out_poses_are_left_with_noise(found):
    gap = found.gap(found.held_out)
    assert gap.before_rms > 20 * NOISE
    assert gap.after_rms < 1.3 * np.sqrt(3) * NOISE
    assert found.chi_square.reduced == approx(1.0, abs=0.35)


def test_the_frame_of_the_tracker_is_found(found):
    [frame] = found.frames
    assert frame.xyz == approx([1.0, 2.0, 0.5], abs=5e-3)
    assert frame.rpy == approx([0.0, 0.0, pi / 2], abs=5e-3)


def test_a_first_joint_about_the_vertical_stays_near_the_shared_size(found):
    """No gravity turns it, so that its stiffness is that of the family, as uncertain as members differ."""
    first = found.parameter("effects.joint_compliance.j1.stiffness")
    family = next(each for each in found.families if each.effect == "joint_compliance")
    assert family.shared is not None
    assert abs(log(first.value / family.shared.value)) < 0.2 * family.spread
    assert not first.determined
    assert first.low90 < STIFFNESS["j1"] < first.high90


def test_files_are_read_again(found, tmp_path):
    found.save(tmp_path / "out")
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"calibration.json", "report.html", "updated.toml", "gaps.nc", "correlations.png"} <= names
    told = json.loads((tmp_path / "out" / "calibration.json").read_text())
    assert told["format"] == "flexarm-calibration/1"
    assert len(told["correlations"]["matrix"]) == len(told["parameters"])
    again = flexarm.Calibration.load(tmp_path / "out")
    assert again.to_json_dict() == {**found.to_json_dict()}
    assert again.summary() == found.summary()
    assert again.plot().lines
    first, *others = told["parameters"]
    unknown = {**told, "parameters": [{**first, "std": None}, *others]}
    (tmp_path / "out" / "calibration.json").write_text(json.dumps(unknown))
    assert isnan(flexarm.Calibration.load(tmp_path / "out").parameters[0].std)
    told["correlations"]["matrix"][0].pop()
    for damaged in (told, {}):
        (tmp_path / "out" / "calibration.json").write_text(json.dumps(damaged))
        with pytest.raises(InvalidFile, match="no report of a calibration"):
            flexarm.Calibration.load(tmp_path / "out")


def test_the_updated_model_has_the_estimates_and_no_registration(found):
    assert found.updated.effect("frame_registration", "tracker") is None
    spring = found.updated.effect("joint_compliance", "j2")
    told = found.parameter("effects.joint_compliance.j2.stiffness")
    assert spring.stiffness == approx(told.value, abs=1e-3 * told.std)
    assert len(repr(spring.stiffness)) < 9  # digits that mean something


def test_a_zero_that_the_data_do_not_tell_from_none_is_not_in_the_updated_model():
    """An encoder at the output reads as the motor's does, which the joint has in common with no spring."""
    rng, names = np.random.default_rng(5), np.array([str(k) for k in range(30)])
    drives = [
        Signal(name=joint, quantity="joint_angle", joint=joint, side="motor", pose=names, file="joints.csv",
               values=rng.uniform(-1.5, 1.5, (30, 1)))
        for joint in JOINTS
    ]  # fmt: skip
    output = drives[1].replace(name="out", side="output", noise_std=1e-4, file="out.csv",
                               values=drives[1].values + 1e-4 * rng.standard_normal((30, 1)))  # fmt: skip
    tip = Signal(name="tip", quantity="position", point="tip", values=np.zeros((30, 3)), pose=names,
                 noise_std=NOISE, file="tip.csv")  # fmt: skip
    bare = Record(kind="static", signals=[*drives, output, tip], drive=JOINTS)
    seen = solve_poses(robot(), bare).position[:, 0] + NOISE * rng.standard_normal((30, 3))
    found = flexarm.calibrate(
        robot(), bare.replace(signals=[*drives, output, tip.replace(values=seen)]), [], n_jobs=1
    )
    zero = found.parameter("effects.sensor_offset.out.offset")
    assert abs(zero.value) < zero.std < 1e-4
    assert found.updated.effects == ()
    assert found.updated.uncertainty == robot().uncertainty


@pytest.mark.parametrize(
    ("families", "said"),
    [
        (["joint_complience"], "did you mean 'joint_compliance'"),
        (["dead_channel"], "fault of a sensor"),
        (["backlash"], "needs joint_compliance there"),
        (["link_stiffness"], "can act nowhere"),
    ],
)
def test_families_that_cannot_be_are_refused(families, said):
    with pytest.raises(InvalidParameter, match=said):
        flexarm.calibrate(robot(), {"poses": record(1, 6)}, families, n_jobs=1)


def test_a_mistyped_family_is_refused_before_faults_of_the_records():
    with pytest.raises(InvalidParameter, match=r"unknown effect 'slack'; known are .*joint_compliance"):
        flexarm.calibrate(robot(), {}, ["slack"], n_jobs=1)


def test_nothing_uncertain_is_refused():
    with pytest.raises(InvalidParameter, match="nothing to calibrate"):
        flexarm.calibrate(robot().replace(uncertainty={}), {"poses": record(1, 6)}, n_jobs=1)


def family(spread: float) -> Family:
    prior = Prior(1e2, 1e6, 1e4, "log", "N m/rad", "test")
    members = tuple(FreeParameter.of_family(f"k{k}", prior, spread, None) for k in range(3))
    hierarchy = HierarchicalPrior.of(prior, CalibrationPolicy(family_spread=spread))
    return Family("joint_compliance", "stiffness", members, ("a", "b", "c"), hierarchy)


def test_the_prior_of_a_family_is_that_of_a_shared_size_and_of_spread():
    """Eq. (1): variance of a member s^2 + tau^2, covariance of two s^2."""
    each = family(0.5)
    covariance = np.linalg.inv(each.hierarchy.precision(3))
    s = each.hierarchy.hyperprior[1]
    assert covariance[0, 0] == approx(s**2 + 0.25)
    assert covariance[0, 1] == approx(s**2)


def test_errors_about_one_scatter_about_one():
    """Eq. (2) of a scale: its prior is centred where nothing is wrong, and its spread counts from there."""
    prior = Prior(0.996, 1.004, 1.0, "linear", "-", "test")
    hierarchy = HierarchicalPrior.of(prior, CalibrationPolicy())
    assert FreeParameter.of_family("k", prior, hierarchy.spread, None).centre == 1.0
    assert (hierarchy.shared_value(np.array([1.01, 1.02])), hierarchy.member_prior().typical) == (1.0, 1.0)
    assert hierarchy.updated(np.full(3, 1.0), np.zeros(3)).spread < hierarchy.spread


@pytest.mark.parametrize("name", ["gear_ratio", "encoder_scale"])
def test_scales_of_two_joints_are_found(name):
    """A tracker far out sees both ratios: the readings are 1.002 and 0.999 times the angles."""
    rng = np.random.default_rng(3)
    shown = rng.uniform(-1.5, 1.5, (24, 2))
    angle = shown / (1.002, 0.999)
    away = np.stack([np.sin(angle[:, 0]), np.cos(angle[:, 0])], axis=1)
    away += 0.8 * np.stack([np.sin(angle.sum(axis=1)), np.cos(angle.sum(axis=1))], axis=1)
    pose = [str(k) for k in range(len(shown))]
    signals = [
        Signal(
            name=joint, quantity="joint_angle", joint=joint, side="motor", values=column, pose=pose,
            noise_std=1e-7, zero_std=0.0,
        )
        for joint, column in zip(("lower", "upper"), shown.T, strict=True)
    ]  # fmt: skip
    tip = Signal(
        name="tip", quantity="position", point="tip", axes=("x", "z"), values=away, pose=pose, noise_std=1e-4
    )
    arm = Arm.from_dict(
        {
            "joints": [
                hinge("lower", "one"),
                {**hinge("upper", "two", parent="one"), "origin": {"xyz": [0, 0, 1.0], "rpy": [0, 0, 0]}},
            ],
            "links": [rigid("one", 1.0, [0, 0, 0.5], [0.1] * 3), rigid("two", 1.0, [0, 0, 0.5], [0.1] * 3)],
            "points": [point("tip", "two", [0, 0, 0.8])],
        }
    )
    poses = Record(kind="static", drive=("lower", "upper"), signals=[*signals, tip])
    found = flexarm.calibrate(arm, {"poses": poses}, [name], n_jobs=1)
    for joint, value in (("lower", 1.002), ("upper", 0.999)):
        scale = found.parameter(f"effects.{name}.{joint}.scale")
        assert scale.value == approx(value, abs=4 * scale.std)
        assert scale.std < 1e-4
        assert scale.prior.value == 1.0


def test_places_of_other_sizes_are_families_of_their_own():
    """Loads of 2 and 20 kg, a torque sensor and an accelerometer: each has a plausible size and a unit."""
    masses = {"tool": 2.0, "load": 20.0}
    arm = Arm.from_dict(
        {
            "joints": [hinge("hinge", "rod")],
            "links": [rigid("rod", 1.0, [0, 0, 0], [0.1] * 3)],
            "points": [point("tip", "rod", [0, 0, 1.0])],
            "payloads": [
                {"name": name, "link": "rod", "position": [0, 0, 1.0], "mass": mass}
                for name, mass in masses.items()
            ],
        }
    )
    angle = np.linspace(-1.0, 1.0, 40)
    noise = 1e-3 * np.random.default_rng(1).standard_normal((2, len(angle)))
    shared = {"pose": [str(k) for k in range(len(angle))], "noise_std": 1e-3}
    of_hinge = {"joint": "hinge", "side": "motor"}
    signals = [
        Signal(name="hinge", quantity="joint_angle", values=angle, zero_std=0.0, **of_hinge, **shared),
        Signal(
            name="torque",
            quantity="motor_torque",
            values=-22 * 9.81 * np.sin(angle) + noise[0],
            **of_hinge,
            **shared,
        ),
        Signal(
            name="level",
            quantity="acceleration",
            point="tip",
            axes=("x",),
            values=-9.81 * np.sin(angle) + noise[1],
            **shared,
        ),
    ]
    poses = Record(kind="static", drive=("hinge",), signals=signals)
    found = flexarm.calibrate(arm, {"poses": poses}, ["payload_mass", "sensor_offset"], n_jobs=1)
    assert {family.at: family.unit for family in found.families} == {
        ("tool",): "kg",
        ("load",): "kg",
        ("torque",): "N m",
        ("level",): "m/s2",
    }
    for name, mass in masses.items():
        assert found.parameter(f"effects.payload_mass.{name}.mass").prior.value == approx(mass)
    ranges = {name: found.parameter(f"effects.sensor_offset.{name}.offset") for name in ("torque", "level")}
    assert ranges["torque"].prior.high90 > 10 * ranges["level"].prior.high90
    assert ranges["level"].unit == "m/s2"


def test_the_spread_is_between_its_prior_and_that_of_the_members():
    """Eq. (3) with nu = 2, tau_0 = 0.5 and members at -1, 0 and 1 about a shared size that is free."""
    u = log(1e4) + np.array([-1.0, 0.0, 1.0])
    found = family(0.5).hierarchy.updated(u, np.zeros(3)).spread
    assert found**2 == approx((2 * 0.25 + 2.0) / 5)


def swing_on_a_soft_hinge(seed: int, exact: bool = False) -> tuple[Arm, Record]:
    """A nominal beam, and the record of one on a soft hinge; exact readings state their noise too."""
    arm = Arm.from_toml(EXAMPLES / "one_link.toml").replace(
        uncertainty={"links.rod.material.youngs_modulus": 0.03}
    )
    true = arm.with_effect(JointCompliance(at="hinge", stiffness=6e4, damping=150.0))
    drive = flexarm.Drive.from_csv(EXAMPLES / "swing.csv", arm)
    sensors = [
        Sensor(
            name="hinge", quantity="joint_angle", joint="hinge", side="motor", rate_hz=200, noise_std=5e-6
        ),
        Sensor(name="tip", quantity="position", point="tip", rate_hz=50, noise_std=1e-4),
    ]
    run = flexarm.simulate(true, drive, step=5e-4 if exact else 2e-3)
    swing = flexarm.measure(run, sensors, np.random.default_rng(seed), drive=["hinge"])
    if not exact:
        return arm, swing
    quiet = [sensor.replace(noise_std=1e-12) for sensor in sensors]
    bare = flexarm.measure(run, quiet, np.random.default_rng(seed), drive=["hinge"])
    signals = {name: swing.signals[name].replace(values=s.values) for name, s in bare.signals.items()}
    return arm, swing.replace(signals=signals)


def test_a_motion_tells_stiffness_and_damping_of_a_joint_beside_an_uncertain_modulus():
    """A beam that swings on a soft hinge: both intervals hold the truth, and only noise is left."""
    arm, swing = swing_on_a_soft_hinge(1)
    found = flexarm.calibrate(arm, {"swing": swing}, ["joint_compliance"], n_jobs=1)
    for name, value in (("stiffness", 6e4), ("damping", 150.0)):
        estimate = found.parameter(f"effects.joint_compliance.hinge.{name}")
        assert estimate.low90 < value < estimate.high90
        assert estimate.determined
    assert found.chi_square.reduced == approx(1.0, abs=0.15)
    assert found.gap(found.held_out).after_rms < 1.1 * found.gap(found.held_out).noise_rms


def test_the_prior_of_an_unknown_clock_lies_about_its_first_guess():
    """1 s about where the correlation of speeds puts it: a tracker that counts from 100 s earlier."""
    arm, swing = swing_on_a_soft_hinge(1)
    tip = swing.signals["tip"]
    lost = tip.replace(time=tip.time + 100.0, clock="tracker")
    swing = swing.replace(
        signals={**swing.signals, "tip": lost}, clocks={**swing.clocks, "tracker": Clock(unknown=True)}
    )
    delay = flexarm.calibrate(arm, {"swing": swing}, n_jobs=1).parameter("effects.time_delay.tracker.delay")
    assert delay.value == approx(100.0, abs=0.02)
    assert delay.prior.value == approx(100.0, abs=0.1)
    assert delay.prior.high90 - delay.prior.low90 == approx(2 * 1.645, rel=1e-3)


def test_estimates_follow_a_curved_valley_to_its_end():
    """Stiffness and modulus share a compliance: without noise both come out true, far within a sigma.

    The drive is smoothed by its stated noise, and errs by a part of that.
    """
    arm, swing = swing_on_a_soft_hinge(1, exact=True)
    found = flexarm.calibrate(arm, {"swing": swing}, ["joint_compliance"], n_jobs=1)
    for name, value in (("stiffness", 6e4), ("damping", 150.0)):
        estimate = found.parameter(f"effects.joint_compliance.hinge.{name}")
        assert abs(estimate.value - value) < 0.3 * estimate.std


def counted_swing(arm: Arm, seed: int) -> Record:
    """Counts of 0.1 mrad drive an arm that a tracker and an accelerometer at its tip see."""
    run = flexarm.simulate(
        arm,
        drive({"hinge": lambda t: 0.4 * np.sin(2 * pi * 0.3 * t) * smooth_step(t / 2)}, 8.0),
        rotations=True,
        forces=True,
    )
    encoder = Sensor(
        name="hinge",
        quantity="joint_angle",
        joint="hinge",
        rate_hz=250,
        noise_std=1e-5,
        step=1e-4,
        clock="plc",
    )
    imu = Sensor(name="imu", quantity="acceleration", point="tip", rate_hz=100, noise_std=0.02, clock="plc",
                 axes=("x", "z"))  # fmt: skip
    return flexarm.measure(
        run,
        [encoder, tracker(rate_hz=20).replace(frame="base"), imu],
        np.random.default_rng(seed),
        drive=["hinge"],
        clocks={"plc": Clock(), "tracker": Clock()},
    )


@pytest.mark.parametrize("seed", [0, 5, 7])
def test_counts_of_the_drive_widen_intervals_beside_an_accelerometer(seed):
    """Counts ring the arm; its accelerations read that error, which is no evidence of spring and damper."""
    spring = JointCompliance(at="hinge", stiffness=6e4, damping=120.0)
    true = crane(effects=[]).with_effect(spring)
    key = "effects.joint_compliance.hinge."
    nominal = true.with_effect(spring.replace(stiffness=6.18e4)).replace(
        uncertainty={f"{key}stiffness": 0.1, f"{key}damping": 0.3}
    )
    found = flexarm.calibrate(nominal, {"swing": counted_swing(true, seed)}, n_jobs=1)
    for name, value in (("stiffness", 6e4), ("damping", 120.0)):
        estimate = found.parameter(key + name)
        assert abs(estimate.value - value) < 3.5 * estimate.std
        assert estimate.determined


def test_a_rigid_joint_cannot_be_told_from_rigid():
    """Of six joints one is soft: data alone set a least stiffness of the others, below what they have."""
    soft = robot().with_effect(JointCompliance(at="j2", stiffness=STIFFNESS["j2"]))
    found = flexarm.calibrate(robot(), {"poses": record(4, arm=soft)}, ["joint_compliance"], n_jobs=1)
    names = {name: found.parameter(f"effects.joint_compliance.{name}.stiffness") for name in JOINTS}
    assert names["j2"].low90 < STIFFNESS["j2"] < names["j2"].high90
    assert names["j2"].determined
    assert not any(names[name].determined for name in JOINTS if name != "j2")
    assert names["j3"].one_sided == "low"  # the next that gravity loads
    assert names["j3"].low90 > 10 * STIFFNESS["j2"]
    assert "effects.joint_compliance.j3.stiffness above " in found.summary()
