"""Logs of every format with the same motion, written by the formats' own libraries."""

import numpy as np

N = 25
TIME = 0.004 * np.arange(N)
ANGLE = 10 * np.sin(20 * TIME)
TIP = np.stack([1000 + 5 * TIME, 2000 - TIME, 3 * TIME], axis=1)
"""Stamps [s], a joint's angle [deg], a marker [mm]."""


def matlab_5(path):
    from scipy.io import savemat

    rec = {"time": TIME, "pos_deg": np.stack([0 * ANGLE, ANGLE]), "tip": {"mm": TIP}}
    savemat(path, {"rec": rec, "note": "made by a test"})


def matlab_73(path):
    import h5py

    with h5py.File(path, "w", userblock_size=512) as file:
        file["rec/time"] = TIME[:, None]
        file["rec/pos_deg"] = np.stack([0 * ANGLE, ANGLE]).T  # MATLAB's matrices lie transposed
        file["rec/tip/mm"] = TIP.T
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")


def hdf5(path):
    import h5py

    with h5py.File(path, "w") as file:
        file["robot/joints"] = np.stack([0 * ANGLE, ANGLE])
        file["robot/stamp"] = (1e9 * TIME).round().astype(np.int64)
        file["robot/stamp"].attrs["units"] = "nanoseconds"
        kind = np.dtype([("t", float), ("xyz", float, (3,))])
        file["tracker"] = np.array([(t, tuple(p)) for t, p in zip(TIME, TIP, strict=True)], dtype=kind)


def netcdf_4(path):
    import xarray as xr

    stamps = np.datetime64("2024-05-01", "ns") + (1e9 * TIME).round().astype("timedelta64[ns]")
    data = {"angle": ("time", ANGLE), "tip": (("time", "axis"), TIP)}
    xr.Dataset(data, coords={"time": stamps}).to_netcdf(path, engine="h5netcdf")


def netcdf_3(path):
    import xarray as xr

    data = {"angle": ("t", ANGLE), "tip": (("t", "axis"), TIP), "stamp": ("t", TIME, {"units": "s"})}
    xr.Dataset(data).to_netcdf(path, engine="scipy")


def frame():
    import pandas as pd

    columns = {"time": TIME, "angle": ANGLE, "x": TIP[:, 0], "y": TIP[:, 1], "z": TIP[:, 2]}
    return pd.DataFrame(columns)


def parquet(path):
    frame().to_parquet(path)


def parquet_with_lists(path):
    import pyarrow as pa
    import pyarrow.parquet as pq

    start = np.datetime64("2024-05-01", "us") + (1e6 * TIME).round().astype("timedelta64[us]")
    columns = {"time": pa.array(start), "angle": pa.array(ANGLE), "tip": pa.array(TIP.tolist())}
    pq.write_table(pa.table(columns), path)


def feather(path):
    frame().to_feather(path)


def excel(path):
    import pandas as pd

    with pd.ExcelWriter(path) as book:
        pd.DataFrame({"what": ["speed", "load"], "value": [1, 2]}).to_excel(book, sheet_name="set-up")
        frame().to_excel(book, sheet_name="run", index=False, startrow=2)


def tdms(path):
    from nptdms import ChannelObject, TdmsWriter

    wave = {"wf_increment": 0.004, "wf_start_offset": 0.0}
    with TdmsWriter(path) as writer:
        writer.write_segment(
            [ChannelObject("robot", "angle", ANGLE, properties=wave)]
            + [ChannelObject("tracker", axis, TIP[:, k]) for k, axis in enumerate("xyz")]
            + [ChannelObject("tracker", "t", TIME)]
        )


def mdf(path):
    from asammdf import MDF, Signal

    with MDF() as file:
        file.append([Signal(ANGLE, TIME, name="angle", unit="deg")], acq_name="robot")
        tip = [Signal(TIP[:, k].copy(), TIME, name=f"tip_{axis}") for k, axis in enumerate("xyz")]
        file.append(tip, acq_name="tracker")
        file.save(path, overwrite=True)


