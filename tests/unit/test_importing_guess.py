"""Claims about proposed maps: logs of a known motion, and what the proposal makes of them."""

import tomllib
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from log_files import single_mcap
from scipy.spatial.transform import Rotation

import flexarm
from flexarm import Arm, InvalidFile
from flexarm.arm.kinematics import link_pose
from flexarm.cli.run import run
from flexarm.importing.guess.logged import _unit_by_size
from flexarm.importing.guess.motion import Track, agreement, white_noise
from flexarm.importing.guess.text_stamps import text_stamps
from flexarm.importing.guess.words import matched, meaning_of

MODEL = """
format = "flexarm-arm/1"
[[joints]]
name = "pan"
type = "revolute"
parent = "base"
child = "mast"
axis = [0, 0, 1]
gear_ratio = 50
[[joints]]
name = "lift"
type = "revolute"
parent = "mast"
child = "boom"
origin = { xyz = [0, 0, 1], rpy = [0, 0, 0] }
axis = [0, 1, 0]
gear_ratio = 80
[[links]]
name = "mast"
type = "rigid"
mass = 1
com = [0, 0, 0]
inertia = [1, 1, 1]
[[links]]
name = "boom"
type = "rigid"
mass = 1
com = [0, 0, 0]
inertia = [1, 1, 1]
[[points]]
name = "tip"
link = "boom"
position = [2, 0, 0]
"""
RATIO = {"pan": 50.0, "lift": 80.0}
LATE = 0.35


def angles(t):
    """Output angles [rad]: they begin and end at rest, at different speeds."""
    return {"pan": 0.8 * np.sin(0.9 * t) ** 2 + 0.2 * np.sin(2.3 * t), "lift": 0.5 * np.sin(1.4 * t)}


def place(arm, t):
    return link_pose(arm, "boom", angles(t)).of_point(np.array([2.0, 0, 0]))


@pytest.fixture
def logs(tmp_path):
    """A robot's log in degrees of its motors; a tracker's in mm, in a frame and on a clock of its own."""
    (tmp_path / "arm.toml").write_text(MODEL)
    arm = Arm.from_toml(tmp_path / "arm.toml")
    rng = np.random.default_rng(5)
    t = np.arange(0, 8, 0.004)
    motor = {k: np.degrees(q * RATIO[k]) + 1e-2 * rng.standard_normal(len(t)) for k, q in angles(t).items()}
    rows = [f"{a:.3f};{b:.6f};{c:.6f}" for a, b, c in zip(t, motor["pan"], motor["lift"], strict=True)]
    (tmp_path / "robot.csv").write_text("time;q_pan;q_lift\n" + "\n".join(rows).replace(".", ","))
    at = np.arange(0.3, 7.5, 0.01)
    turn = Rotation.from_euler("xyz", [0.1, -0.2, 2.0]).as_matrix()
    seen = 1000 * ((place(arm, at) - [3, 1, 0]) @ turn) + 0.05 * rng.standard_normal((len(at), 3))
    stamps = 1e3 * (at + LATE)
    rows = [f"{s:.1f},{x:.4f},{y:.4f},{z:.4f},7" for s, (x, y, z) in zip(stamps, seen, strict=True)]
    (tmp_path / "tracker.csv").write_text("t (ms),tip X,tip Y,tip Z,mode\n" + "\n".join(rows) + "\n")
    return tmp_path


def write_robot(folder, columns, t):
    """A controller's file of columns by name, with decimal commas."""
    head = ";".join(["Zeit [ms]", *columns])
    rows = [";".join(f"{v:.6f}" for v in row) for row in zip(1e3 * t, *columns.values(), strict=True)]
    (folder / "robot.csv").write_text(head + "\n" + "\n".join(rows).replace(".", ",") + "\n")


def guessed(folder, *files, out="map.toml", model="arm.toml"):
    """The tables and the text of a proposal by the command."""
    given = [str(folder / file) for file in files]
    assert run(["import", "--guess", *given, "--model", str(folder / model), "--out", str(folder / out)]) == 0
    text = (folder / out).read_text()
    return tomllib.loads(text), text


def test_units_gears_frames_and_clocks_follow_from_the_models_motion(logs):
    data, text = guessed(logs, "robot.csv", "tracker.csv")
    signals = {each["name"]: each for each in data["signals"]}
    assert set(signals) == {"pan", "lift", "tip"}
    for name in ("pan", "lift"):
        assert (signals[name]["unit"], signals[name]["before_gear"]) == ("deg", True)
    assert signals["tip"]["columns"] == ["tip X", "tip Y", "tip Z"]
    assert (signals["tip"]["unit"], signals["tip"]["time_unit"]) == ("mm", "ms")
    assert data["drive"] == ["pan", "lift"]
    assert data["clocks"]["tracker"] == "unknown"
    assert data["frames"] == {"tracker": "unknown"}
    assert "correlate with the model's by 0.99 at a lag of" in text or "by 1.00 at a lag" in text
    assert "# unknown: side" in text
    assert '"mode": unknown' in text


def test_a_unit_with_which_the_model_meets_the_point_is_known(logs):
    """Degrees of the output and radians of a motor at 80 : 1 move the model 57 / 80 as far, not alike."""
    t = np.arange(0, 8, 0.02)
    write_robot(logs, {f"q_{name}": np.degrees(q) for name, q in angles(t).items()}, t)
    data, text = guessed(logs, "robot.csv", "tracker.csv")
    signals = {each["name"]: each for each in data["signals"]}
    for name in ("pan", "lift"):
        assert signals[name]["unit"] == "deg"
        assert "before_gear" not in signals[name]
    assert "fits almost as well" not in text
    assert text.count("with other units") == 2


def test_a_unit_with_which_the_model_is_far_nearer_to_the_point_is_taken(logs):
    """The tracker sees one swing; degrees of the output move the point more nearly as far as all of them."""
    t = np.arange(0, 8, 0.004)
    pan = np.radians(170) * np.sin(0.9 * t)
    rows = "".join(f"{a:.3f},{np.degrees(q) * RATIO['pan']:.6f}\n" for a, q in zip(t, pan, strict=True))
    (logs / "robot.csv").write_text(f"time,pan_motor_deg\n{rows}")
    part = slice(600, 1150, 5)
    seen = t[part]
    xyz = [2 * np.cos(pan[part]), 2 * np.sin(pan[part]), np.ones(len(seen))]
    rows = "".join(f"{a:.3f},{x:.6f},{y:.6f},{z:.6f}\n" for a, x, y, z in zip(seen, *xyz, strict=True))
    (logs / "tracker.csv").write_text(f"time,x,y,z\n{rows}")
    data, text = guessed(logs, "robot.csv", "tracker.csv")
    assert data["signals"][0]["before_gear"] is True
    assert "# unknown: unit" not in text


