"""Claims about logs of every format: written by the formats' own libraries, read back by a map."""

import signal
import sys
import tracemalloc

import h5py
import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from asammdf import MDF
from asammdf import Signal as MdfSignal
from log_files import ANGLE, FORMATS, JOINTS, POSE, TIME, TIP, N, map_of, ros_1
from nptdms import ChannelObject, TdmsWriter
from pyarrow import parquet as pq
from scipy.io import netcdf_file, savemat

import flexarm
from flexarm import InvalidFile
from flexarm.importing.formats import opened
from flexarm.importing.map_file import Dialect
from flexarm.importing.trial import _fatal


@pytest.mark.parametrize("name", FORMATS)
def test_a_log_of_every_format_comes_in(name, tmp_path):
    write, joint, tip = FORMATS[name]
    write(tmp_path / name)
    (tmp_path / "run.toml").write_text(map_of(name, joint, tip))
    record = flexarm.import_record(tmp_path / "run.toml")
    shoulder, seen = record.signals["shoulder"], record.signals["tip"]
    late = 0.002 if name == "log.mcap" else 0.0
    rtol = 1e-6 if name == "log.c3d" else 1e-12  # C3D holds single precision
    np.testing.assert_allclose(shoulder.values[:, 0], np.radians(ANGLE), rtol=rtol, atol=1e-12)
    np.testing.assert_allclose(seen.values, TIP / 1000, rtol=rtol, atol=1e-12)
    np.testing.assert_allclose(shoulder.time, TIME, rtol=0, atol=1e-9)
    np.testing.assert_allclose(seen.time, TIME + late, rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "before", "length"),
    [
        ("log.mcap", b"\x89MCAP0\r\n\x01", (1 << 50).to_bytes(8, "little")),
        ("log3.nc", b"\0\0\0\x01t\0\0\0", (1 << 28).to_bytes(4, "big")),  # the size of dimension t
        ("log.tdms", b"wf_increment", (1 << 30).to_bytes(4, "little")),
    ],
)
def test_lengths_in_a_damaged_log_ask_for_no_memory(name, before, length, tmp_path):
    write, joint, tip = FORMATS[name]
    write(tmp_path / name)
    (tmp_path / "run.toml").write_text(map_of(name, joint, tip))
    content = (tmp_path / name).read_bytes()
    at = content.index(before) + (-4 if name == "log.tdms" else len(before))  # TDMS: before its text
    (tmp_path / name).write_bytes(content[:at] + length + content[at + len(length) :])
    tracemalloc.start()
    with pytest.raises(InvalidFile) as caught:
        flexarm.import_record(tmp_path / "run.toml")
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert "Memory" not in str(caught.value)
    assert most < 1e8


@pytest.mark.parametrize("name", FORMATS)
def test_columns_that_are_not_there_are_named_with_those_that_are(name, tmp_path):
    write, joint, tip = FORMATS[name]
    write(tmp_path / name)
    lines = joint.splitlines()
    lines[0] = 'columns = ["nonsense"]'
    (tmp_path / "run.toml").write_text(map_of(name, "\n".join(lines), tip))
    with pytest.raises(InvalidFile) as caught:
        flexarm.import_record(tmp_path / "run.toml")
    (line,) = caught.value.lines()
    assert "signals.shoulder.columns" in line
    assert "'nonsense'" in line
    assert "there are" in line


left_open = pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
"""Some libraries leave a damaged file open until it is cleared away."""


@left_open
@pytest.mark.parametrize("name", [name for name in FORMATS if not name.startswith("ros2")])
@pytest.mark.parametrize("share", [0.02, 0.5, 0.97])
def test_a_file_cut_short_is_an_error_or_a_shorter_record(name, share, tmp_path):
    """Never another exception: some formats can be read as far as they go."""
    write, joint, tip = FORMATS[name]
    write(tmp_path / name)
    whole = (tmp_path / name).read_bytes()
    (tmp_path / name).write_bytes(whole[: int(share * len(whole))])
    (tmp_path / "run.toml").write_text(map_of(name, joint, tip))
    try:
        record = flexarm.import_record(tmp_path / "run.toml")
    except InvalidFile as error:
        assert name in str(error)
    else:
        assert len(record.signals["shoulder"]) <= N


