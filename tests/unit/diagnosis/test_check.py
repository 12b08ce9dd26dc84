"""Sensor faults in records of an independent simulator are named, missing effects are not taken for them.

The records come from a chain of rigid rods (`tests/blind`), the nominal model from flexarm; noise, a late
tracker and its registration are in them. Faults are put on the readings by hand.
"""

import re
from dataclasses import replace

import numpy as np
import pytest
from arms import EI, LENGTH, PAYLOAD, RHO_A, paper_arm
from chain import Base, Link
from hub import Hub
from joint_motions import Stops
from motion import Arm
from swings import Swing
from virtual_lab import Lab, Nuisances, record

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.effects import SignError
from flexarm.validation.saturation import _cut
from flexarm.validation.sensor_check import check

LAB = Lab()
SWING = Swing(0.6, 5.0, 3.0, middle=0.1)
HUB = Hub(stiffness=1e5, damping=200.0)
RODS = Arm(Link(LENGTH, EI, RHO_A, mass=PAYLOAD), HUB)


@pytest.fixture(scope="module")
def nominal() -> flexarm.Arm:
    """flexarm's model of the same arm."""
    arm = paper_arm(4, 1e5)
    return arm.with_effect(arm.effects[0].model_copy(update={"damping": 200.0}))


def lab_record(rods: Arm, seed: int = 7) -> flexarm.Record:
    rng = np.random.default_rng(seed)
    return record(rods, SWING, 12.0, rng, LAB, Nuisances.drawn(LAB, rng))


@pytest.fixture(scope="module")
def faultless() -> flexarm.Record:
    return lab_record(RODS)


def changed(rec: flexarm.Record, name: str, change) -> flexarm.Record:
    """The record with a signal's readings changed."""
    signal = rec.signals[name]
    values = change(signal.values.copy())
    return rec.replace(signals={**rec.signals, name: signal.replace(values=values)})


def column(k: int, change):
    """A change of one channel."""

    def all_of(values):
        values[:, k] = change(values[:, k])
        return values

    return all_of


def frozen_at(fraction: float):
    """A channel that repeats what it shows after a fraction of the rows."""

    def change(y):
        at = int(fraction * len(y))
        return np.append(y[:at], np.full(len(y) - at, y[np.isfinite(y)][0] if at == 0 else y[:at][-1]))

    return change


FAULTS = {
    "tip x flipped": ("tip", column(0, lambda y: -y), "sign_error", ("x",), {}),
    "tip in millimetres": ("tip", lambda y: 1e3 * y, "unit_error", (), {"factor": (1e3, 0.02)}),
    "tip z in inches": (
        "tip",
        column(1, lambda y: y / 0.0254),
        "unit_error",
        ("z",),
        {"factor": (39.37, 0.02)},
    ),
    "tip x dead": ("tip", column(0, lambda y: 0 * y + 0.2), "dead_channel", ("x",), {"value": (0.2, 1e-9)}),
    "tip frozen": ("tip", column(0, frozen_at(0.6)), "dead_channel", ("x",), {}),
    "tip x cut off": (
        "tip",
        column(0, lambda y: np.clip(y, -1.2, 1.2)),
        "saturation",
        ("x",),
        {"limit": (1.2, 1e-6)},
    ),
    "torque flipped": ("torque", lambda y: -y, "sign_error", (), {}),
    "torque in kN m": ("torque", lambda y: 1e-3 * y, "unit_error", (), {"factor": (1e-3, 0.05)}),
    "torque flipped, in kN m": ("torque", lambda y: -1e-3 * y, "unit_error", (), {"factor": (-1e-3, 0.05)}),
    "torque dead": ("torque", lambda y: 0 * y, "dead_channel", (), {"value": (0.0, 1e-9)}),
    "torque cut off": (
        "torque",
        lambda y: np.clip(y, -150.0, 150.0),
        "saturation",
        (),
        {"limit": (150.0, 1e-6)},
    ),
    "encoder flipped": ("hinge", lambda y: -y, "sign_error", (), {}),
    "encoder in degrees": ("hinge", np.degrees, "unit_error", (), {"factor": (180 / np.pi, 0.02)}),
    "encoder cut off": ("hinge", lambda y: np.clip(y, -0.4, 0.4), "saturation", (), {"limit": (0.4, 1e-6)}),
}


