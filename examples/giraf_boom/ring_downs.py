"""Records of the ring-downs of the GIRAF boom: what `make_records.py` makes of `ringdown_*in_trial1.csv`.

How the columns become signals (SI; the boom lies along x, z is across it in the plane of the pitch):

    t                   stamps [s] of all columns, jittery
    pitch_pos           joint_angle `pitch`: the commanded angle, in steps of a milliradian, as the motor's
    accel_x, _y, _z     acceleration `imu` at the tip, along the boom and across: see below
    file name           inches that the boom is out, to which its authors add 0.265 m

How the accelerometer sits at the tip is stated nowhere, and at rest it reads 9.0 to 9.2 m/s2. Both are taken
from what it reads before the step, where the boom rests at a known angle: the scale makes that g, and the
shortest turn after x = -z_s, y = -y_s, z = -x_s makes it point up. What the boom hangs at rest is thus no
evidence; how the reading changes is. The noise is what second differences show in the last second.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from flexarm import InvalidFile, Record, Signal
from flexarm.record import DrawnLink

sys.path.insert(0, str(Path(__file__).parents[1]))
from data_script import read_numbers

Floats = NDArray[np.float64]

COLUMNS = ("t", "accel_x", "accel_y", "accel_z", "pitch_pos")
NAME = re.compile(r"ringdown_(\d+)p(\d+)in_trial\d+\.csv")
INCH, ADDED = 0.0254, 0.265
"""[m]; what is added to the length that a name states."""
GRAVITY = 9.81
MOUNT = np.array([[0.0, 0.0, -1.0], [0.0, -1.0, 0.0], [-1.0, 0.0, 0.0]])
"""Boom's axes in rows, sensor's in columns, before the turn."""
COMMAND = 1e-3
"""Step of the commanded angle [rad]."""


def length_of(path: Path) -> float:
    """Length of the boom [m], from the name of a file.

    Raises
    ------
    InvalidFile
        If the name states none.
    """
    found = NAME.fullmatch(path.name)
    if found is None:
        raise InvalidFile(path, "name", "must be ringdown_INCHESpDECIMALSin_trialN.csv")
    return float(f"{found[1]}.{found[2]}") * INCH + ADDED


def ring_down_record(path: Path) -> Record:
    """A step of the pitch, and what the tip does after it."""
    columns = read_numbers(path, COLUMNS)
    time, sensed, pitch = columns[:, 0], columns[:, 1:4], columns[:, 4]
    moves = np.flatnonzero(pitch != pitch[0])
    if not len(moves) or moves[0] < 50:
        raise InvalidFile(path, "pitch_pos", "must rest for 50 samples and then move")
    rest = sensed[: moves[0]].mean(axis=0)
    body = sensed @ to_boom(rest, pitch[0]).T
    quiet = body[time > time[-1] - 1.0][:, [0, 2]]
    noise = float(np.sqrt(np.mean(np.diff(quiet, 2, axis=0) ** 2) / 6))
    signals = [
        Signal(name="pitch", quantity="joint_angle", joint="pitch", side="motor", values=pitch, time=time,
               noise_std=COMMAND / np.sqrt(12), file=path.name),
        Signal(name="imu", quantity="acceleration", point="tip", axes=("x", "z"), values=body[:, [0, 2]],
               time=time, noise_std=noise, file=path.name),
    ]  # fmt: skip
    length = length_of(path)
    return Record(
        signals=signals,
        drive=("pitch",),
        description=f"GIRAF boom, {1e3 * length:.0f} mm out, after a step of its pitch",
        links={"boom": DrawnLink(length=length)},
    )


def to_boom(rest: Floats, pitch: float) -> Floats:
    """Matrix from readings to specific force in the boom's axes, from what it reads at rest at an angle."""
    up = np.array([np.sin(pitch), 0.0, np.cos(pitch)])
    seen = MOUNT @ rest
    size = float(np.linalg.norm(seen))
    across = np.cross(seen / size, up)
    sine = float(np.linalg.norm(across))
    angle = np.arctan2(sine, float(seen @ up) / size)
    turn = Rotation.from_rotvec(across * (angle / sine if sine > 0 else 0.0)).as_matrix()
    found: Floats = GRAVITY / size * turn @ MOUNT
    return found
