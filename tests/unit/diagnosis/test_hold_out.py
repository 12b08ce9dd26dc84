"""What is held out, and how far it lies from the training."""

from dataclasses import replace

import diagnoses
import numpy as np
import pytest
from arms import PAYLOAD, crane
from planted import two_joints

import flexarm
from flexarm import Record, Signal
from flexarm.diagnosis.hold_out import hold_back, hold_out_kind, named_hold_out, split
from flexarm.effects import PayloadMass
from flexarm.errors import InvalidParameter
from flexarm.record.table import CarriedPayload, Clock, DrawnLink
from flexarm.validation.finding import ValidationResult
from flexarm.validation.sensor_check import clean_records

TIME = np.arange(0.0, 20.0, 0.02)
ARM = crane()


def record(amplitude=1.0, frequency=0.2, mass=None):
    angle = amplitude * np.sin(2 * np.pi * frequency * TIME)
    signals = [
        Signal(name="hinge", quantity="joint_angle", values=angle, time=TIME, joint="hinge", side="motor"),
        Signal(name="tip", quantity="position", values=np.sin(angle), time=TIME, point="tip", axes=("x",)),
    ]
    payloads = {} if mass is None else {"load": CarriedPayload(mass=mass)}
    return Record(signals={s.name: s for s in signals}, drive=("hinge",), payloads=payloads)


def poses(count=10, masses=None):
    """A static record of a tip in as many poses, or with as many masses."""
    names = np.array([f"p{k}" for k in range(count if masses is None else len(masses))])
    of_all = {"pose": names}
    signals = [
        Signal(
            name="hinge",
            quantity="joint_angle",
            values=np.linspace(-1, 1, len(names)),
            joint="hinge",
            **of_all,
        ),
        Signal(
            name="tip", quantity="position", values=np.zeros(len(names)), point="tip", axes=("x",), **of_all
        ),
    ]
    if masses is not None:
        signals.append(Signal(name="mass", quantity="payload_mass", values=masses, payload="load", **of_all))
    return Record(kind="static", signals=signals, drive=("hinge",))


def test_every_row_of_evidence_is_in_one_of_the_parts():
    whole = record()
    fitted, held = hold_back(whole)
    inside = np.isfinite(fitted.signals["tip"].values[:, 0])
    back = np.isfinite(held.signals["tip"].values[:, 0])
    assert np.array_equal(inside, ~back)
    assert back.mean() == pytest.approx(0.2, abs=0.01)


def test_the_drive_stays_whole_in_both_parts():
    whole = record()
    for part in hold_back(whole):
        assert np.array_equal(part.signals["hinge"].values, whole.signals["hinge"].values)


def test_blocks_are_stretches_of_time():
    _, held = hold_back(record())
    back = np.isfinite(held.signals["tip"].values[:, 0])
    assert np.abs(np.diff(back.astype(int))).sum() <= 8  # four blocks have eight ends


@pytest.mark.parametrize("clock", [Clock(offset=1000.0, sigma=2e-3), Clock(unknown=True)])
def test_blocks_are_the_same_by_any_clock(clock):
    """A tracker whose stamps are 1000 s late loses the same rows as one with the clock of the drive."""
    whole = record()
    tip = whole.signals["tip"]
    late = tip.replace(time=TIME + 1000.0, clock="tracker")
    other = whole.replace(signals=[whole.signals["hinge"], late], clocks={"clock": Clock(), "tracker": clock})
    for part, late_part in zip(hold_back(whole), hold_back(other), strict=True):
        assert np.array_equal(part.signals["tip"].valid, late_part.signals["tip"].valid)


def test_a_pose_is_held_back_of_all_signals():
    """Whatever the order in which a second instrument saw which of them."""
    whole = poses(10)
    tip = whole.signals["tip"]
    again = tip.replace(name="again", values=tip.values[::-1][:7], pose=tip.pose[::-1][:7])
    _, held = hold_back(whole.replace(signals={**whole.signals, "again": again}))
    back = {name: set(held.signals[name].pose[held.signals[name].valid]) for name in ("tip", "again")}
    assert back == {"tip": {"p4", "p9"}, "again": {"p4", "p9"}}


def test_what_would_be_left_with_nothing_is_not_parted():
    """Four poses, or a tip that is seen in none of the blocks that are held back."""
    whole = record()
    tip = whole.signals["tip"]
    early = tip.replace(values=np.where(TIME[:, None] < 1.0, tip.values, np.nan))
    torque = tip.replace(
        name="torque", quantity="motor_torque", joint="hinge", point=None, axes=(), unit="N m"
    )
    both = whole.replace(signals=[whole.signals["hinge"], early, torque])
    assert hold_back(poses(4)) == (poses(4), None)
    assert hold_back(poses(5))[1] is not None
    assert hold_back(both)[1] is not None
    assert hold_back(both, ["tip"]) == (both, None)  # the model does not predict the torque


