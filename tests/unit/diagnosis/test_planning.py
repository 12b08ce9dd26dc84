"""Claims about plans: what the paper's set-up can tell apart, what parts the rest, and how small is seen."""

import json
from functools import cache

import numpy as np
import pytest
from arms import crane as crane_of
from arms import point, there_and_back, tracker
from pytest import approx

import flexarm
from flexarm.arm import Cascade
from flexarm.arm.sensor import Sensor
from flexarm.diagnosis.design.candidate_measurements import menu
from flexarm.diagnosis.design.experiment import NOISE, from_drive, from_record
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.record import Clock, Frame
from flexarm.report.plan import _evidence

JOINT, LINK, LOAD = ("joint_compliance", "hinge"), ("link_stiffness", "rod"), ("payload_mass", "load")
SOFT = (JOINT, LINK, LOAD)
CLOCKS, FRAMES = {"controller": Clock(), "tracker": Clock(sigma=2e-3)}, {"tracker": Frame(translation=1e-3)}


def crane(*sensors):
    """The paper's arm, with a point half way up."""
    points = [point("mid", "rod", [0, 0, 1.5]), point("tip", "rod", [0, 0, 3.0])]
    return crane_of(points=points, sensors=sensors)


@cache
def poor():
    """Motor angle in, tip out, one payload, slowly."""
    model = crane(tracker("tip"))
    return flexarm.plan(model, {"slow": there_and_back(40.0)}, clocks=CLOCKS, frames=FRAMES, n_jobs=1)


@pytest.mark.parametrize("pair", [(JOINT, LINK), (JOINT, LOAD), (LINK, LOAD)])
def test_in_the_papers_set_up_springs_and_payload_coincide(pair):
    """All three are seen, and bend the arm by what gravity asks: contract, end of section 4."""
    found = poor()
    assert all(found.effect(*place).seen for place in pair)
    assert found.tie(*pair).log_bayes_factor < SelectionPolicy.reach
    assert any(set(pair) <= {found.effects[i].place for i in group} for group in found.groups)


def parted(pair, words):
    [found] = [p for p in poor().tie(*pair).partings if words in p.addition]
    return found


@pytest.mark.parametrize(
    ("pair", "words"),
    [
        ((JOINT, LINK), "mid-span"),  # a spring turns the whole link, EI bends it
        ((LINK, LOAD), "torque"),  # the torque weighs the payload, whatever bends
        ((JOINT, LOAD), "torque"),
        ((JOINT, LOAD), "weighed"),
        ((LINK, LOAD), "weighed"),
    ],
)
def test_what_parts_them_by_mechanics_parts_them(pair, words):
    assert parted(pair, words).log_bayes_factor > max(
        SelectionPolicy.reach, 5 * poor().tie(*pair).log_bayes_factor
    )


@pytest.mark.parametrize(("pair", "words"), [((JOINT, LINK), "torque"), ((JOINT, LOAD), "half the speed")])
def test_what_says_nothing_new_parts_nothing(pair, words):
    """Torque is the same whatever bends; slower than quasi-static is quasi-static."""
    assert not parted(pair, words).parts


def test_of_what_parts_a_pair_the_cheapest_comes_first():
    for tie in poor().ties:
        costs = [each.minutes for each in tie.partings if each.parts]
        assert costs == sorted(costs)
        assert tie.cheapest is (tie.partings[0] if costs else None)


def test_more_reflectors_and_the_torque_part_springs_and_payload():
    torque = Sensor(
        name="torque", quantity="motor_torque", joint="hinge", side="output", rate_hz=10, noise_std=2.0
    )
    model = crane(tracker("tip"), tracker("mid"), torque)
    found = flexarm.plan(model, {"slow": there_and_back(40.0)}, clocks=CLOCKS, frames=FRAMES, n_jobs=1)
    index = [[e.place for e in found.effects].index(place) for place in SOFT]
    factors = found.log_bayes_factor[np.ix_(index, index)]
    assert factors[~np.eye(3, dtype=bool)].min() > SelectionPolicy.reach
    assert not any(found.tie(one, other) for one in SOFT for other in SOFT if one != other)


def test_the_smallest_size_is_proportional_to_the_noise():
    """E ln B ~ (size/noise)^2 where neither clock nor frame is uncertain."""
    exact = {"clocks": {"controller": Clock(), "tracker": Clock()}, "frames": {"tracker": Frame()}}
    sizes = []
    for noise in (5e-5, 2e-4):
        found = flexarm.plan(crane(tracker("tip", noise=noise)), [there_and_back(10.0)], n_jobs=1, **exact)
        sizes.append([found.effect(*place).times for place in SOFT])
    assert np.divide(sizes[1], sizes[0]) == approx(4.0, rel=1e-6)


