"""Unusual records that are right raise no doubt beside their model; the same in a wrong unit still do."""

from functools import cache

import numpy as np
import pytest
from arms import TUBE, beam, crane, hinge, point, rigid, smooth_step
from arms import arm as arm_of

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.record import Clock, Frame, Signal
from flexarm.record.table import CarriedPayload
from flexarm.validation.record_remarks import plausibility_doubts
from flexarm.validation.sensor_check import check

RATIO = 120.0
RNG = np.random.default_rng(5)
T = np.arange(0, 20, 0.02)
MAP = np.array([432_100.0, 5_411_300.0, 212.0])
"""Where a crane stands on a map [m]."""


def rising(t: np.ndarray, by: float) -> np.ndarray:
    """A move that takes 5 s and rests afterwards."""
    return by * smooth_step((t - 1) / 5)


def slewing(**more: object) -> flexarm.Arm:
    """A boom of 3 m that turns about the vertical, with a load and a reflector at its foot."""
    return crane(
        joints=[hinge("hinge", "rod", axis=[0, 0, 1])],
        links=[beam("rod", [3, 0, 0], TUBE, elements=2, up=[0, 0, 1])],
        payloads=[{"name": "load", "link": "rod", "position": [3, 0, 0], "mass": 10.0}],
        points=[point("tip", "rod", [3, 0, 0]), point("foot", "rod", [4e-3, 0, 0])],
        **more,
    )


def encoder(values: np.ndarray, name: str = "hinge", t: np.ndarray = T, **more: object) -> Signal:
    noisy = values + 1e-5 * RNG.standard_normal(len(t))
    own = {"side": "motor", "noise_std": 1e-5, **more}
    return Signal(name=name, quantity="joint_angle", joint=name, values=noisy, time=t, **own)


def seen(values: np.ndarray, name: str = "tip", t: np.ndarray = T, **more: object) -> Signal:
    noisy = values + 5e-5 * RNG.standard_normal(values.shape)
    return Signal(name=name, quantity="position", point=name, values=noisy, time=t, noise_std=5e-5, **more)


def circle(angle: np.ndarray, radius: float = 3.0) -> np.ndarray:
    return radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)


def record(*signals: Signal, **more: object) -> flexarm.Record:
    return flexarm.Record(signals=list(signals), **{"drive": ("hinge",), **more})


def doubts(of: flexarm.Record, arm: flexarm.Arm) -> list[str]:
    problems = [*of.check(arm), *of.check_against(arm)]
    return [f"{problem.where}: {problem.what}" for problem in problems]


@pytest.mark.parametrize("frame", [Frame(unknown=True), Frame(xyz=tuple(-MAP), translation=5e-3)])
def test_a_total_station_may_count_from_where_a_map_does(frame):
    tip = seen(circle(rising(T, 1.2)) + MAP, frame="map")
    here = record(encoder(rising(T, 1.2)), tip, frames={"map": frame})
    assert doubts(here, slewing()) == []
    assert here.check() == []
    wide = here.replace(signals={**here.signals, "tip": tip.replace(values=1e3 * tip.values)})
    if frame.unknown:
        [what] = doubts(wide, slewing())
        assert what.startswith("signals.tip: moves over 2796") and 'say unit = "mm"' in what
        assert [problem.where for problem in wide.check()] == ["signals.tip"]


def test_a_reflector_at_the_foot_of_an_arm_stays_near_the_base():
    """4 mm from the axis of an arm of 3 m; the tip is not."""
    angle = rising(T, 1.2)
    foot = record(encoder(angle), seen(circle(angle, 4e-3), "foot"))
    assert doubts(foot, slewing()) == []
    [what] = doubts(record(encoder(angle), seen(circle(angle, 3e-3))), slewing())
    assert what.startswith("signals.tip: stays within 0.003")
    assert what.endswith("a rigid arm would have it 3 m away; is the unit right?")


@pytest.mark.parametrize("clock", [Clock(sigma=2e-3), Clock(unknown=True)])
def test_a_tracker_may_be_switched_on_after_the_move(clock):
    late = slice(600, None)
    tip = seen(circle(rising(T, 1.2))[late], t=T[late], clock="tracker")
    both = {"clocks": {"controller": Clock(), "tracker": clock}}
    assert doubts(record(encoder(rising(T, 1.2), clock="controller"), tip, **both), slewing()) == []


def test_a_tracker_may_lose_sight_of_a_move():
    values = circle(rising(T, 1.2))
    values[50:] = np.nan
    assert doubts(record(encoder(rising(T, 1.2)), seen(values)), slewing()) == []


