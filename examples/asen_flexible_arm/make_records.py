"""Records and models from the files of the ASEN rotary flexible arm.

    python make_records.py DATA_DIR OUT_DIR

reads `test_2.tsv` and `test_3.tsv` of DATA_DIR and writes for each test N

    OUT_DIR/test_N/arm.toml         arm.toml of this folder with the gains K1 to K4 of that test
    OUT_DIR/test_N/by_hub_angle     a record that is driven by the measured hub angle
    OUT_DIR/test_N/by_reference     the same signals, driven by the position reference through the controller

Each record states its gains too, so the model of one test serves the records of both.

How the columns become signals (SI; the ruler lies along x of its link, the hub turns about z):

    hub angle, rate      joint_angle and joint_rate of `hub`, side "output": the column is the hub's own angle
                         (on which shaft the encoder sits is not documented)
    tip deflection d     deflection of `tip` along y of the undeformed ruler: y = -d, see below
    position reference   joint_command of `hub`
    motor voltage        motor_voltage of `hub`

The tip's rate is left out: no sensor measured it, it is the derivative of its neighbour. Time starts at zero.
The files hold milliradians and millimetres, so angle and deflection are known to step/sqrt(12). The other
columns are computed by the board; nobody states how well. What the columns say of each other is taken for
their noise: the rate is off the slope of its angle by 0.025 rad/s rms, the filter of the board, and the
voltage off the controller's formula by 0.10 V, see 3 below.

**Positive direction of the deflection.** It is not documented. Three things in the data say that d counts
*against* the hub's positive angle:

1. In the quarter of a second after each of the four jumps of the reference, by -0.6 or +0.6 rad, the hub
   moves by -0.26 or +0.27 rad and d swings by -63 or +57 mm: the same sign. The mass trails, so along y it is
   deflected against the hub's motion.
2. The deflection y of the model, driven by the hub angle, correlates with -d by 0.91 and 0.88 where d is
   taken to be 60 ms late. With +d the best value at any lag from 0 to 0.25 s is below 0.02.
3. The recorded voltage follows V = K1 (reference - hub) - K3 hub_rate - K2 d - K4 d_rate to 0.10 and 0.12 V
   rms of up to 5 V, 7 ms late. With K4 > 0 this damps the ruler only if d is positive against the hub: then
   the hub yields to the moving tip.

In the model, whose deflection is y = -d, the gains are therefore -K2 and -K4. `tests/paper/test_asen.py`
repeats all three.

**Clocks.** All columns share one time. The deflection has a clock of its own, known to 0.1 s, because the
latency of its sensor is not documented and is not zero, as 2 shows.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flexarm import Arm, InvalidFile, Record, Signal
from flexarm.output import output_directory
from flexarm.record import Clock

sys.path.insert(0, str(Path(__file__).parents[1]))
from data_script import check_folder, command_line, exit_code, read_text

TESTS = ("test_2", "test_3")
FILES = "test_2.tsv and test_3.tsv"
HEADINGS = {
    "time": "Time (ms)",
    "hub": "Hubangle",
    "tip": "Tip Deflection",
    "hub_rate": "Hub Angular Velocity",
    "tip_rate": "Tip Velocity",
    "reference": "Position Reference",
    "voltage": "Output Voltage",
    "K1": "K1",
    "K2": "K2",
    "K3": "K3",
    "K4": "K4",
}
"""Columns in their order, and how their headings begin (after a `%` in the first one)."""
RESOLUTION = 1e-3
"""Of hub angle [rad] and deflection [m]."""
RATE_NOISE, VOLTAGE_NOISE = 0.025, 0.10
"""Of hub rate [rad/s] and voltage [V]: by how much the columns contradict each other."""
LATENCY_SIGMA = 0.1
"""What is known of the deflection sensor's latency, 1 sigma [s]."""

Columns = dict[str, NDArray[np.float64]]


def read_tsv(path: Path) -> Columns:
    """The columns of one file, by the names in `HEADINGS`; time in s from the first row.

    Raises
    ------
    InvalidFile
        With the line or column of what is wrong.
    """
    lines = read_text(path).splitlines()
    _check_headings(path, lines[0] if lines else "")
    rows = [_numbers(path, number, line) for number, line in enumerate(lines[1:], 2) if line.strip()]
    if len(rows) < 2:
        raise InvalidFile(path, "file", f"needs at least two rows of numbers, got {len(rows)}")
    columns = dict(zip(HEADINGS, np.array(rows).T, strict=True))
    _check_times(path, columns["time"], [i for i, line in enumerate(lines, 1) if i > 1 and line.strip()])
    columns["time"] = np.round(columns["time"] - columns["time"][0], 6) * 1e-3
    return columns


def _check_headings(path: Path, line: str) -> None:
    given = [heading.strip().removeprefix("%") for heading in line.split("\t")]
    for i, wanted in enumerate(HEADINGS.values()):
        found = given[i] if i < len(given) else ""
        if not found.lower().startswith(wanted.lower()):
            raise InvalidFile(path, f"line 1, column {i + 1}", f"must be {wanted!r}, got {found[:40]!r}")