def test_a_current_in_milliampere_is_scaled_to_the_ampere_of_its_constant(logs):
    t = np.arange(0, 8, 0.02)
    write_robot(logs, {**angles(t), "pan current [mA]": 100 * np.sin(t)}, t)
    _, text = guessed(logs, "robot.csv", "tracker.csv")
    assert "scale = 0.001  # the constant is of one ampere, the log in mA" in text


def test_columns_with_the_bare_names_of_joints_are_their_angles(logs):
    t = np.arange(0, 8, 0.02)
    write_robot(logs, angles(t), t)
    data, _ = guessed(logs, "robot.csv", "tracker.csv")
    drives = data["signals"][:2]
    assert [(each["joint"], each["quantity"], each["unit"]) for each in drives] == [
        ("pan", "joint_angle", "rad"),
        ("lift", "joint_angle", "rad"),
    ]


def test_what_is_proposed_can_be_imported_and_is_true(logs):
    guessed(logs, "robot.csv", "tracker.csv")
    record = flexarm.import_record(logs / "map.toml")
    pan = record.signals["pan"]
    np.testing.assert_allclose(pan.values[:, 0], angles(pan.time)["pan"], atol=2e-5)
    assert record.signals["pan"].noise_std == pytest.approx(np.radians(1e-2) / 50, rel=0.3)
    assert record.signals["tip"].noise_std == pytest.approx(5e-5, rel=0.5)
    assert record.check_against(Arm.from_toml(logs / "arm.toml")) == []


def test_a_tracker_in_the_bases_axes_needs_no_frame(logs):
    arm = Arm.from_toml(logs / "arm.toml")
    t = np.arange(0, 8, 0.01)
    rows = [f"{s:.2f},{x:.6f},{y:.6f},{z:.6f}" for s, (x, y, z) in zip(t, place(arm, t), strict=True)]
    (logs / "mocap.csv").write_text("time,x,y,z\n" + "\n".join(rows) + "\n")
    data, text = guessed(logs, "robot.csv", "mocap.csv")
    assert "frames" not in data
    assert 'frame = "base"  # it is' in text


def test_a_tracker_without_names_is_found_by_how_its_points_move(logs):
    """Blanks between the cells, a comment, rows of two points, of which one is the model's."""
    arm = Arm.from_toml(logs / "arm.toml")
    t = np.arange(0, 8, 0.02)
    rows = []
    for s, (x, y, z) in zip(t, 1000 * place(arm, t), strict=True):
        rows += [f"Tip {x:.3f} {y:.3f} {z:.3f} {s:.2f}", f"Wall 100.0 200.0 300.0 {s + 0.01:.2f}"]
    (logs / "tracker.txt").write_text("// job 7, mm\n" + "\n".join(rows) + "\n")
    data, text = guessed(logs, "robot.csv", "tracker.txt")
    (tip,) = [each for each in data["signals"] if each["quantity"] == "position"]
    assert (tip["columns"], tip["time"], tip["where"]) == ([2, 3, 4], 5, {"1": "Tip"})
    assert (tip["point"], tip["unit"]) == ("tip", "mm")
    assert "# unknown: columns: whether they are x, y, z in this order" in text
    record = flexarm.import_record(logs / "map.toml")
    assert len(record.signals["tip"]) == len(t)


def test_without_a_measured_point_ranges_tell_the_unit_or_it_is_open(logs):
    data, text = guessed(logs, "robot.csv")
    assert {each["unit"] for each in data["signals"]} == {"deg"}
    assert "# unknown: unit" not in text  # 2000 deg are too far for an output, and 2000 rad for a motor
    t = np.arange(0, 2, 0.01)
    rows = "\n".join(f"{s:.2f},{np.sin(s):.5f},{np.cos(s):.5f}" for s in t)
    (logs / "small.csv").write_text("time,q_pan,q_lift\n" + rows + "\n")
    _, text = guessed(logs, "small.csv", out="small.toml")
    assert "# unknown: unit: no measured point tells" in text


def test_a_column_of_unknown_joint_is_commented_out(logs):
    t = np.arange(0, 2, 0.01)
    rows = "\n".join(f"{s:.2f},{np.sin(s):.5f}" for s in t)
    (logs / "one.csv").write_text("time,angle\n" + rows + "\n")
    data, text = guessed(logs, "one.csv")
    assert "signals" not in data
    assert "# # unknown: joint: there are pan, lift" in text
    assert "# unknown: drive" in text


def test_a_bag_is_proposed_by_the_names_in_its_messages(logs):
    model = MODEL.replace('"pan"', '"shoulder"').replace('"lift"', '"elbow"')
    (logs / "other.toml").write_text(model)
    single_mcap(logs / "log.mcap")
    data, _ = guessed(logs, "log.mcap", model="other.toml")
    signals = {(each["topic"], tuple(each["columns"])): each for each in data["signals"]}
    assert signals["/joint_states", ("position[shoulder]",)]["joint"] == "shoulder"
    assert signals["/joint_states", ("position[elbow]",)]["time"] == "header.stamp"
    (tip,) = [each for each in data["signals"] if each["name"] == "tip"]  # not the transform that rests
    assert tip["columns"][0] == "transforms[tool.tip].transform.translation.x"
    assert tip["time"] == "transforms[tool.tip].header.stamp"
    assert (tip["point"], tip["unit"]) == ("tip", "mm")


def test_options_that_are_missing_or_out_of_place_are_errors(logs, capsys):
    csv, model = str(logs / "robot.csv"), str(logs / "arm.toml")
    assert run(["import", "--guess", csv, "--model", model]) == 2
    assert run(["import", "--guess", csv, "--out", str(logs / "m.toml")]) == 2
    assert run(["import", csv, "--model", model]) == 2
    assert run(["import", "--guess", csv, "--model", model, "--out", csv]) == 2
    said = capsys.readouterr().err
    assert "--out: is needed" in said
    assert "--model: is needed" in said
    assert "belongs to --guess" in said
    assert (logs / "robot.csv").read_text().startswith("time;q_pan")


