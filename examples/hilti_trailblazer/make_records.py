"""Records from the files of the Hilti construction robot.

    python make_records.py DATA_DIR OUT_DIR [--every N]

reads `flat.yaml`, `pallet.yaml` and `trailblazer.urdf` of DATA_DIR and writes

    OUT_DIR/robot.toml, trailblazer.urdf      the model
    OUT_DIR/flat, OUT_DIR/pallet              joint angles and places of the prism, a static record each
    OUT_DIR/flat_tilt, OUT_DIR/pallet_tilt    the same poses with the accelerometers in place of the prism

Of N poses in a row one is taken (default: all). How the entries become signals (SI):

    joint_states    joint_angle of the lifting column [m] and of the arm's six joints [rad], side "motor"
    prism_position  position of `prism`, in the frame "station" that nobody has registered
    tilt_sensor_base_accel, tilt_sensor_column_accel
                    acceleration of `base_tilt` and `column_tilt`, in the axes that the URDF file gives them

A pose is named HEIGHT/SPACE/ID: column height, solution space of the arm, number in the file. The noise is
what the makers state: 0.75 mm an axis of the prism, 4.4e-4 m/s2 of the accelerometers.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import Any

import numpy as np

from flexarm import InvalidFile, Record, Signal
from flexarm.output import output_directory
from flexarm.record import Frame

sys.path.insert(0, str(Path(__file__).parents[1]))
from data_script import check_folder, command_line, exit_code, read_text

FILES = ("flat", "pallet")
PRISM_NOISE = 7.5e-4
"""1 sigma of the prism's position, an axis [m]."""
TILT_NOISE = 4.4e-4
"""1 sigma of the accelerometers, an axis [m/s2]."""
SENSORS = {
    "base_tilt": "tilt_sensor_base_accel",
    "column_tilt": "tilt_sensor_column_accel",
}


def read_yaml(path: Path) -> dict[str, Any]:
    """The file as it stands.

    Raises
    ------
    InvalidFile
        If it cannot be read, or is no such file.
    """
    try:
        import yaml
    except ModuleNotFoundError:
        raise InvalidFile(path, "file", "needs PyYAML to be read: pip install pyyaml") from None
    try:
        found = yaml.load(read_text(path), getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    except yaml.YAMLError as error:
        raise InvalidFile(path, "file", f"is no YAML: {str(error).splitlines()[0]}") from None
    if not isinstance(found, dict) or not {"joint_names", "column_heights"} <= found.keys():
        raise InvalidFile(path, "file", "must hold joint_names and column_heights")
    return found


def poses(content: dict[str, Any], path: Path) -> dict[str, dict[str, Any]]:
    """The measurements of a file, by the name of the pose.

    Raises
    ------
    InvalidFile
        If an entry is missing or of another size.
    """
    sizes = {"joint_states": len(content["joint_names"]), "prism_position": 3} | dict.fromkeys(
        SENSORS.values(), 3
    )
    found = {}
    for height, spaces in content["column_heights"].items():
        for space, kinds in spaces["solution_spaces"].items():
            for entry in (*kinds["stationing_measurements"], *kinds["evaluation_measurements"]):
                name = f"{height:g}/{space}/{entry['id']}"
                for key, size in sizes.items():
                    if np.shape(entry.get(key)) != (size,):
                        raise InvalidFile(
                            path, f"pose {name}, {key}", f"must be {size} numbers, got {entry.get(key)}"
                        )
                found[name] = entry
    if not found:
        raise InvalidFile(path, "column_heights", "holds no poses")
    return found


def records(content: dict[str, Any], path: Path, name: str, every: int = 1) -> dict[str, Record]:
    """The records of a file: with the prism, and with the accelerometers."""
    entries = dict(list(poses(content, path).items())[::every])
    rows = np.array(list(entries))

    def column(key: str) -> Any:
        return np.array([entry[key] for entry in entries.values()], dtype=float)

    angles = column("joint_states")
    joints = [
        Signal(name=joint, quantity="joint_angle", joint=joint, side="motor", values=angles[:, [k]],
               pose=rows, unit="m" if "prismatic" in joint else "rad", file="joints.csv")
        for k, joint in enumerate(content["joint_names"])
    ]  # fmt: skip
    prism = Signal(name="prism", quantity="position", point="prism", values=column("prism_position"),
                   pose=rows, frame="station", noise_std=PRISM_NOISE, file="prism.csv")  # fmt: skip
    tilts = [
        Signal(name=point, quantity="acceleration", point=point, values=column(key), pose=rows,
               noise_std=TILT_NOISE, file=f"{point}.csv")
        for point, key in SENSORS.items()
    ]  # fmt: skip
    common: dict[str, Any] = {"kind": "static", "drive": tuple(joint.name for joint in joints)}
    return {
        name: Record(
            signals=[*joints, prism],
            frames={"station": Frame(unknown=True)},
            description=f"Trailblazer on {name}, prism seen from a total station",
            **common,
        ),
        f"{name}_tilt": Record(
            signals=[*joints, *tilts], description=f"Trailblazer on {name}, accelerometers", **common
        ),
    }


def make_records(data: Path, out: Path, every: int = 1, force: bool = False) -> list[Path]:
    """Writes model and records; returns the records' folders."""
    check_folder(data, "flat.yaml and pallet.yaml")
    if not (data / "trailblazer.urdf").exists():
        raise InvalidFile(data / "trailblazer.urdf", "file", "there is no such file")
    read = {name: read_yaml(data / f"{name}.yaml") for name in FILES}
    found = []
    with output_directory(out, force) as directory:
        shutil.copy(Path(__file__).with_name("robot.toml"), directory / "robot.toml")
        shutil.copy(data / "trailblazer.urdf", directory / "trailblazer.urdf")
        for name, content in read.items():
            for label, record in records(content, data / f"{name}.yaml", name, every).items():
                record.save(directory / label)
                found.append(out / label)
    return found


def main() -> int:
    """Command line; 0 if done, 2 if the input is at fault."""
    files = "flat.yaml, pallet.yaml, trailblazer.urdf"
    parser = command_line("Records of the Hilti construction robot.", files, force=True)
    parser.add_argument("--every", type=int, default=1, metavar="N", help="take one of N poses")
    given = parser.parse_args()
    if given.every < 1:
        parser.error(f"--every must be at least 1, got {given.every}")
    return exit_code(lambda: print(*make_records(given.data, given.out, given.every, given.force), sep="\n"))


if __name__ == "__main__":
    sys.exit(main())
