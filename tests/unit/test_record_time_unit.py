"""Stamps in another unit than seconds are doubted; of what lasts long for a reason the steps are told."""

from pathlib import Path

import numpy as np
import pytest
from arms import crane, smooth_step

import flexarm
from flexarm.cli.run import run
from flexarm.record import Signal
from flexarm.record.time_unit import duration_problems, implausible_rates

RATES = {"hinge": 250.0, "torque": 50.0, "tip": 10.0}


def signal(name: str, seconds: float, rate: float, factor: float = 1.0) -> Signal:
    """What a sensor sees of a swing of 0.8 rad in four cycles, its stamps so many times too large."""
    t = np.arange(0, seconds, 1 / rate)
    angle = 0.8 * np.sin(8 * np.pi * t / seconds) * smooth_step(t / (0.2 * seconds))
    own = {"name": name, "time": t * factor, "noise_std": 1e-5}
    if name == "tip":
        values = 3 * np.stack([np.sin(angle), np.cos(angle)], axis=1)
        return Signal(quantity="position", point="tip", axes=("x", "z"), values=values, **own)
    quantity, values = ("joint_angle", angle) if name == "hinge" else ("motor_torque", 400 * np.sin(angle))
    return Signal(quantity=quantity, joint="hinge", side="output", values=values, **own)


def record(
    seconds: float, rates: dict[str, float] = RATES, times: dict[str, float] | None = None
) -> flexarm.Record:
    """All of them; the stamps of some are so many times too large."""
    signals = [signal(name, seconds, rate, (times or {}).get(name, 1.0)) for name, rate in rates.items()]
    return flexarm.Record(signals=signals, drive=("hinge",))


def doubted(of: flexarm.Record) -> list[str]:
    return [f"{problem.where}: {problem.what}" for problem in duration_problems(of)]


@pytest.mark.parametrize(("factor", "unit"), [(1e3, "ms"), (1e6, "us")])
def test_stamps_that_all_count_parts_of_a_second(factor, unit):
    [what] = doubted(record(40.0, times=dict.fromkeys(RATES, factor)))
    assert what.startswith(
        "signals.hinge.time: lasts 11.1 h at" if unit == "ms" else "signals.hinge.time: lasts 463 d"
    )
    assert what.endswith(f'if its stamps are in {unit}, say time_unit = "{unit}": 40 s at 250 Hz')
    assert "2e+07 steps of a simulation at 2 ms" in what or unit == "us"


@pytest.mark.parametrize("late", [["hinge", "torque"], ["tip"], ["torque"]])
def test_a_file_that_counts_milliseconds_beside_others_in_seconds(late):
    """One line, with the factor and with what the first of them would be."""
    [what] = doubted(record(40.0, times=dict.fromkeys(late, 1e3)))
    assert what.startswith(f"signals.{late[0]}.time: lasts 11.1 h at")
    assert ", 1000 times as long as" in what
    assert 'if its stamps are in ms, say time_unit = "ms": ' in what
    assert f" s at {RATES[late[0]]:g} Hz" in what
    assert what.endswith("; the same holds for torque") == (len(late) == 2)


def test_seconds_that_are_said_to_be_milliseconds():
    [what] = doubted(record(40.0, times={"hinge": 1e-3}))
    assert what.startswith("signals.hinge.time: lasts 0.04 s at 250000 Hz, ")
    assert what.endswith("are its stamps in s?")
    everything = record(40.0, times=dict.fromkeys(RATES, 1e-3))
    assert doubted(everything) == []
    [problem] = implausible_rates(everything, ["hinge"])
    assert "rad/s, faster than any joint; are its stamps, and its values, in their units?" in problem.what
    assert everything.check_against(crane()) == [problem]


SENSIBLE = {
    "a swing of 4 s": record(4.0),
    "two minutes": record(130.0),
    "ten minutes of a slow crane at 1 Hz": record(600.0, dict.fromkeys(RATES, 1.0)),
    "half an hour of one": record(1800.0, dict.fromkeys(RATES, 0.5)),
    "a tracker that begins late": flexarm.Record(
        signals=[signal("hinge", 40.0, 250.0), signal("tip", 1.0, 10.0)], drive=("hinge",)
    ),
    "a burst of 4 s at 500 Hz in an hour at 10 Hz": flexarm.Record(
        signals=[signal("hinge", 3500.0, 10.0), signal("tip", 3.6, 500.0)], drive=("hinge",)
    ),
}


@pytest.mark.parametrize("what", SENSIBLE)
def test_sensible_records_are_not_doubted(what):
    assert doubted(SENSIBLE[what]) == []
    assert list(implausible_rates(SENSIBLE[what], ["hinge"])) == []