@pytest.mark.parametrize("what", FAULTS)
def test_a_faulty_sensor_is_named(nominal, faultless, what):
    """The sensor, its channels and the size of the fault, and nothing else at fault."""
    signal, change, name, channels, parameters = FAULTS[what]
    found = check(nominal, {"run": changed(faultless, signal, change)})
    assert [(fault.name, fault.at, fault.channels) for fault in found.faults] == [(name, signal, channels)]
    fault = found.faults[0]
    assert fault.probability > 0.99
    assert fault.records == ("run",)
    estimates = {each.name: each.value for each in fault.parameters}
    for key, (value, relative) in parameters.items():
        assert estimates[key] == pytest.approx(value, rel=relative, abs=1e-12)
    assert fault.effect().at == signal


def test_a_noisy_range_end_piles_readings_up_and_a_turning_point_does_not():
    """Cut at 0.8 before the noise is added: a range ends. A slow turn at the top with as many rows: not."""
    rng, time = np.random.default_rng(4), np.arange(0, 40, 0.05)
    motion, noise = np.sin(0.6 * time), 0.01
    cut = np.minimum(motion, 0.8) + noise * rng.standard_normal(len(time))
    turning = 0.8 * motion + noise * rng.standard_normal(len(time))
    assert _cut(cut, motion, noise, noise) is not None
    assert _cut(turning, motion, noise, noise) is None


@pytest.mark.parametrize("seed", range(8))
def test_a_smooth_maximum_below_that_of_the_model_is_no_range_end(seed):
    """A model without damping rings beyond it."""
    rng, time, noise = np.random.default_rng(seed), np.arange(0, 40, 0.05), 2e-3
    motion = np.exp(-(((time - 20) / 8) ** 2))
    model = motion + 0.2 * np.exp(-((time - 20) ** 2))
    assert _cut(motion + noise * rng.standard_normal(len(time)), model, noise, noise) is None


def test_an_arm_that_friction_holds_at_its_least_is_no_range_end():
    """It rests 20 sigma short of where the model goes, 2 % of the motion."""
    rng, time = np.random.default_rng(5), np.arange(0, 40, 0.05)
    motion, noise = np.where(time < 20, np.cos(np.pi * time / 20), -1.0), 1e-3
    held = np.maximum(motion, -0.98) + noise * rng.standard_normal(len(time))
    assert _cut(-held, -motion, noise, noise) is None


def test_an_arm_that_rests_on_both_sides_of_upright_is_no_range_end():
    """Its base leans by 3 mrad: equal heights where the model says 0.4 mm more and less, of 3 m."""
    rng, time = np.random.default_rng(6), np.arange(0, 24, 0.1)
    lean, aside, noise = 3e-3, 0.09, 4e-5
    rests = [-0.02, aside - lean, -0.02, -aside - lean, -aside - lean]
    angle = Stops(rests, [2, 7, 13, 20], [2, 2, 2, 2])(time)[0]
    height = LENGTH / 2 * np.cos(angle + lean) + noise * rng.standard_normal(len(time))
    assert _cut(-height, -LENGTH / 2 * np.cos(angle), noise, 1e-3 * LENGTH) is None


def test_data_in_order_are_left_as_they_are(nominal, faultless):
    """No fault, no outlier, no remark; the record that comes back is the one that went in."""
    found = check(nominal, [faultless])
    assert found.usable
    assert (found.faults, found.outliers, found.remarks) == ((), (), ())
    assert found.records == {"record_1": faultless}


HIDDEN = {
    "a joint ten times softer": replace(RODS, hub=replace(HUB, stiffness=1e4)),
    "backlash of 10 mrad": replace(RODS, hub=replace(HUB, gap=1e-2)),
    "friction of 80 N m": replace(RODS, hub=replace(HUB, coulomb=80.0)),
    "a payload twice as heavy": replace(RODS, link=replace(RODS.link, mass=2 * PAYLOAD)),
    "a link half as stiff": replace(RODS, link=replace(RODS.link, EI=EI / 2)),
    "a base that leans by 20 mrad": replace(RODS, base=Base(tilt=0.02)),
    "a ratio that is 5 % off": replace(RODS, hub=replace(HUB, ratio_scale=1.05)),
}


@pytest.mark.slow
@pytest.mark.parametrize("what", HIDDEN)
def test_a_missing_effect_is_no_faulty_sensor(nominal, what):
    """Gaps of centimetres and torques that are twice as large are physics."""
    found = check(nominal, [lab_record(HIDDEN[what])])
    assert found.faults == ()
    assert found.outliers == ()


