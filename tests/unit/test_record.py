"""A record holds what was measured, in SI, each signal on its own instants."""

import pickle
import re
from math import pi
from pathlib import Path

import numpy as np
import pytest
from arms import crane
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from pytest import approx

import flexarm
from flexarm import Arm, Record, Signal
from flexarm.errors import InvalidFile, InvalidParameter
from flexarm.record import CarriedPayload, Clock, Frame
from flexarm.record.compatibility import _undriven

STATIC = """\
format = "flexarm-record/1"
kind = "static"

[[signals]]
name = "hinge"
quantity = "joint_angle"
joint = "hinge"
side = "motor"
file = "poses.csv"
pose = "pose"
channels = ["angle_rad"]

[[signals]]
name = "tip"
quantity = "position"
point = "tip"
axes = ["z"]
file = "tracker.csv"
pose = "pose"
channels = ["tip_z_m"]
noise_std = 5.0e-5

[[signals]]
name = "pull"
quantity = "force"
point = "tip"
axes = ["x"]
file = "poses.csv"
pose = "pose"
channels = ["pull_N"]

[[signals]]
name = "carried"
quantity = "payload_mass"
payload = "load"
file = "poses.csv"
pose = "pose"
channels = ["mass_g"]
unit = "g"
"""


def test_values_and_noise_are_converted_to_si(record_dir: Path) -> None:
    record = Record.load(record_dir)
    hinge, tip = record.signals["hinge"], record.signals["tip"]
    assert hinge.unit == "rad"
    assert hinge.values[:, 0] == approx(np.array([10, 20, 30]) * pi / 180)
    assert hinge.noise_std == approx(1e-4 * pi / 180)
    assert tip.values[0] == approx([0.52, 3.35])
    assert tip.noise_std == approx(5e-5)


def test_milliseconds_become_seconds(record_dir: Path, record_files: dict[str, str]) -> None:
    toml = record_files["record.toml"].replace('unit = "deg"', 'unit = "deg"\ntime_unit = "ms"')
    (record_dir / "record.toml").write_text(toml)
    (record_dir / "encoder.csv").write_text("time_s,encoder_deg\n0,1\n4,2\n8,3\n")
    assert Record.load(record_dir).signals["hinge"].time == approx([0, 0.004, 0.008])


def test_stamps_without_a_unit_have_that_of_the_name_of_their_column(
    record_dir: Path, record_files: dict[str, str]
) -> None:
    """A column called time_ms holds milliseconds; another unit stated beside it is told."""
    toml = record_files["record.toml"].replace("time_s", "time_ms", 1)
    (record_dir / "encoder.csv").write_text("time_ms,encoder_deg\n0,1\n4,2\n8,3\n")
    (record_dir / "record.toml").write_text(toml)
    record = Record.load(record_dir)
    assert record.signals["hinge"].time == approx([0, 0.004, 0.008])
    assert not [note for note in record.notes if "time_ms" in str(note)]
    (record_dir / "record.toml").write_text(toml.replace('unit = "deg"', 'unit = "deg"\ntime_unit = "s"'))
    record = Record.load(record_dir)
    assert record.signals["hinge"].time == approx([0, 4, 8])
    assert [note for note in record.notes if "'time_ms' ends in 'ms', but its unit is 's'" in str(note)]


def test_empty_cells_and_nan_are_drop_outs(record_dir: Path) -> None:
    tip = Record.load(record_dir).signals["tip"]
    assert tip.valid.tolist() == [True, False, False]
    assert tip.values[1, 1] == approx(3.2)  # the other channel of the row is kept
    assert np.isnan(tip.values[2]).all()


@pytest.mark.parametrize("text", [
    "time_s,encoder_deg\n# started by hand\n0.0,10.0\n0.1,20.0\n0.2,30.0\n",
    "# a comment first\n\ntime_s , encoder_deg\r\n0.0,10.0\r\n\r\n0.1,20.0\r\n0.2,30.0",
    "﻿time_s,encoder_deg\n0,10\n0.1 , 2e1\n0.2,+30.\n",
    'time_s,"encoder_deg"\n0,"10"\n0.1,"20"\n0.2,"30"\n',
    "note,encoder_deg,time_s\nstart,10,0\n,20,0.1\n,30,0.2\n",
])  # fmt: skip
def test_csv_files_are_read_however_they_are_laid_out(text: str, record_dir: Path) -> None:
    (record_dir / "encoder.csv").write_text(text)
    hinge = Record.load(record_dir).signals["hinge"]
    assert hinge.time.tolist() == [0, 0.1, 0.2]
    assert np.degrees(hinge.values[:, 0]) == approx([10, 20, 30])