def test_poses_that_were_not_seen_move_nothing():
    """Two of four poses, of one angle, were measured in a frame of their own."""
    names = np.array(["a", "b", "c", "d"])
    drive = Signal(
        name="hinge",
        quantity="joint_angle",
        joint="hinge",
        side="motor",
        values=[0.3, 0.3, 1.0, 2.0],
        pose=names,
    )
    tip = Signal(
        name="tip",
        quantity="position",
        point="tip",
        values=circle(np.array([0.3, 0.3 + 1e-5])),
        pose=names[:2],
    )
    few = record(
        drive, tip.replace(noise_std=5e-5, frame="yard"), kind="static", frames={"yard": Frame(unknown=True)}
    )
    assert doubts(few, slewing()) == []


def test_a_wrist_or_a_crane_may_turn_more_than_once():
    arm, angle = slewing(), rising(T, 7.2)
    here = record(encoder(angle), seen(circle(angle)))
    assert doubts(here, arm) == []
    assert check(arm, {"slewing": here}).doubts == ()
    wrong = doubts(record(encoder(np.degrees(angle)), seen(circle(angle))), arm)
    assert any(what.startswith("signals.hinge: reaches 412.5") for what in wrong)


def test_a_crane_may_slew_three_times_round():
    """A warning says so, but what follows the model is no reason to judge no sensor."""
    arm = slewing()
    drive = flexarm.Drive.from_samples(T, {"hinge": rising(T, 20.0)})
    sensors = [
        Sensor(name="hinge", quantity="joint_angle", joint="hinge", rate_hz=100, noise_std=1e-5),
        Sensor(name="tip", quantity="position", point="tip", rate_hz=20, noise_std=5e-5),
        Sensor(name="foot", quantity="position", point="foot", rate_hz=20, noise_std=5e-5),
    ]
    run = flexarm.simulate(arm, drive, step=0.01)
    slewed = flexarm.measure(run, sensors, np.random.default_rng(1), drive=["hinge"])
    assert [what[:25] for what in doubts(slewed, arm)] == ["signals.hinge: reaches 20"]
    assert check(arm, {"slewing": slewed}).summary() == "1 record checked: no sensor is at fault"
    unseen = slewed.replace(signals={name: slewed.signals[name] for name in ("hinge", "foot")})
    assert any("3.2 turns" in doubt for doubt in check(arm, {"unseen": unseen}).doubts)


@cache
def geared() -> tuple[flexarm.Arm, flexarm.Record]:
    """A motor's shaft that turns a tube of 3 m by a gear, and its encoder."""
    tables = crane().to_dict()
    own = {key: tables[key] for key in ("links", "payloads", "points", "gravity")}
    own["links"].append(rigid("rotor", 1.0, inertia=[0.01] * 3))
    gears = [{"name": "reducer", "input": "shaft", "output": "hinge", "ratio": RATIO}]
    arm = arm_of(joints=[hinge("hinge", "rod"), hinge("shaft", "rotor")], gears=gears, **own)
    drive = flexarm.Drive.from_samples(T[:500], {"shaft": RATIO * rising(T[:500], 0.9)})
    run = flexarm.simulate(arm, drive, step=0.01)
    sensors = [
        Sensor(name="shaft", quantity="joint_angle", joint="shaft", rate_hz=100, noise_std=1e-4),
        Sensor(name="hinge", quantity="joint_angle", joint="hinge", rate_hz=100, noise_std=1e-5),
        Sensor(name="tip", quantity="position", point="tip", rate_hz=20, noise_std=5e-5),
    ]
    return arm, flexarm.measure(run, sensors, np.random.default_rng(1), drive=["shaft"])


def test_shafts_turn_by_the_ratio_of_their_gear():
    """17 turns of a motor that the arm has behind a gear; its joint moves along and is not held still."""
    arm, here = geared()
    assert doubts(here, arm) == []
    assert check(arm, {"geared": here}).summary() == "1 record checked: no sensor is at fault"


def test_shafts_in_degrees_are_named():
    arm, here = geared()
    shaft = here.signals["shaft"]
    wrong = here.replace(signals={**here.signals, "shaft": shaft.replace(values=np.degrees(shaft.values))})
    [fault] = check(arm, {"geared": wrong}).faults
    assert (fault.name, fault.at) == ("unit_error", "shaft")
    assert "57.296 times the angle, which is what degrees for radians give" in fault.evidence