@left_open
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("name", [name for name in FORMATS if not name.startswith("ros2")])
def test_a_damaged_file_is_an_error_or_a_record(name, seed, tmp_path):
    write, joint, tip = FORMATS[name]
    write(tmp_path / name)
    rng = np.random.default_rng(seed)
    raw = np.frombuffer((tmp_path / name).read_bytes(), dtype=np.uint8).copy()
    raw[rng.integers(len(raw), size=8)] = rng.integers(256, size=8)
    (tmp_path / name).write_bytes(raw.tobytes())
    (tmp_path / "run.toml").write_text(map_of(name, joint, tip))
    try:
        flexarm.import_record(tmp_path / "run.toml")
    except InvalidFile as error:
        assert name in str(error)


BINARY = [name for name in FORMATS if not name.endswith((".csv", ".nc"))]


@pytest.mark.parametrize("name", BINARY)
def test_other_commands_say_what_a_log_is(name, tmp_path, capsys):
    from flexarm.cli.run import run

    FORMATS[name][0](tmp_path / name)
    assert run(["check", str(tmp_path / name)]) == 2
    said = capsys.readouterr().err
    assert "flexarm import" in said
    kinds = ("bag", "MCAP", "MATLAB", "HDF5", "Parquet", "Feather", "Excel", "TDMS", "MDF", "C3D")
    assert any(kind in said for kind in kinds)


@pytest.mark.parametrize(
    ("name", "package"),
    [("log.bag", "rosbags"), ("log.parquet", "pyarrow"), ("log.xlsx", "python_calamine"),
     ("log.tdms", "nptdms"), ("log.mf4", "asammdf"), ("log.c3d", "ezc3d")],
)  # fmt: skip
def test_a_missing_package_is_told_with_the_command_that_installs_it(name, package, tmp_path, monkeypatch):
    write, joint, tip = FORMATS[name]
    write(tmp_path / name)
    for module in [each for each in sys.modules if each.partition(".")[0] == package]:
        monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, package, None)
    (tmp_path / "run.toml").write_text(map_of(name, joint, tip))
    with pytest.raises(InvalidFile, match=r"pip install 'flexarm\[import\]'"):
        flexarm.import_record(tmp_path / "run.toml")


def test_missing_topics_stamps_and_numbers_of_a_bag_are_told(tmp_path):
    ros_1(tmp_path / "log.bag")
    wrong = {
        JOINTS.replace("/joint_states", "/joints"): "there is no topic '/joints'; there are /joint_states",
        JOINTS.replace("header.stamp", "stamp"): '"log" is the time at which',
        JOINTS.replace('"position[shoulder]"', "1"): "fields of messages have names",
        JOINTS.replace("position", "name"): "name[shoulder]: must be a number, got 'shoulder'",
        JOINTS.replace('topic = "/joint_states"', ""): "topic (line",
    }
    for joint, told in wrong.items():
        (tmp_path / "run.toml").write_text(map_of("log.bag", joint, POSE))
        with pytest.raises(InvalidFile) as caught:
            flexarm.import_record(tmp_path / "run.toml")
        assert told in str(caught.value) or "topic: log.bag: is missing" in str(caught.value)


TRACKERS = {
    "blanks, remarks, date and time": (
        "// SA 2024.1, Working Frame: A::Tracker\n// Units: mm\n",
        "A Tip p{k} {x:.4f} 0.0000 {z:.4f} 09/14/2026 14:00:{s:06.3f}",
        'columns = [4, 5, 6]\ntime = [7, 8]\ntime_format = "%m/%d/%Y %H:%M:%S.%f"',
    ),
    "commas, names in a remark, half days": (
        "// Exported from SpatialAnalyzer\n// Collection, Group, Target, X, Y, Z, Timestamp\n",
        "A, Tip, p{k}, {x:.4f}, 0.0000, {z:.4f}, 09/14/2026 02:00:{s:06.3f} PM",
        'columns = ["X", "Y", "Z"]\ntime = 7\ntime_format = "%m/%d/%Y %I:%M:%S.%f %p"',
    ),
    "tabs, a line of units": (
        "Collection\tGroup\tTarget\tX\tY\tZ\tTime\n\t\t\tmm\tmm\tmm\ts\n",
        "A\tTip\tp{k}\t{x:.4f}\t0.0000\t{z:.4f}\t{s:.3f}",
        'columns = ["X", "Y", "Z"]\ntime = "Time"',
    ),
    "whole names of targets": (
        "// Working Frame: A::World\n",
        "A::Tip::p{k} {x:.4f} 0.0000 {z:.4f} {s:.3f}",
        'columns = [2, 3, 4]\ntime = 5\nwhere = { 1 = "A::Tip::*" }',
    ),
    "Leica, columns of one width": (
        "",
        "{k}  {x:12.5f}      0.00000 {z:12.5f}  14:00:{s:06.3f}",
        'columns = [2, 3, 4]\ntime = 5\ntime_format = "%H:%M:%S.%f"',
    ),
    "Leica, semicolons and names": (
        "Nr;Point Id;X [mm];Y [mm];Z [mm];Date;Time;RMS\n",
        "{k};TIP;{x:.5f};0.00000;{z:.5f};14.09.2026;14:00:{s:06.3f};0.0102",
        'columns = ["X [mm]", "Y [mm]", "Z [mm]"]\ntime = ["Date", "Time"]\n'
        'time_format = "%d.%m.%Y %H:%M:%S.%f"\nwhere = { "Point Id" = "TIP" }',
    ),
    "Leica, a stream with its deviations": (
        "# Leica AT960 stream, units: mm, s\n# id, t, x, y, z, sx, sy, sz\n",
        "TIP, {s:.3f}, {x:.5f}, 0.00000, {z:.5f}, 0.010, 0.010, 0.012",
        "columns = [3, 4, 5]\ntime = 2",
    ),
}