def test_drop_outs_are_found_in_every_corner_of_a_file(record_dir: Path) -> None:
    (record_dir / "tracker.csv").write_text("tip_x_mm,time_s,tip_z_mm\n,1,\n2,2,\n,3,4\n , 4 ,NaN\n5,5,")
    tip = Record.load(record_dir).signals["tip"]
    nan = np.nan
    expected = np.array([[nan, nan], [2, nan], [nan, 4], [nan, nan], [5, nan]]) * 1e-3
    np.testing.assert_allclose(tip.values, expected)


def test_clocks_and_frames_are_read_as_stated(record_dir: Path, record_files: dict[str, str]) -> None:
    record = Record.load(record_dir)
    assert record.reference_clock == "controller"
    assert record.clocks["tracker"] == Clock(offset=0.01, sigma=2e-3)
    assert record.frame_of(record.signals["tip"]) == Frame(translation=1e-3, rotation=5e-4)
    assert record.frame_of(record.signals["hinge"]) == Frame()
    unknown = record_files["record.toml"].replace("{ offset = 0.01, sigma = 2.0e-3 }", '"unknown"')
    (record_dir / "record.toml").write_text(
        unknown.replace("{ translation = 1.0e-3, rotation = 5.0e-4 }", '"unknown"')
    )
    record = Record.load(record_dir)
    assert record.clocks["tracker"].unknown
    assert record.frames["tracker"].unknown


def test_signals_without_a_clock_belong_to_the_reference(
    record_dir: Path, record_files: dict[str, str]
) -> None:
    (record_dir / "record.toml").write_text(record_files["record.toml"].replace('clock = "tracker"\n', ""))
    assert Record.load(record_dir).signals["tip"].clock == "controller"


def test_a_static_record_holds_rows_of_poses(tmp_path: Path) -> None:
    (tmp_path / "record.toml").write_text(STATIC)
    (tmp_path / "poses.csv").write_text("pose,angle_rad,pull_N,mass_g\n1,0.0,0,5000\n2,0.5,10,5000\n")
    (tmp_path / "tracker.csv").write_text("pose,tip_z_m\n1,3.0\n1,3.1\n2,2.9\n2.0,\n")
    record = Record.load(tmp_path)
    tip = record.signals["tip"]
    assert record.poses == ("1", "2")
    assert tip.pose.tolist() == ["1", "1", "2", "2"]
    assert tip.valid.tolist() == [True, True, True, False]
    assert len(tip.time) == 0
    assert record.signals["carried"].values[:, 0] == approx([5, 5])
    record.save(tmp_path / "again")
    assert Record.load(tmp_path / "again").signals["tip"] == tip


def test_signals_are_drawn_with_their_units_on_the_reference_clock(record_dir: Path) -> None:
    record = Record.load(record_dir)
    figure = record.plot()
    assert [ax.get_ylabel() for ax in figure.axes] == [
        f"{s.name}\n[{s.unit}]" for s in record.signals.values()
    ]
    assert figure.axes[-1].get_xlabel() == f"time of the clock {record.reference_clock} [s]"
    tip = record.signals["tip"]
    [panel] = record.plot(["tip"]).axes
    assert [line.get_label() for line in panel.lines] == list(tip.axes)
    assert panel.lines[0].get_xdata() == approx(record.instants(tip))
    with pytest.raises(InvalidParameter, match=r"'nose'.*hinge"):
        record.plot(["nose"])