@pytest.mark.parametrize(
    ("held_out", "kind"),
    [
        (record(), "repetition"),
        (record(mass=5.0), "extrapolation"),
        (record(amplitude=0.8), "interpolation"),
        (record(amplitude=1.4), "extrapolation"),
        (record(frequency=0.4), "extrapolation"),
    ],
)
def test_a_held_out_record_is_told_by_payload_range_and_rate(held_out, kind):
    training = {"large": record(), "small": record(amplitude=0.5, frequency=0.2)}
    assert hold_out_kind(ARM, training, held_out)[0] == kind


def test_a_payload_between_those_of_training_is_interpolation():
    training = {"light": record(mass=2.0), "heavy": record(mass=10.0)}
    assert hold_out_kind(ARM, training, record(mass=6.0))[0] == "interpolation"


@pytest.mark.parametrize(
    ("mass", "kind"),
    [(PAYLOAD, "repetition"), (10.0, "interpolation"), (3.0, "extrapolation"), (20.0, "extrapolation")],
)
def test_a_payload_that_was_not_weighed_has_the_mass_of_the_model(mass, kind):
    """14.1 kg, or what an effect makes of it."""
    assert hold_out_kind(ARM, {"nominal": record(), "light": record(mass=5.0)}, record(mass=mass))[0] == kind
    changed = ARM.with_effect(PayloadMass(at="load", mass=5.0))
    assert (
        hold_out_kind(changed, {"changed": record(), "heavy": record(mass=PAYLOAD)}, record(mass=mass))[0]
        == kind
    )


def test_payloads_are_compared_by_name():
    """Two that weigh 10 kg together are not what 2 and 8 kg are."""
    one = {"link": "rod", "position": [0, 0, 3.0]}
    both = crane(payloads=[{"name": "load", "mass": 2.0, **one}, {"name": "tool", "mass": 8.0, **one}])
    swapped = replace(record(), payloads={"load": CarriedPayload(mass=8.0), "tool": CarriedPayload(mass=2.0)})
    assert hold_out_kind(both, {"a": record()}, swapped)[0] == "extrapolation"
    assert hold_out_kind(both, {"a": record()}, swapped)[1] == (
        "payload load weighs 8.00 kg, in the training 2.00 kg at most; "
        "payload tool weighs 2.00 kg, in the training 8.00 kg at least"
    )


def test_masses_of_poses_are_those_that_were_weighed():
    training, heavier = poses(masses=[0.0, 5.0, 10.0]), poses(masses=[5.0, 10.0, 20.0])
    assert hold_out_kind(ARM, {"a": training}, poses(masses=[0.0, 5.0, 10.0]))[0] == "repetition"
    assert hold_out_kind(ARM, {"a": training}, heavier)[1] == (
        "the payload weighs 20.0 kg, in the training 10.0 kg at most"
    )


def test_drives_are_compared_by_joint():
    """A swing of the elbow is not one of the shoulder, and the order of two drives says nothing."""

    def driven(*joints):
        angles = [0.3 * (k + 1) * np.sin(TIME) for k in range(len(joints))]
        signals = [
            Signal(name=name, quantity="joint_angle", values=angle, time=TIME, joint=name)
            for name, angle in zip(joints, angles, strict=True)
        ]
        return Record(signals=signals, drive=joints)

    both = driven("shoulder", "elbow")
    other_order = replace(both, drive=("elbow", "shoulder"))
    assert hold_out_kind(two_joints(), {"a": both}, other_order)[0] == "repetition"
    assert hold_out_kind(two_joints(), {"a": both}, driven("elbow", "shoulder"))[0] == "extrapolation"
    assert hold_out_kind(two_joints(), {"a": driven("elbow")}, driven("shoulder"))[1].startswith(
        "it drives other joints"
    )


def test_another_number_of_drives_is_extrapolation():
    lone = record()
    assert hold_out_kind(ARM, {"a": lone}, replace(lone, drive=()))[0] == "extrapolation"


