"""Claims about records that import maps make of tables of text."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import flexarm
from flexarm import InvalidFile, Record

HINGE = """
format = "flexarm-map/1"
drive = "hinge"
[[signals]]
name = "hinge"
source = "log.csv"
time = "time"
columns = ["angle"]
quantity = "joint_angle"
joint = "hinge"
side = "output"
"""
TIP = """
[[signals]]
name = "tip"
source = "log.csv"
time = "time"
columns = ["x", "z"]
quantity = "position"
point = "tip"
axes = ["x", "z"]
unit = "mm"
"""
ROWS = "time,angle,x,z\n0.0,0.1,1000,2000\n0.01,0.2,,2001\n0.02,0.3,1002,2002\n"


def imported(folder, text, **files):
    """The record of a map beside files."""
    for name, content in files.items():
        path = folder / name.replace("_csv", ".csv").replace("_toml", ".toml")
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    (folder / "run.map.toml").write_text(text)
    return flexarm.import_record(folder / "run.map.toml")


def problems(folder, text, **files):
    """What is wrong, one line a problem."""
    with pytest.raises(InvalidFile) as caught:
        imported(folder, text, **files)
    return caught.value.lines()


def test_signals_of_one_table_come_in_si_and_read_back_equal(tmp_path):
    record = imported(tmp_path, HINGE + TIP, log_csv=ROWS)
    assert record.signals["hinge"].values[:, 0].tolist() == [0.1, 0.2, 0.3]
    assert record.signals["hinge"].time.tolist() == [0.0, 0.01, 0.02]
    np.testing.assert_allclose(record.signals["tip"].values, [[1, 2], [np.nan, 2.001], [1.002, 2.002]])
    record.save(tmp_path / "record")
    again = Record.load(tmp_path / "record")
    for name, signal in record.signals.items():
        np.testing.assert_array_equal(again.signals[name].values, signal.values)
        np.testing.assert_array_equal(again.signals[name].time, signal.time)


@pytest.mark.parametrize(
    "text",
    [
        "time;angle;x;z\r\n0,0;0,1;1000;2000\r\n0,01;0,2;;2001\r\n0,02;0,3;1002;2002\r\n",
        "# made by a logger\n\ntime\tangle\tx\tz\n0.0\t0.1\t1e3\t2000\n0.01\t0.2\tnan\t2001\n# a pause\n"
        "0.02\t0.3\t1002\t2002\n",
        '"time","angle","x","z"\n"0.0","0.1","1000","2000"\n"0.01","0.2","","2001"\n"0.02","0.3","1002","2002"\n',
        "Robot 7\nserial;4711\ntime,angle,x,z\ns,rad,mm,mm\n0.0,0.1,1000,2000\n0.01,0.2,,2001\n"
        "0.02,0.3,1002,2002\n",
        "time  angle    x    z\n 0.0   0.1   1000  2000\n 0.01   0.2    nan  2001 \n 0.02\t0.3 1002 2002\n",
        "%time,angle,x,z\n0.0,0.1,1000,2000\n0.01,0.2,NaN,2001\n0.02,0.3,1002,2002",
        "# time, angle, x, z\n0.0, 0.1, 1000, 2000\n0.01, 0.2, , 2001\n0.02, 0.3, 1002, 2002\n",
    ],
    ids=["semicolons", "tabs", "quoted", "preamble and units", "blanks", "percent", "numpy"],
)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-8-sig", "cp1252"])
def test_dialects_are_seen_from_the_file(tmp_path, text, encoding):
    record = imported(tmp_path, HINGE + TIP, log_csv=text.encode(encoding))
    assert record.signals["hinge"].values[:, 0].tolist() == [0.1, 0.2, 0.3]
    assert record.signals["hinge"].time.tolist() == [0.0, 0.01, 0.02]
    np.testing.assert_allclose(record.signals["tip"].values, [[1, 2], [np.nan, 2.001], [1.002, 2.002]])


def test_a_dialect_that_cannot_be_seen_is_stated(tmp_path):
    said = '[signals.csv]\nseparator = ";"\ndecimal = ","\nheader_rows = 0\ncolumns = ["time", "angle"]\n'
    record = imported(tmp_path, HINGE + said, log_csv="1,5;2\n2,5;3\n")
    assert record.signals["hinge"].time.tolist() == [1.5, 2.5]
    assert record.signals["hinge"].values[:, 0].tolist() == [2, 3]


def test_a_laser_tracker_file_has_no_header_and_names_points(tmp_path):
    text = (
        "// SpatialAnalyzer, frame: A::WORLD, mm\n"
        "Tool 1000.10 20.5 -3.25 10:00:00.100\nTool 1000.20 20.6 -3.20 10:00:00.200\n"
        "Wall 1.0 2.0 3.0 10:00:00.250\nTool 1000.30 20.7 -3.15 10:00:00.300\n"
    )
    tracker = """