def test_poses_are_drawn_in_their_order(tmp_path: Path) -> None:
    rows = {"pose": np.array(["b", "a", "b"]), "values": [1.0, 2.0, 3.0]}
    static = Record(
        signals=[Signal(name="angle", quantity="joint_angle", joint="hinge", **rows)], kind="static"
    )
    [panel] = static.plot().axes
    assert list(panel.lines[0].get_xdata()) == [0, 1, 0]
    assert [text.get_text() for text in panel.get_xticklabels()] == ["b", "a"]


def test_arrays_of_a_record_cannot_be_changed(record_dir: Path) -> None:
    signal = Record.load(record_dir).signals["tip"]
    with pytest.raises(ValueError, match="read-only"):
        signal.values[0, 0] = 1
    with pytest.raises(ValueError, match="read-only"):
        signal.time[0] = 1


def test_rows_with_values_are_looked_for_once() -> None:
    values = np.array([[1, np.nan], [2, 3], [np.nan, np.nan]])
    signal = Signal(
        name="tip", quantity="position", point="tip", axes=("x", "z"), time=np.arange(3), values=values
    )
    assert signal.valid.tolist() == [False, True, False]
    assert signal.valid is signal.valid
    with pytest.raises(ValueError, match="read-only"):
        signal.valid[0] = True


def test_a_signal_does_not_follow_the_array_it_was_made_of() -> None:
    values = np.zeros(3)
    signal = Signal(name="hinge", quantity="joint_angle", joint="hinge", time=np.arange(3), values=values)
    values[0] = 7
    assert signal.values[0, 0] == 0


def test_a_record_crosses_process_borders(record_dir: Path) -> None:
    record = Record.load(record_dir)
    assert pickle.loads(pickle.dumps(record)) == record


# ------------------------------------------------------------------ written and read


def test_a_record_written_and_read_is_the_same_record_in_si(record_dir: Path, tmp_path: Path) -> None:
    record = Record.load(record_dir)
    record.save(tmp_path / "again")
    again = Record.load(tmp_path / "again")
    assert again.signals["tip"].channels == ("tip_x_m", "tip_z_m")  # the old names said millimetres
    assert again.replace(signals=renamed(again, record)) == record
    again.save(tmp_path / "third")
    assert Record.load(tmp_path / "third") == again
    assert again.check() == []


def renamed(record: Record, like: Record) -> dict[str, Signal]:
    """The signals with the column names of another record."""
    return {
        name: signal.replace(channels=like.signals[name].channels) for name, signal in record.signals.items()
    }


@settings(deadline=None, derandomize=True, max_examples=40)
@given(
    values=arrays(
        float, st.tuples(st.integers(1, 20), st.just(2)), elements=st.floats(-1e10, 1e10) | st.just(np.nan)
    )
)
def test_any_values_survive_writing_and_reading(
    tmp_path_factory: pytest.TempPathFactory, values: np.ndarray
) -> None:
    tip = Signal(name="tip", quantity="position", point="tip", axes=("y", "z"), values=values,
                 time=np.cumsum(np.full(len(values), 0.1)))  # fmt: skip
    directory = tmp_path_factory.mktemp("record") / "run"
    Record(signals=[tip]).save(directory)
    again = Record.load(directory).signals["tip"]
    np.testing.assert_array_equal(again.values, values)
    np.testing.assert_array_equal(again.time, tip.time)


@pytest.mark.parametrize(
    "poses", [("#1", "#2", "a"), ("1,2", '"b"', "c d"), ("20260914100300123", "20260914100300124", "x")]
)
def test_any_names_of_poses_and_columns_survive_writing_and_reading(poses, tmp_path: Path) -> None:
    tip = Signal(name="tip", quantity="position", point="tip", axes=("x", "z"), values=np.ones((3, 2)),
                 pose=poses, channels=("x, m", '"z"'), time_column="#pose")  # fmt: skip
    Record(signals=[tip], kind="static").save(tmp_path / "run")
    again = Record.load(tmp_path / "run").signals["tip"]
    assert again.pose is not None and tuple(again.pose) == poses
    assert again.channels == tip.channels