@pytest.mark.parametrize(
    ("length", "kind"), [(1.0, "repetition"), (1.5, "interpolation"), (2.0, "extrapolation")]
)
def test_a_boom_that_was_drawn_out_further_than_ever_is_extrapolation(length, kind):
    def out(length):
        return replace(record(), links={"rod": DrawnLink(length=length)})

    assert hold_out_kind(ARM, {"short": out(1.0), "middle": out(1.8)}, out(length))[0] == kind
    assert hold_out_kind(ARM, {"no boom": record()}, out(length))[0] == "extrapolation"


@pytest.mark.parametrize(
    ("held_out", "why"),
    [
        (record(), ""),
        (record(amplitude=0.3, frequency=0.35), ""),  # a smaller range is nothing new, at a rate between them
        (
            record(amplitude=1.4, frequency=0.15),
            "hinge goes down to -1.40 rad, in the training -1.00 rad at least; hinge goes up to 1.40 rad, "
            "in the training 1.00 rad at most",
        ),
        (record(frequency=0.4), "the rms rate of hinge is 1.77 rad/s, in the training 0.886 rad/s at most"),
        (record(mass=5.0), "the payload weighs 5.00 kg, in the training 14.1 kg at least"),
    ],
)
def test_what_is_beyond_the_training_is_said(held_out, why):
    training = {"large": record(), "small": record(amplitude=0.5, frequency=0.2)}
    assert hold_out_kind(ARM, training, held_out)[1] == why
    assert (hold_out_kind(ARM, training, held_out)[0] == "extrapolation") == bool(why)


def test_other_joints_are_said():
    lone = record()
    assert hold_out_kind(ARM, {"a": lone}, replace(lone, drive=()))[1].startswith("it drives other joints")


def test_the_record_held_out_is_named_like_those_of_the_training(tmp_path):
    """Two tests may each have a record of one name; the folder above then tells them apart, here as there."""
    path = tmp_path / "test_2/by_reference"
    record().save(path)
    held = Record.load(path)
    assert named_hold_out(ARM, held, {"test_3/by_reference": record(0.9)}).keys() == {"test_2/by_reference"}
    assert named_hold_out(ARM, held, {"test_3": record(0.9)}).keys() == {"by_reference"}
    assert named_hold_out(ARM, held, {"by_reference": record(0.9)}).keys() == {"by_reference (held out)"}


@pytest.mark.parametrize(
    ("held_out", "what"),
    [
        (replace(record(), payloads={"crate": CarriedPayload(mass=5.0)}), "there is no payload 'crate'"),
        ([record()], "must be a Record"),
    ],
)
def test_a_record_held_out_that_does_not_fit_the_model_is_told_before_anything_is_simulated(held_out, what):
    begun = []
    with pytest.raises(InvalidParameter, match=what):
        flexarm.diagnose(ARM, {"a": record()}, held_out, progress=lambda done, what: begun.append(what))
    assert not begun


def test_outliers_of_a_record_held_out_are_removed_and_told():
    """As those of the training are, 0.5 m off at a gap of 7 mm."""
    training, held_out = diagnoses.record(1), diagnoses.record(3, 0.2)
    tip = held_out.signals["tip"]
    values = tip.values.copy()
    values[[30, 70]] += 0.5
    odd = held_out.replace(signals={**held_out.signals, "tip": tip.replace(values=values)})
    clean = clean_records(diagnoses.nominal(), {"other": odd}, step=0.01)
    parted = split(diagnoses.nominal(), ValidationResult({"swing": training}), clean)
    seen = parted.held_out["other"].signals["tip"]
    assert np.flatnonzero(~seen.valid).tolist() == [30, 70]
    assert parted.training == {"swing": training}
    assert parted.remarks == ("2 outliers of tip in other, rows 30, 70, 0.707 m off, removed",)


def test_a_record_that_is_fitted_is_not_held_out_under_another_name():
    training = diagnoses.record(1)
    copy = training.replace(description="the same day, copied")
    with pytest.raises(
        InvalidParameter, match=r"hold_out: holds the same values as 'swing', which is fitted"
    ):
        flexarm.diagnose(diagnoses.nominal(), {"swing": training}, hold_out=copy)


def test_ends_of_a_range_count_beside_the_range():
    """A spline's overshoot of a nanometre below zero is nothing new beside a swing."""

    def lifted(least):
        swing = record()
        hinge = swing.signals["hinge"]
        values = np.maximum(np.abs(hinge.values), 0.0) + least
        return swing.replace(signals={**swing.signals, "hinge": hinge.replace(values=values)})

    training, held_out = {"one": lifted(-7e-11)}, lifted(-8e-10)
    assert hold_out_kind(ARM, training, held_out)[0] == "repetition"
    assert hold_out_kind(ARM, training, held_out)[1] == ""