format = "flexarm-map/1"
[frames]
tracker = "unknown"
[[signals]]
name = "tip"
source = "tracker.txt"
time = 5
time_format = "%H:%M:%S.%f"
columns = [2, 3, 4]
where = { point = "Tool" }
quantity = "position"
point = "tip"
frame = "tracker"
unit = "mm"
csv = { columns = ["point", "x", "y", "z", "time"] }
"""
    (tmp_path / "tracker.txt").write_text(text)
    tip = imported(tmp_path, tracker).signals["tip"]
    np.testing.assert_allclose(tip.time - 36000, [0.1, 0.2, 0.3], atol=1e-9)
    np.testing.assert_allclose(tip.values[:, 0], [1.0001, 1.0002, 1.0003])


MODEL = """
format = "flexarm-arm/1"
[[joints]]
name = "hinge"
type = "revolute"
parent = "base"
child = "rod"
axis = [0, 1, 0]
gear_ratio = 50
[[links]]
name = "rod"
type = "rigid"
mass = 1
com = [0, 0, 0]
inertia = [1, 1, 1]
[[points]]
name = "tip"
link = "rod"
position = [0, 0, 1]
"""


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ('unit = "deg"', np.radians(90)),
        ("unit = { counts_per_turn = 360 }", np.radians(90)),
        ('unit = "deg"\nbefore_gear = true', np.radians(90 / 50)),
        ('unit = "deg"\nscale = -2.0\noffset = 10', np.radians(-170)),
        ('unit = "deg"\nbefore_gear = true\nscale = -1.0\noffset = 2', np.radians(0.2)),
    ],
)
def test_angles_by_unit_gear_scale_and_offset(tmp_path, keys, expected):
    text = HINGE.replace('drive = "hinge"', 'drive = "hinge"\nmodel = "arm.toml"') + keys
    record = imported(tmp_path, text, log_csv="time,angle\n0,0\n1,90\n", arm_toml=MODEL)
    assert record.signals["hinge"].values[1, 0] == pytest.approx(expected)


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ("", 90.0),
        ('unit = "mm"', 0.09),
        ('unit = "deg"\nbefore_gear = true', np.radians(90) / 50),
        ("unit = { counts_per_turn = 360 }\nbefore_gear = true", np.radians(90) / 50),
    ],
)
def test_a_joint_that_slides_is_read_in_metres(tmp_path, keys, expected):
    """Its gear ratio is in rad/m, so that angles of its motor become metres too."""
    text = HINGE.replace('drive = "hinge"', 'drive = "hinge"\nmodel = "arm.toml"') + keys
    slide = MODEL.replace("revolute", "prismatic")
    hinge = imported(tmp_path, text, log_csv="time,angle\n0,0\n1,90\n", arm_toml=slide).signals["hinge"]
    assert (hinge.unit, hinge.values[1, 0]) == ("m", pytest.approx(expected))


def test_a_current_is_a_torque_by_its_constant_and_the_gear(tmp_path):
    text = HINGE.replace('drive = "hinge"', 'model = "arm.toml"').replace("joint_angle", "motor_torque")
    text = text.replace('side = "output"\n', "unit = { torque_constant = 0.12 }\nbefore_gear = true\n")
    signal = imported(tmp_path, text, log_csv="time,angle\n0,0\n1,2\n", arm_toml=MODEL).signals["hinge"]
    assert signal.values[1, 0] == pytest.approx(2 * 0.12 * 50)
    assert (signal.side, signal.unit) == ("output", "N m")
    said = problems(tmp_path, text + 'side = "motor"\n')
    assert "before_gear" in said[0]
    assert 'side = "output"' in said[0]


def orientation_map(columns, more):
    """A map of one orientation with columns of these names."""
    names = ", ".join(f'"{name}"' for name in columns)
    return f"""