def c3d(path):
    import ezc3d

    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [250]
    file["parameters"]["POINT"]["LABELS"]["value"] = ["base", "tip"]
    points = np.ones((4, 2, N))
    points[:3, 1] = TIP.T
    file["data"]["points"] = points
    file["parameters"]["ANALOG"]["RATE"]["value"] = [250]
    file["parameters"]["ANALOG"]["LABELS"]["value"] = ["angle"]
    file["data"]["analogs"] = ANGLE[None, None, :]
    file.write(str(path))


def optitrack(path):
    head = [
        "Format Version,1.23,Take Name,run,Capture Frame Rate,250.000000,Length Units,Millimeters",
        "",
        ",,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Marker,Marker,Marker",
        ",,wrist,wrist,wrist,wrist,tip,tip,tip",
        ',,"A1","A1","A1","A1","B2","B2","B2"',
        ",,Rotation,Rotation,Position,Error,Position,Position,Position",
        "Frame,Time (Seconds),X,Y,X,,X,Y,Z",
    ]
    rows = [
        f"{k},{t:.6f},{a!r},0,1,,{p[0]!r},{p[1]!r},{p[2]!r}"
        for k, (t, a, p) in enumerate(zip(TIME.tolist(), ANGLE.tolist(), TIP.tolist(), strict=True))
    ]
    path.write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8-sig")


def messages(store):
    """Topic, type, log time [ns] and message of all messages of a bag."""
    kinds = store.types
    Time, Header = kinds["builtin_interfaces/msg/Time"], kinds["std_msgs/msg/Header"]
    header = {"seq": 0} if "seq" in Header.__dataclass_fields__ else {}
    Joints, Point = kinds["sensor_msgs/msg/JointState"], kinds["geometry_msgs/msg/Point"]
    Pose, Stamped = kinds["geometry_msgs/msg/Pose"], kinds["geometry_msgs/msg/PoseStamped"]
    Quaternion, Tf = kinds["geometry_msgs/msg/Quaternion"], kinds.get("tf2_msgs/msg/TFMessage")
    Moved, Vector = kinds["geometry_msgs/msg/TransformStamped"], kinds["geometry_msgs/msg/Vector3"]
    Transform = kinds["geometry_msgs/msg/Transform"]
    empty, unit = np.array([]), Quaternion(0.0, 0.0, 0.0, 1.0)
    for k, (t, angle, tip) in enumerate(zip(TIME, ANGLE, TIP, strict=True)):
        ns = round(1e9 * t)
        head = Header(**header, stamp=Time(1_700_000_000, ns), frame_id="base")
        names = ["elbow", "shoulder"] if k % 2 else ["shoulder", "elbow"]  # the order may change
        position = np.array([angle, -1.0][:: -1 if k % 2 else 1])
        late = 1_700_000_000_000_000_000 + ns + 2_000_000
        yield "/joint_states", Joints.__msgtype__, late, Joints(head, names, position, empty, empty)
        other = Joints(head, ["gripper"], np.array([9.0]), empty, empty)
        yield "/joint_states", Joints.__msgtype__, late, other
        yield "/tip", Stamped.__msgtype__, late, Stamped(head, Pose(Point(*tip), unit))
        if Tf is None:  # ROS 1 has it elsewhere
            continue
        turned = Transform(Vector(*tip), unit)
        still = Transform(Vector(0.0, 0.0, 0.0), unit)
        tree = [Moved(head, "world/1.0", still), Moved(head, "tool.tip", turned)]
        yield "/tf", Tf.__msgtype__, late, Tf(tree)


def ros_1(path):
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    connections = {}
    with Writer(path) as writer:
        for topic, kind, logged, message in messages(store):
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=store)
            writer.write(connections[topic], logged, store.serialize_ros1(message, kind))