def _check_times(path: Path, time: NDArray[np.float64], numbers: list[int]) -> None:
    backward = np.flatnonzero(np.diff(time) <= 0)
    if len(backward):
        k = int(backward[0]) + 1
        where = f"line {numbers[k]}, column {HEADINGS['time']}"
        raise InvalidFile(path, where, f"must rise, got {time[k]:g} ms after {time[k - 1]:g} ms")


def _numbers(path: Path, number: int, line: str) -> list[float]:
    cells = line.split("\t")[: len(HEADINGS)]
    if len(cells) < len(HEADINGS):
        raise InvalidFile(path, f"line {number}", f"needs {len(HEADINGS)} cells, got {len(cells)}")
    values = []
    for heading, cell in zip(HEADINGS.values(), cells, strict=True):
        try:
            values.append(float(cell))
        except ValueError:
            values.append(float("nan"))
        if not np.isfinite(values[-1]):
            raise InvalidFile(
                path, f"line {number}, column {heading}", f"must be a number, got {cell[:40]!r}"
            )
    return values


def gains(columns: Columns, path: Path) -> dict[str, float]:
    """K1 [V/rad], K2 [V/m], K3 [V s/rad] and K4 [V s/m], which are constant in each test.

    Raises
    ------
    InvalidFile
        If a gain changes: the model has one value of each.
    """
    found = {}
    for name in ("K1", "K2", "K3", "K4"):
        values = np.unique(columns[name])
        if len(values) > 1:
            raise InvalidFile(
                path, f"column {name}", f"must be constant, got {values[0]:g} to {values[-1]:g}"
            )
        found[name] = float(values[0])
    return found


def settings(K: dict[str, float]) -> dict[str, float]:
    """The controller's gains; K2 and K4 act on the deflection against the hub's direction."""
    return {
        "position_gain": K["K1"],
        "rate_gain": K["K3"],
        "deflection_gain": -K["K2"],
        "deflection_rate_gain": -K["K4"],
    }


def model(nominal: Arm, name: str, K: dict[str, float]) -> Arm:
    """The arm with the gains of a test."""
    controller = nominal.controllers[0].replace(**settings(K))
    return nominal.replace(name=f"{nominal.name}, {name}", controllers=(controller,))


def record(columns: Columns, name: str, K: dict[str, float], drive: str) -> Record:
    """The signals of a test, driven by `hub` or by `reference`."""
    noise = RESOLUTION / np.sqrt(12)
    file, time, board = f"{name}.csv", columns["time"], "board"
    signals = [
        Signal(name="hub", quantity="joint_angle", joint="hub", side="output", noise_std=noise,
               values=columns["hub"], time=time, file=file, clock=board),
        Signal(name="hub_rate", quantity="joint_rate", joint="hub", side="output",
               noise_std=RATE_NOISE, values=columns["hub_rate"], time=time, file=file, clock=board),
        Signal(name="tip", quantity="deflection", point="tip", axes=("y",), noise_std=noise,
               values=-columns["tip"], time=time, file=file, clock="tip_sensor"),
        Signal(name="reference", quantity="joint_command", joint="hub",
               values=columns["reference"], time=time, file=file, clock=board),
        Signal(name="voltage", quantity="motor_voltage", joint="hub",
               noise_std=VOLTAGE_NOISE, values=columns["voltage"], time=time, file=file, clock=board),
    ]  # fmt: skip
    stated = ", ".join(f"{key} = {value:g}" for key, value in K.items())
    return Record(
        signals={signal.name: signal for signal in signals},
        drive=(drive,),
        description=f"ASEN flexible arm, {name}: {stated}; driven by {drive}",
        controllers={"hub": settings(K)},
        initial="moving",
        clocks={board: Clock(), "tip_sensor": Clock(sigma=LATENCY_SIGMA)},
    )


def make_records(data: Path, out: Path, force: bool = False) -> list[Path]:
    """Writes models and records of all tests; returns their folders."""
    check_folder(data, FILES)
    nominal = Arm.from_toml(Path(__file__).with_name("arm.toml"))
    read = {name: read_tsv(data / f"{name}.tsv") for name in TESTS}
    with output_directory(out, force) as directory:
        for name, columns in read.items():
            K = gains(columns, data / f"{name}.tsv")
            record(columns, name, K, "hub").save(directory / name / "by_hub_angle")
            record(columns, name, K, "reference").save(directory / name / "by_reference")
            model(nominal, name, K).to_toml(directory / name / "arm.toml")
    return [out / name for name in TESTS]


def main() -> int:
    """Command line; 0 if done, 2 if the input is at fault."""
    parser = command_line("Records and models of the ASEN rotary flexible arm.", FILES, force=True)
    given = parser.parse_args()
    return exit_code(lambda: print(*make_records(given.data, given.out, given.force), sep="\n"))


if __name__ == "__main__":
    sys.exit(main())