def test_slides_of_25_m_in_millimetres_are_named():
    joints = [{"name": "slide", "type": "prismatic", "parent": "base", "child": "rod", "axis": [1, 0, 0]}]
    arm = crane(joints=joints)
    drive = flexarm.Drive.from_samples(T[:500], {"slide": rising(T[:500], 25.0)})
    sensors = [
        Sensor(name="slide", quantity="joint_angle", joint="slide", rate_hz=100, noise_std=1e-5),
        Sensor(name="tip", quantity="position", point="tip", rate_hz=20, noise_std=5e-5),
    ]
    run = flexarm.simulate(arm, drive, step=0.01)
    here = flexarm.measure(run, sensors, np.random.default_rng(1), drive=["slide"])
    assert doubts(here, arm) == []
    slide = here.signals["slide"]
    wrong = here.replace(signals={**here.signals, "slide": slide.replace(values=1e3 * slide.values)})
    [fault] = check(arm, {"rails": wrong}).faults
    assert (fault.name, fault.at) == ("unit_error", "slide")
    assert "the drive slide shows 1000 times the length" in fault.evidence


@pytest.mark.parametrize(
    ("shown", "noise"),
    [
        (4e-4 * RNG.standard_normal(len(T)), 4e-4),  # noise of many samples goes further than 1 mrad
        (1.7e-3 * RNG.integers(0, 2, len(T)), 5e-4),  # a coarse encoder between two counts
    ],
)
def test_an_encoder_of_a_joint_at_rest_does_not_move(shown, noise):
    joints = [hinge("hinge", "rod", axis=[0, 0, 1]), hinge("wrist", "hand", "rod", at="end")]
    arm = slewing()
    arm = arm_of(
        **{**arm.to_dict(), "joints": joints, "links": [*arm.to_dict()["links"], rigid("hand", 1.0)]}
    )
    angle = rising(T, 1.2)
    wrist = encoder(0 * T, "wrist").replace(values=shown, noise_std=noise)
    here = record(encoder(angle), wrist, seen(circle(angle)))
    assert doubts(here, arm) == []
    moved = here.replace(signals={**here.signals, "wrist": wrist.replace(values=shown + rising(T, 0.02))})
    [what] = doubts(moved, arm)
    assert what.startswith("signals.wrist: is a motor's angle and moves, but is not in drive")


@pytest.mark.parametrize(
    ("quantity", "place"), [("force", {"point": "tip"}), ("payload_mass", {"payload": "load"})]
)
def test_loads_in_equal_steps_have_no_noise_of_a_step(quantity, place):
    """Sixteen weights of 2 kg or 2 N, one after the other, each known to a thousandth of it."""
    names = [f"p{k}" for k in range(16)]
    axes = {"axes": ("z",)} if quantity == "force" else {}
    steps = Signal(
        name="load",
        quantity=quantity,
        values=2.0 * np.arange(16),
        pose=names,
        noise_std=2e-3,
        **place,
        **axes,
    )
    drive = Signal(
        name="hinge", quantity="joint_angle", joint="hinge", side="motor", values=np.zeros(16), pose=names
    )
    assert doubts(record(drive.replace(noise_std=1e-5), steps, kind="static"), crane()) == []


def test_an_arm_at_rest_that_was_simulated_scatters_by_rounding():
    """Its record states the noise of the sensor, which it does not have."""
    rest = circle(0.4 + 1e-16 * RNG.standard_normal(len(T)))
    tip = seen(rest).replace(values=rest)
    assert not any("noise_std" in what for what in doubts(record(encoder(0 * T + 0.4), tip), slewing()))


def test_in_orbit_arms_carry_many_times_their_mass():
    """60 times the arm, with nothing in its hand before: on the ground these are grams."""
    own = sum(load.mass for load in slewing().payloads) + 7850 * 5.8e-4 * 3
    bare = replace_load(slewing(), 0.0)
    here = record(
        encoder(rising(T, 1.2)),
        seen(circle(rising(T, 1.2))),
        payloads={"load": CarriedPayload(mass=60 * own / 2)},
    )
    assert doubts(here, bare.replace(gravity=(0.0, 0.0, 0.0))) == []
    [what] = doubts(here, bare)
    assert what.startswith("payloads.load.mass: is ")


def replace_load(arm: flexarm.Arm, mass: float) -> flexarm.Arm:
    return arm.replace(payloads=tuple(load.replace(mass=mass) for load in arm.payloads))


def test_a_tip_in_milliseconds_keeps_sensors_from_being_judged():
    """Of 5 hours 20 s are compared, and these are its first sample."""
    angle = rising(T, 1.2)
    [doubt] = plausibility_doubts(slewing(), {"run": record(encoder(angle), seen(circle(angle), t=1e3 * T))})
    assert doubt.startswith("run: signals.tip.time: lasts 5.55 h") and 'say time_unit = "ms"' in doubt