def test_a_fault_shows_beside_a_missing_effect(nominal):
    """The tip counts x the other way, on an arm whose joint is three times softer than the model's."""
    soft = lab_record(replace(RODS, hub=replace(HUB, stiffness=3e4)))
    found = check(nominal, [changed(soft, "tip", column(0, lambda y: -y))])
    assert [fault.effect() for fault in found.faults] == [SignError(at="tip", channels=("x",))]


def test_spikes_are_removed_and_said(nominal, faultless):
    """Every one of eight samples 5 cm off, the first and the last too, and no other; no sensor is faulty."""
    rng = np.random.default_rng(3)
    good = np.flatnonzero(faultless.signals["tip"].valid)
    rows = np.array([good[0], *np.sort(rng.choice(good[3:-3:4], 6, replace=False)), good[-1]])

    def thrown(values):
        values[rows] += 0.05 * np.sign(rng.standard_normal((8, 2)))
        return values

    found = check(nominal, {"run": changed(faultless, "tip", thrown)})
    assert found.usable
    assert [(each.record, each.signal, each.rows) for each in found.outliers] == [("run", "tip", tuple(rows))]
    assert found.outliers[0].size == pytest.approx(0.05 * np.sqrt(2), rel=0.05)  # along both axes
    assert f"of tip in run, rows {rows[0]}, " in str(found.outliers[0])
    assert not found.records["run"].signals["tip"].valid[rows].any()


def test_zeros_of_a_tracker_that_lost_its_target_are_removed_and_said(nominal, faultless):
    def lost(values):
        values[40:45] = 0.0
        return values

    found = check(nominal, {"run": changed(faultless, "tip", lost)})
    assert found.usable
    assert "run: tip holds zeros in all axes, removed: rows 40, 41, 42, 43, 44" in found.remarks
    assert not found.records["run"].signals["tip"].valid[40:45].any()


def test_a_spiky_encoder_drives_the_model_smoothly(nominal, faultless):
    """Eleven samples of the drive 20 mrad off, the first too, are taken out before they shake the model."""
    rows = np.array([0, *np.arange(100, 2100, 200)])

    def thrown(values):
        values[rows] += 0.02
        return values

    found = check(nominal, {"run": changed(faultless, "hinge", thrown)})
    assert found.usable
    assert [(each.signal, each.rows) for each in found.outliers] == [("hinge", tuple(rows))]


def shifted(rec: flexarm.Record, change) -> flexarm.Record:
    """The record with the tracker's stamps changed."""
    tip = rec.signals["tip"]
    return rec.replace(signals={**rec.signals, "tip": tip.replace(time=change(tip.time))})


def test_a_clock_that_jumps_is_said(nominal, faultless):
    """The tracker's stamps are 15 ms later from t = 6 s on: a remark with the size, and no fault."""
    found = check(nominal, {"run": shifted(faultless, lambda t: t + 0.015 * (t > 6))})
    assert found.usable
    (remark,) = found.remarks
    step, at = re.fullmatch(r"run: the clock tracker jumps by (\S+) ms near t = (\S+) s, .*", remark).groups()
    assert float(step) == pytest.approx(15, abs=1)
    assert float(at) == pytest.approx(6, abs=0.5)


def test_a_jump_that_one_axis_alone_shows_is_no_clocks(nominal, faultless):
    """An effect that the model lacks may look so along one axis; a clock moves all axes."""
    tip = faultless.signals["tip"]
    late = np.interp(tip.time - 0.015 * (tip.time > 6), tip.time, tip.values[:, 0])

    def deformed(values):
        values[:, 0] = late
        return values

    found = check(nominal, {"run": changed(faultless, "tip", deformed)})
    assert not [remark for remark in found.remarks if "jumps" in remark]


def test_a_drive_with_stamps_in_milliseconds_is_doubted_without_trials(nominal, faultless, monkeypatch):
    """A record of 12 s would last for hours, and so would each trial of a wrong unit or sign."""

    def find_drive_fault(*given):
        raise AssertionError("no hypothesis is to be simulated")

    monkeypatch.setattr("flexarm.validation.sensor_check.find_drive_fault", find_drive_fault)
    hinge = faultless.signals["hinge"]
    slow = hinge.replace(time=1e3 * hinge.time[::20], values=hinge.values[::20])
    found = check(nominal, {"run": faultless.replace(signals={**faultless.signals, "hinge": slow})})
    assert not found.judged
    assert any('time_unit = "ms"' in doubt for doubt in found.doubts)