@pytest.mark.parametrize("form", TRACKERS)
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_exports_of_laser_trackers_are_read_in_their_forms(tmp_path, form, end):
    head, row, keys = TRACKERS[form]
    t = 5.0 + 0.1 * np.arange(30)
    x, z = 1500 * np.sin(t), 2600 + 300 * np.cos(t)
    rows = [row.format(k=k + 1, x=x[k], z=z[k], s=t[k]) for k in range(30)]
    text = (head + "\n".join(rows) + "\n").replace("\n", end)
    (tmp_path / "tracker.txt").write_bytes(text.encode())
    (tmp_path / "map.toml").write_text(
        'format = "flexarm-map/1"\n[[signals]]\nname = "tip"\nsource = "tracker.txt"\nquantity = "position"\n'
        f'point = "tip"\nunit = "mm"\n{keys}\n'
    )
    tip = flexarm.import_record(tmp_path / "map.toml").signals["tip"]
    np.testing.assert_allclose(tip.values, np.column_stack([x, 0 * x, z]) / 1e3, atol=1e-7)
    np.testing.assert_allclose(np.diff(tip.time), np.diff(t), atol=1e-6)


GSI_16 = """*110001+00000000000000A1 21.322+0000000010000000 81..16+0000000019786034 82..16-0000000023574287 \
83..16+0000000014606255
*110002+00000000000000A2 21.324+0000000009030150 81..16+0000000019786646 82..16-0000000023573775
"""
GSI_8 = """110001+00000017 22.323+04500000 81..00+00001978 82..08-00002357 83..01+00001000
110002+00000018 22.323+04600000 81..00+00001979 82..08-00002358 83..01+00002000
"""


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (GSI_16, {"point": ["A1", "A2"], "horizontal": [90.0, 90.504167], "x": [1978.6034, 1978.6646],
                  "y": [-2357.4287, -2357.3775], "z": [1460.6255, np.nan]}),
        (GSI_8, {"point": ["17", "18"], "vertical": [45.0, 46.0], "x": [1.978, 1.979],
                 "y": [-0.02357, -0.02358], "z": [0.3048, 0.6096]}),
    ],
    ids=["sixteen digits", "eight digits"],
)  # fmt: skip
def test_words_of_gsi_are_metres_and_degrees(text, wanted, tmp_path):
    """Units by the sixth sign of a word: 0 mm, 1 ft/1000, 2 gon, 3 and 4 degrees, 6 mm/10, 8 mm/100."""
    from flexarm.importing.formats import reader_of
    from flexarm.importing.map_file import Dialect

    (tmp_path / "job.gsi").write_text(text)
    source = reader_of(tmp_path / "job.gsi")(tmp_path / "job.gsi", Dialect(), [])
    assert source.names(None) == list(wanted)
    for k, (name, values) in enumerate(wanted.items()):
        if name == "point":
            assert list(source.array(None, k)) == values
        else:
            np.testing.assert_allclose(source.array(None, k), values, rtol=1e-6)