format = "flexarm-map/1"
[[signals]]
name = "tip"
source = "log.csv"
time = {{ rate_hz = 250 }}
columns = [{names}]
quantity = "orientation"
point = "tip"
{more}
"""


@pytest.mark.parametrize(("order", "columns"), [("xyzw", "qx,qy,qz,qw"), ("wxyz", "qw,qx,qy,qz")])
def test_quaternions_come_in_either_order(tmp_path, order, columns):
    text = orientation_map(columns.split(","), f'quaternion = "{order}"')
    signal = imported(tmp_path, text, log_csv="qw,qx,qy,qz\n1,0,0,0\n0.8,0.6,0,0\n").signals["tip"]
    assert signal.values.tolist() == [[0, 0, 0, 1], [0.6, 0, 0, 0.8]]
    assert signal.time.tolist() == [0, 0.004]


@pytest.mark.parametrize(
    ("form", "head", "row", "unit"),
    [
        ("ZYX", "A,B,C", "30,-20,10", 'unit = "deg"'),
        ("xyz", "roll_rad,pitch_rad,yaw_rad", "0.17453293,-0.34906585,0.52359878", ""),
        ("vector", "rx,ry,rz", "{}", ""),
        ("matrix", "a,b,c,d,e,f,g,h,i", "{}", ""),
    ],
)
def test_rotations_come_as_angles_vectors_and_matrices(tmp_path, form, head, row, unit):
    """The same turn in each form; a row of zeros in a matrix, or an empty one, is none."""
    true = Rotation.from_euler("ZYX", [30, -20, 10], degrees=True)
    numbers = {"vector": true.as_rotvec(), "matrix": true.as_matrix().ravel()}.get(form, ())
    row = row.format(",".join(f"{each:.10f}" for each in numbers))
    columns = head.split(",")
    none = ",".join(["0" if form == "matrix" else "nan"] * len(columns))
    text = orientation_map(columns, f'rotation = "{form}"\n{unit}')
    signal = imported(tmp_path, text, log_csv=f"{head}\n{row}\n{none}\n").signals["tip"]
    np.testing.assert_allclose(signal.values[0], true.as_quat(), atol=1e-8)
    assert np.isnan(signal.values[1]).all()


@pytest.mark.parametrize("order", ["zy", "xxy", "xYz"])
def test_an_order_of_angles_that_is_none_is_an_error(tmp_path, order):
    """Two turns about one axis are a single one."""
    [said] = problems(tmp_path, orientation_map("abc", f'rotation = "{order}"'))
    assert 'an order of angles such as "xyz" or "ZYX"' in said


def test_the_order_of_a_quaternion_belongs_to_no_angles(tmp_path):
    text = orientation_map("abc", 'rotation = "xyz"\nquaternion = "wxyz"')
    [said] = problems(tmp_path, text)
    assert "quaternion" in said and "rotation" in said


def test_a_mounted_sensor_turns_into_the_axes_of_its_signal(tmp_path):
    text = """
