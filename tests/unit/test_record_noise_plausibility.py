"""Noise, jitter and clocks in another unit than their samples are doubted; those of rough sensors are not."""

import csv
from pathlib import Path

import diagnoses
import numpy as np
import pytest

import flexarm
from flexarm.record import Clock, Signal
from flexarm.record.noise_plausibility import clock_problems, noise_problems


def doubted(signal: Signal) -> list[str]:
    return [f"{problem.where.split('.')[-1]}: {problem.what}" for problem in noise_problems(signal)]


def tip(noise: float | None, **changes) -> Signal:
    return diagnoses.record(1).signals["tip"].replace(noise_std=noise, **changes)


@pytest.mark.parametrize("stated", [0.05, 5.0])
def test_a_noise_in_millimetres_is_doubted(stated):
    """0.05 mm as 0.05 m: from sample to sample the tip scatters by far less."""
    [what] = doubted(tip(stated))
    assert what.startswith(f"noise_std: is {stated:g} m, but values scatter by 0.000")
    assert what.endswith("at most; noise_std is in the unit of the signal")


@pytest.mark.parametrize("stated", [None, 0.0, 1e-6, 5e-5, 5e-4, 5e-3])
def test_a_noise_that_may_be_is_not(stated):
    assert doubted(tip(stated)) == []


def test_a_noise_in_metres_beside_steps_of_a_hundredth_millimetre_is_doubted(tmp_path: Path):
    """unit = "mm" with noise_std = 5e-5, meant in m: 5e-8 m, which no sensor has that shows 0.01 mm."""
    diagnoses.record(1).save(tmp_path / "run")
    table = (tmp_path / "run" / "record.toml").read_text()
    (tmp_path / "run" / "record.toml").write_text(table.replace('unit = "m"', 'unit = "mm"'))
    path = next((tmp_path / "run").glob("tip*.csv"))
    with path.open() as file:
        header, *rows = csv.reader(file)
    shown = [[row[0], *(f"{1e3 * float(cell):.2f}" if cell else "" for cell in row[1:])] for row in rows]
    path.write_text("\n".join(",".join(row) for row in [header, *shown]) + "\n")
    [what] = doubted(flexarm.Record.load(tmp_path / "run").signals["tip"])
    assert what.startswith("noise_std: is 5e-08 m, but all values are 1e-05 m apart or multiples of it")
    fine = flexarm.Record.load(tmp_path / "run").signals["tip"].replace(noise_std=5e-6)
    assert doubted(fine) == []


def sampled(values: np.ndarray, rate: float, noise: float, quantity: str = "motor_torque") -> Signal:
    time = np.arange(len(values)) / rate
    place = {"point": "tip", "axes": ("x",)} if quantity == "position" else {"joint": "hinge"}
    return Signal(name="s", quantity=quantity, time=time, values=values, noise_std=noise, **place)


def test_noise_that_lasts_is_not_doubted():
    """A torque whose noise an amplifier filters at 10 Hz, read at 1 kHz and, which tells nothing, at rest."""
    rng, filtered = np.random.default_rng(4), np.zeros(20_000)
    white = rng.standard_normal(len(filtered))
    for i in range(1, len(filtered)):
        filtered[i] = filtered[i - 1] + 2 * np.pi * 10e-3 * (white[i] - filtered[i - 1])
    assert doubted(sampled(filtered, 1e3, float(np.std(filtered)))) == []


def test_a_simulation_without_noise_may_state_one():
    """A tip that sinks by 5 mm and a torque of some N m, as `flexarm simulate --drive RECORD` writes them."""
    t = np.arange(0, 20, 0.1)
    sinking = 5e-3 * np.sin(0.3 * t)
    assert doubted(sampled(sinking, 10, 5e-5, "position")) == []
    assert doubted(sampled(3 * np.sin(0.5 * t), 10, 0.5)) == []


def test_a_coarse_sensor_at_rest_may_state_what_its_steps_are():
    """Steps of 0.1 mm that hardly ever change have 0.03 mm of noise, as they would have in motion."""
    rng = np.random.default_rng(1)
    values = 1e-4 * np.round(0.4 + 0.03 * rng.standard_normal(500))
    assert doubted(sampled(values, 10, 1e-4 / np.sqrt(12), "position")) == []


def test_noise_of_poses_is_that_of_their_repeats():
    pose = np.repeat([f"p{k}" for k in range(6)], 5)
    values = np.repeat(np.arange(6) / 3, 5) + 4e-5 * np.random.default_rng(1).standard_normal(30)
    for stated, count in ((4e-5, 0), (4e-4, 0), (0.04, 1)):
        signal = Signal(
            name="tip",
            quantity="position",
            point="tip",
            axes=("x",),
            pose=pose,
            values=values,
            noise_std=stated,
        )
        assert len(doubted(signal)) == count


def test_jitter_beyond_the_distance_of_samples_is_doubted():
    [what] = doubted(tip(5e-5, jitter_std=2.0))
    assert what == "jitter_std: is 2 s (1 sigma), samples are 0.1 s apart; it is in s, whatever time_unit"
    assert doubted(tip(5e-5, jitter_std=0.02)) == []


@pytest.mark.parametrize(("sigma", "count"), [(2e-3, 0), (0.5, 0), (2.0, 1)])
def test_a_clock_that_is_hardly_known_is_doubted(sigma, count):
    """In a record of 12 s: stamps 2 s late or early, where 2 ms were meant; half a second by a stopwatch."""
    record = diagnoses.record(1).replace(clocks={"controller": Clock(), "tracker": Clock(sigma=sigma)})
    found = [problem.what for problem in clock_problems(record)]
    assert len(found) == count
    assert all(
        what.startswith("is 2 s (1 sigma), its signals last 11.9 s; it is in s, not in ms") for what in found
    )


def test_a_clock_of_a_long_record_may_be_a_second_off():
    record = diagnoses.record(1)
    tip = record.signals["tip"].replace(time=50 * record.signals["tip"].time)
    clocks = {"controller": Clock(), "tracker": Clock(sigma=2.0)}
    long = record.replace(signals={**record.signals, "tip": tip}, clocks=clocks)
    assert list(clock_problems(long)) == []


def test_no_case_is_doubted(shared_dir: Path):
    found = {
        str(path): doubted(signal)
        for path in shared_dir.glob("cases/case_*/*/record.toml")
        for signal in flexarm.Record.load(path.parent).signals.values()
    }
    assert len(found) == 54
    assert not any(found.values())