@pytest.mark.parametrize("column", ["i_mA", "angle_arcmin", "rate_deg_s"])
def test_a_column_is_not_saved_in_si_under_the_name_of_another_unit(column, tmp_path: Path) -> None:
    tip = Signal(name="tip", quantity="joint_angle", joint="a", values=[1.0, 2.0], time=[0.0, 3.0],
                 channels=(column,), time_column="stamp_ns")  # fmt: skip
    Record(signals=[tip]).save(tmp_path / "run")
    again = Record.load(tmp_path / "run").signals["tip"]
    assert again.channels == ("tip_rad",) and again.time.tolist() == [0, 3]


def test_names_of_columns_that_would_not_read_back_are_refused(tmp_path: Path) -> None:
    tip = Signal(name="tip", quantity="joint_angle", joint="a", values=[1.0], time=[0.0], channels=("a\nb",))
    with pytest.raises(InvalidParameter, match="on one line"):
        Record(signals=[tip]).save(tmp_path / "run")


def test_signals_of_one_name_of_file_and_other_instants_get_files_of_their_own(tmp_path: Path) -> None:
    a = Signal(name="a", quantity="joint_angle", joint="a", time=[0, 1], values=[1, 2], file="log.csv")
    b = Signal(name="b", quantity="joint_angle", joint="b", time=[0, 2], values=[3, 4], file="log.csv")
    c = Signal(name="c", quantity="joint_angle", joint="c", time=[0, 1], values=[5, 6], file="log.csv")
    Record(signals=[a, b, c], drive=("a", "b", "c")).save(tmp_path / "run")
    assert sorted(p.name for p in (tmp_path / "run").iterdir()) == ["log-b.csv", "log.csv", "record.toml"]
    assert list(Record.load(tmp_path / "run").signals) == ["a", "b", "c"]
    assert Record.load(tmp_path / "run").signals["b"].time.tolist() == [0, 2]


def test_saving_into_a_directory_with_files_needs_force(record_dir: Path, tmp_path: Path) -> None:
    record, other = Record.load(record_dir), tmp_path / "other"
    record.save(other)
    with pytest.raises(InvalidFile, match="holds files already"):
        record.save(other)
    (other / "notes.txt").write_text("mine")
    record.save(other, force=True)
    assert (other / "notes.txt").read_text() == "mine"
    assert Record.load(other).signals["tip"].unit == "m"


# --------------------------------------------------------------------------- doubts


def test_degrees_read_as_radians_are_reported(record_dir: Path, record_files: dict[str, str]) -> None:
    (record_dir / "record.toml").write_text(
        record_files["record.toml"].replace('unit = "deg"', 'unit = "rad"')
    )
    said = [str(problem) for problem in Record.load(record_dir).check()]
    assert any("reaches 30 rad at the output" in text and 'unit = "deg"' in text for text in said)
    assert any("'encoder_deg' ends in 'deg', but its unit is 'rad'" in text for text in said)


def test_millimetres_read_as_metres_are_reported_beside_the_arm(
    record_dir: Path, record_files: dict[str, str], model_file: Path
) -> None:
    (record_dir / "record.toml").write_text(record_files["record.toml"].replace('unit = "mm"', 'unit = "m"'))
    [problem] = Record.load(record_dir).check_against(without_wrist(model_file))
    assert problem.where == "signals.tip"
    assert "reaches 3350 m" in problem.what


def without_wrist(model_file: Path) -> Arm:
    """The model with a wrist that moves, as the record wants it."""
    arm = Arm.from_toml(model_file)
    wrist = arm.joint("wrist").replace(type="revolute", axis=(0, 1, 0))
    return arm.replace(joints=(arm.joint("hinge"), wrist))


def test_names_that_the_arm_does_not_have_are_errors(record_dir: Path, model_file: Path) -> None:
    with pytest.raises(
        InvalidFile, match=r"record\.toml: joints\.wrist: there is no joint 'wrist'; there are hinge"
    ):
        Record.load(record_dir).check_against(Arm.from_toml(model_file))
    other = without_wrist(model_file).replace(points=(), sensors=(), uncertainty={})
    with pytest.raises(
        InvalidFile, match=r"signals\.tip\.point: there is no point 'tip'; the model has no points"
    ):
        Record.load(record_dir).check_against(other)