@pytest.mark.parametrize(
    ("name", "kind", "quantity", "axis", "unit"),
    [
        ("act_pos_mot_deg[2]", "", "joint_angle", "", "deg"),
        ("act_vel_mot_deg_per_s[1]", "", "joint_rate", "", "deg/s"),
        ("act_torque_abs_nm[1]", "", "motor_torque", "", "N m"),
        ("tip_x_mm", "", "position", "x", "mm"),
        ("pose.position.z", "geometry_msgs/msg/PoseStamped", "position", "z", ""),
        ("pose.orientation.w", "geometry_msgs/msg/PoseStamped", "orientation", "w", ""),
        ("linear_acceleration.y", "sensor_msgs/msg/Imu", "acceleration", "y", ""),
        ("angular_velocity.x", "sensor_msgs/msg/Imu", "angular_rate", "x", ""),
        ("effort[elbow]", "sensor_msgs/msg/JointState", "motor_torque", "", ""),
        ("Position Reference (rad)", "", "joint_command", "", "rad"),
        ("Motor Current [A]", "", "current", "", "A"),
        ("Zähler Hüfte [Inkr]", "", "joint_angle", "", "counts"),
        ("error_pos_deg", "", "", "", "deg"),
        ("ax1", "", "", "", ""),
        ("imu_gy_dps", "", "angular_rate", "y", "deg/s"),
        ("temperature", "", "", "", ""),
    ],
)
def test_names_say_what_columns_are(name, kind, quantity, axis, unit):
    found = meaning_of(name, kind=kind)
    assert (found.quantity, found.axis, found.unit) == (quantity, axis, unit)


def test_the_longest_name_that_fits_is_the_joints():
    assert matched("position[left_shoulder]", ["shoulder", "left_shoulder"]) == "left_shoulder"
    assert matched("position[hip]", ["shoulder"]) == ""


@pytest.mark.parametrize(
    ("time", "unit", "sure"),
    [
        (1.7e9 + 0.01 * np.arange(9), "s", True),
        (1.7e18 + 1e6 * np.arange(9), "ns", True),
        (4.0 * np.arange(9), "ms", False),
        (0.004 * np.arange(9), "s", True),
        (1e6 * np.arange(9), "us", False),
    ],
)
def test_the_unit_of_stamps_by_size_and_interval(time, unit, sure):
    found, why = _unit_by_size(np.asarray(time, dtype=float))
    assert (found, bool(why)) == (unit, sure) or not sure


def test_speeds_find_the_lag_of_a_motion():
    t = np.arange(0, 10, 0.01)
    motion = np.sin(t) + 0.3 * np.sin(3.7 * t + 1)
    found = agreement(Track(t[:-50], motion[50:, None]), Track(t, motion[:, None]))
    assert found.correlation > 0.99
    assert found.lag == pytest.approx(-0.5, abs=0.02)


def test_third_differences_find_white_noise_below_a_motion():
    t = np.arange(0, 10, 0.004)
    noisy = np.sin(5 * t) + 1e-3 * np.random.default_rng(1).standard_normal(len(t))
    assert white_noise(noisy) == pytest.approx(1e-3, rel=0.1)
    assert white_noise(np.zeros(100)) == 0


@pytest.mark.parametrize("axes", [np.eye(3), Rotation.from_euler("xyz", [0.1, -0.2, 2.0]).as_matrix()])
def test_a_joint_that_runs_against_the_model_is_turned(logs, axes):
    """In the base's axes or in the tracker's own; a shift of the places, as of a frame, is no matter."""
    arm = Arm.from_toml(logs / "arm.toml")
    t = np.arange(0, 8, 0.02)
    write_robot(logs, {"pan [rad]": angles(t)["pan"], "lift [rad]": -angles(t)["lift"]}, t)
    seen = 1000 * (place(arm, t) - [3, 1, 0]) @ axes
    rows = [f"{s:.2f},{x:.4f},{y:.4f},{z:.4f}" for s, (x, y, z) in zip(t, seen, strict=True)]
    (logs / "tracker.csv").write_text("time,X,Y,Z\n" + "\n".join(rows) + "\n")
    data, text = guessed(logs, "robot.csv", "tracker.csv")
    signals = {each["name"]: each for each in data["signals"]}
    turned = {name for name in ("pan", "lift") if signals[name].get("scale") == -1.0}
    if axes[0, 0] == 1:
        assert turned == {"lift"}
        assert "against the model's axis: the model comes to within" in text
    else:  # turned by half about x the mirrored motion is the same: the axes of the tracker are not known
        assert len(turned) == 1
        assert "the sign; with lift and pan turned the model fits alike" in text


def bare_tracker(logs, order):
    """A tracker's file without names, in the base's axes, with its columns in some order."""
    arm = Arm.from_toml(logs / "arm.toml")
    t = np.arange(0, 8, 0.02)
    rows = [
        f"{k + 1} {s:.2f} " + " ".join(f"{p[axis]:.4f}" for axis in order)
        for k, (s, p) in enumerate(zip(t, 1000 * place(arm, t), strict=True))
    ]
    (logs / "bare.txt").write_text("\n".join(rows) + "\n")


def test_the_handedness_of_bare_columns_is_open_where_a_mirrored_motion_is_as_near(logs):
    """Exchanged columns are a mirrored motion, which the model makes with one joint turned.

    The first column numbers the rows; the stamps are the second.
    """
    bare_tracker(logs, (0, 2, 1))
    _, text = guessed(logs, "robot.csv", "bare.txt")
    assert "# unknown: columns: whether they are x, y, z in this order" in text
    assert 0 < text.count("scale = -1.0") <= text.count("# unknown: scale: the sign")


def test_signs_that_agree_with_the_model_stay(logs):
    data, _ = guessed(logs, "robot.csv", "tracker.csv")
    assert not any("scale" in each for each in data["signals"])


