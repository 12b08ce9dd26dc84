"""One name of a frame or a clock in several records is one frame and one clock, or the check says so."""

import re

import numpy as np
import pytest
from arms import compliance, smooth_step, waist_and_elbow

import flexarm
from flexarm.measurement import ClockError, Registration
from flexarm.record import Clock, Frame
from flexarm.validation.sensor_check import check, clean_records

FAR = Registration(origin=(4.0, 1.0, 0.5), rpy=(0.0, 0.0, 2.0))


def arm(*effects: dict, mass: float = 5.0) -> flexarm.Arm:
    load = {"name": "load", "link": "rod", "position": [1.5, 0, 0], "mass": mass}
    return waist_and_elbow({"clock": "tracker", "noise_std": 5e-5}, payloads=[load], effects=list(effects))


SOFT = [compliance(joint, 8e4, 200.0) for joint in ("waist", "elbow")]


def swing(
    truth: flexarm.Arm, far: Registration, seed: int, delay: float = 0.0, frame: Frame | None = None
) -> flexarm.Record:
    t = np.linspace(0, 6, 301)
    s = smooth_step(t / 6)
    drive = flexarm.Drive.from_samples(
        t, {"waist": 1.5 * s, "elbow": 0.6 * np.sin(2 * np.pi * s) + 0.1 * seed * s}
    )
    return flexarm.measure(
        flexarm.simulate(truth, drive, step=5e-3),
        truth.sensors,
        np.random.default_rng(seed),
        drive=["waist", "elbow"],
        clocks={"robot": Clock(), "tracker": Clock(sigma=0.05)},
        clock_errors={"tracker": ClockError(delay=delay)},
        frames={"tracker": Frame(unknown=True) if frame is None else frame},
        registrations={"tracker": far},
    )


def said(records: dict[str, flexarm.Record]) -> list[str]:
    return [remark for remark in check(arm(), records).remarks if "do not share" in remark]


def test_two_stations_under_one_name_are_told_with_their_difference():
    turned = Registration(origin=FAR.origin, rpy=(0.0, 0.034, 2.0))
    records = {"flat": swing(arm(*SOFT), FAR, 1), "pallet": swing(arm(*SOFT), turned, 2)}
    [remark] = said(records)
    assert remark.startswith("flat and pallet do not share the frame tracker")
    told = re.search(r"stands ([0-9.]+) mrad apart", remark)
    assert told and float(told[1]) == pytest.approx(34, abs=1.5)
    assert "one pose for both leaves" in remark


def test_what_nobody_knows_and_records_do_not_share_is_fitted_by_itself():
    """Two stations and two starts of a tracker under one name each; a third record is as the first."""
    moved = Registration(origin=(3.5, 1.0, 0.5), rpy=(0.0, 0.0, 1.0))
    unknown = {"robot": Clock(), "tracker": Clock(unknown=True)}
    records = {
        name: swing(arm(*SOFT), far, seed, delay).replace(clocks=unknown)
        for name, far, seed, delay in (("a", FAR, 1, 0.01), ("b", moved, 2, 0.04), ("c", FAR, 3, 0.01))
    }
    for found in (check(arm(*SOFT), records), clean_records(arm(*SOFT), records)):
        for name, place in (("a", "tracker"), ("b", "tracker-2"), ("c", "tracker")):
            record = found.records[name]
            assert list(record.frames) == [place] and place in record.clocks
            assert (record.signals["tip"].frame, record.signals["tip"].clock) == (place, place)
        told = [remark for remark in found.remarks if "is fitted by itself, as tracker-2" in remark]
        assert len(told) == 2


def test_a_frame_that_the_model_names_keeps_its_name():
    moved = Registration(origin=(3.5, 1.0, 0.5), rpy=(0.0, 0.0, 1.0))
    records = {"a": swing(arm(*SOFT), FAR, 1), "b": swing(arm(*SOFT), moved, 2)}
    drifting = arm(*SOFT, {"name": "frame_drift", "at": "tracker", "velocity": [1e-6, 0, 0]})
    found = check(drifting, records)
    assert all("tracker" in record.frames for record in found.records.values())
    assert any("give the frame two names" in remark for remark in found.remarks)