def test_a_dead_channel_is_reported() -> None:
    dead = Signal(name="tip", quantity="position", point="tip", time=np.arange(20), noise_std=1e-5,
                  values=np.column_stack([np.sin(np.arange(20)), np.ones(20), np.cos(np.arange(20))]),
                  channels=("x", "y", "z"))  # fmt: skip
    said = [problem.what for problem in Record(signals=[dead], kind="motion").check()]
    assert "channel 'y' holds 1 m throughout, although its noise is 1e-05" in said


def test_an_encoder_at_rest_is_not_dead() -> None:
    rests = Signal(
        name="encoder",
        quantity="joint_angle",
        joint="hinge",
        time=np.arange(20),
        values=np.full(20, 0.25),
        noise_std=1e-5,
    )
    problems = Record(signals=[rests], kind="motion", drive=("encoder",)).check()
    assert not [problem for problem in problems if "throughout" in problem.what]


def test_a_pause_is_reported() -> None:
    time = np.concatenate([np.arange(10), np.arange(100, 110)])
    signal = Signal(
        name="a", quantity="joint_angle", joint="a", time=time, values=np.sin(time), noise_std=1e-6
    )
    [problem] = Record(signals=[signal], drive=("a",)).check()
    assert "has a pause of 91 s after row 9, 9 s after its first sample" in problem.what


# ------------------------------------------------------------------ in the program


def test_a_weighed_payload_takes_precedence_over_the_model(record_dir: Path, model_file: Path) -> None:
    record = Record.load(record_dir)
    carried = record.applied_to(Arm.from_toml(model_file))
    assert [load.mass for load in carried.payloads] == [5.0]
    assert record.replace(payloads={}).applied_to(carried) is carried


def test_a_run_without_load_is_compared_with_a_model_whose_load_is_uncertain_by_a_share() -> None:
    model = crane(uncertainty={"payloads.load.mass": 0.02})
    t = np.linspace(0, 1, 101)
    hinge = Signal(name="hinge", quantity="joint_angle", joint="hinge", time=t, values=0.1 * t**2)
    tip = Signal(name="tip", quantity="position", point="tip", time=t[::10], values=np.zeros((11, 3)))
    record = Record(signals=[hinge, tip], drive=["hinge"], payloads={"load": CarriedPayload(mass=0.0)})
    assert record.applied_to(model).uncertainty == {}
    assert flexarm.compare(model, record).signals["tip"].rms["total"] > 0


def test_records_made_wrongly_in_python_name_the_signal() -> None:
    with pytest.raises(InvalidParameter, match=r"signals\.tip: has 2 channels; position needs 3"):
        Signal(name="tip", quantity="position", point="tip", time=[0, 1], values=np.zeros((2, 2)))
    with pytest.raises(InvalidParameter, match=r"signals\.a\.time: stamps must be finite and rise"):
        Signal(name="a", quantity="joint_angle", joint="a", time=[0, 0], values=[1, 2])
    with pytest.raises(InvalidParameter, match="values of shape"):
        Signal(name="a", quantity="joint_angle", joint="a", time=[0, 1], values=[1, 2, 3])
    with pytest.raises(InvalidParameter, match="unknown quantity 'angle'"):
        Signal(name="a", quantity="angle", joint="a", time=[0], values=[1])
    good = Signal(name="a", quantity="joint_angle", joint="a", time=[0, 1], values=[1, 2])
    with pytest.raises(InvalidParameter, match="there is no signal 'b'; there are a"):
        Record(signals=[good], drive=("b",))


def test_every_record_of_the_cases_is_read_and_fits_its_model(shared_dir: Path) -> None:
    files = sorted(shared_dir.glob("cases/case_*/*/record.toml"))
    assert len(files) >= 54
    for file in files:
        record = Record.load(file.parent)
        arm = Arm.from_toml(file.parents[1] / "model.toml")
        assert record.check() == []
        assert record.check_against(arm) == []
        assert [record.signals[name].quantity for name in record.drive] == ["joint_angle"] * len(
            arm.moving_joints
        )