def test_names_of_gsi_points_hold_any_characters(tmp_path):
    names = ["TP-1", "A.2", "#7", "P 5"]
    lines = [f"*11{k:04d}+{name:0>16} 81..40+{k:016d} 82..40+{0:016d}" for k, name in enumerate(names, 1)]
    (tmp_path / "job.gsi").write_text("\n".join(lines))
    (tmp_path / "map.toml").write_text(
        'format = "flexarm-map/1"\nkind = "static"\n[[signals]]\nname = "tip"\nsource = "job.gsi"\n'
        'pose = "point"\ncolumns = ["x", "y"]\naxes = ["x", "y"]\nquantity = "position"\npoint = "tip"\n'
    )
    tip = flexarm.import_record(tmp_path / "map.toml").signals["tip"]
    assert tip.pose.tolist() == names
    np.testing.assert_allclose(tip.values[:, 0], [1e-3, 2e-3, 3e-3, 4e-3])


def test_a_gsi_file_of_targets_becomes_a_record_of_poses(tmp_path):
    (tmp_path / "job.gsi").write_text(GSI_8)
    (tmp_path / "angles.csv").write_text("point,angle\n17,0.1\n18,0.2\n")
    (tmp_path / "map.toml").write_text("""
format = "flexarm-map/1"
kind = "static"
drive = "hinge"
[[signals]]
name = "hinge"
source = "angles.csv"
pose = "point"
columns = ["angle"]
quantity = "joint_angle"
joint = "hinge"
[[signals]]
name = "tip"
source = "job.gsi"
pose = "point"
columns = ["x", "y", "z"]
quantity = "position"
point = "tip"
""")
    record = flexarm.import_record(tmp_path / "map.toml")
    assert list(record.signals["tip"].pose) == list(record.signals["hinge"].pose) == ["17", "18"]
    np.testing.assert_allclose(record.signals["tip"].values[1], [1.979, -0.02358, 0.6096], rtol=1e-6)


def test_a_gsi_file_in_place_of_a_model_is_named(tmp_path):
    (tmp_path / "job.gsi").write_text(GSI_16)
    with pytest.raises(InvalidFile, match=r"is a GSI file of Leica; .*flexarm import"):
        flexarm.Arm.from_toml(tmp_path / "job.gsi")


