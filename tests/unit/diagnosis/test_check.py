"""Sensor faults in records of an independent simulator are named, missing effects are not taken for them.

The records come from a chain of rigid rods (`tests/blind`), the nominal model from flexarm; noise, a late
tracker and its registration are in them. Faults are put on the readings by hand.
"""

from dataclasses import replace

import numpy as np
import pytest
from arms import EI, LENGTH, PAYLOAD, RHO_A, paper_arm
from chain import Base, Link
from hub import Hub
from motion import Arm
from swings import Swing
from virtual_lab import Lab, Nuisances, record

import flexarm
from flexarm.diagnosis.check import check
from flexarm.effects import SignError

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
    """Every one of twelve samples 5 cm off, in tip and torque, and no other; no sensor is at fault."""
    rng = np.random.default_rng(3)
    good = np.flatnonzero(faultless.signals["tip"].valid)
    rows = np.sort(rng.choice(good[3:-3:4], 6, replace=False))

    def thrown(values):
        values[rows] += 0.05 * np.sign(rng.standard_normal((6, 2)))
        return values

    found = check(nominal, {"run": changed(faultless, "tip", thrown)})
    assert found.usable
    assert [(each.record, each.signal, each.rows) for each in found.outliers] == [("run", "tip", tuple(rows))]
    assert found.outliers[0].size == pytest.approx(0.05, rel=0.05)
    assert not found.records["run"].signals["tip"].valid[rows].any()


def test_a_spiky_encoder_drives_the_model_smoothly(nominal, faultless):
    """Ten samples of the drive 20 mrad off are taken out before they shake the model."""
    rows = np.arange(100, 2100, 200)

    def thrown(values):
        values[rows] += 0.02
        return values

    found = check(nominal, {"run": changed(faultless, "hinge", thrown)})
    assert found.usable
    assert [(each.signal, each.rows) for each in found.outliers] == [("hinge", tuple(rows))]


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