def test_a_clock_that_ran_at_another_time_is_said_before_a_run_is_made(
    record_dir: Path, model_file: Path
) -> None:
    """Stamps from 1970 beside seconds from the start: no simulation lasts that long."""
    record = Record.load(record_dir)
    late = next(s for s in record.signals.values() if s.name not in record.drive)
    moved = late.replace(time=late.time + 1.7e9)
    apart = record.replace(signals=[moved if s is late else s for s in record.signals.values()])
    assert any("no instant in common" in problem.what for problem in apart.check())
    with pytest.raises(InvalidParameter, match=rf"signals\.{late.name}.*no instant in common"):
        flexarm.compare(Arm.from_toml(model_file), apart)


def test_a_motor_that_moves_and_does_not_drive_is_a_doubt(record_dir: Path, model_file: Path) -> None:
    record, arm = Record.load(record_dir), Arm.from_toml(model_file).replace(controllers=())
    first = record.signals[record.drive[0]].replace(joint="hinge", side="motor")
    first = first.replace(values=np.linspace(0, 1, len(first.time))[:, None])
    other = first.replace(name="other", joint="elbow")
    doubts = list(_undriven(record.replace(signals=[first, other], drive=("other",)), arm))
    assert [problem.where for problem in doubts] == [f"signals.{first.name}"]
    assert "is not in drive" in doubts[0].what
    still = first.replace(values=0 * first.values)
    assert not list(_undriven(record.replace(signals=[still, other], drive=("other",)), arm))


def test_cells_apart_by_semicolons_are_said(record_dir: Path) -> None:
    for file in record_dir.glob("*.csv"):
        file.write_text(file.read_text().replace(",", ";"))
    with pytest.raises(InvalidFile, match="cells are separated by ';'; allowed are commas"):
        Record.load(record_dir)


def test_a_signal_of_the_drives_clock_that_never_meets_the_drive_is_not_compared(
    record_dir: Path, model_file: Path
) -> None:
    """It would be laid beside an arm that stands at the last angle; what else there is counts."""
    record, arm = Record.load(record_dir).replace(joints={}), Arm.from_toml(model_file)
    own = record.signals[record.drive[0]].clock
    tip = next(s for s in record.signals.values() if s.name not in record.drive).replace(clock=own)
    late = tip.replace(name="late", time=tip.time + 1e3)
    others = [record.signals[name] for name in record.drive]
    [problem] = [p for p in record.replace(signals=[*others, late]).check() if "no instant" in p.what]
    assert problem.where == "signals.late" and "by the same" in problem.what
    both = flexarm.compare(arm, record.replace(signals=[*others, tip, late]))
    assert set(both.evidence) == {tip.name} and "no instant in common" in both.skipped["late"]
    with pytest.raises(
        InvalidParameter, match=r"nothing to compare.*late: runs from 1.*no instant in common"
    ):
        flexarm.compare(arm, record.replace(signals=[*others, late]))


def test_a_long_record_reads_back_as_it_was(tmp_path):
    """Longer than a block: written by Arrow where it is installed."""
    from flexarm.record import save

    n = save.BLOCK + 3
    rng = np.random.default_rng(0)
    values = rng.standard_normal((n, 2)) * 10.0 ** rng.integers(-9, 9, (n, 1))
    values[5] = np.nan
    tip = Signal(
        name="tip", quantity="position", point="tip", axes=("x", "z"), time=1e-3 * np.arange(n), values=values
    )
    Record(signals=[tip]).save(tmp_path / "record")
    again = Record.load(tmp_path / "record").signals["tip"]
    np.testing.assert_array_equal(again.values, values)
    np.testing.assert_array_equal(again.time, tip.time)


def test_signals_stand_side_by_side_in_a_table_on_their_own_instants(tmp_path):
    import pandas as pd

    hinge = Signal(
        name="hinge", quantity="joint_angle", joint="hinge", time=[0.0, 0.1, 0.2], values=[1, 2, 3]
    )
    tip = Signal(
        name="tip",
        quantity="position",
        point="tip",
        axes=("x", "z"),
        time=[0.1, 0.15],
        values=[[4, 5], [6, 7]],
    )
    record = Record(signals=[hinge, tip])
    table = record.to_pandas()
    assert list(table.columns) == ["hinge", "tip_x", "tip_z"]
    assert table.index.tolist() == [0.0, 0.1, 0.15, 0.2]
    assert table["tip_z"].dropna().tolist() == [5, 7]
    assert table.attrs["units"]["tip_x"] == "m"
    record.to_parquet(tmp_path / "run.parquet")
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "run.parquet"), table)