def bag_with_camera(path, storage):
    """A bag of 2000 joint states and 20 pictures of 1 MB."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    stamp, header = store.types["builtin_interfaces/msg/Time"], store.types["std_msgs/msg/Header"]
    joints, image = store.types["sensor_msgs/msg/JointState"], store.types["sensor_msgs/msg/CompressedImage"]
    pixels, none = np.arange(1_000_000, dtype=np.uint8), np.array([])
    with Writer(path, version=9, storage_plugin=StoragePlugin[storage]) as bag:
        arm = bag.add_connection("/joint_states", joints.__msgtype__, typestore=store)
        camera = bag.add_connection("/camera", image.__msgtype__, typestore=store)
        for k in range(2000):
            at = header(stamp(k // 100, k % 100 * 10_000_000), "base")
            state = joints(at, ["shoulder"], np.array([np.sin(0.01 * k)]), none, none)
            bag.write(arm, 10_000_000 * k, store.serialize_cdr(state, joints.__msgtype__))
            if k % 100 == 0:
                data = store.serialize_cdr(image(at, "jpeg", pixels), image.__msgtype__)
                bag.write(camera, 10_000_000 * k, data)


@pytest.mark.parametrize("storage", ["MCAP", "SQLITE3"])
def test_pictures_in_a_bag_are_neither_fields_nor_kept(storage, tmp_path):
    """Each byte of a picture was a field, so that a proposal for a bag of 1 GB did not end."""
    import tracemalloc

    from flexarm.importing.bag import Bag
    from flexarm.importing.map_file import Dialect
    from flexarm.importing.source import Request

    bag_with_camera(tmp_path / "run", storage)
    tracemalloc.start()
    try:
        source = Bag(tmp_path / "run", Dialect(), [])
        fields = {group.topic: group.names for group in source.groups()}
        read = source.read(Request("/joint_states", ("position[shoulder]",), "header.stamp"))
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert fields == {"/joint_states": ("position[shoulder]",)}
    assert len(read.values) == 2000
    assert most < 14e6  # of 20 MB; definitions of messages take 8 MB


def test_a_log_that_ends_its_reader_is_refused(tmp_path):
    """A parameter of this C3D file runs into the next one, on which ezc3d ends its process."""
    FORMATS["log.c3d"][0](tmp_path / "log.c3d")
    raw = (tmp_path / "log.c3d").read_bytes()
    at = raw.index(b"DESCRIPTIONS") + 15  # type, then the count of dimensions
    (tmp_path / "log.c3d").write_bytes(raw[:at] + b"\x00\xff" + raw[at:])
    with pytest.raises(InvalidFile, match="is damaged: the library that reads it ended with SIG"):
        opened(tmp_path / "log.c3d", Dialect())


def test_a_reader_that_others_end_says_nothing_of_its_log():
    """As the kernel does where memory ends, or a user who waits no longer."""
    assert [_fatal(-each) for each in (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)] == [None] * 3
    assert (_fatal(-signal.SIGSEGV), _fatal(1), _fatal(0)) == ("SIGSEGV", None, None)


def test_an_error_of_a_damaged_log_is_told_as_ever(tmp_path):
    """The process that tries it first does not hide what its reader says."""
    FORMATS["v5.mat"][0](tmp_path / "v5.mat")
    raw = (tmp_path / "v5.mat").read_bytes()
    (tmp_path / "v5.mat").write_bytes(raw[: len(raw) // 2])
    with pytest.raises(InvalidFile, match="goes beyond what holds it"):
        opened(tmp_path / "v5.mat", Dialect()).groups()


@pytest.mark.parametrize("name", ["log.mat", "log.h5"])
@pytest.mark.parametrize("across", [False, True])
@pytest.mark.parametrize("keys", ['topic = "m"\ntime = 1', "time = { rate_hz = 100 }"])
def test_samples_of_a_matrix_without_separate_stamps_run_along_its_longer_side(name, across, keys, tmp_path):
    matrix = np.column_stack([np.arange(200) / 100, np.arange(200.0), np.ones(200)])
    matrix = matrix.T if across else matrix
    if name == "log.mat":
        savemat(tmp_path / name, {"m": matrix})
    else:
        with h5py.File(tmp_path / name, "w") as file:
            file["m"] = matrix
    columns = "[2]" if "topic" in keys else '["m[2]"]'
    hinge = joint_of(tmp_path, f'source = "{name}"\n{keys}\ncolumns = {columns}')
    np.testing.assert_allclose(hinge.values[:, 0], np.arange(200.0))
    np.testing.assert_allclose(hinge.time, np.arange(200) / 100)


def test_rows_of_a_matrix_count_from_1(tmp_path):
    with h5py.File(tmp_path / "log.h5", "w") as file:
        file["m"] = np.arange(12.0).reshape(6, 2)
    keys = 'source = "log.h5"\ntime = { rate_hz = 100 }\ncolumns = ["m[NUMBER]"]'
    assert joint_of(tmp_path, keys.replace("NUMBER", "1")).values[:, 0].tolist() == [0, 2, 4, 6, 8, 10]
    with pytest.raises(InvalidFile, match=r"rows of a matrix count from 1, got 'm\[0\]'"):
        joint_of(tmp_path, keys.replace("NUMBER", "0"))


def test_invalid_values_of_mdf_are_drop_outs_at_their_stamps(tmp_path):
    flags = np.eye(20, dtype=bool)
    with MDF(version="4.10") as file:
        signals = [
            MdfSignal(k * np.arange(20.0), TIME[:20], name=name, invalidation_bits=flags[3 * k])
            for k, name in enumerate("ab", 1)
        ]
        file.append(signals)
        file.save(tmp_path / "log.mf4")
    both = joint_of(tmp_path, 'source = "log.mf4"\ntime = "log"\ncolumns = ["a", "b"]\nsum = true')
    np.testing.assert_allclose(both.time, TIME[:20])
    np.testing.assert_array_equal(
        both.values[:, 0], np.where(flags[3] | flags[6], np.nan, 3 * np.arange(20.0))
    )


def test_columns_of_mdf_groups_with_other_stamps_are_refused(tmp_path):
    with MDF(version="4.10") as file:
        file.append([MdfSignal(ANGLE, TIME, name="a")])
        file.append([MdfSignal(ANGLE, TIME + 5, name="b")])
        file.save(tmp_path / "log.mf4")
    with pytest.raises(InvalidFile, match="'b' has other stamps than 'a'"):
        joint_of(tmp_path, 'source = "log.mf4"\ntime = "log"\ncolumns = ["a", "b"]\nsum = true')


def test_waveforms_of_tdms_with_other_intervals_are_refused(tmp_path):
    with TdmsWriter(str(tmp_path / "log.tdms")) as file:
        each = [
            ChannelObject("g", n, ANGLE, properties={"wf_increment": h}) for n, h in (("a", 0.1), ("b", 0.2))
        ]
        file.write_segment(each)
    with pytest.raises(InvalidFile, match="'b' has other stamps than 'a'"):
        joint_of(tmp_path, 'source = "log.tdms"\ntime = "log"\ncolumns = ["a", "b"]\nsum = true')


def test_the_unit_of_a_channel_of_stamps_counts(tmp_path):
    with TdmsWriter(str(tmp_path / "log.tdms")) as file:
        stamps = ChannelObject("g", "clock", TIME * 1e3, properties={"unit_string": "ms"})
        file.write_segment([stamps, ChannelObject("g", "a", ANGLE)])
    with MDF(version="4.10") as file:
        file.append([MdfSignal(TIME * 1e6, TIME, name="clock", unit="us"), MdfSignal(ANGLE, TIME, name="a")])
        file.save(tmp_path / "log.mf4")
    for name in ("log.tdms", "log.mf4"):
        hinge = joint_of(tmp_path, f'source = "{name}"\ntime = "clock"\ncolumns = ["a"]')
        np.testing.assert_allclose(hinge.time, TIME, atol=1e-9)


def test_rows_of_a_spreadsheet_are_counted_with_empty_ones(tmp_path):
    rows = {"time": [0.0, None, 0.1, 0.2], "a": [0.1, None, 0.2, "?"]}
    pd.DataFrame(rows).to_excel(tmp_path / "log.xlsx", index=False)
    with pytest.raises(InvalidFile, match=r"row 5, column 'a': must be a number"):
        joint_of(tmp_path, 'source = "log.xlsx"\ntime = "time"\ncolumns = ["a"]')


def test_a_row_without_an_instant_is_named(tmp_path):
    instants = np.array(["2026-01-01", "NaT", "2026-01-03"], dtype="datetime64[ns]")
    pq.write_table(pa.table({"time": instants, "a": [0.1, 0.2, 0.3]}), tmp_path / "log.parquet")
    with pytest.raises(InvalidFile, match="row 2: a row needs a time, got none"):
        joint_of(tmp_path, 'source = "log.parquet"\ntime = "time"\ncolumns = ["a"]')


@pytest.mark.parametrize(
    ("units", "seconds"),
    [
        ("hours since 2026-01-01", 3600.0),
        ("d", 86400.0),
        ("microsec", 1e-6),
        ("minutes since 2026-01-01", 60.0),
    ],
)
def test_units_of_time_of_netcdf_are_read_as_they_are_spelt(units, seconds, tmp_path):
    with netcdf_file(tmp_path / "log.nc", "w") as file:
        file.createDimension("time", N)
        for name, values in (("time", TIME / seconds), ("a", ANGLE)):
            file.createVariable(name, float, ("time",))[:] = values
        file.variables["time"].units = units
    hinge = joint_of(tmp_path, 'source = "log.nc"\ntime = "time"\ncolumns = ["a"]')
    np.testing.assert_allclose(hinge.time, TIME, atol=1e-9)


def test_a_unit_of_stamps_that_is_not_known_must_be_stated(tmp_path):
    with netcdf_file(tmp_path / "log.nc", "w") as file:
        file.createDimension("time", N)
        for name, values in (("time", TIME), ("a", ANGLE)):
            file.createVariable(name, float, ("time",))[:] = values
        file.variables["time"].units = "ticks since 2026-01-01"
    keys = 'source = "log.nc"\ntime = "time"\ncolumns = ["a"]'
    with pytest.raises(InvalidFile, match=r"time_unit.*the unit 'ticks since 2026-01-01' of the source"):
        joint_of(tmp_path, keys)
    np.testing.assert_allclose(joint_of(tmp_path, keys + '\ntime_unit = "s"').time, TIME)


def joint_of(folder, keys):
    """The angle that a map reads by some keys."""
    (folder / "map.toml").write_text(
        'format = "flexarm-map/1"\n[[signals]]\nname = "hinge"\nquantity = "joint_angle"\njoint = "hinge"\n'
        f'side = "output"\n{keys}\n'
    )
    return flexarm.import_record(folder / "map.toml").signals["hinge"]