format = "flexarm-map/1"
[[signals]]
name = "imu"
source = "log.csv"
time = 1
columns = [2, 3, 4]
quantity = "acceleration"
point = "tip"
axes = ["x", "z"]
unit = "g"
mount = [0, 1.5707963267948966, 0]
"""
    signal = imported(tmp_path, text, log_csv="t,a,b,c\n0,1,2,3\n1,0,0,1\n").signals["imu"]
    np.testing.assert_allclose(signal.values / 9.80665, [[3, -1], [1, 0]], atol=1e-12)


def test_nanoseconds_since_1970_keep_every_digit(tmp_path):
    start = 1_700_000_000_123_456_789
    rows = "time,angle\n" + "".join(f"{start + 1_000_001 * k},{k}\n" for k in range(5))
    record = imported(tmp_path, HINGE + 'time_unit = "ns"\n', log_csv=rows)
    expected = 0.123456789 + 1.000001e-3 * np.arange(5)
    np.testing.assert_allclose(record.signals["hinge"].time, expected, rtol=0, atol=1e-12)
    assert record.duration == pytest.approx(4.000004e-3)
    assert "2023-11-14 22:13:20 UTC" in str(record.notes[0])


def test_nanoseconds_since_1970_in_a_text_keep_every_digit(tmp_path):
    """They have 19 digits."""
    stamps = 1_780_000_000_123_456_789 + 10_000_001 * np.arange(3)
    rows = "time,angle\n" + "".join(f"{stamp},0.1\n" for stamp in stamps)
    text = HINGE.replace('time = "time"', 'time = "time"\ntime_unit = "ns"')
    record = imported(tmp_path, text, log_csv=rows)
    exact = 1e-9 * (stamps - 1_780_000_000_000_000_000)
    np.testing.assert_allclose(record.signals["hinge"].time, exact, rtol=0, atol=1e-12)


@pytest.mark.parametrize("rows", ["time,angle\nms,deg\n", "time [ms],angle\n", "time (msec),angle [deg]\n"])
def test_the_unit_that_a_table_gives_its_stamps_counts(rows, tmp_path):
    (time, angle) = rows.splitlines()[0].split(",")
    text = HINGE.replace('time = "time"', f'time = "{time}"').replace('["angle"]', f'["{angle}"]')
    rows += "".join(f"{10 * k}.5,0.1\n" for k in range(30))
    hinge = imported(tmp_path, text, log_csv=rows).signals["hinge"]
    np.testing.assert_allclose(hinge.time, 0.01 * np.arange(30) + 0.0005)


def test_a_row_without_a_pose_is_an_error(tmp_path):
    text = HINGE.replace('time = "time"', 'pose = "pose"').replace('drive = "hinge"', 'kind = "static"')
    (line,) = problems(tmp_path, text, log_csv="pose,angle\nA,0.1\n,0.2\nB,0.3\n")
    assert "line 3: a row needs a pose, got none" in line


def test_clocks_that_are_known_share_an_origin_and_unknown_ones_need_not(tmp_path):
    clocks = '[clocks]\nrobot = 0.0\ntracker = "unknown"\n[[signals]]'
    text = (HINGE + TIP.replace("log.csv", "tracker.csv") + 'clock = "tracker"\n').replace(
        "[[signals]]", clocks, 1
    )
    robot = "time,angle\n1700000000.5,0\n1700000001.5,1\n"
    late = imported(tmp_path, text, log_csv=robot, tracker_csv="time,x,z\n1700000002.0,1,2\n1700000003,1,2\n")
    assert late.signals["hinge"].time.tolist() == [0.5, 1.5]
    assert late.signals["tip"].time.tolist() == [2.0, 3.0]
    own = imported(tmp_path, text, log_csv=robot, tracker_csv="time,x,z\n7.25,1,2\n8.25,1,2\n")
    assert own.signals["tip"].time.tolist() == [7.25, 8.25]


def test_a_clock_counts_from_1970_in_all_its_signals_or_in_none(tmp_path):
    robot, tracker = "time,angle\n1700000000.5,0\n1700000001.5,1\n", "time,x,z\n0.5,1,2\n1.5,1,2\n"
    text = HINGE + TIP.replace("log.csv", "tracker.csv")
    [said] = problems(tmp_path, text, log_csv=robot, tracker_csv=tracker)
    assert "signals.tip.clock" in said
    assert "begins at 0.5 s here and at 1700000000 s in signals before" in said


def test_rows_of_poses_are_chosen_by_a_column(tmp_path):
    text = """