def ros_2(path, storage):
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    connections = {}
    with Writer(path, version=9, storage_plugin=StoragePlugin[storage]) as writer:
        for topic, kind, logged, message in messages(store):
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=store)
            writer.write(connections[topic], logged, store.serialize_cdr(message, kind))


def ros_2_mcap(path):
    ros_2(path, "MCAP")


def ros_2_sqlite(path):
    ros_2(path, "SQLITE3")


def single_mcap(path):
    ros_2(path.with_suffix(""), "MCAP")
    next(path.with_suffix("").glob("*.mcap")).rename(path)


def keys(columns, time, topic=None):
    lines = [f"columns = {columns}", f"time = {time}"]
    return "\n".join(lines + ([f'topic = "{topic}"'] if topic else []))


XYZ, STAMPS, LOG = '["x", "y", "z"]', '"time"', '"log"'
JOINTS = keys('["position[shoulder]"]', '"header.stamp"', "/joint_states")
POSE = keys('["pose.position.x", "pose.position.y", "pose.position.z"]', '"header.stamp"', "/tip")
MATLAB = (
    keys('["rec.pos_deg[2]"]', '"rec.time"'),
    keys('["[1]", "[2]", "[3]"]', '"rec.time"', "rec.tip.mm"),
)
TABLE = (keys('["angle"]', STAMPS), keys(XYZ, STAMPS))
ROWS = '["tip[1]", "tip[2]", "tip[3]"]'
FORMATS = {
    "v5.mat": (matlab_5, *MATLAB),
    "v73.mat": (matlab_73, *MATLAB),
    "log.h5": (
        hdf5,
        keys('["robot/joints[2]"]', '"/robot/stamp"'),
        keys('["xyz[1]", "xyz[2]", "xyz[3]"]', '"t"', "/tracker"),
    ),
    "log4.nc": (netcdf_4, keys('["angle"]', STAMPS), keys(ROWS, STAMPS)),
    "log3.nc": (netcdf_3, keys('["angle"]', '"stamp"'), keys("[1, 2, 3]", '"stamp"', "tip")),
    "log.parquet": (parquet, *TABLE),
    "lists.parquet": (parquet_with_lists, keys('["angle"]', STAMPS), keys(ROWS, STAMPS)),
    "log.feather": (feather, *TABLE),
    "log.xlsx": (excel, keys('["angle"]', STAMPS, "run"), keys("[3, 4, 5]", "1", "run")),
    "log.tdms": (tdms, keys('["angle"]', LOG, "robot"), keys(XYZ, '"t"', "tracker")),
    "log.mf4": (
        mdf,
        keys('["angle"]', LOG, "robot"),
        keys('["tip_x", "tip_y", "tip_z"]', LOG),
    ),
    "log.c3d": (c3d, keys('["angle"]', LOG, "analog"), keys('["tip.x", "tip.y", "tip.z"]', LOG)),
    "motive.csv": (
        optitrack,
        keys('["wrist.Rotation.X"]', '"Time (Seconds)"'),
        keys('["tip.Position.X", "tip.Position.Y", "tip.Position.Z"]', '"Time (Seconds)"'),
    ),
    "log.bag": (ros_1, JOINTS, POSE),
    "ros2_mcap": (ros_2_mcap, JOINTS, POSE),
    "ros2_sqlite": (ros_2_sqlite, JOINTS, POSE),
    "log.mcap": (
        single_mcap,
        JOINTS,
        keys(
            str([f"transforms[tool.tip].transform.translation.{axis}" for axis in "xyz"]).replace("'", '"'),
            '"log"',
            "/tf",
        ),
    ),
}


def map_of(name, joint, tip):
    return f"""
format = "flexarm-map/1"
drive = "shoulder"
[[signals]]
name = "shoulder"
source = "{name}"
quantity = "joint_angle"
joint = "shoulder"
side = "output"
unit = "deg"
{joint}
[[signals]]
name = "tip"
source = "{name}"
quantity = "position"
point = "tip"
unit = "mm"
{tip}
"""