@pytest.mark.parametrize(
    ("count", "geared", "sign"), [(16384, True, 1), (4000, True, -1), (1_000_000, False, 1)]
)
def test_counts_per_turn_are_those_with_which_the_model_meets_the_point(logs, count, geared, sign):
    t = np.arange(0, 8, 0.004)
    lift = sign * angles(t)["lift"] * (RATIO["lift"] if geared else 1) / (2 * np.pi) * count
    write_robot(logs, {"pan [deg]": np.degrees(angles(t)["pan"]), "lift [Ink]": np.round(lift)}, t)
    data, text = guessed(logs, "robot.csv", "tracker.csv")
    (found,) = [each for each in data["signals"] if each["name"] == "lift"]
    assert found["unit"] == {"counts_per_turn": count}
    assert found.get("before_gear", False) == geared
    assert "of usual counts: the model comes to within" in text
    record = flexarm.import_record(logs / "map.toml")
    np.testing.assert_allclose(
        np.abs(record.signals["lift"].values[:, 0]), np.abs(angles(t)["lift"]), atol=2e-5
    )


def test_whole_numbers_of_an_encoder_are_counts_and_hide_no_tracker(logs):
    """No name says counts; read as degrees they moved the model so that no bare columns went with it."""
    t = np.arange(0, 8, 0.004)
    counts = np.round(RATIO["lift"] * angles(t)["lift"] / (2 * np.pi) * 8192)
    rows = [f"{s:.4f} {c:.0f}" for s, c in zip(t, counts, strict=True)]
    (logs / "drive.txt").write_text("time enc_lift\n" + "\n".join(rows) + "\n")
    write_robot(logs, {"pan [deg]": np.degrees(angles(t)["pan"])}, t)
    rows = [line.rsplit(",", 1)[0] for line in (logs / "tracker.csv").read_text().splitlines()[1:]]
    (logs / "bare.txt").write_text("\n".join(rows).replace(",", " ") + "\n")
    data, text = guessed(logs, "robot.csv", "drive.txt", "bare.txt")
    signals = {each["name"]: each for each in data["signals"]}
    assert (signals["lift"]["unit"], signals["lift"]["before_gear"]) == ({"counts_per_turn": 8192}, True)
    assert signals["tip"]["columns"] == [2, 3, 4]
    assert "'enc' in the name; whole numbers" in text


def test_counts_of_all_joints_are_found_beside_a_tracker_without_names(logs):
    """No joint's unit was known, so that no columns could be told by how they move."""
    t = np.arange(0, 8, 0.004)
    counts = {f"{k} [Ink]": np.round(q * RATIO[k] / (2 * np.pi) * 65536) for k, q in angles(t).items()}
    write_robot(logs, counts, t)
    bare_tracker(logs, [0, 1, 2])
    data, text = guessed(logs, "robot.csv", "bare.txt")
    signals = {each["name"]: each for each in data["signals"]}
    assert data["drive"] == ["pan", "lift"]
    assert [signals[k]["unit"] for k in RATIO] == [{"counts_per_turn": 65536}] * 2
    assert "# the only ones without names that move" in text


def test_a_map_all_of_whose_signals_wait_says_for_what(logs):
    t = np.arange(0, 8, 0.004)
    write_robot(logs, {f"{k} [counts]": np.round(1e5 * q) for k, q in angles(t).items()}, t)
    _, text = guessed(logs, "robot.csv")
    assert "# unknown: drive; the angles below are commented out: say what they lack" in text
    assert '# drive = ["pan", "lift"]' in text
    with pytest.raises(InvalidFile, match="at least one signal that is not commented out"):
        flexarm.import_record(logs / "map.toml")


def test_counts_without_a_measured_point_are_left_open(logs):
    t = np.arange(0, 8, 0.004)
    write_robot(logs, {"pan [deg]": angles(t)["pan"], "lift [counts]": np.round(1e5 * angles(t)["lift"])}, t)
    data, text = guessed(logs, "robot.csv")
    assert [each["name"] for each in data["signals"]] == ["pan"]
    assert "# # unknown: unit: no measured point tells how many counts are a turn" in text


def test_targets_of_a_tracker_and_its_dates_are_told_apart(logs):
    """Streams of two targets with numbers of their own, date and time of day beside each other."""
    arm = Arm.from_toml(logs / "arm.toml")
    start = datetime(2026, 9, 14, 23, 59, 57)
    rows = ["// SA 2024.1", "// Working Frame: A::Tracker"]
    for group, wall in (("Tool", 0.0), ("Wall", 1.0)):
        for k, t in enumerate(np.arange(0.3, 7.5, 0.02)):
            x, y, z = np.ravel(1000 * (place(arm, t) * (1 - wall) + wall))
            stamp = (start + timedelta(seconds=float(t))).strftime("%m/%d/%Y %H:%M:%S.%f")[:-3]
            rows.append(f"A {group} p{k} {x:.4f} {y:.4f} {z:.4f} {stamp}")
    (logs / "sa.txt").write_text("\n".join(rows) + "\n")
    data, text = guessed(logs, "robot.csv", "sa.txt")
    assert "time = [7, 8]  # its texts read as dates and times; the source says its unit; 50 Hz" in text
    (tip,) = [each for each in data["signals"] if each["name"] == "tip"]
    assert (tip["time"], tip["time_format"]) == ([7, 8], "%m/%d/%Y %H:%M:%S.%f")
    assert (tip["where"], tip["columns"]) == ({"2": "Tool"}, [4, 5, 6])
    record = flexarm.import_record(logs / "map.toml")
    assert record.signals["tip"].time[-1] - record.signals["tip"].time[0] == pytest.approx(7.18, abs=1e-6)


def test_which_of_the_models_points_was_measured_follows_from_its_motion(logs):
    elbow = '[[points]]\nname = "mid"\nlink = "boom"\nposition = [1, 0, 0.5]\n'
    (logs / "arm.toml").write_text(MODEL + elbow)
    (logs / "seen.csv").write_text((logs / "tracker.csv").read_text().replace("tip ", ""))
    data, text = guessed(logs, "robot.csv", "seen.csv")
    (seen,) = [each for each in data["signals"] if each["quantity"] == "position"]
    assert seen["point"] == "tip"
    assert "# unknown: point: taken by its speed, which goes with that of tip by" in text