def test_the_smallest_size_of_a_reflector_offset_is_that_of_its_noise():
    """An offset o along the link moves every sample by o: |gap|^2 = N (o/sigma)^2 in both axes together."""
    exact = {"clocks": {"controller": Clock(), "tracker": Clock()}, "frames": {"tracker": Frame()}}
    found = flexarm.plan(crane(tracker("tip")), [there_and_back(10.0)], n_jobs=1, **exact)
    each = found.effect("reflector_offset", "tip")
    samples, delta = 101, 0.2
    # of the 2 N rows (sin q, cos q) N_v lies between N/2 and 2 N
    for spread, bound in ((samples / 2, "least"), (2 * samples, "most")):
        value = 5e-5 * np.sqrt(2 * SelectionPolicy.strong_evidence * (1 + delta**2 * spread) / samples)
        assert abs(each.least) >= value if bound == "least" else abs(each.least) <= value


def test_without_sensors_a_tracker_is_assumed_and_said():
    found = from_drive("run", there_and_back(10.0), crane())
    assert [(s.point, s.noise_std, s.rate_hz) for s in found.sensors] == [("tip", NOISE["position"], 10.0)]
    assert "no sensors" in found.assumed[0]
    assert found.assumed[1:] == (
        "clocks are known to 2 ms: tracker",
        "registrations are known to 1 mm and 0.5 mrad: tracker",
    )
    assert found.clocks["tracker"].sigma > 0
    assert found.frames["tracker"].translation > 0


def test_assumed_noise_is_told_in_the_unit_of_its_sensor():
    torque = Sensor(
        name="torque", quantity="motor_torque", joint="hinge", side="output", rate_hz=20, clock="controller"
    )
    tip = tracker("tip").replace(noise_std=None, unit="mm")
    found = from_drive("run", there_and_back(10.0), crane(torque, tip))
    assert found.assumed[:2] == (
        "noise of sensor 'torque' is 2 N m (1 sigma), as it states none",
        "noise of sensor 'tip' is 50 µm (1 sigma), as it states none",
    )


def test_a_faster_run_passes_the_same_points_earlier():
    run = from_drive("run", there_and_back(10.0), crane())
    fast, turned = run.faster(2.0), run.turned("hinge", 0.3)
    t = np.linspace(0.0, 5.0, 50)
    assert fast.drive.joints["hinge"](t) == approx(run.drive.joints["hinge"](2 * t), abs=1e-12)
    assert fast.drive.end == approx(5.0)
    assert turned.drive.joints["hinge"](t) == approx(run.drive.joints["hinge"](t) + 0.3, abs=1e-12)


def test_a_record_is_made_again_with_its_sensors_noise_and_payload():
    torque = Sensor(
        name="torque", quantity="motor_torque", joint="hinge", rate_hz=20, noise_std=0.05, clock="controller"
    )
    turn = Sensor(name="turn", quantity="joint_angle", joint="hinge", side="output", rate_hz=20)
    sensors = (tracker("tip"), torque, turn.replace(noise_std=5e-6, clock="controller"))
    run = from_drive("run", there_and_back(4.0), crane(*sensors), CLOCKS, FRAMES)
    record = run.record(crane(), 4e-3, -0.05)
    found = flexarm.plan(crane(), {"again": record}, n_jobs=1)
    assert found.assumed == ()
    again = from_record("again", record, crane()).sensors
    assert [s.replace(unit=None, rate_hz=round(s.rate_hz, 9)) for s in again] == list(run.sensors)
    assert not any("torque" in each.addition for tie in found.ties for each in tie.partings)
    assert found.effect("reflector_offset", "tip").seen
    assert ("time_delay", "tracker") in [e.place for e in found.effects]


def rows_of(record):
    return {name: len(signal) for name, signal in record.signals.items() if name != "hinge"}


@pytest.mark.parametrize("late", [Clock(offset=5.0, sigma=2e-3), Clock(unknown=True)])
def test_stamps_on_another_clock_lose_no_rows(late):
    """The same record, whose tracker counts from 5 s earlier."""
    model = crane(tracker("tip"))
    record = from_drive("run", there_and_back(8.0), model, CLOCKS, FRAMES).record(model, 4e-3, -0.05)
    tip = record.signals["tip"]
    shifted = record.replace(
        signals={**record.signals, "tip": tip.replace(time=tip.time + 5.0)},
        clocks={**record.clocks, "tracker": late},
    )
    again = from_record("again", shifted, model).record(model, 4e-3, -0.05)
    assert rows_of(again) == rows_of(record)
    assert again.signals["tip"].time == approx(tip.time + again.clocks["tracker"].offset, abs=1e-6)


def test_a_drive_that_is_late_against_the_reference_stays_the_runs_time():
    """Offsets count from the reference, stamps of a run from its drive."""
    model = crane(tracker("tip"))
    record = from_drive("run", there_and_back(8.0), model, CLOCKS, FRAMES).record(model, 4e-3, -0.05)
    clocks = {"tracker": Clock(), "controller": Clock(offset=3.0)}
    hinge = record.signals["hinge"]
    shifted = record.replace(
        clocks=clocks,
        signals={**record.signals, "hinge": hinge.replace(time=hinge.time + 3.0)},
    )
    again = from_record("again", shifted, model).record(model, 4e-3, -0.05)
    assert rows_of(again) == rows_of(record)
    compared = flexarm.compare(model, again)
    assert compared.signals["tip"].rms["total"] < 3e-4  # noise of two axes, no shift of the clock


