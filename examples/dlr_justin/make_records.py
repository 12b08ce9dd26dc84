"""Model and records of Agile Justin, a humanoid with elastic joints, from its makers' poses.

    python make_records.py DATA_DIR OUT_DIR

reads `poses.csv` of DATA_DIR and writes

    OUT_DIR/justin.toml                 the model: rigid links along the published chains of joints
    OUT_DIR/training, OUT_DIR/held_out  static records: three poses in four, and every fourth one

The joints follow Craig's convention: with alpha, r, theta and d of `TORSO`, `RIGHT` and `LEFT`, the frame of
a joint at angle q in that of the joint before is

    T(q) = Rx(alpha) Tx(r) Rz(theta + q) Tz(d)                                                       (1)

The model's joint angle is theta + q about z, its origin the rest. A linkage keeps the chest upright: the
fourth torso joint stands at -(q1 + q2). Nobody states where shoulders and markers are, nor what links weigh:
`SHOULDERS` and `MARKERS` are a rigid fit to all poses, rounded, and `MASSES` are guesses from arms of that
size.
"""

from __future__ import annotations

import sys
from math import cos, radians, sin
from pathlib import Path
from typing import Any

import numpy as np

from flexarm import Arm, Record, Signal
from flexarm.output import output_directory
from flexarm.record import Frame

sys.path.insert(0, str(Path(__file__).parents[1]))
from data_script import check_folder, command_line, exit_code, read_numbers

TORSO = ((0, 0, 0, 0.1055), (-90, 0, -90, 0), (0, 0.3, 0, 0), (0, 0.3, 0, 0))
RIGHT = (
    (0, 0, 0, 0), (90, 0, 0, 0), (-90, 0, -90, 0.4), (90, 0, 0, 0), (-90, 0, -180, 0.39), (90, 0, 90, 0),
    (90, 0, -90, 0),
)  # fmt: skip
LEFT = (
    (180, 0, 0, 0), (90, 0, 0, 0), (-90, 0, -90, -0.4), (90, 0, 0, 0), (-90, 0, 0, -0.39), (-90, 0, 90, 0),
    (-90, 0, -90, 0),
)  # fmt: skip
"""alpha [deg], r [m], theta [deg], d [m] of (1), as published."""
SHOULDERS = {
    "right": ((0.0, 0.08, -0.26), (180, 30, 180)),
    "left": ((0.0, 0.08, 0.25), (0, 30, 0)),
}
"""Mount of each arm on the chest: place [m], and roll, pitch and yaw [deg]."""
MARKERS = {"right": (0.10, 0.20, -0.02), "left": (0.10, 0.17, 0.02)}
"""In the frame of the last joint [m]."""
MASSES = {
    "torso": (8.0, 8.0, 8.0, 20.0),
    "arm": (2.5, 2.5, 2.5, 2.5, 1.5, 1.5, 2.5),
}
"""Of the links [kg]; the chest carries the head, the last link of an arm the hand."""
CENTRES: dict[tuple[str, int], tuple[float, float, float]] = {
    ("torso", 2): (0.15, 0.0, 0.0),
    ("torso", 3): (0.15, 0.0, 0.0),
    ("torso", 4): (0.10, 0.05, 0.0),
    ("right", 3): (0.0, 0.0, -0.15),
    ("left", 3): (0.0, 0.0, 0.15),
    ("right", 5): (0.0, 0.0, -0.15),
    ("left", 5): (0.0, 0.0, 0.15),
    ("right", 7): (0.05, 0.08, 0.0),
    ("left", 7): (0.05, 0.08, 0.0),
}
"""Centres of mass in the joints' frames [m]; at the joint where none is given."""
NOISE = 9e-4
"""1 sigma of a camera's position, an axis [m]."""
SIGMAS = {
    "origin.xyz_m": 3e-3,
    "origin.rpy_rad": 5e-3,
    "shoulder xyz": 0.03,
    "shoulder rpy": 0.05,
    "marker": 0.03,
    "mass": 0.3,
    "com_m": 0.03,
}
"""1 sigma of what is uncertain: our judgement [m], [rad], and of the masses relative."""
HOLD_OUT = 4
"""One pose in so many is held out."""


def chain(name: str, table: Any, parent: str) -> list[dict[str, Any]]:
    """Joints along a chain, eq. (1)."""
    found = []
    for k, (alpha, r, _, d) in enumerate(table, 1):
        roll = radians(alpha)
        origin = {"xyz": [r, -d * sin(roll), d * cos(roll)], "rpy": [roll, 0, 0]}
        found.append({"name": f"{name}{k}", "type": "revolute", "parent": parent, "child": f"{name}_link{k}",
                      "origin": origin, "axis": [0, 0, 1]})  # fmt: skip
        parent = f"{name}_link{k}"
    return found