@pytest.mark.parametrize("late", [0.0, LATE])
def test_a_point_that_is_late_in_the_file_of_the_joints_has_a_clock_of_its_own(logs, late):
    """One table of all: what a stamp says of the point is where it was before."""
    t = np.arange(0.5, 8, 0.01)
    joints = {f"q_{name} [deg]": np.degrees(q) for name, q in angles(t).items()}
    tip = place(Arm.from_toml(logs / "arm.toml"), t - late)
    write_robot(logs, joints | {f"tip {axis} [m]": x for axis, x in zip("XYZ", tip.T, strict=True)}, t)
    data, text = guessed(logs, "robot.csv")
    clocks = {"robot": 0.0} | ({"robot_tip": "unknown"} if late else {})
    assert data["clocks"] == clocks
    used = {each["name"]: each["clock"] for each in data["signals"]}
    assert used == {"pan": "robot", "lift": "robot", "tip": "robot_tip" if late else "robot"}
    if late:
        [said] = [line for line in text.splitlines() if line.startswith("clock = ") and "late" in line]
        assert float(said.split("are ")[1].split(" s")[0]) == pytest.approx(late, abs=0.02)


def test_an_angle_of_unknown_joint_has_a_clock_and_no_noise_before_its_gear_is_known(logs):
    """Once it is uncommented it must neither count on the tracker's clock nor have the motor's noise."""
    t = np.arange(0, 8, 0.004)
    rows = "\n".join(f"{s:.3f},{np.degrees(50 * q):.3f}" for s, q in zip(t, angles(t)["pan"], strict=True))
    (logs / "one.csv").write_text("time,Drehwerk [deg]\n" + rows + "\n")
    data, text = guessed(logs, "one.csv", "tracker.csv")
    assert data["clocks"] == {"one": 0.0, "tracker": "unknown"}
    waiting = [line for line in text.splitlines() if line.startswith("# ")]
    assert '# clock = "one"' in waiting
    assert any("unknown: before_gear" in line for line in waiting)
    assert not any("noise_std" in line for line in waiting)


def test_columns_that_never_change_are_no_signals_and_numbers_name_joints(logs):
    t = np.arange(0, 8, 0.004)
    angle = {"A2 Ist [deg]": np.degrees(angles(t)["lift"]), "A1 Ist [deg]": np.degrees(angles(t)["pan"])}
    still = {"vel pan": 0 * t, "gyro x": 0 * t, "gyro y": 0 * t, "gyro z": 0 * t}
    write_robot(logs, angle | still | {"A2 Moment [Nm]": np.sin(t)}, t)
    data, text = guessed(logs, "robot.csv", "tracker.csv")
    signals = {each["name"]: each for each in data["signals"]}
    assert set(signals) == {"pan", "lift", "lift_motor_torque", "tip"}
    assert signals["lift"]["columns"] == ["A2 Ist [deg]"]
    assert "taken by its number 2 in the order of the model" in text
    assert '"vel pan": may be joint_rate, always 0' in text