def test_a_faster_run_keeps_sensors_that_begin_late():
    late = tracker("tip").replace(start=6.0)
    run = from_drive("run", there_and_back(10.0), crane(late), CLOCKS, FRAMES)
    assert len(run.faster(2.0).record(crane(), 4e-3, -0.05).signals["tip"]) > 10


def test_a_record_is_made_again_with_its_gains():
    """The encoder lags behind the command by about one over the gain of the record, not of the model."""
    slack = Cascade(joint="hinge", position_gain=4.0, velocity_gain=2e3, sample_time=4e-3)
    model = crane(tracker("tip"))
    [motor] = model.joints
    model = model.replace(joints=[motor.replace(rotor_inertia=5e-3)], gravity=(0, 0, 0), controllers=[slack])
    time = np.linspace(0.0, 4.0, 1001)
    command = flexarm.Drive.from_samples(time, {"hinge": 0.1 * time**2}, side="command")
    sensors = [
        Sensor(name=name, quantity=quantity, joint="hinge", rate_hz=250)
        for name, quantity in (("told", "joint_command"), ("encoder", "joint_angle"))
    ]
    tight = {"hinge": {"position_gain": 8.0}}
    run = flexarm.simulate(flexarm.Record(signals={}, controllers=tight).applied_to(model), command)
    record = flexarm.measure(run, sensors, np.random.default_rng(0), drive=["told"], controllers=tight)
    again = from_record("again", record, model).record(model, 4e-3, -0.05)
    shown, expected = (each.signals["encoder"] for each in (again, record))
    there = np.interp(3.0, expected.time, expected.values[:, 0])
    assert np.interp(3.0, shown.time, shown.values[:, 0]) == approx(there, abs=1e-3)


def test_the_file_holds_what_is_printed():
    found = poor()
    report = found.to_json_dict()
    assert json.loads(json.dumps(report, allow_nan=False)) == report
    assert len(report["effects"]) == len(found.effects) == len(report["log_bayes_factor"])
    assert report["ties"][0]["additions"][0]["addition"] in found.summary()
    assert found.headline() in found.summary()


@pytest.mark.parametrize(("side", "share"), [("output", 1.0), ("motor", 1 / 120)])
def test_a_torque_that_states_no_noise_has_as_much_on_either_side_of_the_gear(side, share):
    torque = Sensor(name="torque", quantity="motor_torque", joint="hinge", side=side, rate_hz=20)
    planned = from_drive("run", there_and_back(4.0), crane(torque))
    [assumed] = planned.sensors
    assert assumed.noise_std == approx(share * NOISE["motor_torque"])
    record = planned.record(crane(), 4e-3, -0.05)
    silent = {**record.signals, "torque": record.signals["torque"].replace(noise_std=None)}
    [again] = from_record("again", record.replace(signals=silent), crane()).sensors
    assert again.noise_std == approx(assumed.noise_std)


def test_an_arm_without_trackers_is_offered_reflectors():
    gyro = Sensor(name="gyro", quantity="angular_rate", point="tip", axes=("y",), rate_hz=50, noise_std=1e-4)
    run = from_drive("run", there_and_back(4.0), crane(gyro))
    offered = menu(crane(gyro), [run], run.run(crane(gyro), 4e-3, -0.05))
    reflectors = [each for addition in offered for each in addition.sensors if addition.points]
    assert reflectors
    assert {each.axes for each in reflectors} == {("x", "y", "z")}


def test_a_plan_without_motion_is_refused():
    with pytest.raises(flexarm.InvalidParameter, match="at least one motion"):
        flexarm.plan(crane(), {})


def test_why_the_friction_of_a_rigid_joint_is_not_seen_is_said():
    """The drive takes the torque; with a spring in the hinge, or the torque logged, it shows."""
    hinge = Sensor(
        name="torque", quantity="motor_torque", joint="hinge", side="motor", rate_hz=20, noise_std=0.01
    )
    found = {}
    for name, sensors in (("blind", ()), ("logged", (hinge,))):
        model = crane(tracker("tip"), *sensors)
        stiff = model.without_effect("joint_compliance", "hinge") if model.effects else model
        found[name] = flexarm.plan(
            stiff, {"slow": there_and_back(10.0)}, clocks=CLOCKS, frames=FRAMES, n_jobs=1
        )
    blind = found["blind"].effect("viscous_friction", "hinge")
    assert not blind.seen
    assert blind.hidden.startswith("hinge is rigid in the model")
    assert blind.hidden in str(found["blind"])
    assert found["logged"].effect("viscous_friction", "hinge").hidden == ""


def test_evidence_of_rounding_is_none():
    assert [_evidence(each) for each in (5e-21, 0.25, 18225.0, np.nan)] == ["0", "0.250", "18225", "–"]