def test_readings_of_poses_stand_by_pose_and_number():
    pull = Signal(name="pull", quantity="force", point="tip", axes=("z",), pose=["a", "b"], values=[-1, -2])
    tip = Signal(
        name="tip", quantity="position", point="tip", axes=("z",), pose=["a", "a", "b"], values=[3, 4, 5]
    )
    table = Record(signals=[pull, tip], kind="static").to_pandas()
    assert table.loc[("a", 2), "tip_z"] == 4
    assert table["pull_z"].dropna().tolist() == [-1, -2]
    assert table.index.names == ["pose", "reading"]


def test_a_frequency_response_is_a_table_by_frequency():
    f = np.array([1.0, 2.0])
    none = np.zeros((0, 1))
    force = Signal(name="pull", quantity="force", point="tip", axes=("z",), frequency=[], values=none)
    tip = Signal(
        name="tip",
        quantity="position",
        point="tip",
        axes=("x", "z"),
        frequency=f,
        values=[[1, 2, 3, 4], [5, 6, 7, 8]],
        input="pull",
    )
    table = Record(signals=[force, tip], kind="frequency_response").to_pandas()
    assert list(table.columns) == ["tip_x_real", "tip_x_imaginary", "tip_z_real", "tip_z_imaginary"]
    assert table.index.name == "hz"
    assert table.loc[2.0, "tip_z_imaginary"] == 8


def test_poses_that_are_numbers_have_one_spelling():
    numbers = [np.array([1, 2, 3]), np.array([1.0, 2.0, 3.0]), ["1", "02", "3.0"]]
    for pose in numbers:
        pull = Signal(name="pull", quantity="force", point="tip", axes=("z",), pose=pose, values=[-1, -2, -3])
        assert pull.pose.tolist() == ["1", "2", "3"]


def test_an_encoder_that_rolls_over_is_a_doubt():
    t = np.linspace(0, 10, 1001)
    turned = np.mod(1.4 * t, 2 * np.pi) - np.pi
    hinge = Signal(name="hinge", quantity="joint_angle", joint="hinge", time=t, values=turned)
    told = [str(problem) for problem in Record(signals=[hinge], drive=["hinge"]).check()]
    assert any("jumps 2 times by a turn between two rows" in each for each in told)


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("unit", "deg", "signals.hinge.unit: must be rad or m, the unit of the values, got 'deg'"),
        ("side", "Output", "signals.hinge.side: must be motor or output, got 'Output'"),
        ("axes", ("x", "x"), "signals.hinge.axes: must be of x, y, z, each once"),
        ("axes", ("X",), "signals.hinge.axes: must be of x, y, z, each once"),
    ],
)
def test_signals_made_in_python_are_checked_as_those_of_files(key: str, value: object, said: str) -> None:
    hinge = Signal(name="hinge", quantity="joint_angle", joint="hinge", time=[0.0, 1.0], values=[0, 1])
    with pytest.raises(InvalidParameter, match=re.escape(said)):
        hinge.replace(**{key: value})


@pytest.mark.parametrize(("key", "value"), [("kind", "Static"), ("initial", "rest")])
def test_kinds_of_records_made_in_python_are_checked(key: str, value: str) -> None:
    with pytest.raises(InvalidParameter, match=f"{key}: must be .* got '{value}'"):
        Record(signals=[], **{key: value})


def test_stamps_that_repeat_are_told_as_the_file_has_them(record_dir: Path) -> None:
    """A number of 15 digits has fewer than the file."""
    encoder = record_dir / "encoder.csv"
    names = next(line for line in encoder.read_text().splitlines() if line[:1].isalpha())
    rest = ",0" * names.count(",")
    encoder.write_text(f"{names}\n1780000000.00000045{rest}\n1780000000.00000012{rest}\n")
    with pytest.raises(InvalidFile, match=r"1780000000\.00000012 .* 1780000000\.00000045 of line 2"):
        Record.load(record_dir)