format = "flexarm-map/1"
kind = "static"
[[signals]]
name = "pull"
source = "static.csv"
where = { "length (mm)" = 300 }
pose = "force"
columns = ["force"]
quantity = "force"
point = "tip"
axes = ["z"]
scale = -1.0
[[signals]]
name = "tip"
source = "static.csv"
where = { "length (mm)" = 300 }
columns = ["height"]
quantity = "position"
point = "tip"
axes = ["z"]
unit = "mm"
"""
    rows = "length (mm),force,height\n200,0,10\n300,0,11\n300,5,12\n"
    record = imported(tmp_path, text, static_csv=rows)
    assert record.signals["pull"].values[:, 0].tolist() == [0, -5]
    assert record.signals["pull"].pose.tolist() == ["0", "5"]
    assert record.signals["tip"].values[:, 0].tolist() == [0.011, 0.012]
    assert record.signals["tip"].pose.tolist() == ["1", "2"]


def test_all_that_is_wrong_is_told_at_once(tmp_path):
    text = HINGE.replace('"angle"', '"angel"').replace('drive = "hinge"', 'model = "arm.toml"')
    text = text.replace('joint = "hinge"', 'joint = "elbow"') + TIP
    said = problems(tmp_path, text, log_csv=ROWS.replace("1002", "high"), arm_toml=MODEL)
    assert len(said) == 3
    assert "signals.hinge.joint" in said[0] and "'elbow'" in said[0]
    assert "signals.hinge.columns (line 8)" in said[1] and "did you mean 'angle'" in said[1]
    assert "log.csv: line 4, column 'x': must be a number, got 'high'" in said[2]


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("rad", "rad"), None),
        (("[[signals]]", "[[signals]]\nbefore = 1"), "unknown key"),
        (('["angle"]', '["angle", "x"]'), "must be 1 for joint_angle, got 2"),
        (('["angle"]', "[0]"), "counted from 1, got 0"),
        (('["angle"]', "[9]"), "there is no column 9; there are 4"),
        (('time = "time"', ""), "is missing; needed is a column of stamps"),
        (('time = "time"', 'time = "log"'), "has no time of its own"),
        (('time = "time"', "time = { rate_hz = -1 }"), "must be positive, got -1 Hz"),
        (('time = "time"', 'time = "time"\ntime_unit = "h"'), "allowed are s, ms, us, ns"),
        (('"log.csv"', '"other.csv"'), "there is no such file"),
        (('side = "output"', 'unit = "kg"'), "unit 'kg' does not fit"),
        (('side = "output"', "unit = { torque_constant = 1 }"), "needed is quantity"),
        (('side = "output"', "before_gear = true"), "needs its gear ratio"),
        (('drive = "hinge"', 'drive = "wrist"'), "there is no signal 'wrist'"),
        (('side = "output"', 'topic = "/joints"'), "has no topics"),
        (('side = "output"', 'clock = "robot"'), "there is no clock 'robot'"),
        (('side = "output"', "where = { x = 7 }"), "there is no row"),
        (('side = "output"', "scale = [1, 2]"), "must be one number"),
        (('side = "output"', 'csv = { encoding = "klingon" }'), "klingon"),
        (('side = "output"', 'csv = { columns = ["a"] }'), "must name the 4 columns"),
    ],
)
def test_a_wrong_key_is_named_with_its_place(tmp_path, change, told):
    text = HINGE.replace(*change)
    if told is None:
        assert imported(tmp_path, text, log_csv=ROWS).drive == ("hinge",)
    else:
        assert any(told in line for line in problems(tmp_path, text, log_csv=ROWS))


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ("time,angle\n0,1\n0,2\n", "line 3: 0.0 repeats 0.0 of line 2"),
        ("time,angle\n0,1\n\n-1,2\n", "line 4: -1.0 goes back behind 0.0 of line 2"),
        ("time,angle\n0,1\n,2\n", "line 3: a row needs a time"),
        ("time,angle\n0,1\n1,2\n2\n", "line 4: has 1 cells, other rows have 2"),
        ("time,angle\n", "no cell is a number"),
        ("", "holds no rows"),
        ("time,angle\n0,1\nlate,2\n3,3\n", "line 3, column 'time': must be a number, got 'late'"),
        (b"time,angle\n0,1\n1,\xff\xfe2\n2,3", "line 3, column 'angle': must be a number"),
    ],
)
def test_a_damaged_table_is_told_with_its_line(tmp_path, rows, told):
    said = problems(tmp_path, HINGE, log_csv=rows)
    assert told.replace(".0", "") in said[0].replace(".0", "")


def test_a_joint_that_two_motors_move_is_their_sum(tmp_path):
    text = HINGE.replace('["angle"]', '["angle", "x"]') + "sum = true\nscale = [-1.0, 0.5]\n"
    signal = imported(tmp_path, text, log_csv="time,angle,x\n0,1,2\n1,3,8\n").signals["hinge"]
    assert signal.values[:, 0].tolist() == [0, 1]


def test_the_command_writes_a_record_or_nothing(tmp_path, capsys, monkeypatch):
    from flexarm.cli.run import run

    imported(tmp_path, HINGE, log_csv=ROWS)
    monkeypatch.chdir(tmp_path)
    assert run(["import", "run.map.toml"]) == 0
    assert "written to run: a record" in capsys.readouterr().out
    assert Record.load(tmp_path / "run").signals["hinge"].time.tolist() == [0.0, 0.01, 0.02]
    assert run(["import", "run.map.toml"]) == 2
    assert "holds files already" in capsys.readouterr().err
    (tmp_path / "log.csv").write_text(ROWS.replace("0.02", "late"))
    assert run(["import", "run.map.toml", "--out", "other"]) == 2
    assert "line 4, column 'time': must be a number, got 'late'" in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["log.csv", "run", "run.map.toml"]


def test_the_record_is_never_written_over_what_it_was_read_from(tmp_path, capsys):
    from flexarm.cli.run import run

    imported(tmp_path, HINGE, log_csv=ROWS)
    assert run(["import", str(tmp_path / "run.map.toml"), "--out", str(tmp_path), "--force"]) == 2
    assert "which is read" in capsys.readouterr().err
    assert (tmp_path / "log.csv").read_text() == ROWS


@pytest.mark.parametrize(
    "command",
    [
        ["check", "LOG"],
        ["static", "LOG"],
        ["compare", "arm.toml", "LOG"],
        ["diagnose", "arm.toml", "LOG", "--out", "x"],
        ["simulate", "arm.toml", "--drive", "LOG", "--out", "x"],
        ["plan", "arm.toml", "--drive", "LOG"],
    ],
    ids=lambda command: command[0],
)
@pytest.mark.parametrize("kind", ["file", "directory"])
def test_every_command_names_a_bag_and_what_reads_it(command, kind, tmp_path, capsys):
    from flexarm.cli.run import run

    (tmp_path / "arm.toml").write_text(MODEL)
    if kind == "file":
        (tmp_path / "log.mcap").write_bytes(b"\x89MCAP0\r\n" + bytes(100))
    else:
        (tmp_path / "log.mcap").mkdir()
        (tmp_path / "log.mcap" / "metadata.yaml").write_text("rosbag2_bagfile_information:\n")
    words = [word.replace("LOG", str(tmp_path / "log.mcap")) for word in command]
    words = [str(tmp_path / word) if word in ("arm.toml", "x") else word for word in words]
    assert run(words) == 2
    said = capsys.readouterr().err
    assert "flexarm import" in said
    assert "bag" in said


def test_a_table_in_place_of_a_model_is_named(tmp_path, capsys):
    from flexarm.cli.run import run

    (tmp_path / "log.csv").write_text(ROWS)
    assert run(["check", str(tmp_path / "log.csv")]) == 2
    advice = "`flexarm import --guess` proposes a map"
    assert f"is a table of numbers, such as CSV; {advice}" in capsys.readouterr().err


def test_a_plain_text_in_place_of_a_model_is_named(tmp_path, capsys):
    from flexarm.cli.run import run

    (tmp_path / "notes.txt").write_text("Notes on the arm\n\nJoint two clicks when it is cold.\n")
    assert run(["check", str(tmp_path / "notes.txt")]) == 2
    said = capsys.readouterr().err
    assert "notes.txt: file: is a plain text" in said
    assert "allowed is 'flexarm-arm/1'" in said


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            '<?xml version="1.0"?>\n<!-- lab -->\n<mujoco model="arm">\n<worldbody/>\n</mujoco>',
            "MJCF.*flexarm export",
        ),
        ('<robot name="arm">\n</robot>\n', "URDF; its name must end in .urdf"),
        ("<sdf version='1.9'>\n</sdf>\n", "SDF; allowed are TOML and URDF"),
        ("<html>\n<p>\n</html>\n", "XML, <html>, which flexarm does not read"),
    ],
)
def test_a_robot_file_in_place_of_a_model_is_named(text, told, tmp_path, capsys):
    from flexarm.cli.run import run

    (tmp_path / "arm.xml").write_text(text)
    assert run(["modes", str(tmp_path / "arm.xml")]) == 2
    assert re.search(f"arm.xml: file: is .*{told}", capsys.readouterr().err)


def test_a_model_with_a_typing_error_keeps_the_place_of_the_error(tmp_path, capsys):
    from flexarm.cli.run import run

    (tmp_path / "arm.toml").write_text('format = "flexarm-arm/1"\nname "arm"\n')
    assert run(["check", str(tmp_path / "arm.toml")]) == 2
    assert "line 2, column 6: not valid TOML" in capsys.readouterr().err


TRACKER = """
format = "flexarm-map/1"
[[signals]]
name = "tip"
source = "log.csv"
quantity = "position"
point = "tip"
unit = "mm"
time_format = "%m/%d/%Y %H:%M:%S.%f"
"""
STREAM = [
    ("Tool", "p1", "1000.5000 2000.0000 3000.0000", "09/14/2026 23:59:59.950"),
    ("Wall", "p1", "4000.0000 5000.0000 6000.0000", "09/14/2026 23:59:59.975"),
    ("Tool", "p2", "1001.5000 2000.0000 3000.0000", "09/15/2026 00:00:00.000"),
]


@pytest.mark.parametrize(
    ("row", "keys"),
    [
        ("A {0} {1} {2} {3}", 'columns = [4, 5, 6]\ntime = [7, 8]\nwhere = { 2 = "Tool" }'),
        ("A,{0},{1},{commas},{3}", 'columns = [4, 5, 6]\ntime = 7\nwhere = { 2 = "T?ol" }'),
        ("A::{0}::{1}, {commas}, {3}", 'columns = [2, 3, 4]\ntime = 5\nwhere = { 1 = "A::Tool::*" }'),
    ],
    ids=["blanks", "commas", "one name"],
)
def test_exports_of_laser_trackers_are_read(tmp_path, row, keys):
    """Groups of targets, date and time of day, remarks above and between the rows."""
    rows = [row.format(*each, commas=each[2].replace(" ", ", ")) for each in STREAM]
    rows[1:1] = ["// Working Frame: A::Tracker"]
    text = "// SA 2024.1\n// Units: Millimeters, as a long remark\n\n" + "\n".join(rows) + "\n"
    tip = imported(tmp_path, TRACKER + keys, log_csv=text).signals["tip"]
    np.testing.assert_allclose(tip.values, [[1.0005, 2, 3], [1.0015, 2, 3]])
    assert np.diff(tip.time) == pytest.approx(0.05, abs=1e-6)  # over midnight


def test_where_without_a_row_tells_what_stands_there(tmp_path):
    keys = TIP.replace('point = "tip"', 'point = "tip"\nwhere = { target = "tool" }')
    rows = "time,angle,x,z,target\n" + "".join(f"{k},0,1,2,Ball{k % 7}\n" for k in range(9))
    (told,) = problems(tmp_path, HINGE + keys, log_csv=rows)
    assert "there is no row with {'target': 'tool'}" in told
    assert "column 'target' holds 'Ball0', 'Ball1', 'Ball2', 'Ball3', 'Ball4' and 2 more" in told


def test_stamps_of_several_columns_need_their_form(tmp_path):
    (told,) = problems(tmp_path, HINGE.replace('"time"', '["x", "time"]'), log_csv=ROWS)
    assert "signals.hinge.time" in told and "time_format says how they read" in told


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ('"angle"', '"q_deg"', "signals.hinge: column 'q_deg' ends in 'deg', but its unit is 'rad'"),
        (
            '"time"',
            '"t_ms"\ntime_unit = "s"',
            "signals.hinge: column 't_ms' ends in 'ms', but its unit is 's'",
        ),
        ('"angle"]', '"q_deg"]\nunit = "deg"', None),
        ('"angle"]', '"q_deg"]\nscale = 0.0174533', None),
        ('"time"', '"t_ms"\ntime_unit = "ms"', None),
    ],
    ids=["degrees", "milliseconds", "stated", "scaled", "stated stamps"],
)
def test_a_column_named_after_another_unit_is_told(tmp_path, before, after, said):
    rows = ROWS.replace("angle", "q_deg") if "q_deg" in after else ROWS.replace("time", "t_ms")
    notes = imported(tmp_path, HINGE.replace(before, after), log_csv=rows).notes
    assert [str(note) for note in notes] == ([] if said is None else [said])


@pytest.mark.parametrize(
    ("column", "factor"),
    [("t_ms", 1e-3), ("stamp_ns", 1e-9), ("timeUs", 1e-6), ("time_msec", 1e-3), ("t_min", 60), ("t_h", 1)],
)
def test_stamps_have_the_unit_in_which_the_name_of_their_column_ends(column, factor, tmp_path):
    rows = "STAMP,angle\n0,0.1\n1000,0.2\n".replace("STAMP", column)
    for time in (f'"{column}"', "1"):
        record = imported(tmp_path, HINGE.replace('"time"', time), log_csv=rows)
        assert record.signals["hinge"].time == pytest.approx([0, 1000 * factor]) and not record.notes


def test_a_pressure_is_told_how_it_becomes_a_force(tmp_path):
    force = (
        HINGE.replace('"joint_angle"', '"motor_torque"').replace('drive = "hinge"\n', "") + 'unit = "bar"\n'
    )
    told = "\n".join(problems(tmp_path, force, log_csv=ROWS))
    assert "unit 'bar' is of a pressure; `sum` with areas as `scale` gives the force of a cylinder" in told