@pytest.mark.slow
def test_a_diagnosis_says_it_beside_its_gaps():
    turned = Registration(origin=FAR.origin, rpy=(0.0, 0.034, 2.0))
    records = {"flat": swing(arm(*SOFT), FAR, 1), "pallet": swing(arm(*SOFT), turned, 2)}
    found = flexarm.diagnose(arm(*SOFT), records)
    assert "flat and pallet do not share the frame tracker" in " ".join(found.summary().split())


@pytest.mark.parametrize("frame", [Frame(unknown=True), Frame(xyz=FAR.origin, rpy=FAR.rpy, translation=1e-3)])
@pytest.mark.parametrize("mass", [5.0, 15.0])
def test_one_station_is_not_told_apart_by_what_the_model_misses(frame, mass):
    """Soft joints and another payload, which the nominal model does not know."""
    records = {
        "a": swing(arm(*SOFT), FAR, 1, frame=frame),
        "b": swing(arm(*SOFT, mass=mass), FAR, 2, frame=frame),
    }
    assert said(records) == []


def test_a_clock_that_was_set_anew_is_told():
    records = {"a": swing(arm(*SOFT), FAR, 1, 0.01), "b": swing(arm(*SOFT), FAR, 2, 0.04)}
    [remark] = said(records)
    assert remark.startswith("a and b do not share the clock tracker")
    ends = [float(x) for x in re.findall(r"(-?[0-9.]+) ms in the", remark)]
    assert ends == pytest.approx([10, 40], abs=1.5)


def test_a_frame_of_which_axes_are_missing_is_not_turned_about_them():
    """x and z in one record, x and y in the other."""
    records = {"a": swing(arm(*SOFT), FAR, 1), "b": swing(arm(*SOFT), FAR, 2)}
    stated = Frame(xyz=FAR.origin, rpy=FAR.rpy, translation=1e-3, rotation=1e-3)
    for (name, record), axes in zip(list(records.items()), ((0, 2), (0, 1)), strict=True):
        tip = record.signals["tip"]
        part = tip.replace(values=tip.values[:, axes], axes=tuple("xyz"[k] for k in axes), channels=())
        records[name] = record.replace(signals={**record.signals, "tip": part}, frames={"tracker": stated})
    assert said(records) == []


def on_one_clock(record: flexarm.Record, late: float) -> flexarm.Record:
    """Return the record with all stamps of the robot's clock, those of the tip later by so much [s]."""
    tip = record.signals["tip"]
    shifted = tip.replace(time=tip.time + late, clock="robot")
    return record.replace(signals={**record.signals, "tip": shifted}, clocks={"robot": Clock()})


def lateness(records: dict[str, flexarm.Record]) -> list[str]:
    return [remark for remark in check(arm(), records).remarks if " on the clock " in remark]


@pytest.mark.parametrize("late", [0.35, -0.2])
def test_a_signal_that_is_late_on_the_clock_of_the_joints_is_told(late):
    """As logs are whose tracker began later: both stamped from their own start."""
    frame = Frame(xyz=FAR.origin, rpy=FAR.rpy, translation=1e-3)
    [remark] = lateness({"a": on_one_clock(swing(arm(*SOFT), FAR, 1, frame=frame), late)})
    told = re.search(r"a: tip comes ([0-9.]+) (m?)s (late|early) on the clock robot", remark)
    assert told and told[3] == ("late" if late > 0 else "early")
    assert float(told[1]) * (1e-3 if told[2] else 1.0) == pytest.approx(abs(late), abs=5e-3)


@pytest.mark.parametrize("effects", [[], SOFT])
def test_what_the_model_misses_is_no_lateness(effects):
    frame = Frame(xyz=FAR.origin, rpy=FAR.rpy, translation=1e-3)
    assert lateness({"a": on_one_clock(swing(arm(*effects), FAR, 1, frame=frame), 0.0)}) == []
