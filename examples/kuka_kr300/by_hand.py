"""What the secondary encoders of the KUKA KR 300 say by hand, without a model of the arm.

    python by_hand.py DATA_DIR

fits the difference of the two encoders of each of axes 1 to 3, by least squares, with

    secondary - motor = offset - delay v - compliance T                                              (1)

v is the rate by the motor's encoder, and T the motor's torque times the ratio, without what accelerates the
rotor and without friction as the file's authors give it: 0.2 ms of the delay hang on that. One delay serves
all axes, since one clock stamps their encoders. Prints offset, delay, compliance, and what (1) leaves where
it was fitted (trajectory a) and where it was not (b).
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import NamedTuple

import make_records
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.ndimage import uniform_filter1d

from flexarm import Arm

sys.path.insert(0, str(Path(__file__).parents[1]))
from data_script import check_folder, exit_code

SMOOTHED, ENDS = 9, 12
"""Samples of the moving average of the acceleration, and those left out at both ends."""
SLOW = 1e-3
"""Rate in which dry friction turns over [rad/s]."""


class ByHand(NamedTuple):
    """Values of (1): offsets [rad] and compliances [rad/(N m)] of three axes, and the delay [s]."""

    offset: NDArray[np.float64]
    compliance: NDArray[np.float64]
    delay: float


def columns(file: dict[str, np.ndarray]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Differences y, shape (3, n), and the regressors 1, -v and -T of each axis, shape (3, n, 3)."""
    arm = Arm.from_toml(Path(__file__).with_name("robot.toml"))
    inside, time = slice(ENDS, -ENDS), file["time_cont"]
    y, A = [], []
    for k, name in enumerate(make_records.SECONDARY):
        joint = arm.joint(name)
        motor, second = (np.radians(file[key][k]) for key in ("act_pos_mot_deg", "act_pos_se_deg"))
        spline = CubicSpline(time, motor)
        acceleration = uniform_filter1d(spline(time, 2), SMOOTHED)
        torque = joint.gear_ratio * file["act_torque_abs_nm"][k]
        torque = torque - joint.rotor_inertia * joint.gear_ratio**2 * acceleration
        torque = (
            torque - file["f_vis"][k] * spline(time, 1) - file["f_coul"][k] * np.tanh(spline(time, 1) / SLOW)
        )
        y.append((second - motor)[inside])
        A.append(np.column_stack([np.ones(len(time)), -spline(time, 1), -torque])[inside])
    return np.array(y), np.array(A)


def fitted(y: NDArray[np.float64], A: NDArray[np.float64]) -> ByHand:
    """Least squares of (1) over all axes."""
    count, n = y.shape
    whole = np.zeros((count, n, 2 * count + 1))
    for k in range(count):
        whole[k, :, k], whole[k, :, count + k], whole[k, :, -1] = A[k, :, 0], A[k, :, 2], A[k, :, 1]
    x = np.linalg.lstsq(whole.reshape(count * n, -1), y.ravel(), rcond=None)[0]
    return ByHand(x[:count], x[count : 2 * count], float(x[-1]))


def left(y: NDArray[np.float64], A: NDArray[np.float64], found: ByHand) -> NDArray[np.float64]:
    """Root mean square of what (1) leaves at each axis [rad]."""
    said = np.array([A[k] @ [found.offset[k], found.delay, found.compliance[k]] for k in range(len(y))])
    return np.asarray(np.sqrt(np.mean((y - said) ** 2, axis=1)))


def by_hand(data: Path) -> tuple[ByHand, NDArray[np.float64], NDArray[np.float64]]:
    """Fit of trajectory a, and what it leaves there and in b [rad]."""
    check_folder(data, " and ".join(make_records.FILES.values()))
    a, b = (columns(make_records.read_mat(data / file)) for file in make_records.FILES.values())
    found = fitted(*a)
    return found, left(*a, found), left(*b, found)


def show(data: Path) -> None:
    """Prints a line for each axis."""
    found, train, held_out = by_hand(data)
    print(f"delay of the secondary encoders: {1e3 * found.delay:.2f} ms")
    print("axis   offset [mrad]   compliance [1e-7 rad/(N m)]   left in a, in b [microrad]")
    for k, axis in enumerate(make_records.SECONDARY):
        values = 1e3 * found.offset[k], 1e7 * found.compliance[k], 1e6 * train[k], 1e6 * held_out[k]
        print("{:6s} {:13.3f} {:25.2f} {:22.0f} {:5.0f}".format(axis, *values))


def main() -> int:
    """Command line; 0 if done, 2 if the input is at fault."""
    parser = argparse.ArgumentParser(description="Secondary encoders of the KUKA KR 300 by hand.")
    parser.add_argument("data", type=Path, metavar="DATA_DIR", help="holds the files of both trajectories")
    return exit_code(lambda: show(parser.parse_args().data))


if __name__ == "__main__":
    sys.exit(main())
