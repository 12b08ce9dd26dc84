"""Records from the files of the KUKA KR 300.

    python make_records.py DATA_DIR OUT_DIR

reads `trajectory_a.mat` and `trajectory_b.mat` of DATA_DIR and writes

    OUT_DIR/robot.toml      the model of this folder
    OUT_DIR/a, OUT_DIR/b    a record of each trajectory, 10 s at 250 Hz: all encoders
    OUT_DIR/a_torque, OUT_DIR/b_torque    the same with the motors' torques

How the variables become signals (SI):

    rec.act_pos_mot_deg     joint_angle of axes 1 to 6, side "motor", in degrees of the output: the drives
    rec.act_pos_se_deg      joint_angle of axes 1 to 3, side "output": secondary encoders behind the gears
    rec.act_torque_abs_nm   motor_torque of axes 1 to 6, side "motor": at the motor's shaft

Nobody states noise. Third differences of neighbours have it for 1 sigma of it times sqrt(20); the larger of
the two files counts. The secondary encoders have a clock of their own, of which nothing is known.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat
from scipy.io.matlab import MatReadError

from flexarm import InvalidFile, Record, Signal
from flexarm.output import output_directory
from flexarm.record import Clock

sys.path.insert(0, str(Path(__file__).parents[1]))
from data_script import check_folder, command_line, exit_code

FILES = {"a": "trajectory_a.mat", "b": "trajectory_b.mat"}
VARIABLES = ("time_cont", "act_pos_mot_deg", "act_pos_se_deg", "act_torque_abs_nm")
FRICTION = ("f_vis", "f_coul")
"""The authors' estimates: viscous [N m s/rad] and dry [N m], at the output."""
AXES = tuple(f"axis_{k}" for k in range(1, 7))
SECONDARY = AXES[:3]


def read_mat(path: Path) -> dict[str, np.ndarray]:
    """Time [s], angles [deg] and torques [N m] of a file, shapes (n,) and (6, n), and friction, shape (6,).

    Raises
    ------
    InvalidFile
        If it cannot be read, or a variable is missing or of another size.
    """
    try:
        content = loadmat(path, squeeze_me=True, struct_as_record=False)
        found = {name: np.asarray(getattr(content["rec"], name), dtype=float) for name in VARIABLES}
        friction = {name: np.asarray(getattr(content["para"], name), dtype=float) for name in FRICTION}
    except OSError as error:
        raise InvalidFile(path, "file", f"cannot be read: {error}") from None
    except (MatReadError, ValueError, TypeError, IndexError, NotImplementedError) as error:
        raise InvalidFile(path, "file", f"is no MATLAB file of version 5: {error}") from None
    except (KeyError, AttributeError):
        what = f"must hold {', '.join(VARIABLES)} in rec and {', '.join(FRICTION)} in para"
        raise InvalidFile(path, "rec", what) from None
    for name in VARIABLES[1:]:
        if found[name].shape != (len(AXES), len(found["time_cont"])):
            raise InvalidFile(
                path, f"rec.{name}", f"must be 6 rows as long as time_cont, got shape {found[name].shape}"
            )
    return found | friction


def noise(values: list[np.ndarray]) -> float:
    """1 sigma of white noise in the roughest of several series, from their third differences."""
    return float(f"{max(float(np.std(np.diff(each, 3))) for each in values) / np.sqrt(20):.2g}")


def records(files: dict[str, dict[str, np.ndarray]]) -> dict[str, Record]:
    """Records of each trajectory: of its encoders, and with torques."""

    def signals(of: str) -> list[Signal]:
        here, time = files[of], files[of]["time_cont"]

        def signal(variable: str, axis: str, scale: float, suffix: str, **what: Any) -> Signal:
            row = AXES.index(axis)
            values = scale * here[variable][row]
            sigma = noise([scale * each[variable][row] for each in files.values()])
            return Signal(name=axis + suffix, joint=axis, values=values, time=time, noise_std=sigma, **what)

        angle: dict[str, Any] = {"quantity": "joint_angle", "unit": "rad"}
        rad = np.pi / 180
        return [
            *(
                signal("act_pos_mot_deg", a, rad, "", side="motor", file="motor.csv", **angle, clock="robot",
                       channels=(f"{a}_rad",))
                for a in AXES
            ),
            *(
                signal("act_pos_se_deg", a, rad, "_secondary", side="output", file="secondary.csv", **angle,
                       clock="secondary", channels=(f"{a}_rad",))
                for a in SECONDARY
            ),
            *(
                signal("act_torque_abs_nm", a, 1.0, "_torque", quantity="motor_torque", side="motor",
                       file="torque.csv", clock="robot", channels=(f"{a}_Nm",))
                for a in AXES
            ),
        ]  # fmt: skip

    found = {}
    for name in files:
        whole = Record(
            signals=signals(name),
            drive=AXES,
            clocks={"robot": Clock(), "secondary": Clock(unknown=True)},
            description=f"KUKA KR 300 with 200 kg, trajectory {name}",
        )
        angles = {key: each for key, each in whole.signals.items() if each.quantity == "joint_angle"}
        found |= {name: whole.replace(signals=angles), f"{name}_torque": whole}
    return found


def make_records(data: Path, out: Path, force: bool = False) -> list[Path]:
    """Writes model and records; returns the records' folders."""
    check_folder(data, " and ".join(FILES.values()))
    files = {name: read_mat(data / file) for name, file in FILES.items()}
    with output_directory(out, force) as directory:
        shutil.copy(Path(__file__).with_name("robot.toml"), directory / "robot.toml")
        found = records(files)
        for name, record in found.items():
            record.save(directory / name)
    return [out / name for name in found]


def main() -> int:
    """Command line; 0 if done, 2 if the input is at fault."""
    given = command_line("Records of the KUKA KR 300.", " and ".join(FILES.values()), force=True).parse_args()
    return exit_code(lambda: print(*make_records(given.data, given.out, given.force), sep="\n"))


if __name__ == "__main__":
    sys.exit(main())