def model() -> Arm:
    """The robot: torso, two arms, a marker at each hand, and what is not known of them."""
    joints, chest = chain("torso", TORSO, "base"), f"torso_link{len(TORSO)}"
    links, points, uncertain = [], [], {}
    for side, table in (("right", RIGHT), ("left", LEFT)):
        place, angles = SHOULDERS[side]
        joints.append({"name": f"{side}_shoulder", "type": "fixed", "parent": chest, "child": f"{side}_mount",
                       "origin": {"xyz": place, "rpy": [radians(angle) for angle in angles]}})  # fmt: skip
        links.append({"name": f"{side}_mount", "type": "rigid", "mass": 0.0})
        joints += chain(side, table, f"{side}_mount")
        points.append({"name": side, "link": f"{side}_link{len(table)}", "position": MARKERS[side]})
        uncertain[f"joints.{side}_shoulder.origin.xyz_m"] = SIGMAS["shoulder xyz"]
        uncertain[f"joints.{side}_shoulder.origin.rpy_rad"] = SIGMAS["shoulder rpy"]
        uncertain[f"points.{side}.position_m"] = SIGMAS["marker"]
    for name, masses in (("torso", MASSES["torso"]), ("right", MASSES["arm"]), ("left", MASSES["arm"])):
        for k, mass in enumerate(masses, 1):
            link = f"{name}_link{k}"
            links.append(
                {"name": link, "type": "rigid", "mass": mass, "com": CENTRES.get((name, k), (0, 0, 0))}
            )
            uncertain |= {f"links.{link}.mass": SIGMAS["mass"], f"links.{link}.com_m": SIGMAS["com_m"]}
            if (name, k) != ("torso", 1):  # the base is where the camera's frame says
                for field in ("origin.xyz_m", "origin.rpy_rad"):
                    uncertain[f"joints.{name}{k}.{field}"] = SIGMAS[field]
    return Arm.from_dict({"format": "flexarm-arm/1", "name": "agile_justin", "joints": joints, "links": links,
                          "points": points, "uncertainty": uncertain})  # fmt: skip


def drives(rows: np.ndarray) -> dict[str, np.ndarray]:
    """theta + q of the joints [rad], by name."""
    q = rows[:, 1:20]
    torso = (*q[:, :3].T, -(q[:, 1] + q[:, 2]))
    named = {"torso": (TORSO, torso), "right": (RIGHT, q[:, 3:10].T), "left": (LEFT, q[:, 10:17].T)}
    return {
        f"{name}{k}": radians(theta) + angle
        for name, (table, angles) in named.items()
        for k, ((_, _, theta, _), angle) in enumerate(zip(table, angles, strict=True), 1)
    }


def record(rows: np.ndarray, what: str) -> Record:
    """The static record of some poses."""
    pose = np.array([f"{row[0]:g}" for row in rows])
    angles = drives(rows)
    signals = [
        Signal(name=joint, quantity="joint_angle", joint=joint, side="motor", values=angle[:, None],
               pose=pose, file="joints.csv")
        for joint, angle in angles.items()
    ]  # fmt: skip
    signals += [
        Signal(name=side, quantity="position", point=side, values=rows[:, 20 + 3 * k : 23 + 3 * k],
               pose=pose, frame="camera", noise_std=NOISE, file="markers.csv")
        for k, side in enumerate(MARKERS)
    ]  # fmt: skip
    return Record(kind="static", signals=signals, drive=tuple(angles), frames={"camera": Frame(unknown=True)},
                  description=f"Agile Justin, markers at both hands, {what}")  # fmt: skip


def make_records(data: Path, out: Path, force: bool = False) -> list[Path]:
    """Writes model and records; returns the records' folders."""
    check_folder(data, "poses.csv")
    headings = ["pose", *(f"q{k}_rad" for k in range(19)), *(f"{s}_{a}_m" for s in MARKERS for a in "xyz")]
    rows = read_numbers(data / "poses.csv", headings)
    held = np.arange(len(rows)) % HOLD_OUT == HOLD_OUT - 1
    parts = {"training": (~held, "three poses in four"), "held_out": (held, "every fourth pose")}
    with output_directory(out, force) as directory:
        model().to_toml(directory / "justin.toml")
        for name, (mask, what) in parts.items():
            record(rows[mask], what).save(directory / name)
    return [out / name for name in parts]


def main() -> int:
    """Command line; 0 if done, 2 if the input is at fault."""
    given = command_line("Model and records of Agile Justin.", "poses.csv", force=True).parse_args()
    return exit_code(lambda: print(*make_records(given.data, given.out, given.force), sep="\n"))


if __name__ == "__main__":
    sys.exit(main())