def test_a_damaged_number_is_a_drop_out(logs):
    """Its square would be infinite."""
    whole = guessed(logs, "robot.csv", "tracker.csv")[0]["signals"]
    lines = (logs / "robot.csv").read_text().splitlines()
    cells = lines[len(lines) // 2].split(";")
    lines[len(lines) // 2] = ";".join([cells[0], "1e300", *cells[2:]])
    (logs / "robot.csv").write_text("\n".join(lines) + "\n")
    found = guessed(logs, "robot.csv", "tracker.csv", out="again.toml")[0]["signals"]
    assert [each["columns"] for each in found] == [each["columns"] for each in whole]


@pytest.mark.parametrize(
    ("columns", "form", "seconds"),
    [
        (["09/13/2026 11:59:59.5 PM", "09/14/2026 12:00:00.5 AM"], "%m/%d/%Y %I:%M:%S.%f %p", 1.0),
        (["14.09.2026 14:00:07", "14.09.2026 14:00:08"], "%d.%m.%Y %H:%M:%S", 1.0),
        (["23:59:58.25", "23:59:59.00"], "%H:%M:%S.%f", 0.75),
        (["14.09.2026 23:59:58,25", "14.09.2026 23:59:59,00"], "%d.%m.%Y %H:%M:%S,%f", 0.75),
    ],
)
def test_forms_of_dates_are_seen(columns, form, seconds):
    found = text_stamps([1], [columns])
    assert found is not None and (found.form, found.unknown) == (form, "")
    assert np.diff(found.seconds) == pytest.approx(seconds)


def test_a_date_that_reads_two_ways_says_so():
    found = text_stamps(["d", "t"], [["01/02/2026"] * 2, ["10:00:00", "10:00:01"]])
    assert found is not None and found.columns == ("d", "t")
    assert found.unknown == "which of %d/%m/%Y and %m/%d/%Y the date is"
    assert text_stamps([1], [["p1", "p2"]]) is None


def test_half_of_the_day_may_stand_in_a_column_of_its_own():
    names = ["p9", "p10"]
    found = text_stamps([1, 5, 6, 7], [names, ["9/14/2026"] * 2, ["11:59:59", "12:00:00"], ["AM", "PM"]])
    assert found is not None and (found.columns, found.form) == ((5, 6, 7), "%m/%d/%Y %I:%M:%S %p")
    assert np.diff(found.seconds).tolist() == [1.0]


@pytest.mark.parametrize(("size", "unit"), [(0.4, "m"), (400.0, "mm")])
def test_a_joint_that_slides_is_in_metres_or_millimetres_and_one_beside_it_in_degrees(logs, size, unit):
    """Each kind of joint has units of its own, in one file too."""
    slides = MODEL.replace('name = "lift"\ntype = "revolute"', 'name = "lift"\ntype = "prismatic"')
    (logs / "slide.toml").write_text(slides.replace("gear_ratio = 80\n", ""))
    t = np.arange(0, 2, 0.01)
    write_robot(logs, {"q_pan": 3000 * np.sin(t), "q_lift": size * np.sin(1.4 * t) ** 2}, t)
    data, text = guessed(logs, "robot.csv", model="slide.toml")
    signals = {each["name"]: each for each in data["signals"]}
    assert (signals["pan"]["unit"], signals["lift"]["unit"]) == ("deg", unit)
    assert f"as {unit} of the output values reach 0.4 m" in text


def test_a_length_with_the_name_of_a_joint_that_slides_is_its_way(logs):
    slides = MODEL.replace('name = "lift"\ntype = "revolute"', 'name = "lift"\ntype = "prismatic"')
    (logs / "slide.toml").write_text(slides)
    t = np.arange(0, 2, 0.01)
    write_robot(logs, {"lift [mm]": 400 * np.sin(1.4 * t) ** 2, "pan [mm]": np.sin(t)}, t)
    data, text = guessed(logs, "robot.csv", model="slide.toml")
    [lift] = data["signals"]
    assert (lift["quantity"], lift["joint"], lift["unit"]) == ("joint_angle", "lift", "mm")
    assert '"pan [mm]"' in text


def test_a_column_named_after_all_axes_at_once_is_left_to_its_owner(logs):
    t = np.arange(0, 2, 0.01)
    log = np.column_stack([t, 0.3 * np.sin(t), np.sin(t)])
    np.savetxt(logs / "all.csv", log, delimiter=",", header="time_s,hinge_rad,xyz[1]", comments="")
    assert '"xyz[1]": may be position' in guessed(logs, "all.csv", out="all.toml")[1]


def test_strokes_pressures_and_an_imu_of_a_crane_are_proposed(tmp_path):
    """A stroke in mm is the piston's, the only joint of the loop that slides."""
    crane = (Path(__file__).parents[2] / "examples" / "crane.toml").read_text()
    (tmp_path / "crane.toml").write_text(crane)
    t = np.arange(0.0, 8.0, 0.05)
    swing = np.sin(t)
    plc = np.column_stack([1e3 * t, 300.0 + 90.0 * swing, 55.0 + swing, 4.0 + 0.0 * t])
    np.savetxt(tmp_path / "plc.csv", plc, "%.4f", ";", header="time_ms;stroke_mm;pA_bar;pB_bar", comments="")
    imu = np.column_stack([t, swing, 0.1 * swing, 9.8 + 0.1 * swing, 3 * swing, 0.2 * swing, swing])
    names = "t_s,ax_mps2,ay_mps2,az_mps2,gx_dps,gy_dps,gz_dps"
    np.savetxt(tmp_path / "imu.csv", imu, "%.4f", ",", header=names, comments="")
    found, text = guessed(tmp_path, "plc.csv", "imu.csv", model="crane.toml")
    assert found["drive"] == ["piston"]
    told = {s["name"]: (s["quantity"], s["columns"], s["unit"]) for s in found["signals"]}
    assert told == {
        "piston": ("joint_angle", ["stroke_mm"], "mm"),
        "tip_acceleration": ("acceleration", ["ax_mps2", "ay_mps2", "az_mps2"], "m/s2"),
        "tip_angular_rate": ("angular_rate", ["gx_dps", "gy_dps", "gz_dps"], "deg/s"),
    }
    assert '"pA_bar": a pressure; see `sum`' in text


@pytest.fixture
def gantry(logs):
    """A machine whose joints slide along X, Y and Z, and four seconds of their ways [m]."""
    names = ("base", "X", "Y", "Z")
    model = 'format = "flexarm-arm/1"\n'
    for parent, name, axis in zip(names, names[1:], np.eye(3, dtype=int).tolist(), strict=False):
        model += f'[[joints]]\nname = "{name}"\ntype = "prismatic"\naxis = {axis}\n'
        model += f'parent = "{parent}"\nchild = "{name}"\n'
        model += (
            f'[[links]]\nname = "{name}"\ntype = "rigid"\nmass = 1\ncom = [0, 0, 0]\ninertia = [1, 1, 1]\n'
        )
    (logs / "gantry.toml").write_text(
        model + '[[points]]\nname = "head"\nlink = "Z"\nposition = [0, 0, -0.1]\n'
    )
    t = np.arange(0, 4, 0.01)
    ways = np.column_stack([np.sin(t) ** 2, np.sin(1.7 * t) ** 2, 0.3 * np.sin(2.3 * t) ** 2])
    return t, ways


def test_ways_of_slides_named_as_axes_are_told_from_a_trackers_point(logs, gantry):
    """A gantry's joints are X, Y and Z, as are the columns of the tracker beside it."""
    t, ways = gantry
    for file, values in (("tracker.csv", ways + 1.0), ("plc.csv", ways)):
        head, sheet = "time_s,X_mm,Y_mm,Z_mm", np.column_stack([t, 1e3 * values])
        np.savetxt(logs / file, sheet, "%.4f", ",", header=head, comments="")
    data, _ = guessed(logs, "plc.csv", "tracker.csv", model="gantry.toml")
    told = {s["name"]: (s["source"], s["quantity"], s["columns"]) for s in data["signals"]}
    expected = {name: ("plc.csv", "joint_angle", [f"{name}_mm"]) for name in "XYZ"}
    assert told == expected | {"head": ("tracker.csv", "position", ["X_mm", "Y_mm", "Z_mm"])}
    assert data["drive"] == ["X", "Y", "Z"]


def test_ways_of_axes_are_told_from_a_point_without_names(logs, gantry):
    t, ways = gantry
    names = [f"Achse {axis} Istposition [mm]" for axis in "XYZ"]
    write_robot(logs, dict(zip(names, 1e3 * ways.T, strict=True)), t)
    np.savetxt(logs / "tracker.txt", np.column_stack([t, 1e3 * (ways + 1.0)]), "%.4f")
    data, _ = guessed(logs, "robot.csv", "tracker.txt", model="gantry.toml")
    told = {s["name"]: (s["quantity"], s["columns"]) for s in data["signals"]}
    expected = {axis: ("joint_angle", [name]) for axis, name in zip("XYZ", names, strict=True)}
    assert told == expected | {"head": ("position", [2, 3, 4])}


@pytest.mark.parametrize("name", ["z", "Z"])
def test_a_slide_named_z_among_angles_is_no_coordinate(logs, name):
    slides = MODEL.replace('name = "lift"\ntype = "revolute"', f'name = "{name}"\ntype = "prismatic"')
    (logs / "slide.toml").write_text(slides.replace("gear_ratio = 80\n", ""))
    t = np.arange(0, 8, 0.004)
    write_robot(logs, {"pan_deg": np.degrees(angles(t)["pan"]), "Z_mm": 400 * np.sin(1.4 * t) ** 2}, t)
    data, _ = guessed(logs, "robot.csv", "tracker.csv", model="slide.toml")
    told = {s["name"]: (s["source"], s["quantity"]) for s in data["signals"]}
    robot = ("robot.csv", "joint_angle")
    assert told == {"pan": robot, name: robot, "tip": ("tracker.csv", "position")}


@pytest.fixture
def tables(logs):
    """Forty poses of the robot, numbered, and a tracker's readings of them in a frame of its own."""
    rng = np.random.default_rng(7)
    at = {"pan": rng.uniform(-1.0, 1.0, 40), "lift": rng.uniform(-0.5, 0.5, 40)}
    arm = Arm.from_toml(logs / "arm.toml")
    turn = Rotation.from_euler("xyz", [0.1, -0.2, 2.0]).as_matrix()
    tip = link_pose(arm, "boom", at).of_point(np.array([2.0, 0, 0]))
    seen = 1000 * (tip - [3, 1, 0]) @ turn
    angles = np.degrees(np.column_stack([at["pan"], -at["lift"]]))
    return np.arange(1, 41)[:, None], angles, seen


def write_table(path, head, *columns):
    np.savetxt(path, np.hstack(columns), "%.6f", ",", header=head, comments="")


@pytest.mark.parametrize("number", ["Pose", "", "t_s"])
def test_rows_in_no_order_are_poses_of_one_file(logs, tables, number):
    """Numbered or not, or stamped every half a minute; a sign is found from them as from a motion."""
    rows, angles, seen = tables
    first = {"Pose": [rows], "": [], "t_s": [31.0 * rows]}[number]
    write_table(
        logs / "poses.csv",
        (number + "," if number else "") + "pan [deg],lift [deg],X [mm],Y [mm],Z [mm]",
        *first,
        angles,
        seen,
    )
    data, text = guessed(logs, "poses.csv")
    signals = {each["name"]: each for each in data["signals"]}
    assert data["kind"] == "static" and data["drive"] == ["pan", "lift"] and "clocks" not in data
    assert {each.get("pose") for each in data["signals"]} == {number if number == "Pose" else None}
    assert signals["lift"]["scale"] == -1.0 and "scale" not in signals["pan"]
    assert "distances of its poses correlate with the model's by 1.00" in text
    assert run(["import", str(logs / "map.toml"), "--out", str(logs / "measured")]) == 0
    record = flexarm.Record.load(logs / "measured")
    assert record.kind == "static" and len(record.poses) == 40


@pytest.mark.parametrize("repeats", [1, 5])
def test_poses_and_what_a_tracker_saw_of_them_lie_in_two_files(logs, tables, repeats):
    """The tracker missed one, and may have read each several times."""
    rows, seen = (np.repeat(tables[k], repeats, axis=0) for k in (0, 2))
    write_table(logs / "poses.csv", "nr,pan [deg],lift [deg]", *tables[:2])
    write_table(logs / "points.csv", "point,X [mm],Y [mm],Z [mm]", rows[repeats:], seen[repeats:])
    data, text = guessed(logs, "poses.csv", "points.csv")
    assert data["kind"] == "static"
    assert {s["name"]: s["pose"] for s in data["signals"]} == {"pan": "nr", "lift": "nr", "tip": "point"}
    assert "distances of its poses correlate with the model's by 1.00" in text


def test_poses_that_are_read_several_times_are_no_motion(logs, tables):
    rows, angles, seen = (np.repeat(each, 4, axis=0) for each in tables)
    write_table(logs / "poses.csv", "Pose,pan [deg],lift [deg],X [mm],Y [mm],Z [mm]", rows, angles, seen)
    data, _ = guessed(logs, "poses.csv")
    assert data["kind"] == "static" and data["signals"][0]["pose"] == "Pose"


def test_poses_with_names_are_repeated_and_in_another_order_in_the_trackers_file(logs, tables):
    """Each of forty named poses is measured three times, and the file begins with the last pose."""
    rows, angles, seen = tables
    names = [f"P{row}" for row in rows[:, 0]]
    poses = [f"{name}\t{a:.5f}\t{b:.5f}" for name, (a, b) in zip(names, angles, strict=True)]
    (logs / "poses.dat").write_text("\n".join(["Point\tJ1 [deg]\tJ2 [deg]", *poses]) + "\n")
    told = zip(names, seen, strict=True)
    points = [f"{n},{k}," + ",".join(f"{v:.6f}" for v in row) for n, row in told for k in range(3)]
    head = "Name,Meas,X [mm],Y [mm],Z [mm]"
    (logs / "points.csv").write_text("\n".join([head, *reversed(points)]) + "\n")
    data, text = guessed(logs, "poses.dat", "points.csv")
    signals = {each["name"]: each for each in data["signals"]}
    assert data["kind"] == "static" and data["drive"] == ["pan", "lift"]
    assert {name: s["pose"] for name, s in signals.items()} == {
        "pan": "Point",
        "lift": "Point",
        "tip": "Name",
    }
    assert {s.get("scale") for s in signals.values()} == {None, -1.0} and "by 1.00" in text
    assert "# unknown: noise_std" not in text


def test_four_columns_of_unit_length_are_a_quaternion(logs):
    """`q0` to `q3` of a tracker's target are no angles of joints."""
    t = np.arange(0.3, 7.5, 0.01)
    write_robot(logs, {"pan_deg": np.degrees(angles(t)["pan"]), "lift_deg": np.degrees(angles(t)["lift"])}, t)
    turned = Rotation.from_euler("zy", np.column_stack([angles(t)["pan"], angles(t)["lift"]])).as_quat()
    sheet = np.column_stack([t, turned[:, [3, 0, 1, 2]]])
    np.savetxt(logs / "target.csv", sheet, "%.6f", ",", header="time_s,q0,q1,q2,q3", comments="")
    data, text = guessed(logs, "robot.csv", "target.csv")
    told = {s["name"]: (s["quantity"], s["columns"]) for s in data["signals"]}
    assert told["tip_orientation"] == ("orientation", ["q1", "q2", "q3", "q0"])
    assert set(told) == {"pan", "lift", "tip_orientation"}
    assert "# unknown: columns: whether w is the first" in text


@pytest.mark.parametrize(
    ("names", "rotation"),
    [("A,B,C", "ZYX"), ("roll [deg],pitch [deg],yaw [deg]", "xyz"), ("rx [rad],ry [rad],rz [rad]", "vector")],
)
def test_three_angles_beside_a_point_are_an_orientation_that_waits_for_a_person(logs, names, rotation):
    """A controller may have computed them; without its comment marks the map reads them as they are."""
    t = np.arange(0.3, 7.5, 0.01)
    write_robot(logs, {"pan_deg": np.degrees(angles(t)["pan"]), "lift_deg": np.degrees(angles(t)["lift"])}, t)
    turned = Rotation.from_euler("zy", np.column_stack([angles(t)["pan"], angles(t)["lift"]]))
    shown = turned.as_rotvec() if rotation == "vector" else turned.as_euler(rotation, degrees=True)
    seen = 1000 * place(Arm.from_toml(logs / "arm.toml"), t)
    write_table(logs / "hand.csv", f"time_s,X [mm],Y [mm],Z [mm],{names}", t[:, None], seen, shown)
    data, text = guessed(logs, "robot.csv", "hand.csv")
    assert {s["name"] for s in data["signals"]} == {"pan", "lift", "tip"}
    assert "# unknown: quantity: whether it was measured" in text
    start = text.rindex("[[signals]]")
    proposed = tomllib.loads(text[start - 2 :].replace("\n# ", "\n").lstrip("# "))["signals"][0]
    assert (proposed["quantity"], proposed["rotation"]) == ("orientation", rotation)
    assert proposed["unit"] == ("rad" if rotation == "vector" else "deg")


def test_states_of_a_controller_do_not_part_its_joints(logs):
    t = np.arange(0, 8, 0.004)
    rows = zip(t, *(np.degrees(q) for q in angles(t).values()), strict=True)
    lines = [f"{s:.3f},{a:.5f},{b:.5f},{'RUN' if 1 < s < 7 else 'IDLE'}" for s, a, b in rows]
    (logs / "robot.csv").write_text("\n".join(["time_s,pan_deg,lift_deg,state", *lines]) + "\n")
    data, _ = guessed(logs, "robot.csv", "tracker.csv")
    assert data["drive"] == ["pan", "lift"] and not any("where" in s for s in data["signals"])


@pytest.mark.parametrize("rests", [False, True])
def test_rows_of_a_motion_that_numbers_count_are_no_poses(logs, rests):
    """Nor where a joint rests, whose noise follows in no order."""
    t = np.arange(0, 8, 0.02)
    motion = np.degrees(np.column_stack(list(angles(t).values())))
    motion[:, 1] = np.random.default_rng(1).normal(0.0, 1e-3, len(t)) if rests else motion[:, 1]
    write_table(logs / "motion.csv", "nr,pan [deg],lift [deg]", np.arange(len(t))[:, None], motion)
    assert "kind" not in guessed(logs, "motion.csv")[0]


@pytest.mark.parametrize("unit", ["%", "‰", "bar"])
def test_a_torque_in_a_unit_of_another_kind_waits_for_its_scale(logs, unit):
    t = np.arange(0, 8, 0.004)
    write_robot(logs, {"pan_deg": np.degrees(angles(t)["pan"]), f"Torque pan [{unit}]": 10 * np.sin(t)}, t)
    data, text = guessed(logs, "robot.csv", "tracker.csv")
    assert "pan_motor_torque" not in {s["name"] for s in data["signals"]}
    assert f"# # unknown: scale: N m per {unit}, in which the log is" in text


def test_names_of_joints_stand_in_columns_of_texts_with_the_same_number(logs):
    """`rostopic echo -p`: the order of joints is the driver's, and stamps are those of the header."""
    names = ["header.stamp", "header.frame_id", "name0", "name1", "position0", "position1"]
    head = "%time," + ",".join(f"field.{name}" for name in names)
    t = np.arange(0, 8, 0.004)
    stamp = 1_780_000_000_000_000_000 + np.round(1e9 * t).astype(np.int64)
    q = angles(t)
    rows = zip(stamp + 300_000, stamp, q["lift"], q["pan"], strict=True)
    lines = [f"{late},{ns},,lift,pan,{a:.7f},{b:.7f}" for late, ns, a, b in rows]
    (logs / "joint_states.csv").write_text("\n".join([head, *lines]) + "\n")
    data, _ = guessed(logs, "joint_states.csv", "tracker.csv")
    told = {s["name"]: (s["columns"], s["time"]) for s in data["signals"][:2]}
    assert told == {
        "lift": (["field.position0"], "field.header.stamp"),
        "pan": (["field.position1"], "field.header.stamp"),
    }


def test_stations_of_a_boom_are_poses_along_its_telescope(logs):
    """Angles rise from station to station; a total station tells east and height."""
    slides = MODEL.replace('name = "lift"\ntype = "revolute"', 'name = "lift"\ntype = "prismatic"')
    (logs / "slide.toml").write_text(slides)
    head = "Stand\tNeigung (°)\tTeleskop Auszug (mm)\tOst (m)\tHöhe (m)"
    rows = [(a, e) for a in range(0, 60, 10) for e in (0, 1, 2)]
    lines = [f"S{a}{e}\t{a},013\t{1e3 * e + 0.2:.1f}\t{7 + e},2\t{100 + a},1" for a, e in rows]
    (logs / "poses.txt").write_text("\n".join([head, *lines]).replace(".", ",") + "\n")
    data, _ = guessed(logs, "poses.txt", model="slide.toml")
    told = {s["name"]: (s["columns"], s["pose"], s["unit"]) for s in data["signals"]}
    assert data["kind"] == "static" and data["drive"] == ["pan", "lift"]
    assert told == {
        "pan": (["Neigung (°)"], "Stand", "°"),
        "lift": (["Teleskop Auszug (mm)"], "Stand", "mm"),
        "tip": (["Ost (m)", "Höhe (m)"], "Stand", "m"),
    }


@pytest.mark.parametrize("names", ["E,N,H", "Rechtswert [m],Hochwert [m],Höhe [m]"])
def test_a_total_station_sees_the_tip_of_a_crane(tmp_path, names):
    """East, north and height are x, y and z; the joints of the crane's loop follow its stroke."""
    path = Path(__file__).parents[2] / "examples" / "crane.toml"
    (tmp_path / "crane.toml").write_text(path.read_text())
    crane, t = Arm.from_toml(path), np.arange(0.0, 12.0, 0.1)
    stroke = 0.3 + 0.1 * np.sin(0.7 * t) * np.sin(0.31 * t)
    tip = np.array([flexarm.static(crane, {"piston": s}).position[0] for s in stroke])
    write_table(tmp_path / "plc.csv", "t_s,stroke_mm", t[:, None], 1e3 * stroke[:, None])
    write_table(tmp_path / "station.csv", f"t_s,{names}", 4.0 + t[20:, None], tip[20:] + 7.0)
    data, text = guessed(tmp_path, "plc.csv", "station.csv", model="crane.toml")
    tip = data["signals"][1]
    assert (tip["quantity"], tip["columns"]) == ("position", names.split(","))
    assert "speeds correlate with the model's by 1.00" in text