@pytest.mark.parametrize("judge", [flexarm.compare, flexarm.diagnose, flexarm.calibrate])
def test_a_drive_with_stamps_in_milliseconds_is_not_simulated(nominal, faultless, judge):
    hinge = faultless.signals["hinge"]
    slow = hinge.replace(time=1e3 * hinge.time[::20], values=hinge.values[::20])
    late = faultless.replace(signals={**faultless.signals, "hinge": slow})
    with pytest.raises(flexarm.InvalidParameter, match=r'1000 times as long as .* say time_unit = "ms"'):
        judge(nominal, late if judge is flexarm.compare else {"run": late})


def test_a_late_clock_does_not_jump(nominal, faultless):
    """Stamps that are 50 ms late all the time are told as that, and left to the alignment."""
    found = check(nominal, [shifted(faultless, lambda t: t + 0.05)])
    (remark,) = found.remarks
    assert not found.faults
    late = re.search(r"tip comes ([0-9.]+) ms late on the clock tracker", remark)
    assert late and float(late[1]) == pytest.approx(50, abs=1)


def test_a_tracker_that_was_moved_is_said(nominal):
    """Two reflectors both lie 20 mm higher in the second record; of one reflector nobody can say."""
    arm = nominal.replace(
        points=(*nominal.points, nominal.points[0].replace(name="mid", position=(0, 0, 1.5)))
    )
    points = {"tip": (1.0, (0.0, 0.0)), "mid": (0.5, (0.0, 0.0))}
    rng = np.random.default_rng(5)
    first, second = (record(RODS, SWING, 12.0, rng, LAB, Nuisances(), points, torque=False) for _ in range(2))
    for name in points:
        second = changed(second, name, column(1, lambda z: z + 0.02))
    found = check(arm, {"monday": first, "tuesday": second})
    assert found.usable
    (remark,) = found.remarks
    assert "monday and tuesday contradict each other: tip, mid lie 0.0" in remark
    assert "apart along z, as if the frame tracker had moved" in remark


def test_noise_pauses_and_lost_rows_are_said(nominal, faultless):
    """An encoder ten times noisier than stated, that pauses for a moment, and a tip half of which is lost."""
    rng = np.random.default_rng(6)
    loud = changed(faultless, "hinge", lambda y: y + 10 * LAB.encoder * rng.standard_normal(y.shape))
    lost = changed(loud, "tip", column(0, lambda x: np.where(np.arange(len(x)) % 2, x, np.nan)))
    hinge = lost.signals["hinge"]
    keep = (hinge.time < 5) | (hinge.time > 5.12)
    paused = lost.replace(
        signals={**lost.signals, "hinge": hinge.replace(time=hinge.time[keep], values=hinge.values[keep])}
    )
    remarks = check(nominal, {"run": paused}).remarks
    assert any(re.match(r"run: the noise of hinge is about 2e-05 rad, stated is 2e-06", r) for r in remarks)
    assert any(r.startswith("run: hinge pauses for 0.13 s after t = 4.995 s") for r in remarks)
    assert any(re.match(r"run: tip holds no value in 5\d% of its 120 rows", r) for r in remarks)


def test_what_the_data_leave_open_is_named_as_alternative(nominal, faultless):
    """Without torque a planar arm with one reflector looks the same with encoder or x counting backwards.

    Then both are named, one as the other's alternative.
    """
    signals = {name: signal for name, signal in faultless.signals.items() if name != "torque"}
    poor = changed(faultless.replace(signals=signals), "tip", column(0, lambda x: -x))
    (fault,) = check(nominal, [poor]).faults
    named = {(fault.name, fault.at), *((other.name, other.at) for other in fault.alternatives)}
    assert named == {("sign_error", "tip"), ("sign_error", "hinge")}


def posed(angles, tips) -> flexarm.Record:
    """A static record of an arm at output angles, with its tips (x, z) by a tracker."""
    pose = [f"p{k}" for k in range(len(angles))]
    common = {"pose": np.array(pose), "time": None}
    drive = flexarm.Signal(
        name="hinge",
        quantity="joint_angle",
        joint="hinge",
        side="motor",
        values=angles,
        noise_std=1e-5,
        **common,
    )
    tip = flexarm.Signal(
        name="tip", quantity="position", point="tip", axes=("x", "z"), values=tips, noise_std=1e-4, **common
    )
    return flexarm.Record(kind="static", signals=[drive, tip], drive=("hinge",))