def test_hours_are_told_by_the_steps_that_they_take():
    """Two hours at 10 Hz, or at 1 Hz of a joint that turns as joints do: nothing is said of milliseconds."""
    for slow in (record(7200.0, dict.fromkeys(RATES, 10.0)), turning_for_hours()):
        [what] = doubted(slow)
        assert "lasts 2 h at" in what
        assert what.endswith("3.6e+06 steps of a simulation at 2 ms")


def turning_for_hours() -> flexarm.Record:
    """A turntable of 0.05 rad/s, 50 rad/s if its stamps were milliseconds."""
    t = np.arange(0, 7201.0)
    angle = Signal(name="hinge", quantity="joint_angle", joint="hinge", time=t, values=0.05 * t)
    return flexarm.Record(signals=[angle], drive=("hinge",))


def test_stamps_of_a_clock_that_counts_from_elsewhere_are_not_long():
    """Seconds of 1970 beside seconds of the run."""
    late = record(40.0)
    tip = late.signals["tip"].replace(time=late.signals["tip"].time + 1.7e9, clock="tracker")
    clocks = {"clock": flexarm.record.Clock(), "tracker": flexarm.record.Clock(unknown=True)}
    assert doubted(late.replace(signals={**late.signals, "tip": tip}, clocks=clocks)) == []


def test_no_case_is_doubted(shared_dir: Path):
    found = {
        str(path): doubted(flexarm.Record.load(path.parent))
        for path in shared_dir.glob("cases/case_*/*/record.toml")
    }
    assert len(found) == 54
    assert not any(found.values())


@pytest.fixture
def bench(tmp_path: Path) -> Path:
    """A model, and a record whose stamps are milliseconds in columns that are called time_s."""
    crane().to_toml(tmp_path / "arm.toml")
    record(40.0, {"hinge": 20.0, "tip": 5.0}, {"hinge": 1e6, "tip": 1e6}).save(tmp_path / "measured")
    return tmp_path


@pytest.mark.parametrize("command", ["check", "compare", "simulate", "diagnose"])
def test_a_run_without_end_is_refused_and_its_stamps_doubted_once(bench, command, capsys):
    into = {"check": [], "compare": []}.get(command, ["--out", str(bench / "out")])
    drive = ["--drive"] if command == "simulate" else []
    arguments = [command, str(bench / "arm.toml"), *drive, str(bench / "measured"), *into]
    assert run(arguments) == 2
    err = capsys.readouterr().err.splitlines()
    assert sum("signals.hinge.time" in line for line in err) == 1
    where = "command line: --step" if command == "simulate" else f"{bench / 'measured'}: drive"
    assert err[-1].startswith(f"error: {where}: ")
    assert "allowed are 2e+07" in err[-1]
    assert not (bench / "out").exists()


def test_a_run_without_end_is_refused_in_python():
    slow = record(40.0, {"hinge": 20.0}, {"hinge": 1e6})
    with pytest.raises(flexarm.InvalidParameter, match=r"drive: lasts 3.995e\+07 s, 2e\+10 steps of 0.002 s"):
        flexarm.simulate(crane(), slow)


@pytest.fixture
def slow_swing(bench) -> Path:
    """6 s as a file of milliseconds, of few samples."""
    t = np.linspace(0, 6000, 31)
    rows = [f"{a:g},{1.2 * float(smooth_step(a / 6000)):.6g}" for a in t]
    (bench / "swing.csv").write_text("\n".join(["time_s,hinge", *rows]) + "\n")
    return bench / "swing.csv"


def test_a_drive_in_milliseconds_is_doubted(bench, slow_swing, capsys):
    step = ["--step", "0.5", "--out", str(bench / "out")]
    assert run(["simulate", str(bench / "arm.toml"), "--drive", str(slow_swing), *step]) == 0
    err = capsys.readouterr().err
    assert f"warning: {slow_swing}: column time_s: lasts 1.67 h at 0.005 Hz" in err
    assert "if its stamps are in ms, write them in s: 6 s at 5 Hz" in err


def test_a_plan_doubts_its_drives_as_a_simulation_does(bench, slow_swing, capsys, monkeypatch):
    def stopped(*_: object, **__: object) -> None:
        raise flexarm.InvalidParameter("enough")

    monkeypatch.setattr(flexarm, "plan", stopped)
    assert run(["plan", str(bench / "arm.toml"), "--drive", str(slow_swing)]) == 2
    assert "column time_s: lasts 1.67 h" in capsys.readouterr().err