@pytest.mark.parametrize(
    ("what", "expected"),
    [
        ("in order", []),
        ("x flipped", [("sign_error", "tip", ("x",))]),
        ("z in millimetres", [("unit_error", "tip", ("z",))]),
    ],
)
def test_poses_are_checked_too(nominal, what, expected):
    """Eleven poses of the rigid arm, 3 (sin q, cos q), beside the elastic model that sags by centimetres."""
    q = np.linspace(-1.0, 0.9, 11)
    tips = LENGTH * np.stack([np.sin(q), np.cos(q)], axis=1)
    tips += 1e-4 * np.random.default_rng(2).standard_normal(tips.shape)
    tips *= {"in order": (1, 1), "x flipped": (-1, 1), "z in millimetres": (1, 1e3)}[what]
    found = check(nominal, [posed(q, tips)])
    assert [(fault.name, fault.at, fault.channels) for fault in found.faults] == expected


def test_a_check_reads_as_a_table(nominal, faultless):
    """Verdict, fault, place, probability, record, parameter and evidence."""
    text = str(check(nominal, {"run": changed(faultless, "tip", lambda y: 1e3 * y)}))
    assert text.startswith("1 record checked: data are unusable\n  unit_error    tip ")
    assert "probability 1.000   in run" in text
    assert re.search(r"factor = (999|1000|1001)\S* \+- \S+ -", text)
    told = " ".join(text.split())
    assert re.search(r"in record 'run' tip [xz] moves", told)
    assert "times as far as the model says" in told
    assert "which is what thousandths such as mm or mrad give (1000); with that taken back" in told
    assert re.search(r"; the same holds for tip [xz]\.$", told)


@pytest.mark.slow
def test_of_the_development_cases_only_the_faulty_one_is_unusable(shared_dir):
    """Eighteen cases with all kinds of effects: one holds a tip whose x counts the other way."""
    for number in range(1, 19):
        folder = shared_dir / "cases" / f"case_{number:02d}"
        records = {name: flexarm.Record.load(folder / name) for name in ("train_a", "train_b", "held_out")}
        found = check(flexarm.Arm.from_toml(folder / "model.toml"), records)
        faults = [(fault.name, fault.at, fault.channels) for fault in found.faults]
        assert faults == ([("sign_error", "tip", ("x",))] if number == 15 else []), folder.name
        assert found.outliers == (), folder.name


def test_bad_input_is_said(nominal):
    with pytest.raises(flexarm.InvalidParameter, match="at least one record, got none"):
        check(nominal, [])
    with pytest.raises(flexarm.InvalidParameter, match=r"records\.run: must be a Record, .* got str"):
        check(nominal, {"run": "somewhere"})


def rigid_as_a_tool(arm: flexarm.Arm) -> flexarm.Arm:
    """A hundred times as stiff: its tip bends by less than a thousandth of its reach."""
    [rod] = arm.links
    return arm.replace(
        links=[rod.replace(material=rod.material.replace(youngs_modulus=100 * rod.material.youngs_modulus))]
    )


def bent(arm: flexarm.Arm) -> flexarm.Record:
    """A swing of an arm whose encoder, tip and deflection are seen."""
    time = np.linspace(0.0, 4.0, 401)
    drive = flexarm.Drive.from_samples(time, {"hinge": 0.3 + 0.6 * np.sin(1.5 * time) ** 2})
    sensors = [
        Sensor(
            name="hinge", quantity="joint_angle", joint="hinge", side="motor", rate_hz=100, noise_std=2e-6
        ),
        Sensor(name="tip", quantity="position", point="tip", rate_hz=50, noise_std=1e-4),
        Sensor(name="bow", quantity="deflection", point="tip", axes=("x",), rate_hz=50, noise_std=1e-6),
    ]
    run = flexarm.simulate(arm, drive)
    return flexarm.measure(run, sensors, np.random.default_rng(1), drive=["hinge"])


@pytest.mark.parametrize(
    ("factor", "names"), [(1e3, ["unit_error"]), (-1.0, ["sign_error"]), (1.0, []), (2.0, [])]
)
def test_a_deflection_is_judged_by_its_own_size_and_not_by_the_reach(nominal, factor, names):
    """Millimetres for metres and a turned sign are faults; twice the deflection is a softer link."""
    arm = rigid_as_a_tool(nominal)
    found = check(arm, {"run": changed(bent(arm), "bow", lambda values: factor * values)})
    assert [fault.name for fault in found.faults] == names
